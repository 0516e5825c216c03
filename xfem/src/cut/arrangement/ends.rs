//! Modelling lengths: what an end or a bend nearly touches is joined with it, and a crack beside which another ends is parted there.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use crate::cut::crack::{Crack, Geometry, Tip};
use crate::cut::placement::cells_at;
use crate::geometry::boxes::{Boxes, around};
use crate::geometry::curve::Curve;
use crate::geometry::polygon::{crossed, segment_distance, segment_foot};
use crate::geometry::{Point, add_scaled, cross, dot, mean, norm, root, sub, unit, unite};

use super::around::Around;
use super::snap::Net;
use super::{BEND, DELTA, LINE};

/// An end or a bend closer than this to another crack, to another end or to a side of the body is joined with it, in units of the
/// shortest edge: nobody gives a point on a slanted crack to all digits. Farther away what lies between stays a ligament.
pub(super) const JOINED: f64 = 1e-2;

/// How far an end is followed to where it really crosses, in the same units: so it keeps its direction.
const FOLLOWED: f64 = 10.0 * JOINED;

/// A crack that another's end is nearer to than this, in the same units, is parted at the foot of that end.
const BESIDE: f64 = 1.0;

/// An end of a polyline.
#[derive(Clone, Copy)]
struct End {
    line: usize,
    /// Its last point; otherwise its first.
    last: bool,
    x: Point,
    /// Unit direction out of the crack.
    ahead: Point,
}

impl End {
    /// Where the line of the end crosses a segment p q: how far ahead [m], and how far along, in parts of it.
    fn passes(&self, [p, q]: [&Point; 2]) -> Option<(f64, f64)> {
        let (d, from) = (sub(q, p), sub(p, &self.x));
        let turn = cross(&self.ahead, &d)[2];
        let [t, share] = [&d, &self.ahead].map(|v| cross(&from, v)[2] / turn);
        (0.0..=1.0).contains(&share).then_some((t, share))
    }
}

/// Joins the ends and bends of polylines with what they nearly touch, all as they were put: by no order. Those that were moved: which
/// line, from where and to where [m].
pub(super) fn join(around: &Around<'_>, lines: &mut [Vec<Point>]) -> Vec<(usize, Point, Point)> {
    let size = around.lengths.smallest;
    let inside = |end: &End| !cells_at(around.mesh, &end.x).is_empty();
    let ends: Vec<End> = (0..lines.len())
        .flat_map(|line| ends_of(line, &lines[line]))
        .filter(inside)
        .collect();
    let boxes = Boxes::new(lines.iter().map(|line| self::around(line, JOINED * size)));
    let place = |end: &End| [0, lines[end.line].len() - 1][usize::from(end.last)];
    let mut led: Vec<(usize, usize, Point)> = Vec::new();
    for group in groups(&ends, size) {
        let own: Vec<usize> = group.iter().map(|end| end.line).collect();
        let met = group.iter().filter_map(|end| {
            let near = boxes.meeting(&[end.x; 2]).into_iter();
            let others = near.filter(|line| !own.contains(line));
            let places = others.filter_map(|line| met(around, end, &lines[line]));
            // Where it lies on one already, or the first that it runs into.
            let key = |x: &Point| (*x != end.x, dot(&sub(x, &end.x), &end.ahead));
            places.min_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal))
        });
        let middle = mean(&group.iter().map(|end| end.x).collect::<Vec<_>>());
        let met = nearest_of(met, &middle);
        // On the side of the body, where that is beside.
        let common = met.or_else(|| {
            let x = common_place(&group, size)?;
            Some(side_beside(around, &x).map_or(x, |foot| foot.1))
        });
        for end in &group {
            let to = common.or_else(|| way_out(around, end));
            led.extend(to.map(|to| (end.line, place(end), to)));
        }
    }
    led.extend(bends_beside(around, lines, &ends));
    // A place that was put there keeps its digits.
    led.retain(|(line, k, to)| norm(&sub(to, &lines[*line][*k])) > around.lengths.rounding);
    let moved = led
        .iter()
        .map(|&(line, k, to)| (line, lines[line][k], to))
        .collect();
    for (line, k, to) in led {
        lines[line][k] = to;
    }
    moved
}

