//! Stages of a run as shares of its time.

use super::runs::friction;
use super::{Bundle, Kind, ReportError};
use crate::report::number::{fixed, significant, value};
use crate::report::plot::{Axis, Draw, Figure, Panel, Rgb, Series, Style, plain};
use crate::report::standard::file_name;
use crate::run::verdict::Verdict;
use crate::studies::sweep::analysis::{
    body_times, common_tolerance, compare_methods, compare_problems, has_defaults, method_time,
    published_times,
};
use crate::studies::sweep::record::{Record, Spent};

/// What it is.
pub static KIND: Kind = Kind {
    file: "stages.*.svg",
    question: "Where does the time of a run go?",
    shows: "Shares of the stages of a run in its total time: on every mesh by the fastest method, and on the finest mesh by every method, \
            at the finest tolerance at which something was solved on every mesh.",
};

/// Stages in the order in which they come, with their tints: neighbours differ in lightness.
const STAGES: [(&str, Rgb); 7] = [
    ("setup", [235, 235, 235]),
    ("assembly", [86, 180, 233]),
    ("factorisation", [0, 90, 150]),
    ("condensation", [240, 228, 66]),
    ("prepare", [150, 60, 0]),
    ("solve", [230, 159, 0]),
    ("output", [255, 255, 255]),
];

/// A figure per case, contact space and friction on several meshes; `caveat`: what the caption says of a sweep that is not
/// complete.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, records: &[Record], caveat: &str) -> Result<(), ReportError> {
    let solved =
        |record: &Record| record.found.verdict == Verdict::Solved && has_defaults(&record.cell);
    let timed = records.iter().filter(|record| solved(record));
    let mut own: Vec<(&Record, &Spent)> = timed
        .filter_map(|r| Some((r, published_times(r)?)))
        .collect();
    let problem = |row: &(&Record, &Spent)| row.0.cell.problem().without_mesh();
    own.sort_by(|a, b| {
        compare_problems(&problem(a), &problem(b))
            .then(a.0.cell.refine.cmp(&b.0.cell.refine))
            .then_with(|| compare_methods(&a.0.cell.method, &b.0.cell.method))
    });
    let mut names: Vec<String> = Vec::new();
    for group in own.chunk_by(|a, b| problem(a) == problem(b)) {
        let meshes: Vec<&[(&Record, &Spent)]> = group
            .chunk_by(|a, b| a.0.cell.refine == b.0.cell.refine)
            .collect();
        if meshes.len() < 2 {
            continue;
        }
        let tolerances =
            |rows: &&[(&Record, &Spent)]| rows.iter().map(|r| r.0.cell.tolerance).collect();
        let tolerance = common_tolerance(&meshes.iter().map(tolerances).collect::<Vec<_>>());
        let mut group = group.to_vec();
        group.retain(|row| Some(row.0.cell.tolerance) == tolerance);
        let Some((first, _)) = group.first() else {
            continue;
        };
        let space = first.cell.space.as_deref().unwrap_or("own");
        let mut name = file_name(&[
            &first.cell.case,
            space,
            &format!("mu-{}", value(first.cell.mu())),
        ]);
        if names.contains(&name) {
            name = format!("{name}-{}", names.len());
        }
        names.push(name.clone());
        KIND.add(bundle, &name, figure(&group, records, caveat).svg()?)?;
    }
    Ok(())
}

fn figure(group: &[(&Record, &Spent)], records: &[Record], caveat: &str) -> Figure {
    let median = |row: &&(&Record, &Spent)| method_time(row.1).median_s;
    let mut fastest = Vec::new();
    let mut last = None;
    for mesh in group.chunk_by(|a, b| a.0.cell.refine == b.0.cell.refine) {
        let best = mesh.iter().min_by(|a, b| median(a).total_cmp(&median(b)));
        fastest.extend(best.map(|row| {
            let mesh = row
                .0
                .found
                .problem
                .as_ref()
                .map_or("?", |p| p.mesh.as_str());
            (
                format!("{mesh}, {}", row.0.found.method),
                stages(row, records),
            )
        }));
        last = Some(mesh);
    }
    let finest = last.unwrap_or_default().iter();
    let finest: Vec<Bar> = finest
        .map(|row| (row.0.found.method.clone(), stages(row, records)))
        .collect();
    let title = fastest.last().map_or(String::new(), |(label, stages)| {
        let total: f64 = stages.iter().sum();
        let most = (0..STAGES.len())
            .max_by(|a, b| stages[*a].total_cmp(&stages[*b]))
            .unwrap_or(0);
        format!(
            "{} takes {} % of the time on the finest mesh ({})",
            STAGES[most].0,
            fixed(100.0 * stages[most] / total, 0),
            plain(label)
        )
    });
    let (first, size) = (group[0].0, group[0].0.found.problem.as_ref());
    let caption = format!(
        "{}, {}, {}, solved to a natural map of {}{caveat}",
        first.cell.case,
        size.map_or("", |p| p.space.as_str()),
        friction(first.cell.mu()),
        value(first.cell.tolerance),
    );
    let panels = vec![
        panel("each mesh, least median of all methods", &fastest),
        panel("finest mesh, each method", &finest),
    ];
    Figure {
        wide: true,
        ..Figure::new(title, caption, panels)
    }
}

/// Label and seconds of the stages.
type Bar = (String, [f64; 7]);

fn stages((record, spent): &(&Record, &Spent), records: &[Record]) -> [f64; 7] {
    let [setup, assembly, factorisation] = body_times(record, records).unwrap_or([
        spent.setup_s,
        spent.assembly_s,
        spent.factorisation_s,
    ]);
    let own = [
        spent.condensation_s,
        spent.prepare.median_s,
        spent.solve.median_s,
        spent.output_s,
    ];
    let all = [
        setup,
        assembly,
        factorisation,
        own[0],
        own[1],
        own[2],
        own[3],
    ];
    all.map(|seconds| {
        if seconds.is_finite() {
            seconds.max(0.0)
        } else {
            0.0
        }
    })
}

fn panel(heading: &str, bars: &[Bar]) -> Panel {
    let label = |(label, stages): &Bar| {
        format!(
            "{}: {} s",
            plain(label),
            significant(stages.iter().sum(), 3)
        )
    };
    // Labels of their own: the rows of the two panels are not the same.
    let y = Axis::names("", bars.iter().map(label));
    let mut panel = Panel::new(Axis::linear("share of the total time [%]"), y, 0.0);
    panel.heading = heading.to_owned();
    for (stage, (name, tint)) in STAGES.into_iter().enumerate() {
        let ends = |(_, stages): &Bar| {
            let total = stages.iter().sum::<f64>().max(f64::MIN_POSITIVE);
            let before: f64 = stages[..stage].iter().sum();
            [
                100.0 * before / total,
                100.0 * (before + stages[stage]) / total,
            ]
        };
        let rows = bars.iter().enumerate();
        let points = rows.map(|(row, bar)| [ends(bar)[0], row as f64]).collect();
        let mut series = Series::new(name, Style::line(tint, 0.0, &[]), points);
        series.draw = Draw::Bars;
        series.intervals = bars.iter().map(ends).collect();
        series.texts = series
            .intervals
            .iter()
            .map(|[a, b]| fixed(b - a, 0))
            .collect();
        panel.series.push(series);
    }
    panel
}
