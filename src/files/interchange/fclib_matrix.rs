//! A matrix in an FCLIB file: `m`, `n`, `nzmax`, `nz`, `p`, `i`, `x`.
//!
//! A matrix is stored as compressed columns (nz = −1), compressed rows (nz = −2) or nz >= 0 triplets. Of a triplet, `i`
//! holds the row and `p` the column in what Siconos and every other user of CSparse writes; FCLIB's header says the
//! opposite. Files of either kind are read: rows are in `i` if that fits the matrix, otherwise in `p`. Square matrices fit
//! both ways: of an unsymmetric W the rows are those of Siconos, which writes such files and reads them so. A group with the
//! attribute `symmetric_packed` (or a number of that name) holds one triangle of a symmetric matrix.
//!
//! Written are triplets with rows in `i`: Siconos writes them itself, refuses compressed rows of M and H, and copies
//! `nz` = −1 indices of compressed columns (its `fclib_interface.c` of 2024).

use hdf5_pure::GroupBuilder;

use super::error::{InterchangeError, check_size, unwritable};
use super::hdf5::{Tree, put_integers, put_reals, subgroup};
use super::sparse::SparseMatrix;

/// Says that a matrix holds one triangle of a symmetric one.
const PACKED: &str = "symmetric_packed";

/// Matrices that may be symmetric.
const OPERATORS: [&str; 3] = ["/W", "/M", "/R"];

/// Reads a matrix of known size.
pub(super) fn read_matrix(
    tree: &Tree,
    name: &str,
    rows: usize,
    cols: usize,
) -> Result<SparseMatrix, InterchangeError> {
    for (size, expected) in [("m", rows), ("n", cols)] {
        let dataset = format!("{name}/{size}");
        let value = tree.integer(&dataset)?;
        if usize::try_from(value) != Ok(expected) {
            let allowed = format!("{expected}, as the vectors say");
            return Err(tree.value(&dataset, 0, value, allowed));
        }
    }
    let nz_name = format!("{name}/nz");
    let nz = tree.integer(&nz_name)?;
    let arrays = ["p", "i", "x"].map(|array| format!("{name}/{array}"));
    let [p, i, x] = arrays.each_ref().map(|array| tree.extent(array));
    let found = [p?, i?, x?];
    // Some writers pad arrays to nzmax.
    let longest = found.into_iter().max().unwrap_or(0);
    let (pointers, most) = match nz {
        -1 => (Some(cols as u64 + 1), found[2]),
        -2 => (Some(rows as u64 + 1), found[2]),
        0.. => (None, longest.max(nz as u64)),
        _ => {
            let allowed = "-1 (compressed columns), -2 (compressed rows), 0 and above (triplets)";
            return Err(tree.value(&nz_name, 0, nz, allowed));
        }
    };
    let expected = [pointers.unwrap_or(most), most, most];
    for k in 0..3 {
        if ![expected[k], nz as u64].contains(&found[k]) {
            return Err(tree.length(&arrays[k], found[k], expected[k].to_string()));
        }
    }
    let [p, i] = [0, 1].map(|k| tree.integers(&arrays[k], found[k] as usize));
    let (p, i, x) = (p?, i?, tree.reals(&arrays[2], found[2] as usize)?);
    let stored = Stored {
        tree,
        name,
        p: &p,
        i: &i,
        x: &x,
    };
    let triplets: Vec<_> = match nz {
        -1 => stored
            .compressed(cols, rows)?
            .map(|(j, i, v)| (i, j, v))
            .collect(),
        -2 => stored.compressed(rows, cols)?.collect(),
        _ => stored.triplets(nz as usize, rows, cols)?,
    };
    let matrix = SparseMatrix::from_triplets(rows, cols, triplets);
    let mut matrix = matrix.ok_or_else(|| stored.outside("i", 0, 0, rows))?;
    if OPERATORS.iter().any(|own| name.ends_with(own)) && is_packed(tree, name)? {
        if matrix.sides() == [true; 2] {
            let what = "is `symmetric_packed` and has entries on both sides of its diagonal";
            return Err(tree.refused(name, what));
        }
        matrix = matrix.mirrored();
    }
    let overflow = matrix.entries().find(|e| !e.2.is_finite());
    if let Some((i, j, value)) = overflow {
        let allowed = format!("finite sums; entry ({i}, {j}) is stored more than once");
        return Err(tree.value(&format!("{name}/x"), 0, value, allowed));
    }
    Ok(matrix)
}

