//! The Delassus operator of a body as products alone.

use std::sync::Arc;

use crate::algebra::delassus::{Delassus, columns_abs_add};
use crate::algebra::dense::zero;
use crate::algebra::rows::RowSet;
use crate::contract::elastic::Elastic;
use crate::error::MethodError;

/// W that is never formed: a product is one solve with K.
pub(crate) struct Products {
    elastic: Arc<Elastic>,
    rows: RowSet,
    diagonal: Vec<f64>,
}

impl Products {
    pub fn new(elastic: Arc<Elastic>, rows: RowSet) -> Result<Self, MethodError> {
        Ok(Self {
            diagonal: elastic.diagonal(&rows)?,
            elastic,
            rows,
        })
    }
}

impl Delassus for Products {
    fn rows(&self) -> usize {
        self.rows.len()
    }

    fn apply_add(&self, p: &[f64], v: &mut [f64]) {
        self.elastic.product_add(&self.rows, p, v);
    }

    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn column<'a>(&'a self, k: usize, work: &'a mut Vec<f64>) -> &'a [f64] {
        let mut unit = vec![0.0; self.rows.len()];
        unit[k] = 1.0;
        zero(work, self.rows.len());
        self.apply_add(&unit, work);
        work
    }

    fn apply_abs_add(&self, p: &[f64], v: &mut [f64]) {
        match self.elastic.product_abs(&self.rows, p) {
            Some(product) => v.iter_mut().zip(product).for_each(|(v, w)| *v += w),
            None => columns_abs_add(self, p, v),
        }
    }

    fn formed(&self) -> bool {
        false
    }

    fn symmetric(&self) -> bool {
        self.elastic.asymmetry() == 0.0
    }
}
