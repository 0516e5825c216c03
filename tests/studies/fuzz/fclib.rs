//! FCLIB files: their bytes, and what lies in datasets that HDF5 itself can read.

use std::path::Path;

use hdf5_pure::{FileBuilder, GroupBuilder};
use stickslip::files::interchange::{Problem, fclib};
use stickslip::run::choice::Choice;
use stickslip::run::run_case::Quiet;
use stickslip::studies::exchange::problem_file::ProblemFile;
use stickslip_methods::Tier;
use stickslip_xfem::mesh::stream::Stream;

use super::bytes::{Kind, changed};
use super::{assert_clear, campaign, files_ending};

fn read(bytes: &[u8]) -> bool {
    let path = Path::new("fuzz.hdf5");
    match fclib::from_bytes(path, bytes.to_vec()) {
        Ok(problem) => {
            // What is taken is a problem that can be written and read again.
            let again = problem.to_bytes().unwrap();
            assert_eq!(fclib::from_bytes(path, again).unwrap(), problem);
            let q = match &problem {
                Problem::Local(problem) => &problem.q,
                Problem::Global(problem) => &problem.w,
            };
            assert!(q.iter().all(|q| q.is_finite()));
            true
        }
        Err(error) => {
            assert_clear(&error.to_string(), "`fuzz.hdf5`", 1);
            false
        }
    }
}

#[test]
fn any_bytes_are_a_problem_or_refused_by_name() {
    let seeds = files_ending("tests/data/fclib", "hdf5");
    let draw = move |stream: &mut _| changed(&seeds, Kind::Binary, stream);
    campaign::run("FCLIB bytes", 1500, draw, read);
}

/// Small numbers mostly, sometimes one that no file can mean.
fn integer(stream: &mut Stream) -> i64 {
    match stream.whole(0, 19) {
        0 => i64::MAX,
        1 => i64::MIN,
        2 => -1 - stream.whole(0, 3) as i64,
        3 => 1_000_000_000_000,
        4 => i64::from(i32::MAX) + stream.whole(0, 1) as i64,
        _ => stream.whole(0, 6) as i64,
    }
}

fn put_integers(group: &mut GroupBuilder, name: &str, values: &[i64], stream: &mut Stream) {
    let dataset = group.create_dataset(name);
    let fit = values.iter().all(|v| i32::try_from(*v).is_ok());
    match stream.whole(0, 30) {
        0 => dataset.with_f64_data(&vec![1.0; values.len()]),
        1 => dataset.with_u64_data(&values.iter().map(|v| *v as u64).collect::<Vec<_>>()),
        _ if fit => dataset.with_i32_data(&values.iter().map(|v| *v as i32).collect::<Vec<_>>()),
        _ => dataset.with_i64_data(values),
    };
}

fn put_reals(group: &mut GroupBuilder, name: &str, len: usize, stream: &mut Stream) {
    let len = if stream.chance(0.97) {
        len
    } else {
        stream.whole(0, 9)
    };
    let odd = [
        f64::NAN,
        f64::INFINITY,
        -0.0,
        f64::MAX,
        f64::MIN_POSITIVE,
        -1.0,
    ];
    let value = |_| match stream.whole(0, 60) {
        k @ 0..=5 => odd[k],
        k => 0.1 * k as f64,
    };
    let values: Vec<f64> = (0..len).map(value).collect();
    group.create_dataset(name).with_f64_data(&values);
}

