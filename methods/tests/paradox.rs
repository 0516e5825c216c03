//! Where Coulomb friction has several solutions or none: every method from three starts, with its status.
//!
//! Sources: Klarbring, Ing. Arch. 60 (1990) 529; Janovský 1981. One contact with W = [[1, −1], [−1, 2]] has exactly one
//! solution for every load if and only if μ < W_nn/|W_nt| = 1.

use std::sync::Arc;

use crate::toys::*;
use stickslip_methods::*;

const W: [[f64; 2]; 2] = [[1.0, -1.0], [-1.0, 2.0]];

/// Contacts of that kind side by side, coupled by `coupling` between their equal rows.
fn contacts(count: usize, coupling: f64) -> (Rows, Arc<Elastic>) {
    let m = 2 * count;
    let entry = |i: usize, j: usize| match i / 2 == j / 2 {
        true => W[i % 2][j % 2],
        false if i % 2 == j % 2 => coupling,
        false => 0.0,
    };
    let row = |i: usize| (0..m).map(|j| entry(i, j)).collect();
    let w: Rows = (0..m).map(row).collect();
    let body = Elastic::from_delassus(2, sparse(&w), vec![]).unwrap();
    (w, body)
}

/// Conclusion from the answers from several starts.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Uniqueness {
    /// Nothing closes without contact forces, so that every method answers with the open crack: starts do not matter.
    Open,
    Solved,
    /// Every start led to a solution, and they differ.
    Several,
    /// Some start led to a claim of a state that breaks the laws it is about.
    FalseClaim,
    /// Some start led nowhere, the first of them so.
    Failed(Status),
}

/// Solves from no forces, from those of tied points and from tension.
fn from_all_starts(
    method: &mut dyn Enforcement,
    i: &Increment<'_>,
) -> (Uniqueness, Vec<ContactState>) {
    let starts: Vec<_> = (0..3).map(|number| guess(i, number).unwrap()).collect();
    let (mut states, mut failed, mut broken) = (Vec::new(), None, false);
    for guess in &starts {
        let guess = guess.as_deref();
        let posed = Increment { guess, ..*i };
        let outcome = method.solve(&posed, &mut Silent).unwrap();
        if outcome.status == Status::Converged {
            let judged = residuals_of(&posed, &outcome.state, outcome.claim).unwrap();
            // A NaN is no solution.
            broken |= judged.claimed.is_nan() || judged.claimed > i.tolerance;
        } else {
            failed = failed.or(Some(outcome.status));
        }
        states.push(outcome.state);
    }
    // Tension is as large as the reference force.
    let largest = |m: f64, p: &f64| m.max(p.abs());
    let size = starts.iter().flatten().flatten().fold(0.0, largest);
    let first: &ContactState = &states[0];
    let same = |s: &ContactState| {
        let mut apart = s.p.iter().zip(&first.p).map(|(a, b)| (a - b).abs());
        apart.all(|apart| apart <= 1e4 * i.tolerance * size)
    };
    let verdict = match failed {
        _ if broken => Uniqueness::FalseClaim,
        Some(status) => Uniqueness::Failed(status),
        None if starts[0].is_none() => Uniqueness::Open,
        None if states.iter().all(same) => Uniqueness::Solved,
        None => Uniqueness::Several,
    };
    (verdict, states)
}

/// Runs a method from all starts; whatever it claims must be one of the solutions found by trying all states.
fn study(m: &Method, body: &Arc<Elastic>, w: &Rows, mu: f64, q: &[f64]) -> (Uniqueness, usize) {
    let s = system(body, mu);
    let (load, rest, start) = (free_jump(q), Load::zero(body), ContactState::zero(&s));
    let i = increment(&s, &load, &rest, &start, 1e-9);
    let (verdict, states) = from_all_starts(build(m, &[]).as_mut(), &i);
    let known = enumerate(w, q, mu);
    if !matches!(verdict, Uniqueness::Failed(_)) {
        let size = q.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        for state in &states {
            let at = format!("{} μ {mu} q {q:?}: {:?}", m.name, state.p);
            let off = |k: &Vec<f64>| {
                k.iter()
                    .zip(&state.p)
                    .all(|(k, p)| (k - p).abs() < 1e-7 * size)
            };
            assert!(known.iter().any(off), "{at} is none of {known:?}");
            assert!(residuals(&i, state).unwrap().violation <= 1e-9, "{at}");
        }
    }
    (verdict, known.len())
}

