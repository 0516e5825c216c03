//! Who works when: children before their parents, or after them, on as many threads as there are.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::Scope;

use crate::algebra::multifrontal::tree::{AssemblyTree, NONE};

/// A subtree is one piece of work up to this part of the whole.
const GRAIN: f64 = 1.0 / 64.0;

impl AssemblyTree {
    /// Calls `visit` with every supernode, after its children.
    pub fn upwards(&self, threads: bool, visit: impl Fn(usize) + Sync) {
        let Some(pieces) = Pieces::new(self, threads) else {
            return (0..self.nodes.len()).for_each(visit);
        };
        let waiting: Vec<AtomicUsize> = pieces.waiting().map(AtomicUsize::new).collect();
        let climb = |start: usize| {
            let mut s = start;
            loop {
                (pieces.first[s]..=s).for_each(&visit);
                let parent = self.nodes[s].parent;
                // The last child goes on with the parent.
                if parent == NONE || waiting[parent].fetch_sub(1, Ordering::AcqRel) != 1 {
                    return;
                }
                s = parent;
            }
        };
        let leaves: Vec<usize> = pieces
            .waiting()
            .enumerate()
            .filter(|w| w.1 == 0)
            .map(|w| w.0)
            .collect();
        rayon::scope(|scope| {
            // Last in, first out.
            for &s in leaves.iter().rev().filter(|&&s| pieces.first[s] != NONE) {
                let climb = &climb;
                scope.spawn(move |_| climb(s));
            }
        });
    }

    /// Calls `visit` with every supernode, before its children.
    pub fn downwards(&self, threads: bool, visit: impl Fn(usize) + Sync) {
        let Some(pieces) = Pieces::new(self, threads) else {
            return (0..self.nodes.len()).rev().for_each(visit);
        };
        rayon::scope(|scope| {
            for s in (0..self.nodes.len()).filter(|&s| self.nodes[s].parent == NONE) {
                let (pieces, visit) = (&pieces, &visit);
                scope.spawn(move |scope| pieces.descend(scope, s, visit));
            }
        });
    }
}

/// Pieces of work: whole subtrees that are light, and the supernodes above them one by one.
struct Pieces<'a> {
    tree: &'a AssemblyTree,
    /// First supernode of the piece that ends with a supernode; [`NONE`] inside of pieces.
    first: Vec<usize>,
}

impl<'a> Pieces<'a> {
    /// `None` where one thread does it.
    fn new(tree: &'a AssemblyTree, threads: bool) -> Option<Self> {
        if !threads || rayon::current_num_threads() == 1 {
            return None;
        }
        let work = tree.work();
        let light = |s: usize| tree.nodes[s].work <= GRAIN * work;
        let first = (0..tree.nodes.len()).map(|s| match tree.nodes[s].parent {
            _ if !light(s) => s,
            parent if parent == NONE || !light(parent) => tree.nodes[s].first,
            _ => NONE,
        });
        Some(Self {
            tree,
            first: first.collect(),
        })
    }

    /// Whether the piece that ends with `s` is `s` alone, with pieces as children.
    fn alone(&self, s: usize) -> bool {
        self.first[s] == s
    }

    /// Pieces that each one comes after.
    fn waiting(&self) -> impl Iterator<Item = usize> {
        let children = |s: usize| self.tree.children[s].len();
        (0..self.first.len()).map(move |s| if self.alone(s) { children(s) } else { 0 })
    }

    fn descend<'s>(&'s self, scope: &Scope<'s>, start: usize, visit: &'s (impl Fn(usize) + Sync)) {
        let mut s = start;
        loop {
            (self.first[s]..=s).rev().for_each(visit);
            if !self.alone(s) {
                return;
            }
            let Some((&next, others)) = self.tree.children[s].split_last() else {
                return;
            };
            for &child in others {
                scope.spawn(move |scope| self.descend(scope, child, visit));
            }
            s = next;
        }
    }
}
