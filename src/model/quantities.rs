//! Quantities of interest of one increment: reactions, displacements, contact resultants, energies.

use stickslip_methods::{ContactState, PointStatus};
use stickslip_xfem::contact::surface_point::max_penetration;
use stickslip_xfem::enrichment::basis::STEP;

use crate::case::Case;
use crate::model::body::Body;
use crate::model::boundary::region_name;
use crate::model::loading::Loading;
use crate::model::work::Work;

/// One quantity of interest.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// One of those that [`unit`] knows.
    pub name: String,
    /// Place: a side, a probe, a crack (`crack-1`), or empty.
    pub at: String,
    /// x, y, z, n, a, b, or empty.
    pub component: String,
    /// Value, SI.
    pub value: f64,
    /// Unit of the value.
    pub unit: String,
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

/// The mechanics at the end of an increment, over all unknowns and points.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Time.
    pub time: f64,
    /// All unknowns [m].
    pub u: Vec<f64>,
    /// Jump at the points in local frames, `dim` each [m].
    pub jump: Vec<f64>,
    /// Contact forces on side 1, `dim` each.
    pub p: Vec<f64>,
    /// Factors of the traction rows in Nitsche's consistency term; empty for other methods.
    pub consistency: Vec<f64>,
    /// External forces plus reactions over all unknowns: K u − Bᵀ P, less the consistency term of Nitsche's method.
    pub force: Vec<f64>,
    /// External forces over all unknowns.
    pub external: Vec<f64>,
    /// Open, stick or slip of every point.
    pub status: Vec<PointStatus>,
    /// ½ u·K u: that of the strain, without the initial stress [J, in 2D J/m]; 0 if it is rounding.
    pub strain_energy: f64,
    /// ε ½ Σ K_ii u_i²: what rounding makes of it where the body moves without strain.
    pub rounding: f64,
    /// Work since time 0.
    pub work: Work,
    /// Deepest overlap of the faces of every crack of the case, between its contact points too [m].
    pub overlap: Vec<f64>,
}

impl Snapshot {
    /// The unloaded body.
    pub fn virgin(body: &Body) -> Self {
        let (n, m) = (body.numbers.len(), body.points.len() * body.mesh.dim());
        Snapshot {
            time: 0.0,
            u: vec![0.0; n],
            jump: vec![0.0; m],
            p: vec![0.0; m],
            consistency: Vec::new(),
            force: vec![0.0; n],
            external: vec![0.0; n],
            status: vec![PointStatus::Open; body.points.len()],
            strain_energy: 0.0,
            rounding: 0.0,
            work: Work::none(body.integrated.len()),
            overlap: vec![0.0; body.integrated.len()],
        }
    }

    /// Deepest overlap of the faces of all cracks [m].
    pub fn deepest_overlap(&self) -> f64 {
        self.overlap.iter().copied().fold(0.0, f64::max)
    }

    /// The state a method returned at the end of an increment, after the given one; `consistency` as its claim asks,
    /// `friction`: coefficient of every point.
    pub fn new(
        loading: &Loading<'_>,
        increment: usize,
        state: &ContactState,
        consistency: Option<&[f64]>,
        status: Vec<PointStatus>,
        friction: &[f64],
        before: &Snapshot,
    ) -> Self {
        let body = loading.body();
        let u = loading.all_unknowns(increment, &state.u);
        let jump = body.jump(&u);
        let internal = body.stiffness.mul(&u);
        let energy = 0.5 * u.iter().zip(&internal).map(|(u, f)| u * f).sum::<f64>();
        let diagonal = body.stiffness.diagonal().into_iter().zip(&u);
        let rounding = 0.5 * f64::EPSILON * diagonal.map(|(k, u)| k * u * u).sum::<f64>();
        let mut force = internal;
        let contact = body.jump_rows.iter().zip(&state.p);
        let further = body.traction_rows.iter().zip(consistency.unwrap_or(&[]));
        for (row, p) in contact.chain(further) {
            for &(i, coefficient) in row {
                force[i] -= coefficient * p;
            }
        }
        let mut now = Snapshot {
            external: loading.external_force(increment),
            time: loading.time(increment),
            overlap: sampled_penetration(body, &u, &jump),
            jump,
            p: state.p.clone(),
            consistency: consistency.unwrap_or_default().to_vec(),
            force,
            status,
            strain_energy: if energy > rounding { energy } else { 0.0 },
            rounding,
            work: Work::none(0),
            u,
        };
        now.work = Work::after(loading, increment, friction, before, &now);
        now
    }
}

