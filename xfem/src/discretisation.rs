//! From plain values to a discrete body: mesh, cracks cut, functions, supports, stiffness, contact points.

mod faces;
pub mod mesh_checks;
pub mod norms;
pub mod tips;

use std::collections::BTreeMap;
use std::time::Instant;

use crate::contact::pairs::{ContactPoint, ContactSurface, CrackSurface, jump_rows};
use crate::contact::surface_point::SurfacePoint;
use crate::contact::{ContactSpace, conforming, facet_samples, traction};
use crate::cut::arrangement::{Arrangement, Moved};
use crate::cut::crack::{Crack, Tip};
use crate::cut::solid_arms::solid_arms;
use crate::enrichment::pieces::{MotionError, free_motions};
use crate::enrichment::{Enrichment, EnrichmentError};
use crate::geometry::crack_shape::CrackShape;
use crate::geometry::{Point, add_scaled, norm};
use crate::loads::supports::{Prescribed, Support, SupportError, Supports};
use crate::material::Lame;
use crate::mesh::box_mesh::{FoldedCell, GridSpec, box_mesh};
use crate::mesh::{Lengths, Mesh};
use crate::quadrature::Quadrature;
use crate::stiffness::assembly::{Assembly, elimination_order};
use crate::stiffness::block_matrix::BlockMatrix;
use crate::stiffness::cell_matrices::CellMatrices;
use crate::stiffness::cell_matrix::{CellError, CellIntegrator};
use crate::stiffness::orthonormal::SolverBasis;

use self::mesh_checks::{MeshChecks, mesh_checks, swaying};

/// Sources of a discretised body.
pub struct Plan<'a> {
    /// Grid of the mesh.
    pub grid: &'a GridSpec,
    /// Zero of its coordinates in those of the user [m].
    pub origin: Point,
    /// Cracks; one of node pairs is alone.
    pub cracks: Vec<CrackPlan<'a>>,
    /// Supports.
    pub supports: &'a [Support<'a>],
    /// Material.
    pub lame: Lame,
    /// Quadrature of cut cells.
    pub quadrature: Quadrature,
}

/// A crack as it is asked for.
#[derive(Debug, Clone, Copy)]
pub struct CrackPlan<'a> {
    /// Place and shape.
    pub shape: &'a CrackShape,
    /// Enrichment at tips inside the body.
    pub tip: Tip,
    /// Contact space.
    pub contact: ContactSpace,
}

/// A discrete body: everything that does not depend on friction, method or increment.
pub struct Discretisation {
    /// Mesh, with doubled nodes where a crack of node pairs runs along its facets.
    pub mesh: Mesh,
    /// Cracks through cells.
    pub cracks: Vec<Crack>,
    /// Functions.
    pub enrichment: Enrichment,
    /// Quadrature of cut cells.
    pub quadrature: Quadrature,
    /// Material.
    pub lame: Lame,
    /// Contact points of all cracks, in their order.
    pub points: Vec<ContactPoint>,
    /// Faces of the cracks.
    pub surface: CrackSurface,
    /// Samples of the cracks through cells, much closer than the contact points.
    pub samples: Vec<SurfacePoint>,
    /// Stiffness over all unknowns.
    pub stiffness: BlockMatrix,
    /// Number of every unknown among the free ones; `None`: prescribed.
    pub numbers: Vec<Option<u32>>,
    /// Basis in which the solver works.
    pub basis: SolverBasis,
    /// Number of every unknown of that basis among the solver's; `None`: prescribed or dropped.
    pub solver_numbers: Vec<Option<u32>>,
    /// Prescribed unknowns.
    pub prescribed: BTreeMap<usize, Prescribed>,
    /// By crack of the plan: its contact points are means over multiplier functions, not places.
    pub integrated: Vec<bool>,
    /// Jump operator over all unknowns: rows point by point, (n, a[, b]), as (unknown, coefficient).
    pub jump_rows: Vec<Vec<(usize, f64)>>,
    /// What of cracks is not where it was put.
    pub moved: Vec<Moved>,
    /// Findings of the tests on the mesh.
    pub checks: MeshChecks,
}

