//! Whatever bytes a file holds, its reader gives a value or one clear message: no panic, no hang, no memory beyond the file's.
//!
//! Inputs are drawn from a seed, so each can be made again by its number. `STICKSLIP_FUZZ=100000` sets how many every
//! reader gets, `STICKSLIP_SEED` draws others, `STICKSLIP_FUZZ_ONLY=17` makes one again and prints it.

mod bytes;
mod campaign;
mod cases;
mod devices;
mod fclib;
mod found;
mod large;
mod names;
mod records;
mod sweeps;
mod together;

use std::path::PathBuf;

/// A folder of the repository.
fn folder(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Contents of all files of a folder with an ending, in the order of their names.
fn files_ending(name: &str, ending: &str) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(folder(name)).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == ending));
    paths.sort();
    assert!(!paths.is_empty(), "{name}");
    let read = |path: &PathBuf| std::fs::read(path).unwrap();
    paths.iter().map(read).collect()
}

/// Demands one message: short, visible, of at most `lines` lines, after a beginning that names the file.
fn assert_clear(message: &str, begins: &str, lines: usize) {
    let hidden = |c: char| c.is_control() && c != '\n' || "\u{202e}\u{200b}\u{feff}".contains(c);
    assert!(message.starts_with(begins), "no `{begins}`: {message:?}");
    assert!(message.len() > begins.len() + 8, "says nothing: {message}");
    assert!(message.chars().count() < 1500, "floods: {message}");
    assert!(message.lines().count() <= lines, "rambles: {message}");
    assert!(!message.contains(hidden), "commands: {message:?}");
}
