//! Tips and fronts of cracks with their coordinates: distance ahead along the crack, distance from it.

use std::array::from_fn;

use super::boxes::{Extents, around};
use super::branch_functions::{pair_functions, root_functions, root_values};
use super::clip::Side;
use super::curve::turned;
use super::ellipse::Ellipse;
use super::{Point, Points, add_scaled, cross, dot, mean, norm, sub, unit};

/// A point this near to the line of an arm lies on it, in parts of its distance from the corner, or of half a short crack.
const ON_ARM: f64 = 1e-8;

/// A tip or front inside the body with its coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct TipFrame {
    /// Crack number.
    pub crack: usize,
    /// Position; of an ellipse its centre [m].
    pub position: Point,
    /// Unit direction out of the crack; of an ellipse its first axis.
    pub ahead: Point,
    /// Crack normal, towards side 1.
    pub normal: Point,
    /// Shape of the crack behind it.
    pub shape: FrontShape,
}

/// Shape of a crack near its tip, which bends the coordinates of the branch functions along with it.
#[derive(Debug, Clone, PartialEq)]
pub enum FrontShape {
    /// Straight.
    Straight,
    /// Straight, up to a corner: other arms cross its line there, so that a side says nothing beyond the arm itself.
    Corner,
    /// A chain, or the chords of an arc: its vertices from the tip on, each farther away than those before. θ of its end goes on up to it
    /// at every distance.
    Bent(Vec<Point>),
    /// A crack with both its ends, from one to the other along the axis ahead, which ends in the second; the position is its middle.
    Pair {
        /// Half of the distance of its ends [m].
        half_length: f64,
        /// They themselves [m].
        ends: [Point; 2],
        /// Where it bends, ahead of the middle and across, in this order [m].
        bends: Vec<[f64; 2]>,
    },
    /// The front of an elliptic crack in 3D.
    Ellipse(Ellipse),
}

/// Crack-tip coordinates of a point: r = √(ψ² + φ²), θ = atan2(φ, ψ).
#[derive(Debug, Clone, Copy)]
pub struct TipCoordinates {
    /// Distance ahead of the front along the crack, negative behind it [m].
    pub psi: f64,
    /// Distance from the crack, positive on side 1 [m].
    pub phi: f64,
    /// ∇ψ.
    pub psi_gradient: Point,
    /// ∇φ.
    pub phi_gradient: Point,
}

impl TipFrame {
    /// A straight front at a place; `ahead` and `normal` are its frame.
    pub fn straight(crack: usize, position: Point, ahead: Point, normal: Point) -> Self {
        TipFrame {
            crack,
            position,
            ahead,
            normal,
            shape: FrontShape::Straight,
        }
    }

    /// A crack with both its ends, given by its ends and bends, each farther along the line between the ends than those before.
    pub fn of_both_ends(crack: usize, path: &[Point]) -> Self {
        let [p, q] = [path[0], path[path.len() - 1]];
        let ahead = unit(&sub(&q, &p));
        let mut frame = TipFrame::straight(crack, mean([&p, &q]), ahead, turned(&ahead));
        let inner = path.iter().skip(1).take(path.len() - 2);
        let local = |x: &Point| {
            let at = frame.coordinates(x);
            [at.psi, at.phi]
        };
        frame.shape = FrontShape::Pair {
            bends: inner.map(local).collect(),
            ends: [p, q],
            half_length: 0.5 * norm(&sub(&q, &p)),
        };
        frame
    }

    /// Coordinates of a point.
    pub fn coordinates(&self, x: &Point) -> TipCoordinates {
        let d = sub(x, &self.position);
        match &self.shape {
            FrontShape::Straight
            | FrontShape::Corner
            | FrontShape::Bent(_)
            | FrontShape::Pair { .. } => TipCoordinates {
                psi: dot(&d, &self.ahead),
                phi: dot(&d, &self.normal),
                psi_gradient: self.ahead,
                phi_gradient: self.normal,
            },
            FrontShape::Ellipse(ellipse) => {
                let near = ellipse.nearest(x);
                TipCoordinates {
                    psi: near.psi,
                    phi: dot(&d, &self.normal),
                    psi_gradient: near.ahead,
                    phi_gradient: self.normal,
                }
            }
        }
    }

