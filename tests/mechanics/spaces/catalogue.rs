//! Bodies and cracks of the patch tests, as case files.
//!
//! ```text
//!   plane    1 × 2 m, 6 × 12 cells, straight or moved at random; cracks at a distance from the middle node
//!   solid    1 × 1 × 1 m, 4 × 4 × 4 cells; planes at a distance from the middle node
//! ```

use crate::common::{load, parse, support};
use stickslip_xfem::geometry::{Point, add_scaled, dot, norm, sub, unit};
use stickslip_xfem::mesh::box_mesh::box_mesh;

use super::text::{POISSON, PRESSURE, YOUNG, boundary, chain, head, parted, uniform};

/// Distances of the crack from a node in cell sizes, on both sides of it.
pub const DISTANCES: [f64; 27] = [
    3e-1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 0.0, -1e-12,
    -1e-11, -1e-10, -1e-9, -1e-8, -1e-7, -1e-6, -1e-5, -1e-4, -1e-3, -1e-2, -1e-1, -3e-1,
];

/// Course of the crack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum State {
    /// Closed under hydrostatic pressure, without friction.
    Hydrostatic,
    /// Sticks under a stress with all components.
    Stick,
    /// Open, free of traction beside a stress along it.
    Open,
    /// Slides as a whole.
    Slide,
    /// The sliding block with friction enough to hold.
    Held,
}

/// Conditions on the boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loaded {
    /// Displacements on all sides: the crack leaves through held sides.
    Displacement,
    /// Tractions and just enough supports: the crack leaves through free sides.
    Traction,
}

/// A patch test.
pub struct Patch {
    /// Course of the crack.
    pub state: State,
    /// Shape and direction of the crack.
    pub crack: String,
    /// Mesh: `regular` or how it is distorted.
    pub mesh: String,
    /// Distance of the crack from a node in cell sizes; positive with the node on side 2.
    pub distance: f64,
    /// The case file.
    pub text: String,
}

/// Angles of straight cracks [degrees].
const ANGLES: [f64; 6] = [0.0, 1e-8, 10.0, 27.0, 45.0, 90.0];

/// A grid of a patch test with the node its crack passes.
struct Grid {
    name: &'static str,
    /// `[mesh]` as TOML.
    text: String,
    node: Point,
    /// Cell size [m].
    size: f64,
}

impl Grid {
    /// The grid whose node next to `near` the crack passes.
    fn new(name: &'static str, model: &str, text: String, near: Point, size: f64) -> Self {
        let mesh = box_mesh(&parse(&head(model, &text)).mesh.grid).unwrap();
        let away = |x: &Point| norm(&sub(x, &near));
        let nearest = mesh.nodes.iter().min_by(|p, q| away(p).total_cmp(&away(q)));
        Grid {
            name,
            node: *nearest.unwrap(),
            text,
            size,
        }
    }
}

fn flat_grids() -> [Grid; 2] {
    let grid = |name, motion: &str| {
        let text = format!(
            "mesh = {{ box = {{ min_m = [0, 0], max_m = [1, 2], cells = [6, 12] }}{motion} }}\n"
        );
        Grid::new(name, "plane-strain", text, [0.5, 1.0, 0.0], 1.0 / 6.0)
    };
    [
        grid("regular", ""),
        grid("distorted 25 %", ", distort = { amplitude = 0.25 }"),
    ]
}

fn direction(degrees: f64) -> Point {
    // Exact along the axes: a crack at 90 degrees is meant to run along grid lines.
    if degrees == 90.0 {
        return [0.0, 1.0, 0.0];
    }
    let (s, c) = degrees.to_radians().sin_cos();
    [c, s, 0.0]
}

fn turned(t: &Point) -> Point {
    [-t[1], t[0], 0.0]
}

/// Patch tests in the plane.
pub fn flat(distances: &[f64]) -> Vec<Patch> {
    let mut patches = Vec::new();
    for grid in flat_grids() {
        for &distance in distances {
            let at = |state, crack: &str, rest: String| Patch {
                state,
                crack: crack.to_owned(),
                mesh: grid.name.to_owned(),
                distance,
                text: head("plane-strain", &grid.text) + &rest,
            };
            for degrees in ANGLES {
                let t = direction(degrees);
                let c = add_scaled(&grid.node, distance * grid.size, &turned(&t));
                let mut tests = straight(&c, &t);
                if degrees < 90.0 {
                    tests.extend(blocks(&c, &t));
                }
                for (state, rest) in tests {
                    patches.push(at(state, &format!("{degrees}°"), rest));
                }
            }
            for loaded in [Loaded::Displacement, Loaded::Traction] {
                for (name, crack) in bent(&grid.node, distance * grid.size) {
                    let stress = [("xx", -PRESSURE), ("yy", -PRESSURE)];
                    let rest = crack + &boundary(2, loaded, true) + &uniform(&stress);
                    patches.push(at(State::Hydrostatic, name, rest));
                }
            }
            for (name, rest) in meeting(&grid.node, distance * grid.size) {
                patches.push(at(State::Hydrostatic, name, rest));
            }
        }
    }
    patches
}

