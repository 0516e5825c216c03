//! Pictures of bodies: displacement and contact status of plane ones, contact status of solids.

use super::kind::Kind;
use super::runs::moment;
use crate::report::names::stem;
use crate::report::plot::{contact_status, displacement, plain};
use crate::report::{Bundle, ReportError};
use crate::studies::rows::RunFields;

/// Deformation and contact.
pub static KIND: Kind = Kind {
    file: "*.state.svg",
    question: "How does the body deform, and where is its crack open, where does it stick or slip?",
    shows: "The last increment and those chosen. A plane body: bands of u_x and u_y on the deformed shape, boundary and crack faces black, the \
            undeformed ones grey, the undeformed crack tinted by status. A solid: status on the crack by tint and marker, \
            arrows for the slip of side 1 against side 2, or for the tangential traction where nothing slips, on the deformed \
            body behind the crack.",
};

/// The pictures of one run.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, fields: &RunFields<'_>) -> Result<(), ReportError> {
    let Some(step) = fields.steps.last() else {
        return Ok(());
    };
    let (key, stem) = (&fields.key, stem(&fields.key));
    let run = format!("{}, {}", moment(key), plain(&key.method));
    match step.body.dim {
        2 => KIND.add(bundle, &stem, Some(displacement(step, &run)?)),
        3 if !step.crack.cells.is_empty() => {
            KIND.add(bundle, &stem, Some(contact_status(step, &run)?))
        }
        _ => Ok(()),
    }
}
