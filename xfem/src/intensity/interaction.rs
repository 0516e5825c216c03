//! Stress intensity factors by the domain interaction integral, 2D.
//!
//! With q = 1 around the tip and 0 outside, u^aux the [unit fields](super::williams) of the tangent at the tip, continued
//! up to the faces, and x₁ ahead:
//!
//! ```text
//!   I = ∫_A (σ_ij u^aux_i,1 + σ^aux_ij u_i,1 − σ_ik ε^aux_ik δ_1j) q_,j dA       domain, both sides of the crack
//!     − ∫_A f_i u^aux_i,1 q dA                                                  body force f
//!     − Σ ∫_Γ (t_i u^aux_i,1 + σ^aux_ij m_j u_i,1 − σ_ik ε^aux_ik m_1) q dΓ     faces: m out of the body, t = λ on side 1, −λ on side 2
//!
//!   K = ½ E' I        for the mode of the auxiliary field
//! ```
//!
//! It depends on no domain. Where the faces are straight the last two terms of them vanish. (An angle that follows the crack leaves
//! −∫ σ^aux_ij,j u_i,1 q dA and more: an error of the curvature times the radius.)
//!
//! Yau, Wang & Corten, J. Appl. Mech. 47 (1980) 335; as a domain integral of an extended finite element solution: Moës,
//! Dolbow & Belytschko, Int. J. Numer. Meth. Engng 46 (1999) 131; contact tractions: Dolbow, Moës & Belytschko, Comput. Meth.
//! Appl. Mech. Engng 190 (2001) 6825; curved faces, whose auxiliary tractions count: Gosz & Moran, Eng. Fract. Mech. 69 (2002) 299;
//! Walters, Paulino & Dodds, Eng. Fract. Mech. 72 (2005) 1635. One homogeneous material without initial stress.

use rayon::prelude::*;

use crate::contact::surface_point::SurfacePoint;
use crate::cut::placement::{cells_at, reference_position};
use crate::fields::sampling::{ComparisonPoint, comparison_points};
use crate::geometry::boxes::around;
use crate::geometry::clip::Side;
use crate::geometry::tip_frame::TipFrame;
use crate::geometry::{Point, add_scaled, dot, norm, sub};
use crate::material::{double_dot, stress};
use crate::mesh::Mesh;
use crate::stiffness::cell_matrix::{CellError, CellIntegrator, SidedPoint};

use super::behind::Behind;
use super::williams::{Mode, Williams, plane_modulus};

/// Displacement gradients ∂u_a/∂x_b at points of a cell; Hooke's law makes the stress of them.
pub type Gradients<'a> =
    dyn Fn(usize, &[ComparisonPoint]) -> Result<Vec<[Point; 3]>, CellError> + Sync + 'a;

/// Force per volume at a point and side [N/m³].
pub type BodyForce<'a> = dyn Fn(&Point, Option<Side>) -> Point + Sync + 'a;

/// The fields of the integral.
pub struct Fields<'a> {
    /// The displacement, through its gradients.
    pub gradients: &'a Gradients<'a>,
    /// Points of the crack surface with the contact traction on side 1, in space [Pa].
    pub faces: &'a [(&'a SurfacePoint, Point)],
    /// If there is any.
    pub body_force: Option<&'a BodyForce<'a>>,
}

/// The domain: all cells with a node within a radius of the tip; q is 1 at those nodes and bilinear in the cells.
#[derive(Debug, Clone, Copy)]
pub struct Domain<'a> {
    /// Radius [m]; 3 cells, or fixed: the smaller, the more the error of the cells at the tip enters.
    pub radius: f64,
    /// Tips of all cracks, this one among them.
    pub fronts: &'a [TipFrame],
    /// Points per direction of the rule, see [`comparison_points`].
    pub rule: usize,
}

/// Why a domain does not stand alone around its tip.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Obstacle {
    /// It is smaller than the cells at the tip.
    #[error("the cells at the tip")]
    Cells,
    /// It reaches the outline of the body.
    #[error("a side of the body")]
    Side,
    /// It reaches another tip.
    #[error("another tip")]
    Tip,
    /// It reaches another crack.
    #[error("another crack")]
    Crack,
    /// A sharp bend of the crack, nearer than two cells, or one that turns it away from the tangent at the tip; cells of this size
    /// [m] would do.
    #[error("a bend of the crack, where cells of {0:.2e} m would do")]
    Bend(f64),
}

