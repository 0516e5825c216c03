//! Cracked bodies in general and special position, and fields on their pieces.

use stickslip::model::body::{Body, Needs};
use stickslip_xfem::enrichment::pieces::pieces;

use super::{clamped, crack, parse, plane, solid};

/// Bodies with cracks in general and in special position; all outlines clamped, K and B are kept over all unknowns.
///
/// ```text
///   straight across   oblique   through nodes   two cracks   one tip   two tips   3D planes
/// ```
pub fn bodies(needs: Needs) -> Vec<(&'static str, Body)> {
    bodies_like(needs, str::to_owned)
}

/// The same with case files changed: another material, other meshes.
pub fn bodies_like(needs: Needs, change: impl Fn(&str) -> String) -> Vec<(&'static str, Body)> {
    let body = |text: &str| {
        let text = change(text);
        Body::new(&parse(&text), 1, &needs).unwrap_or_else(|e| panic!("{e}\n{text}"))
    };
    let flat = |cracks: String| {
        let rest = cracks + &clamped(2);
        body(&plane([0.0, 0.0], [3.0, 3.0], [6, 6], &rest))
    };
    let block = |planes: &[([f64; 3], [f64; 3], f64)]| {
        body(&solid([3.0, 3.0, 3.0], [3, 3, 3], planes, &clamped(3)))
    };
    let across = |y: f64, slope: f64| crack([-1.0, y - slope], [4.0, y + 4.0 * slope], 0.3, "none");
    let tipped = |p, q, tip| flat(crack(p, q, 0.3, tip));
    let one_plane = |point, normal| block(&[(point, normal, 0.3)]);
    let low = ([0.0, 0.0, 0.6], [0.05, 0.0, 1.0], 0.3);
    let high = ([0.0, 0.0, 2.4], [0.0, 0.05, 1.0], 0.3);
    #[rustfmt::skip]
    let all = vec![
        ("straight", flat(across(1.6, 0.0))),
        ("oblique", flat(across(0.7, 0.4))),
        ("through nodes", flat(across(0.0, 1.0))),
        ("on cell edges", flat(across(1.5, 0.0))),
        ("two cracks", flat(across(0.7, 0.03) + &across(2.3, -0.02))),
        ("one tip", tipped([-1.0, 1.2], [1.7, 1.9], "branch")),
        ("two tips", tipped([0.6, 1.2], [2.3, 1.9], "branch")),
        ("no tip", tipped([0.6, 1.2], [2.3, 1.9], "none")),
        ("plane", one_plane([0.0, 0.0, 1.7], [0.0, 0.0, 1.0])),
        ("oblique plane", one_plane([1.4, 1.6, 1.5], [1.0, 0.3, 2.0])),
        ("plane through nodes", one_plane([0.0, 0.0, 0.0], [1.0, 0.0, -1.0])),
        ("two planes", block(&[low, high])),
    ];
    all
}

/// A displacement field.
pub type Motion = Box<dyn Fn(&[f64; 3]) -> [f64; 3]>;

/// Rigid motions about the origin: translations, then rotations.
pub fn motions(dim: usize) -> Vec<Motion> {
    let rotations: &[[usize; 2]] = if dim == 2 {
        &[[0, 1]]
    } else {
        &[[0, 1], [1, 2], [2, 0]]
    };
    let mut all: Vec<Motion> = Vec::new();
    for a in 0..dim {
        all.push(Box::new(move |_| {
            let mut r = [0.0; 3];
            r[a] = 1.0;
            r
        }));
    }
    for &[a, b] in rotations {
        all.push(Box::new(move |x| {
            let mut r = [0.0; 3];
            (r[a], r[b]) = (-x[b], x[a]);
            r
        }));
    }
    all
}

/// A field given piece by piece, 0 in the branch functions.
pub fn piecewise(body: &Body, field: impl Fn(usize, &[f64; 3]) -> [f64; 3]) -> Vec<f64> {
    pieces(&body.mesh, &body.enrichment).field(&body.mesh, &body.enrichment, field)
}

/// A motion of some pieces, 0 on the others.
pub fn motion_of(
    body: &Body,
    moves: impl Fn(usize) -> bool,
    r: impl Fn(&[f64; 3]) -> [f64; 3],
) -> Vec<f64> {
    piecewise(body, |piece, x| if moves(piece) { r(x) } else { [0.0; 3] })
}
