//! Arms of cracks and their ways through the cells, from one mesh edge to the next.

use std::sync::Arc;

use crate::cut::crack::{Crack, End, Geometry, PathVertex, on_crack};
use crate::geometry::clip::crossing;
use crate::geometry::curve::{Curve, turned};
use crate::geometry::polygon::bends;
use crate::geometry::{Point, cross, dot, norm, sub, unit};

use super::ends::bend;
use super::snap::{Net, lies_on};
use super::{Arrangement, BEND, Line, On, Vertex};

/// A vertex of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChainVertex {
    /// Its number in the arrangement.
    pub vertex: usize,
    /// Position [m].
    pub x: Point,
}

/// An edge, lower node first, and the cell on side 2 of it.
pub type Along = ([u32; 2], usize);

/// The way of an arm through one cell, or along one edge between two places on it.
#[derive(Debug, Clone)]
pub struct Chain {
    /// Arm.
    pub arm: usize,
    /// Its vertices, in the direction of the arm.
    pub vertices: Vec<ChainVertex>,
    /// Unit directions of the segments between them: those of the crack.
    pub directions: Vec<Point>,
    /// Whether the first and the last vertex are free ends inside the cell, or between two nodes of the edge.
    pub tip: [bool; 2],
    /// First and last abscissa [m].
    pub range: [f64; 2],
    /// The edge it runs along; otherwise it runs through its cell.
    pub along: Option<Along>,
}

/// A free end inside the body.
#[derive(Debug, Clone)]
pub struct TracedTip {
    /// Arm.
    pub arm: usize,
    /// Which of its ends: 0 or 1.
    pub end: usize,
    /// Position [m].
    pub x: Point,
    /// Cells whose closure holds it.
    pub cells: Vec<usize>,
    /// Abscissa at which the arm parts the border of the tip's cells last; the tip's own where it crosses a mesh edge [m].
    pub entry: f64,
}

/// A place on the way of an arm.
#[derive(Debug, Clone, Copy)]
struct Stop {
    vertex: usize,
    s: f64,
    /// Unit direction of the crack from here on.
    direction: Point,
}

/// Where an arm runs between two stops.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Where {
    Cell(usize),
    Along([u32; 2]),
    Outside,
}

/// The arms of all lines, crack by crack, and their ways.
pub(super) fn arms(net: &mut Net<'_>, cracks: &[Crack], found: &mut Arrangement) -> Vec<Crack> {
    let uses = net.uses();
    let lines = std::mem::take(&mut net.lines);
    let mut arms: Vec<Crack> = Vec::new();
    for line in &lines {
        let mut crack = cracks[line.crack].clone();
        let places: Vec<Point> = line.links.iter().map(|link| *net.at(link)).collect();
        let slack = on_crack(net.around.lengths.smallest, net.around.lengths.rounding);
        // Where the line bends, as it is now; chords of an arc all do.
        let bent = match &mut crack.geometry {
            Geometry::Curve(curve @ Curve::Chain(_)) => {
                let bent = bends(&places, slack);
                let points: Vec<[f64; 2]> = (bent.iter())
                    .map(|&k| [places[k][0], places[k][1]])
                    .collect();
                *curve = Curve::chain(&points);
                bent
            }
            _ => (0..places.len()).collect(),
        };
        let nodes = line
            .links
            .iter()
            .filter_map(|link| match net.vertices[link.vertex].on {
                On::Node(node) => Some(node),
                _ => None,
            });
        crack.place(net.around.mesh, net.around.lengths, Some(nodes.collect()));
        // By link: where its straight segment begins, and its direction. Places come from there, whatever lies in between.
        let straight: Vec<[Point; 2]> = (bent.windows(2))
            .flat_map(|w| {
                let [from, to] = [places[w[0]], places[w[1]]];
                std::iter::repeat_n([from, unit(&sub(&to, &from))], w[1] - w[0])
            })
            .collect();
        let ends = parted(net, line, &places, &uses);
        for w in ends.windows(2) {
            let [(from, first), (to, last)] = [w[0], w[1]];
            let vertex = |k: usize| PathVertex {
                s: line.links[k].s,
                x: places[k],
            };
            let inner = bent.iter().copied().filter(|&k| k > from && k < to);
            let path = std::iter::once(from).chain(inner).chain([to]).map(vertex);
            let arm = Crack {
                range: [from, to].map(|k| line.links[k].s),
                ends: [first, last],
                path: path.collect(),
                near: Arc::clone(&crack.near),
                ..crack.clone()
            };
            let stops = stops(net, line, from..to, &straight);
            follow(net, arms.len(), &arm, &stops, found);
            arms.push(arm);
        }
    }
    let used = found
        .chains
        .values()
        .flatten()
        .flat_map(|chain| &chain.vertices);
    let mut used: Vec<usize> = used.map(|vertex| vertex.vertex).collect();
    used.sort_unstable();
    used.dedup();
    for vertex in used {
        if let On::Edge(edge) = net.vertices[vertex].on {
            found.on_edges.entry(edge).or_default().push(vertex);
        }
    }
    for (edge, own) in &mut found.on_edges {
        let away = |vertex: &usize| norm(&sub(&net.vertices[*vertex].x, net.around.at(edge[0])));
        own.sort_by(|a, b| away(a).total_cmp(&away(b)));
    }
    arms
}

