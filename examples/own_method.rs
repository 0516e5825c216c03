//! A method of one's own, judged like any other: Uzawa's, P ← Π(P − v/(5 W_ii)), on the plate of the founding paper.
use stickslip::case::shipped;
use stickslip::run::{choice::Choice, progress::Quiet};
use stickslip::studies::cases::{Settings, run_case};
use stickslip_methods::{law::return_map, *};

struct Uzawa;

static UZAWA: Method = Method {
    name: "uzawa",
    label: "Uzawa",
    reference: "Arrow, Hurwicz & Uzawa (1958)",
    summary: "moves the contact forces against the jump and maps them back",
    exact: true,
    options: &[],
    source: "//! P ← Π(P − v/(5 W_ii))",
    build: |_| Box::new(Uzawa),
};

impl CondensedMethod for Uzawa {
    fn iterate(&mut self, problem: &mut ContactProblem<'_>, to: &mut dyn Monitor) -> Ended {
        let r = problem.scales(&vec![0.0; problem.len()]);
        let (limits, mut x) = (Limits::new(50_000, 5000), problem.start());
        loop {
            let v = problem.jump(&x.p, &x.beta);
            let violation = problem.violation(&x.p, &v);
            let check = problem.check(violation, (&x.p, &x.beta), 0, limits, to)?;
            if let Check::End(status) = check {
                return Ok(End { status, at: x });
            }
            for (i, own) in problem.rows.iter().enumerate() {
                own.clone().for_each(|k| x.p[k] -= 0.2 * r[k] * v[k]);
                return_map(problem.friction(i), &mut x.p[own]);
            }
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plate = shipped::find("plate_mesh1").ok_or("no such case")??;
    let results = run_case(
        &plate,
        &[Choice::new(&UZAWA, &[])?],
        Settings::PLAIN,
        &Quiet,
    )?;
    println!("{}", stickslip::report::standard::summary(&results));
    assert_eq!(results.failures(), 0);
    Ok(())
}
