//! The contact spaces: which of them are stable, by the numbers; that the numbers are right; what the verb writes.

use std::path::Path;
use std::process::Output;
use std::sync::LazyLock;

use assert_cmd::Command;
use nalgebra::DMatrix;
use stickslip::case::ContactSpace;
use stickslip::model::body::{Body, Needs};
use stickslip::report::table::{csv, readable};
use stickslip::report::tables::spaces::{InfSupRow, InfSupSummary};
use stickslip::report::{Bundle, figures};
use stickslip::run::run_case::Quiet;
use stickslip::studies::spaces::infsup::{
    self, LENGTH, SCENES, Sample, Scene, Sequence, YOUNG, multiplier_norm,
};
use stickslip_xfem::fields::mass::mass;

/// All scenes and spaces without the finest meshes.
static COARSE: LazyLock<Vec<Sequence>> = LazyLock::new(|| {
    let cells = |scene: &Scene| scene.cells[..3].to_vec();
    infsup::run(cells, &Quiet).unwrap()
});

fn scene(name: &str) -> &'static Scene {
    SCENES.iter().find(|s| s.name == name).unwrap()
}

fn sequence(name: &str, space: ContactSpace) -> &'static Sequence {
    let mut all = COARSE.iter();
    all.find(|s| s.scene.name == name && s.space == space)
        .unwrap()
}

/// β on the three meshes.
fn betas(name: &str, space: ContactSpace) -> [f64; 3] {
    let samples = &sequence(name, space).samples;
    [0, 1, 2].map(|k| samples[k].beta)
}

/// Source: Béchet, Moës & Wohlmuth 2009 prove it for spaces of this kind in 2D. Goal: `star` has β > 0.5 for every crack
/// through a body, offset and angle, in 2D and 3D, and β > 0.25 for cracks inside, where 2 to 8 multipliers see both tips;
/// every sequence passes.
#[test]
fn star_is_bounded_below_for_every_angle_and_offset() {
    for s in COARSE.iter().filter(|s| s.space == ContactSpace::Star) {
        let inside = s.scene.name.starts_with("inside");
        let least = if inside { 0.25 } else { 0.5 };
        for p in &s.samples {
            assert!(p.beta > least && p.kernel == 0, "{}: {p:?}", s.scene.name);
        }
        assert!(s.is_stable(), "{}: {} {}", s.scene.name, s.slope, s.share);
    }
}

/// Source: Moës, Béchet & Tourbier 2006. Goal: point pairs at every crossed edge lose β like h off the grid lines, and all of
/// it with the offset.
#[test]
fn edge_pairs_are_stable_along_the_grid_only() {
    let pairs = ContactSpace::EdgePairs;
    for name in [
        "horizontal, offset 0.3h",
        "horizontal, offset 1e-4h",
        "normal (0, 0, 1)",
    ] {
        assert!(sequence(name, pairs).is_stable(), "{name}");
    }
    for name in [
        "45°, offset 0.3h",
        "45°, offset 1e-3h",
        "normal (1, 0, 1), offset 0.3h",
    ] {
        let s = sequence(name, pairs);
        assert!(s.slope > 0.9 && s.slope < 1.3, "{name}: {}", s.slope);
        assert!(!s.is_stable(), "{name}");
    }
    let [far, near] = ["45°, offset 0.3h", "45°, offset 1e-3h"].map(|name| betas(name, pairs));
    for (far, near) in far.iter().zip(near) {
        assert!(near < 0.01 * far, "{far} {near}");
    }
    // 30 pairs on 24 nodes: at least 3 (30 − 24) tractions have no effect at all.
    let s = sequence("normal (1, 1, 1)", pairs);
    assert_eq!(s.samples[0].points, 30);
    assert!(s.samples[0].kernel >= 18, "{:?}", s.samples[0]);
    assert!(s.samples.iter().all(|p| p.beta == 0.0) && !s.is_stable());
}

