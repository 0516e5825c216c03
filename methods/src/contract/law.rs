//! The Signorini–Coulomb law at one point: projections, return mapping, their derivatives, the natural map.
//!
//! A point has the components (n), (n, a) or (n, a, b); all functions take slices of length 1, 2 or 3.
//! ```text
//! K_μ      = { P : |P_t| <= μ P_n }                                  Coulomb's cone
//! return   : z -> (P_n, P_t),  P_n = max(z_n, 0),  P_t = proj_{|·| <= μ P_n}(z_t)
//! natural  : e(P, v) = P − proj_{K_μ}(P − ρ ṽ),  ṽ = (g + μ|d|, d)   De Saxcé's correction
//! ```
//! The law holds if and only if e = 0, for any ρ > 0: P is in K_μ, ṽ in its dual cone and P · ṽ = 0, which is
//! 0 <= g ⊥ P_n >= 0 together with Coulomb's rule (De Saxcé & Feng 1998; Acary & Cadoux 2013).

/// State of a contact point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Branch {
    /// No contact force.
    Open,
    /// Closed without slip; also closed without friction.
    Stick,
    /// Closed with the tangential force at Coulomb's bound.
    Slip,
}

/// |z_t| of the tangential part of a point vector.
pub fn tangential_norm(z: &[f64]) -> f64 {
    match z {
        [_, a] => a.abs(),
        [_, a, b] => a.hypot(*b),
        _ => 0.0,
    }
}

/// Projects `z` on Coulomb's cone K_μ, in place; says where it lands: at the tip, inside (where `z` lay in the cone), or on
/// the mantle. Without tangential components K_μ is P_n >= 0.
pub fn project_cone(mu: f64, z: &mut [f64]) -> Branch {
    let t = tangential_norm(z);
    if mu * t <= -z[0] {
        z.fill(0.0);
        return Branch::Open;
    }
    if t <= mu * z[0] {
        return Branch::Stick;
    }
    let c = (z[0] + mu * t) / (1.0 + mu * mu);
    z[0] = c;
    for x in &mut z[1..] {
        *x *= mu * c / t;
    }
    Branch::Slip
}

/// Projects the tangential part of `z` on the ball of the given radius, in place; says whether it lay outside.
pub fn project_ball(radius: f64, z_t: &mut [f64]) -> Branch {
    let t = match z_t {
        [a] => a.abs(),
        [a, b] => a.hypot(*b),
        _ => 0.0,
    };
    if t <= radius {
        return Branch::Stick;
    }
    for x in z_t {
        *x *= radius / t;
    }
    Branch::Slip
}

/// Return mapping z -> P, in place: P_n = max(z_n, 0), P_t projected on |P_t| <= μ P_n.
pub fn return_map(mu: f64, z: &mut [f64]) -> Branch {
    if z[0] <= 0.0 {
        z.fill(0.0);
        return Branch::Open;
    }
    let radius = mu * z[0];
    project_ball(radius, &mut z[1..])
}

/// Derivative of the projection on a ball of variable radius at a point outside of it:
/// δP_t = e δradius + (radius/|z_t|) (I − e eᵀ) δz_t with e = z_t/|z_t|. Returns (e, (radius/|z_t|)(I − e eᵀ)).
pub fn ball_derivative(radius: f64, z_t: &[f64]) -> ([f64; 2], [[f64; 2]; 2]) {
    match z_t {
        // A ball in one dimension is an interval: its ends do not turn.
        [a] => ([a.signum(), 0.0], [[0.0; 2]; 2]),
        [a, b] => {
            let t = a.hypot(*b);
            let e = [a / t, b / t];
            let s = radius / t;
            (
                e,
                [
                    [s * (1.0 - e[0] * e[0]), -s * e[0] * e[1]],
                    [-s * e[0] * e[1], s * (1.0 - e[1] * e[1])],
                ],
            )
        }
        _ => ([0.0; 2], [[0.0; 2]; 2]),
    }
}

