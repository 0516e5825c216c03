//! From a case to the contact system: mesh, cracks, enrichment, unknowns, stiffness, jump operator.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use stickslip_methods::{
    Elastic, ElasticParts, JumpOperator, MethodError, SymmetricMatrix, in_contact,
};
use stickslip_xfem::contact::facet_samples::facet_samples;
use stickslip_xfem::contact::pairs::{ContactPoint, ContactSurface, CrackSurface, jump_rows};
use stickslip_xfem::contact::surface_point::SurfacePoint;
use stickslip_xfem::contact::traction::{integrated_rows, traction_rows};
use stickslip_xfem::contact::{self, conforming, rank};
use stickslip_xfem::cut::arms::{Joined, arms};
use stickslip_xfem::cut::crack::Crack;
use stickslip_xfem::cut::off_facets::off_facets;
use stickslip_xfem::enrichment::pieces::free_motions;
use stickslip_xfem::enrichment::{Enrichment, EnrichmentError};
use stickslip_xfem::geometry::{Point, add_scaled};
use stickslip_xfem::loads::supports::{Prescribed, Supports};
use stickslip_xfem::material::{Dilatation, Lame};
use stickslip_xfem::mesh::box_mesh::box_mesh;
use stickslip_xfem::mesh::{Lengths, Mesh};
use stickslip_xfem::stiffness::assembly::{Assembly, elimination_order};
use stickslip_xfem::stiffness::block_matrix::BlockMatrix;
use stickslip_xfem::stiffness::cell_matrices::CellMatrices;
use stickslip_xfem::stiffness::cell_matrix::{CellError, CellIntegrator};
use stickslip_xfem::stiffness::orthonormal::SolverBasis;

use crate::case::{Case, CaseError, ContactSpace, CrackSpec, Quadrature};
use crate::model::boundary::supports;
use crate::model::fixed_loads::{FixedLoad, fixed_loads};
use crate::model::memory;
use crate::model::mesh_checks::{MeshChecks, mesh_checks, swaying};
pub use crate::model::refusals::BodyError;
use crate::model::refusals::{cell_error, check_probes, crack_error, motion_error, support_error};

/// A discretised case: everything that does not depend on friction, method or increment.
pub struct Body {
    /// Origin of all coordinates here in those of the case file: [`Case::origin`].
    pub origin: Point,
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
    /// Contact points of all cracks, in case order.
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
    /// The algebraic side: K and B over the free unknowns.
    pub elastic: Arc<Elastic>,
    /// Mesh label, e.g. `22x22`.
    pub label: String,
    /// Contact space with its marks, e.g. `edge-pairs/gauss-6`.
    pub space: String,
    /// By crack of the case file: its contact points are means over multiplier functions, not places.
    pub integrated: Vec<bool>,
    /// Times shared by all runs on the body.
    pub setup: Setup,
    /// Jump operator over all unknowns: rows point by point, (n, a[, b]), as (unknown, coefficient).
    pub jump_rows: Vec<Vec<(usize, f64)>>,
    /// Traction operator over all unknowns, in the same form; empty unless a run [`Needs`] it.
    pub traction_rows: Vec<Vec<(usize, f64)>>,
    /// Ends of cracks that were joined with what they nearly touch.
    pub joined: Vec<Joined>,
    /// Loads whose nodal forces only change in size.
    pub loads: Vec<FixedLoad>,
    /// What the tests on the mesh found.
    pub checks: MeshChecks,
}

/// Where the system of a run comes from: times shared by all runs on it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Setup {
    /// Seconds for mesh, cutting, pattern and ordering; for a file, for reading.
    pub setup_s: f64,
    /// Seconds for cell matrices and their sum.
    pub assembly_s: f64,
    /// Seconds for the traction operator, owed by the runs that need it.
    pub traction_s: f64,
}

/// What the runs on a body will ask of it: a body pays for nothing else.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Needs {
    /// No run has friction: only normal rows are ever condensed.
    pub frictionless: bool,
    /// A method needs the traction operator.
    pub traction: bool,
}

