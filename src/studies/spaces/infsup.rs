//! Numerical inf-sup test of the contact spaces (Chapelle & Bathe 1993).
//!
//! ```text
//!   β_h = inf_λ sup_u  b(u, λ) / (‖u‖ ‖λ‖),       b(u, λ) = ∫_Γ λ_h · [[u_h]] dΓ
//!
//!   ‖u‖² = u·A u,  A = K/E + M/L²                 an H¹ norm without a kernel: no supports are needed
//!   ‖λ‖² = λ·C λ,  C = h ∫ φ_i φ_j dΓ             the mesh-dependent norm of H^(−1/2); point pairs: C = h diag(w)
//!   β_h² = least eigenvalue of  G A⁻¹ Gᵀ x = β² C x,     G_k = ∫ φ_k F [[u]] dΓ = w_k B_k
//! ```
//!
//! The interface is tied: n and both tangential components of every multiplier count. A contact space is stable if β_h stays
//! above a positive constant on every sequence of meshes, however the crack lies in them. A finite sample cannot prove
//! that: a space passes here if β_h does not fall faster than h^¼ and never below a tenth of what the space `star` has on a
//! crack along the grid. Tractions of point pairs are measured by C = h diag(w), those of functions by their mass: β
//! of the two kinds compares up to a constant (1.7 for a crack along the grid in 2D, 1.9 in 3D).
//!
//! The bodies are unit squares and cubes made from case files like any other; their supports, which hold standard functions
//! only, are then left out. The norm of the displacement is the energy of its gradient, whatever stress a case may assume.

mod pencil;
mod scene;

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;
use stickslip_methods::{Elastic, ElasticParts, SymmetricMatrix, in_contact};
use stickslip_xfem::enrichment::basis::FunctionKind;
use stickslip_xfem::fields::mass::mass;
use stickslip_xfem::stiffness::assembly::elimination_order;
use stickslip_xfem::stiffness::cell_matrix::CellError;

use crate::case::ContactSpace;
use crate::model::body::{Body, BodyError, Needs, free_rows, numbered};
use crate::run::run_case::Progress;
use crate::studies::convergence;

pub use pencil::{PencilError, eigenvalues};
pub use scene::{LENGTH, SCENES, Scene, YOUNG};

/// Largest d log β / d log h of a space that passes.
pub const LARGEST_SLOPE: f64 = 0.25;

/// Least β of a space that passes, in units of that of `star` on [`Scene::is_reference`] with the same number of cells.
pub const LEAST_SHARE: f64 = 0.1;

/// Eigenvalues below this part of the largest are zero but for rounding.
const ZERO: f64 = 1e-12;

/// A body without an inf-sup number.
#[derive(Debug, thiserror::Error)]
#[error("{scene}, {space}, {cells} cells per axis: {fault}")]
pub struct InfSupError {
    /// Scene.
    pub scene: &'static str,
    /// Contact space.
    pub space: &'static str,
    /// Cells per axis.
    pub cells: usize,
    /// Why.
    #[source]
    pub fault: Box<Fault>,
}

/// Why a body has no inf-sup number.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The body could not be discretised.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// A support holds an enriched function.
    #[error("a support holds an enriched function")]
    Held,
    /// The eigenproblem has no answer.
    #[error(transparent)]
    Pencil(#[from] PencilError),
}

/// β on one mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Cells per axis.
    pub cells: usize,
    /// Cell size L/cells [m].
    pub h: f64,
    /// Displacement unknowns.
    pub unknowns: usize,
    /// Multipliers; every one has `dim` components.
    pub points: usize,
    /// Inf-sup number; 0 if it is rounding.
    pub beta: f64,
    /// Tractions that no displacement feels: dimension of the kernel of Gᵀ.
    pub kernel: usize,
}

/// One contact space on the meshes of one scene.
#[derive(Debug, Clone)]
pub struct Sequence {
    /// The body and its crack.
    pub scene: &'static Scene,
    /// Contact space.
    pub space: ContactSpace,
    /// Coarse to fine.
    pub samples: Vec<Sample>,
    /// d log β / d log h, least squares over all meshes; infinite if some β vanishes, NaN with fewer than two meshes.
    pub slope: f64,
    /// Least β in units of that of `star` on a crack along the grid with the same number of cells.
    pub share: f64,
}

