//! Axes: label, scale, range and ticks.

/// How values become places.
#[derive(Debug, Clone, PartialEq)]
enum Scale {
    Linear,
    Log,
    /// Whole numbers from 0 on a scale of ln(1 + number), which shows few and many.
    Counts,
    /// Names, the first at the left or on top.
    Names(Vec<String>),
}

/// One axis. A kind of figure gives label and scale; [`Axis::fitted`] finds range and ticks from what is drawn.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Label with unit. Panels whose axes have the same label share the range.
    pub label: String,
    scale: Scale,
    /// Values that it covers in any case; at 0 and at the last one a linear axis ends without room.
    with: Vec<f64>,
    low: f64,
    high: f64,
    /// Ticks with labels.
    pub major: Vec<(f64, String)>,
    /// Ticks without.
    pub minor: Vec<f64>,
}

impl Axis {
    fn of(label: &str, scale: Scale) -> Self {
        Self {
            label: label.to_owned(),
            scale,
            with: Vec::new(),
            low: 0.0,
            high: 1.0,
            major: Vec::new(),
            minor: Vec::new(),
        }
    }

    /// Evenly spaced values.
    pub fn linear(label: &str) -> Self {
        Self::of(label, Scale::Linear)
    }

    /// Powers of ten; what is not positive has no place.
    pub fn log(label: &str) -> Self {
        Self::of(label, Scale::Log)
    }

    /// Whole numbers from 0, evenly spaced in ln(1 + number).
    pub fn counts(label: &str) -> Self {
        Self::of(label, Scale::Counts)
    }

    /// Names at 0, 1, 2 …, on a y axis downwards.
    pub fn names(label: &str, names: Vec<String>) -> Self {
        Self::of(label, Scale::Names(names))
    }

    /// The same axis, covering these values in any case.
    pub fn through(self, with: &[f64]) -> Self {
        let with = with.to_vec();
        Self { with, ..self }
    }

    /// How many names the axis has instead of numbers.
    pub fn named(&self) -> Option<usize> {
        match &self.scale {
            Scale::Names(names) => Some(names.len()),
            _ => None,
        }
    }

    /// Whether a value has a place.
    pub fn has(&self, value: f64) -> bool {
        value.is_finite() && (self.scale != Scale::Log || value > 0.0)
    }

