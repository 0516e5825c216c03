//! Course of the iterates of a method: their states, what they violate, how far they move.
//!
//! States are those of the trial z = P − ρ v, as the return mapping reads them, whatever the method's own scale: open
//! z_n <= 0, stick |z_t| <= μ z_n, slip otherwise, with its direction.

use std::collections::VecDeque;

use stickslip_methods::law::{Branch, return_map};
use stickslip_methods::{Gauge, Monitor};

/// State vectors that are kept.
pub const RING: usize = 300;

/// Iterates after which a run is stopped: what it does shows by then.
const LIMIT: usize = 200_000;

/// Directions of slip told apart: each way along a line, sectors of 45° in a plane.
const SECTORS: f64 = 8.0;

/// State of a point: open, stick, and from [`SLIP`] on slip by direction.
pub type State = u8;
/// No contact force.
pub const OPEN: State = 0;
/// Closed without slip, also closed without friction.
pub const STICK: State = 1;
/// The first direction of slip.
pub const SLIP: State = 2;

/// Numbers of one iterate. Changes are those from the iterate before, infinite for the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// η, the violation of the contact laws.
    pub violation: f64,
    /// max −g over u_ref.
    pub penetration: f64,
    /// |P_k − P_{k−1}| / |P_k|.
    pub force_change: f64,
    /// max_i |P_k − P_{k−1}|_i / max_i |P_k|_i over the points.
    pub point_change: f64,
    /// |v_k − v_{k−1}| / |v_k|.
    pub jump_change: f64,
    /// |s_k − s_{k−1}| / |s_k + s_{k−1}| with s = (P, ρ v).
    pub pair_change: f64,
    /// Points that changed between open, stick and slip.
    pub changes: usize,
}

/// A monitor that keeps what it sees.
pub struct Watch<'a> {
    /// The increment.
    pub gauge: &'a Gauge<'a>,
    seen: Vec<Seen>,
    ring: VecDeque<Vec<State>>,
    /// The iterate seen last.
    last: Option<(Vec<f64>, Vec<f64>)>,
}

impl<'a> Watch<'a> {
    /// Nothing seen yet.
    pub fn new(gauge: &'a Gauge<'a>) -> Self {
        Self {
            gauge,
            seen: Vec::new(),
            ring: VecDeque::new(),
            last: None,
        }
    }

    /// Every iterate.
    pub fn seen(&self) -> &[Seen] {
        &self.seen
    }

    /// States of the last iterates, the last one last.
    pub fn states(&self) -> &VecDeque<Vec<State>> {
        &self.ring
    }

    /// P and v of the last iterate.
    pub fn last(&self) -> Option<(&[f64], &[f64])> {
        self.last.as_ref().map(|(p, v)| (&p[..], &v[..]))
    }

    /// States of all points.
    fn read(&self, p: &[f64], v: &[f64]) -> Vec<State> {
        let rho = self.gauge.rho();
        let points = self.gauge.rows().iter().zip(self.gauge.friction());
        let state = |(own, &mu): (std::ops::Range<usize>, &f64)| {
            let z: Vec<f64> = own.map(|k| p[k] - rho * v[k]).collect();
            match return_map(mu, &mut z.clone()) {
                Branch::Open => OPEN,
                Branch::Stick => STICK,
                Branch::Slip => SLIP + direction(&z[1..]),
            }
        };
        points.map(state).collect()
    }
}

/// Number of the direction of a tangential vector.
fn direction(z: &[f64]) -> u8 {
    match z {
        [a, b] => {
            let turn = (b.atan2(*a) / std::f64::consts::TAU).rem_euclid(1.0);
            (turn * SECTORS) as u8 % SECTORS as u8
        }
        [a] => u8::from(*a < 0.0),
        _ => 0,
    }
}

fn norm(x: impl Iterator<Item = f64>) -> f64 {
    x.map(|x| x * x).sum::<f64>().sqrt()
}

/// A change over a size; infinite where there is no size, so that nothing at all is no sign of an end.
fn relative(change: f64, size: f64) -> f64 {
    if size > 0.0 {
        change / size
    } else {
        f64::INFINITY
    }
}

impl Monitor for Watch<'_> {
    fn step(&mut self, _iteration: usize, _violation: f64) -> bool {
        self.seen.len() < LIMIT
    }

    fn iterate(&mut self, at: &dyn Fn() -> (Vec<f64>, Vec<f64>)) {
        let (p, v) = at();
        let found = self.gauge.residuals(&p, &v);
        let mut seen = Seen {
            violation: found.violation,
            penetration: found.penetration,
            force_change: f64::INFINITY,
            point_change: f64::INFINITY,
            jump_change: f64::INFINITY,
            pair_change: f64::INFINITY,
            changes: self.gauge.rows().points(),
        };
        let states = self.read(&p, &v);
        if let (Some((p0, v0)), Some(before)) = (&self.last, self.ring.back()) {
            let apart = |a: &[f64], b: &[f64]| norm(a.iter().zip(b).map(|(a, b)| a - b));
            let together = |a: &[f64], b: &[f64]| norm(a.iter().zip(b).map(|(a, b)| a + b));
            let size = |a: &[f64]| norm(a.iter().copied());
            let (dp, dv) = (apart(&p, p0), apart(&v, v0));
            let rho = self.gauge.rho();
            seen.force_change = relative(dp, size(&p));
            seen.jump_change = relative(dv, size(&v));
            seen.pair_change = relative(
                dp.hypot(rho * dv),
                together(&p, p0).hypot(rho * together(&v, v0)),
            );
            let (mut most, mut largest) = (0.0_f64, 0.0_f64);
            for own in self.gauge.rows().iter() {
                most = most.max(apart(&p[own.clone()], &p0[own.clone()]));
                largest = largest.max(size(&p[own]));
            }
            seen.point_change = relative(most, largest);
            let kind = |state: &State| (*state).min(SLIP);
            let pairs = states.iter().zip(before);
            seen.changes = pairs.filter(|(a, b)| kind(a) != kind(b)).count();
        }
        self.seen.push(seen);
        if self.ring.len() == RING {
            self.ring.pop_front();
        }
        self.ring.push_back(states);
        self.last = Some((p, v));
    }
}