    /// A point ahead of the tip and across the crack behind it [m]: bent as that may be, it lies at φ = 0, ψ < 0.
    pub fn beside(&self, x: &Point) -> [f64; 2] {
        let at = self.coordinates(x);
        let FrontShape::Bent(path) = &self.shape else {
            return [at.psi, at.phi];
        };
        let (sin, cos) = self.turn(path, at.psi.hypot(at.phi)).sin_cos();
        [at.psi * cos - at.phi * sin, at.phi * cos + at.psi * sin]
    }

    /// Angle β, from the line behind the tip towards the normal, at which a chain lies at a distance r.
    fn turn(&self, path: &[Point], r: f64) -> f64 {
        let within = |x: &Point| norm(&sub(x, &self.position)) < r;
        let k = path[1..path.len() - 1].partition_point(within);
        if k == 0 {
            return 0.0;
        }
        let from = sub(&path[k], &self.position);
        let u = unit(&sub(&path[k + 1], &path[k]));
        let along = dot(&from, &u);
        // Where |from + t u| = r.
        let t = -along + (along * along + r * r - dot(&from, &from)).max(0.0).sqrt();
        let x = add_scaled(&from, t, &u);
        dot(&x, &self.normal).atan2(-dot(&x, &self.ahead))
    }

    /// Whether a point, ahead and across, lies between a chain and the line behind its tip: the functions have the other sign there,
    /// so that they jump on the chain. One of the chain lies on the `side` of its region.
    fn lies_beyond(&self, path: &[Point], [psi, phi]: [f64; 2], side: Option<Side>) -> bool {
        let r = psi.hypot(phi);
        let beta = self.turn(path, r);
        // −0 is the lower face.
        let above = phi.atan2(-psi) - beta;
        let on = above.abs() * r <= ON_ARM * r + 4.0 * f64::EPSILON * norm(&self.position);
        let left = side.filter(|_| on).unwrap_or(above) > 0.0;
        left != phi.is_sign_positive()
    }

    /// Distance r from the tip or front, the nearer of two [m].
    pub fn distance(&self, x: &Point) -> f64 {
        let at = self.coordinates(x);
        match self.shape {
            FrontShape::Pair { half_length, .. } => (at.psi.abs() - half_length).hypot(at.phi),
            _ => (at.psi * at.psi + at.phi * at.phi).sqrt(),
        }
    }

    /// A box around all points within a distance of the tip or front [m].
    pub fn extents(&self, radius: f64) -> Extents {
        let reach = match &self.shape {
            FrontShape::Straight | FrontShape::Corner | FrontShape::Bent(_) => radius,
            FrontShape::Pair { half_length, .. } => radius + half_length,
            FrontShape::Ellipse(e) => radius + e.half_axes[0].max(e.half_axes[1]),
        };
        around([&self.position], reach)
    }

    /// The line behind a 2D tip from a distance on, along which the first branch function jumps whether there is a crack or
    /// not, up to `far` [m].
    pub fn behind(&self, room: f64, far: f64) -> [Point; 2] {
        if let FrontShape::Bent(path) = &self.shape
            && let [.., from, to] = path.as_slice()
        {
            return [*to, add_scaled(to, 4.0 * far, &unit(&sub(to, from)))];
        }
        [room, room + 4.0 * far].map(|s| add_scaled(&self.position, -s, &self.ahead))
    }

    /// Tips of a 2D crack, where the branch functions are singular [m].
    pub fn tips(&self) -> Vec<Point> {
        match &self.shape {
            FrontShape::Pair { ends, .. } => ends.to_vec(),
            FrontShape::Ellipse(_) => Vec::new(),
            _ => vec![self.position],
        }
    }

