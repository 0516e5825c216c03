//! The bodies of the inf-sup test: a unit square or cube with one crack that lies in the grid in its own way.

use stickslip_xfem::geometry::{add_scaled, unit};

use crate::case::{self, Case, CaseError, ContactSpace};

/// Edge of the body [m].
pub const LENGTH: f64 = 1.0;

/// Young's modulus [Pa]; Poisson's ratio is 0.3, in 2D in plane strain.
pub const YOUNG: f64 = 1.0;

/// Where the crack lies; h is the cell size.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cut {
    /// y = the grid line below the middle + `offset` h.
    Horizontal { offset: f64 },
    /// y = x, moved along its normal by `offset` h.
    Diagonal { offset: f64 },
    /// Through the centre at 27 degrees.
    Inclined,
    /// A crack of length 0.5 L at 27 degrees with both tips inside; its `tip`.
    Interior { tip: &'static str },
    /// The plane through the centre, moved along its normal by `offset` h.
    Plane { normal: [f64; 3], offset: f64 },
}

/// A body with a crack, on any mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scene {
    /// Name in tables.
    pub name: &'static str,
    /// Space dimension.
    pub dim: usize,
    /// Cells per axis, coarse to fine; odd, so that no node lies at the centre.
    pub cells: &'static [usize],
    /// Whether the crack runs along the grid, midway between its lines or nearly so: what others are measured by.
    pub is_reference: bool,
    cut: Cut,
    /// Largest move of inner nodes, in cells.
    distortion: f64,
}

const PLATES: &[usize] = &[5, 11, 21, 41];
const CUBES: &[usize] = &[3, 5, 7, 9];

const fn plate(name: &'static str, cut: Cut) -> Scene {
    Scene {
        name,
        dim: 2,
        cells: PLATES,
        is_reference: false,
        cut,
        distortion: 0.0,
    }
}

const fn cube(name: &'static str, normal: [f64; 3], offset: f64) -> Scene {
    Scene {
        name,
        dim: 3,
        cells: CUBES,
        is_reference: false,
        cut: Cut::Plane { normal, offset },
        distortion: 0.0,
    }
}

/// All scenes, in the order of tables and figures.
pub static SCENES: [Scene; 15] = [
    Scene {
        is_reference: true,
        ..plate("horizontal, offset 0.3h", Cut::Horizontal { offset: 0.3 })
    },
    plate("horizontal, offset 0.01h", Cut::Horizontal { offset: 0.01 }),
    plate("horizontal, offset 1e-4h", Cut::Horizontal { offset: 1e-4 }),
    plate("45°, offset 0.3h", Cut::Diagonal { offset: 0.3 }),
    plate("45°, offset 1e-3h", Cut::Diagonal { offset: 1e-3 }),
    plate("27°", Cut::Inclined),
    Scene {
        distortion: 0.25,
        ..plate("27°, mesh distorted 25 %", Cut::Inclined)
    },
    plate("inside, 27°, tips none", Cut::Interior { tip: "\"none\"" }),
    plate(
        "inside, 27°, tips branch",
        Cut::Interior { tip: "\"branch\"" },
    ),
    plate(
        "inside, 27°, tips radius 0.3",
        Cut::Interior {
            tip: "{ branch_radius_m = 0.3 }",
        },
    ),
    Scene {
        is_reference: true,
        ..cube("normal (0, 0, 1)", [0.0, 0.0, 1.0], 0.0)
    },
    cube("normal (1, 0, 1), offset 0.3h", [1.0, 0.0, 1.0], 0.3),
    cube("normal (1, 0, 1), offset 1e-3h", [1.0, 0.0, 1.0], 1e-3),
    cube("normal (1, 1, 1)", [1.0, 1.0, 1.0], 0.0),
    cube("normal (1, 0.3, 2)", [1.0, 0.3, 2.0], 0.0),
];

impl Scene {
    /// The case on a mesh of `cells` per axis; its supports hold nodes far from the crack.
    ///
    /// # Errors
    /// Those of [`case::parse`].
    pub fn case(&self, space: ContactSpace, cells: usize) -> Result<Case, CaseError> {
        let h = LENGTH / cells as f64;
        let slope = 27f64.to_radians().tan();
        let through = |point: [f64; 2], slope: f64| {
            let at = |s: f64| [point[0] + s, point[1] + s * slope];
            format!("points_m = [{:?}, {:?}]", at(-2.0), at(2.0))
        };
        let centre = 0.5 * LENGTH;
        let crack = match self.cut {
            Cut::Horizontal { offset } => {
                let line = (cells / 2) as f64;
                through([centre, (line + offset) * h], 0.0)
            }
            Cut::Diagonal { offset } => {
                let up = offset * h * std::f64::consts::SQRT_2;
                through([centre, centre + up], 1.0)
            }
            Cut::Inclined => through([centre, centre], slope),
            Cut::Interior { tip } => {
                // Off the centre, so that both tips lie in their cells in different ways.
                let [x, y] = [0.51 * LENGTH, 0.49 * LENGTH];
                let (sin, cos) = 27f64.to_radians().sin_cos();
                let end = |s: f64| [x + s * cos, y + s * sin];
                let half = 0.25 * LENGTH;
                format!(
                    "points_m = [{:?}, {:?}]\ntip = {tip}",
                    end(-half),
                    end(half)
                )
            }
            Cut::Plane { normal, offset } => {
                let point = add_scaled(&[centre; 3], offset * h, &unit(&normal));
                format!("plane = {{ point_m = {point:?}, normal = {normal:?} }}")
            }
        };
        let (model, supports) = if self.dim == 2 {
            let corners = "[[support]]\non = [\"left\", \"top\"]\ndisplacement_m = [0, 0]\n\
                           [[support]]\non = [\"right\", \"bottom\"]\ndisplacement_m = [0, 0]\n";
            ("plane-strain", corners.to_owned())
        } else {
            // Two nodes of one piece, a corner of the other: no rigid motion of both together is left.
            let near = format!(
                "[[support]]\non = [\"front\", \"bottom\"]\nwhere = \"x <= {h:?}\"\ndisplacement_m = [0, 0, 0]\n"
            );
            let corner =
                "[[support]]\non = [\"right\", \"back\", \"top\"]\ndisplacement_m = [0, 0, 0]\n";
            ("solid", near + corner)
        };
        let low = vec![0.0; self.dim];
        let high = vec![LENGTH; self.dim];
        let counts = vec![cells; self.dim];
        let distort = if self.distortion > 0.0 {
            format!(", distort = {{ amplitude = {:?} }}", self.distortion)
        } else {
            String::new()
        };
        let text = format!(
            "title = \"{name}\"\nmodel = \"{model}\"\n\
             material = {{ young_pa = {YOUNG:?}, poisson = 0.3, dilatation = \"full\" }}\n\
             mesh = {{ box = {{ min_m = {low:?}, max_m = {high:?}, cells = {counts:?} }}{distort} }}\n\
             [[crack]]\n{crack}\nfriction = 0\ncontact = \"{space}\"\n{supports}",
            name = self.name,
            space = space.name(),
        );
        case::parse("infsup.toml", text.as_str())
    }
}
