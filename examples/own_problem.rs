//! W, q and μ of one's own by all methods: two points in the plane, pressed together and sheared.
use stickslip_methods::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Lower triangle of W by columns; rows n, a of the first point, then of the second.
    let (columns, rows) = (vec![0, 2, 3, 5, 6], vec![0, 2, 1, 2, 3, 3]);
    let w = SquareMatrix::symmetric(4, columns, rows, vec![2.0, 0.5, 3.0, 2.0, 0.1, 3.0])?;
    let system = ContactSystem::new(Elastic::from_delassus(2, w, Vec::new())?, vec![0.3, 0.5])?;
    // q: the jump without contact forces.
    let [rest, load] = [[0.0; 4], [-1.0, 0.4, -2.0, 3.0]].map(|q| Load {
        force: vec![0.0; 4],
        offset: q.to_vec(),
        traction: Vec::new(),
    });
    let start = ContactState::zero(&system);
    let increment = Increment {
        system: &system,
        load: &load,
        start_load: &rest,
        start: &start,
        guess: None,
        index: 0,
        tolerance: 1e-9,
    };
    for method in Registry::standard().iter() {
        let mut solver = (method.build)(&Options::new(method.options, &[])?);
        let outcome = match solver.solve(&increment, &mut Silent) {
            Ok(outcome) => outcome,
            Err(reason) => {
                println!("{:22} {reason}", method.name);
                continue;
            }
        };
        let judged = residuals(&increment, &outcome.state)?;
        let (p, violation) = (&outcome.state.p, judged.violation);
        println!("{:22} P = {p:9.5?}, violation {violation:.1e}", method.name);
        assert!(violation <= if method.exact { 1e-9 } else { 1e-2 });
    }
    Ok(())
}