/// Where a line is parted, and how its arms end there.
fn parted(net: &Net<'_>, line: &Line, places: &[Point], uses: &[usize]) -> Vec<(usize, End)> {
    let last = line.links.len() - 1;
    let closed = line.links[0].vertex == line.links[last].vertex;
    let end = |(k, link): (usize, &super::Link)| {
        let inner = k > 0 && k < last;
        if uses[link.vertex] > 1 || link.foot {
            Some((k, End::Meeting))
        } else if !inner && closed {
            Some((k, End::Bend))
        } else if !inner {
            let outer = net.around.is_outer(net.vertices[link.vertex].on);
            Some((k, if outer { End::Mouth } else { End::Free }))
        } else {
            (link.given && bend(&places[k - 1..=k + 1]) > BEND).then_some((k, End::Bend))
        }
    };
    line.links.iter().enumerate().filter_map(end).collect()
}

/// The way of a part of a line: its links, and where it crosses mesh edges in between.
fn stops(
    net: &mut Net<'_>,
    line: &Line,
    links: std::ops::Range<usize>,
    straight: &[[Point; 2]],
) -> Vec<Stop> {
    let mut stops = Vec::new();
    let end = links.end;
    for k in links {
        let [from, to] = [line.links[k], line.links[k + 1]];
        let [u, v] = [from, to].map(|link| net.vertices[link.vertex]);
        let [origin, direction] = straight[k];
        stops.push(Stop {
            vertex: from.vertex,
            s: from.s,
            direction,
        });
        let (normal, length) = (turned(&direction), norm(&sub(&v.x, &u.x)));
        let mut crossed: Vec<(f64, [u32; 2], Point)> = Vec::new();
        for edge in net.around.edges_near(&[u.x, v.x], 0.0) {
            if lies_on(u.on, edge) || lies_on(v.on, edge) {
                continue;
            }
            let [p, q] = edge.map(|node| net.around.at(node));
            let [f, g] = [p, q].map(|x| dot(&normal, &sub(x, &origin)));
            let beside = |x: &Point| cross(&sub(q, p), &sub(x, p))[2];
            if f * g < 0.0 && beside(&u.x) * beside(&v.x) < 0.0 {
                let x = crossing(p, f, q, g);
                crossed.push((dot(&direction, &sub(&x, &u.x)) / length, edge, x));
            }
        }
        crossed.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (t, edge, x) in crossed {
            stops.push(Stop {
                vertex: net.vertices.len(),
                s: from.s + t * (to.s - from.s),
                direction,
            });
            net.vertices.push(net.around.on_edge(edge, x));
        }
    }
    let last = line.links[end];
    stops.push(Stop {
        vertex: last.vertex,
        s: last.s,
        direction: [f64::NAN; 3],
    });
    stops
}