    /// Frame at the point of the front nearest to x: ahead, crack normal, tangent = ahead × normal.
    pub fn frame(&self, x: &Point) -> [Point; 3] {
        let ahead = match &self.shape {
            FrontShape::Ellipse(ellipse) => ellipse.nearest(x).ahead,
            _ => self.ahead,
        };
        [ahead, self.normal, cross(&ahead, &self.normal)]
    }

    /// Branch functions and their gradients at a point.
    ///
    /// `side` says on which face a point of the crack lies (θ = ±π); `None` takes the side from the position.
    pub fn branch(&self, x: &Point, side: Option<Side>) -> ([f64; 4], [Point; 4]) {
        let (values, gradients) = self.branches(&x.map(|v| [v]), side);
        let first = |[v]: [f64; 1]| v;
        (values.map(first), gradients.map(|g| g.map(first)))
    }

    /// ψ, φ, ∇ψ and ∇φ of L points, φ on the face of the crack that `side` says.
    #[inline(always)]
    fn placed<const L: usize>(
        &self,
        x: &Points<L>,
        side: Option<Side>,
    ) -> ([[f64; L]; 2], [Points<L>; 2]) {
        let (mut psi, mut phi) = ([0.0; L], [0.0; L]);
        let (mut ahead, mut across) = ([[0.0; L]; 3], [[0.0; L]; 3]);
        if let FrontShape::Ellipse(ellipse) = &self.shape {
            (psi, ahead, _) = ellipse.nearests(x);
            across = self.normal.map(|n| [n; L]);
            for q in 0..L {
                phi[q] = dot(&sub(&x.map(|v| v[q]), &self.position), &self.normal);
            }
        } else {
            for q in 0..L {
                let at = self.coordinates(&x.map(|v| v[q]));
                (psi[q], phi[q]) = (at.psi, at.phi);
                for a in 0..3 {
                    ahead[a][q] = at.psi_gradient[a];
                    across[a][q] = at.phi_gradient[a];
                }
            }
        }
        if let Some(side) = side {
            let reach = match self.shape {
                FrontShape::Pair { half_length, .. } => Some(half_length),
                _ => None,
            };
            // How far from its line a point still lies on the arm, in parts of |ψ| and besides: rounding.
            let [slope, least] = match &self.shape {
                FrontShape::Corner => [ON_ARM, 4.0 * f64::EPSILON * norm(&self.position)],
                FrontShape::Bent(_) => [0.0, -1.0],
                FrontShape::Pair { bends, .. } if !bends.is_empty() => [0.0, -1.0],
                // Beside the line of a leg lie others of its crack.
                FrontShape::Pair { half_length, .. } => [0.0, ON_ARM * half_length],
                _ => [0.0, f64::INFINITY],
            };
            for q in 0..L {
                // Ahead of the tip, and beside an arm, the place tells.
                if phi[q].abs() > slope * psi[q].abs() + least {
                    continue;
                }
                if reach.map_or(psi[q] <= 0.0, |reach| psi[q].abs() <= reach) {
                    phi[q] = if side > 0.0 {
                        phi[q].max(0.0).abs()
                    } else {
                        -((-phi[q]).max(0.0).abs())
                    };
                }
            }
        }
        ([psi, phi], [ahead, across])
    }

    /// The functions of both ends of a crack at L points, if these are its.
    #[inline(always)]
    fn pair<const L: usize>(
        &self,
        psi: &[f64; L],
        phi: &[f64; L],
        side: Option<Side>,
    ) -> Option<[[[f64; 3]; 4]; L]> {
        let FrontShape::Pair {
            half_length, bends, ..
        } = &self.shape
        else {
            return None;
        };
        let a = *half_length;
        Some(from_fn(|q| {
            let (x, y) = (psi[q], phi[q]);
            pair_functions(a, x, y, lies_between(a, bends, [x, y], side))
        }))
    }