impl Sequence {
    /// Whether the space passes on this crack.
    pub fn is_stable(&self) -> bool {
        // A single mesh has no slope and shows nothing.
        self.slope <= LARGEST_SLOPE && self.share >= LEAST_SHARE
    }
}

/// Runs every scene with every space; `cells` tells which of a scene's meshes are wanted.
///
/// # Errors
/// [`InfSupError`] of the first body that fails, in the order of the result.
pub fn run(
    cells: impl Fn(&Scene) -> Vec<usize>,
    progress: &dyn Progress,
) -> Result<Vec<Sequence>, InfSupError> {
    let mut wanted = Vec::new();
    for scene in &SCENES {
        let cells = cells(scene);
        let spaces = ContactSpace::ALL.into_iter().filter(|_| !cells.is_empty());
        wanted.extend(spaces.map(|space| (scene, space, cells.clone())));
    }
    progress.plan(wanted.iter().map(|sequence| sequence.2.len()).sum());
    let of = |(scene, space, cells): &(&'static Scene, ContactSpace, Vec<usize>)| {
        let one = |n: &usize| {
            let sample = sample(scene, *space, *n);
            progress.done(scene.name);
            sample
        };
        let samples: Vec<Result<Sample, InfSupError>> = cells.par_iter().map(one).collect();
        Ok(Sequence {
            scene,
            space: *space,
            samples: samples.into_iter().collect::<Result<_, _>>()?,
            slope: f64::NAN,
            share: f64::NAN,
        })
    };
    let found: Vec<Result<Sequence, InfSupError>> = wanted.par_iter().map(of).collect();
    let mut sequences = found.into_iter().collect::<Result<Vec<_>, _>>()?;
    judge(&mut sequences);
    Ok(sequences)
}

/// Slopes and shares of all sequences.
fn judge(sequences: &mut [Sequence]) {
    let mut reference: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for s in sequences.iter() {
        if s.scene.is_reference && s.space == ContactSpace::Star {
            reference.extend(s.samples.iter().map(|p| ((s.scene.dim, p.cells), p.beta)));
        }
    }
    for s in sequences {
        s.slope = slope(&s.samples);
        let shares = s.samples.iter().map(|p| {
            let known = reference.get(&(s.scene.dim, p.cells));
            known.map_or(f64::NAN, |r| p.beta / r)
        });
        // NaN where the reference is missing: no space passes then.
        s.share = shares
            .reduce(|a, b| if a < b || a.is_nan() { a } else { b })
            .unwrap_or(f64::NAN);
    }
}

/// d log β / d log h by least squares.
fn slope(samples: &[Sample]) -> f64 {
    if samples.iter().any(|p| p.beta == 0.0) {
        return f64::INFINITY;
    }
    let points: Vec<[f64; 2]> = samples.iter().map(|p| [p.h, p.beta]).collect();
    convergence::slope(&points)
}

/// β of one space on one mesh of a scene.
///
/// # Errors
/// [`InfSupError`].
pub fn sample(scene: &Scene, space: ContactSpace, cells: usize) -> Result<Sample, InfSupError> {
    measure(scene, space, cells).map_err(|fault| InfSupError {
        scene: scene.name,
        space: space.name(),
        cells,
        fault: Box::new(fault),
    })
}

fn measure(scene: &Scene, space: ContactSpace, cells: usize) -> Result<Sample, Fault> {
    let body = Body::new(
        &scene.case(space, cells).map_err(BodyError::from)?,
        1,
        Needs::default(),
    )?;
    let dim = body.mesh.dim();
    let standard = |unknown: &usize| {
        let function = &body.enrichment.functions[unknown / dim];
        function.kind == FunctionKind::Standard
    };
    if !body.prescribed.keys().all(standard) {
        return Err(Fault::Held);
    }
    let h = LENGTH / cells as f64;
    let norm = displacement_norm(&body)?;
    let response = norm.delassus().map_err(BodyError::from)?;
    // G A⁻¹ Gᵀ from B A⁻¹ Bᵀ.
    let weight = |row: usize| body.points[row / dim].weight;
    let m = response.size();
    let mut numerator = vec![0.0; m * m];
    for j in 0..m {
        for e in response.col_ptr()[j]..response.col_ptr()[j + 1] {
            let i = response.row_idx()[e];
            let value = weight(i) * weight(j) * response.values()[e];
            numerator[i * m + j] = value;
            numerator[j * m + i] = value;
        }
    }
    let spectrum = eigenvalues(&numerator, &multiplier_norm(&body, space, h), m)?;
    let largest = spectrum.last().copied().unwrap_or(0.0);
    let kernel = spectrum.iter().filter(|&&v| v <= ZERO * largest).count();
    Ok(Sample {
        cells,
        h,
        unknowns: norm.unknowns(),
        points: body.points.len(),
        beta: if kernel > 0 {
            0.0
        } else {
            spectrum.first().map_or(0.0, |v| v.sqrt())
        },
        kernel,
    })
}

