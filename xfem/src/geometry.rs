//! Points, curves, convex parts, crack shapes and the coordinates of their tips. Knows nothing of meshes.

pub mod boxes;
mod branch_functions;
pub mod chain;
pub mod clip;
pub mod crack_shape;
pub mod curve;
pub mod ellipse;
pub mod polygon;
pub mod segments;
pub mod tip_frame;

/// A point or vector in space; the third entry is 0 in 2D.
pub type Point = [f64; 3];

/// L points or vectors, coordinate by coordinate: loops over them work on several at once.
pub type Points<const L: usize> = [[f64; L]; 3];

/// a · b
pub fn dot(a: &Point, b: &Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a − b
pub fn sub(a: &Point, b: &Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a + s b
pub fn add_scaled(a: &Point, s: f64, b: &Point) -> Point {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// a × b
pub fn cross(a: &Point, b: &Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// |a|
pub fn norm(a: &Point) -> f64 {
    dot(a, a).sqrt()
}

/// Mean of points.
pub fn mean<'a>(points: impl IntoIterator<Item = &'a Point, IntoIter: ExactSizeIterator>) -> Point {
    let points = points.into_iter();
    let share = 1.0 / points.len() as f64;
    points.fold([0.0; 3], |sum, x| add_scaled(&sum, share, x))
}

/// Largest distance between two of some points [m].
pub fn diameter(points: &[Point]) -> f64 {
    let mut largest: f64 = 0.0;
    for (i, p) in points.iter().enumerate() {
        for q in &points[..i] {
            largest = largest.max(norm(&sub(p, q)));
        }
    }
    largest
}

/// Components of a vector along unit vectors.
pub fn resolve<const N: usize>(axes: &[Point; N], v: &Point) -> [f64; N] {
    axes.map(|axis| dot(&axis, v))
}

/// The vector with given components along unit vectors.
pub fn combine(axes: &[Point; 3], components: [f64; 3]) -> Point {
    let terms = components.iter().zip(axes);
    terms.fold([0.0; 3], |x, (value, e)| add_scaled(&x, *value, e))
}

/// The tensor with given components along unit vectors.
pub fn rotated(axes: &[Point; 3], local: &[Point; 3]) -> [Point; 3] {
    let on = local.map(|row| combine(axes, row));
    [0, 1, 2].map(|k| combine(axes, on.map(|row| row[k])))
}

/// Where a condition ends that holds at `holding` and not at `failing`, by bisection.
pub fn bisect(mut holding: f64, mut failing: f64, holds: impl Fn(f64) -> bool) -> f64 {
    // Halvings down to rounding.
    for _ in 0..60 {
        let middle = 0.5 * (holding + failing);
        if holds(middle) {
            holding = middle;
        } else {
            failing = middle;
        }
    }
    0.5 * (holding + failing)
}

/// Root of an item in a forest of joined sets; halves the path to it.
pub fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// Joins the sets of two items; the lower root stays.
pub fn unite(parent: &mut [usize], i: usize, j: usize) {
    let [a, b] = [i, j].map(|k| root(parent, k));
    parent[a.max(b)] = a.min(b);
}

/// a / |a|; the argument must not vanish.
pub fn unit(a: &Point) -> Point {
    let length = norm(a);
    [a[0] / length, a[1] / length, a[2] / length]
}