    /// Signs of the functions of a bent crack at L points, see [`Self::lies_beyond`].
    #[inline(always)]
    fn signs<const L: usize>(
        &self,
        psi: &[f64; L],
        phi: &[f64; L],
        side: Option<Side>,
    ) -> Option<[f64; L]> {
        let FrontShape::Bent(path) = &self.shape else {
            return None;
        };
        let beyond = |q: usize| self.lies_beyond(path, [psi[q], phi[q]], side);
        Some(from_fn(|q| if beyond(q) { -1.0 } else { 1.0 }))
    }

    /// Branch functions at L points on one side, by function and point.
    #[inline(always)]
    pub fn branch_values<const L: usize>(
        &self,
        x: &Points<L>,
        side: Option<Side>,
    ) -> [[f64; L]; 4] {
        let ([psi, phi], _) = self.placed(x, side);
        if let Some(own) = self.pair(&psi, &phi, side) {
            return from_fn(|l| own.map(|own| own[l][0]));
        }
        let values = root_values(&psi, &phi);
        match self.signs(&psi, &phi, side) {
            Some(signs) => values.map(|own| from_fn(|q| signs[q] * own[q])),
            None => values,
        }
    }

    /// The same with their gradients, by function, direction and point.
    #[inline(always)]
    pub fn branches<const L: usize>(
        &self,
        x: &Points<L>,
        side: Option<Side>,
    ) -> ([[f64; L]; 4], [Points<L>; 4]) {
        let ([psi, phi], [ahead, across]) = self.placed(x, side);
        // By function: value, slope ahead, slope across.
        let mut g: [[[f64; L]; 3]; 4] = match self.pair(&psi, &phi, side) {
            Some(own) => from_fn(|l| from_fn(|k| own.map(|own| own[l][k]))),
            None => root_functions(&psi, &phi),
        };
        if let Some(signs) = self.signs(&psi, &phi, side) {
            g = g.map(|own| own.map(|own| from_fn(|q| signs[q] * own[q])));
        }
        let gradient = |[_, g1, g2]: [[f64; L]; 3]| {
            from_fn(|a| from_fn(|q| g1[q] * ahead[a][q] + g2[q] * across[a][q]))
        };
        (g.map(|g| g[0]), g.map(gradient))
    }
}

