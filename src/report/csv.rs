//! The CSV files: one per row type, columns as documented in `docs/schema.md`, rows sorted.

use super::number::{residual, time, value};
use super::{Bundle, ReportError};
use crate::model::quantities::{PointState, Quantity};
use crate::run::record::{
    ExactRow, ExpectRow, HistoryRow, PointRow, QuantityRow, Results, RunKey, RunRow,
};
use std::cmp::Ordering;
use std::path::Path;

/// A row type with its CSV form.
pub trait Row {
    /// File name, e.g. `runs.csv`.
    const FILE: &'static str;
    /// First columns, which rows of other files have too: what a row is about. Those of a run's key unless said otherwise.
    const LEADING: &'static [&'static str] = &KEY_COLUMNS;
    /// Further columns.
    const COLUMNS: &'static [&'static str];
    /// The run the row belongs to, if rows are sorted by it.
    fn key(&self) -> Option<&RunKey> {
        None
    }
    /// Cells in the order of [`Row::LEADING`].
    fn leading(&self) -> Vec<String> {
        self.key().map(key_cells).into_iter().flatten().collect()
    }
    /// Cells in the order of [`Row::COLUMNS`].
    fn cells(&self) -> Vec<String>;
    /// Order among rows of the same key.
    fn order(&self, other: &Self) -> Ordering;
}

/// Columns of a run's key, first in every table that has one.
pub const KEY_COLUMNS: [&str; 6] = ["case", "mesh", "space", "method", "friction", "increment"];

fn key_cells(key: &RunKey) -> [String; 6] {
    // Destructured so that a new field cannot be forgotten here.
    let RunKey {
        case,
        mesh,
        space,
        method,
        friction,
        increment,
    } = key;
    [
        case.clone(),
        mesh.clone(),
        space.clone(),
        method.clone(),
        value(*friction),
        increment.to_string(),
    ]
}

/// Order of runs: case, mesh, space, method (as text), friction, increment (as numbers).
pub fn compare_keys(a: &RunKey, b: &RunKey) -> Ordering {
    (&a.case, &a.mesh, &a.space, &a.method)
        .cmp(&(&b.case, &b.mesh, &b.space, &b.method))
        .then(a.friction.total_cmp(&b.friction))
        .then(a.increment.cmp(&b.increment))
}

/// All columns of a row type, in order.
pub fn header<R: Row>() -> Vec<&'static str> {
    R::LEADING.iter().chain(R::COLUMNS).copied().collect()
}

/// The contents of one CSV file, rows sorted by key and then by [`Row::order`].
///
/// # Errors
/// [`ReportError::Csv`] when a row and the header differ in length.
pub fn file<R: Row>(rows: &[R]) -> Result<Vec<u8>, ReportError> {
    let mut sorted: Vec<&R> = rows.iter().collect();
    sorted.sort_by(|a, b| {
        let keys = match (a.key(), b.key()) {
            (Some(x), Some(y)) => compare_keys(x, y),
            _ => Ordering::Equal,
        };
        keys.then_with(|| a.order(b))
    });
    // The writer itself refuses rows of unequal length.
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    writer.write_record(header::<R>())?;
    for row in sorted {
        let mut cells = row.leading();
        cells.extend(row.cells());
        writer.write_record(&cells)?;
    }
    writer
        .into_inner()
        .map_err(|e| ReportError::Csv(e.into_error().into()))
}

/// Adds `runs.csv`, `quantities.csv`, `history.csv`, `points.csv`, `exact.csv` and `expectations.csv`.
///
/// # Errors
/// Those of [`Bundle::add`].
pub fn add_to(bundle: &mut Bundle, results: &Results) -> Result<(), ReportError> {
    bundle.add(RunRow::FILE, file(&results.runs)?)?;
    bundle.add(QuantityRow::FILE, file(&results.quantities)?)?;
    bundle.add(HistoryRow::FILE, file(&results.history)?)?;
    bundle.add(PointRow::FILE, file(&results.points)?)?;
    bundle.add(ExactRow::FILE, file(&results.exact)?)?;
    Ok(bundle.add(ExpectRow::FILE, file(&results.expectations)?)?)
}

/// Writes these six files into `dir`, all or none.
///
/// # Errors
/// [`FolderError::Io`](crate::files::bundle::FolderError::Io) naming the path that could not be written.
pub fn write_all(dir: &Path, results: &Results) -> Result<(), ReportError> {
    let mut bundle = Bundle::new();
    add_to(&mut bundle, results)?;
    Ok(bundle.commit(dir)?)
}

impl Row for RunRow {
    const FILE: &'static str = "runs.csv";
    const COLUMNS: &'static [&'static str] = &[
        "tier",
        "verdict",
        "natural_map",
        "iterations",
        "factorisations",
        "solves",
        "unknowns",
        "points",
        "dofs",
        "setup_s",
        "assembly_s",
        "factorisation_s",
        "condensation_s",
        "prepare_s",
        "solve_s",
        "equilibrium",
        "claimed_equilibrium",
        "claimed",
        "tangent_factorisations",
        "global_factorisations",
        "local_solves",
        "schema",
    ];

    fn key(&self) -> Option<&RunKey> {
        Some(&self.key)
    }

    fn cells(&self) -> Vec<String> {
        let RunRow {
            key: _,
            tier,
            verdict,
            natural_map,
            iterations,
            factorisations,
            solves,
            unknowns,
            points,
            dofs,
            setup_s,
            assembly_s,
            factorisation_s,
            condensation_s,
            prepare_s,
            solve_s,
            equilibrium,
            claimed_equilibrium,
            claimed,
            tangent_factorisations,
            global_factorisations,
            local_solves,
            schema,
        } = self;
        vec![
            tier.clone(),
            verdict.to_string(),
            residual(*natural_map),
            iterations.to_string(),
            factorisations.to_string(),
            solves.to_string(),
            unknowns.to_string(),
            points.to_string(),
            dofs.to_string(),
            time(*setup_s),
            time(*assembly_s),
            time(*factorisation_s),
            time(*condensation_s),
            time(*prepare_s),
            time(*solve_s),
            residual(*equilibrium),
            residual(*claimed_equilibrium),
            residual(*claimed),
            tangent_factorisations.to_string(),
            global_factorisations.to_string(),
            local_solves.to_string(),
            schema.to_string(),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        self.tier.cmp(&other.tier)
    }
}