/// Derivative of the piece `branch` of [`return_map`] at `z`: row i, column j is ∂P_i/∂z_j.
pub fn return_map_derivative(mu: f64, z: &[f64], branch: Branch) -> [[f64; 3]; 3] {
    let mut d = [[0.0; 3]; 3];
    match branch {
        Branch::Open => {}
        Branch::Stick => (0..z.len()).for_each(|k| d[k][k] = 1.0),
        Branch::Slip => {
            d[0][0] = 1.0;
            let (e, s) = ball_derivative(mu * z[0], &z[1..]);
            for k in 1..z.len() {
                d[k][0] = mu * e[k - 1];
                for l in 1..z.len() {
                    d[k][l] = s[k - 1][l - 1];
                }
            }
        }
    }
    d
}

/// |e|² of the natural map at one point; `v` = (g, d).
///
/// For μ > 1 the smaller of two: with (P_n, P_t) and (g, d), and with (μ P_n, P_t) and (g/μ, d), which obey the same laws with
/// μ = 1. The first multiplies the rounding of a slip that ought to be nothing by μ, the second that of P_n where there is
/// slip.
pub fn natural_map_squared(mu: f64, rho: f64, p: &[f64], v: &[f64]) -> f64 {
    let plain = scaled_map_squared(mu, 1.0, rho, p, v);
    if mu > 1.0 {
        plain.min(scaled_map_squared(1.0, mu, rho, p, v))
    } else {
        plain
    }
}