    fn map(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Log => value.ln(),
            Scale::Counts => value.ln_1p(),
            _ => value,
        }
    }

    /// Difference of the ends.
    pub fn span(&self) -> f64 {
        self.high - self.low
    }

    /// Place of a value: 0 at the lower end, 1 at the upper.
    pub fn place(&self, value: f64) -> f64 {
        let [value, low, high] = [value, self.low, self.high].map(|v| self.map(v));
        (value - low) / (high - low)
    }

    /// The same axis over all `values` that have a place, with about `count` ticks; none without such a value.
    pub fn fitted(&self, values: impl IntoIterator<Item = f64>, count: usize) -> Option<Self> {
        let values = values.into_iter().chain(self.with.iter().copied());
        let (low, high) = range(values.filter(|v| self.has(*v)))?;
        let mut axis = self.clone();
        match &self.scale {
            Scale::Linear => axis.fit_linear(low, high, count),
            Scale::Log => axis.fit_log(low, high, count),
            Scale::Counts => {
                let end = |part: f64| (high + 1.0).powf(part) - 1.0;
                (axis.low, axis.high) = (end(-0.03), end(1.03));
                let within = |t: &f64| *t <= high;
                // Over many decades the labels of 2 and 5 would touch those of the decades.
                let steps = if high < 2e3 {
                    &[1.0, 2.0, 5.0][..]
                } else {
                    &[1.0]
                };
                let ticks = (0..10).flat_map(|e| steps.iter().map(move |m| m * 10f64.powi(e)));
                axis.major = labelled(std::iter::once(0.0).chain(ticks).filter(within), 0);
            }
            Scale::Names(names) => {
                (axis.low, axis.high) = (-0.5, names.len() as f64 - 0.5);
                axis.major = (0..).map(f64::from).zip(names.clone()).collect();
            }
        }
        Some(axis)
    }

    fn fit_linear(&mut self, mut low: f64, mut high: f64, count: usize) {
        if high - low <= 1e-12 * high.abs().max(low.abs()) {
            let half = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
            (low, high) = (low - half, high + half);
        }
        let pad = |end: f64| {
            let last = self.with.len() > 1 && self.with.last() == Some(&end);
            if end == 0.0 || last {
                0.0
            } else {
                0.05 * (high - low)
            }
        };
        (self.low, self.high) = (low - pad(low), high + pad(high));
        let step = nice_step((self.high - self.low) / count.max(1) as f64);
        self.major = labelled(multiples(step, self.low, self.high), decimals(step));
    }

    fn fit_log(&mut self, low: f64, high: f64, count: usize) {
        let pad = (high.powf(0.05) / low.powf(0.05)).max(1.1);
        // Numbers that nearly are none leave no room beyond them.
        (self.low, self.high) = (
            (low / pad).max(f64::MIN_POSITIVE),
            (high * pad).min(f64::MAX),
        );
        let (low, high) = (self.low, self.high);
        let decades = high.log10() - low.log10();
        let exponents = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let of = |steps: &'static [f64]| {
            let powers = exponents.clone().map(|e| 10f64.powi(e));
            let all = powers.flat_map(move |p| steps.iter().map(move |m| m * p));
            all.filter(move |v| (low..=high).contains(v))
        };
        if decades > 1.7 {
            let every = (decades / count.max(2) as f64).ceil() as i32;
            let (major, minor): (Vec<f64>, Vec<f64>) =
                of(&[1.0]).partition(|p| (p.log10().round() as i32).rem_euclid(every) == 0);
            self.major = major.iter().map(|p| (*p, power(*p))).collect();
            self.minor = minor;
            if decades < 6.0 {
                let between = of(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
                self.minor.extend(between);
            }
        } else if decades > 0.7 {
            self.major = of(&[1.0, 2.0, 5.0]).map(|v| (v, handy(v))).collect();
        } else {
            // Less than a decade: evenly spaced ticks, as on a linear axis.
            let step = nice_step((high - low) / count.clamp(3, 4) as f64);
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

fn labelled(ticks: impl IntoIterator<Item = f64>, decimals: usize) -> Vec<(f64, String)> {
    let label = |t| (t, number(t, decimals));
    ticks.into_iter().map(label).collect()
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
        let linear = labels(Axis::linear("f"), [0.0, 1.2]);
        assert_eq!(linear, ["0.0", "0.5", "1.0"]);
        let decades = labels(Axis::log("e"), [1e-3, 1.0]);
        assert_eq!(decades, ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        let parts = labels(Axis::log("e"), [0.2, 2.0]);
        assert_eq!(parts, ["0.2", "0.5", "1", "2"]);
        assert!(labels(Axis::log("e"), [1e-16, 1.0]).len() <= 6);
        assert!(labels(Axis::log("e"), [1e-307, 1e308]).len() <= 6);
        assert!(labels(Axis::log("e"), [973.0, 1138.0]).len() >= 2);
        assert!(Axis::log("e").fitted([0.0, -1.0], 5).is_none());
        let counts = labels(Axis::counts("n"), [0.0, 90.0]);
        assert_eq!(counts[..4], ["0", "1", "2", "5"]);
    }

    #[test]
    fn units_get_the_prefix_that_fits() {
        assert_eq!(prefixed(0.004, "m"), (1e3, "mm".into()));
        assert_eq!(prefixed(52e6, "Pa").1, "MPa");
        assert_eq!(prefixed(12e3, "m").1, "m");
        assert_eq!(prefixed(0.0, "m").0, 1.0);
    }
}
