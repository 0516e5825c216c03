//! Stiffness of enriched cells.
//!
//! Cells with Heaviside functions only need the standard stiffness K^r of their regions r, the two sides of a crack or the
//! parts between several: every function is N_i times a constant in each, f_i^r = 1 (standard) or ±1 − H_j (Heaviside), so
//!
//! ```text
//!   K[(p,a),(q,b)] = Σ_r f_p^r f_q^r K^r[(i_p,a),(i_q,b)]
//! ```
//!
//! Every region is integrated by itself: a sliver keeps its full relative accuracy (its entries may be 10⁻²⁴ of the others and
//! still count), and the [stress](super::stress) of a region is its own. Cells with branch functions are integrated function by
//! function.

use crate::cut::crack::Crack;
use crate::cut::part::{Part, Region};
use crate::cut::partition::Partition;
use crate::enrichment::Enrichment;
use crate::enrichment::cell_functions::CellFunctions;
use crate::enrichment::facets::{CrackFacets, Facet};
use crate::geometry::clip::Side;
use crate::geometry::{Point, polygon};
use crate::material::{Dilatation, Lame};
use crate::mesh::Mesh;
use crate::mesh::cell::{CellMap, Nodal};
use crate::quadrature::graded::{FAR, graded_points};
use crate::quadrature::{Quadrature, WeightedPoint, gauss_map, measure};

use super::dilatation::ProjectedDilatation;
use super::elasticity::{CellMatrix, Gram};
use super::near_front::{Effort, NearFront};

/// A quadrature point of a cell.
#[derive(Debug, Clone, Copy)]
pub struct SidedPoint {
    /// Reference position.
    pub xi: Point,
    /// Position [m].
    pub x: Point,
    /// Weight [m^dim].
    pub weight: f64,
    /// Part of the cell.
    pub region: Region,
}

impl SidedPoint {
    /// A point of a rule with its reference position and region.
    pub fn new(xi: Point, WeightedPoint { x, weight }: WeightedPoint, region: Region) -> Self {
        SidedPoint {
            xi,
            x,
            weight,
            region,
        }
    }
}

/// A cell whose sub-cells cannot be integrated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("cell at {at:?}: {reason}")]
pub struct CellError {
    /// Centre of the cell [m].
    pub at: Point,
    /// The failure.
    pub reason: String,
}

impl CellError {
    /// An error at a place.
    pub fn new(at: Point, reason: impl Into<String>) -> Self {
        CellError {
            at,
            reason: reason.into(),
        }
    }
}

/// Everything the cells of one body share.
pub struct CellIntegrator<'a> {
    /// Mesh.
    pub mesh: &'a Mesh,
    /// Cracks through cells.
    pub cracks: &'a [Crack],
    /// Functions.
    pub enrichment: &'a Enrichment,
    /// Rule for cut cells.
    pub quadrature: Quadrature,
    /// Material.
    pub lame: Lame,
}

