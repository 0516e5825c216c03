//! How methods look: by their place in the registry, so that one method looks the same in every figure of a report.

use super::style::Style;
use crate::run::registry::methods;

/// Place in the registry of the method of a run, whose label may carry options in brackets.
fn place(label: &str) -> Option<usize> {
    let name = label.split('[').next().unwrap_or(label);
    methods().iter().position(|method| method.name == name)
}

/// Order of methods in figures: that of the registry, then what it does not know.
pub fn rank(label: &str) -> usize {
    place(label).unwrap_or(methods().len())
}

/// Whether the method solves the contact laws themselves; false for what the registry does not know.
pub fn is_exact(label: &str) -> bool {
    place(label).is_some_and(|place| methods()[place].exact)
}

/// Looks of the runs of one figure. A second run of the same method, with other options, looks like a further method.
pub fn styles(labels: &[&str]) -> Vec<Style> {
    // Exact, approximate.
    let mut further =
        [true, false].map(|exact| methods().iter().filter(|m| m.exact == exact).count());
    let mut taken = vec![false; methods().len()];
    let style = |label: &&str| {
        let known = place(label);
        let exact = known.is_none_or(|place| methods()[place].exact);
        let index = match known {
            Some(place) if !std::mem::replace(&mut taken[place], true) => methods()[..place]
                .iter()
                .filter(|m| m.exact == exact)
                .count(),
            _ => {
                let next = &mut further[usize::from(!exact)];
                *next += 1;
                *next - 1
            }
        };
        if exact {
            Style::of_exact(index)
        } else {
            Style::of_approximate(index)
        }
    };
    labels.iter().map(style).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: all methods of the registry and some variants are told apart in colour, and in grey by markers and dashes.
    #[test]
    fn all_methods_look_different() {
        let mut labels: Vec<&str> = methods().iter().map(|m| m.name).collect();
        labels.extend(["penalty[normal=1e3]", "latin[k=2]", "unknown"]);
        let styles = styles(&labels);
        for (i, a) in styles.iter().enumerate() {
            for b in &styles[..i] {
                let shape = |s: &Style| (s.marker, s.filled);
                assert!(
                    shape(a) != shape(b) || a.colour != b.colour,
                    "{}",
                    labels[i]
                );
                assert!(
                    shape(a) != shape(b) || a.dashes != b.dashes,
                    "{}",
                    labels[i]
                );
                assert_eq!(a.width, b.width, "no curve hides another by its width");
            }
            assert_eq!(
                styles[i].filled,
                is_exact(labels[i]) || i == labels.len() - 1
            );
        }
    }

    /// Goal: a method looks the same whoever stands beside it.
    #[test]
    fn a_method_keeps_its_look() {
        let look = |labels: &[&str], at: usize| {
            let style = &styles(labels)[at];
            (style.colour, style.marker, style.dashes, style.filled)
        };
        assert_eq!(look(&["latin"], 0), look(&["b-newton", "nsgs", "latin"], 2));
        assert_eq!(look(&["nitsche"], 0), look(&["penalty", "nitsche"], 1));
        assert_eq!(look(&["penalty[normal=1e3]"], 0), look(&["penalty"], 0));
        assert!(rank("nitsche") > rank("tresca") && rank("unknown") > rank("nitsche"));
    }
}
