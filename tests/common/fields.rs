//! Exact fields, bodies that carry them on their outline, and quadrature points of crack surfaces between edge pairs.

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::Complex;
use stickslip::case::{Material, Model};
use stickslip::model::body::{Body, Needs};
use stickslip::model::snapshot::Snapshot;
use stickslip::run::registry::method;
use stickslip_methods::{
    ContactState, ContactSystem, Increment, Options, Silent, Status, point_status,
};
use stickslip_xfem::contact::surface_point::{Side, SurfacePoint};
use stickslip_xfem::cut::crack::Geometry;
use stickslip_xfem::enrichment::basis::FunctionKind;
use stickslip_xfem::exact::Field;
use stickslip_xfem::geometry::{Point, add_scaled, dot, norm, sub};
use stickslip_xfem::intensity::williams::{kolosov, plane_modulus};
use stickslip_xfem::material::{Lame, strain, stress};
use stickslip_xfem::quadrature::gauss;

use super::*;

/// Straight crack |x| < a in an infinite plate under uniform remote stress, whose faces give up a constant part of the
/// stress: Westergaard functions Z = A (z/√(z² − a²) − 1) of mode I and II (Tada, Paris & Irwin).
#[derive(Debug, Clone, Copy)]
pub struct Griffith {
    /// Middle of the crack.
    pub centre: Point,
    /// Angle of the crack from the x axis.
    pub angle: f64,
    /// Half length.
    pub a: f64,
    /// Remote stress in the crack frame: along t, along n, shear.
    pub remote: [f64; 3],
    /// Stress given up at the faces: normal and shear.
    pub drop: [f64; 2],
    pub lame: Lame,
}

impl Griffith {
    fn axes(&self) -> [Point; 2] {
        let (s, c) = self.angle.sin_cos();
        [[c, s, 0.0], [-s, c, 0.0]]
    }

    /// Ends of the crack.
    pub fn ends(&self) -> [[f64; 2]; 2] {
        [-self.a, self.a].map(|s| {
            let x = add_scaled(&self.centre, s, &self.axes()[0]);
            [x[0], x[1]]
        })
    }

    /// Local coordinates; the second of a point on the crack carries the sign of its side.
    fn local(&self, x: &Point, side: f64) -> [f64; 2] {
        let [t, n] = self.axes();
        let d = sub(x, &self.centre);
        let y = dot(&d, &n);
        let on_crack = y.abs() < 1e-12 * self.a;
        [dot(&d, &t), if on_crack { 0f64.copysign(side) } else { y }]
    }

    fn remote_stress(&self) -> [Point; 3] {
        let [tt, nn, nt] = self.remote;
        [[tt, nt, 0.0], [nt, nn, 0.0], [0.0; 3]]
    }

    /// Z, its derivative and its integral per unit drop.
    fn westergaard(&self, x: f64, y: f64) -> [Complex<f64>; 3] {
        let z = Complex::new(x, y);
        let root = (z - self.a).sqrt() * (z + self.a).sqrt();
        [
            z / root - 1.0,
            -self.a * self.a / (root * root * root),
            root - z,
        ]
    }
}

