//! FCLIB files: those of other writers are read, ours come back to the bit, and no bytes bring the reader down.

pub mod any;
mod raw;

use std::path::{Path, PathBuf};
use std::thread;

use hdf5_pure::{Datatype, FileBuilder};
use proptest::prelude::*;
use raw::Raw;
use stickslip::files::interchange::{
    GlobalEquality, GlobalProblem, Info, LocalEquality, LocalProblem, Problem, Solution,
    SparseMatrix, fclib,
};

use crate::common::{METHOD, ends_with};

const W: [(usize, usize, f64); 10] = [
    (0, 0, 4.0),
    (1, 0, 1.0),
    (2, 0, 0.5),
    (0, 1, 1.0),
    (1, 1, 3.0),
    (0, 2, 0.5),
    (2, 2, 5.0),
    (3, 2, -1.0),
    (2, 3, -1.0),
    (3, 3, 2.0),
];

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/fclib")
        .join(name)
}

fn local(problem: Problem) -> LocalProblem {
    match problem {
        Problem::Local(problem) => problem,
        Problem::Global(_) => panic!("a global problem"),
    }
}

fn read_bytes(bytes: Vec<u8>) -> Result<Problem, String> {
    fclib::from_bytes(Path::new("p.hdf5"), bytes).map_err(|e| e.to_string())
}

fn two_points() -> LocalProblem {
    LocalProblem {
        dim: 2,
        w: SparseMatrix::from_triplets(4, 4, W).unwrap(),
        q: vec![-1.0, 0.25, 0.1, -0.3],
        mu: vec![0.5, 0.0],
        equality: None,
        info: Info::default(),
        solution: None,
        guesses: Vec::new(),
    }
}

#[test]
fn a_file_of_the_c_library_is_read() {
    let read = local(fclib::read(&shipped("local_csr.hdf5")).unwrap());
    let text = |text: &str| Some(text.to_owned());
    let (u, r) = (vec![1.0, 2.0, 3.0, 4.0], vec![5.0, 6.0, 7.0, 8.0]);
    let solution = |u: &[f64], r: &[f64]| Solution {
        u: u.into(),
        r: r.into(),
        ..Solution::default()
    };
    let expected = LocalProblem {
        info: Info {
            title: text("two points"),
            description: text("compressed rows"),
            math_info: text("W is positive definite"),
        },
        solution: Some(solution(&u, &r)),
        guesses: vec![solution(&r, &u)],
        ..two_points()
    };
    assert_eq!(read, expected);
}

#[test]
fn compressed_datasets_and_wide_integers_are_read() {
    assert_eq!(
        local(fclib::read(&shipped("local_gzip.hdf5")).unwrap()),
        two_points()
    );
}

#[test]
fn a_global_file_of_the_c_library_is_read() {
    let Problem::Global(read) = fclib::read(&shipped("global.hdf5")).unwrap() else {
        panic!("a local problem");
    };
    let m = [
        (0, 0, 2.0),
        (1, 0, -1.0),
        (0, 1, -1.0),
        (1, 1, 2.0),
        (2, 2, 3.0),
        (3, 3, 4.0),
    ];
    let h = [(3, 0, 1.0), (1, 1, -1.0), (2, 2, 0.5)];
    let expected = GlobalProblem {
        dim: 3,
        m: SparseMatrix::from_triplets(4, 4, m).unwrap(),
        h: SparseMatrix::from_triplets(4, 3, h).unwrap(),
        f: vec![1.0, 2.0, 3.0, 4.0],
        w: vec![0.1, 0.2, 0.3],
        mu: vec![0.7],
        equality: Some(GlobalEquality {
            g: SparseMatrix::from_triplets(4, 1, [(0, 0, 1.0)]).unwrap(),
            b: vec![-2.0],
        }),
        info: Info::default(),
        solution: None,
        guesses: Vec::new(),
    };
    assert_eq!(read, expected);
}

#[test]
fn the_newest_format_is_read_or_refused_with_the_way_out() {
    let plain = fclib::read(&shipped("local_latest.hdf5")).unwrap();
    assert_eq!(local(plain), two_points());
    let chunked = fclib::read(&shipped("local_latest_chunked.hdf5"))
        .unwrap_err()
        .to_string();
    assert!(
        chunked.contains("local_latest_chunked.hdf5`, fclib_local/W/"),
        "{chunked}"
    );
    assert!(chunked.contains("h5repack"), "{chunked}");
}