#[test]
fn below_the_critical_friction_every_start_of_every_method_leads_to_the_one_solution() {
    let (w, body) = contacts(1, 0.0);
    for m in exact() {
        for mu in [0.3, 0.9] {
            for k in 0..24 {
                let angle = f64::from(k) * std::f64::consts::TAU / 24.0;
                let (verdict, solutions) = study(&m, &body, &w, mu, &[angle.cos(), angle.sin()]);
                let open = angle.cos() >= 0.0;
                let expected = [Uniqueness::Solved, Uniqueness::Open][usize::from(open)];
                let gave_up = matches!(verdict, Uniqueness::Failed(_)) && !solves_every_toy(&m);
                let at = format!("{} μ {mu} angle {angle}: {verdict:?}", m.name);
                assert!(gave_up || (verdict, solutions) == (expected, 1), "{at}");
            }
        }
    }
}

/// q = (0.1, −0.4) at μ = 2: open; stick P = (0.2, 0.3); slip P = (0.1, 0.2). Nothing closes without forces, so that
/// every method answers open after one solve, wherever it starts. The verdict must not call that unique.
#[test]
fn an_open_solution_is_found_before_any_other() {
    let (w, body) = contacts(1, 0.0);
    let mut known = enumerate(&w, &[0.1, -0.4], 2.0);
    known.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for (found, expected) in known.iter().zip([[0.0, 0.0], [0.1, 0.2], [0.2, 0.3]]) {
        (0..2).for_each(|k| assert_near(found[k], expected[k], 1e-12, &known));
    }
    for m in exact() {
        let (verdict, solutions) = study(&m, &body, &w, 2.0, &[0.1, -0.4]);
        assert_eq!((verdict, solutions), (Uniqueness::Open, 3), "{}", m.name);
    }
}

/// Two such contacts, one of them pressed so that the contact problem has to be solved: of nine solutions methods find
/// different ones from different starts, and say no more than they know.
#[test]
fn above_the_critical_friction_different_starts_may_lead_to_different_solutions() {
    let (w, body) = contacts(2, 1e-3);
    let q = [0.1, -0.4, -1.0, 0.3];
    let mut verdicts = std::collections::BTreeMap::new();
    for m in exact() {
        let (verdict, solutions) = study(&m, &body, &w, 2.0, &q);
        assert!(solutions >= 3, "{solutions}");
        verdicts.insert(m.name, verdict);
    }
    let differ = verdicts.values().any(|v| *v == Uniqueness::Several);
    assert!(
        differ,
        "the study must be able to see several solutions: {verdicts:?}"
    );
    use Status::{MaxIterations, SingularTangent, Stalled};
    let allowed = [
        Uniqueness::Solved,
        Uniqueness::Several,
        Uniqueness::Failed(Stalled),
        Uniqueness::Failed(MaxIterations),
        Uniqueness::Failed(SingularTangent),
    ];
    assert!(
        verdicts.values().all(|v| allowed.contains(v)),
        "{verdicts:?}"
    );
}

/// Two points on the same place share one force in any proportion: tied forces exist, but W alone does not determine them.
#[test]
fn redundant_points_are_solved_from_every_start() {
    let row = |i: usize| (0..4).map(move |j| f64::from(u8::from(i % 2 == j % 2)));
    let w: Rows = (0..4).map(|i| row(i).collect()).collect();
    let body = Elastic::from_delassus(2, sparse(&w), vec![]).unwrap();
    let s = system(&body, 0.3);
    let load = free_jump(&[-1.0, 0.1, -1.0, 0.1]);
    let (rest, start) = (Load::zero(&body), ContactState::zero(&s));
    let i = increment(&s, &load, &rest, &start, 1e-9);
    for m in exact() {
        let (verdict, states) = from_all_starts(build(&m, &[]).as_mut(), &i);
        assert!(!matches!(verdict, Uniqueness::Failed(_)), "{}", m.name);
        for p in states.iter().map(|s| &s.p) {
            assert_near(p[0] + p[2], 1.0, 1e-7, m.name);
        }
    }
}

/// Answers whatever it starts from.
struct Parrot;

impl Enforcement for Parrot {
    fn prepare(&mut self, _system: &ContactSystem) -> Result<(), MethodError> {
        Ok(())
    }

    fn solve(&mut self, i: &Increment<'_>, _: &mut dyn Monitor) -> Result<Outcome, MethodError> {
        Ok(Outcome {
            status: Status::Converged,
            claim: Claim::Exact,
            state: i.start.clone(),
            history: vec![],
            counters: Counters::default(),
        })
    }
}

