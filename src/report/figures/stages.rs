//! Stages of a run as shares of its time.

use super::kind::Kind;
use super::runs::{friction, least, made_with};
use crate::report::names::file_name;
use crate::report::number::{fixed, significant, value};
use crate::report::plot::{Axis, Draw, Figure, Panel, Rgb, Series, Style, plain};
use crate::report::{Bundle, ReportError};
use crate::studies::analysis::{
    body_times, common_tolerance, compare_methods, compare_problems, has_defaults, method_time,
    published_times,
};
use crate::studies::record::{Record, Spent};

/// The kind.
pub static KIND: Kind = Kind {
    file: "stages.*.svg",
    question: "Where does the time of a run go?",
    shows: "Shares of the stages of a run in its total time: on every mesh by the fastest method, and on the finest \
            mesh by every method, at the finest tolerance at which something was solved on every mesh.",
};

/// Stages in the order in which they come, with their tints, no two of one lightness.
const STAGES: [(&str, Rgb); 8] = [
    ("setup", [235, 235, 235]),
    ("assembly", [86, 180, 233]),
    ("factorisation", [0, 114, 178]),
    ("condensation", [240, 228, 66]),
    ("prepare", [213, 94, 0]),
    ("solves with K", [204, 121, 167]),
    ("enforcement", [30, 30, 30]),
    ("output", [255, 255, 255]),
];

/// A figure per case, contact space and friction on several meshes; `caveat`: what the caption says of a sweep that is not
/// complete.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(bundle: &mut Bundle, records: &[Record], caveat: &str) -> Result<(), ReportError> {
    let solved = |r: &&Record| r.found.verdict.is_solved() && has_defaults(&r.asked);
    let timed = records.iter().filter(solved);
    let mut own: Vec<Timed> = timed
        .filter_map(|r| Some((r, published_times(r)?)))
        .collect();
    let problem = |row: &Timed| row.0.asked.problem().without_mesh();
    own.sort_by(|a, b| {
        compare_problems(&problem(a), &problem(b))
            .then(a.0.asked.refine.cmp(&b.0.asked.refine))
            .then_with(|| compare_methods(&a.0.asked.method, &b.0.asked.method))
    });
    let mut names: Vec<String> = Vec::new();
    for group in own.chunk_by(|a, b| problem(a) == problem(b)) {
        let of_mesh = |rows: &[Timed]| rows.iter().map(|r| r.0.asked.tolerance).collect();
        let tolerances: Vec<Vec<f64>> = group.chunk_by(same_mesh).map(of_mesh).collect();
        let tolerance = common_tolerance(&tolerances);
        let mut group = group.to_vec();
        group.retain(|row| Some(row.0.asked.tolerance) == tolerance);
        let Some(cell) = group
            .first()
            .map(|row| &row.0.asked)
            .filter(|_| tolerances.len() > 1)
        else {
            continue;
        };
        let (space, mu) = (cell.space.as_deref().unwrap_or("own"), value(cell.mu()));
        let mut name = file_name(&[&cell.case, space, &format!("mu-{mu}")]);
        if names.contains(&name) {
            name = format!("{name}-{}", names.len());
        }
        names.push(name.clone());
        KIND.add(bundle, &name, figure(&group, records, caveat).svg()?)?;
    }
    Ok(())
}

/// A record with its times.
type Timed<'a> = (&'a Record, &'a Spent);

fn same_mesh(a: &Timed<'_>, b: &Timed<'_>) -> bool {
    a.0.asked.refine == b.0.asked.refine
}

fn figure(group: &[Timed<'_>], records: &[Record], caveat: &str) -> Figure {
    let mut bars = [Vec::new(), Vec::new()];
    for mesh in group.chunk_by(same_mesh) {
        let method = |row: &Timed<'_>| row.0.found.method.clone();
        let best = least(mesh, |row| method_time(row.1).median_s);
        let label = |row: &Timed<'_>| format!("{}, {}", made_with(row.0).0, method(row));
        bars[0].extend(best.map(|row| (label(row), stages(row, records))));
        bars[1] = mesh
            .iter()
            .map(|row| (method(row), stages(row, records)))
            .collect();
    }
    let title = bars[0].last().map_or(String::new(), |(label, stages)| {
        let most = least(0..STAGES.len(), |i| -stages[*i]).unwrap_or(0);
        let share = fixed(100.0 * stages[most] / stages.iter().sum::<f64>(), 0);
        let (stage, label) = (STAGES[most].0, plain(label));
        format!("On the finest mesh, {stage} takes {share} % of the time ({label})")
    });
    let record = group[0].0;
    let (space, mu) = (made_with(record).1, friction(record.asked.mu()));
    let reached = format!(
        "solved to a natural map of {}",
        value(record.asked.tolerance)
    );
    let caption = format!("{}, {space}, {mu}, {reached}{caveat}", record.asked.case);
    let headings = [
        "each mesh, least median of all methods",
        "finest mesh, each method",
    ];
    let panels = headings
        .iter()
        .zip(&bars)
        .map(|(heading, bars)| panel(heading, bars));
    let figure = Figure::new(&title, &caption, 1, panels.collect());
    Figure {
        wide: true,
        ..figure
    }
}

/// Label and seconds of the stages.
type Bar = (String, [f64; 8]);

fn stages((record, spent): &Timed<'_>, records: &[Record]) -> [f64; 8] {
    let own = [spent.setup_s, spent.assembly_s, spent.factorisation_s];
    let [a, b, c] = body_times(record, records).unwrap_or(own);
    let timings = [&spent.prepare, &spent.solve, &spent.enforcement];
    let [d, all, f] = timings.map(|timing| timing.median_s);
    let all = [a, b, c, spent.condensation_s, d, all - f, f, spent.output_s];
    all.map(|seconds| {
        if seconds.is_finite() {
            seconds.max(0.0)
        } else {
            0.0
        }
    })
}

fn panel(heading: &str, bars: &[Bar]) -> Panel {
    let total = |stages: &[f64]| stages.iter().sum::<f64>();
    let label = |(label, stages): &Bar| {
        let seconds = significant(total(stages), 3);
        format!("{}: {seconds} s", plain(label))
    };
    let x = Axis::linear("share of the total time [%]").through(&[0.0, 100.0]);
    let y = Axis::names("", bars.iter().map(label).collect());
    let mut panel = Panel::new(x, y, 0.0);
    panel.heading = heading.to_owned();
    for (stage, (name, tint)) in STAGES.into_iter().enumerate() {
        let share =
            |parts: &[f64], all: &[f64]| 100.0 * total(parts) / total(all).max(f64::MIN_POSITIVE);
        let ends = |(_, all): &Bar| [stage, stage + 1].map(|end| share(&all[..end], all));
        let points = bars
            .iter()
            .enumerate()
            .map(|(row, bar)| [ends(bar)[0], row as f64]);
        let mut series = Series::new(name, Style::line(tint, 0.0, &[]), points.collect());
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
