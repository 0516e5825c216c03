//! Structured meshes of boxes: uniform or graded grid lines, optionally bent to follow a straight line.

use std::collections::BTreeMap;

use super::cell::CellKind;
use super::mesh::{Facet, Mesh};
use crate::harness::case::{Follow, MeshSpec};

/// Names of the sides per axis: minimum, maximum.
pub fn side_names(dim: usize) -> &'static [[&'static str; 2]] {
    match dim {
        2 => &[["left", "right"], ["bottom", "top"]],
        _ => &[["left", "right"], ["front", "back"], ["bottom", "top"]],
    }
}

/// Builds the mesh of a box.
///
/// Fails with the offending cell if the bent grid lines fold it over.
pub fn box_mesh(spec: &MeshSpec) -> Result<Mesh, FoldedCell> {
    let dim = spec.lines.len();
    let kind = if dim == 2 {
        CellKind::Quad4
    } else {
        CellKind::Hex8
    };
    let points = |axis: usize| spec.lines.get(axis).map_or(1, Vec::len);
    let (nx, ny, nz) = (points(0), points(1), points(2));
    let mut nodes = Vec::with_capacity(nx * ny * nz);
    let mut grid = Vec::with_capacity(nx * ny * nz);
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let mut x = [0.0; 3];
                for (axis, index) in [i, j, k].into_iter().enumerate().take(dim) {
                    x[axis] = spec.lines[axis][index];
                }
                if let Some(follow) = &spec.follow {
                    x[dim - 1] += shift(follow, spec, &x);
                }
                nodes.push(x);
                grid.push([i as u32, j as u32, k as u32]);
            }
        }
    }
    let at = |i: usize, j: usize, k: usize| (i + nx * (j + ny * k)) as u32;
    let count = [nx - 1, ny - 1, if dim == 2 { 1 } else { nz - 1 }];
    let mut cells = Vec::with_capacity(kind.nodes() * count.iter().product::<usize>());
    let mut sides: BTreeMap<String, Vec<Facet>> = BTreeMap::new();
    let mut cell = 0;
    for k in 0..count[2] {
        for j in 0..count[1] {
            for i in 0..count[0] {
                cells.extend([
                    at(i, j, k),
                    at(i + 1, j, k),
                    at(i + 1, j + 1, k),
                    at(i, j + 1, k),
                ]);
                if dim == 3 {
                    let l = k + 1;
                    cells.extend([
                        at(i, j, l),
                        at(i + 1, j, l),
                        at(i + 1, j + 1, l),
                        at(i, j + 1, l),
                    ]);
                }
                for (axis, index) in [i, j, k].into_iter().enumerate().take(dim) {
                    for (end, here) in [(0, index == 0), (1, index + 1 == count[axis])] {
                        if here {
                            let facet = Facet {
                                cell,
                                local: 2 * axis + end,
                            };
                            let name = side_names(dim)[axis][end].to_owned();
                            sides.entry(name).or_default().push(facet);
                        }
                    }
                }
                cell += 1;
            }
        }
    }
    let mesh = Mesh::new(kind, nodes, grid, cells, sides);
    for cell in 0..mesh.cell_count() {
        let corners = mesh.corners(cell);
        let corners = &corners[..kind.nodes()];
        if (0..kind.nodes()).any(|i| kind.gradients(corners, &kind.corner(i)).1 <= 0.0) {
            return Err(FoldedCell {
                centre: mesh.centre(cell),
            });
        }
    }
    Ok(mesh)
}

/// Bending the grid lines folded a cell over.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the bent grid lines fold the cell at {centre:?} over")]
pub struct FoldedCell {
    /// Mean of the cell's node positions [m].
    pub centre: [f64; 3],
}

