//! An increment as interchange formats hold it: condensed to the contact points, all `dim` rows of every point.

use crate::algebra::dense::minus;
use crate::algebra::floating::ModeJumps;
use crate::algebra::matrix::SquareMatrix;
use crate::algebra::rows::RowSet;
use crate::contract::free_jump::slip_from;
use crate::contract::state::ContactState;
use crate::contract::system::Increment;
use crate::error::{MethodError, check_finite, check_len};

/// `v = (g, d) = q + W P + V α`, `Vᵀ P = c`, and the contact laws between v and P.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalForm {
    /// Delassus operator W, `dim` rows per point, in m/N (2D: m²/N). Of a body set up without friction the normal rows; the
    /// tangential ones, on which no force acts, are coupled to nothing and have the mean of its diagonal.
    pub w: SquareMatrix,
    /// Gaps and slips without contact forces, `dim` per point, in m; the tangential jump at the start of the increment
    /// is taken off. Slips of a body set up without friction are 0.
    pub q: Vec<f64>,
    /// Orthonormal jumps V of the rigid motions, one vector each; empty unless the body floats.
    pub modes: Vec<Vec<f64>>,
    /// Amount of the contact forces on each rigid motion, in N (2D: N/m).
    pub balance: Vec<f64>,
    /// Rigid motions that move none of the rows: no contact force holds them.
    pub loose: usize,
}

impl Increment<'_> {
    /// Condenses the increment, points without friction included with all their rows.
    ///
    /// # Errors
    /// Those of the first factorisation and condensation.
    pub fn local_form(&self) -> Result<LocalForm, MethodError> {
        self.check()?;
        let elastic = self.system.elastic();
        let formed = elastic.formed()?;
        elastic.on_body(|| {
            let u = elastic.free(&self.load.force)?;
            let (rows, modes) = (elastic.rows(), self.form_modes());
            let all = self.load.offset.len();
            let q = slip_from(&rows, self.system.dim(), &self.jump(&u), &self.start_jump());
            Ok(LocalForm {
                w: spread(formed.matrix()?, &rows, all)?,
                q: rows.extend(&q, all),
                balance: modes.balance(&self.resultant()),
                modes: modes.q.iter().map(|q| rows.extend(q, all)).collect(),
                loose: modes.free,
            })
        })?
    }

    /// The state of contact forces P and amplitudes α of the [local form](Self::local_form):
    /// u = G (f + Bᵀ P) + R α. What P lacks of the balance Vᵀ P = c is put right by the least change first.
    ///
    /// # Errors
    /// Wrong lengths and non-finite numbers; the errors of a solve with K.
    pub fn state_of(
        &self,
        forces: &[f64],
        amplitudes: &[f64],
    ) -> Result<ContactState, MethodError> {
        let elastic = self.system.elastic();
        elastic.on_body(|| {
            let (rows, modes) = (elastic.rows(), self.form_modes());
            check_len("contact forces", forces.len(), self.load.offset.len())?;
            check_finite("contact forces", forces)?;
            check_len("rigid amplitudes", amplitudes.len(), modes.len())?;
            check_finite("rigid amplitudes", amplitudes)?;
            let balance = modes.balance(&self.resultant());
            let missing = minus(&balance, &modes.components(&rows.restrict(forces)));
            let mut change = vec![0.0; rows.len()];
            modes.add(&missing, &mut change);
            let mut p = rows.extend(&change, forces.len());
            p.iter_mut().zip(forces).for_each(|(p, given)| *p += given);

            let mut u = self.load.force.clone();
            elastic.jump().mul_transpose_add(&p, &mut u);
            elastic.solve(&mut u)?;
            for (r, alpha) in elastic.floating().iter().zip(modes.amplitudes(amplitudes)) {
                u.iter_mut().zip(r).for_each(|(u, r)| *u += alpha * r);
            }
            Ok(ContactState { u, p })
        })?
    }

    /// Jumps of the rigid motions on the rows the body has.
    fn form_modes(&self) -> ModeJumps {
        let elastic = self.system.elastic();
        ModeJumps::new(elastic.jump(), &elastic.rows().source, elastic.floating())
    }
}

/// A matrix on the rows listed among all rows, which have the mean of its diagonal.
fn spread(w: SquareMatrix, rows: &RowSet, all: usize) -> Result<SquareMatrix, MethodError> {
    if rows.len() == all {
        return Ok(w);
    }
    let mean = (0..w.size()).map(|k| w.diagonal(k)).sum::<f64>() / w.size().max(1) as f64;
    let mut place = vec![None; all];
    for (k, &row) in rows.source.iter().enumerate() {
        place[row] = Some(k);
    }
    let mut col_ptr = vec![0];
    let (mut row_idx, mut values) = (Vec::new(), Vec::new());
    for (row, place) in place.into_iter().enumerate() {
        match place {
            Some(k) => {
                for (i, value) in w.column(k) {
                    row_idx.push(rows.source[i]);
                    values.push(value);
                }
            }
            None => {
                row_idx.push(row);
                values.push(mean);
            }
        }
        col_ptr.push(values.len());
    }
    if w.is_symmetric() {
        SquareMatrix::symmetric(all, col_ptr, row_idx, values)
    } else {
        SquareMatrix::general(all, col_ptr, row_idx, values)
    }
}
