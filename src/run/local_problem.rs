//! An increment as the local problem of an interchange file.

use stickslip_methods::{ContactState, Increment, LocalForm};

use crate::files::interchange::{Info, LocalEquality, LocalProblem, SparseMatrix};

/// Local velocity (g, d) of a state: gaps, and slips since the start of the increment.
pub fn local_velocity(increment: &Increment<'_>, state: &ContactState) -> Vec<f64> {
    let dim = increment.system.dim();
    let mut v = increment.jump(&state.u);
    for (row, start) in increment.start_jump().into_iter().enumerate() {
        if row % dim != 0 {
            v[row] -= start;
        }
    }
    v
}

/// The local problem, without solution and guesses.
pub fn unsolved(increment: &Increment<'_>, form: &LocalForm, info: Info) -> LocalProblem {
    let (rows, count) = (form.q.len(), form.modes.len());
    LocalProblem {
        dim: increment.system.dim(),
        w: SparseMatrix::from_square(&form.w),
        q: form.q.clone(),
        mu: increment.system.friction().to_vec(),
        equality: (count > 0).then(|| LocalEquality {
            v: SparseMatrix::from_dense_columns(rows, &form.modes),
            r: SparseMatrix::from_dense(count, count, |_, _| 0.0),
            s: form.balance.iter().map(|c| -c).collect(),
        }),
        info,
        solution: None,
        guesses: Vec::new(),
    }
}
