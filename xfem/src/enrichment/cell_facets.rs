//! Edges and facets of a cell, divided among its regions.

use crate::cut::crack::Crack;
use crate::cut::part::{FaceCorner, Part, Region};
use crate::cut::partition::Partition;
use crate::geometry::clip::Side;
use crate::geometry::polygon::{border_distance, contains};
use crate::geometry::{Point, add_scaled, dot, sub};
use crate::mesh::Mesh;

use super::Enrichment;

/// A piece of an edge (two points) or facet (a polygon), and the region of the cell it bounds.
pub type Piece = (Vec<Point>, Region);

/// Pieces of the edge or facet between some local nodes of a cell, in their order.
pub fn pieces(
    mesh: &Mesh,
    cracks: &[Crack],
    enrichment: &Enrichment,
    cell: usize,
    local: &[usize],
) -> Vec<Piece> {
    let map = mesh.map(cell);
    let vertices: Vec<Point> = local.iter().map(|&i| map[i]).collect();
    let Some(partition) = enrichment.partition(cell) else {
        return vec![(vertices, 0)];
    };
    if let &[i, j] = local {
        return match mesh.dim() {
            2 => border_pieces(partition, [i, j], map.len()),
            _ => edge_pieces(cracks, partition, &vertices, [i, j]),
        };
    }
    let whole: Vec<FaceCorner> = vertices.into_iter().map(|x| (x, None)).collect();
    let pieces = (0..partition.parts.len()).map(|region| {
        let polygon = partition.clipped(cracks, region, whole.clone());
        (polygon.into_iter().map(|corner| corner.0).collect(), region)
    });
    pieces
        .filter(|(polygon, _): &Piece| polygon.len() > 2)
        .collect()
}

/// Whether a part of a cell is beside a crack along a face.
pub fn parted(cracks: &[Crack], part: &Part, face: &[Point]) -> bool {
    let along = |crack: &Crack| face.iter().all(|x| crack.level(x) == 0.0);
    part.sides.iter().any(|side| along(&cracks[side.0]))
}

/// An edge of a 2D cell, cut where arms end on it or cross it.
fn border_pieces(partition: &Partition, [i, j]: [usize; 2], count: usize) -> Vec<Piece> {
    if (i + 1) % count == j {
        let pieces = partition.along(i);
        return pieces
            .map(|piece| (piece.ends.to_vec(), piece.region))
            .collect();
    }
    let pieces = partition.along(j).rev();
    let turned = pieces.map(|piece| (vec![piece.ends[1], piece.ends[0]], piece.region));
    turned.collect()
}

/// An edge of a 3D cell cut where the cracks cross it.
fn edge_pieces(
    cracks: &[Crack],
    partition: &Partition,
    ends: &[Point],
    nodes: [usize; 2],
) -> Vec<Piece> {
    let d = sub(&ends[1], &ends[0]);
    let along = |x: &Point| dot(&sub(x, &ends[0]), &d) / dot(&d, &d);
    let on_edge = |on: &Option<[usize; 2]>| {
        on.is_some_and(|[i, j]| i != j && (nodes == [i, j] || nodes == [j, i]))
    };
    let mut cuts: Vec<Point> = partition
        .faces
        .iter()
        .flat_map(|face| &face.corners)
        .filter(|(_, on)| on_edge(on))
        .map(|(x, _)| *x)
        .collect();
    cuts.sort_by(|a, b| along(a).total_cmp(&along(b)));
    cuts.dedup();
    let mut points = vec![ends[0]];
    points.extend(cuts);
    points.push(ends[1]);
    points
        .windows(2)
        .map(|w| {
            let middle = add_scaled(&w[0], 0.5, &sub(&w[1], &w[0]));
            (w.to_vec(), region_at(cracks, partition, &middle))
        })
        .collect()
}

/// The region that a point of a cell lies in, or most nearly.
pub fn region_at(cracks: &[Crack], partition: &Partition, x: &Point) -> Region {
    let flat = partition
        .parts
        .iter()
        .enumerate()
        .filter(|(_, part)| !part.polygon.is_empty());
    let nearest = flat.min_by(|(_, a), (_, b)| {
        let away = |part: &Part| {
            if contains(&part.polygon, x) {
                -border_distance(&part.polygon, x)
            } else {
                border_distance(&part.polygon, x)
            }
        };
        away(a).total_cmp(&away(b))
    });
    if let Some((region, _)) = nearest {
        return region;
    }
    let depth = |part: &Part| {
        let inside = |&(crack, side): &(usize, Side)| side * cracks[crack].distance(x);
        part.sides.iter().map(inside).fold(f64::INFINITY, f64::min)
    };
    let regions = 0..partition.parts.len();
    regions
        .rev()
        .max_by(|&a, &b| depth(&partition.parts[a]).total_cmp(&depth(&partition.parts[b])))
        .unwrap_or(0)
}
