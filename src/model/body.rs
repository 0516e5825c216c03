//! From a case to the contact system: the discretisation, then K and B over the free unknowns.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;
use std::time::Instant;

use stickslip_methods::{Elastic, ElasticParts, JumpOperator, MethodError, SquareMatrix};
use stickslip_xfem::discretisation::{
    CrackPlan, Discretisation, Plan, Reduced, discretise, products,
};
use stickslip_xfem::enrichment::EnrichmentError;
use stickslip_xfem::enrichment::basis::FunctionKind;
use stickslip_xfem::material::Dilatation;

use crate::case::{Case, Quadrature};
use crate::model::boundary::supports;
use crate::model::fixed_loads::{FixedLoad, fixed_loads};
use crate::model::memory;
pub use crate::model::refusals::BodyError;
use crate::model::refusals::{cell_error, check_pairs, check_probes, crack_error, refused};

/// A case as a contact system: everything that does not depend on friction, method or increment. It is its
/// [`Discretisation`], too.
pub struct Body {
    /// Mesh, functions, contact points.
    pub discrete: Discretisation,
    /// The algebraic side: K and B over the free unknowns.
    pub elastic: Arc<Elastic>,
    /// Mesh label, e.g. `22x22`.
    pub label: String,
    /// Contact space with its marks, e.g. `edge-pairs/gauss-6`.
    pub space: String,
    /// Times shared by all runs on the body.
    pub setup: Setup,
    /// Traction operator over all unknowns: rows as those of the jump operator; empty unless a run [`Needs`] it.
    pub traction_rows: Vec<Vec<(usize, f64)>>,
    /// Loads whose nodal forces only change in size.
    pub loads: Vec<FixedLoad>,
}

impl Deref for Body {
    type Target = Discretisation;

    fn deref(&self) -> &Discretisation {
        &self.discrete
    }
}

impl DerefMut for Body {
    fn deref_mut(&mut self) -> &mut Discretisation {
        &mut self.discrete
    }
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

/// Demands of the runs on a body: it pays for nothing else.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Needs {
    /// Cracks on which no run has friction: only their normal rows are ever condensed. Empty: none.
    pub frictionless: Vec<bool>,
    /// A method needs the traction operator.
    pub traction: bool,
}

impl Body {
    /// Discretises a case on its mesh refined by a factor.
    ///
    /// # Errors
    /// Fault of the case that only the discretisation finds, at its place in the file.
    pub fn new(case: &Case, refine: usize, needs: &Needs) -> Result<Self, BodyError> {
        let grid = case.mesh.grid.refined(refine);
        memory::check(case, &grid)?;
        check_pairs(case)?;
        let cells = grid.lines.iter().map(|l| (l.len() - 1).to_string());
        let label = cells.collect::<Vec<_>>().join("x");
        let plan = Plan {
            grid: &grid,
            origin: case.origin,
            cracks: (case.cracks.iter())
                .map(|spec| CrackPlan {
                    shape: &spec.geometry,
                    tip: spec.tip,
                    contact: spec.contact,
                })
                .collect(),
            supports: &supports(case),
            lame: case.lame(),
            quadrature: case.quadrature,
        };
        let (mut discrete, reduced) = discretise(&plan).map_err(|e| refused(case, &label, e))?;
        check_probes(case, &discrete.mesh, &discrete.enrichment)?;
        let mut setup = Setup {
            setup_s: reduced.setup_s,
            assembly_s: reduced.assembly_s,
            traction_s: 0.0,
        };
        let mut traction_rows = Vec::new();
        if needs.traction {
            let clock = Instant::now();
            let rows = discrete.traction_rows();
            traction_rows = rows.map_err(|e| cell_error(case, discrete.nearest(&e.at), e))?;
            setup.traction_s = clock.elapsed().as_secs_f64();
        }
        let elastic = system(&discrete, reduced, needs, &traction_rows, &mut setup);
        // Pieces are found by what cracks leave whole: their motions are rigid unless a crack was bent.
        let elastic = elastic.map_err(|error| singular(case, &discrete, error))?;
        let loads = fixed_loads(
            case,
            &discrete.integrator(),
            &discrete.points,
            needs.traction,
        )?;
        discrete.check();
        Ok(Body {
            space: space_name(case, !discrete.cracks.is_empty()),
            discrete,
            elastic,
            label,
            setup,
            traction_rows,
            loads,
        })
    }

    /// Factors the stiffness.
    ///
    /// # Errors
    /// The crack next to which it is singular. All else is for every method to tell.
    pub fn factorise(&self, case: &Case) -> Result<(), BodyError> {
        self.definite(case, self.elastic.factorise())
    }

