//! Snapping: vertices onto the mesh and onto each other, segments through what lies beside them, until nothing moves.
//!
//! ```text
//!   1  vertices within δ of each other are one: on the node, else the edge, else at their mean;
//!      places are within `SAME_PLACE`, and the ends of a segment that two lines share up to `JOINED`
//!   2  a segment within δ/30 of a vertex or node runs through it
//!   3  where two segments cross, and where one leaves the body, there is a vertex
//!   4  crossings of one edge by several segments within δ/30 are one vertex on it
//! ```

use std::collections::BTreeMap;

use crate::cut::crack::{Crack, Geometry};
use crate::geometry::boxes::{Boxes, around};
use crate::geometry::curve::Curve;
use crate::geometry::polygon::{crossed, segment_foot};
use crate::geometry::{Point, add_scaled, mean, norm, root, sub, unite};

use super::around::Around;
use super::ends::{JOINED, bend};
use super::{ArrangementError, BEND, DELTA, LINE, Line, Link, Moved, On, Vertex};

/// Places where a crack meets others, bends or leaves the body, closer than this to each other, are one, in shortest edges: a modelling
/// length, for no piece between them can tell its rigid motion, and no arm its forces.
const SAME_PLACE: f64 = 1e-3;

/// Rounds of snapping; one or two suffice wherever tried.
const ROUNDS: usize = 12;

/// Lines over common vertices.
pub(super) struct Net<'a> {
    pub around: &'a Around<'a>,
    pub vertices: Vec<Vertex>,
    pub lines: Vec<Line>,
}

/// What is put between the ends of segments: by line and place of the link before, how far along and which vertex.
type Inserts = BTreeMap<(usize, usize), Vec<(f64, usize)>>;

impl<'a> Net<'a> {
    /// Lines through the points of cracks, arcs by their chords.
    pub fn new(around: &'a Around<'a>, cracks: &[Crack], polylines: &[Vec<Point>]) -> Self {
        let mut net = Net {
            around,
            vertices: Vec::new(),
            lines: Vec::new(),
        };
        for (crack, points) in polylines.iter().enumerate() {
            let given = matches!(cracks[crack].geometry, Geometry::Curve(Curve::Chain(_)));
            let closed = points.first() == points.last();
            let first = net.vertices.len();
            let mut links = Vec::new();
            for (k, x) in points.iter().enumerate() {
                let again = closed && k > 0 && k + 1 == points.len();
                if !again {
                    net.vertices.push(around.vertex(x));
                }
                let s = if given { 0.0 } else { cracks[crack].path[k].s };
                links.push(Link {
                    vertex: if again { first } else { first + k },
                    given: given || k == 0 || k + 1 == points.len(),
                    foot: false,
                    s,
                });
            }
            net.lines.push(Line { crack, links });
        }
        net
    }

    pub fn at(&self, link: &Link) -> &Point {
        &self.vertices[link.vertex].x
    }

    /// Repeats all rules until nothing moves.
    pub fn snap(&mut self) {
        for _ in 0..ROUNDS {
            let mut changed = self.merge();
            changed |= self.run_through();
            changed |= self.cross();
            changed |= self.leave();
            changed |= self.share_edges();
            if !changed {
                return;
            }
        }
    }

    /// Abscissas of chains from their lengths; those of arcs are those of their circles.
    pub fn measure(&mut self, cracks: &[Crack]) {
        for line in &mut self.lines {
            if let Geometry::Curve(Curve::Chain(_)) = cracks[line.crack].geometry {
                let mut s = 0.0;
                let mut before: Option<Point> = None;
                for link in &mut line.links {
                    let x = self.vertices[link.vertex].x;
                    s += before.map_or(0.0, |before| norm(&sub(&x, &before)));
                    link.s = s;
                    before = Some(x);
                }
            }
        }
    }

