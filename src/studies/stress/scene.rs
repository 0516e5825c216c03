//! Random bodies: box, mesh, material, cracks, supports and loads as the text of a case.
//!
//! Positions cluster where discretisations break: as good as on nodes, edges, sides, corners and other cracks, at distances
//! from 1e-14 of a cell. Nothing here knows how a body is discretised. Scene k of a seed can be made again alone.

pub mod flat;
mod grid;
pub mod solid;

use serde::{Deserialize, Serialize};
use stickslip_xfem::mesh::stream::Stream;

use self::flat::Flat;
use self::grid::{Grid, decades, list};
use self::solid::Flaw;
use super::places;
use super::uniform::{Uniform, sides};
use crate::case::CrackShape;

/// Share of the scenes with a mesh whose inner points are moved, where the cracks are not placed by grid points.
const MOVED: f64 = 0.2;

/// A crack as a case states it.
pub enum Shape {
    Flat(Flat),
    Solid(Flaw),
}

impl Shape {
    /// That of a case.
    pub fn of(shape: &CrackShape) -> Self {
        match shape {
            CrackShape::Polyline(points) => Shape::Flat(Flat::Chain(points.clone())),
            CrackShape::Arc {
                centre,
                radius,
                from,
                to,
            } => Shape::Flat(Flat::Arc {
                centre: *centre,
                radius: *radius,
                ends: [from.to_degrees(), to.to_degrees()],
            }),
            CrackShape::Plane { point, normal } => Shape::Solid(Flaw::plane(*point, *normal)),
            CrackShape::Ellipse(e) => Shape::Solid(Flaw::plane(e.centre, e.normal)),
        }
    }

    /// Length in a body, in a solid the smaller width of the whole crack [m].
    fn length_in(&self, body: &Uniform) -> f64 {
        match self {
            Shape::Flat(f) => f.length_in(&body.min, &body.max),
            Shape::Solid(f) => f.width(),
        }
    }
}

/// Kinds of scenes: what is known of the answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Plane bodies in uniform compression whose cracks stick: the closed form.
    Patch2d,
    /// Solids, the same.
    Patch3d,
    /// Plane bodies pushed and sheared, with friction: energy, agreement, invariance.
    Slip2d,
    /// Solids, the same.
    Slip3d,
    /// One parameter at a time through its decades; see [`places`](super::places).
    Ladder,
}

impl Family {
    /// All, in the order of reports.
    pub const ALL: [Self; 5] = [
        Self::Patch2d,
        Self::Patch3d,
        Self::Slip2d,
        Self::Slip3d,
        Self::Ladder,
    ];

    /// As on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Patch2d => "patch-2d",
            Self::Patch3d => "patch-3d",
            Self::Slip2d => "slip-2d",
            Self::Slip3d => "slip-3d",
            Self::Ladder => "ladder",
        }
    }

    /// Whether its scenes are drawn: the others are the same for every seed.
    pub fn is_random(self) -> bool {
        self != Self::Ladder
    }
}

/// A case to be examined.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Its family.
    pub family: Family,
    /// Number in its series; with family and seed it makes the scene again alone.
    pub number: u64,
    /// How its cracks lie; of a ladder its name.
    pub category: String,
    /// Space dimension.
    pub dim: usize,
    /// The case, as TOML.
    pub text: String,
    /// Whether no mesh of such cells can carry it: two cracks within 1e-6 of a cell along each other, or a crack without tip
    /// functions that is shorter than two cells.
    pub beyond: bool,
}

/// The step of a ladder, by its number.
fn step(number: u64) -> Scene {
    let (_, ladder, step) = places::step(number);
    Scene {
        family: Family::Ladder,
        number,
        category: ladder.name.clone(),
        dim: ladder.dim,
        text: step.text.clone(),
        beyond: false,
    }
}

