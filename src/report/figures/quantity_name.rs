//! Names of quantities in figures: words and symbols instead of the words of the tables.

use crate::report::plot::{italic, subscript};

/// A quantity at its place (empty: the whole body), in the words of `convergence.csv`. What has no symbols is its word.
pub fn name(quantity: &str, at: &str) -> String {
    let difference = |symbol: &str| format!("‖{0} − {0}{1}‖", italic(symbol), subscript("h"));
    let words = match quantity {
        "energy" => format!("energy norm {}", difference("σ")),
        "displacement" => format!("displacement L² {}", difference("u")),
        "displacement_rms" => "displacement at nodes, rms".into(),
        "traction" => format!("contact traction L²(Γ) {}", difference("λ")),
        "traction_rms" => "contact traction at points, rms".into(),
        "slip" => "slip, largest on Γ".into(),
        "gap" => "normal gap, largest on Γ".into(),
        "slip_points" => "slip, largest at points".into(),
        "gap_points" => "normal gap, largest at points".into(),
        "stick_boundary" => format!("end of the slip zone {}*", italic("s")),
        "dissipation" => "dissipated energy".into(),
        "max_slip" => "largest slip".into(),
        "max_gap" => "largest normal gap".into(),
        other => match other.split_once('_') {
            Some((mode @ ("k1" | "k2" | "k3"), found)) => {
                let index = ["I", "II", "III"][usize::from(mode.as_bytes()[1] - b'1')];
                let found = if found == "jump" {
                    "jump fit"
                } else {
                    "interaction integral"
                };
                format!("{}{}, {found}", italic("K"), subscript(index))
            }
            _ => other.replace('_', " "),
        },
    };
    match (at.rsplit_once(' '), at) {
        (_, "") => words,
        // A component of a vector on a part of the border.
        (Some((part, component @ ("x" | "y" | "z"))), _) => {
            let symbol = if quantity == "reaction" { "R" } else { "u" };
            format!("{words} {}{}, {part}", italic(symbol), subscript(component))
        }
        _ => format!("{words}, {}", place(at)),
    }
}

/// A crack, tip or point of a front, e.g. `crack-1 tip-2`.
pub fn place(at: &str) -> String {
    at.replace(' ', ", ").replace('-', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_have_words_and_symbols() {
        assert_eq!(name("max_slip", "crack-2"), "largest slip, crack 2");
        assert_eq!(name("contact_force", ""), "contact force");
        let intensity = name("k2_interaction", "crack-1 tip-2");
        assert!(intensity.ends_with(", interaction integral, crack 1, tip 2"));
        assert!(intensity.contains(&subscript("II")) && intensity.contains(&italic("K")));
        let reaction = name("reaction", "top y");
        assert!(reaction.starts_with("reaction ") && reaction.ends_with(", top"));
    }
}
