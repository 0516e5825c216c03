//! Common tools of the whole-chain tests: cases from text, one increment by hand, rows by name.

// Every test program uses its own part.
#![allow(dead_code)]

pub mod bodies;
pub mod fields;

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use stickslip::case::{self, Case};
use stickslip::model::body::{Body, BodyError, Needs};
use stickslip::model::loading::Loading;
use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::run::registry::method;
use stickslip::studies::cases::{Settings, run_case};
use stickslip::studies::results::Results;
use stickslip_methods::{
    ContactState, ContactSystem, Increment, Load, Options, Outcome, Silent, Status,
};
use stickslip_xfem::loads::sides::Sides;

/// A method whose limit are the contact laws and that ends in round-off: the default where the method does not matter.
pub const METHOD: &str = "b-newton";

/// Natural map asked for where a test is held to round-off.
pub const TOLERANCE: f64 = 1e-12;

/// The case of a text that must be accepted.
pub fn parse(text: &str) -> Case {
    case::parse("test.toml", text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// A body of a text that must be accepted.
pub fn body(text: &str) -> Body {
    try_body(text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// A body, or why not.
pub fn try_body(text: &str) -> Result<Body, BodyError> {
    Body::new(&parse(text), 1, &Needs::default())
}

/// One increment solved by hand.
pub struct Solved {
    pub body: Body,
    pub system: Arc<ContactSystem>,
    pub outcome: Outcome,
    /// All unknowns [m].
    pub u: Vec<f64>,
    /// Jump, `dim` per point [m].
    pub jump: Vec<f64>,
    /// External forces over all unknowns.
    pub external: Vec<f64>,
}

impl Solved {
    /// Contact forces, `dim` per point.
    pub fn p(&self) -> &[f64] {
        &self.outcome.state.p
    }

    /// Mean traction component of every point: force over tributary measure.
    pub fn traction(&self, component: usize) -> Vec<f64> {
        let dim = self.body.mesh.dim();
        let forces = self.p().chunks_exact(dim).map(|p| p[component]);
        let points = self.body.points.iter();
        forces.zip(points).map(|(f, p)| f / p.weight).collect()
    }

    /// Largest difference of the nodal displacements from a field [m].
    pub fn displacement_error(&self, field: impl Fn(&[f64; 3]) -> [f64; 3]) -> f64 {
        let dim = self.body.mesh.dim();
        let mut worst: f64 = 0.0;
        for (node, x) in self.body.mesh.nodes.iter().enumerate() {
            for a in 0..dim {
                worst = worst.max((self.u[node * dim + a] - field(x)[a]).abs());
            }
        }
        worst
    }

    /// Force of the supports on a side, one component: rows of K u − Bᵀ P less the loads.
    pub fn reaction(&self, side: &str, component: usize) -> f64 {
        let dim = self.body.mesh.dim();
        let mut force = self.body.stiffness.mul(&self.u);
        for (f, b) in force.iter_mut().zip(contact_force(&self.body, self.p())) {
            *f -= b;
        }
        let nodes = self.body.mesh.side_nodes(side);
        let rows = nodes.iter().map(|n| n * dim + component);
        rows.map(|i| force[i] - self.external[i]).sum()
    }
}

/// Bᵀ P over all unknowns, prescribed ones too.
pub fn contact_force(body: &Body, p: &[f64]) -> Vec<f64> {
    let dim = body.mesh.dim();
    let mut force = vec![0.0; body.numbers.len()];
    for (point, p) in body.points.iter().zip(p.chunks_exact(dim)) {
        for (f, rows) in &point.terms {
            for (row, value) in rows.iter().zip(p) {
                for a in 0..dim {
                    force[*f as usize * dim + a] += row[a] * value;
                }
            }
        }
    }
    force
}

/// Friction of every contact point as the case file states it.
pub fn friction(case: &Case, body: &Body) -> Vec<f64> {
    let points = body.points.iter();
    points.map(|p| case.cracks[p.crack].friction).collect()
}

/// Loads on a body, with the friction of its first crack.
pub fn loading<'a>(body: &'a Body, case: &'a Case) -> Loading<'a> {
    let friction = case.cracks.first().map_or(0.0, |crack| crack.friction);
    Loading::new(body, case, friction).unwrap_or_else(|e| panic!("{e}\n{}", case.source))
}

/// Sides of the first crack of a case in its body.
pub fn sides(case: &Case, body: &Body) -> Option<Sides> {
    let first = case.cracks.first().map(|spec| (&spec.geometry, spec.tip));
    Sides::new(first, &body.integrator())
}

/// The load of a body nothing acts on.
pub fn no_load(body: &Body) -> Load {
    Load::zero(&body.elastic)
}

/// Solves the last load of a case in one increment; the method must converge to the tolerance.
pub fn solve_with(text: &str, name: &str, tolerance: f64) -> Solved {
    solve_case(&parse(text), 1, name, tolerance)
}

/// Solves the last load of a case, refined by a factor, in one increment; the method must converge to the tolerance.
pub fn solve_case(case: &Case, refine: usize, name: &str, tolerance: f64) -> Solved {
    let text = &case.source;
    let body = Body::new(case, refine, &Needs::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let friction = friction(case, &body);
    let system = Arc::new(ContactSystem::new(body.elastic.clone(), friction).unwrap());
    let registered = method(name).expect("registered");
    let options = Options::new(registered.options, &[]).unwrap();
    let mut enforcement = (registered.build)(&options);
    let loading = loading(&body, case);
    let last = case.path.increments;
    let increment = Increment {
        system: &system,
        load: &loading.at(last),
        start_load: &no_load(&body),
        start: &ContactState::zero(&system),
        guess: None,
        index: 0,
        tolerance,
    };
    let outcome = enforcement.solve(&increment, &mut Silent).unwrap();
    assert_eq!(outcome.status, Status::Converged, "{name}\n{text}");
    let u = loading.all_unknowns(last, &outcome.state.u);
    let jump = body.jump(&u);
    let external = loading.external_force(last);
    Solved {
        body,
        system,
        outcome,
        u,
        jump,
        external,
    }
}

/// As [`solve_with`], by [`METHOD`] to [`TOLERANCE`].
pub fn solve(text: &str) -> Solved {
    solve_with(text, METHOD, TOLERANCE)
}

/// Runs a case by methods with their default options, one after the other.
pub fn run(case: &Case, methods: &[&str]) -> Results {
    let settings = Settings::PLAIN;
    run_case(case, &choices(methods), settings, &Quiet).unwrap_or_else(|e| panic!("{e}"))
}

/// Methods with their default options.
pub fn choices(methods: &[&str]) -> Vec<Choice> {
    let choice = |name: &&str| Choice::new(method(name).expect("registered"), &[]).unwrap();
    methods.iter().map(choice).collect()
}

/// The only value of a quantity in the rows that fulfil a condition.
pub fn value(
    results: &Results,
    keep: impl Fn(&stickslip::studies::rows::RunKey) -> bool,
    [quantity, at, component]: [&str; 3],
) -> f64 {
    let found: Vec<f64> = results
        .quantities()
        .into_iter()
        .filter(|row| keep(&row.key))
        .map(|row| row.quantity)
        .filter(|q| q.name == quantity && q.at == at && q.component == component)
        .map(|q| q.value)
        .collect();
    assert_eq!(found.len(), 1, "{quantity} {at} {component}: {found:?}");
    found[0]
}

/// Largest |a − b| over the largest |b|.
pub fn relative_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = b.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
    let difference = a.iter().zip(b).map(|(x, y)| (x - y).abs());
    // `max` drops NaN, and a NaN must fail.
    difference.fold(0.0, |m: f64, d| if d.is_nan() { d } else { m.max(d) }) / size
}

/// Reproducible numbers between 0 and 1 (xorshift64*, Vigna 2016).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.between(-1.0, 1.0)).collect()
    }
}

/// Common part of the files of the tests of one chain: a 2D box and everything after it.
pub fn plane(min: [f64; 2], max: [f64; 2], cells: [usize; 2], rest: &str) -> String {
    format!(
        "title = \"t\"\nmodel = \"plane-strain\"\nmaterial = {{ young_pa = 1, poisson = 0.3 }}\n\
         mesh = {{ box = {{ min_m = {min:?}, max_m = {max:?}, cells = {cells:?} }} }}\n{rest}"
    )
}

/// The same 2D case on a mesh whose inner grid points are turned and moved at random.
pub fn moved(text: &str) -> String {
    let motion = "mesh = { twist = { angle_deg = 35 }, distort = { amplitude = 0.2, seed = 3 }, ";
    assert_eq!(text.matches("mesh = { ").count(), 1);
    text.replace("mesh = { ", motion)
}

/// The same case of another Poisson's ratio.
pub fn of_ratio(text: &str, poisson: f64) -> String {
    assert_eq!(text.matches("poisson = 0.3").count(), 1);
    text.replace("poisson = 0.3", &format!("poisson = {poisson}"))
}

/// A straight crack in 2D, with edge pairs.
pub fn crack(p: [f64; 2], q: [f64; 2], friction: f64, tip: &str) -> String {
    format!(
        "[[crack]]\npoints_m = [{p:?}, {q:?}]\nfriction = {friction:?}\ntip = \"{tip}\"\n\
         contact = \"edge-pairs\"\n"
    )
}

/// A text with the contact space of all its cracks named.
pub fn in_space(text: &str, space: &str) -> String {
    text.replace(
        "contact = \"edge-pairs\"",
        &format!("contact = \"{space}\""),
    )
}

/// A support on sides (TOML), with its displacement (TOML).
pub fn support(on: &str, displacement: &str) -> String {
    format!("[[support]]\non = {on}\ndisplacement_m = {displacement}\n")
}

/// A load on one side: kind and value as one TOML line.
pub fn load(on: &str, what: &str) -> String {
    format!("[[load]]\non = \"{on}\"\n{what}\n")
}

/// A solid box with planes: point, normal, friction; edge pairs.
pub fn solid(
    max: [f64; 3],
    cells: [usize; 3],
    planes: &[([f64; 3], [f64; 3], f64)],
    rest: &str,
) -> String {
    let cracks: String = planes
        .iter()
        .map(|(point, normal, friction)| {
            format!(
                "[[crack]]\nplane = {{ point_m = {point:?}, normal = {normal:?} }}\nfriction = {friction:?}\n\
                 contact = \"edge-pairs\"\n"
            )
        })
        .collect();
    format!(
        "title = \"t\"\nmodel = \"solid\"\nmaterial = {{ young_pa = 1, poisson = 0.3 }}\n\
         mesh = {{ box = {{ min_m = [0, 0, 0], max_m = {max:?}, cells = {cells:?} }} }}\n{cracks}{rest}"
    )
}

/// Every node of the outline held: the body of tests that look at K and B only.
pub fn clamped(dim: usize) -> String {
    let (sides, zero): (&[&str], &str) = if dim == 2 {
        (&["left", "right", "bottom", "top"], "[0, 0]")
    } else {
        (
            &["left", "right", "front", "back", "bottom", "top"],
            "[0, 0, 0]",
        )
    };
    sides
        .iter()
        .map(|side| support(&format!("\"{side}\""), zero))
        .collect()
}

/// Demands a number within a tolerance; NaN is in none.
#[track_caller]
pub fn assert_near(found: f64, exact: f64, tolerance: f64, at: impl Debug) {
    let near = (found - exact).abs() < tolerance;
    assert!(near, "{at:?}: {found:e} instead of {exact:e}");
}

/// Demands a number below a bound.
#[track_caller]
pub fn assert_below(found: f64, bound: f64, at: impl Debug) {
    assert!(found < bound, "{at:?}: {found:e}, not below {bound:e}");
}

/// Whether something comes to hold: ten minutes are for ever, however busy the machine.
pub fn awaited(mut holds: impl FnMut() -> bool) -> bool {
    let clock = Instant::now();
    while !holds() {
        if clock.elapsed().as_secs() > 600 {
            return false;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    true
}

/// What a call gives that computes for less than so many seconds, which do not depend on what else the machine does.
#[track_caller]
pub fn quick<T>(most_s: i64, call: impl FnOnce() -> T) -> T {
    #[cfg(unix)]
    let computed = || rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime).tv_sec;
    #[cfg(not(unix))]
    let computed = || 0;
    let begin = computed();
    let found = call();
    let spent = computed() - begin;
    assert!(spent < most_s, "{spent} s");
    found
}

/// Lines on standard error but those of progress, which come with the time.
pub fn but_progress(complaints: &str) -> String {
    let lines = complaints.split_inclusive('\n');
    lines.filter(|line| !line.starts_with('[')).collect()
}

/// Runs the program in a folder: exit code, standard output, standard error.
pub fn stickslip(arguments: &[&str], dir: &Path) -> (i32, String, String) {
    let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_stickslip"));
    let output = program.args(arguments).current_dir(dir).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let code = output.status.code().unwrap();
    (code, text(output.stdout), text(output.stderr))
}

/// Runs the program, which must end with a code; what it prints.
#[track_caller]
pub fn ends_with(code: i32, arguments: &[&str], dir: &Path) -> (String, String) {
    let (found, output, complaints) = stickslip(arguments, dir);
    assert_eq!(found, code, "{arguments:?}\n{output}{complaints}");
    (output, complaints)
}

/// Rows of a table of commas, by column.
pub fn csv_rows(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().map(Result::unwrap).collect()
}

/// Rows of `runs.csv` without what belongs to the machine and the moment.
pub fn without_times(file: &[u8]) -> Vec<BTreeMap<String, String>> {
    let mut rows = csv_rows(std::str::from_utf8(file).unwrap());
    for row in &mut rows {
        let count = row.len();
        row.retain(|name, _| !name.ends_with("_s") && name != "repetitions" && name != "peak_mb");
        assert_eq!(count - row.len(), 15 + 2);
    }
    rows
}

/// Files below a folder, by relative path.
pub fn files(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(dir).into_iter().flatten() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if path.is_dir() {
            let below = files(&path).into_iter();
            found.extend(below.map(|(file, text)| (format!("{name}/{file}"), text)));
        } else {
            found.insert(name.to_owned(), std::fs::read(&path).unwrap());
        }
    }
    found
}
