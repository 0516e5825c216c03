//! LATIN method: local and global stages in turn.
//!
//! Ladevèze, Nonlinear Computational Structural Mechanics (1999); on cracks in XFEM: Dolbow, Moës & Belytschko,
//! Comput. Meth. Appl. Mech. Engng 190 (2001) 6825.
//!
//! ```text
//! local stage,   at each point:  z = P − k₀ v                   search direction +k₀
//!                                P̂_n = max(z_n, 0),  P̂_t = proj_{|·| <= μ P̂_n}(z_t),  v̂ = (P̂ − z)/k₀
//! global stage,  all points:     P + k₀ v = P̂ + k₀ v̂,  v = q + W P + Q β,  Qᵀ P = c      search direction −k₀
//!                                (I + k₀ W) P + k₀ Q β = P̂ + k₀ v̂ − k₀ q
//! relaxation:                    (P, v) <- (P, v) + ω (new − old)
//! ```
//! The local pair (P̂, v̂) fulfils the contact laws, the global pair (P, v) equilibrium; both meet at the solution.
//! I + k₀ W never changes and is factored once per system.
//!
//! # Options
//! `search_direction`: k₀ as a multiple of 1/√(w_min w_max), which minimises the contraction of the linear part, max |1 − k₀
//! w|/(1 + k₀ w) over the eigenvalues w of W. w_min and w_max come from 60 Lanczos steps; eigenvalues below 1e-4 w_max
//! (redundant contact points) do not count. `relaxation`: ω; 1/2 is Douglas–Rachford, 1 Peaceman–Rachford. `max_iterations`.
//! `anderson`: differences kept by the acceleration of (P, k₀ v) (Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715), taken
//! back where the natural map doubles. On random problems (`stickslip study random`, 100 per entry) median iterations and
//! how many gave up:
//!
//! | μ                | 0       | 0.3     | 1       | 2       | 5       |
//! |------------------|---------|---------|---------|---------|---------|
//! | 2D, `anderson` 0 | 118     | 272     | 196     | 161     | 140     |
//! | 2D, `anderson` 5 | 48      | 78      | 65      | 72, 2   | 62      |
//! | 3D, `anderson` 0 | 234, 7  | 355, 7  | 338, 6  | 245, 6  | 188, 6  |
//! | 3D, `anderson` 5 | 102     | 118, 7  | 111, 1  | 108, 1  | 103     |
//!
//! # Guarantees
//! Convergence for monotone laws (no friction, or Tresca) and ω < 1. For Coulomb friction there is no proof; the
//! iteration count hardly depends on μ in practice.
//!
//! # Skips
//! An open crack is one linear solve. I + k₀ W is factored once for all increments, loads and friction values of a body.
//!
//! # Failure modes
//! Slow far from the best k₀ (times ten in iterations for a factor of ten), and on ill-conditioned W.

use std::sync::Arc;

use crate::condensed::acceleration::Acceleration;
use crate::condensed::branches::Branches;
use crate::condensed::forces::{End, Ended};
use crate::condensed::method::CondensedMethod;
use crate::condensed::pair::Pair;
use crate::condensed::problem::{ContactProblem, Limits};
use crate::condensed::stages::{GlobalStage, local_stage};
use crate::contract::options::{Options, options};
use crate::contract::registry::{Method, Needs};
use crate::contract::state::Monitor;
use crate::error::MethodError;

/// Registry entry.
pub static METHOD: Method = Method {
    name: "latin",
    label: "LATIN",
    reference: "Dolbow, Moës & Belytschko, Comput. Meth. Appl. Mech. Engng 190 (2001) 6825",
    summary: "alternates the contact laws point by point with linear equilibrium along fixed search directions",
    exact: true,
    options: Settings::OPTIONS,
    source: include_str!("latin.rs"),
    build: |options| Box::new(Latin::new(options)),
};

options! {
    Settings {
        search_direction: Real(1.0, 1e-3, 1e3), "search direction k0 as a multiple of 1/sqrt(w_min w_max), extreme eigenvalues of W";
        relaxation: Real(0.8, 0.1, 1.0), "relaxation of the global stage";
        max_iterations: Count(20_000, 1, 10_000_000), "pairs of stages before giving up";
        anderson: Count(0, 0, 20), Acceleration::HELP;
    }
}

/// Iterations without progress after which the iteration counts as stalled: plateaus of some hundred are normal.
const PATIENCE: usize = 2000;

struct Latin {
    settings: Settings,
    /// The global stage, kept for as long as the system stays the same.
    global: Option<Arc<GlobalStage>>,
}

impl Latin {
    fn new(options: &Options) -> Self {
        Self {
            settings: Settings::new(options),
            global: None,
        }
    }

    fn stage(&mut self, problem: &mut ContactProblem<'_>) -> Result<Arc<GlobalStage>, MethodError> {
        match &self.global {
            Some(stage) if stage.belongs_to(&problem.operator) => Ok(stage.clone()),
            _ => {
                problem.counters.factorisations += 1;
                let stage =
                    GlobalStage::new(problem.operator.clone(), self.settings.search_direction)?;
                Ok(self.global.insert(Arc::new(stage)).clone())
            }
        }
    }
}

impl CondensedMethod for Latin {
    fn needs(&self) -> Needs {
        Needs::ANY_OPERATOR
    }

    fn iterate(&mut self, problem: &mut ContactProblem<'_>, monitor: &mut dyn Monitor) -> Ended {
        let limits = Limits::new(self.settings.max_iterations, PATIENCE);
        let global = self.stage(problem)?;
        let (mut pair, mut new) = (Pair::start(problem), Pair::default());
        let (mut branches, mut target) = (Branches::default(), Vec::new());
        let k0 = global.k0();
        let mut acceleration = Acceleration::new(self.settings.anderson, || pair.stacked(k0));
        let mut changes = 0;

        let status = loop {
            if let Some(status) = pair.ends(problem, changes, limits, monitor)? {
                break status;
            }
            changes = local_stage(k0, problem, &pair, &mut branches, &mut target);
            if !global.global_stage(problem, &target, &mut new) {
                break problem.singular();
            }
            pair.relax(problem, self.settings.relaxation, &new);
            if let Some(acceleration) = &mut acceleration {
                let next = acceleration.next(problem, pair.stacked(k0));
                pair.unstack(k0, &next);
            }
        };
        let at = pair.into();
        Ok(End { status, at })
    }
}
