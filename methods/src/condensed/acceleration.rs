//! Anderson acceleration of the fixed point that a method iterates anyway, safeguarded by the natural map.
//! ```text
//! plain        x <- G(x)
//! accelerated  x <- Anderson's combination of the last images (Walker & Ni, SIAM J. Numer. Anal. 49 (2011) 1715)
//! safeguard    violation(x) > growth · violation(x before):  x <- the plain image of x before, and all differences are dropped
//! ```

use crate::condensed::anderson::Anderson;
use crate::condensed::problem::ContactProblem;

/// Growth of the violation after which an accelerated iterate is taken back.
const GROWTH: f64 = 2.0;

/// Knowledge of the iteration, and its fallback.
pub(crate) struct Acceleration {
    depth: usize,
    anderson: Anderson,
    /// The plain image of the iterate before, if that was not taken.
    plain: Option<Vec<f64>>,
    /// Violation of the iterate before.
    before: f64,
}

impl Acceleration {
    /// Effect of the option `anderson`.
    pub const HELP: &str = "differences that Anderson acceleration keeps, safeguarded by the natural map; 0: the plain method";

    /// Keeps `depth` differences, from `start`; `None` for 0.
    pub fn new(depth: usize, start: impl FnOnce() -> Vec<f64>) -> Option<Self> {
        (depth > 0).then(|| Self {
            depth,
            anderson: begun(depth, start()),
            plain: None,
            before: f64::INFINITY,
        })
    }

    /// Forgets all: another map takes over, at `start`.
    pub fn restart(&mut self, start: Vec<f64>) {
        self.anderson = begun(self.depth, start);
        self.plain = None;
    }

    /// The iterate from which the method goes on, given the `image` of the iterate that was noted last.
    pub fn next(&mut self, problem: &ContactProblem<'_>, image: Vec<f64>) -> Vec<f64> {
        let violation = problem.last_violation();
        if violation > GROWTH * self.before
            && let Some(plain) = self.plain.take()
        {
            self.restart(plain.clone());
            return plain;
        }
        self.before = violation;
        let mut next = image.clone();
        self.anderson.next(&mut next);
        self.plain = (next != image).then_some(image);
        next
    }
}

fn begun(depth: usize, mut start: Vec<f64>) -> Anderson {
    let mut anderson = Anderson::unbounded(depth);
    anderson.next(&mut start);
    anderson
}
