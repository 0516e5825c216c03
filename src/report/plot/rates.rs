//! Success rates of the robustness study against friction: one panel per dimension, one curve per method.

use super::axis::Axis;
use super::canvas::Width;
use super::chart::{Chart, Panel, Series};
use super::legend::Entry;
use super::style::Style;
use crate::report::ReportError;
use crate::report::number::value;
use crate::report::robustness::RobustnessRow;

/// Part of the distance between two friction coefficients over which the methods stand side by side.
const SPREAD: f64 = 0.7;

/// Success rate of every method at every friction coefficient, with its confidence interval. The friction coefficients
/// stand at equal distances, the methods beside each other, and the scale is stretched towards 100 %: most methods
/// differ there or nowhere.
///
/// # Errors
/// [`ReportError::Figure`] without any rate.
pub fn success_rates(rows: &[RobustnessRow]) -> Result<String, ReportError> {
    let sorted = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let friction = sorted(rows.iter().map(|row| row.friction).collect());
    let mut methods: Vec<&str> = rows.iter().map(|row| row.method.as_str()).collect();
    methods.sort_unstable();
    methods.dedup();
    let mut dims: Vec<usize> = rows.iter().map(|row| row.dimension).collect();
    dims.sort_unstable();
    dims.dedup();
    let rated = |row: &&RobustnessRow| row.success[0].is_finite();
    if !rows.iter().any(|row| rated(&row)) {
        return Err(ReportError::figure("success rates", "no problem was tried"));
    }

    let place = |row: &RobustnessRow, method: usize| {
        let at = friction.partition_point(|mu| *mu < row.friction) as f64;
        let share = (method as f64 + 0.5) / methods.len() as f64 - 0.5;
        at + SPREAD * share
    };
    let panel = |dim: usize| {
        let mut series = Vec::new();
        for (index, method) in methods.iter().enumerate() {
            let style = Style::beside_others(index);
            let mut own: Vec<&RobustnessRow> = (rows.iter())
                .filter(|row| row.dimension == dim && row.method == *method)
                .filter(rated)
                .collect();
            own.sort_by(|a, b| a.friction.total_cmp(&b.friction));
            for row in &own {
                let x = place(row, index);
                series.push(Series {
                    points: vec![[x, 100.0 * row.success[1]], [x, 100.0 * row.success[2]]],
                    style: style.bar(),
                    markers: Vec::new(),
                });
            }
            series.push(Series {
                points: own
                    .iter()
                    .map(|row| [place(row, index), 100.0 * row.success[0]])
                    .collect(),
                style,
                markers: Vec::new(),
            });
        }
        Panel {
            x: Axis::classes(
                "friction coefficient [-]",
                friction.iter().map(|mu| value(*mu)),
            ),
            y: Axis::towards_hundred(&format!("solved in {dim}D [%]")),
            series,
            levels: Vec::new(),
            slope: None,
        }
    };
    let entry = |(index, method): (usize, &&str)| Entry {
        label: (*method).to_owned(),
        style: Style::beside_others(index),
        line: true,
    };
    let most = rows.iter().map(|row| row.problems).max().unwrap_or(0);
    let chart = Chart {
        title: "Success rate against friction coefficient".into(),
        caption: format!("{most} random problems per point, bars: 95 % confidence"),
        width: Width::Page,
        height: 62.0,
        panels: dims.into_iter().map(panel).collect(),
        legend: vec![methods.iter().enumerate().map(entry).collect()],
    };
    chart.svg()
}