impl Field for Griffith {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        let [x, y] = self.local(x, side);
        let [z, _, integral] = self.westergaard(x, y);
        let (k, g) = (kolosov(self.lame), 2.0 * self.lame.mu);
        let e = strain(self.lame, 2, &self.remote_stress());
        let [open, shear] = self.drop;
        let u = e[0][0] * x
            + e[0][1] * y
            + open / g * ((k - 1.0) / 2.0 * integral.re - y * z.im)
            + shear / g * ((k + 1.0) / 2.0 * integral.im + y * z.re);
        let v = e[1][0] * x
            + e[1][1] * y
            + open / g * ((k + 1.0) / 2.0 * integral.im - y * z.re)
            + shear / g * (-(k - 1.0) / 2.0 * integral.re - y * z.im);
        let [t, n] = self.axes();
        [0, 1, 2].map(|a| u * t[a] + v * n[a])
    }

    fn stress(&self, x: &Point, side: f64) -> [Point; 3] {
        let [x, y] = self.local(x, side);
        let [z, dz, _] = self.westergaard(x, y);
        let [open, shear] = self.drop;
        let mut s = self.remote_stress();
        s[0][0] += open * (z.re - y * dz.im) + shear * (2.0 * z.im + y * dz.re);
        s[1][1] += open * (z.re + y * dz.im) - shear * y * dz.re;
        s[0][1] += -open * y * dz.re + shear * (z.re - y * dz.im);
        let axes = self.axes();
        let mut global = [[0.0; 3]; 3];
        for a in 0..2 {
            for b in 0..2 {
                global[a][b] = s[0][0] * axes[0][a] * axes[0][b]
                    + s[1][1] * axes[1][a] * axes[1][b]
                    + s[0][1] * (axes[0][a] * axes[1][b] + axes[1][a] * axes[0][b]);
            }
        }
        global
    }

    fn traction(&self, _x: &Point) -> [f64; 3] {
        // Side 1 has the outward normal −n.
        let [_, nn, nt] = self.remote;
        [self.drop[0] - nn, self.drop[1] - nt, 0.0]
    }

    fn jump(&self, x: &Point) -> [f64; 3] {
        let [x, _] = self.local(x, 1.0);
        let shape = 4.0 / plane_modulus(self.lame) * (self.a * self.a - x * x).max(0.0).sqrt();
        [self.drop[0] * shape, self.drop[1] * shape, 0.0]
    }

    fn intensity(&self, front: &Point) -> Option<[f64; 3]> {
        // Seen from the first tip, ahead is −t and the shear changes its sign.
        let [x, _] = self.local(front, 1.0);
        let k = (PI * self.a).sqrt();
        Some([self.drop[0] * k, self.drop[1] * k * x.signum(), 0.0])
    }

    fn dissipation(&self) -> Option<f64> {
        let slip = self.drop[1] * 2.0 * PI * self.a * self.a / plane_modulus(self.lame);
        Some(0.5 * (self.remote[2] - self.drop[1]) * slip)
    }
}

/// Open crack along an arc of a circle, counter-clockwise, in an infinite plate under equal tension in all directions: the potentials
/// of Muskhelishvili (Some Basic Problems, § 124), in parts of the radius from the centre, the arc's middle on the x axis.
#[derive(Debug, Clone, Copy)]
pub struct ArcCrack {
    pub centre: [f64; 2],
    pub radius: f64,
    /// Angle of its middle, half of its own.
    pub middle: f64,
    pub half: f64,
    pub tension: f64,
    pub lame: Lame,
}

impl ArcCrack {
    /// φ, φ', φ'', ψ and ψ' at a point as seen from a side of the arc next to it.
    fn potentials(&self, z: Complex<f64>, side: f64) -> [Complex<f64>; 5] {
        let beside = (z.norm() - 1.0).abs() < 0.01 && z.arg().abs() < self.half;
        // Beyond the arc the root goes on with the other sign.
        let sign = if beside && side * (1.0 - z.norm()) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let [a, b] = [-self.half, self.half].map(|t| Complex::from_polar(1.0, t));
        let root = |z: Complex<f64>| {
            let of = |w: Complex<f64>| (-w * (1.0 - b) / (1.0 - a)).sqrt();
            sign * (z - b) * of((z - a) / (z - b)) / of(Complex::new(1.0, 0.0))
        };
        let cos = self.half.cos();
        let lead = self.tension / (3.0 - cos);
        let rest = 0.5 * self.tension * (1.0 - (1.0 + cos) / (3.0 - cos));
        let slope = |z: Complex<f64>| lead * (z - cos) / root(z);
        let (phi, dphi) = (lead * root(z) + 0.5 * rest * z, slope(z) + 0.5 * rest);
        let ddphi = lead / root(z) - slope(z) * 0.5 * (1.0 / (z - a) + 1.0 / (z - b));
        let mirror = 1.0 / z.conj();
        let omega = (lead * root(mirror) - 0.5 * rest * mirror).conj();
        let domega = (slope(mirror) - 0.5 * rest).conj();
        let psi = omega - dphi / z;
        let dpsi = (dphi - z * ddphi - domega) / (z * z);
        [phi, dphi, ddphi, psi, dpsi]
    }

    fn local(&self, x: &Point) -> Complex<f64> {
        let [x, y] = [0, 1].map(|a| (x[a] - self.centre[a]) / self.radius);
        Complex::new(x, y) * Complex::from_polar(1.0, -self.middle)
    }

    /// Displacement gradient ∂u_a/∂x_b.
    pub fn gradient(&self, x: &Point, side: f64) -> [Point; 3] {
        let z = self.local(x);
        let [_, dphi, ddphi, _, dpsi] = self.potentials(z, side);
        let turn = Complex::from_polar(1.0, self.middle);
        let (even, odd) = (
            kolosov(self.lame) * dphi - dphi.conj(),
            z * ddphi.conj() + dpsi.conj(),
        );
        // Along the axes that turn with the arc's middle.
        let [p, q] =
            [even - odd, Complex::<f64>::i() * (even + odd)].map(|d| d / (2.0 * self.lame.mu));
        let (sin, cos) = self.middle.sin_cos();
        let [dx, dy] = [p * cos - q * sin, p * sin + q * cos].map(|d| d * turn);
        [[dx.re, dy.re, 0.0], [dx.im, dy.im, 0.0], [0.0; 3]]
    }
}

