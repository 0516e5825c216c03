//! Every kind of verdict through every table that shows one and into the exit code, and what running out of memory is.

use std::fs;
use std::path::Path;

use crate::report_data::results;
use stickslip::case;
use stickslip::report::table::{self, Row, readable};
use stickslip::report::tables::runs::RunRow;
use stickslip::report::{Bundle, Claim, Provenance, page, plan, standard};
use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::run::verdict::{Accuracy, Verdict, VerdictKind};
use stickslip::studies::axes::{Axes, Subject, named};
use stickslip::studies::cases::{Settings, run_case};
use stickslip::studies::convergence::orders::{self, ErrorRow};
use stickslip::studies::convergence::{Measured, Sample, Variant};
use stickslip::studies::measure::Answer;
use stickslip::studies::paper::comparison::comparison;
use stickslip::studies::paper::penalty::PenaltyRow;
use stickslip::studies::paper::printed_tables::{Table1Row, Table2Row};
use stickslip::studies::record::{Found, Record};
use stickslip::studies::results::Results;
use stickslip::studies::rows::IncrementRow;
use stickslip::studies::task::Looks;
use stickslip::studies::tips::Regularity;
use stickslip::studies::why::Explanation;
use stickslip::studies::why::cause::{Cause, Diagnosis};
use stickslip_methods::{
    ContactSystem, Enforcement, Increment, Method, MethodError, Monitor, Options, Outcome, Status,
    Tier,
};

/// One of each kind, with details that need quotes in a table of commas.
fn of_kind(kind: VerdictKind) -> Verdict {
    match kind {
        VerdictKind::Solved => Verdict::Solved,
        VerdictKind::Approximate => Verdict::Approximate(Some(Tier::Mid)),
        VerdictKind::FalseClaim => Verdict::FalseClaim,
        VerdictKind::GaveUp => Verdict::GaveUp(Status::SingularTangent),
        VerdictKind::Refused => Verdict::Refused("no: \"friction\", or none".into()),
        VerdictKind::Suspect => Verdict::Suspect("uniform stress is off by 1e-2".into()),
        VerdictKind::Crashed => Verdict::Crashed("out of memory, it says: 1, 2".into()),
        VerdictKind::TimedOut => Verdict::TimedOut,
        VerdictKind::OutOfMemory => Verdict::OutOfMemory,
    }
}

/// A run of each kind, every one on a case of its own.
fn runs() -> Vec<Answer> {
    let run = |kind: &VerdictKind| {
        let mut own = results().answers.swap_remove(0);
        own.record.asked.case = format!("case-{}", kind.name());
        own.record.found.verdict = of_kind(*kind);
        own.record.found.increments[0].verdict = of_kind(*kind);
        own
    };
    VerdictKind::ALL.iter().map(run).collect()
}

/// A record of a task that ended so, and was asked why.
fn of_a_task(verdict: &Verdict) -> Record {
    let case = case::parse("pressed.toml", pressed(3)).unwrap();
    let choice = Choice::parse("latin").unwrap();
    let accuracy = Accuracy::exactly(1e-9);
    let tasks = Subject::of(&case).tasks(
        &Axes::of(&case),
        &named(&[choice]),
        &[accuracy],
        Looks::default(),
    );
    let mut found = Found::only(verdict.clone(), "latin".into(), true);
    found.why = Some(Explanation {
        diagnosis: Diagnosis {
            cause: Cause::Slow,
            period: None,
            flips: Vec::new(),
            measure: f64::NAN,
            rate: None,
            more: None,
        },
        solutions: 0,
        remedy: None,
    });
    Record::here(&tasks[0], found, None)
}

/// Value of a file in a column, read back as a reader would; the form for reading says the same.
fn read_back<R: Row>(row: R, column: &str) -> Verdict {
    let rows = [row];
    let bytes = table::csv(&rows).unwrap();
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let place = reader.headers().unwrap().iter().position(|c| c == column);
    let record = reader.records().next().unwrap().unwrap();
    let text = record[place.unwrap()].to_owned();
    if column == "verdict" && R::READABLE {
        let read = readable(&rows, "");
        let mut heads = read.columns.iter().map(|own| own.name.as_str());
        // A table of two ways marks what is not solved, in its headings.
        let marked = text == "solved" || heads.any(|head| head.contains(&text));
        let shown = read.rows[0].contains(&text);
        assert!(shown || R::PIVOT.is_some() && marked, "{text}");
    }
    text.parse().unwrap()
}

fn says_not_run<R: Row>(row: R) {
    let text = String::from_utf8(table::csv(&[row]).unwrap()).unwrap();
    assert!(text.contains(",not run"), "{text}");
}

