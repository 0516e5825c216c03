//! Lines on cases that are read and solved as they say, and probably do not say what was meant.

use super::output::warn;
use crate::case::Case;
use crate::model::resolution::Coarse;
use crate::report::number::significant;
use crate::studies::results::Results;

/// Stiffnesses that were probably meant in other units [Pa]; up to 1 the numbers have none.
const SOFT_PA: std::ops::Range<f64> = 1.0..1e6;
/// Mean strain above which small displacements are a wrong model [-].
const LARGE_STRAIN: f64 = 0.05;

/// Warns of a case; `coarse`: cracks for which the cells of a mesh are too coarse, with its label.
pub fn on_case<'a>(case: &Case, coarse: impl IntoIterator<Item = (&'a str, &'a Coarse)>) {
    let name = &case.name;
    if case.cracks.is_empty() {
        warn(format_args!("{name}: no crack, nothing to compare"));
    }
    let young = case.material.young;
    if young > SOFT_PA.start && young < SOFT_PA.end {
        let young = significant(young, 3);
        warn(format_args!(
            "{name}: young_pa = {young}: the unit is Pa, 1 GPa is 1e9"
        ));
    }
    for (mesh, Coarse { crack, why, cell_m }) in coarse {
        let cell = significant(*cell_m, 2);
        warn(format_args!(
            "{name} {mesh}: crack {crack}: {why}: slip and dissipation may be off by more than 3 %, cells of {cell} m would do"
        ));
    }
}

/// Warns of runs of a case: of cells that are too coarse, and of large strains.
pub fn on_results(case: &Case, results: &Results) {
    let own = || {
        results
            .answers
            .iter()
            .filter(|own| own.record.asked.case == case.name)
    };
    let told = own().flat_map(|own| {
        let found = &own.record.found;
        let mesh = found.problem.as_ref().map_or("", |size| &size.mesh);
        found.coarse.iter().map(move |coarse| (mesh, coarse))
    });
    let mut once: Vec<(&str, &Coarse)> = Vec::new();
    for own in told {
        if !once.contains(&own) {
            once.push(own);
        }
    }
    on_case(case, once);
    let [low, high] = case.mesh.grid.extents();
    let volume: f64 = (0..case.model.dim()).map(|a| high[a] - low[a]).product();
    let steps = own().flat_map(|own| &own.record.found.increments);
    let quantities = steps.flat_map(|step| &step.quantities);
    let energies = quantities.filter(|quantity| quantity.name == "strain_energy");
    let energy = energies.map(|quantity| quantity.value).fold(0.0, f64::max);
    // ½ E ε² V of the mean strain ε.
    let strain = (2.0 * energy / (case.material.young * volume)).sqrt();
    if strain > LARGE_STRAIN {
        let percent = significant(100.0 * strain, 2);
        warn(format_args!(
            "{}: strains of {percent} % in the mean: displacements are taken to be small; are lengths in m?",
            case.name
        ));
    }
}
