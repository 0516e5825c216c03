//! Closed forms made for tests of what supports and loads take from them.

use stickslip::case::CrackShape;
use stickslip_xfem::exact::{Field, ParameterSpec, Setting, Solution, SolutionSpec};
use stickslip_xfem::material::Lame;

pub type Point = [f64; 3];

/// Closed forms made for these tests.
pub static FORMS: &[SolutionSpec] = &[
    SolutionSpec {
        name: "two-maps",
        summary: "an affine map on each side",
        parameters: &[],
        build: |setting, _| Ok(Box::new(TwoMaps(setting.crack.clone()))),
    },
    SolutionSpec {
        name: "sliding",
        summary: "uniform stress at the limit of friction, rigid slip along x",
        parameters: &[
            ParameterSpec {
                name: "pressure_pa",
                summary: "pressure",
                default: None,
            },
            ParameterSpec {
                name: "slip_m",
                summary: "slip at factor 1",
                default: Some(1e-3),
            },
        ],
        build: sliding,
    },
    SolutionSpec {
        name: "smooth",
        summary: "cubic displacement without jump, pressed onto the crack",
        parameters: &[],
        build: |setting, _| {
            let lame = Lame::new(setting.material, setting.model);
            let last = setting.model.dim() - 1;
            Ok(Box::new(Smooth { lame, last }))
        },
    },
];

/// u = factor × (A x + c), other A and c on each side. Like all closed forms it looks at `side` on the crack only.
struct TwoMaps(CrackShape);

/// The side of a point by its place; of one on the crack the given one.
fn side_at(crack: &CrackShape, x: &Point, side: f64) -> f64 {
    let (point, normal) = match crack {
        CrackShape::Polyline(points) => {
            let [p, q] = [points[0], points[1]];
            let length = (q[0] - p[0]).hypot(q[1] - p[1]);
            let normal = [(p[1] - q[1]) / length, (q[0] - p[0]) / length, 0.0];
            ([p[0], p[1], 0.0], normal)
        }
        CrackShape::Plane { point, normal } => (*point, *normal),
        _ => panic!("{crack:?}"),
    };
    let distance: f64 = (0..3).map(|a| normal[a] * (x[a] - point[a])).sum();
    if distance.abs() < 1e-12 {
        side
    } else {
        distance.signum()
    }
}

pub fn map(x: &Point, side: f64) -> Point {
    let a = if side > 0.0 {
        [[0.3, -0.2, 0.5], [0.7, 0.1, -0.4], [-0.6, 0.2, 0.9]]
    } else {
        [[-0.1, 0.4, 0.2], [0.05, -0.8, 0.3], [0.15, -0.35, 0.45]]
    };
    let c = [0.2 * side, 0.5 - 0.1 * side, -0.3 * side];
    [0, 1, 2].map(|k| c[k] + (0..3).map(|l| a[k][l] * x[l]).sum::<f64>())
}

impl Solution for TwoMaps {
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String> {
        match factors.last() {
            Some(&factor) if factor < 2.0 => Ok(Box::new(Scaled(factor, self.0.clone()))),
            _ => Err("factors are below 2".into()),
        }
    }
}

struct Scaled(f64, CrackShape);

impl Field for Scaled {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        map(x, side_at(&self.1, x, side)).map(|u| self.0 * u)
    }
    fn stress(&self, _: &Point, _: f64) -> [Point; 3] {
        [[0.0; 3]; 3]
    }
    /// Degree 3 in x, other on each side.
    fn body_force(&self, x: &Point, side: f64) -> Point {
        let side = side_at(&self.1, x, side);
        [x[0].powi(3), side * x[0] * x[1], 1.0 + side]
    }
    fn traction(&self, _: &Point) -> Point {
        [0.0; 3]
    }
    fn jump(&self, _: &Point) -> Point {
        [0.0; 3]
    }
}

/// σ_yy = −p, σ_xy = μ p, slip along +x: force on side 1 is (p, −μ p), against the slip.
struct Sliding {
    strain: [[f64; 2]; 2],
    pressure: f64,
    friction: f64,
    slip: f64,
}