/// K_I and K_II [Pa √m] at a tip in its frame, or what keeps the domain from standing alone around the tip.
pub fn interaction(
    integrator: &CellIntegrator<'_>,
    tip: &TipFrame,
    domain: Domain<'_>,
    fields: &Fields<'_>,
) -> Result<Result<[f64; 2], Obstacle>, CellError> {
    let CellIntegrator { mesh, lame, .. } = *integrator;
    let inside = |node: u32| {
        let x = &mesh.nodes[node as usize];
        norm(&sub(x, &tip.position)) <= domain.radius
    };
    let count = |cell: usize| mesh.cell(cell).iter().filter(|&&n| inside(n)).count();
    let reached = around([&tip.position], domain.radius);
    let mut cells = mesh.surroundings().meeting(&reached);
    cells.retain(|&cell| count(cell) > 0);
    // Those that the rules of these cells see.
    let sizes = cells.iter().map(|&cell| mesh.map(cell).diagonal());
    let size = sizes.fold(0.0, f64::max);
    let reach = domain.radius + 3.0 * size;
    let near = |front: &&TipFrame| front.distance(&tip.position) <= reach;
    let fronts: Vec<TipFrame> = domain.fronts.iter().filter(near).cloned().collect();
    let at_tip = cells_at(mesh, &tip.position);
    if at_tip.iter().any(|&cell| count(cell) < mesh.kind.nodes()) {
        return Ok(Err(Obstacle::Cells));
    }
    let edges = at_tip.iter().map(|&cell| mesh.map(cell).longest_edge());
    let edge = edges.fold(0.0, f64::max);
    let behind = Behind::new(tip, integrator.cracks, [edge, domain.radius + size]);
    if let Some(obstacle) = obstacle(integrator, &behind, &fronts, &inside, &cells) {
        return Ok(Err(obstacle));
    }
    let range = cells.first()..=cells.last();
    let in_domain = |c: &usize| range.contains(&Some(c)) && cells.binary_search(c).is_ok();
    // On a face with one side in the domain q is 0.
    let both = |p: &SurfacePoint| p.sides.iter().all(|side| in_domain(&side.cell));
    let own_faces: Vec<_> = fields.faces.iter().filter(|(p, _)| both(p)).collect();
    if let Some((p, _)) = own_faces.iter().find(|(p, _)| !behind.holds(&p.x)) {
        return Ok(Err(behind.too_near(&p.x)));
    }
    let modes = [Mode::I, Mode::II].map(|mode| Williams::new(&behind.tangent, lame, mode));
    let of_cell = |&cell: &usize| -> Result<[f64; 2], CellError> {
        let ring = count(cell) < mesh.kind.nodes();
        if !ring && fields.body_force.is_none() {
            return Ok([0.0; 2]); // q = 1
        }
        let points = comparison_points(integrator, cell, &fronts, domain.rule)?;
        let gradients = if ring {
            (fields.gradients)(cell, &points)?
        } else {
            vec![[[0.0; 3]; 3]; points.len()] // ∇q = 0
        };
        let mut sums = [0.0; 2];
        for (at, h) in points.iter().zip(&gradients) {
            let p = &at.point;
            let (q, dq) = weight(mesh, cell, &inside, &p.xi);
            let force = fields.body_force.map_or([0.0; 3], |f| f(&p.x, at.side));
            let sigma = stress(lame, 2, h);
            let slope = ahead(h, tip);
            for (sum, mode) in sums.iter_mut().zip(&modes) {
                let h_aux = behind.gradient(mode, &p.x, at.side);
                let sigma_aux = stress(lame, 2, &h_aux);
                let slope_aux = ahead(&h_aux, tip);
                // σ : ε^aux, σ being symmetric.
                let energy = double_dot(&sigma, &h_aux);
                let flux = bilinear(&slope_aux, &sigma, &dq) + bilinear(&slope, &sigma_aux, &dq)
                    - energy * dot(&tip.ahead, &dq);
                *sum += p.weight * (flux - q * dot(&force, &slope_aux));
            }
        }
        Ok(sums)
    };
    // In the order of the cells, whatever thread a part comes from.
    let parts: Vec<[f64; 2]> = cells.par_iter().map(of_cell).collect::<Result<_, _>>()?;
    let add = |total: [f64; 2], part: [f64; 2]| [0, 1].map(|k| total[k] + part[k]);
    let mut total = parts.into_iter().fold([0.0; 2], add);
    for (point, traction) in own_faces {
        for (place, side) in point.sides.iter().zip([1.0, -1.0]) {
            let (q, _) = weight(mesh, place.cell, &inside, &place.xi);
            let outward = point.frame[0].map(|n| -side * n);
            let at = ComparisonPoint {
                point: SidedPoint {
                    xi: place.xi,
                    x: point.x,
                    weight: point.weight,
                    region: place.region,
                },
                side: Some(side),
            };
            let h = match behind.is_straight() {
                true => [[0.0; 3]; 3], // σ^aux m = 0, m₁ = 0
                false => (fields.gradients)(place.cell, &[at])?[0],
            };
            let (sigma, slope) = (stress(lame, 2, &h), ahead(&h, tip));
            for (sum, mode) in total.iter_mut().zip(&modes) {
                let h_aux = behind.gradient(mode, &point.x, Some(side));
                let sigma_aux = stress(lame, 2, &h_aux);
                let flux = side * dot(traction, &ahead(&h_aux, tip))
                    + bilinear(&slope, &sigma_aux, &outward)
                    - double_dot(&sigma, &h_aux) * dot(&tip.ahead, &outward);
                *sum -= point.weight * q * flux;
            }
        }
    }
    Ok(Ok(total.map(|i| 0.5 * plane_modulus(lame) * i)))
}

