//! What stands at a place of an output folder: nothing, a file, a folder; what else there is, is in the way.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use super::bundle::FolderError;

/// What stands at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Nothing,
    File,
    Folder,
}

/// What stands at a place.
///
/// # Errors
/// [`FolderError::InTheWay`] at a link, through which files of others would be reached, and at what is no regular file.
pub(super) fn kind_of(path: &Path) -> Result<Kind, FolderError> {
    let kind = match fs::symlink_metadata(path) {
        Ok(described) => described.file_type(),
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Kind::Nothing),
        Err(e) => return Err(FolderError::io("look at", path, e)),
    };
    let why = match (kind.is_file(), kind.is_dir(), kind.is_symlink()) {
        (true, ..) => return Ok(Kind::File),
        (_, true, _) => return Ok(Kind::Folder),
        (.., true) => "it is a link, and links are not followed",
        _ => "it is no regular file",
    };
    let path = path.to_path_buf();
    Err(FolderError::InTheWay { path, why })
}

/// As [`kind_of`], of a place below a folder and all places on the way to it.
pub(super) fn kind_below(dir: &Path, path: &str) -> Result<Kind, FolderError> {
    let (mut place, mut kind) = (dir.to_path_buf(), Kind::Folder);
    for part in Path::new(path) {
        match kind {
            Kind::Folder => place.push(part),
            Kind::Nothing => break,
            Kind::File => {
                let why = "a file stands where a folder goes";
                return Err(FolderError::InTheWay { path: place, why });
            }
        }
        kind = kind_of(&place)?;
    }
    Ok(kind)
}

/// That files can be moved into a folder.
#[cfg(unix)]
pub(super) fn open_to_renames(folder: &Path, dir: &Path) -> std::io::Result<()> {
    use rustix::fs::{Access, access};
    use std::os::unix::fs::MetadataExt;
    access(folder, Access::WRITE_OK | Access::EXEC_OK)?;
    match folder.metadata()?.dev() == dir.metadata()?.dev() {
        true => Ok(()),
        false => Err(ErrorKind::CrossesDevices.into()),
    }
}

/// Only the attempt tells.
#[cfg(not(unix))]
pub(super) fn open_to_renames(_: &Path, _: &Path) -> std::io::Result<()> {
    Ok(())
}
