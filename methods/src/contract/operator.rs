//! The problem seen from the contact points: `[[u]] = q + W P + Q β`.
//!
//! W is the Delassus operator on the rows in use; Q spans the jumps of rigid motions (no columns if K is definite).

use faer::Mat;

use crate::algebra::dense::mul_add;
use crate::algebra::floating::{ModeJumps, dot};
use crate::contract::elastic::Elastic;
use crate::error::MethodError;

/// Below this fraction of the local compliance the trace of W is rounding.
const NO_TRACE: f64 = 1e-10;

/// Rows in use: one (normal) or `dim` per contact point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct RowSet {
    /// First row of each point; one more entry for the end.
    pub start: Vec<usize>,
    /// Row of B behind each row.
    pub source: Vec<usize>,
    /// Number of rows of the point each row belongs to.
    pub size_at: Vec<usize>,
}

impl RowSet {
    /// `components[i]` rows for point i.
    pub fn new(dim: usize, components: &[usize]) -> Self {
        let (mut start, mut source, mut size_at) = (vec![0], Vec::new(), Vec::new());
        for (i, &c) in components.iter().enumerate() {
            size_at.extend(std::iter::repeat_n(c, c));
            source.extend((0..c).map(|k| dim * i + k));
            start.push(source.len());
        }
        Self {
            start,
            source,
            size_at,
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.source.len()
    }

    /// Rows of point `i`.
    pub fn of(&self, i: usize) -> std::ops::Range<usize> {
        self.start[i]..self.start[i + 1]
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.start.len() - 1
    }

    /// Row by row of B; 0 for those not in use.
    pub fn positions(&self, all: usize) -> Vec<usize> {
        let mut position = vec![0; all];
        for (k, &i) in self.source.iter().enumerate() {
            position[i] = k;
        }
        position
    }

    /// Entries of a vector with all `dim` rows per point.
    pub fn restrict(&self, all: &[f64]) -> Vec<f64> {
        self.source.iter().map(|&i| all[i]).collect()
    }
}

/// W, Q and the scale of the natural map for one set of rows.
pub(crate) struct Condensed {
    /// Delassus operator, symmetric positive semi-definite, in m/N.
    pub w: Mat<f64>,
    /// Jumps of rigid motions.
    pub modes: ModeJumps,
    /// ρ = rows / trace(W⊥) in N/m, W⊥ = (I − Q Qᵀ) W (I − Q Qᵀ), which no choice of pins changes.
    pub rho: f64,
}

impl Condensed {
    pub fn new(elastic: &Elastic, w: Mat<f64>, rows: &RowSet) -> Result<Self, MethodError> {
        let modes = ModeJumps::new(elastic.jump(), &rows.source, elastic.floating());
        let mut trace: f64 = (0..rows.len()).map(|i| w[(i, i)]).sum();
        for q in &modes.q {
            let mut wq = vec![0.0; q.len()];
            mul_add(&w, q, &mut wq);
            trace -= dot(q, &wq);
        }
        let local = elastic.local_compliance(&rows.source);
        if rows.len() > 0 && local <= 0.0 {
            return Err(MethodError::RigidContact);
        }
        // Where every contact row moves rigidly, W⊥ vanishes and the local compliance sets the scale.
        let rho = rows.len() as f64
            / if trace > NO_TRACE * local {
                trace
            } else {
                local
            };
        Ok(Self { w, modes, rho })
    }

    /// The same for some of the rows.
    pub fn select(
        &self,
        elastic: &Elastic,
        from: &RowSet,
        rows: &RowSet,
    ) -> Result<Self, MethodError> {
        let position = from.positions(elastic.jump().rows());
        let at = |k: usize| position[rows.source[k]];
        let w = Mat::from_fn(rows.len(), rows.len(), |i, j| self.w[(at(i), at(j))]);
        Self::new(elastic, w, rows)
    }
}
