//! The assumed stress of a region against closed forms.

use nalgebra::DVectorView;
use stickslip_xfem::geometry::{Point, dot};
use stickslip_xfem::material::{Lame, double_dot, strain};
use stickslip_xfem::material::{Material, Model, stress};
use stickslip_xfem::mesh::cell::CellKind;
use stickslip_xfem::mesh::cell::CellMap;
use stickslip_xfem::stiffness::assumed_stress::{AssumedStress, ShapePoint};
use stickslip_xfem::stiffness::cell_matrix::whole_cell;
use stickslip_xfem::stiffness::elasticity::CellMatrix;

const RUBBER: Material = Material::new(2.0, 0.4);
const KINDS: [(CellKind, Model); 3] = [
    (CellKind::Quad4, Model::PlaneStrain),
    (CellKind::Quad4, Model::PlaneStress),
    (CellKind::Hex8, Model::Solid),
];

/// Rounding of displacements 20 times as large as the strains, times λ/μ = 5·10³.
const BENT: f64 = 1e-9;

/// The 3 × 3 [× 3] Gauss points of a cell that lie in a region.
fn rule(map: &CellMap, inside: impl Fn(&Point) -> bool) -> Vec<ShapePoint> {
    let points = whole_cell(map, 3, |_| 0)
        .into_iter()
        .filter(|at| inside(&at.xi));
    points.map(|at| (at, map.gradients(&at.xi).0)).collect()
}

/// u · K u
fn square(k: &CellMatrix, u: &[f64]) -> f64 {
    let u = DVectorView::from_slice(u, u.len());
    u.dot(&(k * u))
}

/// Source: uniform stress. Goal: in distorted cells and in parts of them, whatever the rule, a linear displacement has the
/// stress of Hooke's law everywhere, its energy V σ:ε and its tractions, to rounding.
#[test]
fn uniform_stress_is_exact_in_any_part_of_any_cell() {
    let h = [[0.3, -0.2, 0.5], [0.7, 0.1, -0.4], [-0.6, 0.2, 0.9]];
    let parts: [fn(&Point) -> bool; 3] = [
        |_| true,
        |xi| xi[0] + xi[1] < 0.1,
        |xi| xi[0] - 0.8 * xi[1] > -0.1,
    ];
    for (kind, model) in KINDS {
        let dim = kind.dim();
        let lame = Lame::new(RUBBER, model);
        let map = CellMap::new(kind, |i| {
            let [x, y, z] = kind.corner(i);
            let z = if dim == 2 { 0.0 } else { 1.3 * z + 0.2 * x * y };
            [
                3.0 * x + 0.4 * y + 0.2 * y * z,
                y - 0.2 * x + 0.1 * x * y,
                z,
            ]
        });
        let linear = |x: &Point| h.map(|row| dot(&row, x)).into_iter().take(dim);
        let u: Vec<f64> = map.iter().flat_map(linear).collect();
        let exact = stress(lame, dim, &h);
        for inside in parts {
            let points = rule(&map, inside);
            let assumed = AssumedStress::new(&map, lame, &points).unwrap();
            let xi = [0.2, -0.7, if dim == 2 { 0.0 } else { 0.5 }];
            let found = assumed.at(&xi, &u);
            let n = [0.6, -0.8, 0.0];
            let tractions = assumed.response(&xi, &n);
            for a in 0..dim {
                for b in 0..dim {
                    assert!((found[a][b] - exact[a][b]).abs() < 1e-13, "{kind:?}");
                }
                let t: f64 = tractions.iter().zip(&u).map(|(t, u)| t[a] * u).sum();
                assert!((t - dot(&exact[a], &n)).abs() < 1e-13, "{kind:?}");
            }
            let k = assumed.stiffness();
            let energy = square(&k, &u);
            let volume: f64 = points.iter().map(|(at, _)| at.weight).sum();
            let expected = volume * double_dot(&exact, &strain(lame, dim, &exact));
            assert!((energy / expected - 1.0).abs() < 1e-13, "{kind:?}");
        }
    }
}

/// Source: Pian & Sumihara 1984, Pian & Tong 1986; σ_xx = E' κ y. Goal: a box 20 times as long as high bends with exactly that
/// stress and energy, E' = E/(1 − ν²) in plane strain, also as ν → ½; with the stress of the gradient it is 100 times too stiff.
#[test]
fn a_slender_box_bends_exactly() {
    for (kind, model) in KINDS {
        for nu in [0.0, 0.3, 0.4999] {
            let dim = kind.dim();
            let lame = Lame::new(Material::new(2.0, nu), model);
            let modulus = 2.0
                / if model == Model::PlaneStrain {
                    1.0 - nu * nu
                } else {
                    1.0
                };
            let map = CellMap::new(kind, |i| {
                let [x, y, z] = kind.corner(i);
                [20.0 * x, y, if dim == 2 { 0.0 } else { 2.0 * z }]
            });
            // u_y is the same at all corners; a solid bends across, too.
            let bent = |x: &Point| [x[0] * x[1], 0.0, -nu * x[1] * x[2]].into_iter().take(dim);
            let u: Vec<f64> = map.iter().flat_map(bent).collect();
            let points = rule(&map, |_| true);
            let assumed = AssumedStress::new(&map, lame, &points).unwrap();
            let found = assumed.at(&[0.3, 0.5, -0.2], &u);
            assert!(
                (found[0][0] / (0.5 * modulus) - 1.0).abs() < BENT,
                "{found:?}"
            );
            assert!(found[1][1].abs() + found[0][1].abs() + found[2][2].abs() < BENT);
            let k = assumed.stiffness();
            let energy: f64 = points
                .iter()
                .map(|(at, _)| at.weight * at.xi[1].powi(2))
                .sum::<f64>()
                * modulus;
            let found = square(&k, &u);
            assert!((found / energy - 1.0).abs() < BENT, "{kind:?} {nu}");
        }
    }
}
