//! Numbers that must not depend on where the body lies, in which units, and on how many threads it is computed.

use crate::common::*;
use stickslip::case::shipped;
use stickslip::model::body::{Body, Needs};
use stickslip::run::progress::Quiet;
use stickslip::studies::cases::{Fields, Settings, run_case};
use stickslip::studies::results::Results;

/// Rounding times the conditioning of a plate of a few hundred unknowns.
const EQUAL: f64 = 1e-10;

/// With tips: the triangles of the cells around a tip start at their first corner, which turns with the body, and their
/// rule is good to 1e-10; contact forces feel that most.
const EQUAL_WITH_TIPS: f64 = 1e-8;

/// A change of coordinates: a signed permutation with determinant ±1, a factor and a shift; and a factor on stresses.
struct Change {
    /// Column a: image of axis a, as (axis, sign).
    axes: [(usize, f64); 2],
    length: f64,
    shift: [f64; 2],
    stress: f64,
}

impl Change {
    fn vector(&self, v: [f64; 2]) -> [f64; 2] {
        let mut w = [0.0; 2];
        for a in 0..2 {
            w[self.axes[a].0] += self.axes[a].1 * v[a];
        }
        w
    }

    fn place(&self, x: [f64; 2]) -> [f64; 2] {
        let v = self.vector(x);
        [0, 1].map(|a| self.length * v[a] + self.shift[a])
    }

    /// Name of the side with outward normal `n` before the change.
    fn side(&self, n: [f64; 2]) -> &'static str {
        match self.vector(n) {
            [x, _] if x > 0.5 => "right",
            [x, _] if x < -0.5 => "left",
            [_, y] if y > 0.0 => "top",
            _ => "bottom",
        }
    }

    /// A plate 1.5 × 1.2 with an inclined crack with two tips and one that runs through, pushed, sheared and loaded.
    fn case(&self, tip: &str) -> String {
        let (low, high) = (self.place([0.0, 0.0]), self.place([1.5, 1.2]));
        let min = [0, 1].map(|a| low[a].min(high[a]));
        let max = [0, 1].map(|a| low[a].max(high[a]));
        let swapped = self.axes[0].0 == 1;
        let cells = if swapped { [8, 10] } else { [10, 8] };
        let cracks = [
            ([0.31, 0.27], [1.02, 0.43], 0.4, tip),
            ([-0.2, 0.88], [1.7, 0.81], 0.2, "none"),
        ];
        let displacement = self.vector([1e-3, -2e-3]).map(|v| self.length * v);
        let traction = self.vector([0.0, 3e-4]).map(|v| self.stress * v);
        let rest = cracks
            .iter()
            .map(|&(p, q, mu, tip)| crack(self.place(p), self.place(q), mu, tip))
            .collect::<String>()
            + &support(&format!("{:?}", self.side([0.0, -1.0])), "[0, 0]")
            + &support(
                &format!("{:?}", self.side([0.0, 1.0])),
                &format!("{displacement:?}"),
            )
            + &load(
                self.side([1.0, 0.0]),
                &format!("traction_pa = {traction:?}"),
            );
        let text = plane(min, max, cells, &rest);
        text.replace("young_pa = 1", &format!("young_pa = {:e}", self.stress))
    }

    /// Reaction at the former top, in former axes, over E L; forces over E L; jumps over L.
    fn numbers(&self, tip: &str) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let found = solve(&self.case(tip));
        let force = self.stress * self.length;
        let reaction = [0, 1].map(|a| {
            let (axis, sign) = self.axes[a];
            sign * found.reaction(self.side([0.0, 1.0]), axis) / force
        });
        (
            reaction.to_vec(),
            found.p().iter().map(|p| p / force).collect(),
            found.jump.iter().map(|j| j / self.length).collect(),
        )
    }
}

const PLAIN: Change = Change {
    axes: [(0, 1.0), (1, 1.0)],
    length: 1.0,
    shift: [0.0, 0.0],
    stress: 1.0,
};

