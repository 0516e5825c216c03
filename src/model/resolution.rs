//! Cracks for which the cells are too coarse: their dissipation and slip may be off by more than 3 %.
//!
//! ```text
//!   fewer than 3 contact points       pressure that varies along the crack has no points to turn on
//!   tips without ramp                 Σ lost > 3 % of its length, see `Narrow`
//!   2D, slips on fewer than 5 points  and sticks or opens on others: the end of the slip lies between two points. Closed form of
//!                                     partial slip, 120 cracks of 3 to 16 cells, error of the dissipation: 2 points 2 to 44 %,
//!                                     3: 3.3 % (median), 4: 1.3 (worst 4.5), from 5 on 0.7 (worst 3.8)
//! ```

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use stickslip_methods::PointStatus;

use crate::model::body::Body;

/// Relative error that is promised where nothing is told.
const PROMISED: f64 = 0.03;
/// Contact points of a crack, and those that slip beside others that do not: the least.
const POINTS: usize = 3;
const SLIPPING: usize = 5;

/// A crack for which the cells are too coarse.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Coarse {
    /// Its number, from 1.
    pub crack: usize,
    /// What it lacks.
    pub why: String,
    /// Cells that would do [m].
    pub cell_m: f64,
}

/// What the body tells.
pub fn too_coarse(body: &Body) -> Vec<Coarse> {
    let facets = body.mesh.dim() as i32 - 1;
    let mut found = Vec::new();
    for index in 0..body.integrated.len() {
        let own = || body.points.iter().filter(|point| point.crack == index);
        let (count, measure) = (own().count(), own().map(|point| point.weight).sum::<f64>());
        let mut add = |why: String, cell_m: f64| {
            let crack = index + 1;
            found.push(Coarse { crack, why, cell_m });
        };
        if count < POINTS {
            let plural = if count == 1 { "" } else { "s" };
            // Four cells along it have three points in every space.
            let cell_m = (measure / 4f64.powi(facets)).powf(1.0 / f64::from(facets));
            add(format!("{count} contact point{plural}"), cell_m);
        }
        let narrow = body.enrichment.narrow.iter();
        let tips: Vec<f64> = narrow
            .filter(|tip| tip.crack == index)
            .map(|tip| tip.lost)
            .collect();
        let lost: f64 = tips.iter().sum();
        if lost > PROMISED * measure {
            let count = tips.len();
            let plural = if count == 1 { "" } else { "s" };
            let cell_m = body.mesh.smallest_edge() * PROMISED * measure / lost;
            add(
                format!("no room for the functions of {count} tip{plural}"),
                cell_m,
            );
        }
    }
    found
}

/// The points that slip at once on every crack of a plane body, at most, along a load path.
#[derive(Debug, Default)]
pub struct Sliding(BTreeMap<usize, Slip>);

/// Points of a crack at the end of an increment.
#[derive(Debug, Default)]
struct Slip {
    slip: usize,
    others: usize,
    /// Of those that slip [m].
    length: f64,
}

impl Sliding {
    /// Looks at the end of an increment.
    pub fn see(&mut self, body: &Body, status: &[PointStatus]) {
        if body.mesh.dim() > 2 {
            return;
        }
        let mut now: BTreeMap<usize, Slip> = BTreeMap::new();
        for (point, status) in body.points.iter().zip(status) {
            let own = now.entry(point.crack).or_default();
            if *status == PointStatus::Slip {
                own.slip += 1;
                own.length += point.weight;
            } else {
                own.others += 1;
            }
        }
        for (crack, now) in now {
            let most = self.0.entry(crack).or_default();
            if now.slip >= most.slip {
                *most = now;
            }
        }
    }

    /// The cracks that slip on too few points.
    pub fn too_coarse(self) -> impl Iterator<Item = Coarse> {
        let few = |own: &Slip| (1..SLIPPING).contains(&own.slip) && own.others > 0;
        let all = self.0.into_iter().filter(move |(_, own)| few(own));
        all.map(|(index, Slip { slip, length, .. })| Coarse {
            crack: index + 1,
            why: format!("slip on {slip} of its contact points"),
            cell_m: length / SLIPPING as f64,
        })
    }
}
