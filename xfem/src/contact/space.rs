//! Contact spaces by name.

/// Contact space of a crack.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactSpace {
    /// One point pair per crossed mesh edge, point forces (the founding paper's).
    EdgePairs,
    /// One multiplier per crossed mesh edge, linear in between, integrated over the crack.
    Facet,
    /// One multiplier per star of crossed edges, integrated over the crack: stable.
    Star,
    /// One constant multiplier per cut cell.
    P0,
}

impl ContactSpace {
    /// All spaces.
    pub const ALL: [Self; 4] = [Self::EdgePairs, Self::Facet, Self::Star, Self::P0];

    /// The space of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|space| space.name() == name)
    }

    /// Name in case files and tables.
    pub fn name(self) -> &'static str {
        match self {
            ContactSpace::EdgePairs => "edge-pairs",
            ContactSpace::Facet => "facet",
            ContactSpace::Star => "star",
            ContactSpace::P0 => "p0",
        }
    }
}
