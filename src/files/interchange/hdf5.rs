//! The HDF5 tree of a problem file: named datasets of integers, reals and text.
//!
//! Nothing is allocated for a dataset before its extent was compared with what the problem asks for, and with what files of
//! its size may unpack to: a few wrong bytes, or many zeros in few, cannot ask for all memory. Many names of one dataset
//! cannot either: what all together ask for is bounded.

use std::cell::Cell;
use std::fs::File as Disk;
use std::io::{Read, Result as IoResult, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use hdf5_pure::{
    CharacterSet, DType, Dataset, Datatype, Error, File, FileBuilder, FormatError, Group,
    GroupBuilder, LibVer, StringPadding,
};

use super::error::InterchangeError;
use crate::files::visible::excerpt;

/// Longest text shown of what the file says of itself: types of HDF5 nest by the thousand, and their parts have names.
const SHOWN: usize = 200;

/// Bytes that a file may unpack to: so many beside its size, and so many times its size. Datasets that were never written
/// take no room and read as zeros, and zeros take a thousandth of theirs.
const UNPACKED: u64 = 64 << 20;
const RATIO: u64 = 32;

/// Largest whole number up to which reals hold all.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

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
    /// Bytes that the datasets not read so far may unpack to.
    room: Cell<u64>,
}

impl Tree {
    /// Opens the bytes of a file; `path` is only for messages.
    pub fn open(path: &Path, bytes: Vec<u8>) -> Result<Self, InterchangeError> {
        let room = Cell::new(UNPACKED + RATIO * bytes.len() as u64);
        let file = File::from_bytes(bytes).map_err(|e| unreadable(path, "", &e))?;
        Ok(Self {
            file,
            path: path.into(),
            room,
        })
    }

    /// Whether a group is there.
    pub fn has_group(&self, name: &str) -> Result<bool, InterchangeError> {
        Ok(self.found(name, self.file.group(name))?.is_some())
    }

    /// A group, the file itself for `""`.
    fn group(&self, name: &str) -> Result<Group, Error> {
        match name {
            "" => Ok(self.file.root()),
            name => self.file.group(name),
        }
    }

    /// Names of the groups and datasets in a group, of the file itself for `""`; none where they cannot be listed.
    pub fn names(&self, group: &str) -> Vec<String> {
        let Ok(group) = self.group(group) else {
            return Vec::new();
        };
        let [groups, datasets] = [group.groups(), group.datasets()].map(Result::unwrap_or_default);
        groups.into_iter().chain(datasets).collect()
    }

    fn dataset(&self, name: &str) -> Result<Option<Dataset>, InterchangeError> {
        self.found(name, self.file.dataset(name))
    }

    /// The thing looked for, if it is there.
    fn found<T>(
        &self,
        name: &str,
        looked: Result<T, Error>,
    ) -> Result<Option<T>, InterchangeError> {
        match looked {
            Ok(found) => Ok(Some(found)),
            Err(Error::Format(FormatError::PathNotFound(_))) => Ok(None),
            Err(error) => Err(unreadable(&self.path, name, &error)),
        }
    }

    /// Error about a part.
    pub fn refused(&self, name: &str, what: &str) -> InterchangeError {
        InterchangeError::refused(&self.path, format!("{name} {what}"))
    }

    /// Error about a part that is not there.
    pub fn missing(&self, name: &str) -> InterchangeError {
        self.refused(name, "is missing, or a link, which is not followed")
    }

    /// Error about the length of a dataset.
    pub fn length(&self, name: &str, found: u64, allowed: impl Into<String>) -> InterchangeError {
        self.refused(
            name,
            &format!("has {found} entries, expected {}", allowed.into()),
        )
    }

    /// Error about one number of a dataset.
    pub fn value(
        &self,
        name: &str,
        index: usize,
        value: impl ToString,
        allowed: impl Into<String>,
    ) -> InterchangeError {
        let (value, allowed) = (value.to_string(), allowed.into());
        let what = format!("{name}[{index}] = {value}, allowed: {allowed}");
        InterchangeError::refused(&self.path, what)
    }

    /// Number of elements of a dataset. Nothing is read for it.
    pub fn extent(&self, name: &str) -> Result<u64, InterchangeError> {
        let dataset = self.dataset(name)?.ok_or_else(|| self.missing(name))?;
        let shape = (dataset.shape()).map_err(|e| unreadable(&self.path, name, &e))?;
        Ok(shape.into_iter().fold(1, u64::saturating_mul))
    }

    /// Whether a dataset is there.
    pub fn has(&self, name: &str) -> Result<bool, InterchangeError> {
        Ok(self.dataset(name)?.is_some())
    }

    /// One integer.
    pub fn integer(&self, name: &str) -> Result<i64, InterchangeError> {
        Ok(self.integers(name, 1)?[0])
    }