impl Body {
    /// Discretises a case on its mesh refined by a factor.
    pub fn new(case: &Case, refine: usize, needs: Needs) -> Result<Self, BodyError> {
        let clock = Instant::now();
        let spec = case.mesh.grid.refined(refine);
        memory::check(case, &spec)?;
        let cells: Vec<String> = spec
            .lines
            .iter()
            .map(|l| (l.len() - 1).to_string())
            .collect();
        let label = cells.join("x");
        let mut mesh = box_mesh(&spec).map_err(|mut fold| {
            fold.centre = case.place(&fold.centre);
            let allowed = "a motion of the grid points that keeps all cells convex";
            case.error(case.mesh.motion_span(fold.motion), &label, allowed, &fold)
        })?;
        mesh.origin = case.origin;
        let Placed {
            lengths,
            cracks,
            joined,
            doubled,
        } = place_cracks(case, &mut mesh)?;
        let unheld = |e| support_error(case, e);
        let all = supports(case);
        let supports = Supports::new(&all, &mesh).map_err(unheld)?;
        let enrichment = Enrichment::new(&mesh, &lengths, &cracks, &supports.beside(&cracks))
            .map_err(|e| crack_error(case, &e))?;
        let lame = case.lame();
        let integrator = CellIntegrator {
            mesh: &mesh,
            cracks: &cracks,
            enrichment: &enrichment,
            quadrature: case.quadrature,
            lame,
        };
        let fixed = supports.prescribed(&integrator).map_err(unheld)?;
        check_probes(case, &mesh, &enrichment)?;
        let dim = mesh.dim();
        let unknowns = 0..enrichment.functions.len() * dim;
        let (numbers, _) = numbered(unknowns.map(|i| !fixed.contains_key(&i)));
        let assembly = Assembly::new(dim, &enrichment);
        let mut setup_s = clock.elapsed().as_secs_f64();

        let unfilled = |e: CellError| cell_error(case, &cracks, e);
        let clock = Instant::now();
        let mut matrices = CellMatrices::new(&integrator).map_err(unfilled)?;
        let stiffness = assembly.sum(|cell| matrices.of(cell));
        let basis = SolverBasis::new(
            &mesh,
            &enrichment,
            &assembly.users,
            |cell| matrices.of(cell),
            |f, a| numbers[f * dim + a].is_none(),
        );
        let kept = (0..numbers.len()).map(|i| numbers[i].is_some() && !basis.drops(dim, i));
        let (solver_numbers, free) = numbered(kept);
        let transformed = if basis.is_identity() {
            None
        } else {
            matrices.transform(&integrator, &basis);
            Some(assembly.sum(|cell| matrices.of(cell)))
        };
        // On large meshes they are most of the memory.
        drop((assembly, matrices));
        let in_basis = transformed.as_ref().unwrap_or(&stiffness);
        let (col_ptr, row_idx, values) = in_basis.restrict(&solver_numbers);
        let diagonal = in_basis.diagonal();
        drop(transformed);
        let assembly_s = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let scaled = |row: &[(usize, f64)]| -> Vec<(usize, f64)> {
            let row = basis.row(dim, row).into_iter();
            let free = row.filter(|(i, _)| solver_numbers[*i].is_some());
            free.map(|(i, v)| (i, v / diagonal[i].sqrt())).collect()
        };
        let ContactSurface { points, surface } =
            faces(case, &integrator, &lengths, doubled, &numbers, scaled)?;
        let samples = facet_samples(&integrator).map_err(unfilled)?;
        let jump = jump_rows(dim, &points);
        let spaces = case.cracks.iter().map(|spec| spec.contact);
        let integrated: Vec<bool> = spaces.map(ContactSpace::is_integrated).collect();
        let traction_clock = Instant::now();
        let traction = if needs.traction {
            traction(&integrated, &integrator, &points, &surface).map_err(unfilled)?
        } else {
            Vec::new()
        };
        let traction_s = traction_clock.elapsed().as_secs_f64();
        let mut motions = free_motions(&mesh, &enrichment, &numbers, |mode| products(&jump, mode))
            .map_err(|e| motion_error(case, &integrator, &surface, &e))?;
        let rows = |rows: &[Vec<(usize, f64)>]| {
            let rows: Vec<_> = rows.iter().map(|row| basis.row(dim, row)).collect();
            free_rows(&rows, &solver_numbers, free)
        };
        for mode in &mut motions {
            basis.solver_unknowns(dim, mode);
            let kept = (0..mode.len()).filter(|&i| solver_numbers[i].is_some());
            *mode = kept.map(|i| mode[i]).collect();
        }
        let jump_of_free = rows(&jump)?;
        let last = in_contact(&jump_of_free, dim, needs.frictionless);
        let order = |last: &[bool]| elimination_order(&mesh, &enrichment, &solver_numbers, last);
        let (order, free_order) = (order(&last), order(&vec![false; free]));
        setup_s += clock.elapsed().as_secs_f64() - traction_s;
        let elastic = Elastic::new(ElasticParts {
            dim,
            stiffness: SymmetricMatrix::new(free, col_ptr, row_idx, values)?,
            jump: jump_of_free,
            weight: points.iter().map(|p| p.weight).collect(),
            order,
            free_order,
            floating: motions,
            frictionless: needs.frictionless,
            traction: needs.traction.then(|| rows(&traction)).transpose()?,
        });
        let elastic = match elastic {
            // Pieces are found by what cracks leave whole: their motions are rigid unless a crack was bent.
            Err(MethodError::NotRigid { .. }) if !cracks.is_empty() => {
                let crack = cracks.iter().map(|c| c.number).max().unwrap_or(0);
                return Err(crack_error(case, &EnrichmentError::Bent(crack)).into());
            }
            other => other?,
        };
        let loads = fixed_loads(case, &integrator, &points, needs.traction)?;
        let space = space_name(case, &cracks);
        let mut body = Body {
            origin: case.origin,
            quadrature: case.quadrature,
            lame,
            points,
            surface,
            samples,
            stiffness,
            numbers,
            basis,
            solver_numbers,
            prescribed: fixed,
            elastic,
            label,
            space,
            integrated,
            setup: Setup {
                setup_s,
                assembly_s,
                traction_s,
            },
            jump_rows: jump,
            joined,
            traction_rows: traction,
            loads,
            mesh,
            cracks,
            enrichment,
            checks: MeshChecks::default(),
        };
        body.checks = mesh_checks(&body);
        Ok(body)
    }

