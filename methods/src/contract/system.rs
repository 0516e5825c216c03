//! The contact system: an elastic body with a friction coefficient per point, and one increment of load on it.

use std::sync::{Arc, OnceLock};

use crate::algebra::rows::RowSet;
use crate::contract::elastic::Elastic;
use crate::contract::operator::{ContactOperator, DelassusForm};
use crate::contract::products::Products;
use crate::contract::state::ContactState;
use crate::error::{MethodError, check_finite, check_len};

/// An elastic body with friction. Cheap to make: factor and Delassus operator belong to the [`Elastic`] and serve
/// every friction value, method and increment.
pub struct ContactSystem {
    elastic: Arc<Elastic>,
    friction: Vec<f64>,
    rows: RowSet,
    formed: OnceLock<Result<Arc<ContactOperator>, MethodError>>,
    products: OnceLock<Result<Arc<ContactOperator>, MethodError>>,
}

impl std::fmt::Debug for ContactSystem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ContactSystem")
            .field("elastic", &self.elastic)
            .field("friction", &self.friction)
            .finish_non_exhaustive()
    }
}

impl ContactSystem {
    /// Sets the friction coefficient of each point.
    ///
    /// # Errors
    /// Wrong length; negative, NaN or infinite coefficients; friction on a body set up without.
    pub fn new(elastic: Arc<Elastic>, friction: Vec<f64>) -> Result<Self, MethodError> {
        check_len("friction", friction.len(), elastic.points())?;
        for (index, &value) in friction.iter().enumerate() {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(MethodError::range(
                    "friction",
                    index,
                    value,
                    "not negative, finite",
                ));
            }
            if value > 0.0 && elastic.frictionless(index) {
                return Err(MethodError::FrictionlessBody {
                    point: index,
                    friction: value,
                });
            }
        }
        let dim = elastic.dim();
        let components: Vec<usize> = friction
            .iter()
            .map(|&mu| if mu > 0.0 { dim } else { 1 })
            .collect();
        let rows = RowSet::new(dim, &components);
        Ok(Self {
            elastic,
            friction,
            rows,
            formed: OnceLock::new(),
            products: OnceLock::new(),
        })
    }

    /// The elastic body.
    pub fn elastic(&self) -> &Arc<Elastic> {
        &self.elastic
    }

    /// Space dimension.
    pub fn dim(&self) -> usize {
        self.elastic.dim()
    }

    /// Number of contact points.
    pub fn points(&self) -> usize {
        self.elastic.points()
    }

    /// Contact force components per point that can be non-zero: 1 if all friction is 0, else the dimension.
    pub fn components(&self) -> usize {
        if self.friction.iter().all(|&mu| mu == 0.0) {
            1
        } else {
            self.dim()
        }
    }

    /// Number of contact rows: `points · components`, less the tangential rows of single points without friction.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Friction coefficient μ per point.
    pub fn friction(&self) -> &[f64] {
        &self.friction
    }

    /// Tributary area (2D: length) per point.
    pub fn weight(&self) -> &[f64] {
        self.elastic.weight()
    }

    /// Which rows of the jump operator are in use.
    pub fn row_set(&self) -> &RowSet {
        &self.rows
    }

    /// Forms the Delassus operator of the rows in use unless that is done. Solving an increment does it when a load
    /// closes the contact and the method asks for it; a timed run may want it before.
    ///
    /// # Errors
    /// Too many rows; the errors of the factorisation.
    pub fn condense(&self) -> Result<(), MethodError> {
        self.operator(DelassusForm::Formed).map(|_| ())
    }

    /// W, Q and ρ on the rows in use. A formed W is shared with the body where those are all rows, a copy of the block
    /// elsewhere.
    ///
    /// # Errors
    /// Those of the factorisation; too many rows to form W.
    pub fn operator(&self, form: DelassusForm) -> Result<Arc<ContactOperator>, MethodError> {
        let products = || {
            let w = Arc::new(Products::new(self.elastic.clone(), self.rows.clone())?);
            self.elastic.operator(&self.rows, w).map(Arc::new)
        };
        let formed = || {
            let (whole, from) = (self.elastic.formed()?, self.elastic.rows());
            if from == self.rows {
                return self.elastic.condensed();
            }
            let w = whole.select(&self.rows.positions_in(&from))?;
            self.elastic.operator(&self.rows, w).map(Arc::new)
        };
        match form {
            DelassusForm::Formed => self.formed.get_or_init(formed).clone(),
            DelassusForm::Products => self.products.get_or_init(products).clone(),
        }
    }
}