/// Whether a point, ahead and across, lies between a bent crack and the line from end to end. A point of the crack lies on the `side`
/// of its region.
fn lies_between(a: f64, bends: &[[f64; 2]], [x, y]: [f64; 2], side: Option<Side>) -> bool {
    if bends.is_empty() || x.abs() >= a {
        return false;
    }
    let next = bends.partition_point(|bend| bend[0] <= x);
    let from = next.checked_sub(1).map_or([-a, 0.0], |k| bends[k]);
    let to = bends.get(next).copied().unwrap_or([a, 0.0]);
    let above = y - (from[1] + (x - from[0]) / (to[0] - from[0]) * (to[1] - from[1]));
    let on = above.abs() <= ON_ARM * a;
    let left = side.filter(|_| on).unwrap_or(above) > 0.0;
    left != y.is_sign_positive()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> TipFrame {
        let (s, c) = 0.5f64.sin_cos();
        TipFrame::straight(0, [0.3, -0.2, 0.0], [c, s, 0.0], [-s, c, 0.0])
    }

    /// Source: √r sin θ/2, √r cos θ/2 and their products with sin θ, θ from atan2. Tolerance: rounding, also next to both faces.
    #[test]
    fn branch_functions_are_those_of_the_angle() {
        let tip = TipFrame::straight(0, [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let beside = [0.0, 1e-100, 1e-17, 1e-9, 0.3, 1.0, 7.0];
        let signed = |v: f64| [v, -v];
        for (psi, phi) in beside.into_iter().flat_map(|x| beside.map(|y| (x, y))) {
            for (psi, phi) in signed(psi)
                .into_iter()
                .flat_map(|x| signed(phi).map(|y| (x, y)))
            {
                let (r, theta) = (psi.hypot(phi), phi.atan2(psi));
                let (s, c) = (0.5 * theta).sin_cos();
                let exact = [s, c, s * theta.sin(), c * theta.sin()];
                let side = (phi == 0.0).then(|| 1f64.copysign(phi));
                let found = tip.branch(&[psi, phi, 0.0], side).0;
                for (found, exact) in found.iter().zip(exact) {
                    let error = (found - r.sqrt() * exact).abs();
                    assert!(error <= 1e-15 * r.sqrt(), "{psi} {phi}: {found} {exact}");
                }
            }
        }
    }

    /// A tip with a chain behind it that turns by 56 degrees.
    fn bent() -> TipFrame {
        let mut tip = frame();
        let [back, aside] = [tip.ahead.map(|v| -0.2 * v), tip.normal.map(|v| 0.3 * v)];
        let first = add_scaled(&tip.position, 1.0, &back);
        let second = add_scaled(&add_scaled(&first, 1.0, &back), 1.0, &aside);
        tip.shape = FrontShape::Bent(vec![tip.position, first, second]);
        tip
    }

    /// Source: the functions of the angle. Goal: those of the tangent go on up to either side of a chain, θ = ±π − β there, and nowhere
    /// else does one jump: half a turn around the tip from there all are continuous. Tolerance: √ of the distance from the chain.
    #[test]
    fn functions_of_a_chain_jump_on_it_alone() {
        let tip = bent();
        let FrontShape::Bent(path) = &tip.shape else {
            panic!("no chain");
        };
        let on = |a: &Point, b: &Point, t: f64| add_scaled(a, t, &sub(b, a));
        for (w, t) in path.windows(2).flat_map(|w| [0.2, 0.7].map(|t| (w, t))) {
            let x = on(&w[0], &w[1], t);
            let across = turned(&unit(&sub(&w[1], &w[0])));
            let from = sub(&x, &tip.position);
            let (r, beta) = (
                norm(&from),
                dot(&from, &tip.normal).atan2(-dot(&from, &tip.ahead)),
            );
            for sign in [1.0, -1.0] {
                // The first segment leads back from the tip: its left is side 2.
                let theta = -sign * std::f64::consts::PI - beta;
                let (s, c) = (0.5 * theta).sin_cos();
                let exact = [s, c, s * theta.sin(), c * theta.sin()].map(|g| r.sqrt() * g);
                let place = add_scaled(&x, 1e-9 * sign, &across);
                for (x, side) in [(place, None), (x, Some(-sign))] {
                    let found = tip.branch(&x, side).0;
                    let error = (0..4).map(|l| (found[l] - exact[l]).abs());
                    assert!(error.fold(0.0, f64::max) < 1e-7, "{t} {sign} {side:?}");
                }
            }
            let opposite = add_scaled(&tip.position, -1.0, &sub(&x, &tip.position));
            let [p, q] = [1e-9, -1e-9].map(|d| add_scaled(&opposite, d, &across));
            let [p, q] = [p, q].map(|x| tip.branch(&x, None).0);
            assert!((0..4).all(|l| (p[l] - q[l]).abs() < 1e-7), "{t}");
        }
    }

    #[test]
    fn branch_gradients_are_the_derivatives() {
        let places = [[0.5, 0.1, 0.0], [0.1, -0.5, 0.0], [-0.4, -0.2, 0.0]];
        for (tip, x) in [frame(), bent()]
            .iter()
            .flat_map(|tip| places.map(|x| (tip, x)))
        {
            let (_, gradients) = tip.branch(&x, None);
            let h = 1e-6;
            for a in 0..2 {
                let (mut p, mut m) = (x, x);
                p[a] += h;
                m[a] -= h;
                for l in 0..4 {
                    let slope = (tip.branch(&p, None).0[l] - tip.branch(&m, None).0[l]) / (2.0 * h);
                    assert!((slope - gradients[l][a]).abs() < 1e-8, "{x:?} {l} {a}");
                }
            }
        }
    }
}
