//! Faults of a case that only the discretisation finds, told at the place in its file.

use stickslip_methods::MethodError;
use stickslip_xfem::cut::arrangement::ArrangementError;
use stickslip_xfem::discretisation::DiscretisationError;
use stickslip_xfem::enrichment::{Enrichment, EnrichmentError};
use stickslip_xfem::geometry::crack_shape::CrackShape;
use stickslip_xfem::loads::nodal_forces::LoadError;
use stickslip_xfem::loads::supports::SupportError;
use stickslip_xfem::mesh::Mesh;
use stickslip_xfem::stiffness::cell_matrix::CellError;

use crate::case::{Case, CaseError, ContactSpace, CrackSpec, LoadKind, Span};

/// Why a case cannot be discretised.
#[derive(Debug, thiserror::Error)]
pub enum BodyError {
    /// The case asks for something impossible; carries file, line and column.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// A cut cell could not be integrated.
    #[error(transparent)]
    Cell(#[from] CellError),
    /// The algebraic system was refused.
    #[error(transparent)]
    Method(#[from] MethodError),
}

/// Refusal by the discretisation, at its place in the file; `label` of the mesh.
pub fn refused(case: &Case, label: &str, error: DiscretisationError) -> BodyError {
    match error {
        DiscretisationError::Folded(mut fold) => {
            fold.centre = case.place(&fold.centre);
            let allowed = "a motion of the grid points that keeps all cells convex";
            let span = case.mesh.motion_span(fold.motion);
            case.error(span, label, allowed, &fold).into()
        }
        DiscretisationError::Support(error) => support_error(case, error).into(),
        DiscretisationError::Crack(error) => crack_error(case, &error).into(),
        DiscretisationError::Cell(error, crack) => cell_error(case, crack, error),
        DiscretisationError::Moves(error) => {
            let (span, allowed) = match case.supports.first() {
                Some(support) => (&support.span, "supports that hold every rigid motion"),
                None => (&case.mesh.span, "at least one [[support]]"),
            };
            case.refuse(span, allowed, error).into()
        }
    }
}

/// Refuses node pairs beside other cracks.
pub fn check_pairs(case: &Case) -> Result<(), CaseError> {
    let pairs = |spec: &&CrackSpec| spec.contact == ContactSpace::NodePairs;
    match case.cracks.iter().find(pairs) {
        Some(spec) if case.cracks.len() > 1 => {
            let allowed = "edge-pairs or star beside other cracks";
            let message = "node pairs stand for a crack that is alone in its body";
            Err(case.refuse(&spec.contact_span, allowed, message))
        }
        _ => Ok(()),
    }
}

/// The error of a support, at its region or its lip.
fn support_error(case: &Case, error: SupportError) -> CaseError {
    let (SupportError::Empty(number)
    | SupportError::NoLip(number)
    | SupportError::NeedlessLip(number)
    | SupportError::OtherLip(number)) = error;
    let support = &case.supports[number];
    let region = &support.on.span;
    let (span, allowed) = match error {
        SupportError::Empty(_) => {
            let allowed = "a region with at least one node";
            return case.error(region, "no node", allowed, error);
        }
        SupportError::NoLip(_) => {
            let allowed =
                "crack_side = 1 or 2, or a region with a part of the side beside the crack";
            (region, allowed)
        }
        SupportError::NeedlessLip(_) => {
            let span = support.lip.as_ref().map_or(region, |lip| &lip.span);
            let allowed = "no crack_side beside a region that holds a part of the side";
            (span, allowed)
        }
        SupportError::OtherLip(_) => {
            let allowed = "on one lip all components that are held on the other, or a mesh without a node there";
            (region, allowed)
        }
    };
    case.refuse(span, allowed, error)
}

/// Refuses a probe that is at no node, or on a crack, where the displacement has two values.
pub fn check_probes(case: &Case, mesh: &Mesh, enrichment: &Enrichment) -> Result<(), CaseError> {
    let (size, _) = mesh.extent();
    for probe in &case.probes {
        let refuse = |allowed: &str, reason: &str| {
            let message = format!("probe `{}` {reason}", probe.name);
            Err(case.refuse(&probe.span, allowed, message))
        };
        let Some(node) = mesh.node_at(&probe.point) else {
            return refuse("the place of a node of the mesh", "is at no node");
        };
        let twin = mesh.nodes[node + 1..]
            .iter()
            .any(|x| (0..3).all(|a| (x[a] - probe.point[a]).abs() <= 1e-9 * size));
        // A function that jumps at its own node: H reaches across, or the node lies between the faces.
        let faces = enrichment.jumps_at(node);
        if twin || faces {
            return refuse(
                "a node beside the crack",
                "lies on a crack, where two displacements meet",
            );
        }
    }
    Ok(())
}

/// The error of a crack, at its geometry or its `tip`.
pub fn crack_error(case: &Case, error: &EnrichmentError) -> CaseError {
    let error = &error.clone().moved(&case.origin);
    let (crack, allowed) = match error {
        EnrichmentError::Outside(crack) => (*crack, "a crack that cuts at least one cell"),
        EnrichmentError::TooShort { crack, .. } => (*crack, "a longer crack"),
        EnrichmentError::Undetermined { crack, .. } => (*crack, "longer pieces"),
        EnrichmentError::Loose { crack, .. } => (*crack, "supports on the piece"),
        EnrichmentError::Singular { crack, .. } => (
            *crack,
            "cracks that meet in one place, or farther apart than a thousandth of a cell",
        ),
        EnrichmentError::Arrangement(ArrangementError::Overlap { cracks, .. }) => {
            (cracks[1], "cracks that cross or lie apart")
        }
        EnrichmentError::Arrangement(ArrangementError::Point { crack, .. }) => {
            (*crack, "a crack of some cells' length")
        }
        EnrichmentError::Partition { crack, .. } => {
            (*crack, "a finer mesh, or cracks farther apart")
        }
        EnrichmentError::OffFacets { crack, .. } => (
            *crack,
            "a contact space other than node-pairs, or a mesh with nodes along the crack",
        ),
    };
    let spec = &case.cracks[crack];
    let span = match error {
        EnrichmentError::OffFacets { .. } => &spec.contact_span,
        _ => &spec.geometry_span,
    };
    let fitting = match (&spec.geometry, error) {
        (_, EnrichmentError::TooShort { cell, .. }) => {
            fitting_cell(&spec.geometry).map(|fitting| fitting.min(*cell))
        }
        (
            _,
            EnrichmentError::Undetermined { cell, .. }
            | EnrichmentError::Loose { cell, .. }
            | EnrichmentError::Singular { cell, .. },
        ) => Some(*cell),
        _ => None,
    };
    match fitting {
        Some(cell) => {
            let allowed = format!("{allowed}, or cells of at most {cell:.2e} m");
            case.refuse(span, &allowed, error)
        }
        None => case.refuse(span, allowed, error),
    }
}

/// The error of a cell, at the crack nearest to it.
pub fn cell_error(case: &Case, nearest: Option<usize>, error: CellError) -> BodyError {
    let error = in_file(case, error);
    match nearest {
        Some(crack) => {
            let allowed = "another number of cells, or a crack moved by a hundredth of a cell";
            let span = &case.cracks[crack].geometry_span;
            case.refuse(span, allowed, error).into()
        }
        None => error.into(),
    }
}

/// The error of a cell with its place as the file has it.
fn in_file(case: &Case, error: CellError) -> CellError {
    CellError {
        at: case.place(&error.at),
        ..error
    }
}

/// Edge of cells that a crack crosses often enough: a third of its length or width [m].
fn fitting_cell(shape: &CrackShape) -> Option<f64> {
    let third = |length: f64| Some(length / 3.0);
    match shape {
        CrackShape::Polyline(points) => {
            let length = |w: &[[f64; 2]]| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]);
            third(points.windows(2).map(length).sum())
        }
        CrackShape::Arc {
            radius, from, to, ..
        } => third(radius * (to - from).abs()),
        CrackShape::Ellipse(ellipse) => third(2.0 * ellipse.half_axes[0].min(ellipse.half_axes[1])),
        CrackShape::Plane { .. } => None,
    }
}

/// The error of a load, at its region.
pub fn load_error(case: &Case, kind: &LoadKind, span: &Span, error: LoadError) -> BodyError {
    match error {
        LoadError::Cell(e) => in_file(case, e).into(),
        LoadError::Empty(_) => {
            let span = match kind {
                LoadKind::Traction(region, _)
                | LoadKind::ExactTraction(region)
                | LoadKind::Pressure(region, _)
                | LoadKind::Line(region, _) => &region.span,
                LoadKind::Body(..) | LoadKind::ExactBody | LoadKind::InitialStress(_) => span,
            };
            let allowed = "a region with facets or edges to load";
            case.refuse(span, allowed, error).into()
        }
    }
}

/// The error of a load on one side of a crack that does not part the body.
pub fn one_sided_error(case: &Case, span: &Span) -> CaseError {
    let message = "the crack ends inside the body: it has no sides away from its faces";
    case.refuse(span, "a crack through the whole body", message)
}
