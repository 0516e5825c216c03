//! Expected numbers of a case against what its runs found.

use crate::case::{Case, CaseError, Expect, Tolerance};
use crate::model::boundary::region_name;
use crate::model::intensities::{MODES, places};
use crate::model::quantities::{AXES, LOCAL, unit};
use crate::run::choice::Choice;
use crate::studies::record::Record;
use crate::studies::rows::{ExpectRow, MET, MISSED_AS_DOCUMENTED, RunKey};

/// Refuses expectations that no run can answer: an unknown quantity, or a place, component or unit it does not have.
///
/// # Errors
/// The first such expectation, at its place in the file.
pub fn check(case: &Case) -> Result<(), CaseError> {
    let dim = case.model.dim();
    let cracks = || (1..=case.cracks.len()).map(|i| format!("crack-{i}"));
    let tips = || {
        cracks()
            .flat_map(|crack| places(&crack, dim).collect::<Vec<_>>())
            .collect()
    };
    let anywhere = || std::iter::once(String::new()).chain(cracks()).collect();
    let held = || case.supports.iter().map(|s| region_name(&s.on));
    for expect in &case.expects {
        let name = expect.quantity.as_str();
        let Some(unit) = unit(name, dim) else {
            let allowed = "a quantity of quantities.csv, see `stickslip show schema`";
            return Err(case.error(&expect.span, name, allowed, "unknown quantity"));
        };
        let (places, components): (Vec<String>, &[&str]) = match name {
            "reaction" => (held().collect(), &AXES[..dim]),
            "displacement" => {
                let probes = case.probes.iter().map(|p| p.name.clone());
                (held().chain(probes).collect(), &AXES[..dim])
            }
            "contact_force" => (cracks().collect(), &LOCAL[..dim]),
            "mean_slip" => (cracks().collect(), &LOCAL[1..dim]),
            "stress_intensity" => (tips(), &MODES[..dim]),
            "energy_release_rate" | "growth_angle" => (tips(), &[""]),
            "strain_energy"
            | "external_work"
            | "initial_stress_work"
            | "path_error"
            | "energy_identity" => (vec![String::new()], &[""]),
            _ => (anywhere(), &[""]),
        };
        let quote = |list: &[&str]| {
            list.iter()
                .map(|x| format!("{x:?}"))
                .collect::<Vec<_>>()
                .join(", ")
        };
        let names: Vec<&str> = places.iter().map(String::as_str).collect();
        for (what, found, allowed) in [
            ("at", expect.at.as_str(), names.as_slice()),
            ("component", expect.component.as_str(), components),
            ("unit", expect.unit.as_str(), &[unit]),
        ] {
            if !allowed.contains(&found) {
                let message = format!("no run has a `{}` with this `{what}`", expect.quantity);
                return Err(case.error(
                    &expect.span,
                    format!("{found:?}"),
                    quote(allowed),
                    message,
                ));
            }
        }
    }
    Ok(())
}

/// Rows of `expectations.csv` for one run; one that could not start is held to nothing.
pub fn expectation_rows<'a>(
    case: &'a Case,
    choice: &'a Choice,
    record: &'a Record,
) -> impl Iterator<Item = ExpectRow> + 'a {
    let (refine, friction) = (record.asked.refine, record.asked.mu());
    let applicable = case
        .expects
        .iter()
        .filter(move |e| record.spent.is_some() && applies(e, choice, refine, friction));
    applicable.map(|e| {
        let increment = e.increment.unwrap_or(case.path.increments);
        compare(e, RunKey::of(record, increment), record)
    })
}

/// An expectation without a method speaks of the exact ones.
fn applies(expect: &Expect, choice: &Choice, refine: usize, friction: f64) -> bool {
    let method = match &expect.method {
        Some(name) => name == choice.name(),
        None => choice.exact(),
    };
    method
        && expect.friction.is_none_or(|mu| mu == friction)
        && expect.refine.is_none_or(|factor| factor == refine)
}

fn compare(expect: &Expect, key: RunKey, record: &Record) -> ExpectRow {
    let steps = record.found.increments.iter();
    let own = steps.filter(|step| step.increment == key.increment);
    let found = own
        .flat_map(|step| &step.quantities)
        .find(|q| {
            q.name == expect.quantity
                && q.at == expect.at
                && q.component == expect.component
                && q.unit == expect.unit
        })
        .map_or(f64::NAN, |q| q.value);
    let allowed = match expect.tolerance {
        Tolerance::Relative(t) => t * expect.value.abs(),
        Tolerance::Absolute(t) => t,
    };
    // NaN (the run has no such number) is never within the tolerance.
    let met = (found - expect.value).abs() <= allowed;
    let verdict = match (met, expect.missed) {
        (true, false) => MET,
        (false, false) => "missed",
        // A documented miss still needs a number: a run without one has failed.
        (false, true) if found.is_finite() => MISSED_AS_DOCUMENTED,
        (false, true) => "missed",
        (true, true) => "met against the documentation",
    };
    ExpectRow {
        key,
        quantity: expect.quantity.clone(),
        at: expect.at.clone(),
        component: expect.component.clone(),
        expected: expect.value,
        found,
        allowed,
        unit: expect.unit.clone(),
        kind: expect.kind.name().into(),
        source: expect.source.clone(),
        verdict: verdict.into(),
    }
}
