//! Checks across the tables of a case: what one table says about another.

use super::error::CaseError;
use super::schema::side_names;
use super::{Case, Span};

/// Refuses a case whose tables contradict each other.
pub(super) fn check(case: &Case) -> Result<(), CaseError> {
    probes(case)?;
    expectations(case)
}

/// Probe names end up in the `at` column beside sides and cracks, and must be told apart there.
fn probes(case: &Case) -> Result<(), CaseError> {
    for (i, probe) in case.probes.iter().enumerate() {
        let taken = side_names(case.model.dim()).contains(&probe.name.as_str())
            || crack_names(case).contains(&probe.name)
            || case.probes[..i].iter().any(|p| p.name == probe.name);
        if taken {
            return Err(case.error(
                &probe.span,
                &probe.name,
                "a name of its own",
                "probe name already taken",
            ));
        }
    }
    Ok(())
}

/// An expectation that no run meets would never be tested.
fn expectations(case: &Case) -> Result<(), CaseError> {
    let own: Vec<f64> = case.cracks.iter().map(|c| c.friction).collect();
    let frictions = if case.sweep.friction.is_empty() {
        &own
    } else {
        &case.sweep.friction
    };
    for expect in &case.expects {
        let refuse = |value: &dyn std::fmt::Display,
                      allowed: String,
                      message: &str|
         -> Result<(), CaseError> {
            Err(case.error(&expect.span, value, allowed, message))
        };
        if let Some(friction) = expect.friction.filter(|mu| !frictions.contains(mu)) {
            refuse(
                &friction,
                list(frictions),
                "no run has the expected `friction`",
            )?;
        }
        if let Some(refine) = expect
            .refine
            .filter(|factor| !case.sweep.refine.contains(factor))
        {
            refuse(
                &refine,
                list(&case.sweep.refine),
                "no run has the expected `refine`",
            )?;
        }
        if let Some(increment) = expect.increment.filter(|k| *k > case.path.increments) {
            refuse(
                &increment,
                format!("1 to {}", case.path.increments),
                "no run has the expected `increment`",
            )?;
        }
        let places = places(case);
        if !expect.at.is_empty() && !places.contains(&expect.at) {
            refuse(
                &expect.at,
                places.join(", "),
                "no place has the expected `at`",
            )?;
        }
    }
    Ok(())
}

/// Places a quantity can be recorded at: sides, probes, cracks.
fn places(case: &Case) -> Vec<String> {
    let mut places: Vec<String> = side_names(case.model.dim())
        .iter()
        .map(|s| s.to_string())
        .collect();
    places.extend(case.probes.iter().map(|p| p.name.clone()));
    places.extend(crack_names(case));
    places
}

fn crack_names(case: &Case) -> Vec<String> {
    (1..=case.cracks.len())
        .map(|i| format!("crack-{i}"))
        .collect()
}

fn list<T: ToString>(values: &[T]) -> String {
    values
        .iter()
        .map(T::to_string)
        .collect::<Vec<_>>()
        .join(", ")
}

impl Case {
    /// Error about the value at `span`, found later than by the parser (e.g. a crack wholly outside the mesh).
    ///
    /// `value` is what was found, `allowed` what would be accepted; key, line and column follow from the span.
    pub fn error(
        &self,
        span: &Span,
        value: impl std::fmt::Display,
        allowed: impl std::fmt::Display,
        message: impl std::fmt::Display,
    ) -> CaseError {
        super::error::Source {
            file: &self.file,
            text: &self.source,
        }
        .error(span, value, allowed, message)
    }
}
