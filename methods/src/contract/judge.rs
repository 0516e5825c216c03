//! The judge: how well a state fulfils equilibrium and contact law, whatever method produced it.

use crate::algebra::dense::{larger, norm, ratio};
use crate::algebra::rows::RowSet;
use crate::contract::barrier_law::BarrierLaw;
use crate::contract::free_jump::{FreeJump, slip_from};
use crate::contract::law::{natural_map_squared, return_map, tangential_norm};
use crate::contract::operator::{ContactOperator, DelassusForm};
use crate::contract::state::{Claim, ContactState};
use crate::contract::system::Increment;
use crate::error::{MethodError, check_finite, check_len};

/// Residuals of one state, dimensionless but for the reference sizes: they change neither with units nor with the tangent frames.
///
/// Reference sizes: P_ref = ρ s and u_ref = P_ref/ρ̂, with the scale
/// ```text
/// s = max(|Π (q + W Q c)|, |Π W Π P⁰|),   Π = I − Q Qᵀ
/// ```
/// q the jump without contact forces, Q c the least forces that balance the load of floating pieces, P⁰ the forces at the start, ρ =
/// rows / trace(W), ρ̂ = ρ unless slender parts sway ([`ContactOperator::sharp`]), Euclidean norms over all points. All of it
/// is data: no answer buys a larger scale.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Residuals {
    /// |K u − f − Bᵀ P| / (|f| + |Bᵀ P| + ||K| |u||), the backward error: rounding leaves ε |K| |u| behind, which on slender
    /// or large bodies is far above ε |K u|. Or 1e-5 of the largest of one row, the componentwise backward error (Oettli and
    /// Prager, 1964): displacements of a sliver are right if its own forces balance.
    pub equilibrium: f64,
    /// The same under the claim: Nitsche's laws have a consistency term, which counts as a force.
    pub claimed_equilibrium: f64,
    /// Residual of the laws that the claim names, relative to P_ref. Under [`Claim::Exact`] the violation.
    pub claimed: f64,
    /// max −g / u_ref over the points.
    pub penetration: f64,
    /// max −P_n / P_ref: adhesion.
    pub adhesion: f64,
    /// max |g P_n| / (u_ref max(P_ref, |P_n|)): a large force need not close a gap better than any other.
    pub complementarity: f64,
    /// max (|P_t| − μ P_n) / P_ref.
    pub cone: f64,
    /// max (μ P_n |d| + P_t · d) / (u_ref max(P_ref, μ P_n)), in magnitude: zero if and only if slip is opposed by μ P_n. A force
    /// beside which the slip is rounding hides it from the natural map, not from this.
    pub slip_direction: f64,
    /// |e| / P_ref with e = P − proj(P − ρ̂ ṽ) the natural map with De Saxcé's correction: zero if and only if all
    /// contact laws hold. For μ > 1 at every point the smaller of this and the same in (μ P_n, P_t) and (g/μ, d).
    pub natural_map: f64,
    /// η: the largest of natural map, penetration, adhesion, complementarity, cone and slip direction. Tiers and verdicts refer to it.
    ///
    /// The natural map alone divides penetration and cone by √(1 + μ²): −ρ̂ g ≤ |e_n| + μ |e_t|, and as much for
    /// |P_t| − μ P_n. On scales of their own no μ hides them.
    pub violation: f64,
    /// P_ref \[N, in 2D N/m\]; 0 where nothing had to be compared.
    pub reference_force: f64,
    /// u_ref \[m\]; likewise.
    pub reference_jump: f64,
    /// [`ContactOperator::sway`]; likewise.
    pub sway: f64,
    /// ε ||W||P|| / u_ref, where only W is known: what rounding of W P may hide of the violation, with the backward error of
    /// equilibrium for ε where that is larger.
    pub rounding: f64,
}

/// Judges a state against the contact laws: [`residuals_of`] with [`Claim::Exact`].
///
/// # Errors
/// As [`residuals_of`].
pub fn residuals(i: &Increment<'_>, s: &ContactState) -> Result<Residuals, MethodError> {
    residuals_of(i, s, Claim::Exact)
}