    /// How often lines use each vertex, a closed one its seam once.
    pub fn uses(&self) -> Vec<usize> {
        let mut uses = vec![0; self.vertices.len()];
        for line in &self.lines {
            let closed = line.links.len() > 1
                && line.links[0].vertex == line.links[line.links.len() - 1].vertex;
            for link in &line.links[usize::from(closed)..] {
                uses[link.vertex] += 1;
            }
        }
        uses
    }

    /// The lines through every vertex.
    fn lines_of(&self) -> Vec<Vec<usize>> {
        let mut lines = vec![Vec::new(); self.vertices.len()];
        for (l, line) in self.lines.iter().enumerate() {
            line.links
                .iter()
                .for_each(|link| lines[link.vertex].push(l));
        }
        lines
    }

    /// Which vertices are places where lines meet, bend or leave the body; `uses`: how often lines use each.
    fn noted(&self, uses: &[usize]) -> Vec<bool> {
        let outer = |(v, &uses): (&Vertex, &usize)| uses > 1 || self.around.is_outer(v.on);
        let mut noted: Vec<bool> = self.vertices.iter().zip(uses).map(outer).collect();
        for line in &self.lines {
            for w in line.links.windows(3).filter(|w| w[1].given) {
                let places = [0, 1, 2].map(|i| *self.at(&w[i]));
                noted[w[1].vertex] |= bend(&places) > BEND;
            }
        }
        noted
    }

    /// Makes vertices one that are close to each other; whether there were any.
    fn merge(&mut self) -> bool {
        let count = self.vertices.len();
        let uses = self.uses();
        let (noted, lines) = (self.noted(&uses), self.lines_of());
        // Mouths of two lines that run beside each other stay apart.
        let one_place = |i: usize, j: usize| {
            let both = noted[i] && noted[j];
            both && (uses[i].min(uses[j]) > 1 || lines[i].iter().any(|l| lines[j].contains(l)))
        };
        let reach = SAME_PLACE * self.vertices.iter().map(|v| v.size).fold(0.0, f64::max);
        let mut changed = false;
        let boxes = Boxes::new(self.vertices.iter().map(|v| [v.x; 2]));
        let mut parent: Vec<usize> = (0..count).collect();
        for (_, [i, j]) in self.shared() {
            let [a, b] = [i, j].map(|i| &self.vertices[i]);
            if norm(&sub(&a.x, &b.x)) <= JOINED * a.size.min(b.size) {
                unite(&mut parent, i, j);
                changed = true;
            }
        }
        for (i, a) in self.vertices.iter().enumerate().filter(|v| uses[v.0] > 0) {
            for j in boxes.meeting(&around(
                [&a.x],
                if noted[i] { reach } else { self.around.reach },
            )) {
                let b = &self.vertices[j];
                let by = if one_place(i, j) { SAME_PLACE } else { DELTA };
                if j < i && uses[j] > 0 && norm(&sub(&a.x, &b.x)) <= by * a.size.min(b.size) {
                    unite(&mut parent, i, j);
                    changed = true;
                }
            }
        }
        if !changed {
            return false;
        }
        let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for i in 0..count {
            groups.entry(root(&mut parent, i)).or_default().push(i);
        }
        let mut number = vec![0; count];
        let mut vertices = Vec::with_capacity(groups.len());
        for own in groups.into_values() {
            own.iter().for_each(|&i| number[i] = vertices.len());
            vertices.push(self.one_of(&own));
        }
        self.vertices = vertices;
        for line in &mut self.lines {
            line.links
                .iter_mut()
                .for_each(|link| link.vertex = number[link.vertex]);
            tidy(&mut line.links);
        }
        true
    }