impl<'a> CellIntegrator<'a> {
    /// The functions of a cell.
    pub fn functions(&self, cell: usize) -> CellFunctions<'a> {
        CellFunctions::new(self.mesh, self.enrichment, cell)
    }

    /// Stiffness of any cell over its function list, `plain` being its standard stiffness.
    pub fn stiffness(&self, cell: usize, plain: &CellMatrix) -> Result<CellMatrix, CellError> {
        if self.enrichment.is_plain(self.mesh, cell) {
            Ok(plain.clone())
        } else if self.enrichment.has_branch(cell) {
            self.by_functions(cell)
        } else {
            self.by_regions(cell, plain)
        }
    }

    /// The standard stiffness of every region, combined.
    fn by_regions(&self, cell: usize, plain: &CellMatrix) -> Result<CellMatrix, CellError> {
        let dim = self.mesh.dim();
        let functions = self.functions(cell);
        let parts = match self.enrichment.regions(cell) {
            1 => vec![plain.clone()],
            _ => self.region_stiffness(cell)?,
        };
        let size = functions.numbers.len() * dim;
        let mut k = CellMatrix::zeros(size, size);
        for (region, part) in parts.iter().enumerate() {
            for (p, (i, fp)) in functions.steps(region).enumerate() {
                for (q, (j, fq)) in functions.steps(region).enumerate() {
                    let f = fp * fq;
                    if f == 0.0 {
                        continue;
                    }
                    for a in 0..dim {
                        for b in 0..dim {
                            let value = f * part[(j * dim + b, i * dim + a)];
                            k[(q * dim + b, p * dim + a)] += value;
                        }
                    }
                }
            }
        }
        Ok(k)
    }

    /// Direct integration of all functions.
    fn by_functions(&self, cell: usize) -> Result<CellMatrix, CellError> {
        match self.lame.dilatation {
            Dilatation::Full => Ok(self.gram(cell)?.stiffness(self.lame)),
            Dilatation::Mean => {
                let points = self.evaluated(cell)?;
                let mut gram = Gram::zero(self.enrichment.cell(cell).len(), self.mesh.dim());
                for p in &points {
                    gram.add(p.at.weight, &p.gradients);
                }
                let projected = ProjectedDilatation::of(self, cell, &points);
                Ok(gram.projected_stiffness(self.lame, &projected.integrals()))
            }
        }
    }

    /// Quadrature points of a cell for its functions; the weights sum to its measure.
    pub fn points(&self, cell: usize) -> Result<Vec<SidedPoint>, CellError> {
        let map = self.mesh.map(cell);
        let partition = self.enrichment.partition(cell);
        let branch = self.enrichment.has_branch(cell);
        match (partition, self.quadrature) {
            (None, _) if !branch => Ok(whole_cell(&map, 2, |_| 0)),
            (Some(partition), Quadrature::Gauss(n)) => Ok(whole_cell(&map, n, |x| {
                let holds = |&(crack, side): &(usize, Side)| {
                    (self.cracks[crack].distance(x) >= 0.0) == (side > 0.0)
                };
                let inside = |part: &Part| part.sides.iter().all(holds);
                partition.parts.iter().position(inside).unwrap_or(0)
            })),
            _ => self.sub_cell_points(cell, &map, partition, branch),
        }
    }

    fn sub_cell_points(
        &self,
        cell: usize,
        map: &CellMap,
        partition: Option<&Partition>,
        branch: bool,
    ) -> Result<Vec<SidedPoint>, CellError> {
        let affine = map.is_affine();
        let whole = Partition::whole(map);
        let parts = &partition.unwrap_or(&whole).parts;
        if branch && self.mesh.dim() == 3 {
            return self.near_front_points(cell, parts, Effort::WORKING);
        }
        // As far as a rule asks for them.
        let tips = self
            .enrichment
            .singular_points_near(map, FAR * map.diagonal());
        // Errors of 1e-12; a ramp squared raises the degree by four.
        let ramps = self.enrichment.ramps_in(self.mesh.cell(cell), cell);
        let order = if ramps { [12, 8] } else { [10, 6] };
        let mut points = Vec::new();
        for (region, part) in parts.iter().enumerate() {
            let rule = if branch {
                graded_points(&polygon::pieces(&part.polygon), &tips, order)
            } else if affine {
                part.points()
            } else {
                part.fine_points(map)
            };
            points.extend(rule.into_iter().map(|p| (p, region)));
        }
        // A rule in polar coordinates integrates constants to its own accuracy, not to rounding.
        let tolerance = if branch { 1e-6 } else { 1e-11 };
        if branch || !affine {
            fill(parts, &mut points);
        }
        self.located(cell, points, tolerance)
    }

    /// The tips and fronts in a cell, with its number.
    fn tips_in(&self, cell: usize) -> &[(usize, usize)] {
        let all = &self.enrichment.tip_cells;
        let first = all.partition_point(|t| t.0 < cell);
        let count = all[first..].partition_point(|t| t.0 == cell);
        &all[first..first + count]
    }

    /// Signed distances of the corners of a cell to the plane of a crack [m], and its normal.
    pub fn plane(&self, cell: usize, crack: usize) -> (Nodal<f64>, Point) {
        let crack = &self.cracks[crack];
        let phi = crack.cell_phi(self.mesh, cell);
        (phi, crack.frame(&self.mesh.map(cell)[0])[0])
    }

    /// Points of a 3D cell with branch functions.
    pub fn near_front_points(
        &self,
        cell: usize,
        parts: &[Part],
        effort: Effort,
    ) -> Result<Vec<SidedPoint>, CellError> {
        let near = NearFront {
            map: &self.mesh.map(cell),
            parts,
            fronts: &self.enrichment.tips,
            chords: self.chords(cell),
        };
        let mut points = near.points(|crack| self.plane(cell, crack), effort);
        fill(parts, &mut points);
        self.located(cell, points, 1e-6)
    }

    /// The fronts that cross the faces of their cracks in a 3D cell: where each enters and leaves it [m].
    fn chords(&self, cell: usize) -> Vec<(usize, [Point; 2])> {
        let chord = |&(_, tip): &(usize, usize)| {
            let index = self.enrichment.tips[tip].crack;
            let crack = &self.cracks[index];
            self.enrichment.hosts(cell).find_map(|host| {
                let all = CrackFacets::of_cell(self.mesh, host, index, crack, self.enrichment);
                let beside = |facet: &&Facet| facet.sides.iter().any(|side| side.0 == cell);
                let mut own = all.facets.iter().filter(beside);
                own.find_map(|facet| Some((tip, facet.front.as_ref()?.chord)))
            })
        };
        self.tips_in(cell).iter().filter_map(chord).collect()
    }

    /// Reference positions of points that must fill the cell up to a relative tolerance.
    fn located(
        &self,
        cell: usize,
        points: Vec<(WeightedPoint, Region)>,
        tolerance: f64,
    ) -> Result<Vec<SidedPoint>, CellError> {
        let map = self.mesh.map(cell);
        // A slip in the geometry shows as a wrong measure: never integrate over it.
        let measure = measure(&map);
        let largest = map.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        let tolerance = tolerance.max(64.0 * f64::EPSILON * largest / map.diagonal());
        let sum: f64 = points.iter().map(|(p, _)| p.weight).sum();
        if (sum - measure).abs() > tolerance * measure {
            let reason = format!("sub-cells measure {sum:e} instead of {measure:e}");
            return Err(CellError::new(map.centre(), reason));
        }
        let lost = || CellError::new(map.centre(), "a sub-cell point has no reference position");
        let inverter = map.inverter();
        let place = |(p, region): (WeightedPoint, Region)| {
            let xi = inverter.at(&p.x).ok_or_else(lost)?;
            Ok(SidedPoint::new(xi, p, region))
        };
        points.into_iter().map(place).collect()
    }

    /// Displacement at a point of a cell, in one of its regions.
    pub fn displacement(&self, cell: usize, x: &Point, region: Region, u: &[f64]) -> Option<Point> {
        let mut functions = self.functions(cell);
        let xi = functions.map.inverse(x)?;
        Some(functions.field(&xi, x, region, u).0)
    }
}

/// Makes the weights of every part sum to its measure, where they do to the accuracy of their rule: a linear field then has
/// its gradient.
fn fill(parts: &[Part], points: &mut [(WeightedPoint, Region)]) {
    /// Part of the measure that a rule may miss; more is a slip in the geometry, found out later.
    const MISSED: f64 = 1e-3;
    for (region, part) in parts.iter().enumerate() {
        let measure = part.measure();
        let own = points.iter_mut().filter(|p| p.1 == region);
        let sum: f64 = own.map(|p| p.0.weight).sum();
        if (sum - measure).abs() <= MISSED * measure {
            let own = points.iter_mut().filter(|p| p.1 == region);
            own.for_each(|p| p.0.weight *= measure / sum);
        }
    }
}

/// Tensor Gauss points of the whole cell with a region each.
pub fn whole_cell(map: &CellMap, n: usize, region: impl Fn(&Point) -> Region) -> Vec<SidedPoint> {
    let sided = |(xi, p): (Point, WeightedPoint)| SidedPoint::new(xi, p, region(&p.x));
    gauss_map(map, n).map(sided).collect()
}