/// Source: objectivity, dimensional analysis. Goal: turned by 90, 180 and 270 degrees, mirrored, shifted, in mm, in Pa, and
/// all at once: the same dimensionless reactions, contact forces and jumps, point by point.
#[test]
fn a_turned_mirrored_shifted_and_rescaled_body_gives_the_same_numbers() {
    let turned = |axes, length, shift, stress| Change {
        axes,
        length,
        shift,
        stress,
    };
    let plain = PLAIN.axes;
    let quarter = [(1, 1.0), (0, -1.0)];
    let half = [(0, -1.0), (1, -1.0)];
    let three = [(1, -1.0), (0, 1.0)];
    let changes = [
        turned(quarter, 1.0, [0.0, 0.0], 1.0),
        turned(half, 1.0, [0.0, 0.0], 1.0),
        turned(three, 1.0, [0.0, 0.0], 1.0),
        turned(plain, 1e3, [0.0, 0.0], 1.0),
        turned(plain, 1e-3, [0.0, 0.0], 1.0),
        turned(plain, 1.0, [0.0, 0.0], 1e10),
        // The smallest and largest displacements and loads a case may name.
        turned(plain, 1e-21, [0.0, 0.0], 1e-21),
        turned(plain, 5e24, [0.0, 0.0], 1e25),
        turned(plain, 1.0, [17.3, -5.1], 1.0),
        turned(three, 1e3, [-4e3, 9e2], 2.1e11),
        turned([(0, -1.0), (1, 1.0)], 1.0, [0.0, 0.0], 1.0),
    ];
    // In the mirror the crack turns its other side up: pressure and gap stay, shear and slip change sign.
    let mirror = [(0, -1.0), (1, 1.0)];
    let flip = |change: &Change, v: Vec<f64>| -> Vec<f64> {
        let sign = |i: usize| {
            if change.axes == mirror && i % 2 == 1 {
                -1.0
            } else {
                1.0
            }
        };
        v.into_iter()
            .enumerate()
            .map(|(i, v)| sign(i) * v)
            .collect()
    };
    for (tip, equal) in [("none", EQUAL), ("branch", EQUAL_WITH_TIPS)] {
        let (reaction, forces, jumps) = PLAIN.numbers(tip);
        for change in &changes {
            let (r, p, j) = change.numbers(tip);
            let (p, j) = (flip(change, p), flip(change, j));
            let differences = [(r, &reaction), (p, &forces), (j, &jumps)]
                .map(|(found, exact)| relative_difference(&found, exact));
            let name = format!("{:?} {:e} {:e}", change.axes, change.length, change.stress);
            println!("{tip} {name}: {differences:?}");
            assert!(
                differences.iter().all(|d| *d < equal),
                "{tip} {name}: {differences:?}"
            );
        }
    }
}

/// Source: objectivity. Goal: a solid with its axes renamed x → y → z → x gives the same reactions and point forces.
/// An oblique plane with friction; the frame (n, a, b) of a plane is chosen by axes, so P_n and |P_t| are compared.
#[test]
fn a_solid_with_renamed_axes_gives_the_same_numbers() {
    let numbers = |turns: usize| {
        let turn = |v: [f64; 3]| {
            let mut w = v;
            w.rotate_right(turns);
            w
        };
        let names = [["left", "right"], ["front", "back"], ["bottom", "top"]];
        let side = |axis: usize, end: usize| names[(axis + turns) % 3][end];
        let cells = {
            let mut c = [3, 2, 4];
            c.rotate_right(turns);
            c
        };
        let planes = [(turn([0.6, 0.4, 0.9]), turn([0.13, 0.07, 1.0]), 0.2)];
        let top = side(2, 1);
        let rest = support(&format!("{:?}", side(2, 0)), "[0, 0, 0]")
            + &support(
                &format!("{top:?}"),
                &format!("{:?}", turn([1e-3, 4e-4, -2e-3])),
            )
            + &load(
                side(0, 1),
                &format!("traction_pa = {:?}", turn([-1e-4, 2e-4, 0.0])),
            );
        let found = solve(&solid(turn([1.2, 0.8, 1.6]), cells, &planes, &rest));
        let reaction: Vec<f64> = (0..3)
            .map(|a| found.reaction(top, (a + turns) % 3))
            .collect();
        let mut forces: Vec<[f64; 2]> = found
            .p()
            .chunks_exact(3)
            .map(|p| [p[0], p[1].hypot(p[2])])
            .collect();
        // The points come in the order of their coordinates.
        forces.sort_by(|p, q| p[0].total_cmp(&q[0]));
        (reaction, forces.concat())
    };
    let (reaction, forces) = numbers(0);
    for turns in [1, 2] {
        let (r, p) = numbers(turns);
        let change = relative_difference(&r, &reaction).max(relative_difference(&p, &forces));
        assert!(change < EQUAL, "{turns}: {change:e}");
    }
}

/// Everything in results but times; numbers print with as many digits as tell them from their neighbours.
fn bits(results: &Results) -> String {
    let found = results.answers.iter().map(|own| {
        let found = &own.record.found;
        (found, &own.histories, &own.points, &own.fields, &own.jumps)
    });
    let found: Vec<_> = found.collect();
    format!("{found:?} {:?} {:?}", results.exact, results.expectations)
}

