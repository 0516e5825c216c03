//! Figures of the convergence study: errors against unknowns and against time, a panel per enrichment of the tips.

use std::collections::{BTreeMap, BTreeSet};

use super::number::{fixed, significant, value};
use super::plot::{ErrorCurve, ErrorFigure, ErrorPanel, Guide, error_figure, italic};
use super::standard::file_name;
use super::{Bundle, ReportError, quantity_name};
use crate::case::ContactSpace;
use crate::studies::convergence::orders::{ErrorRow, Kind, OrderRow, ROUND_OFF};

/// Panels of one figure; with more of them each place has a figure of its own.
const PANELS: usize = 6;

/// Errors against a closed form that stay below on all meshes are those of the method, which stops at a residual of 1e-9,
/// and of rounding: they have no order and would stretch the axis.
const TOLERANCE: f64 = 1e-9;

/// What a figure shows: one case, method, friction coefficient and quantity; place, empty where all places share it.
type Key = (String, String, String, String, String);

/// `figures/<case>.<method>.mu-<friction>.<quantity>[-<place>].error.svg` and `….error-time.svg`.
///
/// # Errors
/// Those of [`Bundle::add`] and of the figures.
pub fn add(
    bundle: &mut Bundle,
    errors: &[ErrorRow],
    orders: &[OrderRow],
) -> Result<(), ReportError> {
    let mut quantities: BTreeMap<Key, Vec<&OrderRow>> = BTreeMap::new();
    for row in orders {
        let variant = &row.variant;
        // Cracks, tips and points of a front are compared with each other, components of a reaction are not.
        let at = if row.at.starts_with("crack-") {
            String::new()
        } else {
            row.at.clone()
        };
        let key = (
            variant.case.clone(),
            variant.method.clone(),
            value(variant.friction),
            row.quantity.clone(),
            at,
        );
        quantities.entry(key).or_default().push(row);
    }
    for (key, rows) in quantities {
        let panels: BTreeSet<(&str, &str)> = rows.iter().map(|row| panel_key(row)).collect();
        let places: BTreeSet<&str> = panels.iter().map(|(at, _)| *at).collect();
        if places.len() > 1 && panels.len() <= PANELS {
            add_pair(bundle, &key, &rows, errors)?;
            continue;
        }
        for at in places {
            let own: Vec<&OrderRow> = rows.iter().filter(|row| row.at == at).copied().collect();
            let mut key = key.clone();
            key.4 = at.to_owned();
            add_pair(bundle, &key, &own, errors)?;
        }
    }
    Ok(())
}

/// Place and enrichment.
fn panel_key(row: &OrderRow) -> (&str, &str) {
    (&row.at, &row.variant.tip)
}

/// Errors against unknowns and against time.
fn add_pair(
    bundle: &mut Bundle,
    key: &Key,
    rows: &[&OrderRow],
    errors: &[ErrorRow],
) -> Result<(), ReportError> {
    let (case, method, friction, quantity, at) = key;
    let mut rows = rows.to_vec();
    rows.sort_by_key(|row| {
        let tip = &row.variant.tip;
        (&row.at, tip_rank(tip), tip, look(&row.variant.space))
    });
    let places: BTreeSet<&str> = rows.iter().map(|row| row.at.as_str()).collect();
    let tips: BTreeSet<&str> = rows.iter().map(|row| row.variant.tip.as_str()).collect();
    // A figure belongs to one case.
    let dim = rows.iter().map(|row| row.dim).max().unwrap_or(2);
    let exact = rows.iter().all(|row| row.kind == Kind::Exact);
    let place = match places.first() {
        Some(place) if places.len() == 1 => *place,
        _ => "",
    };
    let what = quantity_name::name(quantity, place);
    let columns = if tips.len() > 1 {
        tips.len()
    } else {
        places.len()
    };
    let figure = |x_label: String, note: &str, panels: Vec<ErrorPanel>| {
        let common = format!("{case}, {method}, {} = {friction}", italic("μ"));
        ErrorFigure {
            title: format!("{what} against {x_label}"),
            caption: format!("{common}\n{note}"),
            x_label,
            y_label: format!("{}: {what}", if exact { "error" } else { "relative error" }),
            columns: columns.min(3),
            panels,
        }
    };
    let panels = |x: fn(&ErrorRow) -> f64, with_orders: bool| -> Vec<ErrorPanel> {
        rows.chunk_by(|a, b| panel_key(a) == panel_key(b))
            .map(|own| {
                let first = own[0];
                let place = Some(quantity_name::place(&first.at)).filter(|_| places.len() > 1);
                let heading = place.into_iter().chain(tip_name(&first.variant.tip));
                ErrorPanel {
                    heading: heading.collect::<Vec<_>>().join("; "),
                    curves: own
                        .iter()
                        .map(|row| curve(row, errors, x, with_orders))
                        .collect(),
                    guides: if with_orders {
                        guides(own, dim)
                    } else {
                        Vec::new()
                    },
                }
            })
            .collect()
    };
    let size = {
        let mut note = "observed orders in h over the last two halvings".to_owned();
        if rows.iter().all(|row| row.theory.is_none()) {
            note += ", triangle: order 1";
        }
        if rows.iter().any(|row| is_exact(&measured(row, errors))) {
            note += &format!(", exact: error below {}", value(TOLERANCE));
        }
        let x_label = format!(
            "unknowns {} ∝ {}",
            italic("N"),
            if dim == 2 { "h⁻²" } else { "h⁻³" }
        );
        figure(x_label, &note, panels(|row| row.dofs as f64, true))
    };
    let spent = figure(
        "total time [s]".into(),
        "",
        panels(|row| row.seconds.total(), false),
    );
    let what = format!("{quantity} {at}").trim().to_owned();
    let stem = file_name(&[case, method, &format!("mu-{friction}"), &what]);
    for (figure, ending) in [(size, "error"), (spent, "error-time")] {
        if let Some(svg) = error_figure(&figure)? {
            bundle.add(format!("figures/{stem}.{ending}.svg"), svg)?;
        }
    }
    Ok(())
}

