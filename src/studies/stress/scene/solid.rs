//! Cracks of the 3D scenes, by category.

use stickslip_xfem::mesh::stream::Stream;

use super::grid::{Grid, list, offset};

type Place = [f64; 3];

/// As `flat::KINDS`. The round ones are flat and need no special stress, but cells that are not much larger than they.
pub const KINDS: &[(&str, bool, bool)] = &[
    ("plane", true, false),
    ("two-planes", true, false),
    ("three-planes", true, false),
    ("plane-at-node", true, false),
    ("plane-at-face", true, false),
    ("disc", true, true),
    ("disc-reaching", true, true),
    ("disc-at-node", true, true),
    ("ellipse", true, true),
    ("ellipse-reaching", true, true),
    ("disc-plane", true, true),
];

/// A flat crack in a solid.
pub struct Flaw {
    centre: Place,
    normal: Place,
    /// First half axis and both half lengths; none: a plane.
    front: Option<(Place, [f64; 2])>,
}

impl Flaw {
    /// A plane through a point.
    pub fn plane(centre: Place, normal: Place) -> Self {
        Flaw {
            centre,
            normal,
            front: None,
        }
    }

    pub fn text(&self) -> String {
        let (at, n) = (list(&self.centre), list(&self.normal));
        match &self.front {
            None => format!("plane = {{ point_m = {at}, normal = {n} }}\n"),
            Some((_, [r, other])) if r == other => {
                format!("disc = {{ centre_m = {at}, normal = {n}, radius_m = {r:?} }}\n")
            }
            Some((axis, halves)) => format!(
                "ellipse = {{ centre_m = {at}, normal = {n}, axis = {}, half_axes_m = {} }}\n",
                list(axis),
                list(halves)
            ),
        }
    }

    pub fn has_front(&self) -> bool {
        self.front.is_some()
    }

    /// Smaller width; endless of a plane [m].
    pub fn width(&self) -> f64 {
        let halves = self.front.map(|front| front.1);
        halves.map_or(f64::INFINITY, |[a, b]| 2.0 * a.min(b))
    }

    /// Unit normal.
    pub fn normal(&self) -> Place {
        unit(&self.normal)
    }
}

fn unit(v: &Place) -> Place {
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    v.map(|c| c / length)
}

fn direction(s: &mut Stream) -> Place {
    loop {
        let v = [0; 3].map(|_| s.between(-1.0, 1.0));
        let square: f64 = v.iter().map(|c| c * c).sum();
        if square > 0.01 && square < 1.0 {
            return v;
        }
    }
}

fn place(g: &Grid, low: f64, high: f64, s: &mut Stream) -> Place {
    let x = g.place(low, high, s);
    [x[0], x[1], x[2]]
}

/// Cracks of a category. `h`: the shortest cell edge, the unit of all small distances.
pub fn cracks(category: &str, g: &Grid, s: &mut Stream) -> Vec<Flaw> {
    let (h, least) = (g.h(), g.least());
    let plane = |s: &mut Stream| Flaw {
        centre: place(g, 0.2, 0.8, s),
        normal: direction(s),
        front: None,
    };
    let front = |low: f64, high: f64, round: bool, s: &mut Stream| {
        let r = s.between(low, high) * least;
        let other = if round { r } else { r * s.between(0.4, 1.0) };
        Some((direction(s), [r, other]))
    };
    let round = category.starts_with("disc");
    match category {
        "plane" => vec![plane(s)],
        "two-planes" => vec![plane(s), plane(s)],
        "three-planes" => vec![plane(s), plane(s), plane(s)],
        "plane-at-node" => {
            let node = [0, 1, 2].map(|a| g.lines[a][g.inner(a, s)]);
            let off = offset(s, -14.0, 0.0) * h;
            let normal = direction(s);
            let n = unit(&normal);
            vec![Flaw {
                centre: [0, 1, 2].map(|a| node[a] + off * n[a]),
                normal,
                front: None,
            }]
        }
        "plane-at-face" => {
            // Along a layer of faces, as good as.
            let a = s.whole(0, 2);
            let mut centre = place(g, 0.2, 0.8, s);
            centre[a] = g.lines[a][g.inner(a, s)] + offset(s, -14.0, -1.0) * h;
            let mut normal = [0.0; 3];
            normal[a] = if s.chance(0.5) { 1.0 } else { -1.0 };
            if s.chance(0.3) {
                normal[(a + 1) % 3] = offset(s, -14.0, -2.0);
            }
            vec![Flaw {
                centre,
                normal,
                front: None,
            }]
        }
        "disc" | "ellipse" => vec![Flaw {
            centre: place(g, 0.4, 0.6, s),
            normal: direction(s),
            front: front(0.2, 0.38, round, s),
        }],
        "disc-reaching" | "ellipse-reaching" => {
            let mut centre = place(g, 0.3, 0.7, s);
            let a = s.whole(0, 2);
            let side = if s.chance(0.5) { g.min(a) } else { g.max(a) };
            centre[a] = side + offset(s, -14.0, 0.0) * h;
            vec![Flaw {
                centre,
                normal: direction(s),
                front: front(0.25, 0.45, round, s),
            }]
        }
        "disc-at-node" => {
            // Its plane passes a node, or its front does.
            let node = [0, 1, 2].map(|a| g.lines[a][g.inner(a, s)]);
            let off = offset(s, -14.0, 0.0) * h;
            let normal = direction(s);
            let n = unit(&normal);
            let r = s.between(0.2, 0.38) * least;
            let mut centre = [0, 1, 2].map(|a| node[a] + off * n[a]);
            if s.chance(0.5) {
                let v = direction(s);
                let part: f64 = (0..3).map(|a| v[a] * n[a]).sum();
                let t = unit(&[0, 1, 2].map(|a| v[a] - part * n[a]));
                centre = [0, 1, 2].map(|a| node[a] + (r + off) * t[a]);
            }
            vec![Flaw {
                centre,
                normal,
                front: Some(([1.0, 0.0, 0.0], [r, r])),
            }]
        }
        _ => {
            let mut cracks = vec![
                plane(s),
                Flaw {
                    centre: place(g, 0.4, 0.6, s),
                    normal: direction(s),
                    front: front(0.25, 0.4, true, s),
                },
            ];
            if s.chance(0.7) {
                // Through the disc for certain.
                cracks[0].centre = cracks[1].centre;
                cracks[0].centre[s.whole(0, 2)] += s.between(-0.1, 0.1) * least;
            }
            if s.chance(0.5) {
                cracks.reverse();
            }
            cracks
        }
    }
}
