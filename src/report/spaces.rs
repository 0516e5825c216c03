//! The files of the study of contact spaces.

use super::tables::spaces::{InfSupRow, InfSupSummary, PatchSummary};
use super::{Bundle, Provenance, ReportError, figures, table};
use crate::studies::spaces::infsup::Sequence;
use crate::studies::spaces::patch::PatchRow;

/// Inf-sup numbers and patch tests, every one and summed up, the figure, provenance.
///
/// # Errors
/// Those of [`table::add`] and of the figure.
pub fn bundle(
    sequences: &[Sequence],
    patches: &[PatchRow],
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    table::add(&mut bundle, &InfSupRow::of(sequences), "")?;
    table::add(
        &mut bundle,
        &sequences.iter().map(InfSupSummary).collect::<Vec<_>>(),
        "",
    )?;
    table::add(&mut bundle, patches, "")?;
    table::add(&mut bundle, &PatchSummary::of(patches), "")?;
    figures::infsup::add(&mut bundle, sequences)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}
