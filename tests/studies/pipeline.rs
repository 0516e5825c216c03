//! The pipeline: an id means bits, wherever and beside whatever a task is measured; a record once written is not lost.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::interchange::shipped_file;
use crate::common::*;
use stickslip::run::choice::Choice;
use stickslip::run::progress::Quiet;
use stickslip::studies::lab::Shard;
use stickslip::studies::measure::{Bench, here};
use stickslip::studies::plan::Plan;
use stickslip::studies::record::Record;
use stickslip::studies::records::Records;
use stickslip::studies::task::Task;

/// The verb `study` in a folder, its arguments parted by blanks.
pub fn study(dir: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.arg("study").args(arguments.split_whitespace());
    command.current_dir(dir);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// A study that must end with 0; how many tasks it measured.
#[track_caller]
pub fn measured(dir: &Path, arguments: &str) -> usize {
    let output = study(dir, arguments)
        .stdout(Stdio::piped())
        .output()
        .unwrap();
    let shown = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments}: {shown}");
    let line = shown.lines().find(|line| line.contains(" measured now"));
    let words: Vec<&str> = line.unwrap().split(' ').collect();
    words[2].parse().unwrap()
}

/// A folder with a sweep file in it, and its plan.
pub fn planned(text: &str) -> (tempfile::TempDir, Plan) {
    let dir = tempfile::tempdir().unwrap();
    fs::copy(
        shipped_file("collection/rotating/table-2d.hdf5"),
        dir.path().join("table.hdf5"),
    )
    .unwrap();
    #[cfg(unix)]
    let text = {
        // By the same path wherever the plan is made.
        let waits = super::outside::called(dir.path(), "waits");
        &text.replace("exec:waits", &format!("exec:{}", waits.display()))
    };
    let plan = plan_in(dir.path(), text);
    (dir, plan)
}

/// Writes the sweep file of a folder.
fn plan_in(dir: &Path, text: &str) -> Plan {
    fs::write(dir.join("sweep.toml"), text).unwrap();
    Plan::read(&dir.join("sweep.toml")).unwrap()
}

/// Records in a folder of some tasks, by id.
pub fn records(out: &Path, tasks: &[Task]) -> BTreeMap<String, Record> {
    Records::of(out).read(tasks).unwrap()
}

/// Findings by id.
type Bits = BTreeMap<String, String>;

fn bits<'a>(records: impl IntoIterator<Item = &'a Record>) -> Bits {
    let text = |own: &Record| (own.id.clone(), serde_json::to_string(&own.found).unwrap());
    records.into_iter().map(text).collect()
}

fn kept(out: &Path, tasks: &[Task]) -> Bits {
    bits(records(out, tasks).values())
}

/// Measures tasks in this process.
fn in_process(tasks: &[Task], jobs: usize) -> Bits {
    let mut choices: Vec<Choice> = Vec::new();
    for task in tasks {
        let choice = Choice::parse(&task.asked.method).unwrap();
        if choices
            .iter()
            .all(|own| own.argument() != choice.argument())
        {
            choices.push(choice);
        }
    }
    let bench = &mut Bench::default();
    let answers = here(bench, tasks, &choices, jobs, None, &Quiet, &mut |_, _| ()).unwrap();
    bits(answers.iter().map(|own| &own.record))
}

fn shuffled(tasks: &[Task], seed: u64) -> Vec<Task> {
    let (mut tasks, mut random) = (tasks.to_vec(), Random(seed));
    for last in (1..tasks.len()).rev() {
        tasks.swap(last, (random.next() * (last + 1) as f64) as usize);
    }
    tasks
}