/// Shift of the last coordinate: s(x) r, see [`Follow`].
fn shift(follow: &Follow, spec: &MeshSpec, x: &[f64; 3]) -> f64 {
    let last = spec.lines.len() - 1;
    let slope = follow.angle.tan();
    let lines = &spec.lines[0];
    let (left, right) = (lines[0], lines[lines.len() - 1]);
    let from = (follow.point[0] - follow.half_length).max(left);
    let to = (follow.point[0] + follow.half_length).min(right);
    let s = if x[0] < from {
        slope * (from - follow.point[0]) * (x[0] - left) / (from - left)
    } else if x[0] > to {
        slope * (to - follow.point[0]) * (right - x[0]) / (right - to)
    } else {
        slope * (x[0] - follow.point[0])
    };
    // The row [low, high] that holds the point moves as a whole: the crack then keeps its place within the row.
    let levels = &spec.lines[last];
    let height = levels[levels.len() - 1] - levels[0];
    let on_line = |level: f64| (level - follow.point[last]).abs() <= 1e-9 * height;
    let above = levels.partition_point(|&level| level < follow.point[last] && !on_line(level));
    let high = levels[above.min(levels.len() - 1)];
    let low = if on_line(high) {
        high
    } else {
        levels[above.saturating_sub(1)]
    };
    let (bottom, top) = (levels[0], levels[levels.len() - 1]);
    let r = if x[last] < low {
        (x[last] - bottom) / (low - bottom)
    } else if x[last] > high {
        (top - x[last]) / (top - high)
    } else {
        1.0
    };
    s * r
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spec(lines: Vec<Vec<f64>>, follow: Option<Follow>) -> MeshSpec {
        MeshSpec {
            span: 0..0,
            lines,
            follow,
        }
    }

    #[test]
    fn sides_hold_their_facets_and_corners_meet() {
        let mesh = box_mesh(&spec(
            vec![
                vec![0.0, 1.0, 3.0],
                vec![0.0, 2.0],
                vec![0.0, 1.0, 2.0, 4.0],
            ],
            None,
        ))
        .unwrap();
        assert_eq!(mesh.cell_count(), 6);
        assert_eq!(mesh.sides["left"].len(), 3);
        assert_eq!(mesh.sides["front"].len(), 6);
        assert_eq!(mesh.sides["top"].len(), 2);
        for node in mesh.side_nodes("back") {
            assert_eq!(mesh.nodes[node][1], 2.0);
        }
        let edge = mesh.meeting_nodes(&["back".into(), "top".into()]);
        assert_eq!(edge.len(), 3);
        assert!(
            edge.iter()
                .all(|&n| mesh.nodes[n][1] == 2.0 && mesh.nodes[n][2] == 4.0)
        );
    }

    #[test]
    fn bent_grid_lines_follow_the_line_and_keep_the_border() {
        let lines: Vec<f64> = (0..=23)
            .map(|i| -10.0 + 20.0 * f64::from(i) / 23.0)
            .collect();
        let follow = Follow {
            span: 0..0,
            point: [0.0; 3],
            angle: std::f64::consts::FRAC_PI_4,
            half_length: 5.5,
        };
        let mesh = box_mesh(&spec(vec![lines.clone(), lines.clone()], Some(follow))).unwrap();
        let half_row = 10.0 / 23.0;
        for (x, grid) in mesh.nodes.iter().zip(&mesh.grid) {
            if x[0].abs() < 5.5 && (grid[1] == 11 || grid[1] == 12) {
                assert!(((x[1] - x[0]).abs() - half_row).abs() < 1e-12);
            }
            if grid[1] == 0 || grid[1] == 23 {
                assert_eq!(x[1].abs(), 10.0);
            }
            if grid[0] == 0 || grid[0] == 23 {
                assert_eq!(x[1], lines[grid[1] as usize]);
            }
        }
    }

    #[test]
    fn a_fold_is_refused() {
        let follow = Follow {
            span: 0..0,
            point: [0.0; 3],
            angle: 1.4,
            half_length: f64::INFINITY,
        };
        let lines = vec![vec![-1.0, 0.0, 1.0]; 2];
        assert!(box_mesh(&spec(lines, Some(follow))).is_err());
    }
}
