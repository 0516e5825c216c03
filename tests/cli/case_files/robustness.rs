//! Files that are no case files at all: refused quickly, briefly and without a panic.

use std::fs;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use stickslip::case;

use super::{PLANE, SOLID, refused};

#[test]
fn a_truncated_file_is_refused_wherever_it_ends() {
    // Cut inside the last table everything but the tolerance and its successors is lost piece by piece.
    let required = PLANE.find("source = \"A book").unwrap();
    for end in 0..required {
        if let Ok(case) = case::parse("cut.toml", &PLANE[..end]) {
            // What remains is a smaller case: all its tables are whole.
            assert!(
                end > PLANE.find("cells = [").unwrap() && case.expects.is_empty(),
                "cut at {end}"
            );
        }
    }
    let error = refused(&PLANE[..PLANE.find("0, 0], [1, 2.5]]").unwrap()]);
    assert_eq!((error.line(), error.column()), (34, 13), "{error}");
    assert!(error.message().starts_with("not valid TOML"), "{error}");
}

#[test]
fn ten_megabytes_of_garbage_are_refused_at_once_and_briefly() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("garbage.toml");
    let garbage: Vec<u8> = (0..10_u32 << 20)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8)
        .collect();
    fs::write(&path, garbage).unwrap();
    let start = Instant::now();
    let error = case::read(&path).unwrap_err();
    let elapsed = start.elapsed();
    assert!(elapsed < Duration::from_millis(100), "{elapsed:?}");
    let shown = error.to_string();
    for words in [
        "garbage.toml:1:1: ",
        "got 10485760 bytes",
        "at most 1048576 bytes",
    ] {
        assert!(shown.contains(words) && shown.len() < 1000, "{shown}");
    }
}

#[test]
fn a_megabyte_on_one_line_is_refused_with_a_short_message() {
    for text in [
        format!("title = \"{}\"\n{}", "x".repeat(1_000_000), &SOLID[16..])
            .replace("solid", "fluid"),
        "x".repeat(1 << 20),
        format!("{} = 1", "y".repeat(1_000_000)),
        format!("title = \"{}\u{1}\"", "é".repeat(500_000)),
        format!("title = {}", "[".repeat(1_000_000)),
        format!("title = {}", "{a=".repeat(300_000)),
        format!("{}a = 1", "a.".repeat(500_000)),
        format!("[{}a]", "a.".repeat(500_000)),
        format!("title = 1{}", "0".repeat(1_000_000)),
        SOLID.replace(
            "line_n_per_m",
            &format!("where = \"{}\"\nline_n_per_m", "(".repeat(900_000)),
        ),
    ] {
        let start = Instant::now();
        let length = refused(&text).to_string().chars().count();
        assert!(length < 1000, "{length} characters");
        let elapsed = start.elapsed();
        assert!(elapsed < Duration::from_secs(5), "{elapsed:?}");
    }
}

#[test]
fn tables_nested_as_deeply_as_toml_allows_are_refused() {
    let dotted = vec!["a"; 79].join(".");
    let mut value = "1".to_string();
    for _ in 0..79 {
        value = format!("{{{dotted} = {value}}}");
    }
    refused(&format!("[{dotted}]\n{dotted} = {value}\n"));
}

#[test]
fn files_that_are_not_text_are_refused_at_the_first_bad_byte() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("binary.toml");
    let mut bytes = "title = \"é\"\nmodel = ".as_bytes().to_vec();
    bytes.extend([0xff, 0xfe, 0x00, b'\n']);
    fs::write(&path, &bytes).unwrap();
    let error = case::read(&path).unwrap_err();
    assert_eq!((error.line(), error.column()), (2, 9), "{error}");
    assert_eq!(
        (error.value(), error.allowed()),
        ("byte 0xFF", "UTF-8 text")
    );
    assert!(!error.to_string().contains('\0'));
}

#[test]
fn control_characters_never_reach_the_terminal() {
    let error = refused("title = \"\u{1b}[31mred\"\n");
    assert_eq!((error.line(), error.column()), (1, 10), "{error}");
    let control = |c: char| c.is_control() && c != '\n';
    assert!(!error.to_string().contains(control), "{error}");
}

#[test]
fn files_that_cannot_be_read_are_refused_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let missing = dir.path().join("missing.toml");
    let error = case::read(&missing).unwrap_err().to_string();
    assert!(
        error.contains("missing.toml: cannot be read: got "),
        "{error}"
    );
    let error = case::read(dir.path()).unwrap_err();
    assert!(error.to_string().contains("got a directory"), "{error}");
    assert_eq!(error.line(), 0);
}

/// Parses anything; a refusal must have a place and be short.
fn survives(text: &str) -> Result<(), TestCaseError> {
    if let Err(error) = case::parse("random.toml", text) {
        let shown = error.to_string();
        prop_assert!(
            error.line() >= 1 && error.line() <= text.split('\n').count(),
            "{shown}"
        );
        prop_assert!(error.column() >= 1, "{shown}");
        prop_assert!(shown.chars().count() < 1200, "{shown}");
        prop_assert!(
            !shown.chars().any(|c| c.is_control() && c != '\n'),
            "{shown:?}"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        survives(&String::from_utf8_lossy(&bytes))?;
    }

    #[test]
    fn random_toml_pieces_never_panic(
        pieces in proptest::collection::vec(
            prop::sample::select(vec![
                "[", "]", "[[", "]]", "{", "}", "=", ".", ",", "\n", "\"", "'", "\"\"\"", "#", " ", "mesh", "crack", "arc", "ellipse", "exact", "twist", "tip",
                "on", "box", "1", "-0", "1e999", "nan", "0x", "true", "1979-05-27", "é", "\\u", "\r", "\u{0}",
                "title = \"t\"\n", "model = \"solid\"\n", "[mesh.box]\n", "[[expect]]\n", "x.y = 1\n",
            ]),
            0..60,
        )
    ) {
        survives(&pieces.concat())?;
    }

    #[test]
    fn mutated_case_files_never_panic(
        solid in any::<bool>(),
        edits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8, 0..40_usize), 1..8),
    ) {
        let mut bytes = if solid { SOLID } else { PLANE }.as_bytes().to_vec();
        for (index, byte, kind, length) in edits {
            let at = index.index(bytes.len().max(1)).min(bytes.len());
            let end = (at + length).min(bytes.len());
            match kind {
                0 => { bytes.drain(at..end); }
                1 => bytes.insert(at, byte),
                2 => { let copy = bytes[at..end].to_vec(); bytes.splice(at..at, copy); }
                _ => bytes.iter_mut().skip(at).take(1).for_each(|b| *b = byte & 0x7f),
            }
        }
        survives(&String::from_utf8_lossy(&bytes))?;
    }
}
