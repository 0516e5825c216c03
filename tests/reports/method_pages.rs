//! Every method has a complete page.

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
