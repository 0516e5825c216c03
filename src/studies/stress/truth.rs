//! What is known of an answer.

use serde::{Deserialize, Serialize};

/// What the answer of a scene is held to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Truth {
    /// The closed form of uniform stress: all cracks stick.
    Uniform,
    /// The work done: strain energy and friction.
    Energy,
    /// The contact forces of another case, which has the same contact points.
    Case(String),
}
