//! Cracks of the 2D scenes, by category.

use std::f64::consts::PI;

use stickslip_xfem::mesh::stream::Stream;

use super::grid::{Grid, decades, list, offset};

pub type Place = [f64; 2];

/// Category, whether its cracks are placed by grid points, whether they are round: in hydrostatic stress only.
pub const KINDS: &[(&str, bool, bool)] = &[
    ("through", false, false),
    ("inner", false, false),
    ("edge", false, false),
    ("kinked", false, false),
    ("arc", false, true),
    ("circle", false, true),
    ("short", false, false),
    ("tee", false, false),
    ("tee-off", false, false),
    ("crossing", false, false),
    ("crossing-near-tip", false, false),
    ("parallel", false, false),
    ("end-at-node", true, false),
    ("end-at-edge", true, false),
    ("end-at-side", true, false),
    ("grid-line", true, false),
    ("diagonal", true, false),
    ("mixed", false, false),
];

/// A crack of a plane body.
#[derive(Clone)]
pub enum Flat {
    Chain(Vec<Place>),
    Arc {
        centre: Place,
        radius: f64,
        /// Angles of the ends [degrees].
        ends: Place,
    },
}

impl Flat {
    pub fn text(&self) -> String {
        match self {
            Flat::Chain(points) => {
                let points: Vec<String> = points.iter().map(|p| list(p)).collect();
                format!("points_m = [{}]\n", points.join(", "))
            }
            Flat::Arc {
                centre,
                radius,
                ends: [from, to],
            } => format!(
                "arc = {{ centre_m = {}, radius_m = {radius:?}, from_deg = {from:?}, to_deg = {to:?} }}\n",
                list(centre)
            ),
        }
    }

    pub fn is_closed(&self) -> bool {
        matches!(self, Flat::Arc { ends: [from, to], .. } if (to - from).abs() == 360.0)
    }

    /// Normals of the segments; an arc carries no shear whatever its normal.
    pub fn normals(&self) -> Vec<[f64; 3]> {
        match self {
            Flat::Chain(points) => points.windows(2).map(|w| normal(&w[0], &w[1])).collect(),
            Flat::Arc { .. } => Vec::new(),
        }
    }

    /// Length inside a box [m].
    pub fn length_in(&self, min: &[f64; 3], max: &[f64; 3]) -> f64 {
        match self {
            Flat::Chain(points) => points
                .windows(2)
                .map(|w| inside(&w[0], &w[1], min, max))
                .sum(),
            Flat::Arc {
                centre,
                radius,
                ends: [from, to],
            } => {
                let n = 20_000;
                let step = (to - from).to_radians().abs() / n as f64;
                let at = |i: usize| (from + (to - from) * (i as f64 + 0.5) / n as f64).to_radians();
                let within = |i: &usize| {
                    let (sin, cos) = at(*i).sin_cos();
                    let x = [centre[0] + radius * cos, centre[1] + radius * sin];
                    (0..2).all(|a| min[a] <= x[a] && x[a] <= max[a])
                };
                (0..n).filter(within).count() as f64 * step * radius
            }
        }
    }
}

/// Length of a segment inside a box (Liang & Barsky 1984).
fn inside(p: &Place, q: &Place, min: &[f64; 3], max: &[f64; 3]) -> f64 {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for a in 0..2 {
        let d = q[a] - p[a];
        if d == 0.0 {
            if p[a] < min[a] || p[a] > max[a] {
                return 0.0;
            }
            continue;
        }
        let (s, t) = ((min[a] - p[a]) / d, (max[a] - p[a]) / d);
        from = from.max(s.min(t));
        to = to.min(s.max(t));
    }
    (to - from).max(0.0) * distance(p, q)
}

/// Tangent from p to q, turned by +90 degrees.
fn normal(p: &Place, q: &Place) -> [f64; 3] {
    let length = distance(p, q);
    [-(q[1] - p[1]) / length, (q[0] - p[0]) / length, 0.0]
}

pub fn distance(p: &Place, q: &Place) -> f64 {
    (q[0] - p[0]).hypot(q[1] - p[1])
}

fn along(p: &Place, angle: f64, length: f64) -> Place {
    [p[0] + length * angle.cos(), p[1] + length * angle.sin()]
}

