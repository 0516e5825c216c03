//! Errors under refinement against the number of unknowns, a panel per place and enrichment of the tips.

use super::kind::Kind;
use super::quantity_name;
use super::runs::{distinct, friction};
use crate::case::ContactSpace;
use crate::report::names::file_name;
use crate::report::number::{fixed, significant, value};
use crate::report::plot::{Axis, Figure, Guide, Panel, Series, Style, italic};
use crate::report::{Bundle, ReportError};
use crate::studies::convergence::orders::{self, ErrorRow, OrderRow, ROUND_OFF};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// The kind.
pub static KIND: Kind = Kind {
    file: "*.error.svg",
    question: "How fast does this quantity converge under refinement, with which contact space and enrichment?",
    shows: "Error of a quantity against the number of unknowns, a curve per contact space with its observed order \
            in h over the last two halvings, a panel per place and enrichment of the tips; dots and triangle have \
            the order of theory, or order 1 where it is silent. Errors are those against a closed form, or relative \
            to the finest mesh.",
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
    let mut figures: BTreeMap<String, Vec<&OrderRow>> = BTreeMap::new();
    for row in orders {
        // The body, cracks, tips and points of a front are compared with each other, components of a reaction are not.
        let together = row.finest.at.starts_with("crack-");
        let at = if together { "" } else { &row.finest.at };
        figures.entry(name(row, at)).or_default().push(row);
    }
    for mut rows in figures.into_values() {
        rows.sort_by_key(|row| {
            let (at, tip) = panel_key(row);
            (at, tip_rank(tip), tip, look(&row.finest.variant.space))
        });
        let panels = rows.chunk_by(|a, b| panel_key(a) == panel_key(b)).count();
        for own in rows.chunk_by(|a, b| a.finest.at == b.finest.at || panels <= PANELS) {
            let one = own.iter().all(|row| row.finest.at == own[0].finest.at);
            let name = name(own[0], if one { &own[0].finest.at } else { "" });
            KIND.add(bundle, &name, figure(own, errors).svg()?)?;
        }
    }
    Ok(())
}

/// Name that tells the figure of a quantity at a place apart.
fn name(row: &OrderRow, at: &str) -> String {
    let variant = &row.finest.variant;
    let mu = format!("mu-{}", value(variant.friction));
    let what = format!("{} {at}", row.finest.quantity);
    file_name(&[&variant.case, &variant.method, &mu, what.trim()])
}

/// Place and enrichment.
fn panel_key(row: &OrderRow) -> (&str, &str) {
    (&row.finest.at, &row.finest.variant.tip)
}

/// Rows of one case, method, friction coefficient and quantity, by panel.
fn figure(rows: &[&OrderRow], errors: &[ErrorRow]) -> Figure {
    let first = rows[0];
    let one_place = rows.iter().all(|row| row.finest.at == first.finest.at);
    let exact = rows
        .iter()
        .all(|row| row.finest.kind == Some(orders::Kind::Exact));
    let what = quantity_name::name(
        &first.finest.quantity,
        if one_place { &first.finest.at } else { "" },
    );
    let power = if first.dim == 2 { "h⁻²" } else { "h⁻³" };
    let x = Axis::log(&format!("unknowns {} ∝ {power}", italic("N")));
    let error = if exact { "error" } else { "relative error" };
    let y = Axis::log(&format!("{error}: {what}"));
    let panel = |own: &[&OrderRow]| {
        let mut panel = Panel::new(x.clone(), y.clone(), 48.0);
        let place = (!one_place).then(|| quantity_name::place(&own[0].finest.at));
        let parts = [place, tip_name(&own[0].finest.variant.tip)];
        panel.heading = parts.into_iter().flatten().collect::<Vec<_>>().join("; ");
        panel.series = own.iter().map(|row| curve(row, errors)).collect();
        let mut theory = distinct(own.iter().map(|row| row.theory));
        theory.sort_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
        let silent = theory.iter().all(Option::is_none);
        for order in theory.into_iter().filter(|order| silent || order.is_some()) {
            let label = order.map_or(String::new(), |p| format!("theory: {}", value(p)));
            let guide = Guide::new(-order.unwrap_or(1.0), first.dim as f64, &label);
            panel.guides.push(guide);
        }
        panel
    };
    let by_panel = rows.chunk_by(|a, b| panel_key(a) == panel_key(b));
    let panels: Vec<Panel> = by_panel.map(panel).collect();
    let mut known = rows.to_vec();
    known.retain(|row| row.finest.order.is_finite() && !is_exact(&measured(row, errors)));
    known.sort_by(|a, b| a.finest.order.total_cmp(&b.finest.order));
    let told = |row: &OrderRow| {
        format!(
            "{} ({})",
            number(row.finest.order),
            row.finest.variant.space
        )
    };
    let title = match known[..] {
        [] => format!("{what} under refinement"),
        [one] => format!("{what}: order {}", told(one)),
        [least, .., best] => format!("{what}: orders from {} to {}", told(least), told(best)),
    };
    let variant = &first.finest.variant;
    let mut caption = format!(
        "{}, {}, {}; observed orders in h over the last two halvings",
        variant.case,
        variant.method,
        friction(variant.friction)
    );
    if rows.iter().any(|row| is_exact(&measured(row, errors))) {
        caption += &format!("; exact: error below {}", value(TOLERANCE));
    }
    if first.finest.kind == Some(orders::Kind::Estimate) {
        caption += "; estimated from the strain energies of the meshes";
    }
    let tips = distinct(rows.iter().map(|row| &row.finest.variant.tip)).len();
    let columns = if tips > 1 { tips } else { panels.len() }.min(3);
    // One legend is enough where all panels say the same.
    let labels = |panel: &Panel| {
        panel
            .series
            .iter()
            .map(|s| s.label.clone())
            .collect::<Vec<_>>()
    };
    let own_legends = panels
        .windows(2)
        .any(|pair| labels(&pair[0]) != labels(&pair[1]));
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
    let found = match order.finest.kind {
        _ if exact => "exact".to_owned(),
        _ if order.finest.order.is_finite() => number(order.finest.order),
        Some(orders::Kind::Finest) => "no power law".to_owned(),
        _ if order.error < ROUND_OFF => "exact on the finest mesh".to_owned(),
        _ => "–".to_owned(),
    };
    let space = &order.finest.variant.space;
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
        row.variant == order.finest.variant
            && (&row.quantity, &row.at) == (&order.finest.quantity, &order.finest.at)
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
    let own = ContactSpace::ALL
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
