//! Whether a single contact point can have several solutions.

use crate::contract::law::tangential_norm;
use crate::contract::operator::DelassusForm;
use crate::contract::system::ContactSystem;
use crate::error::MethodError;

/// ρ · min_i (W_nn − μ |W_nt|) over the diagonal blocks of the Delassus operator \[-\].
///
/// Where it is positive, every point alone, the others held, has exactly one solution for any load (Klarbring 1990;
/// Janovský 1981). Otherwise friction is large enough for several, and no method can be expected to find the one
/// another finds. The sign says nothing certain about all points together, and it depends on the pins of a floating body.
///
/// # Errors
/// Those of factorisation and condensation.
pub fn contact_wise_margin(system: &ContactSystem) -> Result<f64, MethodError> {
    let operator = system.operator(DelassusForm::Formed)?;
    let rows = system.row_set();
    let margin = |i: usize| {
        let own = rows.of(i);
        let block = operator.w.block(own.clone());
        let column = [block[0][0], block[1][0], block[2][0]];
        column[0] - system.friction()[i] * tangential_norm(&column[..own.len()])
    };
    let least = (0..rows.points()).map(margin).fold(f64::INFINITY, f64::min);
    Ok(operator.rho * least)
}
