//! Curves of many methods in one figure: those that cannot be told apart are drawn once and named in the caption.

use super::agreement::{at_most, difference, groups};
use super::canvas::plain;
use super::methods;
use super::style::Style;

/// Largest difference of a curve that still runs along another one for the most part, as a fraction of the range.
const LIES_ON: f64 = 0.06;

/// What differences in the legend mean.
const SCALE_NOTE: &str = "differences as fractions of the largest value";

/// One curve of a figure.
pub struct MethodCurve {
    /// Index of the run that is drawn.
    pub run: usize,
    pub style: Style,
    /// Look of its line in the legend.
    pub sample: Style,
    pub label: String,
}

/// Curves, and what the caption says about them.
pub struct MethodCurves {
    pub curves: Vec<MethodCurve>,
    /// Methods that a curve stands for.
    pub notes: Vec<String>,
}

/// Curves of runs by `methods`, one each, in the order of the registry: exact methods whose `scaled` values, fractions of
/// the largest, cannot be told apart and which are `alike` share one, in the given look.
pub fn method_curves(
    methods: &[&str],
    scaled: &[Vec<f64>],
    shared_look: &Style,
    alike: impl Fn(usize, usize) -> bool,
) -> MethodCurves {
    let groups = groups(scaled, |run| methods::is_exact(methods[run]), alike);
    let styles = methods::styles(methods);
    let shared = groups[0].members.len() > 1;
    let mut turns = 0;
    let mut found = MethodCurves {
        curves: Vec::new(),
        notes: Vec::new(),
    };
    for (index, group) in groups.iter().enumerate() {
        let first = group.members[0];
        let several = group.members.len() > 1;
        let sample = match index {
            0 if several => shared_look.clone(),
            _ => styles[first].clone(),
        };
        let off = difference(&scaled[0], &scaled[first]);
        // Curves that lie on the shared one take turns; others need no help.
        let style = if shared && index > 0 && off <= LIES_ON {
            turns += 1;
            sample.clone().on_shared(turns - 1)
        } else {
            sample.clone()
        };
        let count = format!("{} exact methods", group.members.len());
        let label = if several {
            let names: Vec<String> = group.members.iter().map(|m| plain(methods[*m])).collect();
            let names = names.join(", ");
            found.notes.push(format!("{count}: {names}, {SCALE_NOTE}"));
            format!("{count}, apart by {}", at_most(group.apart))
        } else if shared && !methods::is_exact(methods[first]) {
            format!("{}, off by {}", plain(methods[first]), at_most(off))
        } else {
            plain(methods[first])
        };
        found.curves.push(MethodCurve {
            run: first,
            style,
            sample,
            label,
        });
    }
    found
}
