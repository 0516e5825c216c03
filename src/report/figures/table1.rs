//! Table 1 of the founding paper against ours.

use super::runs::friction;
use super::{Bundle, Kind, ReportError};
use crate::report::number::significant;
use crate::report::number::value;
use crate::report::plot::{Axis, Figure, Panel, Series, is_exact, italic, looks};
use crate::run::verdict::Verdict;
use crate::studies::paper::printed_tables::Table1Row;

/// What it is.
pub static KIND: Kind = Kind {
    file: "table1.svg",
    question: "Do we find the numbers that the founding paper prints for its plate?",
    shows: "Relative difference of the computed from the printed vertical reaction of Table 1 by mesh, friction coefficient and \
            method; methods stand side by side about their friction coefficient.",
};

/// Distance of methods on the axis of friction coefficients, which are 1 apart.
const BESIDE: f64 = 0.12;

/// The figure of both meshes.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, rows: &[Table1Row]) -> Result<(), ReportError> {
    let honest = |row: &&Table1Row| row.verdict.as_ref().is_some_and(Verdict::is_honest);
    let known = || {
        rows.iter()
            .filter(honest)
            .filter_map(|row| Some((row, row.relative_difference?)))
    };
    let mut mu: Vec<f64> = known().map(|(row, _)| row.friction).collect();
    mu.sort_by(f64::total_cmp);
    mu.dedup();
    let [mut meshes, mut methods] = [
        |row: &'_ Table1Row| row.mesh.clone(),
        |row: &Table1Row| row.method.clone(),
    ]
    .map(|of| known().map(|(row, _)| of(row)).collect::<Vec<String>>());
    meshes.sort();
    meshes.dedup();
    let mut seen = Vec::new();
    methods.retain(|method| {
        !seen.contains(method) && {
            seen.push(method.clone());
            true
        }
    });
    let labels: Vec<&str> = methods.iter().map(String::as_str).collect();
    let x = Axis::names(
        &format!("friction coefficient {}", italic("μ")),
        mu.iter().map(|mu| value(*mu)),
    );
    let panel = |mesh: &String| {
        let y = Axis::linear("(ours − printed) / printed [%]").through(0.0);
        let mut panel = Panel::new(x.clone(), y, 40.0);
        panel.heading = format!("Mesh {mesh}");
        panel.levels.push(0.0);
        for (place, (label, style)) in looks(&labels, &[]).into_iter().enumerate() {
            let beside = BESIDE * (place as f64 - 0.5 * (labels.len() - 1) as f64);
            let own = known().filter(|(row, _)| row.mesh == *mesh && row.method == labels[place]);
            let point = |(row, difference): (&Table1Row, f64)| {
                [
                    mu.partition_point(|other| *other < row.friction) as f64 + beside,
                    100.0 * difference,
                ]
            };
            let style = crate::report::plot::Style {
                width: 0.0,
                ..style
            };
            panel
                .series
                .push(Series::new(label, style, own.map(point).collect()));
        }
        panel
    };
    let worst = known().filter(|(row, _)| is_exact(&row.method));
    let worst = worst.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let title = worst.map_or("Table 1 of the founding paper against ours".to_owned(), |(row, difference)| {
        let percent = significant(100.0 * difference.abs(), 2);
        format!("Exact methods find the printed reactions of Table 1 to {percent} %, worst on Mesh {} at {}", row.mesh, friction(row.friction))
    });
    let panels: Vec<Panel> = meshes.iter().map(panel).collect();
    let columns = panels.len();
    let caption = "vertical reaction at the top of the plate, printed with four or five digits";
    KIND.add(
        bundle,
        "",
        Figure::new(title, caption, panels).columns(columns).svg()?,
    )
}