    /// `len` integers of any width, or whole numbers among reals: MATLAB has no others.
    pub fn integers(&self, name: &str, len: usize) -> Result<Vec<i64>, InterchangeError> {
        let (dataset, found) = self.numbers(name, len)?;
        if !matches!(found, DType::F32 | DType::F64) {
            return self.all(name, len, dataset.read_i64(), |_| true, "integers");
        }
        let whole = |v: &f64| v.fract() == 0.0 && v.abs() <= LARGEST_WHOLE;
        let values = self.all(name, len, dataset.read_f64(), whole, "whole numbers")?;
        Ok(values.into_iter().map(|v| v as i64).collect())
    }

    /// `len` finite reals, or integers.
    pub fn reals(&self, name: &str, len: usize) -> Result<Vec<f64>, InterchangeError> {
        let read = self.numbers(name, len)?.0.read_f64();
        self.all(name, len, read, |v| v.is_finite(), "finite numbers")
    }

    /// The numbers read, if they are as many as the shape says (of a spoilt layout there may be fewer), and all of them fit.
    fn all<T: Copy + ToString>(
        &self,
        name: &str,
        len: usize,
        read: Result<Vec<T>, Error>,
        fits: impl Fn(&T) -> bool,
        allowed: &str,
    ) -> Result<Vec<T>, InterchangeError> {
        let values = read.map_err(|e| unreadable(&self.path, name, &e))?;
        if values.len() != len {
            return Err(self.length(name, values.len() as u64, len.to_string()));
        }
        match values.iter().position(|v| !fits(v)) {
            None => Ok(values),
            Some(index) => Err(self.value(name, index, values[index], allowed)),
        }
    }

    /// A dataset of `len` numbers, not read.
    fn numbers(&self, name: &str, len: usize) -> Result<(Dataset, DType), InterchangeError> {
        use DType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
        let extent = self.extent(name)?;
        if extent != len as u64 {
            return Err(self.length(name, extent, len.to_string()));
        }
        let dataset = self.dataset(name)?.ok_or_else(|| self.missing(name))?;
        let unreadable = |e: Error| unreadable(&self.path, name, &e);
        let found = dataset.dtype().map_err(unreadable)?;
        if !matches!(
            found,
            F32 | F64 | I8 | I16 | I32 | I64 | U8 | U16 | U32 | U64
        ) {
            let found = excerpt(&found.to_string(), SHOWN);
            return Err(self.refused(name, &format!("holds {found}, expected numbers")));
        }
        self.charge(name, &dataset, extent)?;
        Ok((dataset, found))
    }

    /// Takes what a dataset unpacks to off what all may.
    fn charge(&self, name: &str, dataset: &Dataset, extent: u64) -> Result<(), InterchangeError> {
        let element = (dataset.element_size()).map_err(|e| unreadable(&self.path, name, &e))?;
        // Numbers are read into eight bytes, whatever they take there.
        let left = self
            .room
            .get()
            .checked_sub(extent.saturating_mul(element.max(8)));
        let what = "and the datasets before it unpack to more than";
        let more = || format!("{what} {UNPACKED} bytes and {RATIO} times the file");
        let left = left.ok_or_else(|| self.refused(name, &more()))?;
        self.room.set(left);
        Ok(())
    }

    /// Whether a group, the file itself for `""`, has an attribute that is 1; not where its attributes cannot be read.
    pub fn flagged(&self, group: &str, attribute: &str) -> bool {
        let group = self.group(group);
        let mut found = group.and_then(|group| group.attrs()).unwrap_or_default();
        let value = found.remove(attribute).map(|value| value.to_string());
        value.is_some_and(|value| value.trim_matches(['[', ']']) == "1")
    }

    /// One text, if it is there: what a file says of itself decides nothing.
    pub fn text(&self, name: &str) -> Option<String> {
        let dataset = self.dataset(name).ok()??;
        let is_text = matches!(
            dataset.dtype().ok()?,
            DType::String | DType::VariableLengthString
        );
        // Texts of variable length may all be the same bytes of the file, which the extent does not bound.
        let one = is_text && self.extent(name).ok()? == 1;
        one.then(|| self.charge(name, &dataset, 1).ok())??;
        dataset.read_string().ok()?.pop()
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
    InterchangeError::unreadable(path, dataset, &reason)
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

    /// Goal: memory is bounded also where many names stand for the same bytes of the file.
    #[test]
    fn one_dataset_under_many_names_is_not_read_without_end() {
        let mut file = Writer::new();
        file.group("g", |group| put_reals(group, "x", &[0.5; 10_000]));
        let tree = Tree::open(Path::new("a.hdf5"), file.finish().unwrap()).unwrap();
        tree.room.set(100_000);
        assert_eq!(tree.reals("g/x", 10_000).unwrap().len(), 10_000);
        let error = tree.reals("g/x", 10_000).unwrap_err().to_string();
        assert!(
            error.contains("g/x") && error.contains("unpack to more than"),
            "{error}"
        );
    }
}
