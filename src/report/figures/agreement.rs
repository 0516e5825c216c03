//! Curves of many methods over common points: what agrees is one labelled band, the rest stands out by how far it is off.

use super::runs::counted;
use crate::report::number::{RESIDUAL_FLOOR, significant};
use crate::report::plot::{Style, is_exact, looks, plain};

/// Difference that no picture shows, as a fraction of the largest value: a panel is about 600 pixels high.
const INVISIBLE: f64 = 1e-3;
/// Curves that are off and get a look of their own.
const FEW: usize = 4;

/// Methods as curves.
pub struct Agreement {
    /// Runs to draw with label and look, the band first.
    pub curves: Vec<(usize, String, Style)>,
    /// What the curves say, as a sentence.
    pub title: String,
    /// Who is meant.
    pub caption: String,
}

/// Compares runs given by their methods and their values divided by the largest one. `alike`: whether two runs may share
/// the band.
pub fn agreement(
    methods: &[&str],
    scaled: &[Vec<f64>],
    alike: impl Fn(usize, usize) -> bool,
) -> Agreement {
    let reference = methods
        .iter()
        .position(|method| is_exact(method))
        .unwrap_or(0);
    let off: Vec<f64> = scaled
        .iter()
        .map(|values| difference(&scaled[reference], values))
        .collect();
    let on_band = |i: &usize| off[*i] <= INVISIBLE && alike(reference, *i);
    let (band, mut apart): (Vec<usize>, Vec<usize>) = (0..methods.len()).partition(on_band);
    let names = |runs: &[usize]| {
        runs.iter()
            .map(|i| plain(methods[*i]))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let (exact, own): (Vec<usize>, Vec<usize>) = band.iter().partition(|i| is_exact(methods[**i]));
    let largest = |runs: &[usize]| runs.iter().map(|i| off[*i]).fold(0.0, f64::max);
    let mut told = Vec::new();
    let (mut title, mut caption) = (plain(methods[reference]), Vec::new());
    if exact.len() > 1 {
        title = format!(
            "{} agree to {}",
            counted(exact.len(), "exact method"),
            at_most(largest(&exact))
        );
        told.push(title.clone());
        caption.push(format!("exact: {}", names(&exact)));
    }
    if !own.is_empty() {
        let who = if own.len() == 1 {
            names(&own)
        } else {
            format!("{} approximate ones", own.len())
        };
        told.push(format!(
            "{who} {}within {}",
            if exact.is_empty() { "" } else { "follow " },
            at_most(largest(&own))
        ));
        if own.len() > 1 {
            caption.push(format!("approximate: {}", names(&own)));
        }
    }
    let style = if band.len() > 1 {
        Style::band()
    } else {
        Style::of_method(methods[reference])
    };
    let label = if told.is_empty() {
        title.clone()
    } else {
        told.join(", ")
    };
    let mut curves = vec![(reference, label, style)];
    apart.sort_by(|a, b| off[*b].total_cmp(&off[*a]));
    let labels: Vec<&str> = apart.iter().map(|i| methods[*i]).collect();
    let found = looks(&labels, &labels[..labels.len().min(FEW)]);
    if let Some(first) = apart.first() {
        let percent = 100.0 * off[*first];
        let much = if percent.is_finite() {
            format!("up to {} %", significant(percent, 2))
        } else {
            "other points".into()
        };
        title += &format!("; {} is off by {much}", plain(methods[*first]));
    }
    for (run, (label, style)) in apart.into_iter().zip(found) {
        // Markers tell the contact status here.
        curves.push((
            run,
            label,
            Style {
                marker: None,
                ..style
            },
        ));
    }
    if !caption.is_empty() {
        caption.push("differences as fractions of the largest value".into());
    }
    Agreement {
        curves,
        title,
        caption: caption.join("; "),
    }
}

/// Largest difference at a point; infinite where the curves have different points or a value is not a number.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    if a.len() != b.len() {
        return f64::INFINITY;
    }
    let differences = a.iter().zip(b).map(|(x, y)| (x - y).abs());
    differences.fold(
        0.0,
        |m, d| if d.is_nan() { f64::INFINITY } else { d.max(m) },
    )
}

/// A difference in words: one digit, rounded up, and no round-off, which would differ between machines.
fn at_most(difference: f64) -> String {
    if difference < RESIDUAL_FLOOR {
        return significant(RESIDUAL_FLOOR, 1);
    }
    let power = 10f64.powi(difference.log10().floor() as i32);
    significant((difference / power - 1e-9).ceil() * power, 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_agrees_is_one_band_and_nothing_is_hidden() {
        let curve = |off: f64| vec![0.0, 1.0 + off];
        let methods = [
            "b-newton", "hybrid", "nsgs", "penalty", "barrier", "nitsche",
        ];
        let scaled = [0.0, 4e-10, 0.0, 5e-5, 0.2, f64::NAN].map(curve);
        // The third slips where the first sticks.
        let found = agreement(&methods, &scaled, |a, b| (a == 2) == (b == 2));
        let runs: Vec<usize> = found.curves.iter().map(|c| c.0).collect();
        assert_eq!((runs[0], runs.len()), (0, 4), "a band and three others");
        let band = &found.curves[0].1;
        assert!(
            band.starts_with("2 exact methods agree to ")
                && band.contains("penalty follow within "),
            "{band}"
        );
        assert!(
            found.caption.contains("exact: b-newton, hybrid"),
            "{}",
            found.caption
        );
    }

    #[test]
    fn differences_are_rounded_up() {
        assert_eq!(
            [3.2e-10, 3e-10, 9.7e-4, 2e-16].map(at_most),
            ["4e-10", "3e-10", "0.001", "1e-12"]
        );
    }
}
