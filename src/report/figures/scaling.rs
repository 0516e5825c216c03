//! How methods grow with the contact unknowns and with friction.

use super::kind::Kind;
use super::runs::distinct;
use crate::report::number::{fixed, significant};
use crate::report::plot::{Axis, Cell, Figure, Guide, HeatMap, Panel, Series, looks, plain};
use crate::report::{Bundle, ReportError};
use crate::studies::analysis::scaling::{
    Quantity, Sample, common_friction, exponent, medians, samples,
};
use crate::studies::record::Record;
use crate::studies::statistics::median;

/// Time.
pub static TIME: Kind = Kind {
    file: "scaling.time.svg",
    question: "Which method still works when there are many contact points?",
    shows: "Time of the methods against the number of contact unknowns on bodies of given sizes, and its part in the whole \
            run from the mesh to the contact forces; medians over the bodies of a size, right answers at tier high alone.",
};

/// Methods by class.
pub static CLASSES: Kind = Kind {
    file: "scaling.classes.svg",
    question: "Which method for which size?",
    shows: "Time of every method over that of the fastest on the same body, the median over the bodies of a size that it \
            solves at tier high, below it how many these are; –: none.",
};

/// Both; `caveat`: what captions say of a sweep that is not complete.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, records: &[Record], caveat: &str) -> Result<(), ReportError> {
    let all = samples(records);
    let Some(common) = common_friction(&all) else {
        return Ok(());
    };
    let own: Vec<Sample> = all
        .iter()
        .copied()
        .filter(|s| s.friction == common)
        .collect();
    let fastest = winners(&own);
    if !own.iter().any(|s| s.time.is_finite()) {
        return Ok(());
    }
    let caption = format!(
        "bodies with cracks all over or right through, N contact unknowns; medians over bodies of one size, right answers at \
         tier high{caveat}"
    );
    TIME.add(bundle, "", time(&own, &fastest, &caption).svg()?)?;
    CLASSES.add(bundle, "", classes(&own, &fastest, caveat).svg()?)
}

