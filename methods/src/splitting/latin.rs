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
//! `search_direction`: k₀ as a multiple of 1/√(w_min w_max), which minimises the contraction of the linear part,
//! max |1 − k₀ w|/(1 + k₀ w) over the eigenvalues w of W. w_min and w_max come from 60 Lanczos steps; eigenvalues
//! below 1e-4 w_max (redundant contact points) do not count. `relaxation`: ω; 1/2 is Douglas–Rachford, 1
//! Peaceman–Rachford. `max_iterations`.
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

use crate::condensed::problem::{Begin, Limits, Reduced};
use crate::condensed::stages::{GlobalStage, Pair};
use crate::contract::law::Branch;
use crate::{
    Claim, ContactSystem, Enforcement, Increment, Method, MethodError, Monitor, OptionSpec,
    Options, Outcome,
};

/// Registry entry.
pub static METHOD: Method = Method {
    name: "latin",
    label: "LATIN",
    reference: "Dolbow, Moës & Belytschko, Comput. Meth. Appl. Mech. Engng 190 (2001) 6825",
    summary: "alternates the contact laws point by point with linear equilibrium along fixed search directions",
    exact: true,
    options: &OPTIONS,
    source: include_str!("latin.rs"),
    build: |options| Ok(Box::new(Latin::new(options))),
};

static OPTIONS: [OptionSpec; 3] = [
    OptionSpec {
        name: "search_direction",
        unit: "-",
        default: 1.0,
        min: 1e-3,
        max: 1e3,
        integer: false,
        help: "search direction k0 as a multiple of 1/sqrt(w_min w_max), extreme eigenvalues of W",
    },
    OptionSpec {
        name: "relaxation",
        unit: "-",
        default: 0.8,
        min: 0.1,
        max: 1.0,
        integer: false,
        help: "relaxation of the global stage",
    },
    OptionSpec {
        name: "max_iterations",
        unit: "-",
        default: 20_000.0,
        min: 1.0,
        max: 1e7,
        integer: true,
        help: "pairs of stages before giving up",
    },
];

/// Iterations without progress after which the iteration counts as stalled: plateaus of some hundred are normal.
const PATIENCE: usize = 2000;

struct Latin {
    search_direction: f64,
    relaxation: f64,
    max_iterations: usize,
    global: Option<Arc<GlobalStage>>,
    /// Factorisations not yet counted in an outcome.
    new_factors: usize,
}

impl Latin {
    fn new(options: &Options) -> Self {
        Self {
            search_direction: options.own("search_direction"),
            relaxation: options.own("relaxation"),
            max_iterations: options.own("max_iterations") as usize,
            global: None,
            new_factors: 0,
        }
    }

    /// The global stage of a system; kept for as long as the system stays the same.
    fn stage(&mut self, system: &ContactSystem) -> Result<Arc<GlobalStage>, MethodError> {
        let condensed = system.condensed()?;
        if let Some(stage) = &self.global
            && stage.belongs_to(&condensed)
        {
            return Ok(stage.clone());
        }
        let stage = Arc::new(GlobalStage::new(condensed, self.search_direction)?);
        self.global = Some(stage.clone());
        self.new_factors += 1;
        Ok(stage)
    }
}

impl Enforcement for Latin {
    fn prepare(&mut self, system: &ContactSystem) -> Result<(), MethodError> {
        system.elastic().factorise()
    }

    fn solve(
        &mut self,
        increment: &Increment<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, MethodError> {
        let mut problem = match Reduced::begin(increment, |_| Claim::Exact)? {
            Begin::Done(outcome) => return Ok(outcome),
            Begin::Contact(problem) => problem,
        };
        let relaxation = self.relaxation;
        let limits = Limits {
            iterations: self.max_iterations,
            patience: PATIENCE,
        };
        let global = self.stage(increment.system)?;
        problem.counters.factorisations += std::mem::take(&mut self.new_factors);
        let mut pair = Pair::start(&problem);
        let mut before: Vec<Branch> = Vec::new();
        let mut changes = 0;

        let status = loop {
            let mut natural_map = problem.natural_map(&pair.p, &pair.v);
            if natural_map <= problem.stop {
                // The relaxed v carries the rounding of all stages before: claim nothing without a fresh one.
                pair.v = problem.jump(&pair.p, &pair.beta);
                natural_map = problem.natural_map(&pair.p, &pair.v);
            }
            if let Some(status) = problem.ends(natural_map, changes, limits, monitor) {
                match problem.confirm(status, &pair.p, &pair.beta)? {
                    Some(status) => break status,
                    None => {
                        pair.v = problem.jump(&pair.p, &pair.beta);
                        continue;
                    }
                }
            }
            let (target, branches) = global.local_stage(&mut problem, &pair);
            changes = branches.iter().zip(&before).filter(|(a, b)| a != b).count();
            before = branches;
            let Some(new) = global.global_stage(&problem, &target) else {
                break problem.singular();
            };
            pair.relax(&problem, relaxation, &new);
        };
        problem.finish(status, &pair.p, &pair.beta)
    }
}