/// Entries of a symmetric stress by their names.
type Stress<'a> = &'a [(&'static str, f64)];

/// A crack, given by its friction, in uniform stress: hydrostatic pressure, one that it sticks under, one along it.
fn in_uniform_stress(
    dim: usize,
    crack: impl Fn(f64) -> String,
    [hydrostatic, stick, open]: [Stress<'_>; 3],
) -> Vec<(State, String)> {
    use Loaded::{Displacement, Traction};
    let tests = [
        (State::Hydrostatic, Displacement, 0.0, hydrostatic),
        (State::Hydrostatic, Traction, 0.0, hydrostatic),
        (State::Stick, Displacement, 1.0, stick),
        (State::Stick, Traction, 1.0, stick),
        (State::Open, Displacement, 0.3, open),
    ];
    let text = |(state, loaded, friction, stress): (State, Loaded, f64, Stress<'_>)| {
        let held = boundary(dim, loaded, state == State::Hydrostatic);
        let text = crack(friction) + &held + &uniform(stress) + &parted(state);
        (state, text)
    };
    tests.map(text).into()
}

/// Uniform stress beside a straight crack through c along t.
fn straight(c: &Point, t: &Point) -> Vec<(State, String)> {
    let ends = [-3.0, 3.0].map(|s| add_scaled(c, s, t));
    let along = |a: usize, b: usize| PRESSURE * t[a] * t[b];
    let hydrostatic = [("xx", -PRESSURE), ("yy", -PRESSURE)];
    // Principal stresses −1 ± √0.2: no plane carries more shear than half of its pressure.
    let stick = [
        ("xx", -1.4 * PRESSURE),
        ("yy", -0.6 * PRESSURE),
        ("xy", 0.2 * PRESSURE),
    ];
    let open = [
        ("xx", along(0, 0)),
        ("yy", along(1, 1)),
        ("xy", along(0, 1)),
    ];
    in_uniform_stress(2, |mu| chain(&ends, mu), [&hydrostatic, &stick, &open])
}

/// The confined block that slides forward or sticks.
fn blocks(c: &Point, t: &Point) -> Vec<(State, String)> {
    /// Downward displacement of the top [m]: far beyond the onset of slip.
    const PUSH: f64 = 2e-3;
    let ends = [-3.0, 3.0].map(|s| add_scaled(c, s, t));
    let slope = t[1] / t[0];
    let mut found = Vec::new();
    for (state, friction) in [(State::Slide, 0.5 * slope), (State::Held, 1.5 * slope)] {
        // A level block, or nearly so, has nowhere to slide to.
        let friction = match state {
            State::Slide if slope < 0.01 => continue,
            _ => friction.max(0.01),
        };
        let exact = format!(
            "[exact]\nsolution = \"sliding-block\"\npressure_pa = {PRESSURE:e}\ndisplacement_m = {PUSH:?}\n"
        );
        for loaded in [Loaded::Displacement, Loaded::Traction] {
            let held = match loaded {
                Loaded::Displacement => boundary(2, loaded, false),
                Loaded::Traction => {
                    let pressure = format!("pressure_pa = {PRESSURE:e}\nhistory = \"constant\"");
                    support("\"bottom\"", "[\"free\", 0]")
                        + &support("[\"left\", \"bottom\"]", "[0, 0]")
                        + &support("\"top\"", &format!("[\"free\", {:?}]", -PUSH))
                        + &load("left", &pressure)
                        + &load("right", &pressure)
                }
            };
            found.push((state, chain(&ends, friction) + &held + &exact));
        }
    }
    found
}

/// Single cracks that bend, or leave through a corner of the body.
fn bent(node: &Point, shift: f64) -> Vec<(&'static str, String)> {
    /// Radius of the arc [m].
    const RADIUS: f64 = 0.9;
    let c = add_scaled(node, shift, &[0.0, 1.0, 0.0]);
    let (x, y) = (c[0], c[1] - RADIUS);
    let arc = format!(
        "[[crack]]\narc = {{ centre_m = [{x:?}, {y:?}], radius_m = {RADIUS:?}, from_deg = 160, to_deg = 20 }}\n\
         friction = 0.0\ntip = \"none\"\n"
    );
    let second = add_scaled(&c, 0.27, &direction(-25.0));
    let kinked = [
        add_scaled(&c, -3.0, &direction(20.0)),
        c,
        second,
        add_scaled(&second, 3.0, &direction(10.0)),
    ];
    let t = direction(45.0);
    let corner = add_scaled(&[0.0; 3], shift, &turned(&t));
    let diagonal = [-3.0, 3.0].map(|s| add_scaled(&corner, s, &t));
    vec![
        ("arc", arc),
        ("kinked", chain(&kinked, 0.0)),
        ("45° from a corner", chain(&diagonal, 0.0)),
    ]
}

/// Two cracks that meet: hydrostatic pressure by stated displacements.
fn meeting(node: &Point, shift: f64) -> Vec<(&'static str, String)> {
    let t = direction(27.0);
    let c = add_scaled(node, shift, &turned(&t));
    let u = direction(-70.0);
    let ends = |t: &Point, low: f64| chain(&[low, 3.0].map(|s| add_scaled(&c, s, t)), 0.0);
    // u = −p (1 + ν)(1 − 2ν)/E (x − c)
    let shrink = PRESSURE * (1.0 + POISSON) * (1.0 - 2.0 * POISSON) / YOUNG;
    let sides = [
        ("left", 0, 0.0),
        ("right", 0, 1.0),
        ("bottom", 1, 0.0),
        ("top", 1, 2.0),
    ];
    let held: String = sides
        .iter()
        .map(|&(side, axis, x)| {
            let value = -shrink * (x - c[axis]);
            let entries = match axis {
                0 => format!("[{value:?}, \"free\"]"),
                _ => format!("[\"free\", {value:?}]"),
            };
            support(&format!("\"{side}\""), &entries)
        })
        .collect();
    [("T", 0.0), ("X", -3.0)]
        .map(|(name, low)| (name, ends(&t, -3.0) + &ends(&u, low) + &held))
        .to_vec()
}

/// Patch tests in solids.
pub fn solid(distances: &[f64]) -> Vec<Patch> {
    let text =
        "mesh = { box = { min_m = [0, 0, 0], max_m = [1, 1, 1], cells = [4, 4, 4] } }\n".to_owned();
    let grid = Grid::new("regular", "solid", text, [0.5; 3], 0.25);
    let mut patches = Vec::new();
    for normal in [
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [1.0, 0.3, 2.0],
    ] {
        let n = unit(&normal);
        // A stress along the plane: s ⊗ s with s in it, in no symmetry plane of the body.
        let s = unit(&add_scaled(
            &[0.6, 0.8, 0.0],
            -dot(&[0.6, 0.8, 0.0], &n),
            &n,
        ));
        let along = |a: usize, b: usize| PRESSURE * s[a] * s[b];
        let hydrostatic = [("xx", -PRESSURE), ("yy", -PRESSURE), ("zz", -PRESSURE)];
        let stick = [
            ("xx", -1.3 * PRESSURE),
            ("yy", -0.7 * PRESSURE),
            ("zz", -PRESSURE),
            ("xy", 0.2 * PRESSURE),
            ("yz", 0.1 * PRESSURE),
            ("xz", -0.2 * PRESSURE),
        ];
        let open = [
            ("xx", along(0, 0)),
            ("yy", along(1, 1)),
            ("zz", along(2, 2)),
            ("xy", along(0, 1)),
            ("yz", along(1, 2)),
            ("xz", along(0, 2)),
        ];
        for &distance in distances {
            let point = add_scaled(&grid.node, distance * grid.size, &n);
            let crack = |mu: f64| {
                format!(
                    "[[crack]]\nplane = {{ point_m = {point:?}, normal = {normal:?} }}\nfriction = {mu:?}\n"
                )
            };
            for (state, rest) in in_uniform_stress(3, crack, [&hydrostatic, &stick, &open]) {
                patches.push(Patch {
                    state,
                    crack: format!("({}, {}, {})", normal[0], normal[1], normal[2]),
                    mesh: grid.name.to_owned(),
                    distance,
                    text: head("solid", &grid.text) + &rest,
                });
            }
        }
    }
    patches
}