fn sliding(setting: &Setting<'_>, values: &[f64]) -> Result<Box<dyn Solution>, String> {
    let CrackShape::Polyline(points) = setting.crack else {
        return Err("the crack must be a polyline".into());
    };
    if points[0][1] != points[1][1] {
        return Err("the crack must be horizontal".into());
    }
    assert_eq!(setting.body, [[0.0; 3], [1.0, 1.0, 0.0]]);
    let (e, nu) = (setting.material.young, setting.material.poisson);
    let (p, mu) = (values[0], setting.friction);
    // Plane strain, σ_xx = 0.
    let shear = mu * p * (1.0 + nu) / e;
    let (xx, yy) = (p * nu * (1.0 + nu) / e, -p * (1.0 - nu * nu) / e);
    Ok(Box::new(Sliding {
        strain: [[xx, shear], [shear, yy]],
        pressure: p,
        friction: mu,
        slip: values[1],
    }))
}

impl Solution for Sliding {
    fn at(&self, factors: &[f64]) -> Result<Box<dyn Field>, String> {
        if factors.windows(2).any(|w| w[1] < w[0]) {
            return Err("slip must not turn back".into());
        }
        let slip = self.slip * factors.last().unwrap();
        Ok(Box::new(Sliding { slip, ..*self }))
    }
}

impl Field for Sliding {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        let [[xx, xy], [yx, yy]] = self.strain;
        [
            xx * x[0] + xy * x[1] + 0.5 * side * self.slip,
            yx * x[0] + yy * x[1],
            0.0,
        ]
    }
    fn stress(&self, _: &Point, _: f64) -> [Point; 3] {
        let shear = self.friction * self.pressure;
        [[0.0, shear, 0.0], [shear, -self.pressure, 0.0], [0.0; 3]]
    }
    fn traction(&self, _: &Point) -> Point {
        [self.pressure, -self.friction * self.pressure, 0.0]
    }
    fn jump(&self, _: &Point) -> Point {
        [0.0, self.slip, 0.0]
    }
}

/// u_x = k x² l, u_y = k y l (solid), u_l = −e l + k x l² with l the last coordinate: pressed, and without jump.
#[derive(Clone, Copy)]
pub struct Smooth {
    pub lame: Lame,
    pub last: usize,
}

pub const K: f64 = 1e-3;
const PRESSED: f64 = 2e-2;

impl Solution for Smooth {
    fn at(&self, _: &[f64]) -> Result<Box<dyn Field>, String> {
        Ok(Box::new(*self))
    }
}

impl Field for Smooth {
    fn displacement(&self, x: &Point, _: f64) -> Point {
        let l = x[self.last];
        let mut u = [K * x[0] * x[0] * l, K * x[1] * l, 0.0];
        u[self.last] = -PRESSED * l + K * x[0] * l * l;
        u
    }
    fn stress(&self, x: &Point, _: f64) -> [Point; 3] {
        let (n, l) = (self.last, x[self.last]);
        let mut g = [[0.0; 3]; 3];
        g[0][0] = 2.0 * K * x[0] * l;
        g[0][n] = K * x[0] * x[0];
        if n == 2 {
            (g[1][1], g[1][2]) = (K * l, K * x[1]);
        }
        g[n][0] = K * l * l;
        g[n][n] = -PRESSED + 2.0 * K * x[0] * l;
        let trace = g[0][0] + g[1][1] + g[2][2];
        let mut s = [[0.0; 3]; 3];
        for a in 0..=n {
            for b in 0..=n {
                s[a][b] = self.lame.mu * (g[a][b] + g[b][a]);
            }
            s[a][a] += self.lame.lambda * trace;
        }
        s
    }
    /// Central differences: exact for a quadratic stress.
    fn body_force(&self, x: &Point, side: f64) -> Point {
        let step = 1e-2;
        let mut b = [0.0; 3];
        for k in 0..=self.last {
            let (mut p, mut m) = (*x, *x);
            p[k] += step;
            m[k] -= step;
            let (p, m) = (self.stress(&p, side), self.stress(&m, side));
            for a in 0..=self.last {
                b[a] -= (p[a][k] - m[a][k]) / (2.0 * step);
            }
        }
        b
    }
    fn traction(&self, _: &Point) -> Point {
        [0.0; 3]
    }
    fn jump(&self, _: &Point) -> Point {
        [0.0; 3]
    }
}