/// The ends of an open polyline.
fn ends_of(line: usize, points: &[Point]) -> Vec<End> {
    let &[first, second, ..] = points else {
        return Vec::new();
    };
    let (last, before) = (points[points.len() - 1], points[points.len() - 2]);
    if first == last {
        return Vec::new();
    }
    let end = |last: bool, x: Point, before: Point| End {
        line,
        last,
        x,
        ahead: unit(&sub(&x, &before)),
    };
    vec![end(false, first, second), end(true, last, before)]
}

/// Ends that are that close to each other, also by others in between.
fn groups(ends: &[End], size: f64) -> Vec<Vec<End>> {
    let boxes = Boxes::new(ends.iter().map(|end| [end.x; 2]));
    let mut parent: Vec<usize> = (0..ends.len()).collect();
    for (i, end) in ends.iter().enumerate() {
        for j in boxes.meeting(&around(&[end.x], JOINED * size)) {
            let close = norm(&sub(&end.x, &ends[j].x)) <= JOINED * size;
            // What lies between two that run beside each other stays.
            let beside =
                dot(&end.ahead, &ends[j].ahead) > 0.0 && crossing(end, &ends[j], size).is_none();
            if close && !beside && ends[j].line != end.line {
                unite(&mut parent, i, j);
            }
        }
    }
    let mut groups: BTreeMap<usize, Vec<End>> = BTreeMap::new();
    for (i, end) in ends.iter().enumerate() {
        groups.entry(root(&mut parent, i)).or_default().push(*end);
    }
    groups.into_values().collect()
}

/// Where the line of an end crosses a polyline that it nearly touches, the nearest such place; at a bend of that, or where that leaves
/// the body, if it is beside.
fn met(around: &Around<'_>, end: &End, points: &[Point]) -> Option<Point> {
    let size = around.lengths.smallest;
    let close = |w: &&[Point]| segment_distance(&end.x, &w[0], &w[1]) <= FOLLOWED * size;
    let segments = points.windows(2).filter(close);
    let away = |w: &[Point]| segment_distance(&end.x, &w[0], &w[1]);
    let nearest = segments.clone().map(away).fold(f64::INFINITY, f64::min);
    if nearest > JOINED * size {
        return None;
    }
    // It lies there: what it runs through is snapped to it.
    let lies_there = nearest <= LINE * DELTA * size;
    let places = segments.filter_map(|w| {
        let (t, share) = end.passes([&w[0], &w[1]])?;
        (t.abs() <= FOLLOWED * size).then(|| add_scaled(&w[0], share, &sub(&w[1], &w[0])))
    });
    let crossing = match lies_there {
        true => Some(end.x),
        false => nearest_of(places, &end.x),
    };
    // It passes a bend of the other; beside a straight part it ends alone.
    let from = crossing.unwrap_or(end.x);
    let bends = points.windows(3).filter(|w| bend(w) > BEND).map(|w| w[1]);
    let sides = around.sides_near(&[from], JOINED * size);
    let mouths = sides.flat_map(|edge| {
        let side = edge.map(|node| *around.at(node));
        let meets = move |w: &[Point]| Some(crossed([&w[0], &w[1]], [&side[0], &side[1]], 0.0)?.1);
        points.windows(2).filter_map(meets).collect::<Vec<_>>()
    });
    let beside = |x: &Point| norm(&sub(x, &from)) <= JOINED * size;
    nearest_of(bends.chain(mouths).filter(beside), &from).or(crossing)
}

/// The nearest of some places to one, of equals the first.
fn nearest_of(places: impl Iterator<Item = Point>, from: &Point) -> Option<Point> {
    let away = |x: &Point| norm(&sub(x, from));
    places.min_by(|a, b| away(a).total_cmp(&away(b)))
}

/// By how much a polyline turns at the middle one of three points [rad].
pub(super) fn bend(w: &[Point]) -> f64 {
    let [a, b] = [0, 1].map(|i| sub(&w[i + 1], &w[i]));
    cross(&a, &b)[2].atan2(dot(&a, &b)).abs()
}

