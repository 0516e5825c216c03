//! Axes: label, scale, range and ticks.

/// How values become places.
#[derive(Debug, Clone, PartialEq)]
enum Scale {
    Linear,
    Log,
    /// Whole numbers from 0: linear, or ln(1 + value), which shows few and many.
    Counts,
    ManyCounts,
    /// Names, the first at the left or on top.
    Names(Vec<String>),
}

/// One axis. A kind of figure gives label and scale; [`Axis::fitted`] finds range and ticks from what is drawn.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Label with unit. Panels whose axes have the same label share the range.
    pub label: String,
    scale: Scale,
    /// A value that it covers in any case.
    with: Option<f64>,
    low: f64,
    high: f64,
    /// Ticks with labels.
    pub major: Vec<(f64, String)>,
    /// Ticks without.
    pub minor: Vec<f64>,
}

impl Axis {
    fn of(label: &str, scale: Scale) -> Self {
        let (low, high, major, minor) = (0.0, 1.0, Vec::new(), Vec::new());
        let label = label.to_owned();
        Self {
            label,
            scale,
            with: None,
            low,
            high,
            major,
            minor,
        }
    }

    /// Evenly spaced values. Large and small numbers get a common power of ten inside the brackets of the unit.
    pub fn linear(label: &str) -> Self {
        Self::of(label, Scale::Linear)
    }

    /// The same axis, covering this value in any case.
    pub fn through(self, value: f64) -> Self {
        Self {
            with: Some(value),
            ..self
        }
    }

    /// Powers of ten; what is not positive has no place.
    pub fn log(label: &str) -> Self {
        Self::of(label, Scale::Log)
    }

    /// Whole numbers from 0, `many` of them on a scale of ln(1 + number).
    pub fn counts(label: &str, many: bool) -> Self {
        Self::of(
            label,
            if many {
                Scale::ManyCounts
            } else {
                Scale::Counts
            },
        )
    }

    /// Names at 0, 1, 2 …, upwards on a y axis from the last.
    pub fn names(label: &str, names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self::of(
            label,
            Scale::Names(names.into_iter().map(Into::into).collect()),
        )
    }

    /// Whether the axis has names instead of numbers.
    pub fn is_named(&self) -> bool {
        matches!(self.scale, Scale::Names(_))
    }

    /// Whether a value has a place.
    pub fn has(&self, value: f64) -> bool {
        value.is_finite() && (self.scale != Scale::Log || value > 0.0)
    }