impl ContactState {
    /// The unloaded state of a system.
    pub fn zero(system: &ContactSystem) -> Self {
        Self {
            u: vec![0.0; system.elastic().unknowns()],
            p: vec![0.0; system.dim() * system.points()],
        }
    }
}

/// Load at the end of an increment.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Force vector f, n entries, prescribed displacements included. In N, in 2D N/m.
    pub force: Vec<f64>,
    /// Jump carried by prescribed unknowns and initial gaps, `dim` per point, in m: `[[u]] = B u + offset`.
    pub offset: Vec<f64>,
    /// Contact force that the stress of prescribed displacements implies, `dim` per point, in N (2D: N/m), to be added
    /// to S u; empty if the body has no traction operator.
    pub traction: Vec<f64>,
}

impl Load {
    /// Nothing acts.
    pub fn zero(elastic: &Elastic) -> Self {
        let rows = elastic.jump().rows();
        Self {
            force: vec![0.0; elastic.unknowns()],
            offset: vec![0.0; rows],
            traction: vec![0.0; elastic.traction().map_or(0, |s| s.rows())],
        }
    }
}

/// One increment: from a start state to equilibrium under a new load.
pub struct Increment<'a> {
    /// Body and friction.
    pub system: &'a ContactSystem,
    /// Load at the end.
    pub load: &'a Load,
    /// Load the start state belongs to.
    pub start_load: &'a Load,
    /// State at the start; slip is measured from its jump.
    pub start: &'a ContactState,
    /// Contact forces that methods begin to iterate from, `dim` per point: none stands for those of the start. A guess, and
    /// no part of the problem: laws that remember forces take them from the start.
    pub guess: Option<&'a [f64]>,
    /// Number of the increment, from 0.
    pub index: usize,
    /// Natural map the method must reach.
    pub tolerance: f64,
}

impl Increment<'_> {
    /// `[[u]] = B u + offset` at the end of the increment, `dim` per point, in m.
    pub fn jump(&self, u: &[f64]) -> Vec<f64> {
        jump(self.system, self.load, u)
    }

    /// `[[u]]` at the start of the increment, `dim` per point, in m.
    pub fn start_jump(&self) -> Vec<f64> {
        jump(self.system, self.start_load, &self.start.u)
    }

    /// Contact forces that methods begin to iterate from, `dim` per point.
    pub fn guess(&self) -> &[f64] {
        self.guess.unwrap_or(&self.start.p)
    }

    /// Whether nothing acts at the end of the increment.
    pub(crate) fn unloaded(&self) -> bool {
        let zero = |x: &[f64]| x.iter().all(|&x| x == 0.0);
        zero(&self.load.force) && zero(&self.load.offset)
    }

    /// Refuses arrays of the wrong length and non-finite numbers.
    pub(crate) fn check(&self) -> Result<(), MethodError> {
        let n = self.system.elastic().unknowns();
        let m = self.system.dim() * self.system.points();
        let check = |what, values: &[f64], len| {
            check_len(what, values.len(), len)?;
            check_finite(what, values)
        };
        check("load force", &self.load.force, n)?;
        check("load offset", &self.load.offset, m)?;
        let with_traction = self.system.elastic().traction().map_or(0, |s| s.rows());
        check("load traction", &self.load.traction, with_traction)?;
        check("start load force", &self.start_load.force, n)?;
        check("start load offset", &self.start_load.offset, m)?;
        check("start displacements", &self.start.u, n)?;
        check("start contact forces", &self.start.p, m)?;
        check("guessed contact forces", self.guess(), m)?;
        if self.tolerance > 0.0 && self.tolerance.is_finite() {
            Ok(())
        } else {
            Err(MethodError::range(
                "tolerance",
                0,
                self.tolerance,
                "positive and finite",
            ))
        }
    }
}

fn jump(system: &ContactSystem, load: &Load, u: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; load.offset.len()];
    system.elastic().jump().mul(u, &mut out);
    for (x, offset) in out.iter_mut().zip(&load.offset) {
        *x += offset;
    }
    out
}