impl Row for QuantityRow {
    const FILE: &'static str = "quantities.csv";
    const COLUMNS: &'static [&'static str] = &["quantity", "at", "component", "value", "unit"];

    fn key(&self) -> Option<&RunKey> {
        Some(&self.key)
    }

    fn cells(&self) -> Vec<String> {
        let Quantity {
            name,
            at,
            component,
            value: v,
            unit,
        } = &self.quantity;
        vec![
            name.clone(),
            at.clone(),
            component.clone(),
            value(*v),
            unit.clone(),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        let (a, b) = (&self.quantity, &other.quantity);
        (&a.name, &a.at, &a.component).cmp(&(&b.name, &b.at, &b.component))
    }
}

impl Row for HistoryRow {
    const FILE: &'static str = "history.csv";
    const COLUMNS: &'static [&'static str] = &["iteration", "natural_map"];

    fn key(&self) -> Option<&RunKey> {
        Some(&self.key)
    }

    fn cells(&self) -> Vec<String> {
        let HistoryRow {
            key: _,
            iteration,
            natural_map,
        } = self;
        vec![iteration.to_string(), residual(*natural_map)]
    }

    fn order(&self, other: &Self) -> Ordering {
        self.iteration.cmp(&other.iteration)
    }
}

impl Row for PointRow {
    const FILE: &'static str = "points.csv";
    const COLUMNS: &'static [&'static str] = &[
        "crack",
        "point",
        "x_m",
        "y_m",
        "z_m",
        "s_m",
        "weight",
        "gap_m",
        "slip_a_m",
        "slip_b_m",
        "p_n",
        "p_a",
        "p_b",
        "force_unit",
        "status",
    ];

    fn key(&self) -> Option<&RunKey> {
        Some(&self.key)
    }

    fn cells(&self) -> Vec<String> {
        let PointState {
            crack,
            number,
            x_m,
            y_m,
            z_m,
            s_m,
            weight,
            gap_m,
            slip_a_m,
            slip_b_m,
            p_n,
            p_a,
            p_b,
            force_unit,
            status,
        } = &self.point;
        let mut cells = vec![crack.to_string(), number.to_string()];
        let numbers = [
            x_m, y_m, z_m, s_m, weight, gap_m, slip_a_m, slip_b_m, p_n, p_a, p_b,
        ];
        cells.extend(numbers.map(|number| value(*number)));
        cells.extend([force_unit.clone(), status.clone()]);
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        (self.point.crack, self.point.number).cmp(&(other.point.crack, other.point.number))
    }
}

impl Row for ExactRow {
    const FILE: &'static str = "exact.csv";
    const COLUMNS: &'static [&'static str] = &[
        "case",
        "friction",
        "increment",
        "crack",
        "s_m",
        "x_m",
        "y_m",
        "gap_m",
        "slip_a_m",
        "p_n_pa",
        "p_a_pa",
    ];
    const LEADING: &'static [&'static str] = &[];

    fn cells(&self) -> Vec<String> {
        let ExactRow {
            case,
            friction,
            increment,
            crack,
            s_m,
            x_m,
            y_m,
            gap_m,
            slip_a_m,
            p_n_pa,
            p_a_pa,
        } = self;
        let mut cells = vec![case.clone(), value(*friction)];
        cells.extend([increment.to_string(), crack.to_string()]);
        let numbers = [s_m, x_m, y_m, gap_m, slip_a_m, p_n_pa, p_a_pa];
        cells.extend(numbers.map(|number| value(*number)));
        cells
    }

    fn order(&self, other: &Self) -> Ordering {
        self.case
            .cmp(&other.case)
            .then(self.friction.total_cmp(&other.friction))
            .then((self.increment, self.crack).cmp(&(other.increment, other.crack)))
            .then(self.s_m.total_cmp(&other.s_m))
    }
}

impl Row for ExpectRow {
    const FILE: &'static str = "expectations.csv";
    const COLUMNS: &'static [&'static str] = &[
        "quantity",
        "at",
        "component",
        "expected",
        "found",
        "allowed",
        "unit",
        "kind",
        "source",
        "verdict",
    ];

    fn key(&self) -> Option<&RunKey> {
        Some(&self.key)
    }

    fn cells(&self) -> Vec<String> {
        let ExpectRow {
            key: _,
            quantity,
            at,
            component,
            expected,
            found,
            allowed,
            unit,
            kind,
            source,
            verdict,
        } = self;
        vec![
            quantity.clone(),
            at.clone(),
            component.clone(),
            value(*expected),
            value(*found),
            value(*allowed),
            unit.clone(),
            kind.clone(),
            source.clone(),
            verdict.clone(),
        ]
    }

    fn order(&self, other: &Self) -> Ordering {
        (
            &self.quantity,
            &self.at,
            &self.component,
            &self.kind,
            &self.source,
        )
            .cmp(&(
                &other.quantity,
                &other.at,
                &other.component,
                &other.kind,
                &other.source,
            ))
            .then(self.expected.total_cmp(&other.expected))
    }
}
