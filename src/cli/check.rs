//! `stickslip check`: reads and discretises cases, and says what their loads and supports amount to.

use std::path::PathBuf;

use stickslip_xfem::cut::arrangement::Moved;
use stickslip_xfem::enrichment::Zone;
use stickslip_xfem::geometry::{norm, sub};

use super::advice;
use super::error::CliError;
use super::output::say;
use crate::case;
use crate::model::body::{Body, Needs};
use crate::model::cost::{Cost, predicted};
use crate::model::extent::{LoadExtent, SupportExtent, load_extents, support_extents};
use crate::model::loading::Loading;
use crate::model::resolution::too_coarse;
use crate::report::number::significant;
use crate::run::choice::choices;
use crate::studies::axes::friction_values;
use crate::studies::expect;
use crate::studies::measure::RunError;

/// Digits shown, and below which part of the largest entry a sum is rounding.
const DIGITS: usize = 6;
const ROUNDING: f64 = 1e-9;

/// Cracks moved by more than this are told, in shortest edges.
const TOLD: f64 = 1e-9;

/// Arguments of `stickslip check`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Case files
    #[arg(required = true)]
    files: Vec<PathBuf>,
}

/// Checks cases.
pub fn check(Arguments { files }: Arguments) -> Result<bool, CliError> {
    for file in files {
        let case = case::read(&file)?;
        choices(&case, &[])?;
        expect::check(&case)?;
        for &refine in &case.sweep.refine {
            let frictions = friction_values(&case);
            let body = Body::new(&case, refine, &Needs::default()).map_err(RunError::from)?;
            body.check_rank(&case).map_err(RunError::from)?;
            let mut lines = vec![format!(
                "{}: {}, {} cells, {} unknowns, {} contact points ({}), uniform stress to {:.1e}{}{}",
                file.display(),
                body.label,
                body.mesh.cell_count(),
                body.elastic.unknowns(),
                body.points.len(),
                body.space,
                body.checks.uniform,
                radii(&body.enrichment.zones),
                cost(&body, frictions.len() * case.path.increments)
            )];
            let least = TOLD * body.mesh.smallest_edge();
            let far = |moved: &&Moved| norm(&sub(&moved.to, &moved.from)) > least;
            let moved = body.moved.iter().filter(far);
            lines.extend(moved.map(|moved| moved_line(&body, moved)));
            for (index, per_crack) in frictions.iter().enumerate() {
                let friction = per_crack.first().copied().unwrap_or(0.0);
                let loading = Loading::new(&body, &case, friction).map_err(RunError::from)?;
                // Friction decides what the closed form gives, and nothing else of it.
                if index == 0 {
                    let loads = load_extents(&case, &loading).map_err(RunError::from)?;
                    lines.extend(loads.iter().map(load_line));
                }
            }
            let supports = support_extents(&case, &body);
            lines.extend(supports.iter().map(support_line));
            lines.iter().for_each(|line| say(format_args!("{line}")));
            let coarse = too_coarse(&body);
            advice::on_case(&case, coarse.iter().map(|own| (body.label.as_str(), own)));
        }
    }
    Ok(true)
}

/// Radii of the branch functions, from the least to the largest; empty without any.
fn radii(all: &[Zone]) -> String {
    let ramps = || all.iter().map(|zone| zone.radius).filter(|r| *r > 0.0);
    let [least, largest] = [
        ramps().fold(f64::INFINITY, f64::min),
        ramps().fold(0.0, f64::max),
    ];
    match ramps().next() {
        None => String::new(),
        Some(_) if least == largest => format!(", branch functions within {least:.3} m"),
        Some(_) => format!(", branch functions within {least:.3} to {largest:.3} m"),
    }
}

/// `, about 12 s and 4.7 GB by hybrid`.
fn cost(body: &Body, increments: usize) -> String {
    let shown = |cost: Cost| {
        let [seconds, gb] = [cost.seconds, cost.gb].map(|v| significant(v, 2));
        format!(", about {seconds} s and {gb} GB by hybrid")
    };
    predicted(body, increments).map_or_else(String::new, shown)
}

fn moved_line(body: &Body, moved: &Moved) -> String {
    let dim = body.mesh.dim();
    let [from, to] = [&moved.from, &moved.to].map(|x| vector(&body.place(x)[..dim]));
    let by = significant(norm(&sub(&moved.to, &moved.from)), DIGITS);
    let crack = moved.crack + 1;
    match moved.joined {
        true => format!(
            "    crack {crack}: its end at {from} m is joined with what it nearly touches, at {to} m, {by} m away"
        ),
        false => format!(
            "    crack {crack}: runs through what it nearly touches, at {to} m instead of {from} m, {by} m away"
        ),
    }
}

fn load_line(load: &LoadExtent) -> String {
    let unit = if load.force.len() == 2 { "N/m" } else { "N" };
    let (number, what) = (load.number, &load.what);
    let (force, on) = (vector(&load.force), measured(load.measure, load.power));
    format!("    load {number}, {what}: {force} {unit} over {on}")
}

fn support_line(support: &SupportExtent) -> String {
    let (number, on) = (support.number, &support.on);
    let [from, to] = support.ends.each_ref().map(|end| vector(end));
    let nodes = match support.nodes {
        1 => format!("1 node at {from} m"),
        n => format!("{n} nodes from {from} to {to} m"),
    };
    match support.power {
        0 => format!("    support {number} on {on}: {nodes}"),
        power => format!(
            "    support {number} on {on}: {nodes}, {} held",
            measured(support.measure, power)
        ),
    }
}

/// `(0, -330000)`.
fn vector(values: &[f64]) -> String {
    let size = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let shown = |v: &f64| significant(if v.abs() < ROUNDING * size { 0.0 } else { *v }, DIGITS);
    format!(
        "({})",
        values.iter().map(shown).collect::<Vec<_>>().join(", ")
    )
}

/// `0.33 m`.
fn measured(value: f64, power: usize) -> String {
    let unit = ["", "m", "m²", "m³"][power.min(3)];
    format!("{} {unit}", significant(value, DIGITS))
}
