//! The files of the stress suite.

use super::{Bundle, Provenance, ReportError, figures, table};
use crate::studies::analysis::success::success;
use crate::studies::stress::finding::Finding;
use crate::studies::stress::summary;

/// Faults, invariances, success of the methods, ladders, the smallest failing cases, provenance.
///
/// # Errors
/// Those of [`table::add`].
pub fn bundle(findings: &[Finding], provenance: &Provenance) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    table::add(&mut bundle, &summary::faults(findings), "")?;
    table::add(&mut bundle, &summary::invariances(findings), "")?;
    let records = summary::records(findings);
    table::add(&mut bundle, &success(&records), "")?;
    figures::success::add(&mut bundle, &success(&records), "")?;
    table::add(&mut bundle, &summary::of_ladders(findings), "")?;
    for finding in findings {
        if let (Some(name), Some(text)) = (summary::minimal(finding), &finding.minimal) {
            let fault = finding.fault.map_or("right", |fault| fault.name());
            bundle.add(name, format!("# {fault}: {}\n{text}", finding.reason))?;
        }
    }
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}
