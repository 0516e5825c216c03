//! A chain of an arm that waits to divide a cell.

use crate::cut::trace::Chain;
use crate::geometry::clip::Side;
use crate::geometry::{Point, norm, sub};

/// A chain on its way into the cell.
pub(super) struct Pending {
    /// In order [m].
    pub vertices: Vec<Point>,
    /// Arm of every segment, and the side that lies to its left: 1, or −1 if the chain runs against its arm.
    pub arms: Vec<(usize, Side)>,
    /// Whether its last vertex is a free end.
    pub free: bool,
    /// Whether its first is one too.
    pub loose: bool,
}

impl Pending {
    pub fn new(chain: &Chain) -> Self {
        let vertices: Vec<Point> = chain.vertices.iter().map(|v| v.x).collect();
        let mut pending = Pending {
            arms: vec![(chain.arm, 1.0); vertices.len() - 1],
            vertices,
            free: false,
            loose: chain.tip == [true; 2],
        };
        if chain.tip[0] && !pending.loose {
            pending.reverse();
        }
        pending.free = chain.tip != [false; 2];
        pending
    }

    pub fn reverse(&mut self) {
        self.vertices.reverse();
        self.arms.reverse();
        for (_, side) in &mut self.arms {
            *side = -*side;
        }
    }

    pub fn first(&self) -> &Point {
        &self.vertices[0]
    }

    pub fn last(&self) -> &Point {
        &self.vertices[self.vertices.len() - 1]
    }

    pub fn length(&self) -> f64 {
        let segments = self.vertices.windows(2);
        segments.map(|w| norm(&sub(&w[1], &w[0]))).sum()
    }

    /// From vertex to vertex.
    pub fn piece(&self, from: usize, to: usize) -> Self {
        let mut piece = Pending {
            vertices: self.vertices[from..=to].to_vec(),
            arms: self.arms[from..to].to_vec(),
            free: self.free && to + 1 == self.vertices.len(),
            loose: self.loose && from == 0,
        };
        // Of two free ends one is left.
        if piece.loose && !piece.free {
            piece.reverse();
            (piece.loose, piece.free) = (false, true);
        }
        piece
    }
}
