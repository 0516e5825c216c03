//! Axes: range, ticks and tick labels, linear or logarithmic.

/// How values become places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    Linear,
    Log,
    /// ln(1 + value): shows few and many iterations and has a zero.
    LogFromZero,
    /// −ln(101 − value): percentages, 100 apart from 99 as far as 50 from 0 or so.
    TowardsHundred,
}

impl Scale {
    fn map(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Log => value.ln(),
            Self::LogFromZero => value.ln_1p(),
            Self::TowardsHundred => -(101.0 - value).ln(),
        }
    }
}

/// One axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Label with unit.
    pub label: String,
    low: f64,
    high: f64,
    scale: Scale,
    /// Ticks with labels.
    pub major: Vec<(f64, String)>,
    /// Ticks without.
    pub minor: Vec<f64>,
}

/// Steps of ticks per decade.
const STEPS: [f64; 4] = [1.0, 2.0, 5.0, 10.0];

impl Axis {
    /// A linear axis that covers all finite `values`, with about `count` ticks.
    ///
    /// Large and small numbers get a common power of ten inside the brackets of the label's unit.
    pub fn linear(label: &str, values: impl IntoIterator<Item = f64>, count: usize) -> Self {
        let (mut low, mut high) = range(values).unwrap_or((0.0, 1.0));
        if high - low <= 1e-12 * high.abs().max(low.abs()) {
            let half = if high == 0.0 { 1.0 } else { 0.1 * high.abs() };
            (low, high) = (low - half, high + half);
        }
        // Room at the ends, but an axis that starts at zero keeps starting there.
        let pad = 0.05 * (high - low);
        low -= if low == 0.0 { 0.0 } else { pad };
        high += if high == 0.0 { 0.0 } else { pad };
        let step = nice_step((high - low) / count.max(1) as f64);
        let ticks = multiples(step, low, high);
        let largest = ticks.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
        let exponent = common_exponent(largest);
        let scale = 10f64.powi(exponent);
        let decimals = decimals(step / scale);
        Self {
            label: with_power(label, exponent),
            low,
            high,
            scale: Scale::Linear,
            major: ticks
                .iter()
                .map(|t| (*t, number(t / scale, decimals)))
                .collect(),
            minor: Vec::new(),
        }
    }

    /// A linear axis for whole numbers from 0.
    pub fn counts(label: &str, largest: usize) -> Self {
        let high = largest.max(1) as f64;
        let step = nice_step(high / 6.0).max(1.0);
        let major = multiples(step, 0.0, high);
        Self {
            label: label.to_owned(),
            low: -0.03 * high,
            high: 1.03 * high,
            scale: Scale::Linear,
            major: major.into_iter().map(|t| (t, number(t, 0))).collect(),
            minor: Vec::new(),
        }
    }

    /// A logarithmic axis that covers all positive finite `values`; none if there are none.
    pub fn log(label: &str, values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let (low, high) = range(values.into_iter().filter(|v| *v > 0.0))?;
        let pad = (high / low).powf(0.05).max(1.1);
        let (low, high) = (low / pad, high * pad);
        let decades = (high / low).log10();
        let first = low.log10().floor() as i32;
        let last = high.log10().ceil() as i32;
        let within = |v: &f64| *v >= low && *v <= high;
        let powers = (first..=last).map(|e| 10f64.powi(e));
        let subdivided = powers
            .clone()
            .flat_map(|p| (2..10).map(move |m| p * f64::from(m)));

        let mut axis = Self {
            label: label.to_owned(),
            low,
            high,
            scale: Scale::Log,
            major: Vec::new(),
            // Over many decades only the powers themselves get ticks.
            minor: subdivided.filter(|v| within(v) && decades < 8.0).collect(),
        };
        if decades > 1.7 {
            // At most about seven labels.
            let every = (decades / 7.0).ceil() as i32;
            for e in first..=last {
                let power = 10f64.powi(e);
                if !within(&power) {
                    continue;
                }
                if e.rem_euclid(every) == 0 {
                    axis.major.push((power, format!("10{}", superscript(e))));
                } else {
                    axis.minor.push(power);
                }
            }
        } else if decades > 0.7 {
            for p in powers {
                for m in [1.0, 2.0, 5.0] {
                    if within(&(m * p)) {
                        axis.major.push((m * p, log_number(m, p)));
                    }
                }
            }
        } else {
            // Less than a decade: evenly spaced ticks, as on a linear axis.
            let step = nice_step((high - low) / 4.0);
            let decimals = decimals(step);
            axis.major = multiples(step, low, high)
                .into_iter()
                .map(|t| (t, number(t, decimals)))
                .collect();
            axis.minor.clear();
        }
        Some(axis)
    }

    /// A logarithmic axis for whole numbers from 0: equal steps multiply 1 + number.
    pub fn many_counts(label: &str, largest: usize) -> Self {
        let high = largest.max(1) as f64;
        let decades = (0..=high.log10() as i32).map(|e| 10f64.powi(e));
        let steps: Vec<f64> = decades
            .flat_map(|p| [1.0, 2.0, 5.0].map(|m| m * p))
            .collect();
        // Over many decades the labels of 2 and 5 would touch those of the decades.
        let shown = |t: &f64| high < 2e3 || t.log10().fract() == 0.0;
        let ticks = std::iter::once(0.0).chain(steps.into_iter().filter(shown));
        Self {
            label: label.to_owned(),
            low: (high + 1.0).powf(-0.03) - 1.0,
            high: (high + 1.0).powf(1.03) - 1.0,
            scale: Scale::LogFromZero,
            major: ticks
                .filter(|t| *t <= high)
                .map(|t| (t, number(t, 0)))
                .collect(),
            minor: Vec::new(),
        }
    }

