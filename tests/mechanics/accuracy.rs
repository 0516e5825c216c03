//! Accuracy of the whole chain against closed forms on the shipped cases: errors, observed orders, hysteresis.

use crate::common::*;
use stickslip::case::{Case, ContactSpace, CrackShape, Tip, shipped};
use stickslip::model::errors::Deviation;
use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::run::verdict::Verdict;
use stickslip::studies::convergence;
use stickslip::studies::convergence::{ConvergencePlan, Measured, slope};
use stickslip_xfem::exact::Setting;

/// Errors by mesh, from coarse to fine: cell size and deviations.
struct Errors(Vec<(f64, Vec<Deviation>)>);

impl Errors {
    /// A case with star multipliers and one enrichment of its tips, on refinements of its mesh.
    fn of(case: &Case, refine: &[usize], tip: Option<Tip>) -> Self {
        let study = ConvergencePlan {
            refine: Some(refine.to_vec()),
            spaces: Some(vec![ContactSpace::Star]),
            tips: tip.map(|tip| vec![tip]),
            choice: Choice::new(stickslip::run::registry::method("hybrid").unwrap(), &[]).unwrap(),
        };
        let samples = convergence::run(case, &study, &Quiet).unwrap();
        let rows = samples.into_iter().map(|sample| {
            let Measured::Exact(deviations) = sample.measured else {
                panic!("{}: {}", sample.mesh, sample.verdict)
            };
            (sample.h, deviations)
        });
        Errors(rows.collect())
    }

    fn shipped(name: &str, refine: &[usize]) -> Self {
        Self::of(&shipped(name), refine, None)
    }

    /// A quantity on the finest mesh, largest error of all places.
    fn finest(&self, quantity: &str) -> &Deviation {
        let (_, rows) = self.0.last().unwrap();
        let own = rows.iter().filter(|r| r.quantity == quantity);
        own.max_by(|a, b| a.error.total_cmp(&b.error)).unwrap()
    }

    /// Error on the finest mesh is at most a bound.
    fn within(&self, quantity: &str, bound: f64) {
        let found = self.finest(quantity);
        println!("{quantity} {:.2e}, at most {bound}", found.error);
        assert!(found.error <= bound, "{found:?}");
    }

    /// The same at one place.
    fn within_at(&self, quantity: &str, at: &str, bound: f64) {
        let (_, rows) = self.0.last().unwrap();
        let found = rows.iter().find(|r| r.quantity == quantity && r.at == at);
        let error = found.unwrap().error;
        println!("{quantity} at {at} {error:.2e}, at most {bound}");
        assert!(error <= bound, "{found:?}");
    }

    /// The largest value of a field on the finest mesh is that of the closed form within a relative bound.
    fn largest_within(&self, quantity: &str, bound: f64) {
        let Deviation { found, exact, .. } = self.finest(quantity);
        let error = (found / exact - 1.0).abs();
        println!("largest {quantity} {error:.2e}, at most {bound}");
        assert!(error <= bound, "{quantity}: {found} {exact}");
    }

    /// Observed order over all meshes.
    fn order(&self, quantity: &str) -> f64 {
        let at = |(h, rows): &(f64, Vec<Deviation>)| {
            let row = rows.iter().find(|r| r.quantity == quantity).unwrap();
            [*h, row.error]
        };
        let order = slope(&self.0.iter().map(at).collect::<Vec<_>>());
        println!("{quantity}: order {order:.2}");
        order
    }
}

/// Energy of order 0.95 or more on 40, 80 and 160 cells with branch functions within 0.2 m: four cells on the first mesh, so
/// that the radius decides on all of them how far the functions reach and not the cells around the tip.
fn assert_first_order(case: &Case) {
    let errors = Errors::of(case, &[4, 8, 16], Some(Tip::Radius(0.2)));
    assert!(errors.order("energy") >= 0.95);
}

fn shipped(name: &str) -> Case {
    shipped::find(name).unwrap().unwrap()
}

/// A plate of the shipped cases with its crack of half length 0.45 m at another place and angle, none of them special: the
/// shipped place first, then angles of 27 degrees and of 10 to 45 degrees in turn.
fn placed(name: &str, k: usize) -> Case {
    let mut case = shipped(name);
    if k > 0 {
        let degrees = if k.is_multiple_of(3) {
            27.0
        } else {
            10.0 + (37 * k % 36) as f64
        };
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        // The fractional parts of multiples of these numbers fill a square evenly.
        let offset = |step: f64| 0.19 * ((k as f64 * step).fract() - 0.5);
        let centre = [-0.05 + offset(0.618034), 0.02 + offset(0.7548776662)];
        let end = |s: f64| [centre[0] + s * cos, centre[1] + s * sin];
        case.cracks[0].geometry = CrackShape::Polyline(vec![end(-0.45), end(0.45)]);
    }
    case
}