    /// What is wrong with the mesh, if anything is; inexact quadrature is asked for, and marked. `sway`: see
    /// [`Residuals`](stickslip_methods::Residuals).
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

    /// Contact forces that the stress implies, in local frames, from all unknowns [N, in 2D N/m]; empty without a
    /// traction operator.
    pub fn traction(&self, all: &[f64]) -> Vec<f64> {
        products(&self.traction_rows, all)
    }

    /// A place as the case file has it [m].
    pub fn place(&self, x: &Point) -> Point {
        add_scaled(x, 1.0, &self.origin)
    }
}

/// Contact surfaces of all cracks, without points that no displacement can tell from others. `doubled`: that of a
/// crack that split the mesh; `scaled`: a row of the jump operator over the free unknowns of the solver, divided by the roots of their
/// stiffness.
fn faces(
    case: &Case,
    integrator: &CellIntegrator<'_>,
    lengths: &Lengths,
    doubled: Option<ContactSurface>,
    numbers: &[Option<u32>],
    scaled: impl Fn(&[(usize, f64)]) -> Vec<(usize, f64)>,
) -> Result<ContactSurface, BodyError> {
    let (dim, cracks) = (integrator.mesh.dim(), integrator.cracks);
    let held = |unknown: usize| numbers[unknown].is_none();
    let mut surface = match doubled {
        Some(own) => own.retain(|point| point.acts(dim, held)),
        None => ContactSurface::default(),
    };
    // Points of the arms whose space is integrated.
    let mut arms: Vec<std::ops::Range<usize>> = Vec::new();
    for (number, spec) in case.cracks.iter().enumerate() {
        // The arms of a crack one after the other.
        let own = (0..cracks.len()).filter(|&index| cracks[index].number == number);
        for index in own {
            let start = surface.points.len();
            surface.append(contact::surface(integrator, index, spec.contact, held)?);
            if spec.contact.is_integrated() {
                arms.push(start..surface.points.len());
            }
        }
    }
    let rows = |point: &[ContactPoint]| {
        let rows = jump_rows(dim, point);
        rows.iter().map(|row| scaled(row)).collect()
    };
    let size = lengths.smallest.powi(dim as i32 - 1);
    for (least, anywhere) in [(rank::HAIR, false), (rank::NOTHING, true)] {
        let hairs = rank::hairs(&surface, &arms, least * size);
        arms = rank::merge(&mut surface, &arms, &hairs, anywhere).0;
    }
    loop {
        let weight = |k: usize| surface.points[k].weight;
        let lost = rank::dependent(&arms, weight, |k| rows(&surface.points[k..=k]));
        if lost.is_empty() {
            break;
        }
        let (fewer, merged) = rank::merge(&mut surface, &arms, &lost, false);
        arms = fewer;
        if merged == 0 {
            if let Some(&point) = rank::singular(&arms, |k| rows(&surface.points[k..=k])).first() {
                let crack = surface.points[point].crack;
                return Err(crack_error(case, &EnrichmentError::Undetermined(crack)).into());
            }
            break;
        }
    }
    for number in 0..case.cracks.len() {
        if !surface.points.iter().any(|p| p.crack == number) {
            return Err(crack_error(case, &EnrichmentError::TooShort(number)).into());
        }
    }
    Ok(surface)
}