/// Goal: constants per cell fail along the grid, where they outnumber what the jump can do by far; integrated functions of
/// all pairs fail on the diagonal; both like h.
#[test]
fn p0_and_facet_lose_their_bound_like_h() {
    for (name, space) in [
        ("horizontal, offset 0.3h", ContactSpace::P0),
        ("45°, offset 0.3h", ContactSpace::Facet),
        ("normal (1, 0, 1), offset 1e-3h", ContactSpace::Facet),
    ] {
        let s = sequence(name, space);
        assert!(s.slope > 0.85 && s.slope < 1.2, "{name}: {}", s.slope);
        assert!(!s.is_stable(), "{name}");
    }
}

/// Source: an independent program, two digits. Goal: the same numbers within 5 % for pairs on the same meshes, within 10 % for
/// P0 and facets, known at n = 10, 20 where they go like 1/n.
#[test]
fn numbers_agree_with_an_independent_program() {
    let pairs = ContactSpace::EdgePairs;
    for (name, expected) in [
        ("horizontal, offset 0.3h", [1.34, 1.33, 1.33]),
        ("45°, offset 0.3h", [0.23, 0.09, 0.047]),
        ("normal (0, 0, 1)", [1.33, 1.33, 1.33]),
        ("normal (1, 0, 1), offset 0.3h", [0.42, 0.23, 0.15]),
    ] {
        for (beta, expected) in betas(name, pairs).into_iter().zip(expected) {
            let error = beta / expected - 1.0;
            println!("{name}: {beta:.4}, {expected}");
            assert!(error.abs() < 0.05, "{name}: {beta} {expected}");
        }
    }
    let near = betas("45°, offset 1e-3h", pairs)[0];
    assert!((near / 1.7e-3 - 1.0).abs() < 0.05, "{near}");
    for (name, space, coarse, fine) in [
        ("horizontal, offset 0.3h", ContactSpace::P0, 0.21, 0.11),
        ("45°, offset 0.3h", ContactSpace::Facet, 0.11, 0.054),
    ] {
        let [_, eleven, twenty_one] = betas(name, space);
        println!("{name} {}: {eleven:.4}, {twenty_one:.4}", space.name());
        assert!(
            (1.1 * eleven / coarse - 1.0).abs() < 0.1,
            "{name}: {eleven}"
        );
        assert!(
            (1.05 * twenty_one / fine - 1.0).abs() < 0.1,
            "{name}: {twenty_one}"
        );
    }
}

/// Source: β² is the least eigenvalue of C⁻¹ G A⁻¹ Gᵀ, here with dense matrices, an unsymmetric eigenproblem and A by its
/// columns. Goal: agreement to 1e-8 with the sparse factor and the symmetric pencil, in 2D with branch functions and in 3D.
#[test]
fn dense_matrices_give_the_same_beta() {
    for (name, cells) in [("inside, 27°, tips branch", 5), ("normal (1, 0.3, 2)", 3)] {
        for space in ContactSpace::ALL {
            let scene = scene(name);
            let case = scene.case(space, cells).unwrap();
            let body = Body::new(&case, 1, Needs::default()).unwrap();
            let m = mass(&body.integrator()).unwrap();
            let n = body.numbers.len();
            let column = |j: usize| -> Vec<f64> {
                let mut unit = vec![0.0; n];
                unit[j] = 1.0;
                let (k, m) = (body.stiffness.mul(&unit), m.mul(&unit));
                k.iter()
                    .zip(m)
                    .map(|(k, m)| k / YOUNG + m / (LENGTH * LENGTH))
                    .collect()
            };
            let a = DMatrix::from_columns(
                &(0..n)
                    .map(|j| nalgebra::DVector::from_vec(column(j)))
                    .collect::<Vec<_>>(),
            );
            let rows = body.jump_rows.len();
            let dim = body.mesh.dim();
            let mut g = DMatrix::zeros(rows, n);
            for (i, row) in body.jump_rows.iter().enumerate() {
                for &(j, v) in row {
                    g[(i, j)] = v * body.points[i / dim].weight;
                }
            }
            let h = LENGTH / cells as f64;
            let c = DMatrix::from_row_slice(rows, rows, &multiplier_norm(&body, space, h));
            let s = &g * a.lu().solve(&g.transpose()).unwrap();
            let values = c.lu().solve(&s).unwrap().complex_eigenvalues();
            let least = values.iter().map(|v| v.re).fold(f64::INFINITY, f64::min);
            let found = infsup::sample(scene, space, cells).unwrap().beta;
            let error = found / least.sqrt() - 1.0;
            println!("{name} {}: {found} {error:.1e}", space.name());
            assert!(error.abs() < 1e-8, "{name} {}: {error:e}", space.name());
        }
    }
}

