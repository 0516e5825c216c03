//! Pictures of bodies: the displacement of plane ones, the contact status on the crack of solids.

use super::kind::Kind;
use super::runs::problem;
use crate::report::names::stem;
use crate::report::plot::{contact_status, displacement, plain};
use crate::report::{Bundle, ReportError};
use crate::studies::rows::RunFields;

/// Displacement of plane bodies.
pub static DISPLACEMENT: Kind = Kind {
    file: "*.displacement.svg",
    question: "How does the plane body deform?",
    shows: "Displacement u_x and u_y of a plane body in the last increment as bands on the deformed shape; boundary \
            and crack faces are black, the undeformed ones grey.",
};

/// Contact status of solids.
pub static CONTACT: Kind = Kind {
    file: "*.contact.svg",
    question: "Where is the crack inside the solid open, where does it stick, where and how does it slip?",
    shows: "Status on the crack of a solid in the last increment by tint and marker, arrows for the slip of side 1 \
            against side 2, or for the tangential traction where nothing slips, on the deformed body behind the crack.",
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
    let run = format!("{}, {}", problem(key), plain(&key.method));
    match step.body.dim {
        2 => DISPLACEMENT.add(bundle, &stem, Some(displacement(&step.body, &run)?)),
        3 if !step.crack.cells.is_empty() => {
            CONTACT.add(bundle, &stem, Some(contact_status(step, &run)?))
        }
        _ => Ok(()),
    }
}
