//! Quadrature points several at a time, coordinate by coordinate: the processor then works on several at once.

use std::iter::Peekable;

use pulp::{Arch, NullaryFnOnce};

use crate::geometry::{Point, Points};

/// Points at once: a few registers full.
pub const LANES: usize = 8;

/// Works on points (ξ, x, K weights) of one region, [`LANES`] at a time; the last are filled up with weights of 0. Where `work` and
/// what it calls are not inlined, they go without vectors.
pub fn in_lanes<const K: usize>(
    points: impl IntoIterator<Item = (Point, Point, [f64; K])>,
    work: impl FnMut(&Points<LANES>, &Points<LANES>, &[[f64; LANES]; K]),
) {
    let points = points.into_iter().peekable();
    Arch::new().dispatch(InLanes { points, work });
}

/// What is compiled for the vectors that the processor has, with all that is inlined into it.
struct InLanes<I: Iterator, F> {
    points: Peekable<I>,
    work: F,
}

impl<const K: usize, I, F> NullaryFnOnce for InLanes<I, F>
where
    I: Iterator<Item = (Point, Point, [f64; K])>,
    F: FnMut(&Points<LANES>, &Points<LANES>, &[[f64; LANES]; K]),
{
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        while let Some(&(xi, x, _)) = self.points.peek() {
            let (mut xis, mut xs) = (xi.map(|v| [v; LANES]), x.map(|v| [v; LANES]));
            let mut weights = [[0.0; LANES]; K];
            for (q, (xi, x, weight)) in self.points.by_ref().take(LANES).enumerate() {
                for a in 0..3 {
                    (xis[a][q], xs[a][q]) = (xi[a], x[a]);
                }
                (0..K).for_each(|k| weights[k][q] = weight[k]);
            }
            (self.work)(&xis, &xs, &weights);
        }
    }
}
