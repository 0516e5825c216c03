//! A method from outside: written with what the package exports, added to its registry, held to what is fair.

use crate::toys::*;
use stickslip_methods::law::return_map;
use stickslip_methods::*;

/// Uzawa's method without any refinement: P <- Π(P − r v), r = step/W_ii.
struct Uzawa {
    step: f64,
    limits: Limits,
}

const STEP: Real = Real {
    name: "step",
    default: 0.5,
    min: 1e-3,
    max: 2.0,
    help: "length of the step as a multiple of 1/W_ii",
};

static UZAWA: Method = Method {
    name: "uzawa",
    label: "Uzawa",
    reference: "Arrow, Hurwicz & Uzawa, Studies in Linear and Nonlinear Programming (1958)",
    summary: "moves the contact forces against the jump and maps them back",
    exact: true,
    options: &[OptionSpec::Real(STEP)],
    source: "//! ```text\n//! P <- Π(P − r v)\n//! ```\n",
    build: |options| {
        Box::new(Uzawa {
            step: options.real(&STEP),
            limits: Limits {
                iterations: 2000,
                patience: 200,
            },
        })
    },
};

impl CondensedMethod for Uzawa {
    /// Products are all it needs of W.
    fn needs(&self) -> Needs {
        Needs {
            delassus: DelassusForm::Products,
            ..Needs::default()
        }
    }

    fn iterate(
        &mut self,
        problem: &mut ContactProblem<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<End, MethodError> {
        let r = problem.scales(&vec![0.0; problem.len()]);
        let mut x = problem.start();
        loop {
            let v = problem.jump(&x.p, &x.beta);
            let violation = problem.violation(&x.p, &v);
            match problem.check(violation, (&x.p, &x.beta), 0, self.limits, monitor)? {
                Check::GoOn => {}
                Check::Corrected => continue,
                Check::End(status) => return Ok(End { status, at: x }),
            }
            for (i, own) in problem.rows.iter().enumerate() {
                for k in own.clone() {
                    x.p[k] -= self.step * r[k] * v[k];
                }
                return_map(problem.friction(i), &mut x.p[own]);
            }
        }
    }
}

#[test]
fn a_method_from_outside_is_listed_and_found_like_any_other() {
    let standard = Registry::standard();
    let registry = standard.clone().with(&UZAWA).unwrap();
    assert_eq!(registry.iter().len(), standard.iter().len() + 1);
    assert_eq!(registry.get("uzawa").unwrap().name, "uzawa");
    assert_eq!(registry.position("uzawa"), Some(standard.iter().len()));
    assert!(registry.names().ends_with(", uzawa"));
    assert!(UZAWA.page().contains("P <- Π(P − r v)"));
}

/// Goal: where it converges its answer is right and W was never formed; where it does not, it says so with a state of the
/// right size, the same one every time. That is all a test may ask of a method.
#[test]
fn a_simple_method_solves_what_is_easy_and_fails_fairly_elsewhere() {
    let (mut solved, mut failed) = (0, 0);
    for mu in [0.0, 0.1, 0.5, 2.0, 50.0] {
        for seed in 0..8 {
            let mut rng = Random(700 + seed);
            let (k, b) = random_body(&mut rng, 3, 4, 6, 0.5);
            let body = elastic(3, &k, &b, vec![], false);
            let (s, f) = (system(&body, mu), rng.vector(k.len()));
            let load = force(&s, &f);
            let outcome = run(&UZAWA, &[], &s, &load, 1e-8);
            assert_eq!(outcome, run(&UZAWA, &[], &s, &load, 1e-8), "the same bits");
            let sizes = (outcome.state.u.len(), outcome.state.p.len());
            assert_eq!(sizes, (k.len(), b.len()));
            let judged = judge(&s, &load, &outcome.state);
            assert_eq!(body.counters().condensations, 0);
            if converged(&UZAWA, &outcome) {
                assert!(
                    judged.violation <= 1e-8,
                    "a claim holds: mu {mu} {judged:?}"
                );
                solved += 1;
            } else {
                assert!(outcome.state.p.iter().all(|p| p.is_finite()));
                failed += 1;
            }
        }
    }
    assert!(solved >= 10, "{solved} solved, {failed} failed");
    assert!(failed > 0, "fair failures are what this test is about");
}