impl Snapshot {
    /// What of it is no finite number, if anything: then there is no answer, whatever the residuals say.
    pub fn not_finite(&self) -> Option<&'static str> {
        let Work {
            external,
            initial_stress,
            faces,
            identity,
            ..
        } = self.work;
        let friction = self.work.dissipation();
        let energies = [
            self.strain_energy,
            external,
            initial_stress,
            faces,
            friction,
            identity,
        ];
        let parts: [(&str, &[f64]); 5] = [
            ("displacements", &self.u),
            ("jumps", &self.jump),
            ("contact forces", &self.p),
            ("nodal forces", &self.force),
            ("energies", &energies),
        ];
        let broken = |values: &[f64]| !values.iter().all(|x| x.is_finite());
        let found = parts.iter().find(|(_, values)| broken(values));
        found.map(|(name, _)| *name)
    }
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
        "dissipation" | "external_work" | "initial_stress_work" | "strain_energy" => match dim {
            2 => "J/m",
            _ => "J",
        },
        _ => return None,
    })
}

/// Length of the tangential part of a vector at a contact point.
pub(crate) fn tangential(values: &[f64], dim: usize, point: usize) -> f64 {
    let own = &values[point * dim + 1..(point + 1) * dim];
    own.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// All quantities of interest.
pub fn quantities(case: &Case, body: &Body, now: &Snapshot) -> Vec<Quantity> {
    let dim = body.mesh.dim();
    let mut rows = Vec::new();
    let mut push = |name: &str, at: &str, component: &str, value: f64| {
        rows.push(Quantity {
            name: name.into(),
            at: at.into(),
            component: component.into(),
            value,
            unit: unit(name, dim).unwrap_or_default().into(),
        });
    };
    for (at, component, total) in reactions(case, body, now) {
        push("reaction", &at, AXES[component], total);
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
    let places = std::iter::once((String::new(), all.clone(), now.deepest_overlap())).chain(
        now.overlap.iter().enumerate().map(|(crack, &deepest)| {
            let own = all
                .iter()
                .copied()
                .filter(|&i| body.points[i].crack == crack);
            (format!("crack-{}", crack + 1), own.collect(), deepest)
        }),
    );
    for (at, own, deepest) in places {
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
        let slip = |i: usize| tangential(&now.jump, dim, i);
        push("max_slip", &at, "", largest(&slip));
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

/// Deepest overlap of the faces of every crack [m], between its contact points too. Along cell facets the jump of a crack is
/// linear between its points, which then hold its extremes.
fn sampled_penetration(body: &Body, u: &[f64], jump: &[f64]) -> Vec<f64> {
    let (dim, integrator) = (body.mesh.dim(), body.integrator());
    let deepest = |crack: usize| {
        if body.cracks.iter().any(|c| c.number == crack) {
            let own = body.samples.iter().filter(|s| s.crack == crack);
            return max_penetration(&integrator, own, u);
        }
        let points = body.points.iter().zip(jump.chunks_exact(dim));
        let own = points.filter(|(point, _)| point.crack == crack);
        own.map(|(_, jump)| -jump[0]).fold(0.0, f64::max)
    };
    (0..body.integrated.len()).map(deepest).collect()
}

/// Reactions by place and component, in case order: the force of the supports on the body. Supports on the same place
/// add up; an unknown that several places hold counts at the one whose support is in force, the last.
fn reactions(case: &Case, body: &Body, now: &Snapshot) -> Vec<(String, usize, f64)> {
    let dim = body.mesh.dim();
    let mut forces = vec![[0.0; 3]; case.supports.len()];
    for (&unknown, held) in &body.prescribed {
        let (function, component) = (unknown / dim, unknown % dim);
        let force = now.force[unknown] - now.external[unknown];
        if function < body.mesh.nodes.len() {
            forces[held.support][component] += force;
        } else if let Some((own, _)) = held.less {
            // N_j reaches over all copies of its node: this one's share is not the support's of its own.
            forces[held.support][component] += force / STEP;
            forces[own][component] -= force / STEP;
        }
    }
    let mut totals: Vec<(String, usize, f64)> = Vec::new();
    for (support, force) in case.supports.iter().zip(&forces) {
        let at = region_name(&support.on);
        for component in (0..dim).filter(|&a| support.displacement[a].is_some()) {
            match totals.iter_mut().find(|t| t.0 == at && t.1 == component) {
                Some(total) => total.2 += force[component],
                None => totals.push((at.clone(), component, force[component])),
            }
        }
    }
    totals
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
