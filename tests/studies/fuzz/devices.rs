//! What is no file that a disk holds is refused at once: pipes that nobody writes into, devices without an end, files that
//! grow, and sparse ones of a terabyte.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::folder;
use crate::common::stickslip;

/// Verbs that read a file of the user, up to its name.
const VERBS: [&str; 4] = ["check", "run", "study", "solve"];

/// Gives a file to all verbs, which must refuse it quickly, with one message that names it.
fn refused_by_all(file: &str, dir: &Path, words: &[&str]) {
    for verb in VERBS {
        let arguments = [verb, file];
        let mut program = Command::new(env!("CARGO_BIN_EXE_stickslip"));
        program.args(arguments).current_dir(dir);
        let program = program.stdin(Stdio::null()).stdout(Stdio::piped());
        let mut child = program.stderr(Stdio::piped()).spawn().unwrap();
        let start = Instant::now();
        while child.try_wait().unwrap().is_none() {
            if start.elapsed() > Duration::from_secs(10) {
                child.kill().unwrap();
                panic!("{arguments:?} hangs");
            }
            thread::sleep(Duration::from_millis(2));
        }
        let output = child.wait_with_output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(
            message.starts_with("error: ") && message.contains(file),
            "{message}"
        );
        let told = words.iter().any(|word| message.contains(word));
        assert!(
            told && message.lines().count() <= 3,
            "{arguments:?}: {message}"
        );
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
    assert!(!dir.join("results").exists(), "{file}: written");
}

#[cfg(unix)]
#[test]
fn a_pipe_that_nobody_writes_into_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let made = Command::new("mkfifo")
        .arg(dir.path().join("pipe.toml"))
        .status();
    assert!(made.unwrap().success());
    refused_by_all("pipe.toml", dir.path(), &["a pipe, not a regular file"]);
}

#[cfg(unix)]
#[test]
fn devices_and_directories_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    for device in ["/dev/zero", "/dev/null", "/dev/urandom"] {
        refused_by_all(device, dir.path(), &["a device, not a regular file"]);
    }
    fs::create_dir(dir.path().join("empty")).unwrap();
    let words = ["a directory, not a regular file", "no file.hdf5 or file.h5"];
    refused_by_all("empty", dir.path(), &words);
}

/// Goal: nothing is allocated for a file that cannot be meant.
#[test]
fn a_terabyte_of_nothing_is_refused_unread() {
    let dir = tempfile::tempdir().unwrap();
    let file = fs::File::create(dir.path().join("vast.toml")).unwrap();
    if file.set_len(1 << 40).is_err() {
        return; // A file system without sparse files.
    }
    let words = ["1099511627776 bytes", "does not begin like HDF5"];
    refused_by_all("vast.toml", dir.path(), &words);
    // The same with the signature of HDF5.
    let mut start = fs::read(folder("tests/data/fclib/local_csr.hdf5")).unwrap();
    start.truncate(512);
    let path = dir.path().join("vast.hdf5");
    fs::write(&path, start).unwrap();
    let file = fs::OpenOptions::new().write(true).open(&path).unwrap();
    file.set_len(1 << 40).unwrap();
    let (code, _, message) = stickslip(&["solve", "vast.hdf5"], dir.path());
    assert!(
        code == 2 && message.contains("1099511627776 bytes"),
        "{message}"
    );
}

/// Goal: who appends while the file is read does not keep the reader.
#[test]
fn a_file_that_grows_while_it_is_read_ends() {
    use std::io::Write;
    use std::sync::atomic::{AtomicBool, Ordering};
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("grows.toml");
    let mut file = fs::File::create(&path).unwrap();
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            let lines = "# more\n".repeat(10_000);
            // Bounded by the disk of who runs this.
            for _ in 0..2000 {
                if stop.load(Ordering::Relaxed) {
                    break;
                }
                file.write_all(lines.as_bytes()).unwrap();
            }
        });
        let start = Instant::now();
        let error = stickslip::case::read(&path).unwrap_err();
        let elapsed = start.elapsed();
        stop.store(true, Ordering::Relaxed);
        assert!(elapsed < Duration::from_secs(2), "{elapsed:?}");
        let message = error.to_string();
        assert!(message.contains("grows.toml"), "{message}");
    });
}

/// Goal: a folder of records with something else in it is an error, not a wait.
#[cfg(unix)]
#[test]
fn a_pipe_among_records_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let made = Command::new("mkfifo")
        .arg(dir.path().join("sweep.json"))
        .status();
    assert!(made.unwrap().success());
    let (code, _, message) = stickslip(&["merge", ".", "--out", "merged"], dir.path());
    assert_eq!(code, 2);
    assert!(
        message.contains("sweep.json") && message.contains("a pipe"),
        "{message}"
    );
}
