//! The files of the stress suite.

use super::{Bundle, Provenance, ReportError, figures, table};
use crate::studies::stress::conduct::Suite;
use crate::studies::stress::finding::Finding;
use crate::studies::stress::{rungs, summary};

/// Causes, invariances, methods, scenes, the smallest failing cases, provenance.
///
/// # Errors
/// Those of [`table::add`].
pub fn bundle(
    suite: &Suite,
    findings: &[Finding],
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let mut bundle = Bundle::new();
    table::add(&mut bundle, &summary::causes(findings), "")?;
    table::add(&mut bundle, &summary::invariances(findings), "")?;
    table::add(&mut bundle, &summary::methods(findings), "")?;
    table::add(&mut bundle, &summary::scenes(suite, findings), "")?;
    table::add(&mut bundle, &rungs::of_scenes(findings), "")?;
    table::add(&mut bundle, &rungs::of_options(findings), "")?;
    table::add(&mut bundle, &rungs::rungs(findings), "")?;
    figures::ladders::add(&mut bundle, findings)?;
    for finding in findings {
        if let (Some(name), Some(text)) = (summary::minimal(finding), &finding.minimal) {
            let cause = finding.cause.map_or("right", |c| c.name());
            bundle.add(name, format!("# {cause}: {}\n{text}", finding.reason))?;
        }
    }
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}