/// The scene with a number among those of a family and a seed.
pub fn scene(family: Family, seed: u64, number: u64) -> Scene {
    let (dim, sticks) = match family {
        Family::Patch2d => (2, true),
        Family::Patch3d => (3, true),
        Family::Slip2d => (2, false),
        Family::Slip3d => (3, false),
        Family::Ladder => return step(number),
    };
    let s = &mut Stream::numbered(seed, 2 * number + dim as u64 % 2);
    let kinds = if dim == 2 { flat::KINDS } else { solid::KINDS };
    let kind = (number % kinds.len() as u64) as usize;
    let (category, by_grid, round) = kinds[kind];
    let grid = grid(dim, dim == 3 && round, s);
    let motion = if dim == 2 && !by_grid && s.chance(MOVED) {
        let steep = grid.size(0).max(grid.size(1)) / grid.least() > 1.5;
        if s.chance(0.5) {
            let (amplitude, seed) = (s.between(0.02, 0.25), s.whole(1, 1000));
            format!("[mesh.distort]\namplitude = {amplitude:?}\nseed = {seed}\n")
        } else {
            let most = if steep { 8.0 } else { 30.0 };
            format!("[mesh.twist]\nangle_deg = {:?}\n", s.between(-most, most))
        }
    } else {
        String::new()
    };
    let hydrostatic = dim == 2 && round || s.chance(0.25);
    let (model, material, exact) = stressed(dim, hydrostatic, &grid, s);
    let mut text = format!("title = \"{category}\"\nmodel = \"{model}\"\ntolerance = 1e-12\n");
    text += &material;
    text += &mesh(&grid, s);
    text += &motion;
    let cracks: Vec<Shape> = if dim == 2 {
        // One that leaves the body where it begins is none.
        let inside = |f: &Flat| f.length_in(&exact.min, &exact.max) > 0.3 * grid.h();
        let mut cracks = flat::cracks(category, &grid, s);
        while !cracks.iter().all(inside) {
            cracks = flat::cracks(category, &grid, s);
        }
        cracks.into_iter().map(Shape::Flat).collect()
    } else {
        solid::cracks(category, &grid, s)
            .into_iter()
            .map(Shape::Solid)
            .collect()
    };
    // Further draws of the other family leave these as they are.
    let mut own = Stream::numbered(seed ^ 0x5eed, number);
    let mut beyond = match &cracks[..] {
        [Shape::Flat(one), Shape::Flat(two)] => {
            category == "parallel" && flat::apart(one, two) < 1e-6 * grid.h()
        }
        _ => false,
    };
    // Without friction a part that a crack cuts off, or a ring around a disc, would move freely.
    let held = ["inner", "short", "disc", "ellipse"].contains(&category) && cracks.len() == 1;
    for crack in &cracks {
        let needed = match crack {
            Shape::Flat(f) => f.normals().iter().map(|n| exact.steepness(n)).collect(),
            Shape::Solid(f) => vec![exact.steepness(&f.normal())],
        };
        let needed = needed.into_iter().fold(0.0, f64::max);
        let smooth = hydrostatic && held && s.chance(0.3);
        let friction = match sticks {
            true if smooth => 0.0,
            true => 2.0 * needed + 0.1,
            false => decades(&mut own, -1.3, 0.3),
        };
        let (place, ends) = match crack {
            Shape::Flat(f) => (f.text(), !f.is_closed()),
            Shape::Solid(f) => (f.text(), f.has_front()),
        };
        text += &format!("[[crack]]\n{place}friction = {friction:?}\n");
        if ends {
            text += &match s.whole(0, 3) {
                0 => String::new(),
                1 => {
                    beyond |= crack.length_in(&exact) < 2.0 * exact.cell;
                    "tip = \"none\"\n".to_owned()
                }
                2 => "tip = \"branch\"\n".to_owned(),
                _ => {
                    let radius = s.between(0.3, if dim == 2 { 6.0 } else { 2.0 }) * grid.h();
                    format!("tip = {{ branch_radius_m = {radius:?} }}\n")
                }
            };
        }
        // By name or by default.
        text += match s.whole(0, 5) {
            2 => "contact = \"star\"\n",
            _ => "",
        };
    }
    text += &if sticks {
        held_and_loaded(&exact, s.chance(0.5))
    } else {
        pushed(&exact, &mut own)
    };
    Scene {
        family,
        number,
        category: category.into(),
        dim,
        text,
        beyond,
    }
}

/// Grid lines of a random box: of any size, far from the origin at times, graded or with slender cells at times;
/// even: about a cube, in cells of about one size.
fn grid(dim: usize, even: bool, s: &mut Stream) -> Grid {
    let size = decades(s, -3.0, 3.0);
    let far = if s.chance(0.15) {
        decades(s, 0.0, 3.0)
    } else {
        f64::from(u8::from(s.chance(0.5)))
    };
    let most = if dim == 2 { 20 } else { 6 };
    let cells: Vec<usize> = (0..dim)
        .map(|_| s.whole(if even { 4 } else { 3 }, most))
        .collect();
    let mut sides: Vec<f64> = vec![size];
    let aspect = if even { 0.15 } else { 0.47 };
    sides.extend((1..dim).map(|_| size * decades(s, -aspect, aspect)));
    if dim == 2 && s.chance(0.1) {
        // Cells of up to 50 : 1.
        let slender = decades(s, -1.7, 1.7);
        sides[1] = sides[0] / cells[0] as f64 * cells[1] as f64 * slender;
    } else if s.chance(0.2) {
        // Square cells.
        for a in 1..dim {
            sides[a] = sides[0] / cells[0] as f64 * cells[a] as f64;
        }
    }
    let graded = s.chance(0.15) && !even;
    let mut lines = Vec::new();
    for a in 0..dim {
        let min = far * size * s.between(-1.0, 1.0);
        let ratio: f64 = if graded { s.between(0.77, 1.3) } else { 1.0 };
        let n = cells[a];
        let sum = |i: usize| (0..i).map(|k| ratio.powi(k as i32)).sum::<f64>();
        let part = |i: usize| {
            if graded {
                sum(i) / sum(n)
            } else {
                i as f64 / n as f64
            }
        };
        let max = min + sides[a];
        let mut own: Vec<f64> = (0..=n).map(|i| min + (max - min) * part(i)).collect();
        own[n] = max;
        lines.push(own);
    }
    Grid { dim, lines }
}