/// The point of a polyline nearest to a place, with its distance [m].
fn foot(x: &Point, points: &[Point]) -> Option<(f64, Point)> {
    let feet = points.windows(2).map(|w| segment_foot(x, &w[0], &w[1]));
    let feet = feet.map(|foot| (norm(&sub(&foot, x)), foot));
    feet.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The bends of polylines that nearly touch another or a side: which line and point, and where it is led [m]. Those beside ends stay:
/// the end is led there.
fn bends_beside(
    around: &Around<'_>,
    lines: &[Vec<Point>],
    ends: &[End],
) -> Vec<(usize, usize, Point)> {
    let size = around.lengths.smallest;
    let bent = |line: usize| {
        lines[line]
            .windows(3)
            .enumerate()
            .filter_map(move |(k, w)| (bend(w) > BEND).then_some((line, k + 1, w[1])))
    };
    let all: Vec<(usize, usize, Point)> = (0..lines.len()).flat_map(bent).collect();
    let boxes = Boxes::new(lines.iter().map(|line| self::around(line, JOINED * size)));
    let [places, tips] = [
        Boxes::new(all.iter().map(|bend| [bend.2; 2])),
        Boxes::new(ends.iter().map(|end| [end.x; 2])),
    ];
    let close = |x: &Point, y: &Point| norm(&sub(x, y)) <= JOINED * size;
    let led = |&(line, k, x): &(usize, usize, Point)| {
        let here = self::around(&[x], JOINED * size);
        let mut near = tips.meeting(&here).into_iter();
        if near.any(|end| close(&ends[end].x, &x)) {
            return None;
        }
        // What runs beside one of its legs stays apart.
        let legs = [k - 1, k + 1].map(|next| {
            let d = unit(&sub(&lines[line][next], &x));
            add_scaled(&x, FOLLOWED * size, &d)
        });
        let apart = |other: usize| {
            let near = |leg: &Point| foot(leg, &lines[other]).is_some_and(|f| f.0 <= JOINED * size);
            other != line && legs.iter().any(near)
        };
        let near = places.meeting(&here).into_iter();
        let others = near.filter(|&k| close(&all[k].2, &x) && !apart(all[k].0));
        let others: Vec<Point> = others.map(|other| all[other].2).collect();
        if others.len() > 1 {
            return Some((line, k, mean(&others)));
        }
        let near = boxes.meeting(&[x; 2]).into_iter();
        let near = near.filter(|&other| other != line && !apart(other));
        let feet = near.filter_map(|other| foot(&x, &lines[other]));
        let nearest = feet.chain(side_beside(around, &x));
        let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
        let (_, to) = nearest.filter(|(away, _)| *away <= JOINED * size)?;
        Some((line, k, to))
    };
    all.iter().filter_map(led).collect()
}

/// The place that several ends are joined in: where their lines cross, so that they keep their directions, or halfway.
fn common_place(group: &[End], size: f64) -> Option<Point> {
    let first = group.first()?;
    if group.len() < 2 || group.iter().all(|end| end.x == first.x) {
        return (group.len() > 1).then_some(first.x);
    }
    let mut crossings = Vec::new();
    for (i, one) in group.iter().enumerate() {
        for two in &group[..i] {
            let of_all = |x: &Point| group.iter().all(|end| is_near(end, x, size));
            crossings.extend(crossing(one, two, size).filter(of_all));
        }
    }
    if crossings.is_empty() {
        crossings = group.iter().map(|end| end.x).collect();
    }
    Some(mean(&crossings))
}

/// The nearest place on a side of the body that a place nearly touches, with its distance [m].
fn side_beside(around: &Around<'_>, x: &Point) -> Option<(f64, Point)> {
    let reach = JOINED * around.lengths.smallest;
    let sides = around.sides_near(&[*x], reach);
    let feet = sides.filter_map(|edge| foot(x, &edge.map(|node| *around.at(node))));
    let nearest = feet.min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.filter(|foot| foot.0 <= reach)
}

fn is_near(end: &End, x: &Point, size: f64) -> bool {
    norm(&sub(x, &end.x)) <= FOLLOWED * size
}

/// Where the lines of two ends cross near both.
fn crossing(one: &End, two: &End, size: f64) -> Option<Point> {
    let turn = cross(&one.ahead, &two.ahead)[2];
    let t = cross(&sub(&two.x, &one.x), &two.ahead)[2] / turn;
    let x = add_scaled(&one.x, t, &one.ahead);
    (is_near(one, &x, size) && is_near(two, &x, size)).then_some(x)
}

/// Where an end that nearly touches a side of the body leaves it.
fn way_out(around: &Around<'_>, end: &End) -> Option<Point> {
    let size = around.lengths.smallest;
    let sides = around.sides_near(&[end.x], JOINED * size);
    let before = sides.filter_map(|edge| {
        let [p, q] = edge.map(|node| around.at(node));
        let close = segment_distance(&end.x, p, q) <= JOINED * size;
        let (t, _) = end.passes([p, q]).filter(|_| close)?;
        (t > 0.0).then_some(t)
    });
    let nearest = before.fold(f64::INFINITY, f64::min);
    (nearest <= FOLLOWED * size).then(|| add_scaled(&end.x, nearest, &end.ahead))
}

impl Net<'_> {
    /// Parts straight cracks at the feet of ends that stop beside them: what they carry is singular there, too. The nearest come
    /// first, then those near the middle of the body, however the cracks are ordered.
    pub fn part_at_feet(&mut self, cracks: &[Crack]) {
        let size = self.around.lengths.smallest;
        self.measure(cracks);
        // Both with functions, which is what the corner at the foot is for.
        let carries = |line: usize| cracks[line].tip != Tip::None;
        let straight = |line: usize| {
            carries(line) && matches!(cracks[line].geometry, Geometry::Curve(Curve::Chain(_)))
        };
        let points = |line: usize| -> Vec<Point> {
            self.lines[line]
                .links
                .iter()
                .map(|link| *self.at(link))
                .collect()
        };
        let polylines: Vec<Vec<Point>> = (0..self.lines.len()).map(points).collect();
        let boxes = Boxes::new(polylines.iter().map(|line| around(line, BESIDE * size)));
        let mut feet = Vec::new();
        for end in (0..polylines.len()).flat_map(|line| ends_of(line, &polylines[line])) {
            if !carries(end.line) || cells_at(self.around.mesh, &end.x).is_empty() {
                continue;
            }
            let near = boxes.meeting(&[end.x; 2]).into_iter();
            for line in near.filter(|&line| line != end.line && straight(line)) {
                let on =
                    polylines[line]
                        .windows(2)
                        .zip(&self.lines[line].links)
                        .map(|(w, from)| {
                            let foot = segment_foot(&end.x, &w[0], &w[1]);
                            (
                                norm(&sub(&end.x, &foot)),
                                from.s + norm(&sub(&foot, &w[0])),
                                foot,
                            )
                        });
                let nearest = on.min_by(|a, b| a.0.total_cmp(&b.0));
                if let Some((away, s, foot)) = nearest.filter(|foot| foot.0 <= BESIDE * size) {
                    let away = (away / size * 1e9).round() as i64;
                    let order = [away, self.around.lengths.from_middle(&end.x)];
                    feet.push((order, line, s, foot));
                }
            }
        }
        feet.sort_by_key(|foot| foot.0);
        for (_, line, s, x) in feet {
            let uses = self.uses();
            let links = &self.lines[line].links;
            // Within a cell one corner does.
            let taken = links.iter().any(|link| {
                let met = uses.get(link.vertex).is_none_or(|&uses| uses > 1) || link.foot;
                let by = if met { BESIDE } else { FOLLOWED };
                (link.given || met) && (link.s - s).abs() <= by * size
            });
            if let (false, Some(k)) = (
                taken,
                links.windows(2).position(|w| s > w[0].s && s < w[1].s),
            ) {
                let t = (s - links[k].s) / (links[k + 1].s - links[k].s);
                let vertex = self.vertices.len();
                self.vertices.push(self.around.vertex(&x));
                self.insert([((line, k), vec![(t, vertex)])].into());
                self.lines[line].links[k + 1].foot = true;
            }
        }
    }
}