#[test]
fn every_kind_stands_in_every_table() {
    for run in runs() {
        let run = run.record;
        let row = IncrementRow::of(&run).next().unwrap();
        let (verdict, key) = (row.step.verdict.clone(), row.key.clone());
        let table1_row = |verdict| Table1Row::new("I", 0.1, "latin", None, Some(973.3), verdict);
        let table2_row = |verdict| {
            let printed = Table2Row::printed("I", "as-printed", "y", [0.1; 7]);
            Table2Row::computed(&printed, "latin", [f64::NAN; 7], verdict)
        };
        let penalty = |verdict| PenaltyRow {
            friction: 0.1,
            parameter: 1.0,
            reaction_mn_per_m: f64::NAN,
            relative_error: f64::NAN,
            max_penetration_m: f64::NAN,
            natural_map: f64::NAN,
            verdict,
        };
        let record = of_a_task(&verdict);
        let error = || -> ErrorRow {
            let sample = Sample {
                variant: Variant {
                    case: key.case.clone(),
                    space: "star".into(),
                    tip: "branch".into(),
                    method: key.method.clone(),
                    friction: 0.1,
                },
                regularity: Regularity::Tip,
                mesh: key.mesh.clone(),
                refine: 1,
                h: 0.5,
                dim: 2,
                dofs: 2,
                points: 1,
                verdict: verdict.clone(),
                seconds: [f64::NAN; 6],
                measured: Measured::Nothing,
            };
            orders::rows(&[sample]).0.swap_remove(0)
        };
        let compared = || comparison([&run]).swap_remove(0);
        let known = || Some(verdict.clone());
        for found in [
            read_back(row, "verdict"),
            read_back(RunRow(&run), "verdict"),
            read_back(compared(), "verdict"),
            read_back(table1_row(known()), "verdict"),
            read_back(table2_row(known()), "verdict"),
            read_back(penalty(known()), "verdict"),
            read_back(error(), "verdict"),
            read_back(RunRow(&record), "verdict"),
        ] {
            assert_eq!(found, verdict);
        }
        says_not_run(table1_row(None));
        says_not_run(table2_row(None));
        says_not_run(penalty(None));
    }
}

/// The folder of a report on these runs.
fn folder_of(answers: &[Answer]) -> tempfile::TempDir {
    let (dir, mut bundle) = (tempfile::tempdir().unwrap(), Bundle::new());
    let runs = answers.iter().map(|own| &own.record);
    let compared = comparison(runs.clone());
    let runs: Vec<RunRow<'_>> = runs.map(RunRow).collect();
    table::add(&mut bundle, &runs, "").unwrap();
    table::add(&mut bundle, &compared, "").unwrap();
    let claim = Claim::new(dir.path(), plan("run"), false).unwrap();
    claim.commit(&bundle).unwrap();
    dir
}

/// Counts at the top of a page with their labels.
fn facts(page: &str) -> Vec<(String, usize)> {
    let facts = page.split("<strong>").skip(1).filter_map(|rest| {
        let (count, rest) = rest.split_once("</strong> <span>")?;
        let label = rest.split_once("</span>")?.0;
        Some((label.to_owned(), count.parse().ok()?))
    });
    facts.collect()
}

#[test]
fn every_kind_is_counted_once_on_the_page() {
    let all = runs();
    let html = page::of_folder(folder_of(&all).path()).unwrap();
    let counts = facts(&html);
    let told = format!("solved, of {} runs: the contact laws hold", all.len());
    assert!(counts.contains(&(told, 1)), "{counts:?}");
    // Refused ones are neither answers nor failures.
    let of = |label: &str| counts.iter().find(|c| c.0.starts_with(label)).map(|c| c.1);
    let found = ["solved", "approximate", "failed"].map(of);
    assert_eq!(found, [Some(1), Some(1), Some(all.len() - 3)], "{counts:?}");
    for kind in VerdictKind::ALL {
        assert!(html.contains(&format!("<dt>{}</dt>", kind.name())));
        let colour = match kind {
            VerdictKind::Solved => "good",
            VerdictKind::Approximate => "fair",
            VerdictKind::Refused => "none",
            _ => "bad",
        };
        let text = of_kind(*kind).to_string().replace('"', "&quot;");
        let cell = format!("<span class=\"v {colour}\">{text}</span>");
        assert!(html.contains(&cell), "{cell}");
    }
}