#[test]
fn all_storages_give_the_same_matrix() {
    let doubles = |name, values: &[i32]| {
        let values: Vec<f64> = values.iter().map(|&v| v.into()).collect();
        Raw::columns().without(name).reals(name, &values)
    };
    let lower = Raw::new(
        -1,
        &[0, 3, 4, 6, 7],
        &[0, 1, 2, 1, 2, 3, 3],
        &[4.0, 1.0, 0.5, 3.0, 5.0, -1.0, 2.0],
    );
    for raw in [
        Raw::triplets(),
        Raw::columns(),
        doubles("W/p", &[0, 3, 5, 8, 10]),
        doubles("spacedim", &[2]),
        lower.integers("W/symmetric_packed", &[1]),
    ] {
        assert_eq!(local(raw.read().unwrap()), two_points());
    }
    // Rows in p, as FCLIB's header has it: V is 4 × 2, so (row 3, column 1) fits only one way.
    let v = |p: &[i32], i: &[i32]| {
        let raw = Raw::triplets().integers("V/p", p).integers("V/i", i);
        let raw = raw.reals("V/x", &[1.0, -2.0]).reals("R/x", &[0.0]);
        let sizes = [("V/m", 4), ("V/n", 2), ("V/nz", 2), ("R/m", 2), ("R/n", 2)];
        let zero = [("R/nz", 1), ("R/p", 0), ("R/i", 0)];
        let all = sizes.iter().chain(&zero);
        let raw = all.fold(raw, |raw, (name, value)| raw.integers(name, &[*value]));
        let read = raw.reals("vectors/s", &[0.0; 2]).read();
        local(read.unwrap()).equality.unwrap().v
    };
    let expected = SparseMatrix::from_triplets(4, 2, [(3, 1, 1.0), (0, 1, -2.0)]);
    assert_eq!(Some(v(&[1, 1], &[3, 0])), expected);
    assert_eq!(Some(v(&[3, 0], &[1, 1])), expected);
}

#[test]
fn every_defect_is_named() {
    let nan = f64::NAN;
    let triplets = Raw::triplets;
    let columns = Raw::columns;
    #[rustfmt::skip]
    let rows = [
        (triplets().integers("spacedim", &[4]), ["fclib_local/spacedim[0] = 4", "2 or 3"]),
        (triplets().integers("spacedim", &[3]), ["vectors/q has 4 entries", "multiple of spacedim = 3"]),
        (triplets().integers("spacedim", &[2, 2]), ["spacedim has 2 entries", "expected 1"]),
        (triplets().without("spacedim"), ["fclib_local/spacedim is missing", ""]),
        (triplets().reals("vectors/mu", &[0.5, -0.1]), ["vectors/mu[1] = -0.1", "0 and above"]),
        (triplets().reals("vectors/mu", &[0.5]), ["vectors/mu has 1 entries", "expected 2"]),
        (triplets().reals("vectors/q", &[0.0, nan, 0.0, 0.0]), ["vectors/q[1] = NaN", "finite"]),
        (triplets().reals("vectors/q", &[0.0, f64::INFINITY, 0.0, 0.0]), ["vectors/q[1] = inf", "finite"]),
        (triplets().without("vectors/q"), ["fclib_local/vectors/q is missing", ""]),
        (triplets().without("W/p").reals("W/p", &[0.5; 10]), ["W/p[0] = 0.5", "whole numbers"]),
        (triplets().integers("W/symmetric_packed", &[1]), ["fclib_local/W is `symmetric_packed`", "both sides"]),
        (triplets().integers("W/m", &[6]), ["W/m[0] = 6", "4, as the vectors say"]),
        (triplets().integers("W/n", &[-4]), ["W/n[0] = -4", "4"]),
        (triplets().integers("W/nz", &[-3]), ["W/nz[0] = -3", "compressed rows"]),
        (triplets().integers("W/nz", &[11]), ["W/p has 10 entries", "expected 11"]),
        (triplets().integers("W/i", &[0, 1, 2, 0, 1, 0, 2, 3, 2, 4]), ["W/i[9] = 4", "0 to 3"]),
        (triplets().integers("W/p", &[-1, 0, 0, 1, 1, 2, 2, 2, 3, 3]), ["W/p[0] = -1", "0 to 3"]),
        (columns().integers("W/p", &[0, 3, 5, 8]), ["W/p has 4 entries", "expected 5"]),
        (columns().integers("W/p", &[1, 3, 5, 8, 10]), ["W/p[0] = 1", "allowed: 0"]),
        (columns().integers("W/p", &[0, 5, 3, 8, 10]), ["W/p[2] = 3", "5 to 10"]),
        (columns().integers("W/p", &[0, 3, 5, 8, 12]), ["W/p[4] = 12", "8 to 10"]),
        (columns().integers("W/i", &[0, 1, 2, 0, 1, 0, 2, 3, 2, -3]), ["W/i[9] = -3", "0 to 3"]),
        (columns().reals("W/x", &[4.0, 1.0, 0.5, 1.0, 3.0, 0.5, 5.0, -1.0, -1.0, nan]), ["W/x[9] = NaN", "finite"]),
        (triplets().reals("vectors/mu_r", &[0.1, 0.1]), ["rolling-friction problem", "fclib_local/vectors/mu_r"]),
        (triplets().integers("spacedim", &[5]), ["rolling-friction problem", "spacedim = 5"]),
    ];
    for (raw, parts) in rows {
        let error = raw.read().unwrap_err();
        assert!(
            parts.iter().all(|part| error.contains(part)),
            "{parts:?}: {error}"
        );
        assert!(error.contains("`p.hdf5`"), "{error}");
    }
    for (bytes, part) in [
        (Vec::new(), "not readable as HDF5"),
        (
            b"%%MatrixMarket matrix array real general\n1 1\n1\n".to_vec(),
            "not readable as HDF5",
        ),
        (FileBuilder::new().finish().unwrap(), "it holds no problem"),
    ] {
        let error = read_bytes(bytes).unwrap_err();
        assert!(error.contains(part), "{error}");
    }
    let missing = fclib::read(Path::new("nowhere.hdf5"))
        .unwrap_err()
        .to_string();
    assert!(missing.contains("cannot read `nowhere.hdf5`"), "{missing}");
}