fn between(p: &Place, q: &Place, t: f64) -> Place {
    [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]
}

fn place(g: &Grid, low: f64, high: f64, s: &mut Stream) -> Place {
    let x = g.place(low, high, s);
    [x[0], x[1]]
}

fn angle(s: &mut Stream) -> f64 {
    s.between(-PI, PI)
}

/// Between 30 and 150 degrees to either side.
fn turn(s: &mut Stream) -> f64 {
    let size = s.between(30.0, 150.0).to_radians();
    if s.chance(0.5) { size } else { -size }
}

/// From outside to outside, through a place.
fn through(g: &Grid, p: &Place, angle: f64) -> Vec<Place> {
    let reach = 1.3 * g.diagonal();
    vec![along(p, angle, -reach), along(p, angle, reach)]
}

/// Two places inside, not next to each other.
fn inner(g: &Grid, s: &mut Stream) -> Vec<Place> {
    loop {
        let (p, q) = (place(g, 0.06, 0.94, s), place(g, 0.06, 0.94, s));
        if distance(&p, &q) > 0.3 * g.least() {
            return vec![p, q];
        }
    }
}

/// From a place to outside, or back.
fn leaving(g: &Grid, p: &Place, angle: f64, s: &mut Stream) -> Vec<Place> {
    let mut points = vec![*p, along(p, angle, 1.3 * g.diagonal())];
    if s.chance(0.5) {
        points.reverse();
    }
    points
}

/// Any straight crack.
fn straight(g: &Grid, s: &mut Stream) -> Vec<Place> {
    match s.whole(0, 2) {
        0 => through(g, &place(g, 0.15, 0.85, s), angle(s)),
        1 => inner(g, s),
        _ => leaving(g, &place(g, 0.15, 0.85, s), angle(s), s),
    }
}

