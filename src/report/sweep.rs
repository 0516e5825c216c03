//! Records of a sweep as tables and figures.
//!
//! Files that hold no times are the same on every machine: `increments.csv`, `success.*`, `options.*`. All others belong to the machine. Times stand beside honest verdicts only, see
//! [`published_times`](crate::studies::analysis::published_times).

use std::collections::BTreeSet;

use super::names::file_name;
use super::tables::of_study;
use super::tables::ranks::sets;
use super::{Bundle, Provenance, ReportError, figures};
use crate::studies::analysis::options::sweeps;
use crate::studies::analysis::success::success;
use crate::studies::record::Record;

/// Files of a sweep; `total`: cells that the sweep has in all. Paths have no common folder.
///
/// # Errors
/// Those of the parts.
pub fn bundle(
    records: &[Record],
    total: usize,
    provenance: &Provenance,
) -> Result<Bundle, ReportError> {
    let caveat = match records.len() {
        found if found < total => format!("; incomplete, {found} of {total} cells"),
        _ => String::new(),
    };
    let mut bundle = Bundle::new();
    for table in of_study() {
        (table.add)(&mut bundle, records, &caveat)?;
    }
    let (sets, sweeps) = (sets(records), sweeps(records));
    figures::success::add(&mut bundle, &success(records), &caveat)?;
    figures::options::add(&mut bundle, &sweeps, &caveat)?;
    figures::scaling::add(&mut bundle, records, &caveat)?;
    figures::performance::add(&mut bundle, "", &sets, &caveat)?;
    figures::time_against_solver_error::add(&mut bundle, records, &caveat)?;
    figures::time_against_total_error::add(&mut bundle, records, &caveat)?;
    figures::stages::add(&mut bundle, records, &caveat)?;
    add_classes(&mut bundle, records, &caveat)?;
    super::add_provenance(&mut bundle, provenance)?;
    Ok(bundle)
}

/// Adds a performance profile per class, where problems come from files.
fn add_classes(bundle: &mut Bundle, records: &[Record], caveat: &str) -> Result<(), ReportError> {
    let own = records.iter().filter(|r| r.asked.is_from_file());
    let classes: BTreeSet<&str> = own.map(|record| record.class.as_str()).collect();
    for class in classes {
        let members = records.iter().filter(|record| record.class == class);
        let members: Vec<Record> = members.cloned().collect();
        let name = format!("{}.", file_name(&[class]));
        figures::performance::add(bundle, &name, &sets(&members), caveat)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