#[test]
fn parts_that_do_not_fit_are_not_written() {
    let refused = |problem: &LocalProblem| problem.to_bytes().unwrap_err().to_string();
    let mut problem = two_points();
    problem.q.pop();
    assert!(refused(&problem).contains("q: 3 entries, expected 4"));
    let mut problem = two_points();
    problem.dim = 1;
    assert!(refused(&problem).contains("2 points of 1 components"));
    let mut problem = two_points();
    problem.solution = Some(Solution::default());
    assert!(refused(&problem).contains("solution u: 0 entries, expected 4"));
}

/// Debug text tells −0 from 0 and every other pair of numbers apart.
fn bits(problem: &Problem) -> String {
    format!("{problem:?}")
}

proptest! {
    #[test]
    fn local_problems_come_back_to_the_bit(problem in any::any_local()) {
        let problem = Problem::Local(problem);
        let back = read_bytes(problem.to_bytes().unwrap()).unwrap();
        prop_assert_eq!(bits(&back), bits(&problem));
    }

    #[test]
    fn global_problems_come_back_to_the_bit(problem in any::any_global()) {
        let problem = Problem::Global(problem);
        let back = read_bytes(problem.to_bytes().unwrap()).unwrap();
        // A triplet list whose rows and columns fit both ways is read with rows in i, as it is written.
        prop_assert_eq!(bits(&back), bits(&problem));
    }
}

/// A file whose first dataset holds sequences of sequences of …
fn nested(depth: usize) -> Vec<u8> {
    let build = move || {
        let mut datatype = hdf5_pure::make_f64_type();
        for _ in 0..depth {
            datatype = Datatype::VariableLength {
                is_string: false,
                padding: None,
                charset: None,
                base_type: Box::new(datatype),
            };
        }
        let mut file = FileBuilder::new();
        let mut root = file.create_group("fclib_local");
        let dataset = root.create_dataset("spacedim");
        dataset.with_raw_data(datatype, vec![0; 16], 1);
        file.add_group(root.finish());
        file.finish().unwrap()
    };
    // The library that writes it recurses as well.
    let thread = thread::Builder::new().stack_size(1 << 30);
    thread.spawn(build).unwrap().join().unwrap()
}

/// The library that reads HDF5 recurses into them without a bound, and a stack that overflows ends the program.
#[test]
fn types_nested_as_deeply_as_a_header_holds_are_refused() {
    for depth in [1, 100, 8000] {
        let error = read_bytes(nested(depth)).unwrap_err();
        assert!(
            error.starts_with("`p.hdf5`") && error.len() < 1500,
            "{error}"
        );
    }
}

/// A V without columns took the solution of no equations for one, which the library of matrices does not.
#[test]
fn a_problem_with_no_rigid_motions_in_its_v_is_solved() {
    let dir = tempfile::tempdir().unwrap();
    let empty = |rows| SparseMatrix::from_triplets(rows, 0, []).unwrap();
    let problem = LocalProblem {
        equality: Some(LocalEquality {
            v: empty(4),
            r: empty(0),
            s: Vec::new(),
        }),
        ..two_points()
    };
    std::fs::write(dir.path().join("p.hdf5"), problem.to_bytes().unwrap()).unwrap();
    ends_with(0, &["solve", "p.hdf5", "-m", METHOD], dir.path());
}

#[test]
fn guesses_that_are_not_there_cost_nothing() {
    let mut file = FileBuilder::new();
    let mut guesses = file.create_group("guesses");
    guesses
        .create_dataset("number_of_guesses")
        .with_i32_data(&[i32::MAX]);
    file.add_group(guesses.finish());
    let read = Raw::triplets().read_into(file).unwrap();
    assert_eq!(local(read), two_points());
}

/// Texts that all are the same bytes of the file would take as much memory as there are of them.
#[test]
fn a_title_of_several_texts_is_not_read() {
    let mut file = FileBuilder::new();
    let mut root = file.create_group("fclib_local");
    let mut info = root.create_group("info");
    info.create_dataset("title").with_vlen_strings(&["a", "b"]);
    root.add_group(info.finish());
    let read = Raw::triplets().read_within(file, root).unwrap();
    assert_eq!(local(read).info.title, None);
}
