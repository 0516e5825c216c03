//! Errors under refinement against the number of unknowns, a panel per place and enrichment of the tips.

use super::kind::Kind;
use super::quantity_name;
use super::runs::{distinct, friction};
use crate::case::ContactSpace;
use crate::report::number::{fixed, significant, value};
use crate::report::plot::{Axis, Figure, Guide, Panel, Series, Style, italic};
use crate::report::standard::file_name;
use crate::report::{Bundle, ReportError};
use crate::studies::convergence::orders::{self, ErrorRow, OrderRow, ROUND_OFF};
use std::collections::BTreeMap;

/// What it is.
pub static KIND: Kind = Kind {
    file: "*.error.svg",
    question: "How fast does this quantity converge under refinement, with which contact space and enrichment?",
    shows: "Error of a quantity against the number of unknowns, a curve per contact space with its observed order \
            in h over the last two halvings, a panel per place and enrichment of the tips; dots and triangle have \
            the order of theory, or order 1 where it is silent. Errors are those against a closed form, or relative \
            to the extrapolated limit or the finest mesh.",
};

/// Panels of one figure; with more of them each place has a figure of its own.
const PANELS: usize = 6;
/// Errors against a closed form that stay below on all meshes are those of the method, which stops at a residual of 1e-9,
/// and of rounding: they have no order and would stretch the axis.
const TOLERANCE: f64 = 1e-9;

/// One figure per case, method, friction coefficient and quantity.
///
/// # Errors
/// Those of drawing and of [`Bundle::add`].
pub fn add(
    bundle: &mut Bundle,
    errors: &[ErrorRow],
    orders: &[OrderRow],
) -> Result<(), ReportError> {
    let mut figures: BTreeMap<(String, String), Vec<&OrderRow>> = BTreeMap::new();
    for row in orders {
        let variant = &row.variant;
        let mu = format!("mu-{}", value(variant.friction));
        let stem = |what: &str| file_name(&[&variant.case, &variant.method, &mu, what]);
        let own = format!("{} {}", row.quantity, row.at);
        // Cracks, tips and points of a front are compared with each other, components of a reaction are not.
        let what = if row.at.starts_with("crack-") {
            &row.quantity
        } else {
            own.trim()
        };
        figures
            .entry((stem(what), stem(own.trim())))
            .or_default()
            .push(row);
    }
    let figures: Vec<((String, String), Vec<&OrderRow>)> = figures.into_iter().collect();
    for places in figures.chunk_by(|a, b| a.0.0 == b.0.0) {
        let mut all: Vec<&OrderRow> = places.iter().flat_map(|(_, rows)| rows).copied().collect();
        all.sort_by_key(|row| {
            let (at, tip) = panel_key(row);
            (at, tip_rank(tip), tip, look(&row.variant.space))
        });
        if all.chunk_by(|a, b| panel_key(a) == panel_key(b)).count() <= PANELS {
            let name = if places.len() > 1 {
                &places[0].0.0
            } else {
                &places[0].0.1
            };
            KIND.add(bundle, name, figure(&all, errors).svg()?)?;
            continue;
        }
        for ((_, name), rows) in places {
            let at = |row: &&&OrderRow| rows.iter().any(|own| std::ptr::eq(*own, **row));
            let own: Vec<&OrderRow> = all.iter().filter(at).copied().collect();
            KIND.add(bundle, name, figure(&own, errors).svg()?)?;
        }
    }
    Ok(())
}

/// Place and enrichment.
fn panel_key(row: &OrderRow) -> (&str, &str) {
    (&row.at, &row.variant.tip)
}