/// A = K/E + M/L² over all unknowns, with the jump operator on them: as the stiffness of a body without supports.
pub fn displacement_norm(body: &Body) -> Result<Arc<Elastic>, BodyError> {
    let integrator = body.integrator();
    let all: Vec<Option<u32>> = (0..body.numbers.len() as u32).map(Some).collect();
    let (col_ptr, row_idx, mut values) = body.stiffness.restrict(&all);
    let (_, same, masses) = mass(&integrator)?.restrict(&all);
    if same != row_idx {
        return Err(CellError {
            at: body.mesh.centre(0),
            reason: "mass and stiffness have different patterns".into(),
        }
        .into());
    }
    for (value, mass) in values.iter_mut().zip(masses) {
        *value = *value / YOUNG + mass / (LENGTH * LENGTH);
    }
    // In the basis of the solver: branch functions within a radius are not independent as they stand.
    let dim = body.mesh.dim();
    let (kept, n) = numbered((0..all.len()).map(|i| !body.basis.drops(dim, i)));
    let columns: Vec<Vec<(usize, f64)>> =
        (0..all.len()).map(|i| body.basis.column(dim, i)).collect();
    let mut sum: Vec<BTreeMap<usize, f64>> = vec![BTreeMap::new(); n];
    for j in 0..all.len() {
        for k in col_ptr[j]..col_ptr[j + 1] {
            let (i, value) = (row_idx[k], values[k]);
            let mirror = (i != j).then_some((j, i));
            for (i, j) in std::iter::once((i, j)).chain(mirror) {
                for &(p, s) in &columns[i] {
                    for &(q, t) in &columns[j] {
                        // The lower triangle, column by column.
                        if let (Some(p), Some(q)) = (kept[p], kept[q])
                            && p >= q
                        {
                            *sum[q as usize].entry(p as usize).or_default() += s * t * value;
                        }
                    }
                }
            }
        }
    }
    let mut ptr = vec![0];
    let (mut rows, mut entries) = (Vec::new(), Vec::new());
    for column in &sum {
        rows.extend(column.keys());
        entries.extend(column.values());
        ptr.push(rows.len());
    }
    let jump: Vec<_> = (body.jump_rows.iter().map(|row| body.basis.row(dim, row))).collect();
    let jump = free_rows(&jump, &kept, n)?;
    let last = in_contact(&jump, dim, false);
    let parts = ElasticParts {
        dim,
        stiffness: SymmetricMatrix::new(n, ptr, rows, entries)?,
        jump,
        weight: body.points.iter().map(|p| p.weight).collect(),
        order: elimination_order(&body.mesh, &body.enrichment, &kept, &last),
        free_order: Vec::new(),
        floating: Vec::new(),
        frictionless: false,
        traction: None,
    };
    Ok(Elastic::new(parts)?)
}

/// C, full and row by row, rows point by point as those of the jump operator [m^dim].
pub fn multiplier_norm(body: &Body, space: ContactSpace, h: f64) -> Vec<f64> {
    let dim = body.mesh.dim();
    let m = dim * body.points.len();
    let mut gram = vec![0.0; m * m];
    let mut add = |k: u32, l: u32, value: f64| {
        for a in 0..dim {
            gram[(k as usize * dim + a) * m + l as usize * dim + a] += h * value;
        }
    };
    if !space.is_integrated() {
        // Point forces: the quadrature of the surface, which is there to draw their tractions, has no part in this space.
        for (k, point) in body.points.iter().enumerate() {
            add(k as u32, k as u32, point.weight);
        }
    } else {
        for q in &body.surface.quadrature {
            for &(k, a) in &q.shares {
                for &(l, b) in &q.shares {
                    add(k, l, q.weight * a * b);
                }
            }
        }
    }
    gram
}