/// Bounds of a crack that slides over its whole length, on 40 x 40 cells with branch functions within 0.2 m.
const SLIDING: [(&str, f64); 6] = [
    ("traction", 4e-3),
    ("traction_rms", 4e-3),
    ("slip", 0.02),
    ("slip_points", 0.02),
    ("displacement", 4e-4),
    ("k2_interaction", 5e-3),
];

/// Source: closed form, Laborde et al. (2005). Goal: energy of order 0.95 or more with a fixed radius; with the tip cell alone
/// the √r field in the next cells is missed, so energy of order 1/2 and displacement of order 1 (within 0.15).
#[test]
fn a_sliding_crack_has_the_orders_of_its_tip_functions() {
    let case = shipped("inclined_crack");
    assert_first_order(&case);
    let topological = Errors::of(&case, &[1, 2, 4], Some(Tip::Branch));
    assert_near(topological.order("energy"), 0.5, 0.15, "energy");
    assert_near(topological.order("displacement"), 1.0, 0.15, "displacement");
}

/// Source: closed form. Goal: traction within 0.4 %, slip within 2 %, displacement within 4e-4, K_II within 0.5 % on 40 x 40
/// cells wherever the crack lies on the grid.
#[test]
fn a_sliding_crack_has_its_traction_slip_and_intensity_at_any_place() {
    for k in 0..25 {
        let errors = Errors::of(&placed("inclined_crack", k), &[4], None);
        for (quantity, bound) in SLIDING {
            errors.within(quantity, bound);
        }
    }
}

/// Source: closed form. Goal: half of those bounds, or less, with cells of half the size.
#[test]
fn a_sliding_crack_has_half_the_errors_on_cells_of_half_the_size() {
    for k in 0..6 {
        let errors = Errors::of(&placed("inclined_crack", k), &[8], None);
        for (quantity, bound) in SLIDING {
            errors.within(quantity, bound / 2.0);
        }
    }
}

/// Source: closed form. Goal: K_I and K_II of an open crack within 0.5 % on 40 x 40 cells, energy of order 1, no contact.
#[test]
fn an_open_crack_is_the_linear_problem() {
    let errors = Errors::shipped("open_crack", &[4]);
    assert_first_order(&shipped("open_crack"));
    errors.within("k1_interaction", 5e-3);
    errors.within("k2_interaction", 5e-3);
    errors.within("traction", 0.0);
    errors.within("dissipation", 0.0);
}

/// Source: closed form. Goal: on 40 x 40 cells the largest slip and the dissipation of first loading within 1 %, energy of
/// order 1.
#[test]
fn partial_slip_ends_where_it_should() {
    let errors = Errors::shipped("partial_slip", &[4]);
    assert_first_order(&shipped("partial_slip"));
    errors.largest_within("slip", 0.01);
    errors.within("dissipation", 0.01);
}

/// Source: closed form. Goal: on 80 x 80 cells the stick boundary within 1 % of the length of the crack, the largest slip and
/// the dissipation within 1 %, wherever the crack lies on the grid; the boundary converges.
#[test]
fn the_stick_boundary_is_found_at_any_place() {
    for k in 0..6 {
        let errors = Errors::of(&placed("partial_slip", 2 * k), &[8], None);
        errors.within("stick_boundary", 0.01);
        errors.largest_within("slip", 0.01);
        errors.within("dissipation", 0.01);
    }
    let errors = Errors::shipped("partial_slip", &[2, 4, 8, 16]);
    errors.within("stick_boundary", 0.005);
    assert!(errors.order("stick_boundary") >= 1.0);
}

/// Dissipation at the end of every increment [J/m].
fn dissipation(name: &str, refine: usize) -> Vec<f64> {
    let mut case = shipped(name);
    // The numbers expected of the coarse mesh are not those of the fine one.
    case.expects.clear();
    case.sweep.refine = vec![refine];
    let results = run(&case, &[METHOD]);
    let mut runs = results.records();
    assert!(runs.all(|run| run.found.verdict == Verdict::Solved));
    let rows = results.quantities().into_iter();
    rows.filter(|q| q.quantity.name == "dissipation" && q.quantity.at.is_empty())
        .filter(|q| q.key.increment > 0)
        .map(|q| q.quantity.value)
        .collect()
}

/// Source: closed form, W₁ in the first loading and 4 W₁ per cycle. Goal: both within 1 % on 40 x 40 and 80 x 80 cells.
#[test]
fn a_load_cycle_dissipates_its_loop() {
    let exact = 96.78396117699806;
    for refine in [4, 8] {
        let w = dissipation("partial_slip_cycle", refine);
        assert_eq!(w.len(), 5);
        let (first, cycle) = (w[0] / exact, (w[4] - w[0]) / (4.0 * exact));
        println!("{refine}: first loading {first}, cycle {cycle}");
        assert!((cycle - 1.0).abs() <= 0.01, "{w:?}");
        assert!((first - 1.0).abs() <= 0.01, "{w:?}");
    }
}

