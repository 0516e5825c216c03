//! Reading files that somebody named: at once, bounded, and only what a disk holds.
//!
//! A pipe blocks until somebody writes into it, a device such as `/dev/zero` never ends, and a file may grow while it is
//! read. None of them may take the program along.

use std::fs::{File, FileType, Metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Opens a regular file.
///
/// # Errors
/// Those of the file system, and whatever is no regular file, by name.
pub fn open(path: &Path) -> Result<(File, u64)> {
    // Before it is opened: opening a pipe waits for its other end.
    regular(&std::fs::metadata(path)?)?;
    let file = File::open(path)?;
    let described = file.metadata()?;
    regular(&described)?;
    Ok((file, described.len()))
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// Those of [`open`], and a file that is larger, also because it grows.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    let (file, len) = open(path)?;
    rest(file, len, most)
}

/// As [`read`], for text.
///
/// # Errors
/// Those of [`read`], and bytes that are not UTF-8.
pub fn read_text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(read(path, most)?).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        invalid(format!(
            "byte {at} is 0x{:02X}, no UTF-8 text",
            e.as_bytes()[at]
        ))
    })
}

/// What is left of an open file that was `len` bytes long.
///
/// # Errors
/// Those of [`read`].
pub fn rest(file: File, len: u64, most: u64) -> Result<Vec<u8>> {
    if len > most {
        return Err(invalid(format!(
            "it has {len} bytes, at most {most} are read"
        )));
    }
    let mut bytes = Vec::new();
    let room = usize::try_from(len).map_err(|_| Error::from(ErrorKind::OutOfMemory))?;
    bytes.try_reserve_exact(room)?;
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(invalid(format!(
            "it grew beyond {most} bytes while it was read"
        )));
    }
    Ok(bytes)
}

fn regular(described: &Metadata) -> Result<()> {
    let kind = described.file_type();
    match kind.is_file() {
        true => Ok(()),
        false => Err(invalid(format!("{}, not a regular file", named(kind)))),
    }
}

#[cfg(unix)]
fn named(kind: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    if kind.is_dir() {
        "a directory"
    } else if kind.is_fifo() {
        "a pipe"
    } else if kind.is_socket() {
        "a socket"
    } else {
        "a device"
    }
}

#[cfg(not(unix))]
fn named(kind: FileType) -> &'static str {
    if kind.is_dir() {
        "a directory"
    } else {
        "a device"
    }
}

fn invalid(what: String) -> Error {
    Error::new(ErrorKind::InvalidData, what)
}