    /// Factors the stiffness next to the cracks, all else held: a motion that costs nothing is one of pieces that cracks leave.
    ///
    /// # Errors
    /// Those of [`factorise`](Self::factorise).
    pub fn check_rank(&self, case: &Case) -> Result<(), BodyError> {
        let (mesh, functions) = (&self.mesh, &self.enrichment.functions);
        let mut near = vec![false; mesh.nodes.len()];
        let enriched = functions
            .iter()
            .filter(|f| f.kind != FunctionKind::Standard);
        enriched.for_each(|f| near[f.node as usize] = true);
        let cut = |cell: &usize| mesh.cell(*cell).iter().any(|&n| near[n as usize]);
        let nodes = mesh.nodes_of((0..mesh.cell_count()).filter(cut));
        let numbers = self.solver_numbers.iter().enumerate();
        let own = numbers.filter(|(i, _)| nodes.contains(&functions[i / mesh.dim()].node));
        let mut own: Vec<usize> = own.filter_map(|(_, n)| Some((*n)? as usize)).collect();
        own.sort_unstable();
        self.definite(case, self.elastic.try_part(&own))
    }

    fn definite(&self, case: &Case, factored: Result<(), MethodError>) -> Result<(), BodyError> {
        match factored {
            Err(error @ MethodError::NotPositiveDefinite { .. }) if !self.cracks.is_empty() => {
                Err(singular(case, self, error))
            }
            _ => Ok(()),
        }
    }

    /// Contact forces that the stress implies, in local frames, from all unknowns [N, in 2D N/m]; empty without a
    /// traction operator.
    pub fn traction(&self, all: &[f64]) -> Vec<f64> {
        products(&self.traction_rows, all)
    }
}

/// A fault of the stiffness, at the crack next to it.
fn singular(case: &Case, discrete: &Discretisation, error: MethodError) -> BodyError {
    let (MethodError::NotPositiveDefinite { unknown, .. } | MethodError::NotRigid { unknown, .. }) =
        error
    else {
        return error.into();
    };
    let own = |number: &Option<u32>| number.is_some_and(|n| n as usize == unknown);
    let place = discrete.solver_numbers.iter().position(own);
    let function = place.map(|i| discrete.enrichment.functions[i / discrete.mesh.dim()]);
    let at = function.map(|f| discrete.mesh.nodes[f.node as usize]);
    match at.and_then(|at| Some((discrete.nearest(&at)?, at))) {
        Some((crack, at)) => {
            let cell = 0.5 * discrete.mesh.smallest_edge();
            crack_error(case, &EnrichmentError::Singular { crack, at, cell }).into()
        }
        None => error.into(),
    }
}

/// K, B and, where a method needs it, the traction operator over the free unknowns, with the order in which K is factored.
fn system(
    discrete: &Discretisation,
    reduced: Reduced,
    needs: &Needs,
    traction: &[Vec<(usize, f64)>],
    setup: &mut Setup,
) -> Result<Arc<Elastic>, MethodError> {
    let clock = Instant::now();
    let dim = discrete.mesh.dim();
    let (col_ptr, row_idx, values) = reduced.stiffness;
    let free = col_ptr.len() - 1;
    let jump = free_rows(discrete, free, &discrete.jump_rows)?;
    let of_point = |crack: usize| needs.frictionless.get(crack) == Some(&true);
    let frictionless: Vec<bool> = (discrete.points.iter().map(|p| of_point(p.crack))).collect();
    let order = discrete.elimination_order();
    setup.setup_s += clock.elapsed().as_secs_f64();
    let traction = needs.traction.then(|| free_rows(discrete, free, traction));
    Elastic::new(ElasticParts {
        dim,
        stiffness: SquareMatrix::symmetric(free, col_ptr, row_idx, values)?,
        jump,
        weight: discrete.points.iter().map(|p| p.weight).collect(),
        order,
        floating: reduced.motions,
        frictionless,
        traction: traction.transpose()?,
    })
}

/// Sparse rows over all unknowns as an operator over the free ones.
fn free_rows(
    discrete: &Discretisation,
    free: usize,
    rows: &[Vec<(usize, f64)>],
) -> Result<JumpOperator, MethodError> {
    let mut row_ptr = vec![0];
    let (mut col_idx, mut values) = (Vec::new(), Vec::new());
    for row in rows {
        for (i, v) in discrete.basis.row(discrete.mesh.dim(), row) {
            if let Some(n) = discrete.solver_numbers[i] {
                col_idx.push(n as usize);
                values.push(v);
            }
        }
        row_ptr.push(col_idx.len());
    }
    JumpOperator::new(rows.len(), free, row_ptr, col_idx, values)
}

/// Contact spaces of the cracks, each named once, with marks for inexact quadrature and for the mean dilatation in every cell.
fn space_name(case: &Case, cut: bool) -> String {
    let mut names: Vec<&str> = Vec::new();
    for name in case.cracks.iter().map(|spec| spec.contact.name()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let mut name = names.join("+");
    if let (Quadrature::Gauss(n), true) = (case.quadrature, cut) {
        name += &format!("/gauss-{n}");
    }
    if case.dilatation == Some(Dilatation::Mean) {
        name += "/mean-dilatation";
    }
    name
}
