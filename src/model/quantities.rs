//! Quantities of interest of one increment: reactions, displacements, contact resultants, energies.

use serde::{Deserialize, Serialize};
use stickslip_methods::PointStatus;
use stickslip_xfem::enrichment::basis::STEP;

use crate::case::Case;
use crate::files::nan;
use crate::model::body::Body;
use crate::model::boundary::region_name;
use crate::model::snapshot::Snapshot;

/// One quantity of interest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// One of those that [`unit`] knows.
    pub name: String,
    /// Place: a side, a probe, a crack (`crack-1`), a tip (`crack-1 tip-2`, `crack-1 front-45deg`), or empty.
    pub at: String,
    /// x, y, z, n, a, b, I, II, III, or empty.
    pub component: String,
    /// Value, SI.
    #[serde(with = "nan")]
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
    /// Estimate of its error, in its unit; not-a-number where there is none.
    #[serde(with = "nan")]
    pub error: f64,
    /// [`ESTIMATE`], [`EXACT`], why there is no value or no estimate, or empty.
    pub error_kind: String,
}

/// Kind of an error that is estimated.
pub const ESTIMATE: &str = "estimate";
/// Kind of the distance from a closed form.
pub const EXACT: &str = "exact";

impl Quantity {
    /// Place and component, e.g. `top y`; empty: the whole body.
    pub fn place(&self) -> String {
        format!("{} {}", self.at, self.component).trim().to_owned()
    }

    /// A value with its name, place and component in a body of that dimension, without an estimate of its error.
    pub fn new([name, at, component]: [&str; 3], value: f64, dim: usize) -> Self {
        Self {
            name: name.into(),
            at: at.into(),
            component: component.into(),
            value,
            unit: unit(name, dim).unwrap_or_default().into(),
            error: f64::NAN,
            error_kind: String::new(),
        }
    }
}

/// One contact point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointState {
    /// Crack number, from 1.
    pub crack: usize,
    /// Point number within the crack, from 1, ordered along it.
    pub number: usize,
    /// Position [m].
    pub x_m: f64,
    /// Position [m].
    pub y_m: f64,
    /// Position [m]; 0 in 2D.
    pub z_m: f64,
    /// Distance along the crack from its first point (2D) [m]; 0 in 3D.
    pub s_m: f64,
    /// Tributary length [m] (2D) or area [m²] (3D).
    pub weight: f64,
    /// Normal gap, open > 0 [m].
    pub gap_m: f64,
    /// Tangential jump along a, total [m].
    pub slip_a_m: f64,
    /// Tangential jump along b, total [m]; 0 in 2D.
    pub slip_b_m: f64,
    /// Contact force along n on side 1, compression > 0 [N/m in 2D, N in 3D].
    pub p_n: f64,
    /// Contact force along a on side 1 [N/m in 2D, N in 3D].
    pub p_a: f64,
    /// Contact force along b on side 1; 0 in 2D [N/m in 2D, N in 3D].
    pub p_b: f64,
    /// `N/m` in 2D (per metre of thickness), `N` in 3D.
    pub force_unit: String,
    /// open, stick or slip.
    pub status: String,
}

/// Components in space.
pub const AXES: [&str; 3] = ["x", "y", "z"];
/// Components at a crack: normal and tangential.
pub const LOCAL: [&str; 3] = ["n", "a", "b"];

/// Unit of forces: in 2D per metre of thickness.
fn force_unit(dim: usize) -> &'static str {
    if dim == 2 { "N/m" } else { "N" }
}

/// Unit of a quantity of interest in a body of that dimension; none where there is no such quantity.
pub fn unit(name: &str, dim: usize) -> Option<&'static str> {
    Some(match name {
        "reaction" | "contact_force" => force_unit(dim),
        "displacement" | "mean_slip" | "max_slip" => "m",
        "max_gap" | "max_penetration" | "max_penetration_sampled" => "m",
        "points_open" | "points_stick" | "points_slip" => "-",
        "energy_identity" | "path_error" => "-",
        "stress_intensity" => "Pa·√m",
        "energy_release_rate" => "J/m²",
        "growth_angle" => "°",
        "dissipation" | "external_work" | "initial_stress_work" | "strain_energy" => match dim {
            2 => "J/m",
            _ => "J",
        },
        _ => return None,
    })
}

