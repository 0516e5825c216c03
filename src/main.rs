//! Command line.

use stickslip::harness::{case, run};

fn main() {
    for file in std::env::args().skip(1) {
        let case = match case::read(&file) { Ok(c) => c, Err(e) => { eprintln!("{e}"); continue; } };
        let settings = run::Settings { tier: None, jobs: 1 };
        match run::run_case(&case, &[], settings, &run::Quiet) {
            Err(e) => eprintln!("{e}"),
            Ok(results) => {
                for r in &results.runs { println!("{} {} {} {} mu={} k={} {} eta={:.2e} it={} fac={} sol={} m={} nc={} n={} asm={:.4} fac={:.4} cond={:.4} prep={:.4} solve={:.4} eq={:.1e} setup={:.3}", r.key.case, r.key.mesh, r.key.space, r.key.method, r.key.friction, r.key.increment, r.verdict, r.natural_map, r.iterations, r.factorisations, r.solves, r.unknowns, r.points, r.dofs, r.assembly_s, r.factorisation_s, r.condensation_s, r.prepare_s, r.solve_s, r.equilibrium, r.setup_s); }
                for e in &results.expectations { println!("{} {} mu={} {} {} {} {}: expected {} found {} allowed {:e} diff {:e}", e.verdict, e.key.method, e.key.friction, e.quantity, e.at, e.component, e.key.increment, e.expected, e.found, e.allowed, e.found-e.expected); }
            }
        }
    }
}
