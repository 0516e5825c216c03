//! Bodies of a given size: about so many contact points, in a plate with many cracks or a block with planes or discs.
//!
//! A body is the text of a case, and depends on the seed and its numbers alone. Unit square or cube, E = 1 Pa, a random
//! Poisson's ratio; the bottom is held, the top is pushed down and sheared in one increment. Cracks lie on a lattice, so that
//! none comes near another by chance:
//!
//! ```text
//!   2D   field    one crack of random direction in every box of the lattice
//!        echelon  the same direction everywhere
//!        crosses  two cracks that cross in every box
//!   3D   planes   one slanted plane through the block, three for more than 1500 points
//!        discs    a disc in every box
//!        stack    two planes with a slab between them, which nothing but contact holds; four for more than 1500 points
//! ```

use std::f64::consts::PI;
use std::fmt::Write;
use std::ops::RangeInclusive;
use std::path::Path;

use stickslip_xfem::mesh::stream::Stream;

use super::{MOST, Problem, entries};
use crate::case::reader::Value;
use crate::case::{self, CaseError};

/// How many contact points a body may have.
pub const POINTS: RangeInclusive<usize> = 4..=20_000;

/// Friction coefficient of bodies and random problems where none is given.
pub const FRICTION: f64 = 0.3;

/// Names of all begin like this.
const NAME: &str = "bodies";

/// Contact points asked for of a body, by its name.
pub fn points_of(case: &str) -> Option<usize> {
    parts(case)?[1].parse().ok()
}

/// Dimension of a body, by its name.
pub fn dimension_of(case: &str) -> Option<usize> {
    parts(case)?[0].strip_suffix('d')?.parse().ok()
}

fn parts(case: &str) -> Option<[&str; 2]> {
    let rest = case.strip_prefix(NAME)?.strip_prefix('-')?;
    let (dim, rest) = rest.split_once('-')?;
    Some([dim, rest.split('-').next()?])
}

/// Most bodies of a size: each draws from a stream of its own.
const STREAMS: usize = 1000;

/// `bodies = { dimension = 3, seed = 1, points = [100, 1000], of_each = 5 }`.
///
/// # Errors
/// Numbers out of range.
pub(crate) fn read(value: Value<'_>, _: &Path) -> Result<Vec<Problem>, CaseError> {
    let table = value.table(&["dimension", "seed", "points", "of_each"])?;
    let dim = table.required("dimension")?.integer(2..=3)?;
    let seed = table.get("seed");
    let seed = seed.map_or(Ok(1), |v| v.integer(0..=usize::MAX))? as u64;
    let sizes = entries(table.required("points")?, |v| v.integer(POINTS))?;
    let of_each = table.required("of_each")?.integer(1..=STREAMS)?;
    if sizes.len().saturating_mul(of_each) > MOST {
        return Err(value.refuse(format!("at most {MOST} bodies"), "too many bodies"));
    }
    let all = sizes.iter().flat_map(|&points| {
        (0..of_each).map(move |number| Sized {
            dim,
            points,
            seed,
            number,
        })
    });
    all.map(|body| {
        let case = case::parse(format!("{}.toml", body.name()), body.text())?;
        let mut problem = Problem::of(&case);
        problem.subject.class = format!("{dim}d-{}", body.points);
        Ok(problem)
    })
    .collect()
}

/// A body by its numbers.
#[derive(Debug, Clone, Copy)]
pub struct Sized {
    /// 2 or 3.
    pub dim: usize,
    /// About how many contact points.
    pub points: usize,
    /// Seed of all bodies.
    pub seed: u64,
    /// Which of them.
    pub number: usize,
}

impl Sized {
    /// Name of the case: sorts by size.
    pub fn name(&self) -> String {
        let Self {
            dim,
            points,
            seed,
            number,
        } = self;
        format!("{NAME}-{dim}d-{points:05}-seed-{seed}-{number}")
    }

    /// The case file.
    pub fn text(&self) -> String {
        let which = (self.points * STREAMS + self.number) * 4 + self.dim;
        let mut stream = Stream::numbered(self.seed, which as u64);
        let (kind, cells, cracks) = match self.dim {
            2 => self.plate(&mut stream),
            _ => self.block(&mut stream),
        };
        let (model, zero, one) = match self.dim {
            2 => ("plane-strain", "[0, 0]", "[1, 1]"),
            _ => ("solid", "[0, 0, 0]", "[1, 1, 1]"),
        };
        let poisson = stream.between(0.0, 0.4);
        let mut top = vec![stream.between(-1.5e-3, 1.5e-3); self.dim - 1];
        top.push(stream.between(-2e-3, -5e-4));
        let mut text = format!(
            "title = \"{kind}\"\nmodel = \"{model}\"\n\n[material]\nyoung_pa = 1\npoisson = {poisson:?}\n\n\
             [mesh.box]\nmin_m = {zero}\nmax_m = {one}\ncells = {:?}\n",
            vec![cells; self.dim],
        );
        for crack in cracks {
            // Writing to a string cannot fail.
            let _ = write!(text, "\n[[crack]]\n{crack}\nfriction = {FRICTION}\n");
        }
        text + &format!(
            "\n[[support]]\non = \"bottom\"\ndisplacement_m = {zero}\n\
             \n[[support]]\non = \"top\"\ndisplacement_m = {top:?}\n"
        )
    }

