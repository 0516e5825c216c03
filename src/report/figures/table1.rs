//! Table 1 of the founding paper against ours.

use super::kind::Kind;
use super::runs::distinct;
use crate::report::number::{significant, value};
use crate::report::plot::{Axis, Figure, Panel, Series, Style, is_exact, italic, looks};
use crate::report::{Bundle, ReportError};
use crate::run::verdict::Verdict;
use crate::studies::paper::printed_tables::Table1Row;

/// What it is.
pub static KIND: Kind = Kind {
    file: "table1.svg",
    question: "Do we find the numbers that the founding paper prints for its plate?",
    shows: "Relative difference of the computed from the printed vertical reaction of Table 1 by mesh, friction \
            coefficient and method; methods stand side by side about their friction coefficient.",
};

/// Distance of methods on the axis of friction coefficients, which are 1 apart.
const BESIDE: f64 = 0.12;

/// The figure of both meshes.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, rows: &[Table1Row]) -> Result<(), ReportError> {
    let honest = |row: &&Table1Row| row.verdict.as_ref().is_some_and(Verdict::is_honest);
    let honest = rows.iter().filter(honest);
    let known = honest.filter_map(|row| Some((row, 100.0 * row.relative_difference?)));
    let known: Vec<(&Table1Row, f64)> = known.collect();
    let mut mu = distinct(known.iter().map(|(row, _)| row.friction));
    mu.sort_by(f64::total_cmp);
    let methods = distinct(known.iter().map(|(row, _)| row.method.as_str()));
    let names = mu.iter().map(|mu| value(*mu)).collect();
    let x = Axis::names(&format!("friction coefficient {}", italic("μ")), names);
    let mut panels = Vec::new();
    let meshes = distinct(known.iter().map(|(row, _)| &row.mesh));
    for mesh in &meshes {
        let y = Axis::linear("(ours − printed) / printed [%]").through(&[0.0]);
        let mut panel = Panel::new(x.clone(), y, 40.0);
        panel.heading = format!("Mesh {mesh}");
        panel.levels.push(0.0);
        for (index, (label, style)) in looks(&methods, &[]).into_iter().enumerate() {
            let beside = BESIDE * (index as f64 - 0.5 * (methods.len() - 1) as f64);
            let own = |row: &Table1Row| row.mesh == **mesh && row.method == methods[index];
            let own = known.iter().filter(|(row, _)| own(row));
            let place = |row: &Table1Row| mu.partition_point(|mu| *mu < row.friction) as f64;
            let points = own.map(|(row, percent)| [place(row) + beside, *percent]);
            let style = Style {
                width: 0.0,
                ..style
            };
            panel
                .series
                .push(Series::new(label, style, points.collect()));
        }
        panels.push(panel);
    }
    let worst = |mesh: &String| {
        let own = known
            .iter()
            .filter(|(row, _)| is_exact(&row.method) && row.mesh == *mesh);
        let worst = own.map(|(_, percent)| percent.abs()).fold(0.0, f64::max);
        format!("{} % on Mesh {mesh}", significant(worst, 2))
    };
    let worst: Vec<String> = meshes.into_iter().map(worst).collect();
    let title = format!("Exact methods find Table 1 to {}", worst.join(", "));
    let caption = "vertical reaction at the top of the plate, printed with four or five digits";
    KIND.add(bundle, "", Figure::new(&title, caption, 2, panels).svg()?)
}