fn put_matrix(
    parent: &mut GroupBuilder,
    name: &str,
    [rows, cols]: [usize; 2],
    stream: &mut Stream,
) {
    let mut group = parent.create_group(name);
    let entries = if rows * cols == 0 {
        0
    } else {
        stream.whole(0, 4)
    };
    let own = |value: usize, stream: &mut Stream| match stream.chance(0.97) {
        true => value as i64,
        false => integer(stream),
    };
    let kind = stream.whole(0, 2);
    // Diagonal ones are symmetric, which M and W must be.
    let diagonal: Vec<usize> = (0..entries).map(|k| k % rows.min(cols).max(1)).collect();
    let line = |n: usize| {
        let mut sorted = diagonal.clone();
        sorted.sort_unstable();
        (0..=n)
            .map(|j| sorted.partition_point(|&d| d < j))
            .collect::<Vec<_>>()
    };
    let (nz, p) = match kind {
        0 => (entries as i64, diagonal.clone()),
        1 => (-1, line(cols)),
        _ => (-2, line(rows)),
    };
    let mut i = diagonal.clone();
    if kind > 0 {
        i.sort_unstable();
    }
    let nz = if stream.chance(0.97) {
        nz
    } else {
        integer(stream)
    };
    let mut all = |values: Vec<usize>| {
        values
            .into_iter()
            .map(|v| own(v, stream))
            .collect::<Vec<_>>()
    };
    let (m, n, p, i) = (all(vec![rows]), all(vec![cols]), all(p), all(i));
    for (name, values) in [
        ("m", m),
        ("n", n),
        ("nzmax", vec![nz]),
        ("nz", vec![nz]),
        ("p", p),
        ("i", i),
    ] {
        if stream.chance(0.995) {
            put_integers(&mut group, name, &values, stream);
        }
    }
    put_reals(&mut group, "x", entries, stream);
    parent.add_group(group.finish());
}

/// A file with all parts of a problem, some of them wrong.
fn problem(stream: &mut Stream) -> Vec<u8> {
    let mut file = FileBuilder::new();
    let local = stream.chance(0.5);
    let (dim, points, extra) = (stream.whole(2, 3), stream.whole(1, 2), stream.whole(0, 2));
    let (m, n) = (dim * points, stream.whole(1, 5));
    let mut root = file.create_group(if local { "fclib_local" } else { "fclib_global" });
    let space = if stream.chance(0.95) {
        dim as i64
    } else {
        integer(stream)
    };
    put_integers(&mut root, "spacedim", &[space], stream);
    let mut vectors = root.create_group("vectors");
    let (matrices, lengths) = if local {
        (
            vec![("W", [m, m]), ("V", [m, extra]), ("R", [extra, extra])],
            vec![("q", m), ("s", extra)],
        )
    } else {
        (
            vec![("M", [n, n]), ("H", [n, m]), ("G", [n, extra])],
            vec![("f", n), ("w", m), ("b", extra)],
        )
    };
    let whole = extra > 0 || stream.chance(0.05);
    let optional = |name: &str| ["V", "R", "G", "s", "b"].contains(&name);
    for (name, len) in lengths
        .into_iter()
        .filter(|(name, _)| whole || !optional(name))
    {
        put_reals(&mut vectors, name, len, stream);
    }
    put_reals(&mut vectors, "mu", points, stream);
    root.add_group(vectors.finish());
    for (name, size) in matrices
        .into_iter()
        .filter(|(name, _)| whole || !optional(name))
    {
        put_matrix(&mut root, name, size, stream);
    }
    file.add_group(root.finish());
    if stream.chance(0.3) {
        let mut guesses = file.create_group("guesses");
        put_integers(
            &mut guesses,
            "number_of_guesses",
            &[integer(stream)],
            stream,
        );
        for number in 1..=stream.whole(0, 3) {
            let mut guess = guesses.create_group(&number.to_string());
            for (name, len) in [("v", n), ("u", m), ("r", m), ("l", extra)] {
                put_reals(&mut guess, name, len, stream);
            }
            guesses.add_group(guess.finish());
        }
        file.add_group(guesses.finish());
    }
    file.finish().unwrap()
}

#[test]
fn any_numbers_in_whole_datasets_are_a_problem_or_refused() {
    campaign::run("FCLIB datasets", 500, problem, read);
}

/// Goal: what the reader takes becomes a system that methods solve or give up on, or is refused.
#[test]
fn an_accepted_problem_is_run_or_refused() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("fuzz.hdf5");
    let choices = [
        Choice::parse("b-newton").unwrap(),
        Choice::parse("nsgs").unwrap(),
    ];
    let read = move |bytes: &[u8]| {
        std::fs::write(&file, bytes).unwrap();
        match ProblemFile::read(&file) {
            Ok(problem) => {
                assert_eq!(
                    problem
                        .run(&choices, Tier::Low, 1, &Quiet)
                        .results
                        .runs
                        .len(),
                    2
                );
                true
            }
            Err(error) => {
                assert_clear(&error.to_string(), "`", 1);
                false
            }
        }
    };
    campaign::run("FCLIB runs", 100, problem, read);
}
