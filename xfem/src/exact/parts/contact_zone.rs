//! Zone of a straight crack that slips or opens from one end, and ends smoothly inside the crack.
//!
//! The load drives a point of the crack by F and resistance grows along it: what must vanish on the faces is F − c s/a with
//! c > 0, positive (so the point lets go) on the side of the end s = −a, up to x₀ = a F/c. The zone that lets go is
//!
//! ```text
//!   x₀ <= −a       none
//!   x₀ >= a/2      the whole crack: A = F, B = −c/a
//!   otherwise      [−a, 2b − a], b = 2 (x₀ + a)/3: A = −B b/2, no singularity at its inner end
//!
//!   jump (4/E')(c/2a)(b − ξ)^{3/2} (b + ξ)^{1/2}        K(−a) = √(πb) c b/a
//!   stress left on the closed part (c/a)(ξ + b/2) √((ξ − b)/(ξ + b)) below resistance
//! ```
//!
//! ξ from the middle of the zone. With resistance −pressure this is partial opening, with μ times the pressure partial slip.

use super::face_load::{FaceLoad, Mode};

/// The zone that lets go under excess F − c s/a on a crack |s| <= a; `growth` is c >= 0 [Pa].
pub fn released(mode: Mode, a: f64, excess: f64, growth: f64) -> Option<FaceLoad> {
    let slope = -growth / a;
    // x₀/a against −1 and 1/2, multiplied by c: c = 0 needs no case of its own.
    if excess <= -growth {
        None
    } else if excess >= 0.5 * growth {
        Some(FaceLoad::new(mode, 0.0, a, excess, slope))
    } else {
        let b = 2.0 * a * (excess / growth + 1.0) / 3.0;
        // No singularity at the inner end.
        Some(FaceLoad::new(mode, b - a, b, -0.5 * slope * b, slope))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_grows_without_a_leap_to_the_whole_crack() {
        let (a, c) = (1.0, 0.5);
        let part = released(Mode::Opening, a, 0.25 - 1e-12, c).unwrap();
        let full = released(Mode::Opening, a, 0.25, c).unwrap();
        assert!((part.half_length - full.half_length).abs() < 1e-11 && part.centre.abs() < 1e-11);
        assert!((part.mean() - full.mean()).abs() < 1e-11);
        // Without growth the crack holds or lets go as a whole.
        assert!(released(Mode::Shear, a, -1e-9, 0.0).is_none());
        assert_eq!(released(Mode::Shear, a, 1e-9, 0.0).unwrap().mean(), 1e-9);
    }
}
