//! Nitsche's method.
//!
//! Nitsche, Abh. Math. Sem. Univ. Hamburg 36 (1971) 9; contact: Chouly & Hild, SIAM J. Numer. Anal. 51 (2013) 1295;
//! variants: Chouly, Hild & Renard, Math. Comput. 84 (2015) 1089; friction: Chouly, J. Math. Anal. Appl. 411 (2014) 329;
//! weights on cut cells: Annavarapu, Hautefeuille & Dolbow, Comput. Meth. Appl. Mech. Engng 225-228 (2012) 44.
//!
//! ```text
//! τ = S u                               contact forces that the stress at the crack implies, τ = −w {σ} n
//! P = Π(τ − Γ v),  Γ = γ w              Π: P_n = max(z_n, 0),  P_t = proj_{|·| <= μ P_n}(z_t);   v = (g, d)
//! y = Γ⁻¹ (τ − P)                       on the rows in use: normal, and tangential where there is friction
//! K u = f + Bᵀ P + θ Sᵀ y
//! ```
//! There is no multiplier: P follows from u. The exact solution has τ = P, so that y = 0 and P = Π(P − Γ v) is the
//! contact law itself: nothing is modelled away, unlike with springs. What remains is an error of the discretisation,
//! since τ is as good as the stress of the cells. `Converged` refers to the equations above, and the outcome says so by
//! [`Claim::Nitsche`]; the natural map that fills the history ends at the distance from the laws of the contact points.
//!
//! K does not change, so u is eliminated once: what is left is the exact contact law with a further compliance C ~ 1/γ
//! between the points, on as many unknowns as a multiplier method has (`own_laws/stabilisation.rs`). A semismooth Newton
//! method with the consistent tangent solves it.
//!
//! # Options
//! `theta`: 1 symmetric, 0 incomplete, −1 skew-symmetric.
//! `gamma`: γ as a multiple of λ, the largest eigenvalue of w^−½ S K⁻¹ Sᵀ w^−½: the constant of the discrete trace
//! inequality |τ|²/w <= λ u·K u, computed for the body at hand. Safe from 1.2 to 16 for θ = 1; θ = 0 and −1 also take less.
//! `max_iterations`.
//!
//! # Guarantees
//! For γ > ¼ (1 + θ)² λ the stabilised operator is positive: without friction the solution is unique. Less is refused.
//! Uniform stress is solved to rounding where the contact points can carry it (sliding block, all θ). Otherwise contact
//! forces approach those of the multipliers like 1/γ. With γ = 2 λ the reaction of the plate of the founding paper is within
//! 2e-4 of theirs for all θ and μ on meshes from 22 × 22 to 88 × 88, less than a tenth of what either misses of the
//! continuum for μ = 0.8 and 1.2; the displacements of its beam within 8e-5. Slivers do not drive λ: it varies by a factor
//! 1.3 over cuts down to 1e-9 h.
//! Where edge pairs off the grid make multipliers oscillate (scatter of P_n/w in the sliding block 0.53 to 0.65 of its
//! mean), γ = 2 λ leaves 0.12 to 0.17, and θ = −1 with γ = 0.2 λ 0.05 to 0.07.
//!
//! # Failure modes
//! Closed points overlap by y_n, sticking ones creep by y_t. Close to the bound on γ the overlap grows (natural map on the
//! plate 5e-3 for γ = 1.2 λ, 1e-3 for 2 λ). Large γ brings back the oscillations of the multipliers, and rounding: Γ v is
//! known to about 2e-14 γ/λ of the forces, so tolerances below that end as `Stalled`. Branch functions at tips triple λ, and
//! γ is the same everywhere. No global guarantee with friction; cycles for large μ, after which the iteration starts again
//! from some sweeps of the multiplier problem (random bodies: all solved up to μ = 0.6, at least 98 in 100 at μ = 1 to 5).
//!
//! # Skips
//! A load that leaves all gaps open is answered by that one solve: the contact laws hold exactly, nothing is condensed, and
//! no term of the stress is added to a crack without contact. S is assembled only if a run asks for this method; T = S K⁻¹ Sᵀ
//! and X = B K⁻¹ Sᵀ are built by the first closing load and serve every μ, θ, γ and increment. Without friction only
//! normal rows enter. A tangent that has not changed is not factored again; on 256 rows and more, nor is one of which few rows have.

use std::sync::Arc;