/// Rows of one case, method, friction coefficient and quantity, by panel.
fn figure(rows: &[&OrderRow], errors: &[ErrorRow]) -> Figure {
    let first = rows[0];
    let one_place = rows.iter().all(|row| row.at == first.at);
    let exact = rows.iter().all(|row| row.kind == orders::Kind::Exact);
    let what = quantity_name::name(&first.quantity, if one_place { &first.at } else { "" });
    let power = if first.dim == 2 { "h⁻²" } else { "h⁻³" };
    let x = Axis::log(&format!("unknowns {} ∝ {power}", italic("N")));
    let y = Axis::log(&format!(
        "{}: {what}",
        if exact { "error" } else { "relative error" }
    ));
    let panel = |own: &[&OrderRow]| {
        let mut panel = Panel::new(x.clone(), y.clone(), 48.0);
        let place = (!one_place).then(|| quantity_name::place(&own[0].at));
        let heading: Vec<String> = place
            .into_iter()
            .chain(tip_name(&own[0].variant.tip))
            .collect();
        panel.heading = heading.join("; ");
        panel.series = own.iter().map(|row| curve(row, errors)).collect();
        let mut theory: Vec<f64> = own.iter().filter_map(|row| row.theory).collect();
        theory.sort_by(f64::total_cmp);
        theory.dedup();
        let guide = |order: f64, label| Guide {
            rise: -order,
            run: first.dim as f64,
            label,
        };
        panel.guides = theory
            .iter()
            .map(|p| guide(*p, format!("theory: {}", value(*p))))
            .collect();
        if theory.is_empty() {
            panel.guides.push(guide(1.0, String::new()));
        }
        panel
    };
    let panels: Vec<Panel> = rows
        .chunk_by(|a, b| panel_key(a) == panel_key(b))
        .map(panel)
        .collect();
    let known = rows
        .iter()
        .filter(|row| row.order.is_finite() && !is_exact(&measured(row, errors)));
    let mut known: Vec<&&OrderRow> = known.collect();
    known.sort_by(|a, b| a.order.total_cmp(&b.order));
    let told = |row: &OrderRow| format!("{} ({})", number(row.order), row.variant.space);
    let title = match known[..] {
        [] => format!("{what} under refinement"),
        [one] => format!("{what}: order {}", told(one)),
        [least, .., best] => format!("{what}: orders from {} to {}", told(least), told(best)),
    };
    let variant = &first.variant;
    let mut caption = format!(
        "{}, {}, {}; observed orders in h over the last two halvings",
        variant.case,
        variant.method,
        friction(variant.friction)
    );
    if rows.iter().any(|row| is_exact(&measured(row, errors))) {
        caption += &format!("; exact: error below {}", value(TOLERANCE));
    }
    let tips = distinct(rows.iter().map(|row| &row.variant.tip)).len();
    let columns = if tips > 1 { tips } else { panels.len() }.min(3);
    let own_legends = true;
    let figure = Figure::new(&title, &caption, columns, panels);
    Figure {
        own_legends,
        ..figure
    }
}

fn number(order: f64) -> String {
    fixed(order, 2).replace('-', "−")
}

/// The errors of a sequence that are no round-off.
fn curve(order: &OrderRow, errors: &[ErrorRow]) -> Series {
    let own = measured(order, errors);
    let exact = is_exact(&own);
    let found = match order.kind {
        _ if exact => "exact".to_owned(),
        _ if order.order.is_finite() => number(order.order),
        orders::Kind::Finest => "no power law".to_owned(),
        _ if order.error < ROUND_OFF => "exact on the finest mesh".to_owned(),
        _ => "–".to_owned(),
    };
    let space = &order.variant.space;
    let shown = own.iter().filter(|row| !exact && row.error >= ROUND_OFF);
    let points = shown.map(|row| [row.dofs as f64, row.error]).collect();
    Series::new(
        format!("{space}: {found}"),
        Style::curve(look(space)),
        points,
    )
}

/// The meshes of a sequence that have an error.
fn measured<'a>(order: &OrderRow, errors: &'a [ErrorRow]) -> Vec<&'a ErrorRow> {
    let of = |row: &&ErrorRow| {
        row.variant == order.variant && (&row.quantity, &row.at) == (&order.quantity, &order.at)
    };
    let mut own: Vec<&ErrorRow> = errors
        .iter()
        .filter(of)
        .filter(|row| row.error.is_finite())
        .collect();
    own.sort_by_key(|row| row.refine);
    own
}

/// Whether no mesh has an error above the tolerance of the runs.
fn is_exact(rows: &[&ErrorRow]) -> bool {
    let below = |row: &&ErrorRow| row.kind == Some(orders::Kind::Exact) && row.error < TOLERANCE;
    !rows.is_empty() && rows.iter().all(below)
}

/// Contact spaces look the same in every figure; with its marks a space is still that space.
fn look(space: &str) -> usize {
    let own = ContactSpace::stable_first()
        .into_iter()
        .position(|own| space.starts_with(own.name()));
    own.unwrap_or(ContactSpace::ALL.len())
}

/// Enrichments in the order of what they add.
fn tip_rank(tip: &str) -> usize {
    let known = ["no-tips", "none", "branch"];
    known.iter().position(|k| *k == tip).unwrap_or(known.len())
}

/// An enrichment in words; none where no crack ends inside the body.
fn tip_name(tip: &str) -> Option<String> {
    let one = |tip: &str| match tip {
        "none" => "tips not enriched".to_owned(),
        "branch" => "tip cells enriched".to_owned(),
        radius => {
            let metres = radius
                .parse()
                .map_or_else(|_| radius.to_owned(), |r: f64| significant(r, 3));
            format!("tips enriched within {} = {metres} m", italic("r"))
        }
    };
    (tip != "no-tips").then(|| tip.split('+').map(one).collect::<Vec<_>>().join(", "))
}