/// The body as the solver takes it, over its unknowns, and what it took to get there.
pub struct Reduced {
    /// Stiffness: column pointers, rows, values.
    pub stiffness: (Vec<usize>, Vec<usize>, Vec<f64>),
    /// Rigid motions of pieces that only contact resists.
    pub motions: Vec<Vec<f64>>,
    /// Seconds for mesh, cutting, pattern, contact points.
    pub setup_s: f64,
    /// Seconds for cell matrices and their sum.
    pub assembly_s: f64,
}

/// A plan that cannot be discretised; places are those of the mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DiscretisationError {
    /// Moved grid points fold a cell over.
    #[error(transparent)]
    Folded(#[from] FoldedCell),
    /// A support cannot be held.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// A mesh cannot carry a crack.
    #[error(transparent)]
    Crack(#[from] EnrichmentError),
    /// A cell cannot be integrated; with the number of the crack nearest to it.
    #[error("{0}")]
    Cell(CellError, Option<usize>),
    /// The body can move, and no crack would open.
    #[error(transparent)]
    Moves(#[from] MotionError),
}

/// Discretises a body.
///
/// # Errors
/// See [`DiscretisationError`].
pub fn discretise(plan: &Plan<'_>) -> Result<(Discretisation, Reduced), DiscretisationError> {
    let clock = Instant::now();
    let mut mesh = box_mesh(plan.grid)?;
    mesh.origin = plan.origin;
    let Placed {
        lengths,
        cracks,
        arrangement,
        moved,
        doubled,
    } = place_cracks(&plan.cracks, &mut mesh)?;
    let supports = Supports::new(plan.supports, &mesh)?;
    let enrichment = Enrichment::new(
        &mesh,
        &lengths,
        (&cracks, arrangement),
        &supports.beside(&cracks),
    )?;
    let integrator = CellIntegrator {
        mesh: &mesh,
        cracks: &cracks,
        enrichment: &enrichment,
        quadrature: plan.quadrature,
        lame: plan.lame,
    };
    let prescribed = supports.prescribed(&integrator)?;
    let dim = mesh.dim();
    let unknowns = 0..enrichment.functions.len() * dim;
    let numbers = numbered(unknowns.map(|i| !prescribed.contains_key(&i)));
    let assembly = Assembly::new(dim, &enrichment);
    let mut setup_s = clock.elapsed().as_secs_f64();

    let broken = |error: CellError| {
        let crack = nearest(&cracks, &error.at);
        DiscretisationError::Cell(error, crack)
    };
    let clock = Instant::now();
    let solved = solver_stiffness(&integrator, assembly, &numbers).map_err(broken)?;
    let assembly_s = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let (basis, solver_numbers) = (solved.basis, solved.numbers);
    let scaled = |row: &[(usize, f64)]| -> Vec<(usize, f64)> {
        let row = basis.row(dim, row).into_iter();
        let free = row.filter(|(i, _)| solver_numbers[*i].is_some());
        free.map(|(i, v)| (i, v / solved.diagonal[i].sqrt()))
            .collect()
    };
    let spaces: Vec<ContactSpace> = plan.cracks.iter().map(|crack| crack.contact).collect();
    let ContactSurface { points, surface } =
        faces::faces(&spaces, &integrator, &lengths, doubled, &numbers, scaled)?;
    let samples = facet_samples::facet_samples(&integrator).map_err(broken)?;
    let jump = jump_rows(dim, &points);
    let mut motions = free_motions(&mesh, &enrichment, &numbers, |mode| products(&jump, mode))
        .map_err(|e| loose(&integrator, &surface, e))?;
    for mode in &mut motions {
        basis.solver_unknowns(dim, mode);
        let kept = (0..mode.len()).filter(|&i| solver_numbers[i].is_some());
        *mode = kept.map(|i| mode[i]).collect();
    }
    setup_s += clock.elapsed().as_secs_f64();
    let body = Discretisation {
        quadrature: plan.quadrature,
        lame: plan.lame,
        points,
        surface,
        samples,
        stiffness: solved.all,
        numbers,
        basis,
        solver_numbers,
        prescribed,
        integrated: spaces.iter().map(|space| space.is_integrated()).collect(),
        jump_rows: jump,
        moved,
        mesh,
        cracks,
        enrichment,
        checks: MeshChecks::default(),
    };
    let reduced = Reduced {
        stiffness: solved.free,
        motions,
        setup_s,
        assembly_s,
    };
    Ok((body, reduced))
}

impl Discretisation {
    /// Tests the mesh.
    pub fn check(&mut self) {
        self.checks = mesh_checks(self);
    }

    /// Fault of the mesh, if there is one; inexact quadrature is asked for, and marked. `sway`: how many times as far
    /// slender parts move as stiff cells deform.
    pub fn suspect(&self, sway: f64) -> Option<String> {
        match self.quadrature {
            Quadrature::SubCells => self.checks.reason().or_else(|| swaying(sway)),
            Quadrature::Gauss(_) => None,
        }
    }

    /// Integrator over the cells.
    pub fn integrator(&self) -> CellIntegrator<'_> {
        CellIntegrator {
            mesh: &self.mesh,
            cracks: &self.cracks,
            enrichment: &self.enrichment,
            quadrature: self.quadrature,
            lame: self.lame,
        }
    }

    /// Jump at the contact points in local frames (n, a[, b]) from all unknowns [m].
    pub fn jump(&self, all: &[f64]) -> Vec<f64> {
        products(&self.jump_rows, all)
    }

    /// Traction operator over all unknowns, in the form of the jump operator: by the stress at the points, or integrated where
    /// the jump is.
    ///
    /// # Errors
    /// A cell that cannot be integrated.
    pub fn traction_rows(&self) -> Result<Vec<Vec<(usize, f64)>>, CellError> {
        let dim = self.mesh.dim();
        let integrated = |crack: usize| self.integrated[crack];
        let quadrature = self.surface.quadrature.iter();
        let inside: Vec<SurfacePoint> = quadrature
            .filter(|q| integrated(q.crack))
            .cloned()
            .collect();
        let integrator = self.integrator();
        let mut rows = traction::integrated_rows(&integrator, self.points.len(), &inside)?;
        let at_places = (self.points.iter().enumerate()).filter(|(_, p)| !integrated(p.crack));
        let (numbers, own): (Vec<usize>, Vec<ContactPoint>) =
            at_places.map(|(i, p)| (i, p.clone())).unzip();
        let blocks = traction::traction_rows(&integrator, &own)?;
        for (i, block) in numbers.into_iter().zip(blocks.chunks(dim)) {
            rows[i * dim..(i + 1) * dim].clone_from_slice(block);
        }
        Ok(rows)
    }

    /// Elimination order of the solver's unknowns.
    pub fn elimination_order(&self) -> Vec<usize> {
        elimination_order(&self.mesh, &self.enrichment, &self.solver_numbers)
    }

    /// Number of the crack nearest to a place.
    pub fn nearest(&self, x: &Point) -> Option<usize> {
        nearest(&self.cracks, x)
    }

    /// A place as the user has it [m].
    pub fn place(&self, x: &Point) -> Point {
        add_scaled(x, 1.0, &self.mesh.origin)
    }
}

fn nearest(cracks: &[Crack], x: &Point) -> Option<usize> {
    let away = |crack: &&Crack| crack.distance(x).abs();
    let nearest = cracks.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.map(|crack| crack.number)
}

/// Products of sparse rows with a vector.
pub fn products(rows: &[Vec<(usize, f64)>], x: &[f64]) -> Vec<f64> {
    rows.iter()
        .map(|row| row.iter().map(|&(i, v)| v * x[i]).sum())
        .collect()
}

/// Numbers those that are kept, in their order.
fn numbered(kept: impl Iterator<Item = bool>) -> Vec<Option<u32>> {
    let mut count = 0;
    let number = |kept: bool| {
        kept.then(|| {
            count += 1;
            count - 1
        })
    };
    kept.map(number).collect()
}

/// Cracks in a mesh.
struct Placed {
    lengths: Lengths,
    cracks: Vec<Crack>,
    arrangement: Arrangement,
    moved: Vec<Moved>,
    doubled: Option<ContactSurface>,
}

/// The arms of the cracks, and the surface of one that splits the mesh along its facets, if that was asked for.
fn place_cracks(plan: &[CrackPlan<'_>], mesh: &mut Mesh) -> Result<Placed, EnrichmentError> {
    let lengths = mesh.lengths();
    let pairs = |crack: &CrackPlan<'_>| crack.contact == ContactSpace::NodePairs;
    let pairs = plan.iter().any(pairs);
    let own = plan.iter().enumerate();
    let new = |(k, own): (usize, &CrackPlan<'_>)| Crack::new(k, own.shape, own.tip, mesh, &lengths);
    let whole: Vec<Crack> = own.map(new).collect();
    let (mut arrangement, mut cracks) = match mesh.dim() {
        2 => Arrangement::new(mesh, &lengths, &whole)?,
        _ => solid_arms(&whole, mesh, &lengths),
    };
    let moved = std::mem::take(&mut arrangement.moved);
    let doubled = match pairs {
        true => Some(conforming::split(
            mesh,
            &std::mem::take(&mut cracks),
            &std::mem::take(&mut arrangement),
        )?),
        false => None,
    };
    Ok(Placed {
        lengths: mesh.lengths(),
        cracks,
        arrangement,
        moved,
        doubled,
    })
}

/// Stiffness over all unknowns and in the basis of the solver.
struct SolverStiffness {
    all: BlockMatrix,
    basis: SolverBasis,
    numbers: Vec<Option<u32>>,
    free: (Vec<usize>, Vec<usize>, Vec<f64>),
    diagonal: Vec<f64>,
}

fn solver_stiffness(
    integrator: &CellIntegrator<'_>,
    assembly: Assembly<'_>,
    numbers: &[Option<u32>],
) -> Result<SolverStiffness, CellError> {
    let (mesh, enrichment) = (integrator.mesh, integrator.enrichment);
    let dim = mesh.dim();
    let mut matrices = CellMatrices::new(integrator)?;
    let all = assembly.sum(|cell| matrices.of(cell));
    let basis = SolverBasis::new(
        mesh,
        enrichment,
        &assembly.users,
        |cell| matrices.of(cell),
        |f, a| numbers[f * dim + a].is_none(),
    );
    let kept = (0..numbers.len()).map(|i| numbers[i].is_some() && !basis.drops(dim, i));
    let solver_numbers = numbered(kept);
    let transformed = (!basis.is_identity()).then(|| {
        matrices.transform(integrator, &basis);
        assembly.sum(|cell| matrices.of(cell))
    });
    // On large meshes they are most of the memory.
    drop((assembly, matrices));
    let in_basis = transformed.as_ref().unwrap_or(&all);
    Ok(SolverStiffness {
        free: in_basis.restrict(&solver_numbers),
        diagonal: in_basis.diagonal(),
        all,
        basis,
        numbers: solver_numbers,
    })
}

/// Lack of a body that can move: contact points on a crack that its motions open, or supports.
fn loose(
    integrator: &CellIntegrator<'_>,
    surface: &CrackSurface,
    error: MotionError,
) -> DiscretisationError {
    /// Motions are of order one.
    const OPEN: f64 = 1e-6;
    /// As many points as tell the motions of a piece, and one more.
    const POINTS: f64 = 4.0;
    let opened = |motion: &Vec<f64>| {
        let points = surface.quadrature.iter();
        let open = points.filter(|q| norm(&q.jump(integrator, motion)) > OPEN);
        let open: Vec<_> = open.collect();
        let measure: f64 = open.iter().map(|q| q.weight).sum();
        let edge = measure.powf(1.0 / (integrator.mesh.dim() as f64 - 1.0));
        // Those at hand do not.
        let finer = 0.5 * integrator.enrichment.lengths.smallest;
        open.first().map(|q| EnrichmentError::Loose {
            crack: q.crack,
            at: q.x,
            cell: finer.min(edge / POINTS),
        })
    };
    match error.motions.iter().find_map(opened) {
        Some(loose) => loose.into(),
        None => error.into(),
    }
}