/// The errors of a sequence that are no round-off.
fn curve(
    order: &OrderRow,
    errors: &[ErrorRow],
    x: fn(&ErrorRow) -> f64,
    with_order: bool,
) -> ErrorCurve {
    let mut own = measured(order, errors);
    let exact = is_exact(&own);
    let found = if exact {
        "exact".to_owned()
    } else if order.order.is_finite() {
        fixed(order.order, 2).replace('-', "−")
    } else if order.kind == Kind::Finest {
        "no power law".to_owned()
    } else if order.error < ROUND_OFF {
        "exact on the finest mesh".to_owned()
    } else {
        "–".to_owned()
    };
    let space = &order.variant.space;
    own.retain(|row| !exact && row.error >= ROUND_OFF);
    ErrorCurve {
        label: if with_order {
            format!("{space}: {found}")
        } else {
            space.clone()
        },
        look: look(space),
        points: own.iter().map(|row| [x(row), row.error]).collect(),
    }
}

/// The meshes of a sequence that have an error.
fn measured<'a>(order: &OrderRow, errors: &'a [ErrorRow]) -> Vec<&'a ErrorRow> {
    let mut own: Vec<&ErrorRow> = errors
        .iter()
        .filter(|row| row.variant == order.variant)
        .filter(|row| (&row.quantity, &row.at) == (&order.quantity, &order.at))
        .filter(|row| row.error.is_finite())
        .collect();
    own.sort_by_key(|row| row.refine);
    own
}

/// Whether no mesh has an error above the tolerance of the runs.
fn is_exact(rows: &[&ErrorRow]) -> bool {
    !rows.is_empty()
        && rows
            .iter()
            .all(|row| row.kind == Some(Kind::Exact) && row.error < TOLERANCE)
}

/// Orders that theory promises the curves of a panel; order 1 without a label where it is silent.
fn guides(rows: &[&OrderRow], dim: usize) -> Vec<Guide> {
    let mut orders: Vec<f64> = rows.iter().filter_map(|row| row.theory).collect();
    orders.sort_by(f64::total_cmp);
    orders.dedup();
    let guide = |order: f64, label| Guide {
        rise: -order,
        run: dim as f64,
        label,
    };
    if orders.is_empty() {
        return vec![guide(1.0, None)];
    }
    let labelled = |order: f64| guide(order, Some(format!("theory: {}", value(order))));
    orders.into_iter().map(labelled).collect()
}

/// Contact spaces look the same in every figure.
fn look(space: &str) -> usize {
    // With its marks a space is still that space.
    let mut spaces = ContactSpace::stable_first().into_iter();
    let own = spaces.position(|own| space.starts_with(own.name()));
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
                .map_or_else(|_| radius.to_owned(), |radius: f64| significant(radius, 3));
            format!("tips enriched within {} = {metres} m", italic("r"))
        }
    };
    let all = || tip.split('+').map(one).collect::<Vec<_>>().join(", ");
    (tip != "no-tips").then(all)
}
