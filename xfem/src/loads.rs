//! Loads on a body: supports and loads on parts of its border and in its cells, closed forms.
//!
//! Where something acts is a [`Region`](border::Region) of the border or all cells; supports become prescribed unknowns, force
//! densities consistent nodal forces.

pub mod border;
pub mod exact_values;
pub mod nodal_forces;
pub mod sides;
pub mod supports;
