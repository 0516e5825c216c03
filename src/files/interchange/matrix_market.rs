//! MatrixMarket text files: `coordinate real` matrices and `array real` vectors.
//!
//! Numbers are written with the fewest digits that give the same number back, at most 17. Indices in the file start at 1
//! (Boisvert, Pozo, Remington: The Matrix Market exchange formats, NISTIR 5935, 1996).

use std::fmt::Write;
use std::path::Path;

use super::error::InterchangeError;
use super::sparse::SparseMatrix;
use crate::files::regular;
use crate::files::visible::excerpt;

const BANNER: &str = "%%MatrixMarket matrix";

/// A matrix with all its stored entries.
pub fn general(matrix: &SparseMatrix) -> String {
    coordinates("general", matrix, |_, _| true)
}

/// The lower triangle of a symmetric matrix; the upper one is not looked at.
pub fn symmetric(matrix: &SparseMatrix) -> String {
    coordinates("symmetric", matrix, |i, j| i >= j)
}

fn coordinates(
    symmetry: &str,
    matrix: &SparseMatrix,
    keep: impl Fn(usize, usize) -> bool,
) -> String {
    let kept: Vec<_> = matrix.entries().filter(|e| keep(e.0, e.1)).collect();
    let mut text = format!("{BANNER} coordinate real {symmetry}\n");
    let _ = writeln!(text, "{} {} {}", matrix.rows(), matrix.cols(), kept.len());
    for (i, j, value) in kept {
        let _ = writeln!(text, "{} {} {value:e}", i + 1, j + 1);
    }
    text
}

/// A vector as a matrix of one column.
pub fn vector(values: &[f64]) -> String {
    let mut text = format!("{BANNER} array real general\n{} 1\n", values.len());
    for value in values {
        let _ = writeln!(text, "{value:e}");
    }
    text
}

/// Most rows of a matrix: those without entries take no line, but memory as soon as the matrix is transposed.
const MOST_ROWS: usize = 1 << 22;

/// Reads a file of at most `most` bytes, see [`parse`].
///
/// # Errors
/// Those of [`parse`], and a file that is larger or no regular file.
pub fn read(path: &Path, most: u64) -> Result<SparseMatrix, InterchangeError> {
    let text = regular::read_text(path, most).map_err(|source| InterchangeError::Io {
        path: path.into(),
        source,
    })?;
    parse(path, &text)
}

/// Reads what this module writes: a `coordinate` or `array` matrix of reals, `general` or `symmetric`. `path` is only
/// for messages.
///
/// # Errors
/// [`InterchangeError::Line`] naming the line and what was expected.
pub fn parse(path: &Path, text: &str) -> Result<SparseMatrix, InterchangeError> {
    let mut lines = Lines {
        path,
        lines: text.lines().enumerate(),
        last: 0,
    };
    let banner = lines.next("a MatrixMarket banner")?;
    let words: Vec<String> = banner.split_whitespace().map(str::to_lowercase).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let form = match words[..] {
        [
            "%%matrixmarket",
            "matrix",
            format,
            "real" | "integer",
            symmetry,
        ] => (format, symmetry),
        _ => ("", ""),
    };
    let (array, symmetric) = match form {
        ("coordinate", "general") => (false, false),
        ("coordinate", "symmetric") => (false, true),
        ("array", "general") => (true, false),
        _ => {
            let allowed = "a real matrix, `coordinate` general or symmetric, or `array` general";
            return Err(lines.error(banner, format!("{BANNER} …: {allowed}")));
        }
    };
    let header = lines.content("the sizes")?;
    let sizes = (header.split_whitespace()).map(|word| word.parse().ok());
    let sizes: Vec<usize> = sizes.collect::<Option<_>>().unwrap_or_default();
    let (rows, cols, count) = match (array, &sizes[..]) {
        (true, &[rows, cols]) => (rows, cols, rows.saturating_mul(cols)),
        (false, &[rows, cols, count]) => (rows, cols, count),
        _ => return Err(lines.error(header, "rows, columns and, for coordinates, entries")),
    };
    let line_of_sizes = lines.last;
    // Every entry takes a line, and a column without entries only a pointer.
    if count > text.len() || cols > text.len() || rows > text.len().max(MOST_ROWS) {
        return Err(lines.error(header, "sizes that the file can hold"));
    }
    let mut triplets = Vec::with_capacity(count);
    for k in 0..count {
        let line = lines.content("another entry")?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let entry = match words[..] {
            [value] if array => value.parse().ok().map(|v: f64| (k % rows, k / rows, v)),
            [i, j, value] if !array => index(i, rows)
                .zip(index(j, cols))
                .zip(value.parse().ok())
                .map(|((i, j), v)| (i, j, v)),
            _ => None,
        };
        let Some((i, j, value)) = entry.filter(|e| e.2.is_finite()) else {
            let allowed = match array {
                true => "one finite number".to_owned(),
                false => format!("row 1 to {rows}, column 1 to {cols} and a finite number"),
            };
            return Err(lines.error(line, allowed));
        };
        triplets.push((i, j, value));
        if symmetric && i != j {
            triplets.push((j, i, value));
        }
    }
    if let Some(line) = lines.content_or_end() {
        return Err(lines.error(line, "the end of the file, all entries are read"));
    }
    lines.last = line_of_sizes;
    let sizes = || lines.error(header, "a square matrix, because it is symmetric");
    let matrix = SparseMatrix::from_triplets(rows, cols, triplets).ok_or_else(sizes)?;
    let overflow = matrix.entries().find(|e| !e.2.is_finite());
    match overflow {
        None => Ok(matrix),
        Some((i, j, _)) => {
            let (i, j) = (i + 1, j + 1);
            let allowed = format!("finite sums; entry ({i}, {j}) stands there more than once");
            Err(lines.error(header, allowed))
        }
    }
}