/// Adds the chains and tips of an arm.
fn follow(net: &Net<'_>, index: usize, arm: &Crack, stops: &[Stop], found: &mut Arrangement) {
    let place = |w: &[Stop]| between(net, [0, 1].map(|i| &net.vertices[w[i].vertex]));
    let places: Vec<Where> = stops.windows(2).map(place).collect();
    let in_cell = |k: usize| matches!(net.vertices[stops[k].vertex].on, On::Cell(_));
    let mut from = 0;
    while from < places.len() {
        // To the next place on the border of the cell.
        let mut to = from + 1;
        while to < places.len() && in_cell(to) {
            to += 1;
        }
        let host = match places[from] {
            Where::Cell(cell) => Some((cell, None)),
            Where::Along(edge) => beside(net, edge, &stops[from].direction),
            Where::Outside => None,
        };
        // Free ends within: a place on an edge along which the arm comes is one, too.
        let free = |k: usize, end: usize| {
            let within = in_cell(k)
                || matches!(
                    (places[from], net.vertices[stops[k].vertex].on),
                    (Where::Along(_), On::Edge(_))
                );
            let outermost = k == [0, stops.len() - 1][end];
            outermost && arm.ends[end] == End::Free && within
        };
        let tip = [free(from, 0), free(to, 1)];
        let range = [from, to].map(|k| stops[k].s);
        for end in (0..2).filter(|&end| {
            [from, to][end] == [0, stops.len() - 1][end] && arm.ends[end] == End::Free
        }) {
            let stop = &stops[[from, to][end]];
            let vertex = &net.vertices[stop.vertex];
            found.tips.push(TracedTip {
                arm: index,
                end,
                x: vertex.x,
                cells: net.around.cells(vertex.on),
                entry: match tip {
                    [true, true] => 0.5 * (range[0] + range[1]),
                    _ if tip[end] => range[1 - end],
                    _ => stop.s,
                },
            });
        }
        if let Some((cell, along)) = host {
            let vertices = stops[from..=to].iter().map(|stop| ChainVertex {
                vertex: stop.vertex,
                x: net.vertices[stop.vertex].x,
            });
            found.chains.entry(cell).or_default().push(Chain {
                arm: index,
                vertices: vertices.collect(),
                directions: stops[from..to].iter().map(|stop| stop.direction).collect(),
                tip,
                range,
                along,
            });
        }
        from = to;
    }
}

/// Where the segment between two vertices lies.
fn between(net: &Net<'_>, [u, v]: [&Vertex; 2]) -> Where {
    let edge = match (u.on, v.on) {
        (On::Node(i), On::Node(j)) => {
            Some([i.min(j), i.max(j)]).filter(|edge| net.around.has_edge(edge))
        }
        (On::Edge(edge), other) | (other, On::Edge(edge)) => {
            Some(edge).filter(|&edge| lies_on(other, edge))
        }
        _ => None,
    };
    if let Some(edge) = edge {
        return Where::Along(edge);
    }
    let others = net.around.cells(v.on);
    let own = net.around.cells(u.on).into_iter();
    let mut both = own.filter(|cell| others.contains(cell));
    both.next().map_or(Where::Outside, Where::Cell)
}

/// The cell on side 1 of an edge along which an arm runs in a direction, with the edge and the cell on side 2; `None` on the border of
/// the body: there it parts nothing.
fn beside(net: &Net<'_>, edge: [u32; 2], direction: &Point) -> Option<(usize, Option<Along>)> {
    let &[one, two] = net.around.cells_with(&edge).as_slice() else {
        return None;
    };
    let from = net.around.at(edge[0]);
    let is_left = dot(&turned(direction), &sub(&net.around.mesh.centre(one), from)) > 0.0;
    let [left, right] = if is_left { [one, two] } else { [two, one] };
    Some((left, Some((edge, right))))
}