    fn map(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Log => value.ln(),
            Scale::ManyCounts => value.ln_1p(),
            _ => value,
        }
    }

    /// Place of a value: 0 at the lower end, 1 at the upper.
    pub fn place(&self, value: f64) -> f64 {
        let [value, low, high] = [value, self.low, self.high].map(|v| self.map(v));
        (value - low) / (high - low)
    }

    /// The same axis over all `values` that have a place, with about `count` ticks; none without such a value.
    pub fn fitted(&self, values: impl IntoIterator<Item = f64>, count: usize) -> Option<Self> {
        let (low, high) = range(values.into_iter().chain(self.with).filter(|v| self.has(*v)))?;
        let mut axis = self.clone();
        match &self.scale {
            Scale::Linear => axis.fit_linear(low, high, count),
            Scale::Log => axis.fit_log(low, high, count),
            Scale::Counts => {
                let step = nice_step(high.max(1.0) / count.max(1) as f64).max(1.0);
                (axis.low, axis.high) = (-0.03 * high.max(1.0), 1.03 * high.max(1.0));
                axis.major = labelled(multiples(step, 0.0, high.max(1.0)), 0);
            }
            Scale::ManyCounts => {
                let ends = [-0.03, 1.03].map(|part| (high + 1.0).powf(part) - 1.0);
                [axis.low, axis.high] = ends;
                let decades = (0..=high.max(1.0).log10() as i32).map(|e| 10f64.powi(e));
                // Over many decades, or where there is no room, the labels of 2 and 5 would touch those of the decades.
                let fine = if high < 2e3 && count > 4 {
                    &[1.0, 2.0, 5.0][..]
                } else {
                    &[1.0]
                };
                let steps = decades.flat_map(|p| fine.iter().map(move |m| m * p));
                let ticks = std::iter::once(0.0).chain(steps.filter(|t| *t <= high));
                axis.major = labelled(ticks.collect(), 0);
            }
            Scale::Names(names) => {
                (axis.low, axis.high) = (-0.5, names.len() as f64 - 0.5);
                let named = names
                    .iter()
                    .enumerate()
                    .map(|(i, name)| (i as f64, name.clone()));
                axis.major = named.collect();
            }
        }
        Some(axis)
    }

    fn fit_linear(&mut self, mut low: f64, mut high: f64, count: usize) {
        if high - low <= 1e-12 * high.abs().max(low.abs()) {
            let half = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
            (low, high) = (low - half, high + half);
        }
        // Room at the ends, but an axis that starts or ends at zero keeps doing so.
        let pad = 0.05 * (high - low);
        self.low = if low == 0.0 { 0.0 } else { low - pad };
        self.high = if high == 0.0 { 0.0 } else { high + pad };
        let step = nice_step((self.high - self.low) / count.max(1) as f64);
        let ticks = multiples(step, self.low, self.high);
        let exponent = common_exponent(ticks.iter().fold(0.0_f64, |m, t| m.max(t.abs())));
        let scale = 10f64.powi(exponent);
        self.label = with_power(&self.label, exponent);
        let decimals = decimals(step / scale);
        self.major = ticks
            .iter()
            .map(|t| (*t, number(t / scale, decimals)))
            .collect();
    }

    fn fit_log(&mut self, low: f64, high: f64, count: usize) {
        let pad = (high / low).powf(0.05).max(1.1);
        let (low, high) = (low / pad, high * pad);
        (self.low, self.high) = (low, high);
        let within = |v: &f64| *v >= low && *v <= high;
        let decades = (high / low).log10();
        let exponents = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let of = |steps: &'static [f64]| {
            let powers = exponents.clone().map(|e| 10f64.powi(e));
            powers
                .flat_map(move |p| steps.iter().map(move |m| m * p))
                .filter(within)
        };
        if decades > 1.7 {
            let every = (decades / count.max(2) as f64).ceil() as i32;
            let [labelled, bare]: [Vec<f64>; 2] = of(&[1.0])
                .partition(|p| (p.log10().round() as i32).rem_euclid(every) == 0)
                .into();
            self.major = labelled.iter().map(|p| (*p, power(*p))).collect();
            self.minor = bare;
            if decades < 6.0 {
                self.minor
                    .extend(of(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]));
            }
        } else if decades > 0.7 {
            self.major = of(&[1.0, 2.0, 5.0]).map(|v| (v, handy(v))).collect();
        } else {
            // Less than a decade: evenly spaced ticks, as on a linear axis.
            let step = nice_step((high - low) / count.clamp(2, 4) as f64);
            self.major = labelled(multiples(step, low, high), decimals(step));
        }
    }
}

/// Smallest and largest finite value.
pub fn range(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    let finite = values.into_iter().filter(|v| v.is_finite());
    finite.fold(None, |range, v| match range {
        None => Some((v, v)),
        Some((low, high)) => Some((v.min(low), v.max(high))),
    })
}

/// The smallest of 1, 2, 5 × 10ⁿ that is not below `raw`.
pub fn nice_step(raw: f64) -> f64 {
    let power = 10f64.powi(raw.log10().floor() as i32);
    // The tolerance keeps 0.2 from becoming 0.5 by round-off.
    let step = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|s| s * power >= raw * (1.0 - 1e-9));
    step.unwrap_or(10.0) * power
}