/// `[mesh]`: as a box where the lines are even, half of the time.
fn mesh(grid: &Grid, s: &mut Stream) -> String {
    let even = (0..grid.dim).all(|a| {
        let n = grid.lines[a].len() - 1;
        let step = grid.size(a) / n as f64;
        (0..n).all(|i| (grid.lines[a][i + 1] - grid.lines[a][i] - step).abs() < 1e-3 * step)
    });
    let as_box = s.chance(0.7);
    if !even || !as_box {
        let lines: Vec<String> = grid.lines.iter().map(|l| list(l)).collect();
        return format!("[mesh]\nlines_m = [{}]\n", lines.join(", "));
    }
    let all = |f: &dyn Fn(usize) -> f64| list(&(0..grid.dim).map(f).collect::<Vec<_>>());
    let cells: Vec<usize> = grid.lines.iter().map(|l| l.len() - 1).collect();
    format!(
        "[mesh.box]\nmin_m = {}\nmax_m = {}\ncells = {cells:?}\n",
        all(&|a| grid.min(a)),
        all(&|a| grid.max(a))
    )
}

/// Model, `[material]` and the closed form.
fn stressed(
    dim: usize,
    hydrostatic: bool,
    grid: &Grid,
    s: &mut Stream,
) -> (&'static str, String, Uniform) {
    let young = decades(s, -3.0, 12.0);
    let poisson = if s.chance(0.1) {
        0.0
    } else {
        s.between(0.0, 0.49)
    };
    let plane_stress = s.chance(0.4);
    let base = -young * decades(s, -6.0, -2.0);
    let mut stress = [0.0; 3];
    for value in &mut stress[..dim] {
        *value = base
            * if hydrostatic {
                1.0
            } else {
                s.between(0.28, 1.0)
            };
    }
    let mut across = stress;
    if dim == 2 && !plane_stress {
        across[2] = poisson * (stress[0] + stress[1]);
    }
    let total: f64 = across.iter().sum();
    let mut strain = [0.0; 3];
    for a in 0..dim {
        strain[a] = (across[a] - poisson * (total - across[a])) / young;
    }
    let model = match (dim, plane_stress) {
        (3, _) => "solid",
        (_, true) => "plane-stress",
        _ => "plane-strain",
    };
    let corner = |f: &dyn Fn(usize) -> f64| [0, 1, 2].map(|a| if a < dim { f(a) } else { 0.0 });
    let exact = Uniform {
        dim,
        min: corner(&|a| grid.min(a)),
        max: corner(&|a| grid.max(a)),
        stress,
        strain,
        cell: grid.cell(),
    };
    let material = format!("[material]\nyoung_pa = {young:?}\npoisson = {poisson:?}\n");
    (model, material, exact)
}

/// Rollers on the lower sides; on the upper ones the pressure or the displacement of the closed form.
fn held_and_loaded(exact: &Uniform, moved: bool) -> String {
    let mut text = String::new();
    for (a, [low, high]) in sides(exact.dim).iter().enumerate() {
        let mut roller = |side: &str, value: f64| {
            let entry = |b| {
                if b == a {
                    format!("{value:?}")
                } else {
                    "\"free\"".to_owned()
                }
            };
            let entries: Vec<String> = (0..exact.dim).map(entry).collect();
            let entries = entries.join(", ");
            text += &format!("[[support]]\non = \"{side}\"\ndisplacement_m = [{entries}]\n");
        };
        roller(low, 0.0);
        if moved {
            roller(high, exact.displacement(&exact.max)[a]);
        } else {
            let pressure = -exact.stress[a];
            text += &format!("[[load]]\non = \"{high}\"\npressure_pa = {pressure:?}\n");
        }
    }
    text
}

/// The bottom held, the top pushed and sheared; a side pressed at times.
fn pushed(exact: &Uniform, s: &mut Stream) -> String {
    let dim = exact.dim;
    let up = dim - 1;
    let size = (exact.max[up] - exact.min[up]) * decades(s, -6.0, -2.0);
    let top: Vec<f64> = (0..dim)
        .map(|a| {
            size * if a == up {
                -s.between(0.2, 1.0)
            } else {
                s.between(-1.0, 1.0)
            }
        })
        .collect();
    let mut text = format!(
        "[[support]]\non = \"bottom\"\ndisplacement_m = {}\n[[support]]\non = \"top\"\ndisplacement_m = {}\n",
        list(&vec![0.0; dim]),
        list(&top)
    );
    if s.chance(0.5) {
        let pressure = exact.size() * s.between(0.0, 1.0);
        text += &format!("[[load]]\non = \"right\"\npressure_pa = {pressure:?}\n");
    }
    text
}