fn cross(o: &Place, p: &Place, q: &Place) -> f64 {
    (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
}

/// One to three kinks of 25 to 120 degrees inside the body.
fn kinked(g: &Grid, s: &mut Stream) -> Vec<Place> {
    loop {
        let mut way = angle(s);
        let mut points = vec![place(g, -0.2, 0.9, s)];
        for leg in 0..=s.whole(1, 3) {
            if leg > 0 {
                let size = s.between(25.0, 120.0).to_radians();
                way += if s.chance(0.5) { size } else { -size };
            }
            let length = s.between(0.15, 0.7) * g.least();
            points.push(along(&points[leg], way, length));
        }
        let last = points.len() - 1;
        let within = |p: &Place| {
            (0..2).all(|a| {
                let part = (p[a] - g.min(a)) / g.size(a);
                part > 0.05 && part < 0.95
            })
        };
        let meet = |i: usize, j: usize| {
            let (a, b, c, d) = (&points[i], &points[i + 1], &points[j], &points[j + 1]);
            cross(a, b, c) * cross(a, b, d) <= 0.0 && cross(c, d, a) * cross(c, d, b) <= 0.0
        };
        let simple = (0..last).all(|i| (i + 2..last).all(|j| !meet(i, j)));
        if simple && points[1..last].iter().all(within) {
            return points;
        }
    }
}

/// A crack with one end at a place.
fn ending(g: &Grid, p: &Place, s: &mut Stream) -> Vec<Place> {
    if s.chance(0.4) {
        return leaving(g, p, angle(s), s);
    }
    loop {
        let q = place(g, 0.06, 0.94, s);
        if distance(p, &q) > 0.3 * g.least() {
            let mut points = vec![*p, q];
            if s.chance(0.5) {
                points.reverse();
            }
            return points;
        }
    }
}

/// A place of a crack that lies inside the body.
fn foot(g: &Grid, points: &[Place], s: &mut Stream) -> Place {
    for _ in 0..100 {
        let x = between(&points[0], &points[1], s.between(0.02, 0.98));
        if (0..2).all(|a| (x[a] - g.min(a)).min(g.max(a) - x[a]) > 0.08 * g.size(a)) {
            return x;
        }
    }
    between(&points[0], &points[1], 0.5)
}

/// A crack that ends on another, `off` metres along its normal.
fn tee(g: &Grid, off: f64, s: &mut Stream) -> Vec<Flat> {
    let main = straight(g, s);
    let n = normal(&main[0], &main[1]);
    let x = foot(g, &main, s);
    let x = [x[0] + off * n[0], x[1] + off * n[1]];
    let way = (main[1][1] - main[0][1]).atan2(main[1][0] - main[0][0]) + turn(s);
    let length = if s.chance(0.4) {
        1.3 * g.diagonal()
    } else {
        s.between(0.2, 0.7) * g.least()
    };
    let mut stem = vec![x, along(&x, way, length)];
    if s.chance(0.5) {
        stem.reverse();
    }
    any_order(vec![Flat::Chain(main), Flat::Chain(stem)], s)
}

/// In either order: the later crack must not matter less.
fn any_order(mut cracks: Vec<Flat>, s: &mut Stream) -> Vec<Flat> {
    if s.chance(0.5) {
        cracks.reverse();
    }
    cracks
}

/// Distance of two parallel chains; none of others [m].
pub fn apart(one: &Flat, two: &Flat) -> f64 {
    let (Flat::Chain(one), Flat::Chain(two)) = (one, two) else {
        return f64::INFINITY;
    };
    let n = normal(&one[0], &one[1]);
    ((two[0][0] - one[0][0]) * n[0] + (two[0][1] - one[0][1]) * n[1]).abs()
}

/// Cracks of a category. `h`: the shortest cell edge, the unit of all small distances.
pub fn cracks(category: &str, g: &Grid, s: &mut Stream) -> Vec<Flat> {
    let h = g.h();
    let one = |points| vec![Flat::Chain(points)];
    match category {
        "through" => one(through(g, &place(g, 0.15, 0.85, s), angle(s))),
        "inner" => one(inner(g, s)),
        "edge" => one(leaving(g, &place(g, 0.15, 0.85, s), angle(s), s)),
        "kinked" => one(kinked(g, s)),
        "arc" => {
            let from = s.between(-180.0, 60.0);
            let span = s.between(30.0, 300.0);
            let ends = if s.chance(0.5) {
                [from, from + span]
            } else {
                [from, (from - span).max(-360.0)]
            };
            vec![Flat::Arc {
                centre: place(g, 0.2, 0.8, s),
                radius: s.between(0.12, 0.5) * g.least(),
                ends,
            }]
        }
        "circle" => vec![Flat::Arc {
            centre: if s.chance(0.15) {
                place(g, 0.0, 1.0, s)
            } else {
                place(g, 0.32, 0.68, s)
            },
            radius: s.between(0.1, 0.3) * g.least(),
            ends: if s.chance(0.5) {
                [0.0, 360.0]
            } else {
                [-90.0, 270.0]
            },
        }],
        "short" => (0..s.whole(1, 2))
            .map(|_| {
                let p = place(g, 0.1, 0.9, s);
                Flat::Chain(vec![p, along(&p, angle(s), s.between(0.4, 3.5) * h)])
            })
            .collect(),
        "tee" => tee(g, 0.0, s),
        "tee-off" => {
            let off = decades(s, -14.0, -3.0) * h;
            let off = if s.chance(0.5) { off } else { -off };
            tee(g, off, s)
        }
        "crossing" => {
            let main = straight(g, s);
            let x = foot(g, &main, s);
            let way = (main[1][1] - main[0][1]).atan2(main[1][0] - main[0][0]) + turn(s);
            let reach = if s.chance(0.5) {
                [1.3 * g.diagonal(); 2]
            } else {
                [0; 2].map(|_| s.between(0.15, 0.5) * g.least())
            };
            let other = vec![along(&x, way, -reach[0]), along(&x, way, reach[1])];
            any_order(vec![Flat::Chain(main), Flat::Chain(other)], s)
        }
        "crossing-near-tip" => {
            let mut main = inner(g, s);
            if s.chance(0.4) {
                main = leaving(g, &main[0], angle(s), s);
                // The tip first.
                let centre = [0, 1].map(|a| 0.5 * (g.min(a) + g.max(a)));
                if distance(&main[1], &centre) < distance(&main[0], &centre) {
                    main.reverse();
                }
            }
            let away = decades(s, -14.0, 3f64.log10()) * h;
            let x = between(&main[0], &main[1], away / distance(&main[0], &main[1]));
            let way = (main[1][1] - main[0][1]).atan2(main[1][0] - main[0][0]) + turn(s);
            let reach = s.between(0.15, 1.3) * g.least();
            let other = vec![along(&x, way, -reach), along(&x, way, reach)];
            any_order(vec![Flat::Chain(main), Flat::Chain(other)], s)
        }
        "parallel" => {
            let main = straight(g, s);
            let n = normal(&main[0], &main[1]);
            let off = decades(s, -12.0, 2f64.log10()) * h;
            let mut other: Vec<Place> = (main.iter())
                .map(|p| [p[0] + off * n[0], p[1] + off * n[1]])
                .collect();
            if s.chance(0.5) {
                let part = [s.between(-0.2, 0.3), s.between(0.7, 1.2)];
                other = part.map(|t| between(&other[0], &other[1], t)).to_vec();
            }
            vec![Flat::Chain(main), Flat::Chain(other)]
        }
        "end-at-node" => {
            let node = [0, 1].map(|a| g.lines[a][g.inner(a, s)]);
            let end = along(&node, angle(s), offset(s, -14.0, 0.0) * h);
            one(ending(g, &end, s))
        }
        "end-at-edge" => {
            let a = s.whole(0, 1);
            let mut end = place(g, 0.1, 0.9, s);
            end[a] = g.lines[a][g.inner(a, s)] + offset(s, -14.0, 0.0) * h;
            one(ending(g, &end, s))
        }
        "end-at-side" => {
            let mut end = place(g, 0.05, 0.95, s);
            let a = s.whole(0, 1);
            for b in 0..2 {
                if b == a || s.chance(0.3) {
                    let side = if s.chance(0.5) { g.min(b) } else { g.max(b) };
                    end[b] = side + offset(s, -14.0, 0.0) * h;
                }
            }
            one(ending(g, &end, s))
        }
        "grid-line" => {
            let (a, off) = (s.whole(0, 1), offset(s, -14.0, -2.0) * h);
            let level = g.lines[a][g.inner(a, s)] + off;
            let b = 1 - a;
            let last = g.lines[b].len() - 1;
            let mut ends = match s.whole(0, 3) {
                0 => [g.min(b) - 0.1 * g.size(b), g.max(b) + 0.1 * g.size(b)],
                1 => [g.lines[b][0], g.lines[b][last]],
                2 => [g.lines[b][1], g.lines[b][last] - 0.4 * h],
                _ => [g.min(b) - 0.1 * g.size(b), g.lines[b][last - 1] - 0.3 * h],
            };
            if s.chance(0.5) {
                ends.reverse();
            }
            let point = |along: f64| {
                if a == 0 {
                    [level, along]
                } else {
                    [along, level]
                }
            };
            one(ends.map(point).to_vec())
        }
        "diagonal" => {
            // From node to node; from corner to corner of the body, or on to outside, at times.
            let node = |i: usize, j: usize| [g.lines[0][i], g.lines[1][j]];
            let (m, n) = (g.lines[0].len() - 1, g.lines[1].len() - 1);
            let steps = s.whole(2, m.min(n));
            let (i, j) = (s.whole(0, m - steps), s.whole(0, n - steps));
            let rising = s.chance(0.5);
            let [mut p, mut q] = match (s.chance(0.2), rising) {
                (true, true) => [node(0, 0), node(m, n)],
                (true, false) => [node(0, n), node(m, 0)],
                (false, true) => [node(i, j), node(i + steps, j + steps)],
                (false, false) => [node(i, j + steps), node(i + steps, j)],
            };
            if s.chance(0.5) {
                let way = (q[1] - p[1]).atan2(q[0] - p[0]);
                [p, q] = [along(&p, way, -2.0 * g.diagonal()), q];
                if s.chance(0.5) {
                    q = along(&q, way, 2.0 * g.diagonal());
                }
            }
            one(vec![p, q])
        }
        _ => (0..s.whole(2, 4))
            .map(|_| {
                Flat::Chain(if s.chance(0.3) {
                    kinked(g, s)
                } else {
                    straight(g, s)
                })
            })
            .collect(),
    }
}