impl Field for ArcCrack {
    fn displacement(&self, x: &Point, side: f64) -> Point {
        let z = self.local(x);
        let [phi, dphi, _, psi, _] = self.potentials(z, side);
        let u = kolosov(self.lame) * phi - z * dphi.conj() - psi.conj();
        let u = u * Complex::from_polar(self.radius / (2.0 * self.lame.mu), self.middle);
        [u.re, u.im, 0.0]
    }

    fn stress(&self, x: &Point, side: f64) -> [Point; 3] {
        stress(self.lame, 2, &self.gradient(x, side))
    }

    fn traction(&self, _x: &Point) -> [f64; 3] {
        [0.0; 3]
    }

    fn jump(&self, x: &Point) -> [f64; 3] {
        let [one, two] = [1.0, -1.0].map(|side| self.displacement(x, side));
        sub(&one, &two)
    }

    fn intensity(&self, _front: &Point) -> Option<[f64; 3]> {
        let quarter = 0.5 * self.half;
        let length = (PI * self.radius * self.half.sin()).sqrt();
        let k = self.tension * length / (1.0 + quarter.sin().powi(2));
        Some([k * quarter.cos(), k * quarter.sin(), 0.0])
    }
}

pub fn lame() -> Lame {
    let material = Material {
        young: 1.0,
        poisson: 0.3,
    };
    Lame::new(material, Model::PlaneStrain)
}

/// A closed crack that slides under friction, μ = 0.3, p = 1e-3, τ = 0.7e-3, off the centre and oblique to the grid.
pub fn sliding() -> Griffith {
    Griffith {
        centre: [0.031, -0.047, 0.0],
        angle: 27f64.to_radians(),
        a: 0.45,
        remote: [-0.4e-3, -1.0e-3, 0.7e-3],
        drop: [0.0, 0.4e-3],
        lame: lame(),
    }
}

/// The same crack pulled open and sheared.
pub fn open() -> Griffith {
    Griffith {
        remote: [0.2e-3, 1.0e-3, 0.5e-3],
        drop: [1.0e-3, 0.5e-3],
        ..sliding()
    }
}

/// A plate around such a crack, held on its outline.
pub fn plate(field: &Griffith, cells: usize, tip: &str) -> String {
    let [p, q] = field.ends();
    let rest = crack(p, q, 0.3, tip) + &clamped(2);
    plane([-1.0, -1.0], [1.0, 1.0], [cells, cells], &rest)
}

/// An arc of 120 degrees, pulled open.
pub fn arc() -> ArcCrack {
    ArcCrack {
        centre: [0.03, -0.32],
        radius: 0.6,
        middle: 80f64.to_radians(),
        half: 60f64.to_radians(),
        tension: 1e-3,
        lame: lame(),
    }
}

/// A plate around an arc, or around a chain of so many points on it, held on its outline.
pub fn plate_of_arc(arc: &ArcCrack, cells: usize, points: Option<usize>) -> String {
    let [from, to] = [-1.0, 1.0].map(|s| arc.middle + s * arc.half);
    let shape = match points {
        None => format!(
            "arc = {{ centre_m = {:?}, radius_m = {:?}, from_deg = {:?}, to_deg = {:?} }}",
            arc.centre,
            arc.radius,
            from.to_degrees(),
            to.to_degrees()
        ),
        Some(count) => {
            let at = |k: usize| from + (to - from) * k as f64 / (count - 1) as f64;
            let place = |t: f64| {
                let (sin, cos) = t.sin_cos();
                [
                    arc.centre[0] + arc.radius * cos,
                    arc.centre[1] + arc.radius * sin,
                ]
            };
            let points: Vec<[f64; 2]> = (0..count).map(at).map(place).collect();
            format!("points_m = {points:?}")
        }
    };
    let rest = format!("[[crack]]\n{shape}\nfriction = 0.3\n") + &clamped(2);
    plane([-1.0, -1.0], [1.0, 1.0], [cells, cells], &rest)
}

