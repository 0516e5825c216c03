//! Reading files that somebody named: bounded, and only what a disk holds. A pipe may block, and a device never end.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Opens a regular file: the file and its length.
///
/// # Errors
/// Those of the file system, and whatever is no regular file.
pub fn open(path: &Path) -> Result<(File, u64)> {
    // Before it is opened: opening a pipe waits for its other end.
    regular(&std::fs::metadata(path)?)?;
    let file = File::open(path)?;
    let len = file.metadata()?.len();
    Ok((file, len))
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// Those of [`open`], and a file that is larger, also because it grows.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    rest(open(path)?.0, most)
}

/// As [`read`], for text.
///
/// # Errors
/// Those of [`read`], and bytes that are not UTF-8.
pub fn read_text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(read(path, most)?).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let byte = e.as_bytes()[at];
        invalid(format!("byte {at} is 0x{byte:02X}, no UTF-8 text"))
    })
}

/// The rest of an open file.
///
/// # Errors
/// Those of [`read`].
pub fn rest(file: File, most: u64) -> Result<Vec<u8>> {
    let len = file.metadata()?.len();
    let mut bytes = Vec::new();
    if len <= most {
        // Checked first: the length of a sparse file is no promise that it fits.
        bytes.try_reserve_exact(len as usize)?;
        file.take(most + 1).read_to_end(&mut bytes)?;
    }
    match len.max(bytes.len() as u64) {
        len if len > most => Err(invalid(format!(
            "it has {len} bytes, at most {most} are read"
        ))),
        _ => Ok(bytes),
    }
}

fn regular(described: &Metadata) -> Result<()> {
    let kind = match (described.is_file(), described.is_dir()) {
        (true, _) => return Ok(()),
        (false, true) => "a directory",
        (false, false) => "a pipe or device",
    };
    Err(invalid(format!("{kind}, not a regular file")))
}

fn invalid(what: String) -> Error {
    Error::new(ErrorKind::InvalidData, what)
}
