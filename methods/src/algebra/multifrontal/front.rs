//! One dense front: assembled from K and from the updates of its children, its own columns eliminated.
//! ```text
//! [ F₁₁      ]     L₁₁ L₁₁ᵀ = F₁₁,   L₂₁ = F₂₁ L₁₁⁻ᵀ,   U = F₂₂ − L₂₁ L₂₁ᵀ
//! [ F₂₁  F₂₂ ]
//! ```
//! Blocks are cut at the same places whatever the number of threads, so that the bits are the same.

use std::ops::Range;

use faer::MatMut;
use faer::reborrow::ReborrowMut;

use crate::algebra::strips::{
    Failure, STRIP, Trapezoid, WORTH_THREADS, cholesky_of_strips, for_all, subtract_square,
};

/// U, the lower triangle by strips of columns.
pub(super) struct Update {
    size: usize,
    /// Columns t·STRIP.., rows from the first of these columns on.
    strips: Vec<Vec<f64>>,
}

impl Update {
    fn zeros(size: usize) -> Result<Self, Failure> {
        let strips = (0..size).step_by(STRIP);
        let strips = strips.map(|begin| zeros((size - begin) * STRIP.min(size - begin)));
        Ok(Self {
            size,
            strips: strips.collect::<Result<_, _>>()?,
        })
    }

    /// The strip of column j, and where its rows j.. stand in it.
    fn place(&self, j: usize) -> (usize, Range<usize>) {
        let (strip, own) = (j / STRIP, j % STRIP);
        let height = self.size - strip * STRIP;
        (strip, own * height + own..(own + 1) * height)
    }

    /// Rows j.. of column j.
    fn column(&self, j: usize) -> &[f64] {
        let (strip, rows) = self.place(j);
        &self.strips[strip][rows]
    }

    /// Rows j.. of column j.
    fn column_mut(&mut self, j: usize) -> &mut [f64] {
        let (strip, rows) = self.place(j);
        &mut self.strips[strip][rows]
    }
}

/// A front under assembly, then its columns of L.
pub(super) struct Front<'a> {
    /// F₁₁ over F₂₁, later L₁₁ over L₂₁.
    panel: &'a mut [f64],
    shape: Trapezoid,
    pub update: Update,
}

impl<'a> Front<'a> {
    /// Of zeros.
    pub fn new(panel: &'a mut [f64], shape: Trapezoid) -> Result<Self, Failure> {
        // Zeros already: but a page that is read before it is written to is given out twice, and the second time all cores wait.
        panel.fill(0.0);
        let update = Update::zeros(shape.height - shape.columns)?;
        Ok(Self {
            panel,
            shape,
            update,
        })
    }

    /// Rows j.. of column j of the panel.
    pub fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.panel[self.shape.column(j)]
    }

    /// Adds the update of a child whose rows stand at `places` here, increasing.
    pub fn extend_add(&mut self, child: &Update, places: &[u32]) {
        let (runs, columns) = (runs(places), self.shape.columns);
        // The run that the diagonal is in.
        let mut current = 0;
        for j in 0..child.size {
            if j >= runs[current].1 {
                current += 1;
            }
            let (from, at) = (child.column(j), places[j] as usize);
            let to = match at.checked_sub(columns) {
                None => self.column_mut(at),
                Some(at) => self.update.column_mut(at),
            };
            for &(begin, end) in &runs[current..] {
                let begin = begin.max(j);
                let place = places[begin] as usize - at;
                let to = &mut to[place..place + end - begin];
                for (to, from) in to.iter_mut().zip(&from[begin - j..end - j]) {
                    *to += from;
                }
            }
        }
    }

    /// Eliminates the own columns.
    pub fn eliminate(&mut self) -> Result<(), Failure> {
        let Trapezoid { columns, height } = self.shape;
        let threads = (height * height * columns) as f64 > WORTH_THREADS;
        cholesky_of_strips(self.shape.strips_mut(self.panel))?;
        let panel: Vec<_> = self.shape.strips(self.panel).collect();
        for_all(
            self.update.strips.iter_mut().enumerate().collect(),
            threads,
            |(t, strip)| {
                let height = height - columns - t * STRIP;
                let mut strip =
                    MatMut::from_column_major_slice_mut(strip, height, STRIP.min(height));
                for (_, columns) in &panel {
                    let below = columns.subrows(columns.nrows() - height, height);
                    subtract_square(strip.rb_mut(), below);
                }
            },
        );
        Ok(())
    }
}

/// Ranges of places that follow each other.
fn runs(places: &[u32]) -> Vec<(usize, usize)> {
    let mut runs = Vec::new();
    let mut begin = 0;
    for k in 1..=places.len() {
        if k == places.len() || places[k] != places[k - 1] + 1 {
            runs.push((begin, k));
            begin = k;
        }
    }
    runs
}

/// Zeros, if there is memory: threads ask for it at the same time, so what was promised is what is filled.
fn zeros(len: usize) -> Result<Vec<f64>, Failure> {
    let mut values = Vec::new();
    values
        .try_reserve_exact(len)
        .map_err(|_| Failure::OutOfMemory)?;
    values.resize(len, 0.0);
    Ok(values)
}