    /// The vertex that some become.
    fn one_of(&self, own: &[usize]) -> Vertex {
        let vertices = || own.iter().map(|&i| &self.vertices[i]);
        if let &[only] = own {
            return self.vertices[only];
        }
        if let Some(on_node) = vertices().find(|v| matches!(v.on, On::Node(_))) {
            return *on_node;
        }
        let mut edges: Vec<[u32; 2]> = vertices()
            .filter_map(|v| {
                if let On::Edge(edge) = v.on {
                    Some(edge)
                } else {
                    None
                }
            })
            .collect();
        edges.sort_unstable();
        edges.dedup();
        match edges[..] {
            [] => {
                let places: Vec<Point> = vertices().map(|v| v.x).collect();
                self.around.vertex(&mean(&places))
            }
            [edge] => {
                let on = vertices().filter(|v| v.on == On::Edge(edge));
                let places: Vec<Point> = on.map(|v| v.x).collect();
                let x = mean(&places);
                // Equal ones stay to the last bit.
                let x = if places.iter().all(|p| *p == places[0]) {
                    places[0]
                } else {
                    x
                };
                self.around.on_edge(edge, x)
            }
            // Beside the node that they share.
            [one, two, ..] => match one.into_iter().find(|node| two.contains(node)) {
                Some(node) => self.around.node(node),
                None => *vertices().next().unwrap_or(&self.vertices[own[0]]),
            },
        }
    }

    /// All segments: line, place of the first link, ends.
    fn segments(&self) -> Vec<(usize, usize, [usize; 2])> {
        let lines = self.lines.iter().enumerate();
        let of = |(l, line): (usize, &Line)| {
            let own = line.links.windows(2).enumerate();
            let own = own.map(move |(k, w)| (l, k, [w[0].vertex, w[1].vertex]));
            own.collect::<Vec<_>>()
        };
        lines.flat_map(of).collect()
    }

    /// Segments between the same ends as one before: the lines of both, and the ends.
    fn shared(&self) -> impl Iterator<Item = ([usize; 2], [usize; 2])> {
        let mut known = BTreeMap::new();
        let segments = self.segments().into_iter();
        segments.filter_map(move |(l, _, [i, j])| {
            let before = known.insert([i.min(j), i.max(j)], l);
            before.map(|k| ([k, l], [i, j]))
        })
    }

    /// Leads segments through vertices and nodes beside them; whether there were any.
    fn run_through(&mut self) -> bool {
        let uses = self.uses();
        let boxes = Boxes::new(self.vertices.iter().map(|v| [v.x; 2]));
        let mut on_node: BTreeMap<u32, usize> = BTreeMap::new();
        for (i, vertex) in self.vertices.iter().enumerate() {
            if let On::Node(node) = vertex.on {
                on_node.insert(node, i);
            }
        }
        let mut inserts = Inserts::new();
        for (l, k, own) in self.segments() {
            let [p, q] = own.map(|i| self.vertices[i].x);
            let mut put = |t: f64, vertex: usize| {
                if !own.contains(&vertex) {
                    inserts.entry((l, k)).or_default().push((t, vertex));
                }
            };
            for i in boxes.meeting(&around(&[p, q], self.around.reach)) {
                let vertex = &self.vertices[i];
                if uses[i] > 0 && !matches!(vertex.on, On::Node(_)) {
                    Around::runs_through([&p, &q], &vertex.x, vertex.size)
                        .into_iter()
                        .for_each(|t| put(t, i));
                }
            }
            for node in self
                .around
                .nodes_near(&[p, q], self.around.reach)
                .collect::<Vec<_>>()
            {
                let (x, size) = (self.around.at(node), self.around.size(node));
                if let Some(t) = Around::runs_through([&p, &q], x, size) {
                    let known = *on_node.entry(node).or_insert_with(|| {
                        self.vertices.push(self.around.node(node));
                        self.vertices.len() - 1
                    });
                    put(t, known);
                }
            }
        }
        self.insert(inserts)
    }

