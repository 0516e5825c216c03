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
    /// Finding of the curves, as a sentence.
    pub title: String,
}

/// Compares runs given by their methods and their values divided by the largest one. `alike`: whether two runs may share
/// the band.
pub fn agreement(
    methods: &[&str],
    scaled: &[Vec<f64>],
    alike: impl Fn(usize, usize) -> bool,
) -> Agreement {
    let first = methods.iter().position(|method| is_exact(method));
    let first = first.unwrap_or(0);
    let off = |i: usize| difference(&scaled[first], &scaled[i]);
    let on_band = |i: &usize| off(*i) <= INVISIBLE && alike(first, *i);
    let (band, mut apart): (Vec<usize>, Vec<usize>) = (0..methods.len()).partition(on_band);
    let (exact, own): (Vec<usize>, Vec<usize>) = band.iter().partition(|i| is_exact(methods[**i]));
    let within = |runs: &[usize]| at_most(runs.iter().map(|i| off(*i)).fold(0.0, f64::max));
    let mut title = match &exact[..] {
        [] | [_] => plain(methods[first]),
        all => format!(
            "{} agree to {}",
            counted(all.len(), "exact method"),
            within(all)
        ),
    };
    let mut label = title.clone();
    match &own[..] {
        [one] if *one != first => {
            label += &format!(", {} within {}", plain(methods[*one]), within(&own));
        }
        [_, _, ..] => label += &format!(", {} approximate within {}", own.len(), within(&own)),
        _ => {}
    }
    let style = match band.len() {
        1 => Style::of_method(methods[first], 0).bare(),
        _ => Style::band(),
    };
    let mut curves = vec![(first, label, style)];
    apart.sort_by(|a, b| off(*b).total_cmp(&off(*a)));
    if let Some(worst) = apart.first() {
        let percent = 100.0 * off(*worst);
        title += &if percent.is_finite() {
            format!(
                "; {} is off by up to {} %",
                plain(methods[*worst]),
                significant(percent, 2)
            )
        } else {
            format!("; {} cannot be compared", plain(methods[*worst]))
        };
    }
    let labels: Vec<&str> = apart.iter().map(|i| methods[*i]).collect();
    let found = looks(&labels, &labels[..labels.len().min(FEW)]);
    // Markers tell other things here.
    let apart = apart.into_iter().zip(found);
    curves.extend(apart.map(|(run, (label, style))| (run, label, style.bare())));
    Agreement { curves, title }
}

/// Largest difference at a point; infinite where the curves have different points or a value is not a number.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(x, y)| (x - y).abs());
    let number = |d: f64| if d.is_nan() { f64::INFINITY } else { d };
    let largest = differences.map(number).fold(0.0, f64::max);
    if a.len() == b.len() {
        largest
    } else {
        f64::INFINITY
    }
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
        let scaled = [0.0, 3.2e-10, 0.0, 5e-5, 0.2, f64::NAN].map(curve);
        // The third slips where the first sticks.
        let found = agreement(&methods, &scaled, |a, b| (a == 2) == (b == 2));
        let band = "2 exact methods agree to 4e-10, penalty within 5e-5";
        assert_eq!(found.curves[0].1, band);
        let mut others: Vec<&str> = found.curves[1..].iter().map(|c| c.1.as_str()).collect();
        others.sort_unstable();
        assert_eq!(others, ["barrier", "nitsche", "nsgs"]);
        assert_eq!(
            at_most(2e-16),
            "1e-12",
            "round-off differs between machines"
        );
    }
}