/// All quantities of interest.
pub fn quantities(case: &Case, body: &Body, now: &Snapshot) -> Vec<Quantity> {
    let dim = body.mesh.dim();
    let mut rows = Vec::new();
    let mut push = |name: &str, at: &str, component: &str, value: f64| {
        rows.push(Quantity::new([name, at, component], value, dim));
    };
    for held in reactions(case, body, now) {
        let (at, component) = (&held.at, AXES[held.component]);
        push("reaction", at, component, held.force);
        if held.nodes > 0 {
            push(
                "displacement",
                at,
                component,
                held.moved / held.nodes as f64,
            );
        }
    }
    for probe in &case.probes {
        if let Some(node) = body.mesh.node_at(&probe.point) {
            for a in 0..dim {
                let value = now.u[node * dim + a];
                push("displacement", &probe.name, AXES[a], value);
            }
        }
    }
    // Every crack, and all of them together.
    let all: Vec<usize> = (0..body.points.len()).collect();
    let places = std::iter::once((String::new(), all.clone(), now.largest())).chain(
        now.extremes.iter().enumerate().map(|(crack, &most)| {
            let own = all
                .iter()
                .copied()
                .filter(|&i| body.points[i].crack == crack);
            (format!("crack-{}", crack + 1), own.collect(), most)
        }),
    );
    for (at, own, [deepest, slip]) in places {
        if !at.is_empty() {
            for c in 0..dim {
                let total = own.iter().map(|&i| now.p[i * dim + c]).sum();
                push("contact_force", &at, LOCAL[c], total);
            }
        }
        for (name, status) in [
            ("points_open", PointStatus::Open),
            ("points_stick", PointStatus::Stick),
            ("points_slip", PointStatus::Slip),
        ] {
            let count = own.iter().filter(|&&i| now.status[i] == status).count();
            push(name, &at, "", count as f64);
        }
        let largest = |f: &dyn Fn(usize) -> f64| own.iter().map(|&i| f(i)).fold(0.0, f64::max);
        push("max_gap", &at, "", largest(&|i| now.jump[i * dim]));
        push("max_penetration", &at, "", largest(&|i| -now.jump[i * dim]));
        push("max_penetration_sampled", &at, "", deepest);
        push("max_slip", &at, "", slip);
        if !at.is_empty() {
            // Mean over the surface of the crack: NaN for one without contact points.
            let area: f64 = own.iter().map(|&i| body.points[i].weight).sum();
            for c in 1..dim {
                let part = |&i: &usize| body.points[i].weight * now.jump[i * dim + c];
                let mean = own.iter().map(part).sum::<f64>() / area;
                push("mean_slip", &at, LOCAL[c], mean);
            }
        }
    }
    push("dissipation", "", "", now.work.dissipation());
    for (crack, &work) in now.work.friction.iter().enumerate() {
        push("dissipation", &format!("crack-{}", crack + 1), "", work);
    }
    push("strain_energy", "", "", now.strain_energy);
    push("external_work", "", "", now.work.external);
    push("initial_stress_work", "", "", now.work.initial_stress);
    push("path_error", "", "", now.work.path_error());
    push("energy_identity", "", "", now.work.identity);
    rows
}

/// A component of a place that supports hold.
struct Held {
    at: String,
    component: usize,
    /// Force of the supports on the body.
    force: f64,
    /// Sum of its displacement over so many nodes.
    moved: f64,
    nodes: usize,
}

/// What supports hold, in case order. Supports on the same place add up; an unknown that several places hold counts at the one
/// whose support is in force, the last.
fn reactions(case: &Case, body: &Body, now: &Snapshot) -> Vec<Held> {
    let dim = body.mesh.dim();
    let mut sums = vec![[(0.0, 0.0, 0); 3]; case.supports.len()];
    for (&unknown, held) in &body.prescribed {
        let (function, component) = (unknown / dim, unknown % dim);
        let force = now.force[unknown] - now.external[unknown];
        if function < body.mesh.nodes.len() {
            let (total, moved, nodes) = &mut sums[held.support][component];
            *total += force;
            *moved += now.u[unknown];
            *nodes += 1;
        } else if let Some((own, _)) = held.less {
            // N_j reaches over all copies of its node: this one's share is not the support's of its own.
            sums[held.support][component].0 += force / STEP;
            sums[own][component].0 -= force / STEP;
        }
    }
    let mut all: Vec<Held> = Vec::new();
    for (support, sums) in case.supports.iter().zip(&sums) {
        let at = region_name(&support.on);
        for component in (0..dim).filter(|&a| support.displacement[a].is_some()) {
            let known = all
                .iter()
                .position(|h| h.at == at && h.component == component);
            let place = known.unwrap_or_else(|| {
                let at = at.clone();
                all.push(Held {
                    at,
                    component,
                    force: 0.0,
                    moved: 0.0,
                    nodes: 0,
                });
                all.len() - 1
            });
            let (force, moved, nodes) = sums[component];
            let held = &mut all[place];
            held.force += force;
            held.moved += moved;
            held.nodes += nodes;
        }
    }
    all
}

/// All contact points.
pub fn point_states(body: &Body, now: &Snapshot) -> Vec<PointState> {
    let dim = body.mesh.dim();
    let mut number = 0;
    let mut last = usize::MAX;
    let third = |values: &[f64]| values.get(2).copied().unwrap_or(0.0);
    body.points
        .iter()
        .enumerate()
        .map(|(i, point)| {
            number = if point.crack == last { number + 1 } else { 1 };
            last = point.crack;
            let (jump, p) = (
                &now.jump[i * dim..(i + 1) * dim],
                &now.p[i * dim..(i + 1) * dim],
            );
            let [x_m, y_m, z_m] = body.place(&point.x);
            PointState {
                crack: point.crack + 1,
                number,
                x_m,
                y_m,
                z_m,
                s_m: point.s,
                weight: point.weight,
                gap_m: jump[0],
                slip_a_m: jump[1],
                slip_b_m: third(jump),
                p_n: p[0],
                p_a: p[1],
                p_b: third(p),
                force_unit: force_unit(dim).into(),
                status: now.status[i].as_str().into(),
            }
        })
        .collect()
}