    /// Adds vertices where segments cross; whether there were any.
    fn cross(&mut self) -> bool {
        let segments = self.segments();
        let ends = |own: [usize; 2]| own.map(|i| self.vertices[i].x);
        let boxes = Boxes::new(segments.iter().map(|s| around(&ends(s.2), 0.0)));
        let mut found = Vec::new();
        for (i, &(l, k, own)) in segments.iter().enumerate() {
            let [p, q] = ends(own);
            for j in boxes
                .meeting(&around(&[p, q], 0.0))
                .into_iter()
                .take_while(|&j| j < i)
            {
                let (other_line, other_link, other) = segments[j];
                if own.iter().any(|v| other.contains(v)) {
                    continue;
                }
                let [a, b] = ends(other);
                if let Some((t, x)) = crossed([&p, &q], [&a, &b], 0.0) {
                    let s = norm(&sub(&x, &a)) / norm(&sub(&b, &a));
                    found.push(((l, k, t), (other_line, other_link, s), x));
                }
            }
        }
        let mut inserts = Inserts::new();
        for ((l, k, t), (m, n, s), x) in found {
            let vertex = self.vertices.len();
            self.vertices.push(self.around.vertex(&x));
            inserts.entry((l, k)).or_default().push((t, vertex));
            inserts.entry((m, n)).or_default().push((s, vertex));
        }
        self.insert(inserts)
    }

    /// Adds vertices where segments leave the body; whether there were any.
    fn leave(&mut self) -> bool {
        let mut inserts = Inserts::new();
        for (l, k, own) in self.segments() {
            let [u, v] = own.map(|i| self.vertices[i]);
            for edge in self.around.sides_near(&[u.x, v.x], 0.0) {
                if lies_on(u.on, edge) || lies_on(v.on, edge) {
                    continue;
                }
                let [a, b] = edge.map(|node| self.around.at(node));
                if let Some((t, x)) = crossed([&u.x, &v.x], [a, b], 0.0) {
                    let vertex = self.vertices.len();
                    self.vertices.push(self.around.vertex(&x));
                    inserts.entry((l, k)).or_default().push((t, vertex));
                }
            }
        }
        self.insert(inserts)
    }

    /// Makes crossings of one edge by several lines one vertex where they are that close; whether there were any.
    fn share_edges(&mut self) -> bool {
        // By edge: how far along, line, link, how far along that.
        type Place = (f64, usize, usize, f64);
        let mut on: BTreeMap<[u32; 2], Vec<Place>> = BTreeMap::new();
        for (l, k, own) in self.segments() {
            let [u, v] = own.map(|i| self.vertices[i]);
            for edge in self.around.edges_near(&[u.x, v.x], 0.0) {
                if lies_on(u.on, edge) || lies_on(v.on, edge) {
                    continue;
                }
                let [a, b] = edge.map(|node| self.around.at(node));
                if let Some((s, _)) = crossed([a, b], [&u.x, &v.x], 0.0) {
                    let x = add_scaled(a, s, &sub(b, a));
                    let t = norm(&sub(&x, &u.x)) / norm(&sub(&v.x, &u.x));
                    on.entry(edge).or_default().push((s, l, k, t));
                }
            }
        }
        let mut inserts = Inserts::new();
        for (edge, mut places) in on.into_iter().filter(|(_, places)| places.len() > 1) {
            places.sort_by(|a, b| a.0.total_cmp(&b.0));
            let [a, b] = edge.map(|node| self.around.at(node));
            let d = sub(b, a);
            let same = LINE * DELTA * self.around.on_edge(edge, *a).size / norm(&d);
            for group in places
                .chunk_by(|a, b| b.0 - a.0 <= same)
                .filter(|g| g.len() > 1)
            {
                let share = group.iter().map(|place| place.0).sum::<f64>() / group.len() as f64;
                let vertex = self.vertices.len();
                self.vertices
                    .push(self.around.on_edge(edge, add_scaled(a, share, &d)));
                for &(_, l, k, t) in group {
                    inserts.entry((l, k)).or_default().push((t, vertex));
                }
            }
        }
        self.insert(inserts)
    }

