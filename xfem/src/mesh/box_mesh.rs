//! Structured meshes of boxes: uniform or graded grid lines, optionally moved inside the box.

use std::collections::BTreeMap;

use crate::geometry::Point;

use super::cell::CellKind;
use super::grid_motion::{self, Distort, Follow, Twist};
use super::{Facet, Mesh};

/// Names of the sides per axis: minimum, maximum.
pub fn side_names(dim: usize) -> &'static [[&'static str; 2]] {
    match dim {
        2 => &[["left", "right"], ["bottom", "top"]],
        _ => &[["left", "right"], ["front", "back"], ["bottom", "top"]],
    }
}

/// The grid of a box and what moves its points.
#[derive(Debug, Clone)]
pub struct GridSpec {
    /// Grid-line coordinates per axis, strictly increasing, at least two each; `dim` axes [m].
    pub lines: Vec<Vec<f64>>,
    /// Bends the second family of grid lines so that it follows a straight line.
    pub follow: Option<Follow>,
    /// Turns the grid lines about the centre; after following, 2D only.
    pub twist: Option<Twist>,
    /// Moves the inner nodes at random; after everything else, 2D only.
    pub distort: Option<Distort>,
}

impl GridSpec {
    /// A grid whose points stay where its lines cross.
    pub fn new(lines: Vec<Vec<f64>>) -> Self {
        GridSpec {
            lines,
            follow: None,
            twist: None,
            distort: None,
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> f64 {
        self.lines.iter().map(|l| (l.len() - 1) as f64).product()
    }

    /// Lowest and highest corner; third entries 0 in 2D [m].
    pub fn extents(&self) -> [Point; 2] {
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        for (axis, line) in self.lines.iter().enumerate() {
            (low[axis], high[axis]) = (line[0], line[line.len() - 1]);
        }
        [low, high]
    }

    /// Largest distance of neighbouring lines [m].
    pub fn cell_size(&self) -> f64 {
        let pairs = self.lines.iter().flat_map(|line| line.windows(2));
        pairs.map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
    }

    /// The same box with every interval of every axis divided into `factor` >= 1 equal parts.
    ///
    /// The given grid lines keep their bits, so probes and sides stay where they are. Zero is taken as one.
    pub fn refined(&self, factor: usize) -> GridSpec {
        let parts = factor.max(1) as f64;
        let divided = |line: &Vec<f64>| {
            let inner = |w: &[f64]| {
                let (a, b) = (w[0], w[1]);
                // j = 0 keeps a as it is; the interpolation would round it.
                (0..factor.max(1)).map(move |j| {
                    if j == 0 {
                        a
                    } else {
                        (a * (parts - j as f64) + b * j as f64) / parts
                    }
                })
            };
            line.windows(2)
                .flat_map(inner)
                .chain(line.last().copied())
                .collect()
        };
        GridSpec {
            lines: self.lines.iter().map(divided).collect(),
            ..self.clone()
        }
    }
}

/// The motion of grid points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// [`GridSpec::follow`].
    Follow,
    /// [`GridSpec::twist`].
    Twist,
    /// [`GridSpec::distort`].
    Distort,
}

/// Builds the mesh of a box.
///
/// Fails with the offending cell if moved grid points fold it over.
pub fn box_mesh(spec: &GridSpec) -> Result<Mesh, FoldedCell> {
    let dim = spec.lines.len();
    let kind = if dim == 2 {
        CellKind::Quad4
    } else {
        CellKind::Hex8
    };
    let lines = [0, 1, 2].map(|axis| spec.lines.get(axis).map_or(1, Vec::len));
    let mut nodes = Vec::with_capacity(lines.iter().product());
    let mut grid = Vec::with_capacity(nodes.capacity());
    for position in positions(lines) {
        let mut x = [0.0; 3];
        for (axis, line) in spec.lines.iter().enumerate() {
            x[axis] = line[position[axis]];
        }
        nodes.push(x);
        grid.push(position.map(|i| i as u32));
    }
    let intervals = lines.map(|count| count.max(2) - 1);
    let mut cells = Vec::with_capacity(kind.nodes() * intervals.iter().product::<usize>());
    let mut sides: BTreeMap<String, Vec<Facet>> = BTreeMap::new();
    for (cell, position) in positions(intervals).enumerate() {
        cells.extend((0..kind.nodes()).map(|node| {
            let corner = kind.corner(node);
            let [i, j, k] = [0, 1, 2].map(|a| position[a] + usize::from(corner[a] > 0.0));
            (i + lines[0] * (j + lines[1] * k)) as u32
        }));
        for (axis, names) in side_names(dim).iter().enumerate() {
            let last = intervals[axis] - 1;
            for (end, border) in [0, last].into_iter().enumerate() {
                if position[axis] == border {
                    let local = 2 * axis + end;
                    let side = sides.entry(names[end].to_owned()).or_default();
                    side.push(Facet { cell, local });
                }
            }
        }
    }
    let mut mesh = Mesh::new(kind, nodes, grid, cells, sides);
    if let Some(follow) = &spec.follow {
        let shift = |_: usize, _: &[u32; 3], x: &[f64; 3]| {
            let mut x = *x;
            x[dim - 1] += grid_motion::follow_shift(follow, &spec.lines, &x);
            x
        };
        move_nodes(&mut mesh, Motion::Follow, shift)?;
    }
    if let Some(twist) = &spec.twist {
        let turn = |_, grid: &_, x: &_| grid_motion::twisted(twist, &spec.lines, grid, x);
        move_nodes(&mut mesh, Motion::Twist, turn)?;
    }
    if let Some(distort) = &spec.distort {
        let shake = |n, grid: &_, x: &_| grid_motion::distorted(distort, &spec.lines, n, grid, x);
        move_nodes(&mut mesh, Motion::Distort, shake)?;
    }
    Ok(mesh)
}

/// Moves every node.
fn move_nodes(
    mesh: &mut Mesh,
    motion: Motion,
    place: impl Fn(usize, &[u32; 3], &Point) -> Point,
) -> Result<(), FoldedCell> {
    for node in 0..mesh.nodes.len() {
        mesh.nodes[node] = place(node, &mesh.grid[node], &mesh.nodes[node]);
    }
    for map in (0..mesh.cell_count()).map(|cell| mesh.map(cell)) {
        let kind = map.kind;
        if (0..kind.nodes()).any(|i| map.determinant(&kind.corner(i)) <= 0.0) {
            let centre = map.centre();
            return Err(FoldedCell { centre, motion });
        }
    }
    Ok(())
}

/// Positions in a box of so many per axis, the first axis fastest.
fn positions([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let row = move |j, k| (0..nx).map(move |i| [i, j, k]);
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| row(j, k)))
}