/// Traction operator: by the stress at the points, or integrated where the jump is.
fn traction(
    integrated: &[bool],
    integrator: &CellIntegrator<'_>,
    points: &[ContactPoint],
    surface: &CrackSurface,
) -> Result<Vec<Vec<(usize, f64)>>, CellError> {
    let dim = integrator.mesh.dim();
    let inside = surface
        .quadrature
        .iter()
        .filter(|q| integrated[q.crack])
        .cloned();
    let mut rows = integrated_rows(integrator, points.len(), &inside.collect::<Vec<_>>())?;
    let at_places = points
        .iter()
        .enumerate()
        .filter(|(_, p)| !integrated[p.crack]);
    let (numbers, own): (Vec<usize>, Vec<ContactPoint>) =
        at_places.map(|(i, p)| (i, p.clone())).unzip();
    for (i, block) in numbers
        .into_iter()
        .zip(traction_rows(integrator, &own)?.chunks(dim))
    {
        rows[i * dim..(i + 1) * dim].clone_from_slice(block);
    }
    Ok(rows)
}

/// Contact spaces of the cracks, each named once, with marks for inexact quadrature and for the mean dilatation in every cell.
fn space_name(case: &Case, cracks: &[Crack]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for spec in &case.cracks {
        if !names.contains(&spec.contact.name()) {
            names.push(spec.contact.name());
        }
    }
    let mut name = names.join("+");
    if let (Quadrature::Gauss(n), false) = (case.quadrature, cracks.is_empty()) {
        name += &format!("/gauss-{n}");
    }
    if case.dilatation == Some(Dilatation::Mean) {
        name += "/mean-dilatation";
    }
    name
}

/// Cracks in a mesh.
struct Placed {
    lengths: Lengths,
    cracks: Vec<Crack>,
    joined: Vec<Joined>,
    doubled: Option<ContactSurface>,
}

/// The arms of the cracks, and the surface of one that splits the mesh along its facets, if that was asked for.
fn place_cracks(case: &Case, mesh: &mut Mesh) -> Result<Placed, CaseError> {
    let refused = |e: EnrichmentError| crack_error(case, &e);
    let lengths = mesh.lengths();
    let pairs = |spec: &&CrackSpec| spec.contact == ContactSpace::NodePairs;
    if let Some(spec) = case.cracks.iter().find(pairs) {
        if case.cracks.len() > 1 {
            let allowed = "edge-pairs, facet, star or p0 beside other cracks";
            let message = "node pairs stand for a crack that is alone in its body";
            return Err(case.refuse(&spec.contact_span, allowed, message));
        }
        let crack = Crack::new(0, &spec.geometry, spec.tip, mesh, &lengths);
        let surface = conforming::split(mesh, &crack).map_err(refused)?;
        return Ok(Placed {
            lengths: mesh.lengths(),
            cracks: Vec::new(),
            joined: Vec::new(),
            doubled: Some(surface),
        });
    }
    let cracks: Vec<_> = case.cracks.iter().map(|c| (&c.geometry, c.tip)).collect();
    let cracks = off_facets(mesh, &lengths, &cracks).map_err(|e| refused(e.into()))?;
    let (cracks, joined) = arms(cracks, mesh, &lengths).map_err(|e| refused(e.into()))?;
    Ok(Placed {
        lengths,
        cracks,
        joined,
        doubled: None,
    })
}

/// Numbers those that are kept, in their order, and counts them.
pub(crate) fn numbered(kept: impl Iterator<Item = bool>) -> (Vec<Option<u32>>, usize) {
    let mut count = 0;
    let number = |kept: bool| {
        kept.then(|| {
            count += 1;
            count - 1
        })
    };
    let numbers = kept.map(number).collect();
    (numbers, count as usize)
}

/// Products of sparse rows with a vector.
fn products(rows: &[Vec<(usize, f64)>], x: &[f64]) -> Vec<f64> {
    rows.iter()
        .map(|row| row.iter().map(|&(i, v)| v * x[i]).sum())
        .collect()
}

/// Sparse rows over the free unknowns.
pub(crate) fn free_rows(
    rows: &[Vec<(usize, f64)>],
    numbers: &[Option<u32>],
    free: usize,
) -> Result<JumpOperator, MethodError> {
    let mut row_ptr = vec![0];
    let (mut col_idx, mut values) = (Vec::new(), Vec::new());
    for row in rows {
        for &(i, v) in row {
            if let Some(n) = numbers[i] {
                col_idx.push(n as usize);
                values.push(v);
            }
        }
        row_ptr.push(col_idx.len());
    }
    JumpOperator::new(rows.len(), free, row_ptr, col_idx, values)
}
