//! Gradients that satisfy the divergence theorem on every cell, whatever the rule.
//!
//! ```text
//!   Σ_q w_q ∇φ_f  =  b_f  =  ∮_cell φ_f n ds − ∫_Γ [[φ_f]] n dΓ        for every function f of the cell
//!
//!   ∇φ_f ← ∇φ_f + (b_f − Σ_q w_q ∇φ_f) / V         V: measure of the cell; of shape functions region by region
//! ```
//!
//! Border integrals cancel between neighbours, for both take the same points; those over the crack are the rows of the jump
//! operator. So a uniform stress is in equilibrium with its tractions to rounding, on any cell: branch functions, arcs and
//! distorted cells cost as many points as their energy needs, no more. Variationally consistent integration: Chen, Hillman &
//! Rüter, Int. J. Numer. Meth. Engng 95 (2013) 387.

use std::array::from_fn;
use std::collections::{BTreeMap, BTreeSet};

use crate::cut::part::Region;
use crate::cut::partition::Partition;
use crate::enrichment::basis::{ABSENT, FunctionKind};
use crate::enrichment::cell_functions::CellFunctions;
use crate::enrichment::facet_rule::facet_points;
use crate::enrichment::facets::CrackFacets;
use crate::geometry::curve::turned;
use crate::geometry::{Point, Points, add_scaled, sub, unit};
use crate::mesh::cell::CellMap;
use crate::quadrature::rational::rational_order;
use crate::quadrature::{Quadrature, WeightedPoint, segment};

use super::border::{Within, outward};
use super::cell_matrix::{CellError, CellIntegrator, SidedPoint};
use super::elasticity::{Gram, Moments};
use super::lanes::{LANES, in_lanes};

/// A quadrature point with the gradients of all functions of its cell.
pub struct EvaluatedPoint {
    /// The point.
    pub at: SidedPoint,
    /// Gradients [1/m].
    pub gradients: Vec<Point>,
}

/// All of it.
fn uncut(piece: Vec<Point>) -> Vec<Vec<Point>> {
    vec![piece]
}

/// A smaller part of a distorted cell keeps the gradients of its rule.
const SLIVER: f64 = 1e-8;