/// Another thing than the crack of the tip that disturbs the domain.
fn obstacle(
    integrator: &CellIntegrator<'_>,
    behind: &Behind,
    fronts: &[TipFrame],
    inside: &dyn Fn(u32) -> bool,
    cells: &[usize],
) -> Option<Obstacle> {
    let mesh = integrator.mesh;
    let outline = mesh.sides.keys().flat_map(|side| mesh.side_nodes(side));
    if outline.into_iter().any(|node| inside(node as u32)) {
        return Some(Obstacle::Side);
    }
    cells.iter().find_map(|&cell| {
        let size = mesh.map(cell).diagonal();
        let parts = integrator.enrichment.partition(cell).into_iter();
        let sides = parts.flat_map(|p| p.parts.iter().flat_map(|part| &part.sides));
        let mut others = sides.map(|s| s.0).filter(|arm| !behind.arms.contains(arm));
        let number = |arm: usize| integrator.cracks[arm].number;
        let other_tip = fronts.iter().any(|front| {
            norm(&sub(&front.position, &behind.tangent.position)) > 1e-9 * size
                && reference_position(mesh, cell, &front.position, 1e-9).is_some()
        });
        match others.next() {
            _ if other_tip => Some(Obstacle::Tip),
            Some(arm) if number(arm) == number(behind.arms[0]) => {
                Some(behind.too_near(&mesh.centre(cell)))
            }
            Some(_) => Some(Obstacle::Crack),
            None => None,
        }
    })
}

/// q and ∇q [1/m].
fn weight(mesh: &Mesh, cell: usize, inside: &dyn Fn(u32) -> bool, xi: &Point) -> (f64, Point) {
    let n = mesh.kind.shape(xi);
    let (dn, _) = mesh.map(cell).gradients(xi);
    let (mut q, mut dq) = (0.0, [0.0; 3]);
    for (i, &node) in mesh.cell(cell).iter().enumerate() {
        if inside(node) {
            q += n[i];
            dq = add_scaled(&dq, 1.0, &dn[i]);
        }
    }
    (q, dq)
}

/// ∂u/∂x₁.
fn ahead(h: &[Point; 3], tip: &TipFrame) -> Point {
    [0, 1, 2].map(|a| dot(&h[a], &tip.ahead))
}

/// v · σ w
fn bilinear(v: &Point, sigma: &[Point; 3], w: &Point) -> f64 {
    (0..3).map(|a| v[a] * dot(&sigma[a], w)).sum()
}
