//! The HDF5 tree of a problem file: named datasets of integers, reals and text.
//!
//! Nothing is allocated for a dataset before its extent was compared with the size of the file, so a few wrong bytes
//! cannot ask for all memory. Many names of one dataset cannot either: what all together ask for is bounded alike.

use std::cell::Cell;
use std::fs::File as Disk;
use std::io::{Read, Result as IoResult, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use hdf5_pure::{
    CharacterSet, DType, Dataset, Datatype, Error, File, FileBuilder, FormatError, GroupBuilder,
    LibVer, StringPadding,
};

use super::error::InterchangeError;
use crate::files::visible::excerpt;

/// Longest text shown of what the file says of itself: types of HDF5 nest by the thousand, and their parts have names.
const SHOWN: usize = 200;

/// Bytes that one byte of a deflate stream can stand for, rounded up.
const DEFLATE_RATIO: u64 = 1100;

/// How an HDF5 file begins, at byte 0, 512, 1024, … behind a block of the user.
const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";

/// Whether an open file of a length has the signature of HDF5; leaves it at its beginning.
pub(super) fn is_signed(file: &mut Disk, len: u64) -> IoResult<bool> {
    let blocks = std::iter::successors(Some(512u64), |at| at.checked_mul(2));
    let places = std::iter::once(0).chain(blocks);
    let mut signed = false;
    for at in places.take_while(|at| at.saturating_add(8) <= len) {
        let mut found = [0; 8];
        file.seek(SeekFrom::Start(at))?;
        file.read_exact(&mut found)?;
        signed = found == SIGNATURE;
        if signed {
            break;
        }
    }
    file.rewind()?;
    Ok(signed)
}

/// A file being read.
pub(super) struct Tree {
    file: File,
    path: PathBuf,
    size: u64,
    /// Bytes of the file that the datasets read so far must take.
    taken: Cell<u64>,
}

impl Tree {
    /// Opens the bytes of a file; `path` is only for messages.
    pub fn open(path: &Path, bytes: Vec<u8>) -> Result<Self, InterchangeError> {
        let size = bytes.len() as u64;
        let file = File::from_bytes(bytes).map_err(|e| unreadable(path, "", &e))?;
        Ok(Self {
            file,
            path: path.into(),
            size,
            taken: Cell::new(0),
        })
    }

    /// Whether a group is there.
    pub fn has_group(&self, name: &str) -> Result<bool, InterchangeError> {
        match self.file.group(name) {
            Ok(_) => Ok(true),
            Err(Error::Format(FormatError::PathNotFound(_))) => Ok(false),
            Err(error) => Err(unreadable(&self.path, name, &error)),
        }
    }

    /// Names of the groups and datasets in a group, of the file itself for `""`; none where they cannot be listed.
    pub fn names(&self, group: &str) -> Vec<String> {
        let group = match group {
            "" => Ok(self.file.root()),
            name => self.file.group(name),
        };
        let Ok(group) = group else {
            return Vec::new();
        };
        let [groups, datasets] = [group.groups(), group.datasets()].map(Result::unwrap_or_default);
        groups.into_iter().chain(datasets).collect()
    }

    fn dataset(&self, name: &str) -> Result<Option<Dataset>, InterchangeError> {
        match self.file.dataset(name) {
            Ok(dataset) => Ok(Some(dataset)),
            Err(Error::Format(FormatError::PathNotFound(_))) => Ok(None),
            Err(error) => Err(unreadable(&self.path, name, &error)),
        }
    }

    /// Error about a part that is not there.
    pub fn missing(&self, name: &str) -> InterchangeError {
        InterchangeError::refused(&self.path, format!("{name} is missing"))
    }

    /// Error about the length of a dataset.
    pub fn length(&self, name: &str, found: u64, allowed: impl Into<String>) -> InterchangeError {
        InterchangeError::unexpected(&self.path, format!("{name} has {found} entries"), allowed)
    }

    /// Error about one number of a dataset.
    pub fn value(
        &self,
        name: &str,
        index: usize,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> InterchangeError {
        InterchangeError::Value {
            path: self.path.clone(),
            dataset: name.into(),
            index,
            value: value.to_string(),
            allowed: allowed.into(),
        }
    }

    /// Number of elements, refused if the file is too small to hold them.
    fn extent(&self, name: &str, dataset: &Dataset) -> Result<u64, InterchangeError> {
        let unreadable = |e: Error| unreadable(&self.path, name, &e);
        let shape = dataset.shape().map_err(unreadable)?;
        let element = dataset.element_size().map_err(unreadable)?.max(1);
        let ratio = if dataset.is_chunked() {
            DEFLATE_RATIO
        } else {
            1
        };
        let largest = self.size.saturating_mul(ratio) / element;
        let extent = (shape.iter()).try_fold(1u64, |n, &extent| n.checked_mul(extent));
        let Some(extent) = extent.filter(|&extent| extent <= largest) else {
            let allowed = format!("at most {largest}, which is what the file can hold");
            return Err(self.length(name, extent.unwrap_or(u64::MAX), allowed));
        };
        self.taken.set(self.taken.get() + extent * element / ratio);
        if self.taken.get() > self.size {
            let what = format!("{name}: the datasets up to this one need more than the file holds");
            return Err(InterchangeError::refused(&self.path, what));
        }
        Ok(extent)
    }

    /// One integer.
    pub fn integer(&self, name: &str) -> Result<i64, InterchangeError> {
        let values = self.integers(name)?;
        match values[..] {
            [value] => Ok(value),
            _ => Err(self.length(name, values.len() as u64, "1")),
        }
    }

    /// Integers of any width.
    pub fn integers(&self, name: &str) -> Result<Vec<i64>, InterchangeError> {
        use DType::{I8, I16, I32, I64, U8, U16, U32, U64};
        let (dataset, _) = self.typed(name, "integers", |t| {
            matches!(t, I8 | I16 | I32 | I64 | U8 | U16 | U32 | U64)
        })?;
        (dataset.read_i64()).map_err(|e| unreadable(&self.path, name, &e))
    }

    /// `len` finite reals.
    pub fn reals(&self, name: &str, len: usize) -> Result<Vec<f64>, InterchangeError> {
        let values = self.all_reals(name)?;
        if values.len() != len {
            return Err(self.length(name, values.len() as u64, len.to_string()));
        }
        Ok(values)
    }

    /// Finite reals, as many as there are.
    pub fn all_reals(&self, name: &str) -> Result<Vec<f64>, InterchangeError> {
        let (dataset, _) = self.typed(name, "reals", |t| matches!(t, DType::F32 | DType::F64))?;
        let values = (dataset.read_f64()).map_err(|e| unreadable(&self.path, name, &e))?;
        match values.iter().position(|v| !v.is_finite()) {
            None => Ok(values),
            Some(index) => Err(self.value(name, index, values[index], "finite numbers")),
        }
    }

    fn typed(
        &self,
        name: &str,
        allowed: &'static str,
        fits: impl Fn(&DType) -> bool,
    ) -> Result<(Dataset, u64), InterchangeError> {
        let dataset = self.dataset(name)?.ok_or_else(|| self.missing(name))?;
        let extent = self.extent(name, &dataset)?;
        let found = (dataset.dtype()).map_err(|e| unreadable(&self.path, name, &e))?;
        if fits(&found) {
            return Ok((dataset, extent));
        }
        let found = format!("{name} holds {}", excerpt(&found.to_string(), SHOWN));
        Err(InterchangeError::unexpected(&self.path, found, allowed))
    }

    /// Text, if it is there.
    pub fn text(&self, name: &str) -> Result<Option<String>, InterchangeError> {
        if self.dataset(name)?.is_none() {
            return Ok(None);
        }
        let (dataset, extent) = self.typed(name, "text", |t| {
            matches!(t, DType::String | DType::VariableLengthString)
        })?;
        // Texts of variable length may all be the same bytes of the file, which the extent does not bound.
        if extent > 1 {
            return Err(self.length(name, extent, "1"));
        }
        let texts = (dataset.read_string()).map_err(|e| unreadable(&self.path, name, &e))?;
        Ok(texts.into_iter().next())
    }
}

fn unreadable(path: &Path, dataset: &str, error: &Error) -> InterchangeError {
    let mut reason = excerpt(&error.to_string(), SHOWN);
    let newer = matches!(
        error,
        Error::Format(
            FormatError::InvalidLayoutVersion(_)
                | FormatError::UnsupportedVersion(_)
                | FormatError::InvalidDatatypeVersion { .. }
                | FormatError::InvalidObjectHeaderVersion(_)
        )
    );
    if newer {
        reason += "; files in the newest HDF5 format can be rewritten by `h5repack --high=2 in out` \
                   or by h5py with libver=('earliest', 'v110')";
    }
    InterchangeError::Hdf5 {
        path: path.into(),
        dataset: dataset.into(),
        reason,
    }
}

/// A file being written: HDF5 1.8 format, datasets of rank 1 in the native types of FCLIB.
pub(super) struct Writer(FileBuilder);

impl Writer {
    pub fn new() -> Self {
        let mut file = FileBuilder::new();
        file.with_libver_bounds(LibVer::Earliest, LibVer::V18);
        Self(file)
    }

    /// Adds a group of the root.
    pub fn group(&mut self, name: &str, fill: impl FnOnce(&mut GroupBuilder)) {
        let mut group = self.0.create_group(name);
        fill(&mut group);
        self.0.add_group(group.finish());
    }

    /// The bytes of the file.
    pub fn finish(self) -> Result<Vec<u8>, InterchangeError> {
        self.0.finish().map_err(|e| InterchangeError::Unwritable {
            what: e.to_string(),
        })
    }
}

/// Adds a group inside a group.
pub(super) fn subgroup(
    parent: &mut GroupBuilder,
    name: &str,
    fill: impl FnOnce(&mut GroupBuilder),
) {
    let mut group = parent.create_group(name);
    fill(&mut group);
    parent.add_group(group.finish());
}

/// Adds a dataset of 32-bit integers.
pub(super) fn put_integers(group: &mut GroupBuilder, name: &str, values: &[i32]) {
    group.create_dataset(name).with_i32_data(values);
}

/// Adds a dataset of reals.
pub(super) fn put_reals(group: &mut GroupBuilder, name: &str, values: &[f64]) {
    group.create_dataset(name).with_f64_data(values);
}

/// Adds text as C expects it: one string that ends with a zero byte.
pub(super) fn put_text(group: &mut GroupBuilder, name: &str, text: &str) {
    let mut bytes: Vec<u8> = text.bytes().filter(|&b| b != 0).collect();
    bytes.push(0);
    let datatype = Datatype::String {
        size: bytes.len() as u32,
        padding: StringPadding::NullTerminate,
        charset: if text.is_ascii() {
            CharacterSet::Ascii
        } else {
            CharacterSet::Utf8
        },
    };
    let dataset = group.create_dataset(name);
    dataset.with_shape(&[]).with_raw_data(datatype, bytes, 1);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: memory is bounded by the size of the file also where many names stand for the same bytes of it.
    #[test]
    fn one_dataset_under_many_names_is_read_once() {
        let mut file = Writer::new();
        file.group("g", |group| put_reals(group, "x", &[0.5; 10_000]));
        let tree = Tree::open(Path::new("a.hdf5"), file.finish().unwrap()).unwrap();
        assert_eq!(tree.all_reals("g/x").unwrap().len(), 10_000);
        let error = tree.all_reals("g/x").unwrap_err().to_string();
        assert!(
            error.contains("g/x") && error.contains("more than the file holds"),
            "{error}"
        );
    }
}
