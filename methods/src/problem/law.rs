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

/// Projects `z` on Coulomb's cone K_μ, in place. Without tangential components K_μ is P_n >= 0.
pub fn project_cone(mu: f64, z: &mut [f64]) {
    let t = tangential_norm(z);
    if z[0] >= 0.0 && t <= mu * z[0] {
        return;
    }
    if mu * t <= -z[0] {
        z.fill(0.0);
        return;
    }
    let c = (z[0] + mu * t) / (1.0 + mu * mu);
    z[0] = c;
    for x in &mut z[1..] {
        *x *= mu * c / t;
    }
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
pub fn natural_map_squared(mu: f64, rho: f64, p: &[f64], v: &[f64]) -> f64 {
    let mut z = [0.0; 3];
    let z = &mut z[..p.len()];
    z[0] = p[0] - rho * (v[0] + mu * tangential_norm(v));
    for k in 1..p.len() {
        z[k] = p[k] - rho * v[k];
    }
    project_cone(mu, z);
    p.iter().zip(z.iter()).map(|(p, z)| (p - z).powi(2)).sum()
}
