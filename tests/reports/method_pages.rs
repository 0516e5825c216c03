//! Every method has a complete page, and `docs/methods.md` says of those it names what the code says.

use std::collections::BTreeMap;

use stickslip::cli::method_manual;
use stickslip::run::registry::methods;

#[test]
fn every_page_says_what_a_user_has_to_know() {
    for method in methods() {
        let page = method_manual::page(method);
        for section in [
            "### Options",
            "### Guarantees",
            "### Failure modes",
            "### Skips",
        ] {
            assert!(page.contains(section), "{}: no {section}", method.name);
        }
        assert!(page.contains("```text"), "{}: no equations", method.name);
        for option in method.options {
            let mentions = page.matches(&format!("`{}`", option.name())).count();
            assert!(
                mentions >= 2,
                "{}: {} is not explained",
                method.name,
                option.name()
            );
        }
    }
}

#[test]
fn the_manual_is_that_of_this_source() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/methods.md");
    let committed = std::fs::read_to_string(path).expect("docs/methods.md");
    let sections = |text: &str| -> BTreeMap<String, String> {
        // Each begins with an anchor of its name.
        let sections = text.split("<a id=\"").skip(1).map(|section| {
            let name = section.split('"').next().unwrap_or_default();
            (name.to_owned(), section.trim_end().to_owned())
        });
        sections.collect()
    };
    let (committed, current) = (sections(&committed), sections(&method_manual::all()));
    assert!(!committed.is_empty());
    // A method that is not in the manual yet is no fault of the manual's.
    for (name, section) in committed {
        assert!(
            current.get(&name) == Some(&section),
            "docs/methods.md is stale about {name}: write it with `stickslip show methods`"
        );
    }
}