/// Source: closed form, W₁. Goal: after the first loading the cycles dissipate less than 1e-12 of it.
#[test]
fn small_cycles_shake_down() {
    let w = dissipation("partial_slip_shakedown", 4);
    println!("{:e}", (w[4] - w[0]) / w[0]);
    assert!(w[0] > 90.0 && w.len() == 5);
    for later in &w[1..] {
        assert!((later - w[0]).abs() <= 1e-12 * w[0], "{w:?}");
    }
}

/// Source: closed form. Goal: on 40 x 40 cells the largest opening within 1 %, K_I within 0.5 % at the open tip, energy of
/// order 1; on 80 x 80 cells K_I within 0.5 % at both tips wherever the crack lies on the grid. At the closed tip K_I is zero
/// and the error measured against Σ √(πL/2); it is that of the contact pressure, which ends like a square root in the middle
/// of the crack.
#[test]
fn a_partly_open_crack_has_its_opening_and_intensity() {
    let errors = Errors::shipped("partial_opening", &[4]);
    assert_first_order(&shipped("partial_opening"));
    errors.largest_within("gap", 0.01);
    errors.within_at("k1_interaction", "crack-1 tip-1", 5e-3);
    for k in 0..6 {
        let errors = Errors::of(&placed("partial_opening", 2 * k), &[8], None);
        errors.largest_within("gap", 0.01);
        errors.within("k1_interaction", 5e-3);
    }
}

/// Source: closed form, 0.9648017 with contact, 0.8862269 with faces free to overlap. Goal: K_I within 0.5 % of the first at
/// both tips.
#[test]
fn a_crack_in_bending_has_the_intensity_of_contact() {
    let errors = Errors::shipped("closing_crack", &[2]);
    let (_, rows) = &errors.0[0];
    let found = |at: &str| {
        let row = rows
            .iter()
            .find(|r| r.quantity == "k1_interaction" && r.at == at);
        row.unwrap().found / 1e6
    };
    let (closed, open) = (found("crack-1 tip-1"), found("crack-1 tip-2"));
    println!("{closed} {open}");
    assert!((open / 0.9648017 - 1.0).abs() <= 5e-3, "{open}");
    assert!(closed.abs() <= 0.02, "{closed}");
}

/// Source: theory of smooth solutions. Goal: orders 1 in energy, 2 in displacement (within 0.15), traction 1 or more, along the
/// grid and across it.
#[test]
fn manufactured_slip_has_the_orders_of_smooth_solutions() {
    for name in ["manufactured_slip", "manufactured_slip_rotated"] {
        let errors = Errors::shipped(name, &[1, 2, 4]);
        assert!((errors.order("energy") - 1.0).abs() <= 0.15, "{name}");
        assert!((errors.order("displacement") - 2.0).abs() <= 0.15, "{name}");
        assert!(errors.order("traction") >= 1.0, "{name}");
    }
}

/// Source: SSNP169, contact pressure 10.147926 MPa at 0 and 9.852074 MPa at 90 degrees. Goal: both within 0.2 %, orders 1 in
/// energy and 2 in displacement (within 0.15).
#[test]
fn a_circular_interface_has_its_pressures_and_orders() {
    let errors = Errors::shipped("circular_interface", &[1, 2, 4]);
    assert!((errors.order("energy") - 1.0).abs() <= 0.15);
    assert!((errors.order("displacement") - 2.0).abs() <= 0.15);
    let mut case = shipped("circular_interface");
    case.expects.clear();
    case.sweep.refine = vec![4];
    let results = run(&case, &[METHOD]);
    let pressure = |angle: f64| {
        let away = |p: &stickslip::studies::rows::PointRow<'_>| {
            (p.point.y_m.atan2(p.point.x_m) - angle.to_radians()).abs()
        };
        let points = results.points().into_iter();
        let nearest = points.min_by(|p, q| away(p).total_cmp(&away(q))).unwrap();
        nearest.point.p_n / nearest.point.weight / 1e6
    };
    let (p0, p90) = (pressure(0.0), pressure(90.0));
    println!("{p0} {p90}");
    assert!((p0 / 10.147926 - 1.0).abs() <= 2e-3, "{p0}");
    assert!((p90 / 9.852074 - 1.0).abs() <= 2e-3, "{p90}");
}

