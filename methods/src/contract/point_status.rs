//! Open, stick or slip: what the contact law says of every point of a state.

use crate::algebra::rows::RowSet;
use crate::contract::free_jump::slip_from;
use crate::contract::law::tangential_norm;
use crate::contract::operator::DelassusForm;
use crate::contract::state::ContactState;
use crate::contract::system::Increment;
use crate::error::MethodError;

/// State of a contact point at the end of an increment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PointStatus {
    /// No contact force.
    Open,
    /// Closed, no slip in this increment.
    Stick,
    /// Closed and slipping in this increment.
    Slip,
}

impl PointStatus {
    /// Name in tables.
    pub fn as_str(self) -> &'static str {
        match self {
            PointStatus::Open => "open",
            PointStatus::Stick => "stick",
            PointStatus::Slip => "slip",
        }
    }
}

/// Status of every point, from the sign of the arguments of the projections:
/// ```text
/// open:  P_n − ρ g <= 0        slip:  |P_t − ρ d| > μ P_n        stick: otherwise
/// ```
/// Both comparisons allow for the rounding of a converged state, 1e-7 of the largest force: a point at the very limit
/// counts as sticking.
///
/// # Errors
/// Those of factorisation and condensation.
pub fn point_status(i: &Increment<'_>, s: &ContactState) -> Result<Vec<PointStatus>, MethodError> {
    /// Relative to the largest force: between the tolerance of tier high and anything a picture shows.
    const SLACK: f64 = 1e-7;
    let (system, dim) = (i.system, i.system.dim());
    let jump = i.jump(&s.u);
    if s.p.iter().all(|&p| p == 0.0) && jump.iter().step_by(dim).all(|&g| g >= 0.0) {
        return Ok(vec![PointStatus::Open; system.points()]);
    }
    let rho = system.operator(DelassusForm::Products)?.rho;
    let all = RowSet::all(dim, system.points());
    let d = slip_from(&all, dim, &jump, &i.start_jump());
    let largest = s.p.iter().fold(0.0f64, |m, p| m.max(p.abs()));
    let slack = SLACK * largest;
    Ok((0..system.points())
        .map(|point| {
            let (p, v) = (
                &s.p[dim * point..dim * (point + 1)],
                &d[dim * point..dim * (point + 1)],
            );
            let z: Vec<f64> = p.iter().zip(v).map(|(p, v)| p - rho * v).collect();
            if z[0] <= slack {
                PointStatus::Open
            } else if tangential_norm(&z) > system.friction()[point] * p[0] + slack {
                PointStatus::Slip
            } else {
                PointStatus::Stick
            }
        })
        .collect())
}