fn index(word: &str, size: usize) -> Option<usize> {
    let index: usize = word.parse().ok()?;
    (1..=size).contains(&index).then(|| index - 1)
}

fn is_content(line: &str) -> bool {
    !line.trim().is_empty() && !line.starts_with('%')
}

struct Lines<'a> {
    path: &'a Path,
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    last: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self, wanted: &str) -> Result<&'a str, InterchangeError> {
        match self.lines.next() {
            Some((number, line)) => {
                self.last = number + 1;
                Ok(line)
            }
            None => {
                self.last += 1;
                Err(self.error("end of file", wanted))
            }
        }
    }

    /// The next line that is neither blank nor a comment.
    fn content(&mut self, wanted: &str) -> Result<&'a str, InterchangeError> {
        loop {
            let line = self.next(wanted)?;
            if is_content(line) {
                return Ok(line);
            }
        }
    }

    /// The same where the file may end.
    fn content_or_end(&mut self) -> Option<&'a str> {
        let (number, line) = self.lines.find(|(_, line)| is_content(line))?;
        self.last = number + 1;
        Some(line)
    }

    fn error(&self, found: &str, allowed: impl Into<String>) -> InterchangeError {
        InterchangeError::Line {
            path: self.path.into(),
            line: self.last,
            found: excerpt(found, 80),
            allowed: allowed.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn matrix(entries: &[(usize, usize, f64)]) -> SparseMatrix {
        SparseMatrix::from_triplets(7, 7, entries.iter().copied()).unwrap()
    }

    fn parsed(text: &str) -> Result<SparseMatrix, InterchangeError> {
        parse(Path::new("a.mtx"), text)
    }

    #[test]
    fn layout_is_the_published_one() {
        let a = matrix(&[(0, 0, 1.5), (2, 1, -2e-300), (1, 2, -2e-300)]);
        let text = symmetric(&a);
        assert_eq!(
            text,
            "%%MatrixMarket matrix coordinate real symmetric\n7 7 2\n1 1 1.5e0\n3 2 -2e-300\n"
        );
        assert_eq!(
            vector(&[0.1]),
            "%%MatrixMarket matrix array real general\n1 1\n1e-1\n"
        );
    }

    #[test]
    fn wrong_lines_are_named() {
        let banner = "%%MatrixMarket matrix coordinate real general\n";
        for (text, part) in [
            ("", "line 1"),
            (
                "%%MatrixMarket matrix coordinate complex general\n1 1 0\n",
                "line 1",
            ),
            (&format!("{banner}% comment\n2 2\n"), "line 3"),
            (&format!("{banner}2 2 1\n3 1 1.0\n"), "row 1 to 2"),
            (&format!("{banner}2 2 1\n1 1 nan\n"), "line 3"),
            (&format!("{banner}2 2 2\n1 1 1\n"), "line 4: `end of file`"),
            (&format!("{banner}2 2 99999999999\n"), "the file can hold"),
            (
                "%%MatrixMarket matrix coordinate real symmetric\n1 2 1\n1 2 1\n",
                "square",
            ),
        ] {
            let message = parsed(text).unwrap_err().to_string();
            assert!(message.contains(part), "{text:?}: {message}");
        }
    }

    proptest! {
        #[test]
        fn every_number_comes_back_to_the_bit(
            entries in prop::collection::vec((0..7usize, 0..7usize, prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO), 0..20),
        ) {
            let mut seen = std::collections::BTreeSet::new();
            let entries: Vec<_> = entries.into_iter().filter(|e| seen.insert((e.0, e.1))).collect();
            let a = matrix(&entries);
            let back = parsed(&general(&a)).unwrap();
            let bits = |a: &SparseMatrix| a.entries().map(|e| (e.0, e.1, e.2.to_bits())).collect::<Vec<_>>();
            prop_assert_eq!(bits(&back), bits(&a));
            let values: Vec<f64> = entries.iter().map(|e| e.2).collect();
            let back = parsed(&vector(&values)).unwrap();
            let column: Vec<u64> = (0..values.len()).map(|i| back.get(i, 0).to_bits()).collect();
            prop_assert_eq!(column, values.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        }

        #[test]
        fn any_text_is_refused_or_read(text in "(%%MatrixMarket matrix (coordinate|array) real (general|symmetric)\n)?([0-9e.% -]{0,9}\n){0,6}") {
            let _ = parsed(&text);
        }
    }
}
