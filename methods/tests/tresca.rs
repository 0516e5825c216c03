//! The Tresca problem is convex: with the friction bound of a Coulomb solution, that solution minimises it.
//! ```text
//! min J(P) = ½ P·W P + q·P   over P_n >= 0, |P_t| <= g,      g = μ P_n of the Coulomb solution
//! ```
//! It tells a wrong answer of a solver from a difficulty of Coulomb's law, and an independent code can solve it.

use crate::toys::*;
use clarabel::solver::SupportedConeT;
use stickslip_methods::*;

/// W and q of a random body under a random load.
struct Problem {
    W: Rows,
    q: Vec<f64>,
    dim: usize,
    load: Load,
    k: Rows,
    b: Rows,
}

impl Problem {
    fn random(rng: &mut Random, dim: usize, points: usize) -> Self {
        let (k, b) = random_body(rng, dim, points, 10, 0.1);
        let f = rng.vector(k.len());
        Self {
            W: delassus(&k, &b),
            q: mul(&b, &solve(&k, &f)),
            dim,
            load: load(f, vec![0.0; dim * points]),
            k,
            b,
        }
    }

    fn system(&self, mu: f64) -> ContactSystem {
        system(&elastic(self.dim, &self.k, &self.b, vec![], false), mu)
    }

    fn objective(&self, P: &[f64]) -> f64 {
        let WP = mul(&self.W, P);
        let terms = P.iter().zip(WP).zip(&self.q);
        terms.map(|((p, wp), q)| p * (0.5 * wp + q)).sum()
    }

    /// The minimiser by clarabel, at its default accuracy of 1e-8.
    fn minimiser(&self, bounds: &[f64]) -> Vec<f64> {
        let (m, dim) = (self.q.len(), self.dim);
        // Per point P_n >= 0 and (g, P_t) in a second-order cone.
        let (mut rows, mut right, mut cones): (Rows, Vec<f64>, Vec<_>) = Default::default();
        let unit = |k: usize| (0..m).map(|j| if j == k { -1.0 } else { 0.0 }).collect();
        for (i, g) in bounds.iter().enumerate() {
            rows.push(unit(dim * i));
            rows.push(vec![0.0; m]);
            rows.extend((1..dim).map(|k| unit(dim * i + k)));
            right.extend([0.0, *g]);
            right.extend(vec![0.0; dim - 1]);
            cones.push(SupportedConeT::NonnegativeConeT(1));
            cones.push(SupportedConeT::SecondOrderConeT(dim));
        }
        minimise(&self.W, &self.q, (&rows, &right, &cones), 1e-8).x
    }
}

#[test]
fn every_exact_coulomb_solution_minimises_the_tresca_problem_of_its_own_bound() {
    let mut rng = Random(29);
    for (dim, points, mu) in [(2, 10, 0.3), (2, 10, 0.9), (3, 8, 0.3), (3, 8, 0.9)] {
        let problem = Problem::random(&mut rng, dim, points);
        let s = problem.system(mu);
        let solution = |m: &Method, s: &_| Some(solved(m, &[], s, &problem.load, 1e-12)?.state.p);
        let tresca = method("tresca").unwrap();
        let reference = solution(tresca, &s).unwrap();
        let normal = reference.iter().step_by(dim);
        let bounds: Vec<f64> = normal.map(|p| mu * p.max(0.0)).collect();
        let least = problem.objective(&reference);
        let off = |P: &[f64]| (problem.objective(P) / least - 1.0).abs();

        let independent = problem.minimiser(&bounds);
        assert!(
            off(&independent) < 1e-6,
            "clarabel: {:e}",
            off(&independent)
        );
        assert!(difference(&independent, &reference) < 1e-5);
        let rounding = 1e-10 * bounds.iter().fold(0.0, |m: f64, g| m.max(*g));
        for m in exact() {
            let Some(P) = solution(&m, &s) else { continue };
            let at = format!("{} dim {dim} mu {mu}: {:e}", m.name, off(&P));
            assert!(off(&P) < 1e-10, "{at}");
            for (P, g) in P.chunks(dim).zip(&bounds) {
                let t = P[1..].iter().map(|x| x * x).sum::<f64>().sqrt();
                assert!(P[0] > -rounding && t < g + rounding, "{at}");
            }
        }
        // Another friction is another problem.
        let other = solution(tresca, &problem.system(0.8 * mu)).unwrap();
        assert!(off(&other) > 1e-5, "dim {dim} mu {mu}: {:e}", off(&other));
    }
}

/// Residuals that clarabel cannot reach are not claimed; one or two Newton steps reach them.
#[test]
fn unpolished_fixed_points_end_at_their_floor_and_say_so() {
    let mut rng = Random(30);
    for dim in [2, 3] {
        let problem = Problem::random(&mut rng, dim, 8);
        let s = problem.system(0.4);
        for name in ["socp", "tresca"] {
            let m = method(name).unwrap();
            let raw = run(m, &[("polish", 0.0)], &s, &problem.load, 1e-13);
            assert_eq!(raw.status, Status::Stalled, "{name} dim {dim}");
            let floor = judge(&s, &problem.load, &raw.state).violation;
            assert!(
                (1e-13..1e-6).contains(&floor),
                "{name} dim {dim}: {floor:e}"
            );

            let polished = solved(m, &[], &s, &problem.load, 1e-13).unwrap().history;
            let newton = polished.iter().filter(|i| i.violation <= 1e-6);
            assert!(newton.count() <= 4, "{name} dim {dim}: {polished:?}");
        }
    }
}
