//! Common parts of the local and the global problem of FCLIB: sizes, friction, info, solutions.

use hdf5_pure::GroupBuilder;

use super::error::{InterchangeError, check_size, unwritable};
use super::fclib_matrix::{check_matrix, put_matrix};
use super::hdf5::{Tree, Writer, put_integers, put_reals, put_text, subgroup};
use super::sparse::SparseMatrix;

/// Words of the author about a problem.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Info {
    /// Title.
    pub title: Option<String>,
    /// Description.
    pub description: Option<String>,
    /// Known mathematical properties.
    pub math_info: Option<String>,
}

/// A solution or a guess.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solution {
    /// Global unknowns v; empty in local files.
    pub v: Vec<f64>,
    /// Local velocity u.
    pub u: Vec<f64>,
    /// Reaction r.
    pub r: Vec<f64>,
    /// Multiplier λ of the equality constraints; empty where there are none.
    pub l: Vec<f64>,
}

impl Solution {
    /// Its parts by their names in files.
    fn parts(&self) -> [(&'static str, &[f64]); 4] {
        [
            ("v", &self.v),
            ("u", &self.u),
            ("r", &self.r),
            ("l", &self.l),
        ]
    }
}

/// Lengths of v, u = r, and l.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lengths {
    pub v: usize,
    pub r: usize,
    pub l: usize,
}

/// `spacedim` of a problem group.
pub(super) fn read_dim(tree: &Tree, group: &str) -> Result<usize, InterchangeError> {
    let name = format!("{group}/spacedim");
    match tree.integer(&name)? {
        2 => Ok(2),
        3 => Ok(3),
        value => Err(tree.value(&name, 0, value, "2 or 3")),
    }
}

/// μ of every point.
pub(super) fn read_friction(
    tree: &Tree,
    group: &str,
    points: usize,
) -> Result<Vec<f64>, InterchangeError> {
    let name = format!("{group}/vectors/mu");
    let mu = tree.reals(&name, points)?;
    match mu.iter().position(|&mu| mu < 0.0) {
        None => Ok(mu),
        Some(index) => Err(tree.value(&name, index, mu[index], "0 and above")),
    }
}

/// Entries of a vector with `dim` for each contact point.
pub(super) fn rows(tree: &Tree, name: &str, dim: usize) -> Result<usize, InterchangeError> {
    let rows = tree.extent(name)?;
    if rows.is_multiple_of(dim as u64) {
        return Ok(rows as usize);
    }
    Err(tree.length(name, rows, format!("a multiple of spacedim = {dim}")))
}

/// Info of a problem group: what is there.
pub(super) fn read_info(tree: &Tree, group: &str) -> Info {
    let text = |part: &str| tree.text(&format!("{group}/info/{part}"));
    Info {
        title: text("title"),
        description: text("description"),
        math_info: text("math_info"),
    }
}

/// A solution, if it is there and complete.
fn read_solution(tree: &Tree, group: &str, len: Lengths) -> Option<Solution> {
    let part = |part: &str, len: usize| match len {
        0 => Some(Vec::new()),
        _ => tree.reals(&format!("{group}/{part}"), len).ok(),
    };
    Some(Solution {
        v: part("v", len.v)?,
        u: part("u", len.r)?,
        r: part("r", len.r)?,
        l: part("l", len.l)?,
    })
}

/// Solution and guesses of a file, which need not be there: nothing is solved with them.
pub(super) fn read_solutions(tree: &Tree, len: Lengths) -> (Option<Solution>, Vec<Solution>) {
    let count = tree.integer("guesses/number_of_guesses").unwrap_or(0);
    let guess = |number| read_solution(tree, &format!("guesses/{number}"), len);
    let guesses = (1..=count).map_while(guess).collect();
    (read_solution(tree, "solution", len), guesses)
}

/// A problem on its way into a file.
pub(super) struct Layout<'a> {
    /// Group of the problem.
    pub group: &'static str,
    /// Components per contact point.
    pub dim: usize,
    /// Number of contact points.
    pub points: usize,
    /// Name, matrix, and the rows and columns it must have.
    pub matrices: Vec<(&'static str, &'a SparseMatrix, [usize; 2])>,
    /// Name, vector, and the entries it must have.
    pub vectors: Vec<(&'static str, &'a [f64], usize)>,
    /// Words of the author.
    pub info: &'a Info,
    /// Lengths of solutions.
    pub lengths: Lengths,
    /// Solution.
    pub solution: Option<&'a Solution>,
    /// Guesses.
    pub guesses: &'a [Solution],
}

impl Layout<'_> {
    fn check(&self) -> Result<(), InterchangeError> {
        let (dim, points) = (self.dim, self.points);
        if !(dim == 2 || dim == 3) {
            return Err(unwritable(format!("{points} points of {dim} components")));
        }
        for (name, values, len) in &self.vectors {
            check_size(name, values.len(), *len)?;
        }
        for (name, matrix, [rows, cols]) in &self.matrices {
            check_matrix(name, matrix, *rows, *cols)?;
        }
        let Lengths { v, r, l } = self.lengths;
        for solution in self.solution.into_iter().chain(self.guesses) {
            for ((name, values), len) in solution.parts().into_iter().zip([v, r, r, l]) {
                check_size(&format!("solution {name}"), values.len(), len)?;
            }
        }
        Ok(())
    }

    /// The bytes of the file.
    ///
    /// # Errors
    /// [`InterchangeError::Unwritable`] if the parts do not fit or exceed 32-bit integers.
    pub fn to_bytes(&self) -> Result<Vec<u8>, InterchangeError> {
        self.check()?;
        let mut file = Writer::new();
        file.group(self.group, |group| {
            put_integers(group, "spacedim", &[self.dim as i32]);
            for (name, matrix, _) in &self.matrices {
                put_matrix(group, name, matrix);
            }
            subgroup(group, "vectors", |group| {
                for (name, values, _) in &self.vectors {
                    put_reals(group, name, values);
                }
            });
            put_info(group, self.info);
        });
        put_solutions(&mut file, self.solution, self.guesses);
        file.finish()
    }
}

fn put_info(group: &mut GroupBuilder, info: &Info) {
    if *info == Info::default() {
        return;
    }
    subgroup(group, "info", |group| {
        let parts = [
            ("title", &info.title),
            ("description", &info.description),
            ("math_info", &info.math_info),
        ];
        for (name, text) in parts {
            if let Some(text) = text {
                put_text(group, name, text);
            }
        }
    });
}

fn put_solution(group: &mut GroupBuilder, solution: &Solution) {
    let parts = solution.parts().into_iter();
    for (name, values) in parts.filter(|part| !part.1.is_empty()) {
        put_reals(group, name, values);
    }
}

fn put_solutions(file: &mut Writer, solution: Option<&Solution>, guesses: &[Solution]) {
    if let Some(solution) = solution {
        file.group("solution", |group| put_solution(group, solution));
    }
    if !guesses.is_empty() {
        file.group("guesses", |group| {
            put_integers(group, "number_of_guesses", &[guesses.len() as i32]);
            for (number, guess) in guesses.iter().enumerate() {
                subgroup(group, &(number + 1).to_string(), |group| {
                    put_solution(group, guess)
                });
            }
        });
    }
}