/// Source: every entry is summed in one order. Goal: stiffness, jump operator and everything a run reports have the same
/// bits for 1, 2 and 5 threads: a plate with tips by all exact methods, a sliding block, and a solid.
#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let block = solid(
        [1.0, 1.0, 1.0],
        [4, 4, 5],
        &[([0.5, 0.5, 0.5], [0.1, 0.2, 1.0], 0.3)],
        &(support("\"bottom\"", "[0, 0, 0]") + &support("\"top\"", "[1e-3, 5e-4, -1e-3]")),
    );
    let mut plate = shipped::find("plate_mesh1").unwrap().unwrap();
    plate.sweep.friction = vec![0.1];
    let cases = [
        (plate, vec!["b-newton", "latin", "augmented-lagrangian"]),
        (parse(&block), vec!["b-newton"]),
    ];
    for (case, methods) in &cases {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                let body = Body::new(case, 1, &Needs::default()).unwrap();
                let k = body.elastic.stiffness().unwrap().values();
                let k: Vec<u64> = k.iter().map(|v| v.to_bits()).collect();
                (k, bits(&run(case, methods)))
            })
        };
        let one = on(1);
        for threads in [2, 5] {
            assert!(on(threads) == one, "{}: {threads} threads", case.name);
        }
    }
}

/// Goal: runs at the same time give the rows of runs one after the other, without times.
#[test]
fn jobs_change_nothing_but_the_times() {
    let case = shipped::find("sliding_block_embedded").unwrap().unwrap();
    let methods = choices(&["penalty", "latin"]);
    let [one, two] = [1, 2].map(|jobs| {
        let settings = Settings {
            jobs,
            ..Settings::PLAIN
        };
        run_case(&case, &methods, settings, &Quiet).unwrap()
    });
    assert!(bits(&one) == bits(&two));
    assert!(one.records().all(|run| run.spent.is_some()));
    assert!(two.records().all(|run| run.spent.is_none()));
}

/// Source: translation; numbers that are multiples of 1/16, moved by powers of two, are exact. Goal: a million sizes from zero
/// a body gives every bit it gives near it: loads that vary in space, conditions, probes, cracks and twisted lines go along,
/// and tables and fields have the coordinates of the file.
#[test]
fn a_body_far_from_zero_gives_the_same_bits() {
    let far = [1048576.0, 2097152.0];
    let case = |by: [f64; 2]| {
        let at = |x: f64, y: f64| [x + by[0], y + by[1]];
        let cracks = crack(at(0.3125, 0.25), at(1.0, 0.4375), 0.4, "branch")
            + &crack(at(-0.25, 0.875), at(1.75, 0.8125), 0.2, "none");
        let gradient = [0.0, -0.25];
        let at_origin = 0.5 - gradient[0] * by[0] - gradient[1] * by[1];
        let [edge, height] = at(0.75, 0.5625);
        let rest = format!(
            "{cracks}[mesh.twist]\nangle_deg = 5\n\
             [[support]]\non = \"bottom\"\ndisplacement_m = [0, 0]\n\
             [[support]]\non = \"right\"\nwhere = \"y >= {height} or x < {edge}\"\ndisplacement_m = [-0.0625, 0]\n\
             [[load]]\non = \"top\"\nwhere = \"x <= {edge}\"\n\
             pressure_pa = {{ at_origin_pa = {at_origin}, gradient_pa_per_m = {gradient:?} }}\n\
             [[probe]]\nname = \"corner\"\npoint_m = {:?}\n",
            at(0.0, 1.25)
        );
        let text = plane(at(0.0, 0.0), at(1.5, 1.25), [12, 10], &rest);
        let text = text
            .replace("mesh = { box", "[mesh]\nbox")
            .replace("] } }\n", "] }\n");
        // Tables follow the keys of the root.
        let (head, mesh) = text.split_once("[mesh]").unwrap();
        stickslip::case::parse("far.toml", format!("{head}[mesh]{mesh}")).unwrap()
    };
    let results = |by| {
        let settings = Settings {
            fields: Fields::All,
            ..Settings::PLAIN
        };
        run_case(&case(by), &choices(&["hybrid"]), settings, &Quiet).unwrap()
    };
    let (near, away) = (results([0.0; 2]), results(far));
    assert_eq!(near.increments()[0].step.verdict.to_string(), "solved");
    assert!(near.points().len() > 10);
    for (p, q) in near.points().iter().zip(&away.points()) {
        let forces = |r: &stickslip::model::quantities::PointState| {
            [r.p_n, r.p_a, r.gap_m, r.slip_a_m, r.weight].map(f64::to_bits)
        };
        assert_eq!(forces(p.point), forces(q.point));
        assert_near(p.point.x_m + far[0], q.point.x_m, 1e-9, "x");
        assert_near(p.point.y_m + far[1], q.point.y_m, 1e-9, "y");
    }
    assert_eq!(near.points().len(), away.points().len());
    for (a, b) in near.quantities().iter().zip(&away.quantities()) {
        // Not-a-number is like itself.
        let [a, b] = [a, b].map(|row| format!("{:?}", row.quantity));
        assert_eq!(a, b);
    }
    let corners = |r: &Results| r.answers[0].fields[0].body.points.clone();
    for (x, y) in corners(&near).iter().zip(corners(&away)) {
        assert_near(x[0] + far[0], y[0], 1e-9, "field");
    }
}