/// Moving grid points folded a cell over.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the moved grid points fold the cell at {centre:?} over")]
pub struct FoldedCell {
    /// Mean of the cell's node positions [m].
    pub centre: Point,
    /// Which motion did.
    pub motion: Motion,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{norm, sub};
    use crate::mesh::grid_motion::{Distort, Twist};

    fn unit_square(cells: usize) -> GridSpec {
        let line: Vec<f64> = (0..=cells).map(|i| i as f64 / cells as f64).collect();
        GridSpec::new(vec![line.clone(), line])
    }

    fn twist(degrees: f64) -> Option<Twist> {
        Some(Twist {
            angle: f64::to_radians(degrees),
        })
    }

    /// Goal: every point keeps its distance from the centre and turns by α w w; lines at the centre turn by α, the border
    /// and its neighbourhood stay; the nodes a refined mesh shares with the coarse one are at the same places.
    #[test]
    fn a_twist_turns_the_lines_at_the_centre_and_keeps_the_border() {
        let mut coarse = unit_square(8);
        coarse.twist = twist(30.0);
        let mesh = box_mesh(&coarse).unwrap();
        let plain = box_mesh(&unit_square(8)).unwrap();
        let centre = [0.5, 0.5, 0.0];
        for ((x, start), grid) in mesh.nodes.iter().zip(&plain.nodes).zip(&mesh.grid) {
            let (d, e) = (sub(x, &centre), sub(start, &centre));
            assert!((norm(&d) - norm(&e)).abs() < 1e-15);
            if grid[..2].iter().any(|&i| i == 0 || i == 8) {
                assert_eq!(x, start);
            } else if norm(&e) > 0.0 {
                let w = |s: f64| (1.0 - 4.0 * s * s).powi(2);
                let turned = (d[1] * e[0] - d[0] * e[1]).atan2(d[0] * e[0] + d[1] * e[1]);
                let wanted = 30f64.to_radians() * w(e[0]) * w(e[1]);
                assert!((turned - wanted).abs() < 1e-14, "{start:?}");
            }
        }
        let fine = box_mesh(&coarse.refined(3)).unwrap();
        for (x, grid) in mesh.nodes.iter().zip(&mesh.grid) {
            let there = fine.nodes[(3 * grid[0] + 25 * 3 * grid[1]) as usize];
            assert!(norm(&sub(x, &there)) < 1e-15);
        }
        // Turned so far that lines cross.
        for (degrees, folds) in [(89.0, false), (179.0, true)] {
            coarse.twist = twist(degrees);
            let folded = box_mesh(&coarse.refined(4)).err().map(|fold| fold.motion);
            assert_eq!(folded, folds.then_some(Motion::Twist), "{degrees}");
        }
    }

    /// Goal: interior nodes move by up to the stated part of the narrower interval beside them, in both senses, along all
    /// axes; the border stays; the same seed gives the same mesh, another one another.
    #[test]
    fn a_distorted_mesh_moves_interior_nodes_only_and_is_reproducible() {
        let graded = vec![0.0, 0.1, 0.3, 0.6, 1.0, 1.4, 1.7, 1.9, 2.0];
        for dim in [2, 3] {
            let plain = GridSpec::new(vec![graded.clone(); dim]);
            let moved = |seed| {
                let mut spec = plain.clone();
                let amplitude = 0.25;
                spec.distort = Some(Distort { amplitude, seed });
                box_mesh(&spec).unwrap()
            };
            let (mesh, start) = (moved(1), box_mesh(&plain).unwrap());
            let mut extreme = [0.0f64; 2];
            for ((x, s), grid) in mesh.nodes.iter().zip(&start.nodes).zip(&mesh.grid) {
                let border = grid[..dim].iter().any(|&i| i == 0 || i == 8);
                for a in 0..dim {
                    if border {
                        assert_eq!(x[a], s[a]);
                        continue;
                    }
                    let i = grid[a] as usize;
                    let size = (graded[i + 1] - graded[i]).min(graded[i] - graded[i - 1]);
                    let part = (x[a] - s[a]) / size;
                    assert!(part.abs() <= 0.25 + 1e-12, "{part}");
                    extreme = [extreme[0].min(part), extreme[1].max(part)];
                }
            }
            assert!(extreme[0] < -0.2 && extreme[1] > 0.2, "{extreme:?}");
            assert_eq!(mesh.nodes, moved(1).nodes);
            assert_ne!(mesh.nodes, moved(2).nodes);
        }
    }
}