/// Judges a state against the contact laws and against the laws that a method claims to have solved. The jump is
/// computed from `s.u`; nothing a method reports is trusted.
///
/// Without contact forces and penetration the contact laws hold for any scale, so the natural map is 0 and W is not
/// asked for anything.
///
/// # Errors
/// Arrays of the wrong length or with non-finite entries; a claim of Nitsche's laws on a body without traction
/// operator; the errors of factorisation and condensation.
pub fn residuals_of(
    i: &Increment<'_>,
    s: &ContactState,
    claim: Claim,
) -> Result<Residuals, MethodError> {
    i.check()?;
    claim.check()?;
    check_len("displacements", s.u.len(), i.start.u.len())?;
    check_len("contact forces", s.p.len(), i.start.p.len())?;
    check_finite("displacements", &s.u)?;
    check_finite("contact forces", &s.p)?;

    let (system, dim) = (i.system, i.system.dim());
    let result = Residuals {
        equilibrium: equilibrium(i, s, Claim::Exact)?,
        claimed_equilibrium: equilibrium(i, s, claim)?,
        ..Default::default()
    };
    let jump = i.jump(&s.u);
    if claim == Claim::Exact
        && s.p.iter().all(|&p| p == 0.0)
        && jump.iter().step_by(dim).all(|&g| g >= 0.0)
    {
        return Ok(result);
    }

    // W is not formed to judge: one solve, and the trace in ρ.
    let operator = system.operator(DelassusForm::Products)?;
    let (rho, rows) = (operator.sharp, system.row_set());
    let free = system.elastic().free(&i.load.force)?;
    let FreeJump {
        start_jump, scale, ..
    } = FreeJump::new(i, &operator, &i.jump(&free))?;
    let v = slip_from(rows, dim, &jump, &start_jump);
    let p = rows.restrict(&s.p);
    let (p_ref, u_ref) = operator.reference(scale);

    let forbidden = norm(&s.p).powi(2) - norm(&p).powi(2);
    let found = Violations::of(system.friction(), rows, &operator, scale, &p, &v);
    let natural_map = found
        .natural_map
        .hypot(ratio(forbidden.max(0.0).sqrt(), p_ref));
    // All components, also those without a row: forces the law forbids must not hide.
    let excess = |i: usize| excess(system.friction()[i], &s.p[dim * i..dim * (i + 1)]);
    let cone = ratio((0..rows.points()).map(excess).fold(0.0, larger), p_ref);
    let found = Violations {
        natural_map,
        cone,
        ..found
    };
    let mut result = Residuals {
        equilibrium: result.equilibrium,
        claimed_equilibrium: result.claimed_equilibrium,
        sway: operator.sway,
        ..found.residuals(&operator, scale)
    };
    // Of a body equilibrium says how right its jumps are; where only W is known they may miss W P by as much as that is off.
    if system.elastic().stiffness().is_none() {
        let error = result.equilibrium.max(f64::EPSILON);
        result.rounding = ratio(error * operator.w.magnitude(&p), u_ref);
    }
    result.claimed = match claim {
        Claim::Exact => result.violation,
        Claim::Penalised { normal, tangential } => {
            // Springs in series with the body: the contact laws hold with v + (P − A)/k for v.
            let mut stretched = v;
            for (k, &row) in rows.source.iter().enumerate() {
                stretched[k] += if row % dim == 0 {
                    p[k] / normal
                } else {
                    (p[k] - i.start.p[row]) / tangential
                };
            }
            Violations::of(system.friction(), rows, &operator, scale, &p, &stretched).largest()
        }
        Claim::Barrier {
            gap,
            slip,
            stiffness,
        } => {
            let law = BarrierLaw {
                gap,
                slip,
                stiffness,
            };
            let square = |i: usize| {
                let own = rows.of(i);
                let mu = system.friction()[i];
                law.mismatch_squared(mu, rho, &p[own.clone()], &v[own])
            };
            ratio((0..rows.points()).map(square).sum::<f64>().sqrt(), p_ref)
        }
        Claim::Nitsche { gamma, .. } => {
            let stress = rows.restrict(&implied_forces(i, &s.u)?);
            let mut square = 0.0;
            for point in 0..rows.points() {
                let own = rows.of(point);
                let stiffness = gamma * system.weight()[point];
                let mut z: Vec<f64> = (own.clone())
                    .map(|k| stress[k] - stiffness * v[k])
                    .collect();
                return_map(system.friction()[point], &mut z);
                square += own.zip(z).map(|(k, z)| (p[k] - z).powi(2)).sum::<f64>();
            }
            ratio(square.sqrt(), p_ref)
        }
    };
    Ok(result)
}

/// S u plus the traction of prescribed displacements: the contact forces that the stress of the bulk implies.
pub(crate) fn implied_forces(i: &Increment<'_>, u: &[f64]) -> Result<Vec<f64>, MethodError> {
    let traction = i.system.elastic().traction();
    let traction = traction.ok_or(MethodError::NoTraction)?;
    let mut stress = vec![0.0; traction.rows()];
    traction.mul(u, &mut stress);
    stress
        .iter_mut()
        .zip(&i.load.traction)
        .for_each(|(x, t)| *x += t);
    Ok(stress)
}

