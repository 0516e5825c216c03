//! The crack behind a tip, as the auxiliary fields of the interaction integral see it.
//!
//! ```text
//!   u^aux  Williams' field of the tangent at the tip, its angle continued up to the faces:
//!          −π + β(r) < θ < π + β(r),   β(r) the angle at which the crack lies at the distance r
//! ```
//!
//! So it jumps over the crack alone and is in equilibrium everywhere. 2π more or less turns the sign of all four functions.

use crate::cut::crack::{Crack, End, PathVertex};
use crate::geometry::clip::Side;
use crate::geometry::tip_frame::{FrontShape, TipFrame};
use crate::geometry::{Point, dot, norm, sub};

use super::interaction::Obstacle;
use super::williams::Williams;

/// A sharp bend nearer to the tip than this, in edges of its cells, spoils the field there.
const SHORTEST_LEG: f64 = 2.0;

/// What the smallest domain reaches, in the same: cells around two of them.
const DOMAIN: f64 = 3.5;

/// Least cosine of the angles of the crack behind a tip with the radius and, seen from the tip, with its tangent there: 75 degrees.
const LEADING: f64 = 0.25;

/// A point farther than this from the crack behind a tip is no part of it, in parts of the distance from the tip.
const BESIDE: f64 = 0.05;

/// The crack behind a tip.
pub(super) struct Behind {
    /// Its arms, that of the tip first.
    pub arms: Vec<usize>,
    /// The tip, its tangent for the crack.
    pub tangent: TipFrame,
    /// The tip with the crack, as far as it leads away.
    bent: TipFrame,
    /// Cells that would leave room for a domain where it bends too near or too much [m].
    room: f64,
}

impl Behind {
    /// Around sharp bends that are not nearer than [`SHORTEST_LEG`] edges, in all up to `reach` [m].
    pub fn new(tip: &TipFrame, cracks: &[Crack], [edge, reach]: [f64; 2]) -> Self {
        let away = |x: &Point| sub(x, &tip.position);
        let far = |v: Option<&PathVertex>| v.map_or(0.0, |v| norm(&away(&v.x)));
        let own = &cracks[tip.crack].path;
        let end = usize::from(far(own.last()) < far(own.first()));
        let mut behind = Behind {
            arms: Vec::new(),
            tangent: TipFrame::straight(tip.crack, tip.position, tip.ahead, tip.normal),
            bent: TipFrame::straight(tip.crack, tip.position, tip.ahead, tip.normal),
            room: f64::INFINITY,
        };
        let mut path = vec![tip.position];
        let leads = |from: &Point, to: &Point| {
            let (on, back, ahead) = (sub(to, from), away(from), away(to));
            dot(&back, &on) >= LEADING * norm(&back) * norm(&on)
                && -dot(&ahead, &tip.ahead) >= LEADING * norm(&ahead)
        };
        let mut next = Some(tip.crack);
        while let Some(arm) = next {
            behind.arms.push(arm);
            let mut own: Vec<Point> = cracks[arm].path.iter().map(|v| v.x).collect();
            if end == 1 {
                own.reverse();
            }
            let before = path.len();
            for to in own.iter().skip(1) {
                let from = path[path.len() - 1];
                let far = norm(&away(&from));
                if far <= reach && leads(&from, to) {
                    path.push(*to);
                    continue;
                }
                if far <= reach {
                    behind.room = far / DOMAIN;
                }
                break;
            }
            let whole = path.len() + 1 == before + own.len();
            let other = if end == 0 {
                Some(arm + 1)
            } else {
                arm.checked_sub(1)
            };
            next = other.filter(|_| whole).filter(|&other| {
                let goes_on = |other: &Crack| {
                    other.number == cracks[arm].number
                        && cracks[arm].ends[1 - end] == End::Bend
                        && other.range[end] == cracks[arm].range[1 - end]
                };
                cracks.get(other).is_some_and(goes_on)
            });
            if next.is_some() {
                let bend = norm(&away(&path[path.len() - 1]));
                if bend < SHORTEST_LEG * edge {
                    behind.room = bend / SHORTEST_LEG;
                    next = None;
                }
            }
        }
        if path.len() > 2 {
            behind.bent.shape = FrontShape::Bent(path);
        }
        behind
    }

    /// A part of its crack that is not behind the tip, in the domain around it.
    pub fn too_near(&self, x: &Point) -> Obstacle {
        let far = norm(&sub(x, &self.tangent.position));
        Obstacle::Bend(self.room.min(far / DOMAIN))
    }

    /// Whether the crack is straight: the auxiliary faces are free of traction.
    pub fn is_straight(&self) -> bool {
        self.bent.shape == FrontShape::Straight
    }

    /// Whether a point of a crack is a part of it.
    pub fn holds(&self, x: &Point) -> bool {
        let [psi, phi] = self.bent.beside(x);
        psi < 0.0 && phi.abs() <= BESIDE * -psi
    }

    /// Gradient of an auxiliary field, on the given side of the crack next to it.
    pub fn gradient(&self, mode: &Williams<'_>, x: &Point, side: Option<Side>) -> [Point; 3] {
        let at = self.tangent.coordinates(x);
        if at.psi >= 0.0 {
            return mode.at(x, None).1;
        }
        let side = side.unwrap_or_else(|| 1f64.copysign(self.bent.beside(x)[1]));
        if side * at.phi < 0.0 {
            // Half the angle is off by π there.
            mode.at(x, None).1.map(|row| row.map(|v| -v))
        } else {
            mode.at(x, Some(side)).1
        }
    }
}