/// Multiples of `step` in [low, high].
pub fn multiples(step: f64, low: f64, high: f64) -> Vec<f64> {
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

fn labelled(ticks: Vec<f64>, decimals: usize) -> Vec<(f64, String)> {
    ticks
        .into_iter()
        .map(|t| (t, number(t, decimals)))
        .collect()
}

fn decimals(step: f64) -> usize {
    (-step.log10() - 1e-9).ceil().max(0.0) as usize
}

/// A number with a true minus sign.
pub fn number(value: f64, decimals: usize) -> String {
    crate::report::number::fixed(value, decimals).replace('-', "−")
}

/// A power of ten, e.g. `10⁻³`.
fn power(value: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let exponent = (value.log10().round() as i32).to_string();
    let digits = exponent
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize]));
    std::iter::once('1').chain(['0']).chain(digits).collect()
}

/// 1, 2 or 5 times a power of ten.
fn handy(value: f64) -> String {
    let exponent = (value.log10() + 1e-9).floor() as i32;
    let mantissa = (value / 10f64.powi(exponent)).round();
    match exponent {
        -3..=4 => number(value, (-exponent).max(0) as usize),
        _ if mantissa == 1.0 => power(value),
        _ => format!("{mantissa}·{}", power(10f64.powi(exponent))),
    }
}

/// Power of ten taken out of tick labels, a multiple of three; 0 for handy numbers.
fn common_exponent(largest: f64) -> i32 {
    if largest == 0.0 || (1e-2..1e4).contains(&largest) {
        return 0;
    }
    3 * (largest.log10() / 3.0).floor() as i32
}

fn with_power(label: &str, exponent: i32) -> String {
    if exponent == 0 {
        return label.to_owned();
    }
    let power = power(10f64.powi(exponent));
    match label.rsplit_once('[') {
        Some((name, "-]")) => format!("{name}[{power}]"),
        Some((name, unit)) => format!("{name}[{power} {unit}"),
        None => format!("{label} [{power}]"),
    }
}

/// Factor and prefixed unit that bring `largest` between 1 and 1000, e.g. 0.004 m gives (1e3, `mm`).
pub fn prefixed(largest: f64, unit: &str) -> (f64, String) {
    if largest == 0.0 || !largest.is_finite() {
        return (1.0, unit.to_owned());
    }
    // Kilometres of displacement would be odd: lengths go down only.
    let highest = if unit == "m" { 0 } else { 3 };
    let thousands = (((largest.log10() + 1e-9) / 3.0).floor() as i32).clamp(-3, highest);
    let prefix = ["n", "µ", "m", "", "k", "M", "G"][(thousands + 3) as usize];
    (10f64.powi(-3 * thousands), format!("{prefix}{unit}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |axis: Axis, values: [f64; 2]| -> Vec<String> {
            let axis = axis.fitted(values, 5).expect("values");
            axis.major.into_iter().map(|(_, l)| l).collect()
        };
        let axis = Axis::linear("force [N]")
            .fitted([0.0, 1.2e9], 5)
            .expect("values");
        assert_eq!(
            (axis.label.as_str(), axis.place(0.0)),
            ("force [10⁹ N]", 0.0)
        );
        assert_eq!(labels(Axis::linear("f"), [0.0, 1.2]), ["0.0", "0.5", "1.0"]);
        assert_eq!(
            labels(Axis::log("e"), [1e-3, 1.0]),
            ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]
        );
        assert_eq!(labels(Axis::log("e"), [0.2, 2.0]), ["0.2", "0.5", "1", "2"]);
        assert!(labels(Axis::log("e"), [1e-16, 1.0]).len() <= 6);
        assert!(labels(Axis::log("e"), [973.0, 1138.0]).len() >= 2);
        assert!(Axis::log("e").fitted([0.0, -1.0], 5).is_none());
        assert_eq!(
            labels(Axis::counts("n", true), [0.0, 90.0])[..4],
            ["0", "1", "2", "5"]
        );
    }

    #[test]
    fn units_get_the_prefix_that_fits() {
        assert_eq!(prefixed(0.004, "m"), (1e3, "mm".into()));
        assert_eq!(prefixed(52e6, "Pa").1, "MPa");
        assert_eq!(prefixed(12e3, "m").1, "m");
        assert_eq!(prefixed(0.0, "m").0, 1.0);
    }
}
