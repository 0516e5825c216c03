//! Case files.

use stickslip::case;
use stickslip::model::body::{Body, Needs};

use super::bytes::{Kind, changed};
use super::{assert_clear, campaign, files_ending};

#[test]
fn any_bytes_are_a_case_or_refused_at_line_and_column() {
    let mut seeds = files_ending("cases", "toml");
    seeds.extend(files_ending("tests/data/geometry", "toml"));
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("fuzz.toml");
    let draw = move |stream: &mut _| changed(&seeds, Kind::Text, stream);
    let read = move |bytes: &[u8]| {
        let _kept = &dir;
        std::fs::write(&file, bytes).unwrap();
        let error = match case::read(&file) {
            Ok(case) => {
                let visible = |text: &str| !text.chars().any(char::is_control);
                assert!(!case.title.is_empty() && visible(&case.title));
                assert!(!case.title.trim().starts_with(['=', '@']), "{}", case.title);
                assert!(case.probes.iter().all(|probe| visible(&probe.name)));
                assert!(case.path.increments >= 1 && case.tolerance > 0.0);
                return true;
            }
            Err(error) => error,
        };
        let lines = bytes.iter().filter(|b| **b == b'\n').count() + 1;
        assert!((1..=lines).contains(&error.line()), "{error}");
        assert!(error.column() >= 1, "{error}");
        let place = format!("{}:{}:{}: ", file.display(), error.line(), error.column());
        assert_clear(&error.to_string(), &place, 3);
        assert!(
            !error.value().is_empty() && !error.allowed().is_empty(),
            "{error}"
        );
        false
    };
    campaign::run("case", 400, draw, read);
}

/// Goal: what the reader takes is discretised or refused, whatever its numbers.
#[test]
fn an_accepted_case_is_discretised_or_refused() {
    let mut seeds = files_ending("cases", "toml");
    seeds.extend(files_ending("tests/data/geometry", "toml"));
    let draw = move |stream: &mut _| changed(&seeds, Kind::Text, stream);
    let read = move |bytes: &[u8]| {
        let Ok(text) = std::str::from_utf8(bytes) else {
            return false;
        };
        let Ok(case) = case::parse("fuzz.toml", text) else {
            return false;
        };
        let cells: usize = case
            .mesh
            .grid
            .lines
            .iter()
            .map(|line| line.len() - 1)
            .product();
        // Many cells take their time, and are none of the reader's affairs.
        if cells > 300 {
            return false;
        }
        match Body::new(&case, 1, Needs::default()) {
            Ok(_) => true,
            Err(error) => {
                assert_clear(&error.to_string(), "", 3);
                false
            }
        }
    };
    campaign::run("body", 100, draw, read);
}
