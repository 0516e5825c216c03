//! Work with the elastic body that all runs on it share: how much, and how long it took.

/// How often the body was factored, solved with and condensed so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ElasticCounters {
    /// Sparse factorisations of K (0 or 1).
    pub factorisations: usize,
    /// Solves with the factor; refinement steps belong to the solve they refine.
    pub solves: usize,
    /// Products with a Delassus operator that is not formed, one solve each.
    pub products: usize,
    /// Condensations to the contact points (0 or 1): how often the Delassus operator was formed.
    pub condensations: usize,
}

/// Work and memory that it takes until W is formed, counted from the pattern of K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticCost {
    /// Multiplications and additions of the factorisation.
    pub factorisation: f64,
    /// The same of the condensation.
    pub condensation: f64,
    /// Numbers that the factor holds.
    pub entries: usize,
    /// Rows of W.
    pub rows: usize,
    /// Seconds that the count took: the analysis is done.
    pub analysis_s: f64,
}

/// Wall-clock times of work with K, in s; 0 for work not done. All but the last are shared by all runs on the body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElasticTimings {
    /// Elimination order and symbolic factorisation.
    pub analysis_s: f64,
    /// Scaling and numeric factorisation.
    pub factorisation_s: f64,
    /// Delassus operator.
    pub condensation_s: f64,
    /// Condensation of the traction operator, for the methods that need it.
    pub traction_s: f64,
    /// Work on all unknowns in all runs so far: from loads to the free jump, from contact forces back to displacements, and
    /// checks of equilibrium.
    pub on_body_s: f64,
}
