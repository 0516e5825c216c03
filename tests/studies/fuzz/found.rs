//! What fuzzing has found, in its smallest form.

use std::path::Path;
use std::thread;

use hdf5_pure::{Datatype, FileBuilder};
use stickslip::files::interchange::{
    Info, LocalEquality, LocalProblem, Problem, SparseMatrix, fclib,
};
use stickslip::studies::sweep::cell::{Cell, digest};
use stickslip::studies::sweep::plan::Outline;

use super::assert_clear;
use crate::common::ends_with;

/// Drawn without a word for hours: a digit too many.
#[test]
fn a_sweep_of_a_million_random_problems_is_refused_at_its_place() {
    let text = "title = \"t\"\n[[cells]]\nrandom = { dimension = 2, problems = 1000000 }\n";
    let Err(error) = Outline::parse(Path::new("s.toml"), text) else {
        panic!("accepted");
    };
    assert_clear(&error.to_string(), "s.toml:3:38: ", 3);
}

/// A path too long for the system was shown in full, all of it.
#[test]
fn a_case_that_cannot_be_read_is_refused_where_the_sweep_names_it() {
    for name in ["x".repeat(300), "x".repeat(100_000), "missing".to_owned()] {
        let text = format!("title = \"t\"\n[[cells]]\ncases = [\"cyclic\", \"{name}.toml\"]\n");
        let Err(error) = Outline::parse(Path::new("s.toml"), &text) else {
            panic!("accepted");
        };
        assert_clear(&error.to_string(), "s.toml:3:20: cells", 3);
    }
}

/// A case with a long name was measured, and then its record could not be written.
#[test]
fn an_id_is_the_name_of_a_file_however_long_the_name_of_the_case() {
    let cell = |case: String| Cell {
        case,
        digest: digest("text"),
        refine: 1,
        space: None,
        friction: vec![0.1],
        increments: 1,
        cold: false,
        method: "nsgs".into(),
        tolerance: 1e-6,
        program: None,
    };
    let [one, two] = ["a", "b"].map(|end| cell("ü".repeat(249) + end).id());
    assert!(one.len() <= 200 && one != two, "{one}");
}

/// Texts that all are the same bytes of the file took as much memory as there were of them.
#[test]
fn a_title_of_several_texts_is_not_read() {
    let mut file = FileBuilder::new();
    let mut root = file.create_group("fclib_local");
    root.create_dataset("spacedim").with_i32_data(&[2]);
    let mut w = root.create_group("W");
    for (name, value) in [("m", 2), ("n", 2), ("nz", 1), ("nzmax", 1)] {
        w.create_dataset(name).with_i32_data(&[value]);
    }
    w.create_dataset("p").with_i32_data(&[0]);
    w.create_dataset("i").with_i32_data(&[0]);
    w.create_dataset("x").with_f64_data(&[1.0]);
    root.add_group(w.finish());
    let mut vectors = root.create_group("vectors");
    vectors.create_dataset("q").with_f64_data(&[0.0; 2]);
    vectors.create_dataset("mu").with_f64_data(&[0.0]);
    root.add_group(vectors.finish());
    let mut info = root.create_group("info");
    info.create_dataset("title").with_vlen_strings(&["a", "b"]);
    root.add_group(info.finish());
    file.add_group(root.finish());
    match fclib::from_bytes(Path::new("a.hdf5"), file.finish().unwrap()) {
        Ok(Problem::Local(problem)) => assert_eq!(problem.info.title, None),
        other => panic!("{other:?}"),
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
        let error = fclib::from_bytes(Path::new("a.hdf5"), nested(depth)).unwrap_err();
        assert_clear(&error.to_string(), "`a.hdf5`", 1);
    }
}

/// A V without columns took the solution of no equations for one, which the library of matrices does not.
#[test]
fn a_problem_with_no_rigid_motions_in_its_v_is_solved() {
    let dir = tempfile::tempdir().unwrap();
    let empty = |rows| SparseMatrix::from_triplets(rows, 0, []).unwrap();
    let problem = Problem::Local(LocalProblem {
        dim: 2,
        w: SparseMatrix::from_triplets(2, 2, [(0, 0, 1.0), (1, 1, 1.0)]).unwrap(),
        q: vec![-1.0, 0.1],
        mu: vec![0.3],
        equality: Some(LocalEquality {
            v: empty(2),
            r: empty(0),
            s: Vec::new(),
        }),
        info: Info::default(),
        solution: None,
        guesses: Vec::new(),
    });
    let file = dir.path().join("p.hdf5");
    std::fs::write(&file, problem.to_bytes().unwrap()).unwrap();
    ends_with(0, &["solve", "p.hdf5", "-m", "b-newton"], dir.path());
}
