//! The table of small numbers in docs/tolerances.md is that of the sources.

use std::collections::BTreeSet;
use std::path::Path;

/// All Rust files in a folder and below, but tests.
fn sources(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
}

/// Numbers with a negative exponent in a line without its comment, as they are written.
fn small_numbers(line: &str) -> impl Iterator<Item = &str> {
    let code = line.split("//").next().unwrap_or_default();
    let words = code.split(|c: char| !c.is_ascii_alphanumeric() && !"._-".contains(c));
    words
        .map(|word| word.trim_start_matches('-'))
        .filter(|word| {
            let parts = word.split_once("e-");
            let digits = |text: &str| text.chars().all(|c| c.is_ascii_digit() || c == '.');
            parts.is_some_and(|(a, b)| !a.is_empty() && !b.is_empty() && digits(a) && digits(b))
        })
}

/// Goal: no number that decides what counts as nothing stands in the sources without its row and its reason, nor a row without
/// its number.
#[test]
fn every_tolerance_is_in_the_table() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = Vec::new();
    sources(&root.join("xfem/src"), &mut paths);
    let mut found: BTreeSet<(String, String)> = BTreeSet::new();
    for path in paths {
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap();
        let file = path.strip_prefix(root.join("xfem/src")).unwrap();
        let file = file.to_string_lossy().replace('\\', "/");
        let numbers = code.lines().flat_map(small_numbers);
        found.extend(numbers.map(|number| (file.clone(), number.to_owned())));
    }
    let table = std::fs::read_to_string(root.join("docs/tolerances.md")).unwrap();
    let rows = table.lines().filter(|line| line.starts_with("| ")).skip(1);
    let cells = rows.map(|row| row.split('|').map(str::trim).collect::<Vec<_>>());
    let mut told = BTreeSet::new();
    for row in cells {
        assert!(row[3].len() > 10, "no reason: {row:?}");
        told.insert((row[1].to_owned(), row[2].to_owned()));
    }
    assert!(found.len() > 50, "{}", found.len());
    let untold: Vec<_> = found.difference(&told).collect();
    let gone: Vec<_> = told.difference(&found).collect();
    assert!(
        untold.is_empty() && gone.is_empty(),
        "untold {untold:?}, gone {gone:?}"
    );
}