use crate::condensed::forces::{End, Ended};
use crate::condensed::method::CondensedMethod;
use crate::condensed::problem::ContactProblem;
use crate::condensed::stages::rescue;
use crate::contract::options::{Options, options};
use crate::contract::registry::{Method, Needs};
use crate::contract::state::{Monitor, Status};
use crate::contract::system::ContactSystem;
use crate::error::MethodError;
use crate::newton::springs::{SpringNewton, recorded};
use crate::own_laws::stabilisation::Stabilisation;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "nitsche",
    label: "Nitsche",
    reference: "Chouly & Hild, SIAM J. Numer. Anal. 51 (2013) 1295; Chouly, Hild & Renard, Math. Comput. 84 (2015) 1089",
    summary: "takes the contact forces from the stress at the crack and the jump, consistently and without multipliers",
    exact: false,
    options: Settings::OPTIONS,
    source: include_str!("nitsche.rs"),
    build: |options| Box::new(Nitsche::new(options)),
};

options! {
    Settings {
        gamma: Real(2.0, 1e-2, 1e6), "stabilisation gamma as a multiple of the constant of the discrete trace inequality";
        max_iterations: Count(100, 1, 1_000_000), "Newton steps before giving up";
        theta: Whole(1, -1, 1), "1 symmetric, 0 incomplete, -1 skew-symmetric variant";
    }
}

/// The law is solved this much more accurately than asked: the judge holds the claim to it in another norm.
const CLAIM_FRACTION: f64 = 0.1;

/// Newton steps after which the iteration counts as cycling and starts again from where the stages of the multiplier
/// problem lead.
const ROUND: usize = 20;

struct Nitsche {
    settings: Settings,
    /// The terms of a system, kept for as long as it stays the same.
    terms: Option<Arc<Stabilisation>>,
}

impl Nitsche {
    fn new(options: &Options) -> Self {
        Self {
            settings: Settings::new(options),
            terms: None,
        }
    }

    fn theta(&self) -> f64 {
        self.settings.theta as f64
    }

    fn terms(
        &mut self,
        problem: &mut ContactProblem<'_>,
    ) -> Result<Arc<Stabilisation>, MethodError> {
        match &self.terms {
            Some(terms) if terms.belongs_to(&problem.operator) => Ok(terms.clone()),
            _ => {
                let (system, operator) = (problem.increment.system, problem.operator.clone());
                let terms =
                    Stabilisation::new(system, operator, self.theta(), self.settings.gamma)?;
                problem.counters.factorisations += 1;
                Ok(self.terms.insert(Arc::new(terms)).clone())
            }
        }
    }
}

impl CondensedMethod for Nitsche {
    fn refuses(&self, system: &ContactSystem) -> Option<String> {
        let least = 0.25 * (1.0 + self.theta()).powi(2);
        if system.elastic().traction().is_none() {
            Some(
                "the body has no traction operator: the stress at its contact points is unknown"
                    .into(),
            )
        } else if self.settings.gamma <= least {
            Some(format!(
                "theta = {} needs gamma > {least}: below, the stabilised operator is not positive",
                self.theta()
            ))
        } else {
            None
        }
    }

    fn needs(&self) -> Needs {
        Needs {
            traction: true,
            ..Needs::default()
        }
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let terms = self.terms(problem)?;
        problem.claim = terms.claim();
        // The Newton iteration measures jumps on the scale of ρ, the claim measures them on that of Γ.
        let scale = (problem.operator.rho / terms.stiffest()).min(1.0);
        let stop = CLAIM_FRACTION * scale * problem.stop;
        let mut s = terms.free_stress(problem)?;
        let mut x = problem.start();
        let (mut newton, mut corrections) = (SpringNewton::default(), 0);

        let status = loop {
            let left = (self.settings.max_iterations).saturating_sub(problem.counters.iterations);
            if left == 0 {
                break Status::MaxIterations;
            }
            let springs = terms.springs(problem, &s);
            newton.start(problem, &springs, &x);
            let report = recorded(monitor, |problem, at| {
                terms.jump(problem, &s, &at.p, &at.beta)
            });
            let status = newton.solve(problem, &springs, stop, left.min(ROUND), report)?;
            x.copy(&newton.at.forces);
            match status {
                // Stalled: solved to rounding, which may be enough.
                Status::Converged | Status::Stalled => {
                    match terms.confirm(problem, &mut s, &x.p, &x.beta, corrections)? {
                        Some(status) => break status,
                        None => corrections += 1,
                    }
                }
                Status::MaxIterations if left > ROUND && problem.rescue_left() => {
                    let Some(pair) = rescue(problem)? else {
                        break problem.singular();
                    };
                    x = pair.into();
                }
                _ => break status,
            }
        };
        problem.further = terms.consistency(problem, &s, &x.p)?;
        Ok(End { status, at: x })
    }
}
