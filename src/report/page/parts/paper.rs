//! The founding paper: its tables computed beside printed, refinement, limits, the penalty parameter.

use super::blocks::{figures, made, tables};
use crate::report::page::{Budget, Folder, Kind, PageError, Section, Show};

const TABLE1: [Show; 7] = [
    Show::new("mesh", Kind::Text),
    Show::new("friction", Kind::Number),
    Show::new("method", Kind::Text),
    Show::new("reaction_mn_per_m", Kind::Fixed(3)),
    Show::new("printed_mn_per_m", Kind::Fixed(1)),
    Show::new("relative_difference", Kind::Percent(3)),
    Show::new("verdict", Kind::Verdict),
];

const TABLE2: [Show; 13] = [
    Show::new("model", Kind::Text),
    Show::new("variant", Kind::Text),
    Show::new("component", Kind::Text),
    Show::new("method", Kind::Text),
    Show::new("p1_mm", Kind::Fixed(7)).titled("P1"),
    Show::new("p2_mm", Kind::Fixed(7)).titled("P2"),
    Show::new("p3_mm", Kind::Fixed(7)).titled("P3"),
    Show::new("p4_mm", Kind::Fixed(7)).titled("P4"),
    Show::new("p5_mm", Kind::Fixed(7)).titled("P5"),
    Show::new("p6_mm", Kind::Fixed(7)).titled("P6"),
    Show::new("p7_mm", Kind::Fixed(7)).titled("P7"),
    Show::new("max_difference_mm", Kind::Digits(2)).titled("largest difference"),
    Show::new("verdict", Kind::Verdict),
];

const CONVERGED: [Show; 8] = [
    Show::new("friction", Kind::Number),
    Show::new("mesh", Kind::Text),
    Show::new("finest_h_m", Kind::Fixed(4)),
    Show::new("order", Kind::Fixed(2)),
    Show::new("limit_mn_per_m", Kind::Fixed(3)),
    Show::new("error_bar_mn_per_m", Kind::Fixed(3)),
    Show::new("printed_mn_per_m", Kind::Fixed(1)),
    Show::new("printed_difference", Kind::Percent(2)).titled("printed − limit"),
];

const LIMITS: [Show; 4] = [
    Show::new("friction", Kind::Number),
    Show::new("mesh_1_mn_per_m", Kind::Fixed(2)).titled("Mesh I"),
    Show::new("mesh_2_mn_per_m", Kind::Fixed(2)).titled("Mesh II"),
    Show::new("relative_gap", Kind::Digits(2)),
];

const REFINEMENT: [Show; 7] = [
    Show::new("family", Kind::Text),
    Show::new("mesh", Kind::Text).titled("cells"),
    Show::new("h_m", Kind::Fixed(4)),
    Show::new("friction", Kind::Number),
    Show::new("dofs", Kind::Number).titled("unknowns"),
    Show::new("reaction_mn_per_m", Kind::Fixed(3)),
    Show::new("verdict", Kind::Verdict),
];

const PENALTY: [Show; 7] = [
    Show::new("friction", Kind::Number),
    Show::new("parameter", Kind::Number),
    Show::new("reaction_mn_per_m", Kind::Fixed(3)),
    Show::new("relative_error", Kind::Digits(2)),
    Show::new("max_penetration_m", Kind::Digits(2)).titled("largest penetration"),
    Show::new("natural_map", Kind::Digits(2)),
    Show::new("verdict", Kind::Verdict),
];

/// The section.
pub fn section(folder: &Folder, budget: &mut Budget) -> Result<Option<Section>, PageError> {
    let mut blocks = Vec::new();
    for (name, title, shows) in [
        (
            "table1.csv",
            "Table 1: vertical reaction at the top of the plate",
            &TABLE1[..],
        ),
        (
            "table2.csv",
            "Table 2: displacement of the points P1 to P7 of the beam",
            &TABLE2,
        ),
        (
            "converged.csv",
            "Converged reactions of the plate with error bars, beside Table 1",
            &CONVERGED,
        ),
        (
            "limits.csv",
            "Limits of both meshes with the paper's elements, from the two finest",
            &LIMITS,
        ),
        (
            "refinement.csv",
            "Plate under refinement: reaction at the top",
            &REFINEMENT,
        ),
        (
            "penalty.csv",
            "Penalty method on Mesh I: error against its parameter",
            &PENALTY,
        ),
    ] {
        blocks.extend(tables(folder, name, title, shows)?);
    }
    let wanted = |name: &str| {
        name.starts_with("converged.") || ["refinement.svg", "penalty.svg"].contains(&name)
    };
    blocks.extend(figures(
        folder,
        budget,
        "Refinement, limits and penalty parameter",
        wanted,
    )?);
    let lead = "Plate and beam of the founding paper: computed beside printed numbers, and what the plate converges to.";
    Ok(made("paper", "Founding paper", lead, blocks))
}