    /// An axis of percentages that shows those close to 100 apart.
    pub fn towards_hundred(label: &str) -> Self {
        let ticks = [0.0, 50.0, 80.0, 90.0, 95.0, 98.0, 99.0, 100.0];
        Self {
            label: label.to_owned(),
            low: -10.0,
            high: 100.15,
            scale: Scale::TowardsHundred,
            major: ticks.into_iter().map(|t| (t, number(t, 0))).collect(),
            minor: vec![10.0, 20.0, 30.0, 40.0, 60.0, 70.0, 85.0, 96.0, 97.0],
        }
    }

    /// Place of a value: 0 at the lower end, 1 at the upper.
    pub fn place(&self, value: f64) -> f64 {
        let [value, low, high] = [value, self.low, self.high].map(|v| self.scale.map(v));
        (value - low) / (high - low)
    }
}

/// Smallest and largest finite value.
pub fn range(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .into_iter()
        .filter(|v| v.is_finite())
        .fold(None, |range, v| match range {
            None => Some((v, v)),
            Some((low, high)) => Some((v.min(low), v.max(high))),
        })
}

/// The smallest of 1, 2, 5 × 10ⁿ that is not below `raw`.
pub fn nice_step(raw: f64) -> f64 {
    let power = 10f64.powi(raw.log10().floor() as i32);
    // The tolerance keeps 0.2 from becoming 0.5 by round-off.
    let step = STEPS.into_iter().find(|s| s * power >= raw * (1.0 - 1e-9));
    step.unwrap_or(10.0) * power
}

/// Multiples of `step` in [low, high].
pub fn multiples(step: f64, low: f64, high: f64) -> Vec<f64> {
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

/// Decimals that a step needs.
pub fn decimals(step: f64) -> usize {
    (-step.log10() - 1e-9).ceil().max(0.0) as usize
}

/// A number with a true minus sign.
pub fn number(value: f64, decimals: usize) -> String {
    crate::report::number::fixed(value, decimals).replace('-', "−")
}

/// 10ⁿ in Unicode, e.g. `⁻³`.
pub fn superscript(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    exponent
        .to_string()
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |d| DIGITS[d as usize]))
        .collect()
}

fn log_number(mantissa: f64, power: f64) -> String {
    let exponent = power.log10().round() as i32;
    match exponent {
        -3..=4 => number(mantissa * power, (-exponent).max(0) as usize),
        _ if mantissa == 1.0 => format!("10{}", superscript(exponent)),
        _ => format!("{mantissa}·10{}", superscript(exponent)),
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
    let power = format!("10{}", superscript(exponent));
    match label.rsplit_once('[') {
        Some((name, "-]")) => format!("{name}[{power}]"),
        Some((name, unit)) => format!("{name}[{power} {unit}"),
        None => format!("{label} [{power}]"),
    }
}

/// Factor and prefixed unit that bring `largest` between 1 and 1000, e.g. 0.004 m gives (1e3, `mm`).
pub fn prefixed(largest: f64, unit: &str) -> (f64, String) {
    const PREFIXES: [(i32, &str); 7] = [
        (-9, "n"),
        (-6, "µ"),
        (-3, "m"),
        (0, ""),
        (3, "k"),
        (6, "M"),
        (9, "G"),
    ];
    if largest == 0.0 || !largest.is_finite() {
        return (1.0, unit.to_owned());
    }
    let wanted = 3 * ((largest.log10() + 1e-9) / 3.0).floor() as i32;
    // Kilometres of displacement would be odd: lengths go down only.
    let highest = if unit == "m" { 0 } else { 9 };
    let exponent = wanted.clamp(-9, highest);
    let prefix = PREFIXES
        .iter()
        .find(|(e, _)| *e == exponent)
        .map_or("", |(_, p)| p);
    (10f64.powi(-exponent), format!("{prefix}{unit}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_ticks_are_round_and_inside() {
        let axis = Axis::linear("force [N]", [0.0, 1.2e9], 5);
        assert_eq!(axis.label, "force [10⁹ N]");
        let labels: Vec<&str> = axis.major.iter().map(|(_, l)| l.as_str()).collect();
        assert_eq!(labels, ["0.0", "0.5", "1.0"]);
        assert_eq!(axis.place(0.0), 0.0);
    }

    #[test]
    fn log_axes_label_decades_or_parts_of_them() {
        let labels = |low, high| -> Vec<String> {
            let axis = Axis::log("e", [low, high]).expect("positive values");
            axis.major.into_iter().map(|(_, l)| l).collect()
        };
        assert_eq!(labels(1e-3, 1.0), ["10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
        assert_eq!(labels(0.2, 2.0), ["0.2", "0.5", "1", "2"]);
        assert!(labels(1e-16, 1.0).len() <= 9);
        assert!(labels(973.0, 1138.0).len() >= 2);
        assert!(Axis::log("e", [0.0, -1.0]).is_none());
    }

    #[test]
    fn units_get_the_prefix_that_fits() {
        assert_eq!(prefixed(0.004, "m").1, "mm");
        assert_eq!(prefixed(52e6, "Pa").1, "MPa");
        assert_eq!(prefixed(12e3, "m").1, "m");
        assert_eq!(prefixed(0.0, "m").0, 1.0);
    }
}