#[test]
fn false_claims_count_for_nothing_and_claims_of_other_laws_for_these() {
    let (_, body) = contacts(1, 0.0);
    let s = system(&body, 0.5);
    let (rest, start) = (Load::zero(&body), ContactState::zero(&s));
    // Once the solution is open, once it is not: the state at rest is none of either.
    for q in [[-1.0, 0.2], [1.0, 0.2]] {
        let load = free_jump(&q);
        let i = increment(&s, &load, &rest, &start, 1e-9);
        let mut penetrating = start.clone();
        penetrating.u[0] = -2.0;
        let start = &penetrating;
        let i = Increment { start, ..i };
        let (verdict, _) = from_all_starts(&mut Parrot, &i);
        assert_eq!(verdict, Uniqueness::FalseClaim);
    }
    let load = free_jump(&[-1.0, 0.2]);
    let i = increment(&s, &load, &rest, &start, 1e-9);
    for name in ["penalty", "barrier"] {
        let mut method = build(method(name).unwrap(), &[]);
        let (verdict, _) = from_all_starts(method.as_mut(), &i);
        assert_eq!(verdict, Uniqueness::Solved, "{name}");
    }
}

/// Semi-coercive: a block that nothing holds sideways, pushed beyond its friction. No equilibrium exists.
#[test]
fn without_a_solution_no_start_of_any_method_ends_in_a_claim() {
    let body = block(1.0, 0.8, 50.0, 0.0);
    let s = system(&body, 0.3);
    let load = force(&s, &[0.0, 0.0, 0.0, 0.0, 4.0, -10.0]);
    let (rest, start) = (Load::zero(&body), ContactState::zero(&s));
    let i = increment(&s, &load, &rest, &start, 1e-9);
    for m in exact() {
        let limit = m.options.iter().find(|o| o.name().starts_with("max_"));
        let given = limit.map(|limit| (limit.name(), limit.default().number().min(200.0)));
        let mut method = build(&m, given.as_slice());
        let (verdict, _) = from_all_starts(method.as_mut(), &i);
        let Uniqueness::Failed(status) = verdict else {
            panic!("{}: {verdict:?}", m.name)
        };
        let honest = [
            Status::Mechanism,
            Status::MaxIterations,
            Status::Stalled,
            Status::SingularTangent,
            Status::Diverged,
        ];
        assert!(honest.contains(&status), "{}: {status}", m.name);
    }
}

/// The rate problem: on a path of loads at μ = 2 the sticking solution ends at a fold and the answer jumps. Each increment
/// still has a solution, and every method must find one or say that it did not.
#[test]
fn a_path_through_a_fold_jumps_but_every_claim_holds() {
    let (w, body) = contacts(1, 0.0);
    let s = system(&body, 2.0);
    for m in exact() {
        let mut method = build(&m, &[]);
        let (mut state, mut before) = (ContactState::zero(&s), Load::zero(&body));
        let (mut jumps, mut solved) = (0, 0);
        for k in 1..=20 {
            let t = f64::from(k) / 20.0;
            let load = free_jump(&[-0.2 + 0.4 * t, -0.6 * t]);
            let i = increment(&s, &load, &before, &state, 1e-9);
            let outcome = method.solve(&i, &mut Silent).unwrap();
            if outcome.status != Status::Converged {
                break;
            }
            let found = residuals(&i, &outcome.state).unwrap().violation;
            assert!(found <= 1e-9, "{}: {found:e}", m.name);
            // The jump of one increment's slip: q less the start's tangential jump.
            let start = i.start_jump();
            let q = [load.offset[0], load.offset[1] - start[1]];
            let known = enumerate(&w, &q, 2.0);
            let near = |k: &Vec<f64>| (0..2).all(|a| (k[a] - outcome.state.p[a]).abs() < 1e-7);
            assert!(known.iter().any(near), "{} step {k}: {known:?}", m.name);
            let moved = (outcome.state.p[0] - state.p[0]).abs();
            jumps += usize::from(k > 1 && moved > 0.15);
            (state, before) = (outcome.state, load);
            solved = k;
        }
        assert!(jumps <= 1, "{}", m.name);
        let steps = solved >= 5 || !solves_every_toy(&m);
        assert!(steps, "{}: {solved} steps", m.name);
    }
}
