//! Methods against each other and against independent solvers.

mod toys;

use stickslip_methods::*;
use toys::*;

const FRICTION: [f64; 5] = [0.0, 0.1, 0.3, 0.6, 1.0];

#[test]
fn probe_random_study() {
    for dim in [2, 3] {
        for mu in FRICTION {
            for m in METHODS {
                let mut rng = Random(7);
                let (mut ok, mut it, mut worst, mut fact) = (0, 0, 0, 0);
                let mut stat = vec![];
                for _ in 0..30 {
                    let (k, b) = random_body(&mut rng, dim, 12, 20, 0.05);
                    let body = elastic(dim, &k, &b, vec![], false);
                    let s = system(&body, mu);
                    let load = force(&s, &rng.vector(k.len()));
                    let o = run(m, &[], &s, &load, 1e-9);
                    let eta = judge(&s, &load, &o.state);
                    if o.status == Status::Converged {
                        ok += 1;
                        it += o.counters.iterations;
                        worst = worst.max(o.counters.iterations);
                        fact += o.counters.factorisations;
                        assert!(!m.exact || eta.natural_map <= 1e-9);
                        assert!(eta.equilibrium < 1e-12, "{}", eta.equilibrium)
                    } else {
                        stat.push(o.status.as_str());
                    }
                }
                eprintln!(
                    "dim {dim} mu {mu} {:22} ok {ok}/30 mean {:.1} worst {worst} fact {fact} {stat:?}",
                    m.name,
                    it as f64 / ok.max(1) as f64
                );
            }
        }
    }
}