impl CellIntegrator<'_> {
    /// Points of a cell with the gradients of its functions, which satisfy the divergence theorem.
    ///
    /// # Errors
    /// A cell that cannot be integrated.
    pub fn evaluated(&self, cell: usize) -> Result<Vec<EvaluatedPoint>, CellError> {
        let mut functions = self.functions(cell);
        let mut points: Vec<EvaluatedPoint> = self
            .points(cell)?
            .into_iter()
            .map(|at| {
                functions.evaluate(&at.xi, &at.x, at.region);
                EvaluatedPoint {
                    at,
                    gradients: functions.gradients.clone(),
                }
            })
            .collect();
        if self.is_corrected(cell, &functions) {
            let none = Moments {
                measure: 0.0,
                gradients: vec![[0.0; 3]; functions.numbers.len()],
            };
            let mut moments = vec![none; self.enrichment.regions(cell)];
            for p in &points {
                let own = &mut moments[p.at.region];
                own.measure += p.at.weight;
                for (sum, g) in own.gradients.iter_mut().zip(&p.gradients) {
                    *sum = add_scaled(sum, p.at.weight, g);
                }
            }
            let corrections = self.corrections(cell, &functions, &moments)?;
            for p in &mut points {
                for (g, c) in p.gradients.iter_mut().zip(&corrections[p.at.region]) {
                    *g = add_scaled(g, 1.0, c);
                }
            }
        }
        Ok(points)
    }

    /// Their Gram matrix, without keeping them: the corrections are constants by region.
    ///
    /// # Errors
    /// A cell that cannot be integrated.
    pub fn gram(&self, cell: usize) -> Result<Gram, CellError> {
        let functions = self.functions(cell);
        let mut gram = Gram::zero(functions.numbers.len(), self.mesh.dim());
        let mut moments = Vec::new();
        let points = self.points(cell)?;
        for region in 0..self.enrichment.regions(cell) {
            let own = points.iter().filter(|p| p.region == region);
            let own = own.map(|p| (p.xi, p.x, [p.weight]));
            in_lanes(
                own,
                #[inline(always)]
                |xi, x, [weights]| {
                    functions.visit(
                        xi,
                        x,
                        region,
                        #[inline(always)]
                        |f, _, g| gram.put(f, weights, g),
                    );
                    gram.end(weights);
                },
            );
            moments.push(gram.take_moments());
        }
        let corrections = if self.is_corrected(cell, &functions) {
            self.corrections(cell, &functions, &moments)?
        } else {
            vec![vec![[0.0; 3]; functions.numbers.len()]; moments.len()]
        };
        for (moments, corrections) in moments.iter().zip(&corrections) {
            gram.return_moments(moments, corrections);
        }
        Ok(gram)
    }

    /// Whether the rule of a cell leaves something to correct.
    fn is_corrected(&self, cell: usize, functions: &CellFunctions<'_>) -> bool {
        self.quadrature == Quadrature::SubCells
            && !self.enrichment.is_plain(self.mesh, cell)
            && (self.enrichment.has_branch(cell) || !functions.map.is_affine())
    }

    /// Defect of the gradients of all functions, by region, from the moments of the rule.
    fn corrections(
        &self,
        cell: usize,
        functions: &CellFunctions<'_>,
        moments: &[Moments],
    ) -> Result<Vec<Vec<Point>>, CellError> {
        let exact = self.shape_moments(cell, &functions.map)?;
        let nodes = functions.map.len();
        let tips = self.tips_of(functions);
        let whole: f64 = moments.iter().map(|m| m.measure).sum();
        // On a sliver the difference of border integrals is rounding, and what its rule misses is nothing to the cell.
        let least = if functions.map.is_affine() {
            0.0
        } else {
            SLIVER * whole
        };
        let mut found = vec![vec![[0.0; 3]; tips.len()]; moments.len()];
        // Evenly over a region: piece functions follow the shape functions.
        let regions = moments.iter().zip(&mut found).enumerate();
        for (region, (own, found)) in regions.filter(|(_, (own, _))| own.measure > least) {
            let mut missing = vec![[0.0; 3]; nodes];
            // Standard functions come first.
            for ((local, _), sum) in functions.steps(region).take(nodes).zip(&own.gradients) {
                missing[local] = sub(&exact[region][local], sum);
            }
            for (f, (local, step)) in functions.steps(region).enumerate() {
                if tips[f].is_none() {
                    found[f] = missing[local].map(|v| step / own.measure * v);
                }
            }
        }
        if tips.iter().any(Option::is_some) {
            // Evenly over where it lives in the cell.
            let flux = self.flux(cell, functions)?;
            let steps = self.enrichment.steps(cell);
            for f in (0..tips.len()).filter(|&f| tips[f].is_some()) {
                let sums = moments.iter().map(|m| &m.gradients[f]);
                let missing = sums.fold(flux[f], |missing, sum| sub(&missing, sum));
                let lives = |region: &usize| steps[region * tips.len() + f] != ABSENT;
                let regions: Vec<usize> = (0..moments.len()).filter(lives).collect();
                let whole: f64 = regions.iter().map(|&region| moments[region].measure).sum();
                for region in regions {
                    found[region][f] = missing.map(|v| v / whole);
                }
            }
        }
        Ok(found)
    }

    /// ∫ of the gradients of the shape functions over every region, by local node.
    fn shape_moments(&self, cell: usize, map: &CellMap) -> Result<Vec<Vec<Point>>, CellError> {
        let whole = Partition::whole(map);
        let partition = self.enrichment.partition(cell).unwrap_or(&whole);
        let mut moments = vec![vec![[0.0; 3]; map.len()]; partition.parts.len()];
        if map.is_affine() {
            // Polynomials: exact.
            for (part, sums) in partition.parts.iter().zip(&mut moments) {
                for p in part.points() {
                    let xi = map.inverse(&p.x).ok_or_else(|| lost(&p.x))?;
                    for (sum, g) in sums.iter_mut().zip(map.gradients(&xi).0.iter()) {
                        *sum = add_scaled(sum, p.weight, g);
                    }
                }
            }
            return Ok(moments);
        }
        let mut add = |p: &WeightedPoint, region: usize, sign: f64, normal: &Point| {
            let xi = map.inverse(&p.x).ok_or_else(|| lost(&p.x))?;
            let shapes = map.kind.shape(&xi);
            for (sum, value) in moments[region].iter_mut().zip(shapes.iter()) {
                *sum = add_scaled(sum, sign * p.weight * value, normal);
            }
            Ok::<(), CellError>(())
        };
        for local in map.kind.facets() {
            let normal = outward(map, local);
            // Linear along an edge.
            for (p, region) in self.border_points(cell, local, None, &uncut) {
                add(&p, region, 1.0, &normal)?;
            }
        }
        self.facet_points(cell, |p, regions, normal| {
            add(p, regions[0], -1.0, normal)?;
            add(p, regions[1], 1.0, normal)
        })?;
        for ([a, b], [one, two]) in partition.beyond.iter().zip(&partition.joined) {
            let normal = turned(&unit(&sub(b, a)));
            for p in segment(a, b, rational_order(map, [a, b])) {
                add(&p, *one, -1.0, &normal)?;
                add(&p, *two, 1.0, &normal)?;
            }
        }
        Ok(moments)
    }

    /// Visits the points of the facets inside a cell, not those on its border, that jumps are integrated with: point, regions, normal.
    fn facet_points(
        &self,
        cell: usize,
        mut visit: impl FnMut(&WeightedPoint, [usize; 2], &Point) -> Result<(), CellError>,
    ) -> Result<(), CellError> {
        let faces = self
            .enrichment
            .partition(cell)
            .map_or(&[][..], |p| p.faces.as_slice());
        let cracks: BTreeSet<usize> = faces.iter().map(|face| face.crack).collect();
        for index in cracks {
            let crack = &self.cracks[index];
            let mut facets = CrackFacets::of_cell(self.mesh, cell, index, crack, self.enrichment);
            // As the multipliers see them.
            facets.part_at_corners(self.enrichment, index);
            let all = facets.facets.iter();
            for facet in all.filter(|facet| facet.sides.iter().all(|side| side.0 == cell)) {
                for p in facet_points(self.mesh, crack, self.enrichment, &facets, facet) {
                    let point = WeightedPoint::new(p.x, p.weight);
                    visit(&point, facet.sides.map(|side| side.1), &facet.frame[0])?;
                }
            }
        }
        Ok(())
    }

    /// b_f of the branch functions of a cell.
    fn flux(&self, cell: usize, functions: &CellFunctions<'_>) -> Result<Vec<Point>, CellError> {
        let map = &functions.map;
        let tips = self.tips_of(functions);
        let inverter = map.inverter();
        let mut flux = vec![[[0.0; LANES]; 3]; tips.len()];
        // Points of a region with weights times normals; `which`: tip, nodes of a face.
        let mut add = |points: &[(WeightedPoint, Point)], region, which: (Option<u32>, u8)| {
            let place = |(p, normal): &(WeightedPoint, Point)| {
                let xi = inverter.at(&p.x).ok_or_else(|| lost(&p.x))?;
                Ok((xi, p.x, normal.map(|n| n * p.weight)))
            };
            let points: Vec<(Point, Point, [f64; 3])> =
                points.iter().map(place).collect::<Result<_, _>>()?;
            in_lanes(
                points,
                #[inline(always)]
                |xi, x, areas| {
                    functions.visit_branches(
                        (xi, x),
                        region,
                        which,
                        #[inline(always)]
                        |f, value| {
                            for (sum, area) in flux[f].iter_mut().zip(areas) {
                                *sum = from_fn(|q| sum[q] + value[q] * area[q]);
                            }
                        },
                    );
                },
            );
            Ok::<(), CellError>(())
        };
        let own: BTreeSet<u32> = tips.iter().copied().flatten().collect();
        for local in map.kind.facets() {
            let normal = outward(map, local);
            let nodes = local.iter().fold(0, |mask, i| mask | 1 << i);
            for &tip in &own {
                let points = self.border_points(cell, local, Some(tip), &uncut);
                for side in points.chunk_by(|p, q| p.1 == q.1) {
                    let points: Vec<_> = side.iter().map(|(p, _)| (*p, normal)).collect();
                    add(&points, side[0].1, (Some(tip), nodes))?;
                }
            }
        }
        let mut facets: BTreeMap<Region, Vec<(WeightedPoint, Point)>> = BTreeMap::new();
        self.facet_points(cell, |p, regions, normal| {
            for (region, sign) in regions.into_iter().zip([-1.0, 1.0]) {
                let own = facets.entry(region).or_default();
                own.push((*p, normal.map(|n| sign * n)));
            }
            Ok(())
        })?;
        for (region, points) in &facets {
            add(points, *region, (None, u8::MAX))?;
        }
        let sum = |sums: Points<LANES>| sums.map(|s| s.iter().sum());
        Ok(flux.into_iter().map(sum).collect())
    }

    /// The tip of every branch function of a cell.
    fn tips_of(&self, functions: &CellFunctions<'_>) -> Vec<Option<u32>> {
        let kind = |&f: &u32| self.enrichment.functions[f as usize].kind;
        let kinds = functions.numbers.iter().map(kind);
        kinds
            .map(|kind| match kind {
                FunctionKind::Branch { tip, .. } => Some(tip),
                _ => None,
            })
            .collect()
    }

    /// Visits the functions of a cell at the points of one of its edges (2D) or faces that they are integrated with: number in
    /// the cell, point, region, value. `within`: the parts of a convex piece that are asked for.
    ///
    /// # Errors
    /// A point without a reference position.
    pub fn visit_border(
        &self,
        cell: usize,
        local: &[usize],
        within: Within<'_>,
        functions: &mut CellFunctions<'_>,
        mut visit: impl FnMut(usize, &WeightedPoint, Region, f64),
    ) -> Result<(), CellError> {
        let tips = self.tips_of(functions);
        let own: BTreeSet<Option<u32>> = tips.iter().copied().chain([None]).collect();
        let inverter = functions.map.inverter();
        for tip in own {
            for (p, region) in self.border_points(cell, local, tip, within) {
                let xi = inverter.at(&p.x).ok_or_else(|| lost(&p.x))?;
                functions.evaluate(&xi, &p.x, region);
                for (f, value) in functions.values.iter().enumerate() {
                    if tips[f] == tip {
                        visit(f, &p, region, *value);
                    }
                }
            }
        }
        Ok(())
    }
}

fn lost(x: &Point) -> CellError {
    CellError::new(*x, "a point of a cell has no reference position")
}