    /// Kind, cells along a side, cracks.
    fn plate(&self, stream: &mut Stream) -> (&'static str, usize, Vec<String>) {
        /// Points of a crack in a body with many.
        const OF_ONE: f64 = 30.0;
        /// Length of a crack in a box of the lattice, and how far its middle may lie from that of the box.
        const LENGTH: f64 = 0.66;
        const ASIDE: f64 = 0.1;
        let kind = ["field", "echelon", "crosses"][self.number % 3];
        let of_box = if kind == "crosses" { 2 } else { 1 };
        let wanted = self.points as f64 / OF_ONE / of_box as f64;
        let side = wanted.sqrt().round().max(1.0) as usize;
        let length = LENGTH / side as f64;
        let common = stream.between(0.15 * PI, 0.85 * PI);
        let (mut cracks, mut crossed) = (Vec::new(), 0.0);
        for k in 0..side * side {
            let centre = [k % side, k / side]
                .map(|i| (i as f64 + 0.5 + stream.between(-ASIDE, ASIDE)) / side as f64);
            let first = match kind {
                "echelon" => common,
                _ => stream.between(0.0, PI),
            };
            let second = first + stream.between(0.25 * PI, 0.75 * PI);
            for angle in [first, second].into_iter().take(of_box) {
                let half = [angle.cos(), angle.sin()].map(|c| 0.5 * length * c);
                let ends = [-1.0, 1.0].map(|s| [0, 1].map(|a| centre[a] + s * half[a]));
                cracks.push(format!("points_m = {ends:?}"));
                crossed += length * (angle.cos().abs() + angle.sin().abs());
            }
        }
        // A crack has about two points for every three edges that it crosses.
        let cells = 1.4 * self.points as f64 / crossed;
        (kind, cells.round().max(4.0) as usize, cracks)
    }

    fn block(&self, stream: &mut Stream) -> (&'static str, usize, Vec<String>) {
        /// Radius of a disc in a box of the lattice.
        const RADIUS: f64 = 0.36;
        let kind = ["planes", "discs", "stack"][self.number % 3];
        let points = self.points as f64;
        let more = usize::from(self.points > 1500);
        if kind == "discs" {
            // As many boxes as leave a disc eight cells across: 0.36² π n² points in every layer of the lattice. Without tip
            // functions a disc ends a cell earlier.
            let layer = RADIUS * RADIUS * PI;
            let cells = |side: f64| (points / (layer * side)).sqrt() + 2.0 * side;
            let fits = |side: &usize| 2.0 * RADIUS * cells(*side as f64) >= 8.0 * *side as f64;
            let side = (1..=6).rev().find(fits).unwrap_or(1);
            let mut cracks = Vec::new();
            for k in 0..side.pow(3) {
                let place = [k % side, k / side % side, k / (side * side)];
                let centre =
                    place.map(|i| (i as f64 + 0.5 + stream.between(-0.05, 0.05)) / side as f64);
                let normal = [0, 1, 2].map(|_| stream.between(-1.0, 1.0));
                let radius = RADIUS / side as f64;
                cracks.push(format!(
                    "disc = {{ centre_m = {centre:?}, normal = {normal:?}, radius_m = {radius:?} }}\ntip = \"none\""
                ));
            }
            return (kind, cells(side as f64).round() as usize, cracks);
        }
        let count = match kind {
            "planes" => 1 + 2 * more,
            _ => 2 + 2 * more,
        };
        // A point for every vertical edge.
        let cells = ((points / count as f64).sqrt() - 1.0).round().max(2.0) as usize;
        let planes = (0..count).map(|k| {
            let height = (k as f64 + 1.0 + stream.between(-0.1, 0.1)) / (count as f64 + 1.0);
            let slope = [0, 1].map(|_| stream.between(-0.3, 0.3) / count as f64);
            let [a, b] = slope;
            format!("plane = {{ point_m = [0.5, 0.5, {height:?}], normal = [{a:?}, {b:?}, 1] }}")
        });
        (kind, cells, planes.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case;
    use crate::model::body::{Body, Needs};

    /// Goal: every body can be discretised, and has half to twice as many contact points as asked for.
    #[test]
    fn bodies_have_about_the_size_asked_for() {
        for dim in [2, 3] {
            for points in [10, 30, 100] {
                for number in 0..6 {
                    let own = Sized {
                        dim,
                        points,
                        seed: 1,
                        number,
                    };
                    assert_eq!(points_of(&own.name()), Some(points));
                    assert_eq!(dimension_of(&own.name()), Some(dim));
                    let case = case::parse("body.toml", own.text()).unwrap();
                    let body = Body::new(&case, 1, &Needs::default());
                    let found = body.map(|body| body.points.len());
                    let found = found.unwrap_or_else(|e| panic!("{}: {e}", own.name()));
                    println!("{}: {found}", own.name());
                    assert!(
                        (points / 2..=2 * points).contains(&found),
                        "{}: {found}",
                        own.name()
                    );
                }
            }
        }
    }
}
