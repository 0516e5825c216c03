//! Table 1 of the founding paper, Mesh I: the reaction at the top of the plate, by four methods, beside the print.
use stickslip::case::shipped;
use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::studies::cases::{Settings, run_case};

const PRINTED: [(f64, f64); 3] = [(0.1, 973.3), (0.8, 1107.4), (1.2, 1137.5)];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let plate = shipped::find("plate_mesh1").ok_or("a shipped case")??;
    let methods = ["b-newton", "augmented-lagrangian", "latin", "penalty"];
    let choices: Vec<Choice> = methods
        .map(Choice::parse)
        .into_iter()
        .collect::<Result<_, _>>()?;
    let results = run_case(&plate, &choices, Settings::PLAIN, &Quiet)?;
    for row in results.quantities() {
        let quantity = row.quantity;
        if [&*quantity.name, &*quantity.at, &*quantity.component] == ["reaction", "top", "y"] {
            let found = -quantity.value / 1e6;
            let printed = PRINTED.iter().find(|(mu, _)| *mu == row.key.friction);
            let (mu, printed) = printed.ok_or("a printed number")?;
            println!(
                "mu = {mu}  {:22} {found:9.3} MN/m, printed {printed}",
                row.key.method
            );
            assert!((found / printed - 1.0).abs() < 1e-3);
        }
    }
    Ok(())
}