/// A case with and without friction, a path with both starts, random problems, a file; methods that share a body, need the
/// traction operator, give up, decline and have laws of their own; several accuracies; all that is looked at.
const MIXED: &str = "title = \"Mixed\"
repeats = { least = 2, most = 2, seconds = 0.0 }
[[cells]]
cases = [\"plate_mesh1\"]
friction = [0.0, 0.1, 0.8]
methods = [\"hybrid\", \"nitsche\", \"nsgs\", \"nsgs:max_iterations=2\", \"penalty:normal=1e2,tangential=1e2\"]
tolerances = [1e-3, 1e-9]
[[cells]]
cases = [\"cyclic\"]
methods = [\"b-newton\", \"barrier\"]
start = [\"warm\", \"cold\"]
tolerances = [1e-6]
[[cells]]
random = { dimension = 3, problems = 2 }
friction = [0.6, 5.0]
methods = [\"nitsche\", \"nsgs:max_iterations=5\", \"pdas\"]
tolerances = [1e-9]
looks = [\"why\", \"stops\"]
[[cells]]
files = [\"table.hdf5\"]
methods = [\"newton-ac\", \"socp\"]
tolerances = [1e-9]
";

/// Goal: what is found is a function of what is asked. Source: the tasks in the order of the plan, one after the other.
#[test]
fn an_id_means_bits() {
    let (dir, plan) = planned(MIXED);
    let tasks = &plan.tasks;
    let expected = in_process(tasks, 1);
    assert_eq!(expected.len(), tasks.len());
    let ends = ["\"solved\"", "\"gave-up", "\"refused", "\"approximate"];
    let of = |end: &&str| expected.values().any(|text| text.contains(*end));
    assert!(ends.iter().all(of) && expected.values().any(|text| text.contains("\"cause\"")));
    #[track_caller]
    fn equal(how: &str, found: &Bits, expected: &Bits) {
        assert!(found.keys().eq(expected.keys()), "{how}");
        for (id, text) in found {
            assert_eq!(text, &expected[id], "{how}: {id}");
        }
    }
    equal("shuffled", &in_process(&shuffled(tasks, 5), 4), &expected);
    let other = shuffled(tasks, 11);
    let parts = (1..=3).map(|number| Shard { number, of: 3 }.tasks(other.clone()));
    let parts: Vec<Bits> = parts.map(|own| in_process(&own, 1)).collect();
    let sizes: Vec<usize> = parts.iter().map(Bits::len).collect();
    assert!(
        sizes.iter().max() <= sizes.iter().min().map(|n| n + 1).as_ref(),
        "{sizes:?}"
    );
    let all = parts.into_iter().flatten().collect();
    equal("dealt out", &all, &expected);
    // In workers: with times, and in parts that know nothing of each other.
    assert_eq!(measured(dir.path(), "sweep.toml --out whole"), tasks.len());
    equal("timed", &kept(&dir.path().join("whole"), tasks), &expected);
    for (part, jobs) in [(1, 1), (2, 4), (3, 4)] {
        let shard = format!("sweep.toml --shard {part}/3 --jobs {jobs} --out part-{part}");
        measured(dir.path(), &shard);
    }
    let join = "sweep.toml --untimed --out all --join part-1 part-2 part-3";
    assert_eq!(measured(dir.path(), join), 0);
    equal("joined", &kept(&dir.path().join("all"), tasks), &expected);
    // Tables without times are equal byte by byte.
    for table in ["increments", "success"] {
        let of = |out: &str| fs::read(dir.path().join(format!("{out}/{table}.csv"))).unwrap();
        assert!(of("whole") == of("all"), "{table}");
    }
    let runs = |out: &str| without_times(&fs::read(dir.path().join(out).join("runs.csv")).unwrap());
    assert_eq!(runs("whole"), runs("all"));
}

/// A few tasks of milliseconds.
const QUICK: &str = "title = \"Quick\"
repeats = { least = 1, most = 1, seconds = 0.0 }
[[cells]]
cases = [\"plate_mesh1\"]
friction = [0.1]
methods = [\"b-newton\", \"latin\", \"penalty\"]
tolerances = [1e-6]
";

/// A list of tolerances.
pub fn forty_tolerances() -> String {
    let tolerance = |k: i32| format!("{:e}", 10f64.powf(-2.0 - 0.2 * f64::from(k)));
    let all: Vec<String> = (0..40).map(tolerance).collect();
    format!("[{}]", all.join(", "))
}

/// The only file of records in a folder of results.
fn only_file(out: &Path) -> PathBuf {
    let mut files = fs::read_dir(out.join("records")).unwrap();
    let file = files.next().unwrap().unwrap().path();
    assert!(files.next().is_none());
    file
}

#[test]
fn a_record_reads_back_bit_by_bit_and_a_cut_costs_the_last_line_alone() {
    let (dir, plan) = planned(QUICK);
    let (run, out) = ("sweep.toml --untimed --out out", dir.path().join("out"));
    assert_eq!(measured(dir.path(), run), 3);
    let file = only_file(&out);
    let whole = fs::read(&file).unwrap();
    let text = String::from_utf8(whole.clone()).unwrap();
    for line in text.lines() {
        let record: Record = serde_json::from_str(line).unwrap();
        assert_eq!(serde_json::to_string(&record).unwrap(), line);
    }
    let expected = records(&out, &plan.tasks);
    for cut in 0..whole.len() {
        fs::write(&file, &whole[..cut]).unwrap();
        let lines = whole[..cut].iter().filter(|byte| **byte == b'\n').count();
        let left = records(&out, &plan.tasks);
        assert_eq!(left.len(), lines, "{cut}");
        let whole = |(id, own): (&String, &Record)| bits([own]) == bits([&expected[id]]);
        assert!(left.iter().all(whole), "{cut}");
    }
    let second = text.match_indices('\n').nth(1).unwrap().0;
    let end = whole.len() - 1;
    for (cut, missing) in [
        (end, 1),
        (second + 2, 1),
        (second + 1, 1),
        (second, 2),
        (0, 3),
    ] {
        fs::write(&file, &whole[..cut]).unwrap();
        assert_eq!(measured(dir.path(), run), missing, "{cut}");
        assert_eq!(kept(&out, &plan.tasks), bits(expected.values()), "{cut}");
    }
    // Numbers of all sizes, and those that do not exist.
    let mut record = expected.into_values().next().unwrap();
    for value in [0.1, -0.0, 5e-324, f64::MAX, f64::EPSILON, f64::NAN] {
        record.found.increments[0].judge.sway = value;
        let text = serde_json::to_string(&record).unwrap();
        let back: Record = serde_json::from_str(&text).unwrap();
        let found = back.found.increments[0].judge.sway;
        assert!(found.to_bits() == value.to_bits() || found.is_nan() && value.is_nan());
    }
}

/// Goal: `kill -9` loses nothing but the task in hand. The last one waits, so that it is killed before the end.
#[cfg(unix)]
#[test]
fn a_study_killed_at_any_moment_ends_like_one_that_was_not_killed() {
    let waits =
        "[[cells]]\ncases = [\"tension_open\"]\nmethods = [\"exec:waits\"]\ntolerances = [1e-6]\n";
    let (dir, plan) = planned(&(QUICK.replace("[1e-6]", &forty_tolerances()) + waits));
    let [whole, out, go] = ["whole", "out", "waits.go"].map(|name| dir.path().join(name));
    let all = plan.tasks.len();
    fs::write(&go, "").unwrap();
    assert_eq!(measured(dir.path(), "sweep.toml --out whole"), all);
    fs::remove_file(&go).unwrap();
    let mut random = Random(20_261_125);
    let length = |out: &Path| -> usize {
        let files = files(&out.join("records"));
        files.values().map(Vec::len).sum()
    };
    // Before the program waits, whatever times stand in their lines.
    let most = length(&whole) * 3 / 4;
    for _ in 0..5 {
        let mut run = study(dir.path(), "sweep.toml --out out").spawn().unwrap();
        let enough = most.min(length(&out) + random.between(0.0, 6e4) as usize);
        while length(&out) <= enough {
            assert!(run.try_wait().unwrap().is_none(), "ended first");
            std::thread::sleep(std::time::Duration::from_micros(200));
        }
        run.kill().unwrap();
        run.wait().unwrap();
        let count = records(&out, &plan.tasks).len();
        assert!((1..all).contains(&count), "{count}");
    }
    fs::write(&go, "").unwrap();
    let left = all - records(&out, &plan.tasks).len();
    // Those that have no times yet are measured again.
    assert!(measured(dir.path(), "sweep.toml --out out") >= left);
    assert_eq!(kept(&out, &plan.tasks), kept(&whole, &plan.tasks));
    let timed = |own: &Record| own.spent.is_some() || !own.is_honest();
    assert!(records(&out, &plan.tasks).values().all(timed));
    assert_eq!(measured(dir.path(), "sweep.toml --out out"), 0);
}

/// Goal: what is known is kept as long as it answers what is asked.
#[test]
fn what_does_not_answer_a_task_is_measured_again_and_nothing_else() {
    let (dir, plan) = planned(QUICK);
    let out = dir.path().join("out");
    let run = |more: &str| measured(dir.path(), &format!("sweep.toml --out out {more}"));
    assert_eq!([run("--untimed"), run("--untimed")], [3, 0]);
    // Times are wanted now, and then are there.
    assert_eq!([run(""), run(""), run("--jobs 2")], [3, 0, 0]);
    let before = records(&out, &plan.tasks);
    // A grown plan keeps its records, and a smaller one does not lose them.
    let more = &QUICK.replace("\"latin\"", "\"latin\", \"nsgs\"");
    let grown = plan_in(dir.path(), more);
    assert_eq!([run(""), run("")], [1, 0]);
    let now = records(&out, &grown.tasks);
    assert!(before.iter().all(|(id, own)| now[id] == *own));
    plan_in(dir.path(), QUICK);
    assert_eq!(run(""), 0);
    // Another look, and none again.
    plan_in(dir.path(), &(QUICK.to_owned() + "looks = [\"stops\"]\n"));
    assert_eq!([run(""), run("")], [3, 0]);
    plan_in(dir.path(), QUICK);
    assert_eq!(run(""), 0);
    // Another program, another machine, limits that ended it, and what somebody wrote in.
    let file = only_file(&out);
    let text = fs::read_to_string(&file).unwrap();
    #[rustfmt::skip]
    let changes = [
        ("\"sources\":\"", "\"sources\":\"x", 1),
        ("\"rustc\":\"", "\"rustc\":\"old ", 1),
        ("\"machine\":\"", "\"machine\":\"another ", 0),
        ("\"found\":{", "\"limits\":{\"seconds\":1.0,\"memory_mb\":null},\"found\":{", 1),
        ("\"friction\":[0.1]", "\"friction\":[0.2]", 1),
        ("{\"id\":", "nonsense {\"id\":", 1),
    ];
    let last = text.trim_end().rfind('\n').unwrap() + 1;
    let record: Record = serde_json::from_str(&text[last..]).unwrap();
    // Of one task the last line holds: its older ones go.
    let lines = text.split_inclusive('\n');
    let others: String = lines.filter(|own| !own.contains(&record.id)).collect();
    for (from, to, untimed) in changes {
        let line = text[last..].replacen(from, to, 1);
        assert_ne!(line, text[last..]);
        fs::write(&file, others.clone() + &line).unwrap();
        let counts = [run("--untimed"), run(""), run("")];
        assert_eq!(counts, [untimed, 1, 0], "{to}");
    }
    // Nothing of another program is taken over.
    fs::write(&file, text.replace("\"sources\":\"", "\"sources\":\"x")).unwrap();
    let join = "sweep.toml --untimed --out joined --join out";
    assert_eq!(measured(dir.path(), join), 3);
}

#[test]
fn a_study_of_cases_and_its_list_are_views_of_the_same_plan() {
    let dir = tempfile::tempdir().unwrap();
    let cases = "cyclic plate_mesh1 -m nsgs -m penalty:normal=1e3";
    let listed = |more: &str| {
        let mut list = study(dir.path(), &format!("{cases} --list {more}"));
        let output = list.stdout(Stdio::piped()).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        text.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let ids = listed("");
    // Friction values of each, two methods, nine decades, two finer meshes.
    assert_eq!(ids.len(), (1 + 3) * 2 * (9 + 2));
    let mut dealt = [listed("--shard 1/2"), listed("--shard 2/2")].concat();
    dealt.sort();
    assert_eq!(dealt, ids);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
    assert_eq!(measured(dir.path(), &format!("{cases} --untimed")), 88);
    let table = fs::read_to_string(dir.path().join("results/study/runs.csv")).unwrap();
    let rows = csv_rows(&table).into_iter();
    let mut found: Vec<String> = rows.map(|row| row["id"].clone()).collect();
    found.sort();
    assert_eq!(found, ids);
    // One case has the folder of its name; a sweep names its methods itself.
    assert_eq!(measured(dir.path(), "cyclic -m nsgs --untimed"), 11);
    assert!(dir.path().join("results/cyclic/index.html").exists());
    for (bad, part) in [
        ("study -m nsgs", "method"),
        ("nobody", "unknown case `nobody`"),
        ("cyclic -m nobody", "unknown method `nobody`"),
        ("cyclic cyclic", "given twice"),
        ("cyclic --shard 3/2", "1 <= i <= n"),
    ] {
        let output = study(dir.path(), bad)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{bad}: {told}");
        assert!(told.contains(part), "{bad}: {told}");
    }
}
