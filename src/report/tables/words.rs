//! Meanings that columns of several tables share.

pub const CASE: &str = "name of the case: its file without `.toml`";
pub const MESH: &str = "mesh label, e.g. `22x22`";
pub const SPACE: &str =
    "contact space with its marks, e.g. `edge-pairs`, `edge-pairs/gauss-6`, `star/mean-dilatation`";
pub const METHOD: &str = "method, options other than the default in brackets; `exec:` and the name of the file of a program from outside";
pub const FRICTION: &str = "friction coefficient (of the first crack where cracks differ)";
pub const INCREMENT: &str = "number of the increment, from 1; 0: the state at time 0, solved first where something acts then";
pub const VERDICT: &str = "what the method claims, checked: `solved`, `solved (several)` (another answer holds as well), `approximate: low`, `mid` or `none` (its own laws solved; the contact laws hold to that tier), `false-claim`, `gave-up: …`, `refused: …`, `crashed: …`, `timed-out`, `out-of-memory`; `not run` where there is no such run";
pub const NATURAL_MAP: &str = "residual of the contact conditions, found by the judge";
pub const ITERATIONS: &str = "iterations of the method";
pub const TANGENTS: &str = "dense factorisations of condensed matrices";
pub const GLOBALS: &str =
    "sparse factorisations of matrices over all unknowns, by monolithic variants";
pub const LOCALS: &str = "evaluations of the contact law at one point";
pub const SOLVES: &str = "solves with the factor of K";
pub const DOFS: &str = "free displacement unknowns";
pub const POINTS: &str = "contact points";
pub const CELL_WIDTH: &str = "largest distance of neighbouring grid lines";
pub const SETUP_S: &str = "mesh, cracks, sparsity pattern and elimination order, once per mesh; the traction operator for methods that need it";
pub const ASSEMBLY_S: &str = "assembly of K, once per mesh";
pub const FACTORISATION_S: &str = "factorisation of K, once per mesh";
pub const CONDENSATION_S: &str = "condensation to the contact points, once per mesh; for methods that need it with that of the traction operator";
pub const PREPARE_S: &str = "preparation of the method";
pub const ENFORCEMENT_S: &str = "of these enforcement, from the free jump and W to the contact forces: without load solves, recovery of displacements and checks of equilibrium, which cost the same whatever the method";
pub const REPORTED_S: &str = "of a program from outside (`exec:`) its own account of what its solver took, no part of any comparison; `NaN` without one, and of all other methods. `enforcement` is then the wall time of the process from its start to its end";
pub const AT: &str = "place: a side, a probe, a crack (`crack-1`), a tip (`crack-1 tip-2`, `crack-1 front-45deg`), or empty";
pub const COMPONENT: &str = "`x`, `y`, `z`, `n`, `a`, `b`, `I`, `II`, `III`, or empty";
pub const DIMENSION: &str = "space dimension, 2 or 3";
pub const CAUSE: &str = "why the run gave up, decided by running it again under observation: `no-solution`, `singular-tangent`, `inner-iteration`, `floor`, `cycle`, `conditioning`, `slow`, `several-solutions`, `wandering`, `unexplained`, asked in this order (docs/stability.md); empty if it did not give up but failed otherwise";
pub const MEASURE: &str = "what decided: combinations of states tried (`no-solution`; `NaN` where a certificate proves it), smallest over largest singular value (`singular-tangent`), least violation (`cycle`, `slow`, `unexplained`), violation over its rounding (`floor`), condition number of W on the loaded rows, or at rest along what is missing to the nearest solution (`conditioning`), iterations up to the inner one that failed (`inner-iteration`), points that keep changing (`wandering`), largest difference between two solutions (`several-solutions`)";
pub const REMEDY: &str = "first of the documented list that solves the problem: the method with another option, else another method; empty if none does";
