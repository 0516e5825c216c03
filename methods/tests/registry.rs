//! The registry lists every method file, and every entry is complete.

use std::collections::BTreeSet;

use stickslip_methods::*;

/// Goal: a new file of a family takes part as soon as its family names it, and none is forgotten.
#[test]
fn every_file_with_a_method_is_registered() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src");
    let mut files = BTreeSet::new();
    let entries = |folder: &std::path::Path| {
        let all = std::fs::read_dir(folder).unwrap();
        all.map(|entry| entry.unwrap().path()).collect::<Vec<_>>()
    };
    for family in entries(folder.as_ref()).into_iter().filter(|p| p.is_dir()) {
        for path in entries(&family).into_iter().filter(|p| p.is_file()) {
            let text = std::fs::read_to_string(&path).unwrap();
            if text.contains("\npub static METHOD: Method") {
                let name = path.file_stem().unwrap().to_str().unwrap();
                files.insert(name.replace('_', "-"));
            }
        }
    }
    let registry = Registry::standard();
    let registered: BTreeSet<String> = registry.iter().map(|m| m.name.to_owned()).collect();
    assert_eq!(files, registered);
}

#[test]
fn names_are_unique_and_found_by_name() {
    let registry = Registry::standard();
    let names: BTreeSet<&str> = registry.iter().map(|m| m.name).collect();
    assert_eq!(names.len(), registry.iter().len());
    for (place, m) in registry.iter().enumerate() {
        assert_eq!(registry.get(m.name).unwrap().name, m.name);
        assert_eq!(registry.position(m.name), Some(place));
        assert!(![m.label, m.reference, m.summary].contains(&""));
        assert!(m.page().contains("```text"), "{}: no equations", m.name);
        // A name is taken once, whoever takes it.
        assert_eq!(registry.clone().with(m).unwrap_err(), NameTaken(m.name));
    }
    assert!(registry.get("no-such-method").is_none());
}

#[test]
fn every_default_is_allowed_and_every_range_has_an_outside_that_is_refused() {
    for m in Registry::standard().iter() {
        (m.build)(&Options::new(m.options, &[]).unwrap());
        for option in m.options {
            let (name, default) = (option.name(), option.default());
            assert_eq!(option.value(default.number()), Some(default), "{name}");
            assert!(!option.help().is_empty(), "{} {name}", m.name);
            let (min, max) = match option {
                OptionSpec::Real(real) => (real.min, real.max),
                OptionSpec::Whole(whole) => (whole.min as f64, whole.max as f64),
                OptionSpec::Switch(_) => (0.0, 1.0),
            };
            for value in [min - 1.0, max * 2.0, f64::NAN, f64::NEG_INFINITY] {
                let error = Options::new(m.options, &[(name.to_string(), value)]).unwrap_err();
                let text = error.to_string();
                let told = text.contains(name) && text.contains(&option.allowed());
                assert!(told, "{text}");
            }
        }
        let unknown = Options::new(m.options, &[("no_such_option".to_string(), 1.0)]).unwrap_err();
        let text = unknown.to_string();
        assert!(m.options.iter().all(|o| text.contains(o.name())), "{text}");
    }
}

#[test]
fn tiers_are_named_and_ordered() {
    for tier in Tier::ALL {
        assert_eq!(tier.as_str().parse(), Ok(tier));
    }
    let error = "ultra".parse::<Tier>().unwrap_err().to_string();
    assert!(error.contains("low, mid, high"), "{error}");
    assert_eq!(Tier::ALL.map(Tier::tolerance), [1e-3, 1e-6, 1e-9]);
}