/// With `scale` P_n and g/`scale`.
fn scaled_map_squared(mu: f64, scale: f64, rho: f64, p: &[f64], v: &[f64]) -> f64 {
    let normal = scale * p[0];
    let mut z = [0.0; 3];
    let z = &mut z[..p.len()];
    z[0] = normal - rho * (v[0] / scale + mu * tangential_norm(v));
    for k in 1..p.len() {
        z[k] = p[k] - rho * v[k];
    }
    project_cone(mu, z);
    let tangential = p[1..].iter().zip(&z[1..]).map(|(p, z)| (p - z).powi(2));
    (normal - z[0]).powi(2) + tangential.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const CASES: u32 = 500;

    fn norm(z: &[f64]) -> f64 {
        z.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    fn distance(a: &[f64], b: &[f64]) -> f64 {
        norm(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
    }

    fn projected(mu: f64, z: &[f64]) -> Vec<f64> {
        let mut p = z.to_vec();
        project_cone(mu, &mut p);
        p
    }

    /// Points with one, two and three components.
    fn point() -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec(-10.0..10.0_f64, 1..=3)
    }

    fn friction() -> impl Strategy<Value = f64> {
        prop_oneof![Just(0.0), 0.01..5.0_f64]
    }

    /// A pair (P, v) that fulfils the law, from a direction and two sizes.
    fn lawful(mu: f64, branch: Branch, angle: f64, p_n: f64, size: f64) -> ([f64; 3], [f64; 3]) {
        let e = [angle.cos(), angle.sin()];
        match branch {
            Branch::Open => ([0.0; 3], [size, e[0], e[1]]),
            Branch::Stick => {
                let t = 0.9 * mu * p_n * size / (1.0 + size);
                ([p_n, t * e[0], t * e[1]], [0.0; 3])
            }
            Branch::Slip => {
                let t = -mu * p_n;
                ([p_n, t * e[0], t * e[1]], [0.0, size * e[0], size * e[1]])
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(CASES))]

        #[test]
        fn cone_projection_lands_in_the_cone_and_is_idempotent(mu in friction(), z in point()) {
            let p = projected(mu, &z);
            prop_assert!(tangential_norm(&p) <= mu * p[0] + 1e-14 * norm(&z) && p[0] >= 0.0);
            prop_assert!(distance(&projected(mu, &p), &p) <= 1e-14 * norm(&z));
        }

        #[test]
        fn cone_projection_is_the_nearest_point(mu in friction(), z in point(), w in point()) {
            // (z − p)·(w − p) <= 0 for every w in the cone characterises the projection.
            let p = projected(mu, &z);
            let mut w = w[..z.len().min(w.len())].to_vec();
            w.resize(z.len(), 0.0);
            let w = projected(mu, &w);
            let angle: f64 = (0..z.len()).map(|k| (z[k] - p[k]) * (w[k] - p[k])).sum();
            prop_assert!(angle <= 1e-12 * (1.0 + norm(&z) * norm(&w)));
        }

        #[test]
        fn cone_projection_does_not_expand(mu in friction(), a in prop::array::uniform3(-9.0..9.0_f64), b in prop::array::uniform3(-9.0..9.0_f64)) {
            prop_assert!(distance(&projected(mu, &a), &projected(mu, &b)) <= distance(&a, &b) * (1.0 + 1e-14));
        }

        #[test]
        fn return_map_lands_in_the_cone_and_is_idempotent(mu in friction(), z in point()) {
            let mut p = z.clone();
            let branch = return_map(mu, &mut p);
            prop_assert_eq!(branch == Branch::Open, z[0] <= 0.0);
            prop_assert!(p[0] >= 0.0 && tangential_norm(&p) <= mu * p[0] + 1e-14 * norm(&z));
            let mut again = p.clone();
            return_map(mu, &mut again);
            prop_assert!(distance(&again, &p) <= 1e-14 * norm(&z));
        }

        #[test]
        fn return_map_derivative_matches_differences(mu in 0.05..3.0_f64, z in point(), k in 0..3_usize) {
            let k = k % z.len();
            let mut p = z.clone();
            let branch = return_map(mu, &mut p);
            // Away from kinks, where differences mix two pieces.
            prop_assume!(z[0].abs() > 1e-3 && (tangential_norm(&z) - mu * z[0]).abs() > 1e-3);
            prop_assume!(z.len() == 1 || tangential_norm(&z) > 0.1);
            let d = return_map_derivative(mu, &z, branch);
            let h = 1e-6;
            let (mut up, mut down) = (z.clone(), z.clone());
            up[k] += h;
            down[k] -= h;
            return_map(mu, &mut up);
            return_map(mu, &mut down);
            for i in 0..z.len() {
                prop_assert!((d[i][k] - (up[i] - down[i]) / (2.0 * h)).abs() < 1e-6);
            }
        }

        #[test]
        fn natural_map_vanishes_where_the_law_holds(
            mu in friction(), angle in 0.0..6.3_f64, p_n in 0.1..10.0_f64, size in 0.01..10.0_f64, rho in 1e-3..1e3_f64, b in 0..3_usize,
        ) {
            let branch = [Branch::Open, Branch::Stick, Branch::Slip][b];
            let (p, v) = lawful(mu, branch, angle, p_n, size);
            let scale = norm(&p) + rho * (1.0 + mu) * norm(&v);
            prop_assert!(natural_map_squared(mu, rho, &p, &v).sqrt() <= 1e-14 * scale);
        }

        #[test]
        fn natural_map_sees_every_violation(
            mu in 0.05..3.0_f64, angle in 0.0..6.3_f64, p_n in 0.1..10.0_f64, size in 0.1..10.0_f64, amount in 0.01..1.0_f64, kind in 0..6_usize,
        ) {
            let (stick, slip, open) = (Branch::Stick, Branch::Slip, Branch::Open);
            let (mut p, mut v) = lawful(mu, [stick, stick, slip, slip, open, stick][kind], angle, p_n, size);
            let e = [angle.cos(), angle.sin()];
            match kind {
                0 => v[0] = -amount,                                  // penetration
                1 => v[0] = amount,                                   // force across a gap
                2 => (1..3).for_each(|k| p[k] *= 1.0 + amount),       // beyond the cone
                3 => (1..3).for_each(|k| v[k] = -v[k]),               // friction that drives slip
                4 => p[0] = -amount,                                  // adhesion
                _ => (1..3).for_each(|k| v[k] = amount * e[k - 1]),   // slip inside the cone
            }
            prop_assert!(natural_map_squared(mu, 1.0, &p, &v).sqrt() > 1e-4 * amount.min(p_n * mu));
        }

        #[test]
        fn natural_map_does_not_depend_on_the_tangent_frame(
            mu in friction(), p in prop::array::uniform3(-9.0..9.0_f64), v in prop::array::uniform3(-9.0..9.0_f64), angle in 0.0..6.3_f64,
        ) {
            let turn = |x: [f64; 3]| [x[0], angle.cos() * x[1] + angle.sin() * x[2], -angle.sin() * x[1] + angle.cos() * x[2]];
            let (a, b) = (natural_map_squared(mu, 0.7, &p, &v), natural_map_squared(mu, 0.7, &turn(p), &turn(v)));
            prop_assert!((a - b).abs() <= 1e-12 * (1.0 + a));
        }
    }
}
