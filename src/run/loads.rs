//! A problem as a load path sees it: a contact system, and what acts on it increment by increment.

use stickslip_methods::{ContactSystem, Load};

use crate::model::loading::Loading;

/// The problem that methods are given: a contact system, and the load on it.
#[derive(Clone, Copy)]
pub struct Posed<'a> {
    /// The contact system, with its friction coefficients.
    pub system: &'a ContactSystem,
    /// The load on it.
    pub loads: Loads<'a>,
}

/// Loads on a system, increment by increment.
#[derive(Clone, Copy)]
pub enum Loads<'a> {
    /// A body along the path of its case.
    Body(&'a Loading<'a>),
    /// Bare algebra: nothing, then a load, in one increment.
    Algebra(&'a [Load; 2]),
}

impl<'a> Loads<'a> {
    /// Number of the first increment: 0 where something acts on a body at time 0, otherwise 1.
    pub fn first(&self) -> usize {
        self.body().map_or(1, Loading::first)
    }

    /// Number of the last increment.
    pub fn last(&self) -> usize {
        self.body().map_or(1, Loading::increments)
    }

    /// The load that the first increment begins from.
    pub fn before(&self) -> Load {
        match self {
            Self::Body(loading) => loading.before(loading.first()),
            Self::Algebra([rest, _]) => rest.clone(),
        }
    }

    /// The load at the end of an increment.
    pub fn at(&self, increment: usize) -> Load {
        match self {
            Self::Body(loading) => loading.at(increment),
            Self::Algebra([_, load]) => load.clone(),
        }
    }

    /// The body with what acts on it; none of bare algebra.
    pub fn body(&self) -> Option<&'a Loading<'a>> {
        match self {
            Self::Body(loading) => Some(loading),
            Self::Algebra(_) => None,
        }
    }
}
