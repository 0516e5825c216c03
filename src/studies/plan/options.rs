//! Options of methods as axes of a sweep.
//!
//! ```toml
//! options.r = { from = 1e-3, to = 1e3, per_decade = 2 }      # from · 10^(k/2), and the default of the method between them
//! options.max_iterations = [801]                             # these values
//! ```

use crate::case::error::CaseError;
use crate::case::reader::Value;
use crate::run::choice::Choice;

/// Most settings of one method.
const MAX_SETTINGS: usize = 10_000;

/// Significant digits of the values of a grid after its ends, so that ids can be read.
const DIGITS: usize = 4;

/// One option with the values it takes.
struct Axis<'a> {
    name: &'a str,
    place: Value<'a>,
    /// Each where it stands in the file.
    values: Vec<(Value<'a>, f64)>,
    /// Whether they are a grid, to which the default of a method belongs where it lies within.
    grid: bool,
}

/// Every method of a block with every combination of the values of its options. Those `named`, with
/// their places, must have all options; of `all` methods those are meant that have them.
pub(super) fn settings(
    options: Value<'_>,
    named: Option<Vec<(Value<'_>, Choice)>>,
    all: &[Choice],
) -> Result<Vec<Choice>, CaseError> {
    let axes = axes(options)?;
    for axis in &axes {
        let have: Vec<&str> = (all.iter().filter(|c| c.spec(axis.name).is_some()))
            .map(|choice| choice.name())
            .collect();
        if have.is_empty() {
            let known = "an option of a method, as `stickslip show methods` names them";
            let message = format_args!("no method has an option `{}`", axis.name);
            return Err(axis.place.refuse(known, message));
        }
        for (place, choice) in named.iter().flatten() {
            if choice.spec(axis.name).is_none() {
                let allowed = format!("methods that have it: {}", have.join(", "));
                let message = format_args!("the method has no option `{}`", axis.name);
                return Err(place.refuse(allowed, message));
            }
        }
    }
    let has_all = |c: &&Choice| axes.iter().all(|axis| c.spec(axis.name).is_some());
    let meant: Vec<(Value<'_>, &Choice)> = match &named {
        Some(named) => named
            .iter()
            .map(|(place, choice)| (*place, choice))
            .collect(),
        None => all.iter().filter(has_all).map(|c| (options, c)).collect(),
    };
    if meant.is_empty() {
        return Err(options.refuse("options of one method", "no method has all of them"));
    }
    let mut settings = Vec::new();
    for (place, choice) in meant {
        let mut own = vec![choice.argument()];
        for axis in &axes {
            let values = axis.of(choice)?;
            if own.len().saturating_mul(values.len()) > MAX_SETTINGS {
                let allowed = format!("at most {MAX_SETTINGS} combinations of a method");
                return Err(options.refuse(allowed, "too many values"));
            }
            let with = |argument: &String, value: &f64| {
                let joint = if argument.contains(':') { ',' } else { ':' };
                format!("{argument}{joint}{}={value:e}", axis.name)
            };
            let all = own
                .iter()
                .flat_map(|a| values.iter().map(move |v| with(a, v)));
            own = all.collect();
        }
        for argument in own {
            // The values are checked: what is left is an option that the method was given already.
            let choice = Choice::parse(&argument)
                .map_err(|e| place.refuse("every option in one place", e))?;
            settings.push(choice);
        }
    }
    Ok(settings)
}

fn axes(options: Value<'_>) -> Result<Vec<Axis<'_>>, CaseError> {
    let entries = options.any_table()?.entries();
    if entries.is_empty() {
        return Err(options.refuse("at least one option", "empty table"));
    }
    let axis = |(name, _, place)| Axis::read(name, place);
    entries.into_iter().map(axis).collect()
}

impl<'a> Axis<'a> {
    fn read(name: &'a str, place: Value<'a>) -> Result<Self, CaseError> {
        let list = place.list();
        let grid = list.is_err();
        let values = match list {
            Ok(list) if list.is_empty() => {
                return Err(place.refuse("at least one value", "empty list"));
            }
            Ok(list) => (list.into_iter().map(|v| Ok((v, v.number()?))))
                .collect::<Result<Vec<_>, CaseError>>()?,
            Err(_) if place.any_table().is_err() => {
                let allowed = "a list of numbers, or { from = 1e-3, to = 1e3, per_decade = 1 }";
                return Err(place.refuse(allowed, "wrong type"));
            }
            Err(_) => grid_of(place)?.into_iter().map(|v| (place, v)).collect(),
        };
        Ok(Self {
            name,
            place,
            values,
            grid,
        })
    }

    /// Its values for a method that has the option.
    fn of(&self, choice: &Choice) -> Result<Vec<f64>, CaseError> {
        let Some(spec) = choice.spec(self.name) else {
            return Ok(Vec::new());
        };
        if let Some((place, value)) = self.values.iter().find(|v| spec.value(v.1).is_none()) {
            let message = format!(
                "{value:e} is not allowed for `{}` of {}",
                self.name,
                choice.name()
            );
            return Err(place.refuse(spec.allowed(), message));
        }
        let mut values: Vec<f64> = self.values.iter().map(|v| v.1).collect();
        let default = spec.default().number();
        let within = values.iter().any(|v| *v <= default) && values.iter().any(|v| *v >= default);
        if self.grid && within {
            values.push(default);
        }
        values.sort_by(f64::total_cmp);
        values.dedup();
        Ok(values)
    }
}

/// from · 10^(k/n) up to `to`.
fn grid_of(place: Value<'_>) -> Result<Vec<f64>, CaseError> {
    let table = place.table(&["from", "to", "per_decade"])?;
    let (from, to) = (table.positive("from")?, table.required("to")?);
    let to = to.number_if(&format!("numbers > {from:e}"), |to| to > from)?;
    let per_decade = table.get("per_decade");
    let n = per_decade.map_or(Ok(1), |v| v.integer(1..=100))? as i32;
    let value = |k: i32| from * 10f64.powf(f64::from(k) / f64::from(n));
    let within = |v: &f64| *v < to * (1.0 - 1e-9);
    let rounded = |v: f64| format!("{v:.*e}", DIGITS - 1).parse().unwrap_or(v);
    let inner = (1..).map(value).take_while(within).map(rounded);
    let mut values: Vec<f64> = std::iter::once(from).chain(inner).collect();
    let steps = (to / from).log10() * f64::from(n);
    if (steps - steps.round()).abs() < 1e-6 {
        values.push(to);
    }
    Ok(values)
}
