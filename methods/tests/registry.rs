//! The registry lists every method file, and every entry is complete.

#![allow(missing_docs)]

use std::collections::BTreeSet;

use stickslip_methods::*;

#[test]
fn every_method_file_is_registered() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src");
    let files: BTreeSet<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name != "lib.rs" && name != "problem")
        .collect();
    let registered: BTreeSet<String> = METHODS
        .iter()
        .map(|m| format!("{}.rs", m.name.replace('-', "_")))
        .collect();
    assert_eq!(files, registered);
}

#[test]
fn names_are_unique_and_found_by_name() {
    let names: BTreeSet<&str> = METHODS.iter().map(|m| m.name).collect();
    assert_eq!(names.len(), METHODS.len());
    for m in METHODS {
        assert_eq!(method(m.name).unwrap().name, m.name);
        assert!(
            ![m.label, m.reference, m.summary].contains(&""),
            "{}",
            m.name
        );
    }
    assert!(method("no-such-method").is_none());
}

#[test]
fn every_default_is_allowed_and_every_range_has_an_outside_that_is_refused() {
    for m in METHODS {
        (m.build)(&Options::new(m.options, &[]).unwrap()).unwrap();
        for option in m.options {
            assert!(
                option.accepts(option.default) && !option.help.is_empty(),
                "{} {}",
                m.name,
                option.name
            );
            for value in [
                option.min - 1.0,
                option.max * 2.0,
                f64::NAN,
                f64::NEG_INFINITY,
            ] {
                let error =
                    Options::new(m.options, &[(option.name.to_string(), value)]).unwrap_err();
                let text = error.to_string();
                assert!(
                    text.contains(option.name) && text.contains(&option.allowed()),
                    "{text}"
                );
            }
        }
        let unknown = Options::new(m.options, &[("no_such_option".to_string(), 1.0)]).unwrap_err();
        assert!(
            m.options
                .iter()
                .all(|o| unknown.to_string().contains(o.name)),
            "{unknown}"
        );
    }
}

#[test]
fn tiers_are_named_and_ordered() {
    for tier in Tier::ALL {
        assert_eq!(tier.as_str().parse(), Ok(tier));
    }
    assert!(
        "ultra"
            .parse::<Tier>()
            .unwrap_err()
            .to_string()
            .contains("low, mid, high")
    );
    assert_eq!(Tier::ALL.map(Tier::tolerance), [1e-3, 1e-6, 1e-9]);
}