#[test]
fn every_failure_is_one_in_the_exit_code() {
    for run in runs() {
        let expected = match run.record.found.verdict.kind() {
            VerdictKind::Solved | VerdictKind::Approximate | VerdictKind::Refused => 0,
            _ => 1,
        };
        let name = run.record.found.verdict.to_string();
        let results = Results {
            answers: vec![run],
            ..Results::default()
        };
        assert_eq!(results.failures(), expected, "{name}");
        assert_eq!(results.as_expected(), expected == 0, "{name}");
        let said = format!("{expected} failed;");
        assert!(standard::summary(&results).contains(&said), "{name}");
    }
    let mut missed = results();
    assert!(missed.as_expected());
    missed.expectations[0].verdict = "missed".into();
    assert!(missed.failures() == 0 && !missed.as_expected());
}

/// A method whose factorisation finds no memory, in its preparation or later.
struct Denied {
    at_once: bool,
}

const DENIED: MethodError = MethodError::OutOfMemory {
    what: "factorisation",
};

impl Enforcement for Denied {
    fn prepare(&mut self, _: &ContactSystem) -> Result<(), MethodError> {
        if self.at_once { Err(DENIED) } else { Ok(()) }
    }

    fn solve(&mut self, _: &Increment<'_>, _: &mut dyn Monitor) -> Result<Outcome, MethodError> {
        Err(DENIED)
    }
}

const fn denied(name: &'static str, build: fn(&Options) -> Box<dyn Enforcement>) -> Method {
    Method {
        name,
        label: name,
        reference: "",
        summary: "",
        exact: true,
        options: &[],
        source: "",
        build,
    }
}

static AT_ONCE: Method = denied("at-once", |_| Box::new(Denied { at_once: true }));
static LATER: Method = denied("later", |_| Box::new(Denied { at_once: false }));

/// A box in two parts, pressed together: nothing is expected of it. With 24 cells in every direction its factor takes
/// more than 600 MB and everything before it less than 160 MB.
fn pressed(cells: usize) -> String {
    format!(
        "title = \"A box in two parts\"\nmodel = \"solid\"\n\
         [material]\nyoung_pa = 1e10\npoisson = 0.3\n\
         [mesh.box]\nmin_m = [0, 0, 0]\nmax_m = [1, 1, 1]\ncells = [{cells}, {cells}, {cells}]\n\
         [[crack]]\nplane = {{ point_m = [0.5, 0.5, 0.517], normal = [0, 0, 1] }}\nfriction = 0.3\n\
         [[support]]\non = \"bottom\"\ndisplacement_m = [0, 0, 0]\n\
         [[support]]\non = \"top\"\ndisplacement_m = [0.0001, 0, -0.001]\n"
    )
}

#[test]
fn an_error_of_memory_is_told_by_its_type_and_fails_the_run() {
    let case = case::parse("pressed.toml", pressed(3)).unwrap();
    assert!(case.expects.is_empty());
    let settings = Settings::PLAIN;
    for method in [&AT_ONCE, &LATER] {
        let choice = Choice::new(method, &[]).unwrap();
        let results = run_case(&case, &[choice], settings, &Quiet).unwrap();
        assert_eq!(results.increments().len(), 1);
        assert_eq!(results.increments()[0].step.verdict, Verdict::OutOfMemory);
        assert!(!results.as_expected());
        let dir = tempfile::tempdir().unwrap();
        let bundle = standard::bundle(&results, &Provenance::collect(1)).unwrap();
        let claim = Claim::new(dir.path(), plan("run"), false).unwrap();
        claim.commit(&bundle).unwrap();
        says_so(dir.path());
    }
}

/// A folder of one run that ended without memory.
fn says_so(dir: &Path) {
    let runs = fs::read_to_string(dir.join("runs.csv")).unwrap();
    assert_eq!(runs.matches(",out-of-memory,").count(), 1, "{runs}");
    let html = page::of_folder(dir).unwrap();
    assert!(html.contains("<span class=\"v bad\">out-of-memory</span>"));
    assert!(facts(&html).contains(&("failed".into(), 1)));
}

/// Through the program, in an address space that holds the matrix and not its factor.
#[cfg(target_os = "linux")]
#[test]
fn a_program_whose_factorisation_finds_no_memory_exits_with_1_and_says_so() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("pressed.toml"), pressed(24)).unwrap();
    let program = env!("CARGO_BIN_EXE_stickslip");
    let limited = format!("ulimit -v 320000 && exec '{program}' run pressed.toml --method hybrid");
    let output = std::process::Command::new("sh")
        .args(["-c", &limited])
        .current_dir(dir.path())
        // The C library reserves address space per thread.
        .env("RAYON_NUM_THREADS", "1")
        .env("MALLOC_ARENA_MAX", "1")
        .env("RUST_BACKTRACE", "0")
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}{complaints}");
    assert!(text.contains(" out-of-memory "), "{text}");
    assert!(
        text.contains("0 solved, 0 approximate, 0 refused, 1 failed"),
        "{text}"
    );
    says_so(&dir.path().join("results/pressed"));
}