/// Goal: a space passes if both rules hold, and a single mesh, a vanishing β or a missing reference never pass.
#[test]
fn verdicts_follow_slope_and_share() {
    let judged = |slope: f64, share: f64| {
        let sequence = Sequence {
            scene: &SCENES[0],
            space: ContactSpace::Star,
            samples: Vec::new(),
            slope,
            share,
        };
        sequence.is_stable()
    };
    assert!(judged(0.25, 0.1) && judged(-3.0, 7.0));
    assert!(!judged(0.26, 1.0) && !judged(0.0, 0.09));
    assert!(!judged(f64::NAN, 1.0) && !judged(f64::INFINITY, 1.0) && !judged(0.0, f64::NAN));
}

fn stickslip(arguments: &[&str], dir: &Path) -> Output {
    let mut program = Command::cargo_bin("stickslip").unwrap();
    let program = program.env("RAYON_NUM_THREADS", "1");
    program.args(arguments).current_dir(dir).output().unwrap()
}

/// Goal: the verb writes its files with exit code 0, and the same numbers with one thread as the library with all.
#[test]
fn the_verb_writes_what_the_library_finds() {
    let dir = tempfile::tempdir().unwrap();
    let few = [
        "spaces",
        "--meshes",
        "3",
        "--distances",
        "1",
        "--out",
        "out",
    ];
    let run = stickslip(&few, dir.path());
    let text = String::from_utf8_lossy(&run.stdout);
    assert_eq!(run.status.code(), Some(0), "{text}");
    assert!(text.contains("60 sequences"), "{text}");
    let read = |name: &str| std::fs::read_to_string(dir.path().join("out").join(name)).unwrap();
    let table = csv(&InfSupRow::of(&COARSE)).unwrap();
    assert_eq!(read("infsup.csv"), String::from_utf8(table).unwrap());
    let header = "dimension,crack,space,cells,h_m,dofs,points,beta,kernel,slope,share,verdict\n";
    assert!(read("infsup.csv").starts_with(header));
    assert!(read("infsup_by_space.tex").contains("$\\beta$"));
    for name in [
        "infsup_by_space.md",
        "patch.csv",
        "patch_by_space.md",
        "provenance.toml",
        "figures/infsup.svg",
    ] {
        assert!(!read(name).is_empty(), "{name}");
    }
}

/// Goal: bad input and unwritable folders are exit code 2, before any computing.
#[test]
fn bad_input_ends_with_code_two() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("file"), "").unwrap();
    for arguments in [
        &["spaces", "--out", "file"][..],
        &["spaces", "--meshes", "2"],
        &["spaces", "--meshes", "5"],
    ] {
        assert_eq!(stickslip(arguments, dir.path()).status.code(), Some(2));
    }
}

/// Goal: a β that vanishes is shown as such: no slope in the table, the lower edge in the figure.
#[test]
fn vanishing_numbers_can_be_shown() {
    let zero = |cells: usize| Sample {
        cells,
        h: LENGTH / cells as f64,
        unknowns: 1,
        points: 1,
        beta: 0.0,
        kernel: 1,
    };
    let mut sequence = Sequence {
        scene: &SCENES[0],
        space: ContactSpace::P0,
        samples: vec![zero(5), zero(11)],
        slope: f64::INFINITY,
        share: 0.0,
    };
    let mut bundle = Bundle::new();
    figures::infsup::add(&mut bundle, std::slice::from_ref(&sequence)).unwrap();
    let table = readable(&[InfSupSummary(&sequence)], "");
    let cells = ["2", "0", "0", "1", "inf", "0", "not stable"];
    assert_eq!(table.rows[0][3..], cells);
    assert!(bundle.get("figures/infsup.svg").is_some());
    sequence.samples.clear();
    let table = readable(&[InfSupSummary(&sequence)], "");
    assert_eq!(table.rows[0][4..6], ["–", "–"]);
}
