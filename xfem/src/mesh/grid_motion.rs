//! Grid points moved inside a box whose border stays: lines that follow a crack, turned lines, random places.
//!
//! ```text
//!   follow    x_last += s(x) r                                              see `Follow`
//!   twist     x ← c + R(α w(s) w(t)) (x − c),  w(s) = (1 − s²)²             s, t = ±1 on the border, w = w' = 0 there
//!   distort   x_a += a h_a ξ,  ξ uniform in (−1, 1), h_a the narrower of the two intervals beside the point
//! ```
//!
//! Follow and twist are maps of space, so a refined mesh is a refinement of the same map. Random places are drawn anew for
//! every mesh, each from a stream of its own.

use super::stream::Stream;

/// Grid lines that follow a straight line inside the body and stay straight on its border.
///
/// The last coordinate (y in 2D, z in 3D) of a grid point is shifted by s(x) · r: s(x) = (x − x₀) tan(angle) within
/// `half_length` of the point (measured along x), returning linearly to 0 at the sides x = min, max; r falls linearly
/// from 1 on the row (or grid line) that holds the point to 0 at the two ends of that axis. Every cell must keep a
/// positive height.
#[derive(Debug, Clone)]
pub struct Follow {
    /// A point of the line [m], inside the box.
    pub point: [f64; 3],
    /// Angle from the x axis [rad], less than 80 degrees either way.
    pub angle: f64,
    /// Half of the followed extent along x [m], less than the distance to either side; infinite: the line is followed
    /// from side to side.
    pub half_length: f64,
}

/// Grid lines turned about the centre of a 2D box by angle × w(x) w(y), w(s) = (1 − s²)² with s = ±1 on the border: the
/// border and the directions of the lines there stay.
#[derive(Debug, Clone)]
pub struct Twist {
    /// Turn at the centre, counter-clockwise [rad], less than 180 degrees either way.
    pub angle: f64,
}

/// Inner nodes moved along every axis by up to amplitude × the narrower interval between grid lines beside them.
#[derive(Debug, Clone)]
pub struct Distort {
    /// Largest move in intervals, 0 <= amplitude < 0.5.
    pub amplitude: f64,
    /// Seed of the moves; every node has a stream of its own.
    pub seed: u64,
}

/// Shift of the last coordinate: s(x) r, see [`Follow`].
pub fn follow_shift(follow: &Follow, lines: &[Vec<f64>], x: &[f64; 3]) -> f64 {
    let last = lines.len() - 1;
    let slope = follow.angle.tan();
    let (left, right) = (lines[0][0], lines[0][lines[0].len() - 1]);
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
    let levels = &lines[last];
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

/// Whether a grid point lies on the border of the box.
fn on_border(lines: &[Vec<f64>], grid: &[u32; 3]) -> bool {
    let mut axes = lines.iter().zip(grid);
    axes.any(|(line, &i)| i == 0 || i as usize + 1 == line.len())
}

/// Place of a 2D grid point after turning.
pub fn twisted(twist: &Twist, lines: &[Vec<f64>], grid: &[u32; 3], x: &[f64; 3]) -> [f64; 3] {
    if on_border(lines, grid) {
        return *x;
    }
    let ends = |axis: usize| {
        let line = &lines[axis];
        (line[0], line[line.len() - 1])
    };
    let centre = [0, 1].map(|a| 0.5 * (ends(a).0 + ends(a).1));
    let weight = |a: usize| {
        let s = (x[a] - centre[a]) / (0.5 * (ends(a).1 - ends(a).0));
        (1.0 - s * s).powi(2)
    };
    let (sin, cos) = (twist.angle * weight(0) * weight(1)).sin_cos();
    let d = [x[0] - centre[0], x[1] - centre[1]];
    [
        centre[0] + cos * d[0] - sin * d[1],
        centre[1] + sin * d[0] + cos * d[1],
        x[2],
    ]
}

/// Place of a grid point, the `node`-th of the mesh, after its random move.
pub fn distorted(
    distort: &Distort,
    lines: &[Vec<f64>],
    node: usize,
    grid: &[u32; 3],
    x: &[f64; 3],
) -> [f64; 3] {
    if on_border(lines, grid) {
        return *x;
    }
    let mut stream = Stream::numbered(distort.seed, node as u64);
    let mut moved = *x;
    for (axis, line) in lines.iter().enumerate() {
        let i = grid[axis] as usize;
        let size = (line[i + 1] - line[i]).min(line[i] - line[i - 1]);
        moved[axis] += distort.amplitude * size * stream.between(-1.0, 1.0);
    }
    moved
}