    /// Puts vertices between the ends of segments; whether there are any.
    pub fn insert(&mut self, inserts: Inserts) -> bool {
        let changed = !inserts.is_empty();
        // From the last link on: the places of the others stay.
        for ((l, k), mut places) in inserts.into_iter().rev() {
            places.sort_by(|a, b| a.0.total_cmp(&b.0));
            let links = &mut self.lines[l].links;
            let [from, to] = [links[k].s, links[k + 1].s];
            let link = |(t, vertex): (f64, usize)| Link {
                vertex,
                given: false,
                foot: false,
                s: from + t * (to - from),
            };
            links.splice(k + 1..k + 1, places.into_iter().map(link));
            tidy(links);
        }
        changed
    }

    /// Refuses lines that are points, and two that share a segment.
    pub fn check(&self, cracks: &[Crack]) -> Result<(), ArrangementError> {
        if let Some(line) = self.lines.iter().find(|line| line.links.len() < 2) {
            let at = line
                .links
                .first()
                .map_or([f64::NAN; 3], |link| *self.at(link));
            let crack = cracks[line.crack].number;
            return Err(ArrangementError::Point { crack, at });
        }
        let overlap = |(lines, ends): ([usize; 2], [usize; 2])| ArrangementError::Overlap {
            cracks: lines.map(|l| cracks[self.lines[l].crack].number),
            at: mean(&ends.map(|i| self.vertices[i].x)),
        };
        self.shared().next().map_or(Ok(()), |own| Err(overlap(own)))
    }

    /// The place of every crack that was moved farthest, where that is more than rounding. `put`: their points [m].
    pub fn moved(&self, cracks: &[Crack], put: &[Vec<Point>]) -> Vec<Moved> {
        let size = self.around.lengths.smallest;
        let least = self.around.lengths.rounding;
        let farthest = |line: (&Line, &Vec<Point>)| {
            let (line, put) = line;
            let now: Vec<Point> = line.links.iter().map(|link| *self.at(link)).collect();
            let there = away(put, &now, SAME_PLACE * size).into_iter();
            let back = away(&now, put, SAME_PLACE * size).into_iter();
            let all = there.chain(back.map(|(by, to, from)| (by, from, to)));
            let (by, from, to) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
            (by > least).then_some(Moved {
                crack: cracks[line.crack].number,
                from,
                to,
                joined: false,
            })
        };
        self.lines.iter().zip(put).filter_map(farthest).collect()
    }
}

/// How far points lie from a polyline that is at most `reach` away, with its nearest point [m].
fn away(points: &[Point], polyline: &[Point], reach: f64) -> Vec<(f64, Point, Point)> {
    let boxes = Boxes::new(polyline.windows(2).map(|w| around(w, reach)));
    let nearest = |x: &Point| {
        let near = boxes.meeting(&[*x; 2]).into_iter();
        let feet = near.map(|k| segment_foot(x, &polyline[k], &polyline[k + 1]));
        let found = feet.map(|foot| (norm(&sub(&foot, x)), *x, foot));
        found.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    points.iter().filter_map(nearest).collect()
}

/// Whether a vertex lies on an edge or one of its nodes.
pub(super) fn lies_on(on: On, edge: [u32; 2]) -> bool {
    match on {
        On::Node(node) => edge.contains(&node),
        On::Edge(own) => own == edge,
        On::Cell(_) | On::Outside => false,
    }
}

/// Takes out links that repeat a vertex, and spikes: there and back.
fn tidy(links: &mut Vec<Link>) {
    loop {
        links.dedup_by(|b, a| {
            let same = a.vertex == b.vertex;
            a.given |= same && b.given;
            a.foot |= same && b.foot;
            same
        });
        let spike = links.windows(3).position(|w| w[0].vertex == w[2].vertex);
        let Some(k) = spike else {
            return;
        };
        links.remove(k + 1);
    }
}
