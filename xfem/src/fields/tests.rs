//! Rules for comparison with exact fields over cut bodies.

use crate::cut::arrangement::Arrangement;
use crate::cut::crack::{Crack, Tip};
use crate::cut::placement;
use crate::enrichment::Enrichment;
use crate::fields::sampling::{ComparisonPoint, comparison_points};
use crate::geometry::crack_shape::CrackShape;
use crate::geometry::tip_frame::TipFrame;
use crate::geometry::{Point, norm, sub};
use crate::material::{Lame, Material, Model};
use crate::mesh::Mesh;
use crate::mesh::box_mesh::{GridSpec, box_mesh};
use crate::quadrature::Quadrature;
use crate::quadrature::check::inverse_distance;
use crate::stiffness::cell_matrix::CellIntegrator;

/// A body with one crack.
struct Body {
    mesh: Mesh,
    cracks: Vec<Crack>,
    enrichment: Enrichment,
}

impl Body {
    /// The box from the origin to `corner`, `cells` per axis.
    fn new(corner: &[f64], cells: &[usize], shape: &CrackShape, tip: Tip) -> Self {
        let line = |(&length, &n): (&f64, &usize)| -> Vec<f64> {
            (0..=n).map(|k| length * k as f64 / n as f64).collect()
        };
        let lines = corner.iter().zip(cells).map(line).collect();
        let mesh = box_mesh(&GridSpec::new(lines)).unwrap();
        let lengths = mesh.lengths();
        let whole = vec![Crack::new(0, shape, tip, &mesh, &lengths)];
        let (arrangement, cracks) = match mesh.dim() {
            2 => Arrangement::new(&mesh, &lengths, &whole).unwrap(),
            _ => (Arrangement::default(), whole),
        };
        let placed = (cracks.as_slice(), arrangement);
        let enrichment = Enrichment::new(&mesh, &lengths, placed, &Default::default()).unwrap();
        Body {
            mesh,
            cracks,
            enrichment,
        }
    }

    fn integrator(&self) -> CellIntegrator<'_> {
        let material = Material::new(1.0, 0.3);
        let model = [Model::PlaneStrain, Model::Solid][self.mesh.dim() - 2];
        CellIntegrator {
            mesh: &self.mesh,
            cracks: &self.cracks,
            enrichment: &self.enrichment,
            quadrature: Quadrature::SubCells,
            lame: Lame::new(material, model),
        }
    }
}

fn line(p: [f64; 2], q: [f64; 2]) -> CrackShape {
    CrackShape::Polyline(vec![p, q])
}

/// The square [0, 6]².
const SQUARE: [Point; 4] = [[0.0; 3], [6.0, 0.0, 0.0], [6.0, 6.0, 0.0], [0.0, 6.0, 0.0]];

/// Source: ∫ 1/r dA of a square in closed form; strain energy near a tip is of this kind. Goal: the rule fills the body and
/// finds the integral to 1e-6 with 4 points per direction, 1e-10 with 8, for cracks with and without tip functions; every
/// point of a split cell lies on its side.
#[test]
fn the_rule_fills_the_body_and_resolves_both_tips() {
    let shape = line([1.2, 2.1], [4.3, 3.7]);
    for tip in [Tip::Branch, Tip::None] {
        let body = Body::new(&[6.0; 2], &[6; 2], &shape, tip);
        let integrator = body.integrator();
        let crack = &body.cracks[0];
        let fronts = placement::fronts(0, crack);
        let ends: Vec<Point> = fronts.iter().map(|f| f.position).collect();
        for (n, tolerance) in [(4, 1e-6), (8, 1e-9)] {
            let (mut area, mut found) = (0.0, [0.0; 2]);
            for cell in 0..body.mesh.cell_count() {
                for p in comparison_points(&integrator, cell, &fronts, n).unwrap() {
                    let ComparisonPoint { point: p, side } = p;
                    area += p.weight;
                    for (sum, end) in found.iter_mut().zip(&ends) {
                        *sum += p.weight / norm(&sub(&p.x, end));
                    }
                    if let Some(side) = side {
                        assert!(crack.distance(&p.x) * side > -1e-12);
                    }
                }
            }
            assert!((area / 36.0 - 1.0).abs() < tolerance, "{tip:?} {n}: {area}");
            for (sum, end) in found.iter().zip(&ends) {
                let error = (sum / inverse_distance(&SQUARE, end) - 1.0).abs();
                println!("{tip:?} n = {n}: {error:.1e}");
                assert!(error < tolerance, "{tip:?} {n}: {error:e}");
            }
        }
    }
}

/// Source: ∫ 1/ρ dV of a block about its axis is its height times the integral over the square. Goal: the halved
/// tetrahedra find it to 2e-3, with one more halving to 1e-3. What is left comes from the tetrahedra that the front runs
/// through, with signs that depend on how it does, so it need not fall by half each time.
#[test]
fn halved_tetrahedra_resolve_a_front() {
    let shape = CrackShape::plane([0.0, 2.8, 0.0], [0.0, 1.0, 0.0]);
    let body = Body::new(&[6.0, 6.0, 2.0], &[3, 3, 1], &shape, Tip::None);
    let integrator = body.integrator();
    // The line x = 3.2, y = 2.8.
    let front = TipFrame::straight(0, [3.2, 2.8, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let exact = 2.0 * inverse_distance(&SQUARE, &front.position);
    let error = |n: usize| {
        let found: f64 = (0..body.mesh.cell_count())
            .flat_map(|cell| {
                let fronts = std::slice::from_ref(&front);
                comparison_points(&integrator, cell, fronts, n).unwrap()
            })
            .map(|p| p.point.weight / front.distance(&p.point.x))
            .sum();
        (found / exact - 1.0).abs()
    };
    let [coarse, fine] = [error(4), error(8)];
    println!("1/r about a front: {coarse:.1e}, {fine:.1e}");
    assert!(coarse < 2e-3 && fine < 1e-3, "{coarse:e} {fine:e}");
}
