//! One parameter at a time: the safe windows of the options of methods, and iterations over the parameters of a scene.

use super::kind::Kind;
use crate::report::number::value;
use crate::report::plot::{
    Axis, Cell, Figure, HeatMap, Panel, Series, is_exact, italic, looks, plain, rank,
};
use crate::report::{Bundle, ReportError};
use crate::studies::stress::finding::Finding;
use crate::studies::stress::rungs::{Curve, OptionRow, curves, of_options};

/// The options.
pub static OPTIONS: Kind = Kind {
    file: "stress_options.svg",
    question: "How wrong may a parameter of a method be?",
    shows: "Iterations of a method with one of its options changed, from a 10 000th to 10 000 times its default; –: it did \
            not do what it is for; grey: not allowed.",
};

/// The parameters of scenes.
pub static ITERATIONS: Kind = Kind {
    file: "stress_iterations.svg",
    question: "Which methods slow down near incompressibility, at large friction, on finer or slender cells?",
    shows: "Iterations of every exact method on a sheared plate against one parameter; where a line ends or has a gap the \
            method did not solve the scene.",
};

/// Ladders with a panel: name, label of the x axis, and what values are taken off from; 0: shown as they are.
const PANELS: [(&str, &str, f64); 4] = [
    ("Poisson's ratio", "½ − ν [-]", 0.5),
    ("friction", "μ [-]", 0.0),
    ("finer mesh", "cells along x [-]", 0.0),
    ("slender cells", "height/width of the body [-]", 0.0),
];

/// Both figures.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, findings: &[Finding]) -> Result<(), ReportError> {
    OPTIONS.add(bundle, "", options(&of_options(findings))?)?;
    ITERATIONS.add(bundle, "", iterations(&curves(findings))?)
}

fn options(rows: &[OptionRow]) -> Result<Option<String>, ReportError> {
    let factors: Vec<f64> = (-4..=4).map(|k| 10f64.powi(k)).collect();
    let cell = |row: &OptionRow, factor: f64| {
        let at = |v: f64| (v / row.default / factor - 1.0).abs() < 1e-6;
        let (tint, text) = match row.steps.iter().find(|(v, _)| at(*v)) {
            None => (f64::NAN, String::new()),
            Some((_, None)) => (1.0, "–".into()),
            Some((_, Some(n))) => {
                let times = *n as f64 / row.iterations.max(1) as f64;
                (times.log10() / 3.0, n.to_string())
            }
        };
        let below = String::new();
        Cell { tint, text, below }
    };
    let mut sorted: Vec<&OptionRow> = rows.iter().collect();
    sorted.sort_by_key(|w| (rank(w.method), w.method));
    let lines = sorted.iter().map(|window| {
        let cells = factors.iter().map(|&factor| cell(window, factor));
        let sign = if is_exact(window.method) { "" } else { "≈ " };
        let name = format!(
            "{sign}{} {} = {}",
            plain(window.method),
            plain(window.option),
            value(window.default)
        );
        (name, cells.collect())
    });
    let lost = |w: &&OptionRow| w.steps.iter().any(|s| s.1.is_none());
    let narrow: Vec<String> = rows.iter().filter(lost).map(|w| plain(w.method)).collect();
    let title = match narrow.is_empty() {
        true => "No option that is off by four decades costs a method its answer".to_owned(),
        false => format!(
            "Options of {} have a window; the others may be off by decades",
            narrow.join(", ")
        ),
    };
    HeatMap {
        title,
        caption: "iterations with an option at a multiple of its default (behind its name); –: lost; grey: not allowed".into(),
        groups: Vec::new(),
        columns: factors.iter().map(|f| format!("{}×", value(*f))).collect(),
        rows: lines.collect(),
    }
    .svg()
}

fn iterations(curves: &[Curve]) -> Result<Option<String>, ReportError> {
    let mut names: Vec<&str> = curves
        .iter()
        .map(|c| c.method.as_str())
        .filter(|m| is_exact(m))
        .collect();
    names.sort_by_key(|name| (rank(name), *name));
    names.dedup();
    let looks = looks(&names, &[]);
    let mut panels = Vec::new();
    for (ladder, label, from) in PANELS {
        let y = Axis::log("iterations [-]");
        let mut panel = Panel::new(Axis::log(label), y, 42.0);
        panel.heading = ladder.to_owned();
        for (name, (label, style)) in names.iter().zip(&looks) {
            let own = curves
                .iter()
                .find(|c| c.ladder == ladder && c.method == *name);
            let Some(own) = own else { continue };
            let x = |v: f64| if from > 0.0 { from - v } else { v };
            // What has no place on the axes leaves a gap.
            let points = own
                .steps
                .iter()
                .map(|(v, n)| [x(*v), n.map_or(f64::NAN, |n| n.max(1) as f64)]);
            panel
                .series
                .push(Series::new(label.clone(), style.clone(), points.collect()));
        }
        if !panel.series.is_empty() {
            panels.push(panel);
        }
    }
    let caption = format!(
        "sheared plate of 33 × 25 cells with two cracks, {} = 0.3, {} = 0.3, one of these changed; no marker: not solved",
        italic("μ"),
        italic("ν")
    );
    let title = "Iterations of the exact methods against one parameter";
    Figure::new(title, &caption, 4, panels).svg()
}