/// Sets the prescribed displacements of all standard functions to an exact field; those of enriched ones stay 0.
pub fn hold(body: &mut Body, field: &dyn Field) {
    let body = &mut body.discrete;
    let dim = body.mesh.dim();
    for (&unknown, prescribed) in &mut body.prescribed {
        let function = body.enrichment.functions[unknown / dim];
        if function.kind == FunctionKind::Standard {
            let x = body.mesh.nodes[function.node as usize];
            prescribed.amount = Some(field.displacement(&x, 1.0)[unknown % dim]);
        }
    }
}

/// Solves a case whose prescribed displacements are those of a field.
pub fn solve_held(text: &str, field: &dyn Field) -> (Body, Snapshot) {
    let case = parse(text);
    let mut body = Body::new(&case, 1, &Needs::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    hold(&mut body, field);
    let system =
        Arc::new(ContactSystem::new(body.elastic.clone(), friction(&case, &body)).unwrap());
    let registered = method(METHOD).expect("registered");
    let options = Options::new(registered.options, &[]).unwrap();
    let mut enforcement = (registered.build)(&options);
    let held = loading(&body, &case);
    let increment = Increment {
        system: &system,
        load: &held.at(1),
        start_load: &no_load(&body),
        start: &ContactState::zero(&system),
        guess: None,
        index: 0,
        tolerance: TOLERANCE,
    };
    let outcome = enforcement.solve(&increment, &mut Silent).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    let status = point_status(&increment, &outcome.state).unwrap();
    let virgin = Snapshot::virgin(&body);
    let now = Snapshot::new(
        &held,
        1,
        &outcome.state,
        None,
        status,
        system.friction(),
        &virgin,
    );
    drop(held);
    (body, now)
}

/// Quadrature points of 2D cracks, multipliers linear between the edge pairs and constant from the last pair to a tip.
pub fn surface(body: &Body, n: usize) -> Vec<SurfacePoint> {
    let mesh = &body.mesh;
    let mut points = Vec::new();
    for cell in 0..mesh.cell_count() {
        let Some(partition) = body.enrichment.partition(cell) else {
            continue;
        };
        let crack = &body.cracks[partition.faces[0].crack];
        let vertices = &partition.faces[0].corners;
        // A face ends inside a cell where the crack does.
        let mut ends: Vec<(f64, bool)> = vertices
            .iter()
            .map(|v| (crack.abscissa(&v.0), v.1.is_none()))
            .collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let pairs: Vec<(u32, f64)> = (body.points.iter().enumerate())
            .filter(|(_, p)| vertices.iter().any(|v| norm(&sub(&v.0, &p.x)) < 1e-9))
            .map(|(i, p)| (i as u32, p.s))
            .collect();
        let (from, to) = (ends[0].0, ends[1].0);
        let at_tip = [ends[0].1, ends[1].1];
        for (s, w) in gauss(n) {
            let t = 0.5 * (1.0 + s);
            // s = ρ² from a tip: the jump and the auxiliary fields go with √s.
            let (t, w) = match at_tip {
                [true, _] => (t * t, w * t),
                [_, true] => (1.0 - (1.0 - t).powi(2), w * (1.0 - t)),
                _ => (t, 0.5 * w),
            };
            let s = from + t * (to - from);
            let Geometry::Curve(curve) = &crack.geometry else {
                panic!("a 2D crack");
            };
            let x = curve.at(s).0;
            let shares = match *pairs.as_slice() {
                [(i, a), (j, b)] => vec![(i, (b - s) / (b - a)), (j, (s - a) / (b - a))],
                [(i, _)] => vec![(i, 1.0)],
                _ => Vec::new(),
            };
            points.push(SurfacePoint {
                crack: crack.number,
                x,
                weight: w * (to - from),
                sides: partition.faces[0].sides.map(|(_, region)| Side {
                    cell,
                    xi: mesh.map(cell).inverse(&x).unwrap(),
                    region,
                }),
                frame: crack.frame(&x),
                shares,
            });
        }
    }
    points
}

/// A displacement given by a function with its gradient, the same on both sides, free of jumps.
pub struct Smooth<F> {
    /// Displacement and gradient ∂u_a/∂x_b.
    pub field: F,
    pub lame: Lame,
    pub dim: usize,
}

impl<F: Fn(&Point) -> (Point, [Point; 3]) + Send + Sync> Field for Smooth<F> {
    fn displacement(&self, x: &Point, _side: f64) -> Point {
        (self.field)(x).0
    }
    fn stress(&self, x: &Point, _side: f64) -> [Point; 3] {
        stress(self.lame, self.dim, &(self.field)(x).1)
    }
    fn traction(&self, _x: &Point) -> [f64; 3] {
        [0.0; 3]
    }
    fn jump(&self, _x: &Point) -> [f64; 3] {
        [0.0; 3]
    }
}
