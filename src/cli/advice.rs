//! Lines on cases that are read and solved as they say, and probably do not say what was meant.

use super::output::warn;
use crate::case::Case;
use crate::model::quantities::PointState;
use crate::report::number::significant;
use crate::studies::results::Results;

/// Stiffnesses that were probably meant in other units [Pa]; up to 1 the numbers have none.
const SOFT_PA: std::ops::Range<f64> = 1.0..1e6;
/// Mean strain above which small displacements are a wrong model [-].
const LARGE_STRAIN: f64 = 0.05;
/// Contact points below which a crack says little.
const FEW_POINTS: usize = 4;

/// Warns of a case; `points`: contact points by crack.
pub fn on_case(case: &Case, points: &[usize]) {
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
    for (index, &count) in points.iter().enumerate().filter(|own| *own.1 < FEW_POINTS) {
        let crack = index + 1;
        warn(format_args!(
            "{name}: crack {crack} has {count} contact points: a finer mesh would tell more"
        ));
    }
}

/// Warns of runs of a case: of the mesh that has fewest contact points on a crack, and of large strains.
pub fn on_results(case: &Case, results: &Results) {
    let own = || {
        results
            .answers
            .iter()
            .filter(|own| own.record.asked.case == case.name)
    };
    let count = |crack: usize| {
        let of = |points: &Vec<PointState>| {
            let own = points.iter().filter(|point| point.crack == crack + 1);
            own.count()
        };
        own().filter_map(|own| own.points.last()).map(of).min()
    };
    let points: Vec<usize> = (0..case.cracks.len()).filter_map(count).collect();
    on_case(case, &points);
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