/// Dimensions there are samples of.
fn dimensions(all: &[Sample<'_>]) -> Vec<usize> {
    let some = |dim: &usize| all.iter().any(|s| s.dim == *dim);
    [2, 3].into_iter().filter(some).collect()
}

/// A panel over the contact unknowns with a curve for every method.
fn panel(own: &[&Sample<'_>], further: &[&str], vertical: Axis, quantity: Quantity) -> Panel {
    let horizontal = Axis::log("contact unknowns [-]");
    let mut panel = Panel::new(horizontal, vertical, 55.0);
    let groups: Vec<&[&Sample]> = own.chunk_by(|a, b| a.method == b.method).collect();
    let names: Vec<&str> = groups.iter().map(|group| group[0].method).collect();
    for (group, (label, style)) in groups.iter().zip(looks(&names, further)) {
        let points = medians(group, quantity);
        panel.series.push(Series::new(label, style, points));
    }
    panel
}

fn time(all: &[Sample<'_>], fastest: &[&str], caption: &str) -> Figure {
    let seconds: Quantity = |s| s.time;
    let share: Quantity = |s| 100.0 * s.share;
    let mut panels = Vec::new();
    for dim in dimensions(all) {
        let own: Vec<&Sample> = all.iter().filter(|s| s.dim == dim).collect();
        let whole = Axis::log("part in the whole run [%]").through(&[100.0]);
        let panel_of = |axis: Axis, quantity: Quantity| Panel {
            heading: format!("{dim}D"),
            ..panel(&own, fastest, axis, quantity)
        };
        let mut times = panel_of(Axis::log("time of the method [s]"), seconds);
        times.guides = vec![Guide::new(2.0, 1.0, "")];
        panels.extend([times, panel_of(whole, share)]);
    }
    let leaders: Vec<String> = dimensions(all)
        .into_iter()
        .filter_map(|dim| leader(all, dim))
        .collect();
    let title = format!("Least time: {}", leaders.join("; "));
    Figure::new(&title, caption, 2, panels)
}

/// The method that takes least time on the largest bodies of a dimension, of those that solve most of them.
fn leader(all: &[Sample<'_>], dim: usize) -> Option<String> {
    let own = || all.iter().filter(|s| s.dim == dim && s.time.is_finite());
    let largest = own().map(|s| s.points).max()?;
    let there = |name: &str| {
        let own = own().filter(|s| s.points == largest && s.method == name);
        own.map(|s| s.time).collect::<Vec<f64>>()
    };
    let names = distinct(own().filter(|s| s.points == largest).map(|s| s.method));
    let most = names.iter().map(|name| there(name).len()).max()?;
    let (seconds, name) = names
        .into_iter()
        .filter(|name| there(name).len() == most)
        .map(|name| (median(there(name)), name))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let grows = exponent(own().filter(|s| s.method == name), |s| s.time);
    let grows = grows.map_or(String::new(), |a| format!(", as N^{}", fixed(a, 1)));
    let (seconds, name) = (significant(seconds, 2), plain(name));
    Some(format!(
        "{name} on {largest} points in {dim}D ({seconds} s{grows})"
    ))
}

/// Ratio with the full tint.
const WORST: f64 = 100.0;

/// Time of an answer over that of the fastest right one on the same body.
fn behind(own: &Sample<'_>, all: &[Sample<'_>]) -> f64 {
    let same = all.iter().filter(|other| other.body == own.body);
    own.time / same.map(|s| s.time).fold(f64::INFINITY, f64::min)
}

/// Dimensions and sizes there are samples of.
fn sizes(all: &[Sample<'_>]) -> Vec<(usize, usize)> {
    let mut sizes = distinct(all.iter().map(|s| (s.dim, s.points)));
    sizes.sort_unstable();
    sizes
}

/// Ratios of a method on the bodies of a size.
fn ratios(all: &[Sample<'_>], method: &str, size: (usize, usize)) -> Vec<f64> {
    let own = all
        .iter()
        .filter(|s| s.method == method && (s.dim, s.points) == size);
    own.map(|s| behind(s, all)).collect()
}

/// Methods that are fastest on the bodies of some size, in the median.
fn winners<'a>(all: &[Sample<'a>]) -> Vec<&'a str> {
    let names = distinct(all.iter().map(|s| s.method));
    let of_size = sizes(all).into_iter().filter_map(|size| {
        let own = names
            .iter()
            .map(|name| (median(ratios(all, name, size)), *name));
        let own = own.filter(|own| own.0.is_finite());
        own.min_by(|a, b| a.0.total_cmp(&b.0)).map(|best| best.1)
    });
    distinct(of_size)
}

fn classes(all: &[Sample<'_>], fastest: &[&str], caveat: &str) -> HeatMap {
    let columns = sizes(all);
    let names = distinct(all.iter().map(|s| s.method));
    let line = |name: &str| {
        let cell = |size: &(usize, usize)| {
            let own = ratios(all, name, *size);
            let bodies = all.iter().filter(|s| (s.dim, s.points) == *size);
            let given = distinct(bodies.map(|s| s.body)).len();
            match own.len() {
                0 => Cell {
                    tint: f64::NAN,
                    text: "–".into(),
                    below: String::new(),
                },
                count => {
                    let middle = median(own);
                    Cell {
                        tint: (middle.ln() / WORST.ln()).clamp(0.0, 1.0),
                        text: significant(middle, 2),
                        below: format!("{count} of {given}"),
                    }
                }
            }
        };
        (plain(name), columns.iter().map(cell).collect())
    };
    let fastest: Vec<String> = fastest.iter().map(|name| plain(name)).collect();
    HeatMap {
        title: format!("Fastest by size: {}", fastest.join(", ")),
        caption: format!(
            "time of the method over that of the fastest on the same body, median over the bodies of a size that it solves \
             at tier high; below: how many these are of those that some method solves; –: none{caveat}"
        ),
        groups: columns
            .chunk_by(|a, b| a.0 == b.0)
            .map(|own| (format!("{}D, contact points", own[0].0), own.len()))
            .collect(),
        columns: columns
            .iter()
            .map(|(_, points)| points.to_string())
            .collect(),
        rows: names.into_iter().map(line).collect(),
    }
}