/// θ y by row, y = (S u − P)/(γ w): equilibrium has the force Sᵀ (θ y) under Nitsche's laws, and under no others.
///
/// # Errors
/// A claim of Nitsche's laws on a body without traction operator.
pub fn consistency(
    i: &Increment<'_>,
    s: &ContactState,
    claim: Claim,
) -> Result<Option<Vec<f64>>, MethodError> {
    let Claim::Nitsche { theta, gamma } = claim else {
        return Ok(None);
    };
    let mut y = vec![0.0; s.p.len()];
    let stress = implied_forces(i, &s.u)?;
    for &row in &i.system.row_set().source {
        let weight = i.system.weight()[row / i.system.dim()];
        y[row] = theta * (stress[row] - s.p[row]) / (gamma * weight);
    }
    Ok(Some(y))
}

/// Backward error of equilibrium between all forces of the claim.
fn equilibrium(i: &Increment<'_>, s: &ContactState, claim: Claim) -> Result<f64, MethodError> {
    let mut further = vec![0.0; s.u.len()];
    if let (Some(y), Some(traction)) = (consistency(i, s, claim)?, i.system.elastic().traction()) {
        traction.mul_transpose_add(&y, &mut further);
    }
    Ok(imbalance(i, s, &further))
}

/// Backward error of equilibrium between the load, the contact forces and further ones.
pub(crate) fn imbalance(i: &Increment<'_>, s: &ContactState, further: &[f64]) -> f64 {
    let elastic = i.system.elastic();
    let mut contact = vec![0.0; s.u.len()];
    elastic.jump().mul_transpose_add(&s.p, &mut contact);
    elastic.imbalance(&s.u, &[&i.load.force, &contact, further])
}

/// Violations of the contact laws by a pair of forces and jumps, each relative to its own scale; see [`Residuals`].
pub(crate) struct Violations {
    natural_map: f64,
    penetration: f64,
    adhesion: f64,
    complementarity: f64,
    cone: f64,
    slip: f64,
}

impl Violations {
    /// Of P and v = (g, d) by row, both first divided by their scales: nothing leaves the range of numbers on the way.
    pub(crate) fn of(
        friction: &[f64],
        rows: &RowSet,
        operator: &ContactOperator,
        scale: f64,
        p: &[f64],
        v: &[f64],
    ) -> Self {
        let (mut square, mut overlap, mut tension, mut product, mut outside, mut slip) =
            (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let (p_ref, u_ref) = operator.reference(scale);
        for (own, &mu) in rows.iter().zip(friction) {
            let (mut at_p, mut at_v) = ([0.0; 3], [0.0; 3]);
            let count = own.len();
            for (l, k) in own.enumerate() {
                (at_p[l], at_v[l]) = (ratio(p[k], p_ref), ratio(v[k], u_ref));
            }
            let (p, v) = (&at_p[..count], &at_v[..count]);
            square += natural_map_squared(mu, 1.0, p, v);
            overlap = larger(overlap, -v[0]);
            tension = larger(tension, -p[0]);
            product = larger(product, (v[0] * p[0] / p[0].abs().max(1.0)).abs());
            outside = larger(outside, excess(mu, p));
            // In this order no bound leaves the range of numbers.
            let (d, bound) = (tangential_norm(v), mu * p[0].max(0.0));
            let power = |scale: f64| -> f64 {
                p[1..].iter().zip(&v[1..]).map(|(p, d)| p / scale * d).sum()
            };
            let unopposed = if bound > 1.0 {
                d + power(bound)
            } else {
                bound * d + power(1.0)
            };
            slip = larger(slip, unopposed.abs());
        }
        Self {
            natural_map: square.sqrt(),
            penetration: overlap,
            adhesion: tension,
            complementarity: product,
            cone: outside,
            slip,
        }
    }

    /// The same as residuals of a pair that has no displacements, relative to P_ref and u_ref = P_ref/ρ.
    pub(crate) fn residuals(&self, operator: &ContactOperator, scale: f64) -> Residuals {
        let (reference_force, reference_jump) = operator.reference(scale);
        Residuals {
            penetration: self.penetration,
            adhesion: self.adhesion,
            complementarity: self.complementarity,
            cone: self.cone,
            slip_direction: self.slip,
            natural_map: self.natural_map,
            violation: self.largest(),
            reference_force,
            reference_jump,
            ..Residuals::default()
        }
    }

    /// The largest; NaN if one is.
    pub(crate) fn largest(&self) -> f64 {
        let own_scales = [
            self.penetration,
            self.adhesion,
            self.complementarity,
            self.cone,
            self.slip,
        ];
        own_scales.into_iter().fold(self.natural_map, larger)
    }
}

/// |P_t| − μ max(P_n, 0) at one point.
fn excess(mu: f64, p: &[f64]) -> f64 {
    tangential_norm(p) - mu * p[0].max(0.0)
}