/// Whether a matrix is marked, itself or with all others of the problem or the file, by an attribute or a number.
fn is_packed(tree: &Tree, name: &str) -> Result<bool, InterchangeError> {
    let number = format!("{name}/{PACKED}");
    if tree.has(&number)? {
        return Ok(tree.integer(&number)? != 0);
    }
    let problem = name.split('/').next().unwrap_or_default();
    let marks = ["", problem, name];
    Ok(marks.into_iter().any(|group| tree.flagged(group, PACKED)))
}

/// The arrays of a matrix as they lie in the file.
struct Stored<'a> {
    tree: &'a Tree,
    name: &'a str,
    p: &'a [i64],
    i: &'a [i64],
    x: &'a [f64],
}

impl Stored<'_> {
    /// (outer, inner, value) of compressed storage with pointers `p` over `outer` lines of length `inner`.
    fn compressed(
        &self,
        outer: usize,
        inner: usize,
    ) -> Result<impl Iterator<Item = (usize, usize, f64)> + '_, InterchangeError> {
        let (tree, name) = (self.tree, self.name);
        let room = self.x.len() as i64;
        let mut before = 0;
        for (index, &pointer) in self.p.iter().enumerate() {
            let fits = if index == 0 {
                pointer == 0
            } else {
                (before..=room).contains(&pointer)
            };
            if !fits {
                let allowed = match index {
                    0 => "0".to_owned(),
                    _ => format!("{before} to {room}, pointers that never fall"),
                };
                return Err(tree.value(&format!("{name}/p"), index, pointer, allowed));
            }
            before = pointer;
        }
        let used = before as usize;
        if let Some(index) = (self.i[..used].iter()).position(|&i| !(0..inner as i64).contains(&i))
        {
            return Err(self.outside("i", index, self.i[index], inner));
        }
        let line = |k: usize| self.p[k] as usize..self.p[k + 1] as usize;
        Ok((0..outer).flat_map(move |o| line(o).map(move |k| (o, self.i[k] as usize, self.x[k]))))
    }

    /// (row, column, value) of `nz` triplets.
    fn triplets(
        &self,
        nz: usize,
        rows: usize,
        cols: usize,
    ) -> Result<Vec<(usize, usize, f64)>, InterchangeError> {
        let (p, i, x) = (&self.p[..nz], &self.i[..nz], &self.x[..nz]);
        let stray = |indices: &[i64], size: usize| {
            indices.iter().position(|&k| !(0..size as i64).contains(&k))
        };
        let (row, col) = match (stray(i, rows), stray(p, cols)) {
            (None, None) => (i, p),
            _ if stray(p, rows).is_none() && stray(i, cols).is_none() => (p, i),
            (Some(index), _) => return Err(self.outside("i", index, i[index], rows)),
            (None, Some(index)) => return Err(self.outside("p", index, p[index], cols)),
        };
        let triplet = |k: usize| (row[k] as usize, col[k] as usize, x[k]);
        Ok((0..nz).map(triplet).collect())
    }

    fn outside(&self, array: &str, index: usize, value: i64, size: usize) -> InterchangeError {
        let dataset = format!("{}/{array}", self.name);
        let allowed = format!("0 to {}", size as i64 - 1);
        self.tree.value(&dataset, index, value, allowed)
    }
}

pub(super) fn check_matrix(
    what: &str,
    matrix: &SparseMatrix,
    rows: usize,
    cols: usize,
) -> Result<(), InterchangeError> {
    check_size(&format!("{what} (rows)"), matrix.rows(), rows)?;
    check_size(&format!("{what} (columns)"), matrix.cols(), cols)?;
    // FCLIB counts in C's int.
    let sizes = [matrix.rows(), matrix.cols(), matrix.len()];
    if sizes.iter().all(|&n| i32::try_from(n).is_ok()) {
        Ok(())
    } else {
        Err(unwritable(format!("{what}: more than 2147483647 entries")))
    }
}

/// Writes a checked matrix as triplets.
pub(super) fn put_matrix(group: &mut GroupBuilder, name: &str, matrix: &SparseMatrix) {
    let index = |k: usize| k as i32;
    let (mut p, mut i, mut x) = (Vec::new(), Vec::new(), Vec::new());
    for (row, col, value) in matrix.entries() {
        i.push(index(row));
        p.push(index(col));
        x.push(value);
    }
    subgroup(group, name, |group| {
        put_integers(group, "m", &[index(matrix.rows())]);
        put_integers(group, "n", &[index(matrix.cols())]);
        put_integers(group, "nzmax", &[index(matrix.len())]);
        put_integers(group, "nz", &[index(matrix.len())]);
        put_integers(group, "p", &p);
        put_integers(group, "i", &i);
        put_reals(group, "x", &x);
    });
}
