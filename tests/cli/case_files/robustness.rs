//! Files that are no case files at all: refused quickly and briefly. What is nearly one is drawn at random in `studies/fuzz`.

use std::fs;

use stickslip::case;

use super::{PLANE, SOLID, refused};
use crate::common::quick;

#[test]
fn a_truncated_file_is_refused_at_its_end() {
    let error = refused(&PLANE[..PLANE.find("0, 0], [1, 2.5]]").unwrap()]);
    assert_eq!((error.line(), error.column()), (34, 13), "{error}");
    assert!(error.message().starts_with("not valid TOML"), "{error}");
}

/// Goal: neither length nor depth brings the reader down or floods a terminal.
#[test]
fn a_megabyte_of_anything_is_refused_with_a_short_message() {
    let dotted = vec!["a"; 79].join(".");
    let nested = (0..79).fold("1".to_owned(), |value, _| format!("{{{dotted} = {value}}}"));
    let deep = format!("where = \"{}\"\nline_n_per_m", "(".repeat(900_000));
    for text in [
        "x".repeat(1 << 20),
        format!("title = \"{}\"\nmodel = 1", "x".repeat(1_000_000)),
        format!("{} = 1", "y".repeat(1_000_000)),
        format!("title = \"{}\u{1}\"", "é".repeat(500_000)),
        format!("title = {}", "[".repeat(1_000_000)),
        format!("title = {}", "{a=".repeat(300_000)),
        "a={b=[1]\n[[c]]\n".repeat(65_000),
        format!("{}a = 1", "a.".repeat(500_000)),
        format!("[{}a]", "a.".repeat(500_000)),
        format!("title = 1{}", "0".repeat(1_000_000)),
        format!("[{dotted}]\n{dotted} = {nested}\n"),
        SOLID.replace("line_n_per_m", &deep),
    ] {
        let error = quick(5, || refused(&text));
        let length = error.to_string().chars().count();
        assert!(length < 1000, "{length} characters");
    }
}

#[test]
fn files_that_are_no_text_or_cannot_be_read_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("bad.toml");
    for (bytes, words) in [
        (
            vec![0; 10 << 20],
            "bad.toml:1:1: file too large for a case: got 10485760 bytes, allowed: at most 1048576",
        ),
        (
            b"title = \"\xc3\xa9\"\nmodel = \xff\xfe\0\n".to_vec(),
            "bad.toml:2:9: not a text file: got byte 0xFF, allowed: UTF-8 text",
        ),
    ] {
        fs::write(&path, bytes).unwrap();
        let error = case::read(&path).unwrap_err().to_string();
        assert!(error.contains(words) && !error.contains('\0'), "{error}");
    }
    let error = case::read(dir.path().join("missing.toml")).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("missing.toml: cannot be read: got "),
        "{error}"
    );
    let error = case::read(dir.path()).unwrap_err();
    assert!(
        error.line() == 0 && error.to_string().contains("got a directory"),
        "{error}"
    );
    let path = dir.path().join(format!("{}.toml", "x".repeat(121)));
    fs::write(&path, SOLID).unwrap();
    let error = case::read(&path).unwrap_err().to_string();
    assert!(error.contains(".toml:1:1: file name too long"), "{error}");
}