/// Source: uniform stress. Goal: displacement, energy and traction of a sloping interface that sticks to 1e-10 on every mesh.
#[test]
fn a_sloping_interface_passes_the_patch_test() {
    for refine in [1, 2, 4] {
        let errors = Errors::shipped("sloped_patch", &[refine]);
        for quantity in ["displacement", "energy", "traction", "slip", "gap"] {
            errors.within(quantity, 1e-10);
        }
    }
}

/// Source: formulas in the heads of the case files. Goal: the dissipation they expect at every increment is that of the
/// program's closed form, to the digits of quadrature.
#[test]
fn expected_dissipation_is_that_of_the_closed_form() {
    let mut count = 0;
    for case in shipped::CASES.iter().map(|(name, _)| shipped(name)) {
        let Some(exact) = &case.exact else { continue };
        let lines = &case.mesh.grid.lines;
        let end = |last: bool, a: usize| match lines.get(a) {
            Some(line) => line[if last { line.len() - 1 } else { 0 }],
            None => 0.0,
        };
        let setting = Setting {
            material: case.material,
            model: case.model,
            friction: case.cracks[0].friction,
            crack: &case.cracks[0].geometry,
            body: [false, true].map(|last| [0, 1, 2].map(|a| end(last, a))),
        };
        let solution = (exact.solution.build)(&setting, &exact.values).unwrap();
        let factors = exact.factors(&case.path);
        for expect in case.expects.iter().filter(|e| e.quantity == "dissipation") {
            let increment = expect.increment.unwrap_or(case.path.increments);
            let field = solution.at(&factors[..=increment]).unwrap();
            let exact = field.dissipation().unwrap();
            let error = (expect.value - exact).abs();
            assert!(
                error <= 1e-9 * exact,
                "{}: {} {exact}",
                case.name,
                expect.value
            );
            count += 1;
        }
    }
    assert!(count >= 18, "{count} expectations");
}

/// Source: McClintock & Walsh (1962), the closed form of `inclined_crack`. Goal: at ν = 0.4999 the energy error of a crack that
/// slides between tips with branch functions within a radius falls with order 1 and slip is right to 2 %: cells at a tip project
/// the dilatation on its singular modes, too.
///
/// ```text
///   cells                   10 × 10   20 × 20   40 × 40   80 × 80
///   energy                  2.4 %     2.1 %     1.3 %     0.7 %
///     means only            3.7 %     2.9 %     2.0 %
///     full                  18 %      17 %      13 %      9.6 %
///   slip                    1.7 %     2.0 %     1.6 %     1.0 %
///     means only            12 %      7.2 %     6.0 %
///     full                  22 %      64 %      53 %      31 %
/// ```
#[test]
fn a_sliding_crack_in_a_nearly_incompressible_body_keeps_its_accuracy() {
    let mut case = shipped("inclined_crack");
    case.material.poisson = 0.4999;
    let coarse = Errors::of(&case, &[1], None);
    coarse.within("energy", 0.03);
    coarse.within("slip", 0.03);
    let fine = Errors::of(&case, &[4], None);
    fine.within("energy", 0.016);
    fine.within("slip", 0.02);
    fine.within("k2_interaction", 2e-3);
}

/// Source: conforming quadratic elements, deflection 1.0973 m and mean slip 20.436 mm. Goal: the lips of a split beam slip in
/// bending; 60 × 5 cells find both within 3 % with assumed stress (1.2 % and 2.3 %), and lack 8 % and 13 % with the stress of the
/// gradient.
#[test]
fn a_split_beam_bends_and_slips() {
    let beam = "title = \"beam\"
        model = \"plane-strain\"
        material = { young_pa = 1e10, poisson = 0.3 }
        mesh = { box = { min_m = [0, 0], max_m = [20, 1], cells = [60, 5] } }
        [[crack]]
        points_m = [[0, 0.5], [12.03, 0.5]]
        friction = 0.3
        [[support]]
        on = \"right\"
        displacement_m = [0, 0]
        [[load]]
        on = \"left\"
        traction_pa = [0, -1e5]
        [[load]]
        on = \"top\"
        traction_pa = [0, -2e4]
        [[probe]]
        name = \"end\"
        point_m = [0, 1]
        ";
    let found = |text: &str| {
        let results = run(&parse(text), &[METHOD]);
        let value = |name: [&str; 3]| value(&results, |_| true, name);
        let deflection = value(["displacement", "end", "y"]) / -1.0973;
        let slip = value(["mean_slip", "crack-1", "a"]) / 2.0436e-2;
        println!("{deflection:.4} {slip:.4}");
        [deflection, slip]
    };
    for part in found(beam) {
        assert!((part - 1.0).abs() <= 0.03, "{part}");
    }
    let full = beam.replace("poisson = 0.3", "poisson = 0.3, dilatation = \"full\"");
    assert!(found(&full).iter().all(|part| *part < 0.92));
}
