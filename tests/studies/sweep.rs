//! Sweeps through the program: a killed run is taken up, shards are merged, limits are verdicts, bad folders are refused.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use stickslip::run::verdict::Verdict;
use stickslip::studies::sweep::record::{Record, SCHEMA};
use stickslip::studies::sweep::store::sealed;

const PROGRAM: &str = env!("CARGO_BIN_EXE_stickslip");

/// 5 methods × 40 tolerances on a coarse plate: 200 cells of a few milliseconds.
fn sweep(folder: &Path, methods: &[&str], tolerances: usize) -> std::path::PathBuf {
    let list: Vec<String> = (0..tolerances)
        .map(|k| format!("{:e}", 10f64.powf(-2.0 - 0.2 * k as f64)))
        .collect();
    let text = format!(
        "title = \"Two hundred cells\"\nrepeats = {{ least = 1, most = 2, seconds = 0.0 }}\n\n[[cells]]\n\
         cases = [\"plate_mesh1\"]\nrefine = [1]\nfriction = [0.1]\nmethods = {methods:?}\ntolerances = [{}]\n",
        list.join(", ")
    );
    let file = folder.join("sweep.toml");
    fs::write(&file, text).unwrap();
    file
}

const METHODS: [&str; 5] = [
    "b-newton",
    "hybrid",
    "latin",
    "nsgs",
    "penalty:normal=1e2,tangential=1e2",
];

fn study(file: &Path, out: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command
        .arg("study")
        .arg(file)
        .arg("--out")
        .arg(out)
        .args(more);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn code(mut command: Command) -> i32 {
    command.status().unwrap().code().unwrap()
}

/// Exit code and what was printed.
fn printed(mut command: Command) -> (Option<i32>, String) {
    let output = command.stdout(Stdio::piped()).output().unwrap();
    (
        output.status.code(),
        String::from_utf8(output.stdout).unwrap(),
    )
}

/// What a command complains of that ends with 2.
fn refused(mut command: Command) -> String {
    let output = command.stderr(Stdio::piped()).output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    error
}

/// What was found, by file; and that nothing else lies in the folder.
fn found(out: &Path) -> BTreeMap<String, Record> {
    let files = fs::read_dir(out.join("cells")).unwrap();
    files
        .map(|entry| {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let mut record: Record =
                serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
            assert_eq!(name, format!("{}.json", record.id));
            record.spent = None;
            (name, record)
        })
        .collect()
}

/// Goal: `kill -9` loses nothing but the cell that was being measured.
#[test]
fn a_killed_sweep_is_taken_up_and_ends_like_one_that_was_not_killed() {
    let folder = tempfile::tempdir().unwrap();
    let file = sweep(folder.path(), &METHODS, 40);
    let (whole, killed) = (folder.path().join("whole"), folder.path().join("killed"));
    assert_eq!(code(study(&file, &whole, &[])), 0);
    let expected = found(&whole);
    assert_eq!(expected.len(), 200);

    let mut run = study(&file, &killed, &[]).spawn().unwrap();
    let clock = Instant::now();
    let kept = || fs::read_dir(killed.join("cells")).map_or(0, Iterator::count);
    while kept() < 30 {
        assert!(
            clock.elapsed() < Duration::from_secs(120),
            "{} cells",
            kept()
        );
        std::thread::sleep(Duration::from_millis(1));
    }
    run.kill().unwrap();
    run.wait().unwrap();
    let before = kept();
    assert!(
        (30..200).contains(&before),
        "killed after the end: {before}"
    );

    // What a run killed while it wrote leaves behind.
    let id = expected.values().next_back().unwrap().id.clone();
    fs::write(killed.join(format!("cells/{id}.json.1.partial")), "{\"sch").unwrap();
    let (code_again, text) = printed(study(&file, &killed, &[]));
    assert_eq!(code_again, Some(0));
    assert!(text.starts_with("200 cells: "), "{text}");
    assert!(!text.starts_with("200 cells: 0 measured before"), "{text}");
    assert_eq!(found(&killed), expected);

    // A third run measures nothing.
    let (_, text) = printed(study(&file, &killed, &[]));
    assert!(
        text.starts_with("200 cells: 200 measured before, 0 now"),
        "{text}"
    );
}

#[test]
fn two_shards_merged_equal_one_run() {
    let folder = tempfile::tempdir().unwrap();
    let file = sweep(folder.path(), &METHODS[..3], 10);
    let at = |name: &str| folder.path().join(name);
    assert_eq!(code(study(&file, &at("whole"), &[])), 0);
    assert_eq!(code(study(&file, &at("one"), &["--shard", "1/2"])), 0);
    assert_eq!(
        code(study(&file, &at("two"), &["--shard", "2/2", "--jobs", "2"])),
        0
    );
    assert_eq!(found(&at("one")).len(), 15);
    let merge = |folders: &[&str], more: &[&str]| {
        let mut command = Command::new(PROGRAM);
        command.arg("merge").args(folders.iter().map(|f| at(f)));
        command.arg("--out").arg(at("merged")).args(more);
        command.output().unwrap()
    };
    let output = merge(&["one"], &[]);
    assert_eq!(
        output.status.code(),
        Some(1),
        "half of the cells are missing"
    );
    let missing = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        missing
            .lines()
            .filter(|l| l.starts_with("missing: "))
            .count(),
        15
    );

    assert_eq!(merge(&["one", "two"], &[]).status.code(), Some(0));
    assert_eq!(found(&at("merged")), found(&at("whole")));
    // Tables without times are equal byte by byte.
    for table in ["cells.csv", "increments.csv", "deviations.csv"] {
        let read = |out: &str| fs::read(at(out).join(table)).unwrap();
        assert_eq!(read("merged"), read("whole"), "{table}");
    }

    // Times of cells that shared the machine are not kept.
    let spent = |out: &str| {
        let files = fs::read_dir(at(out).join("cells")).unwrap();
        let text = files.map(|f| fs::read_to_string(f.unwrap().path()).unwrap());
        text.filter(|t| !t.contains("\"spent\": null")).count()
    };
    assert_eq!((spent("one"), spent("two")), (15, 0));

    // The same numbers are no change; a verdict that got worse is a failure.
    let compare = || {
        let mut command = Command::new(PROGRAM);
        command.arg("compare").arg(at("whole")).arg(at("merged"));
        command.output().unwrap()
    };
    let output = compare();
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(
        text.contains("30 cells in both, 30 found the same bit by bit"),
        "{text}"
    );
    let name = fs::read_dir(at("merged").join("cells")).unwrap().next();
    let name = name.unwrap().unwrap().path();
    let solved = fs::read_to_string(&name).unwrap();
    let worse = solved.replace("\"verdict\": \"solved\"", "\"verdict\": \"false-claim\"");
    fs::write(&name, sealed(&worse)).unwrap();
    let output = compare();
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.contains("false-claim") && text.contains("worse"),
        "{text}"
    );
    fs::write(&name, solved).unwrap();

    // Another machine, and another result of the same program.
    let change = |from: &str, to: &str| {
        let entry = fs::read_dir(at("two").join("cells"))
            .unwrap()
            .next()
            .unwrap();
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from));
        fs::write(&path, sealed(&text.replacen(from, to, 1))).unwrap();
        (path, text)
    };
    let (path, text) = change("\"machine\": \"", "\"machine\": \"another ");
    let output = merge(&["one", "two"], &[]);
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(
        error.contains("machine") && error.contains("--force"),
        "{error}"
    );
    assert_eq!(merge(&["one", "two"], &["--force"]).status.code(), Some(0));
    fs::write(path, text).unwrap();

    let (path, text) = change("\"iterations\": ", "\"iterations\": 1");
    let output = merge(&["whole", "two"], &[]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(error.contains("other numbers"), "{error}");
    fs::write(path, text).unwrap();

    let (path, text) = change(&format!("\"schema\": {SCHEMA}"), "\"schema\": 7");
    let output = merge(&["one", "two"], &["--force"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(error.contains("schema 7"), "{error}");
    fs::write(path, text).unwrap();
}

#[test]
fn records_of_another_program_are_not_taken_for_ones_own() {
    let folder = tempfile::tempdir().unwrap();
    let file = sweep(folder.path(), &METHODS[..1], 2);
    let out = folder.path().join("out");
    assert_eq!(code(study(&file, &out, &[])), 0);
    let expected = found(&out);
    let path = fs::read_dir(out.join("cells"))
        .unwrap()
        .next()
        .unwrap()
        .unwrap()
        .path();
    let text = fs::read_to_string(&path).unwrap();
    fs::write(
        &path,
        sealed(&text.replacen("\"rustc\": \"", "\"rustc\": \"old ", 1)),
    )
    .unwrap();
    let error = refused(study(&file, &out, &[]));
    assert!(
        error.contains("compiler") && error.contains("--redo"),
        "{error}"
    );
    assert_eq!(code(study(&file, &out, &["--redo"])), 0);
    assert_eq!(found(&out), expected);

    // A record that is cut off is never skipped as done.
    fs::write(&path, &text[..text.len() / 2]).unwrap();
    let error = refused(study(&file, &out, &[]));
    assert!(
        error.contains(path.file_name().unwrap().to_str().unwrap()),
        "{error}"
    );

    // Another sweep does not mix with this one.
    let other = sweep(folder.path(), &METHODS[..1], 3);
    let error = refused(study(&other, &out, &[]));
    assert!(error.contains("another sweep"), "{error}");
}

/// Goal: what a disk or a hand has changed is refused with file and line, whatever it is, and removing the file helps.
#[test]
fn no_changed_digit_of_a_record_is_believed() {
    let folder = tempfile::tempdir().unwrap();
    let file = sweep(folder.path(), &METHODS[..1], 1);
    let out = folder.path().join("out");
    assert_eq!(code(study(&file, &out, &[])), 0);
    let expected = found(&out);
    let cell = out.join("cells").join(expected.keys().next().unwrap());
    for path in [cell.clone(), out.join("sweep.json")] {
        let text = fs::read_to_string(&path).unwrap();
        let digits: Vec<usize> = (text.char_indices())
            .filter(|(_, c)| c.is_ascii_digit())
            .map(|(at, _)| at)
            .collect();
        assert!(digits.len() > 20);
        // Some from everywhere: a start of the program each.
        for &at in digits.iter().step_by(digits.len() / 12) {
            let mut changed = text.clone().into_bytes();
            changed[at] = if changed[at] == b'9' {
                b'8'
            } else {
                changed[at] + 1
            };
            fs::write(&path, changed).unwrap();
            let error = refused(study(&file, &out, &[]));
            let name = path.file_name().unwrap().to_str().unwrap();
            let line = text[..at].lines().count();
            assert!(error.contains(name), "{error}");
            assert!(
                error.contains("line 2") || error.contains("schema"),
                "{line}: {error}"
            );
        }
        fs::write(&path, text).unwrap();
        assert_eq!(code(study(&file, &out, &[])), 0);
    }
    let text = fs::read_to_string(&cell).unwrap();
    let without: String = (text.split_inclusive('\n'))
        .filter(|line| !line.contains("\"digest\": \"") || line.starts_with("    "))
        .collect();
    assert_ne!(without, text);
    fs::write(&cell, without).unwrap();
    assert!(refused(study(&file, &out, &[])).contains("line 2"));
    fs::remove_file(&cell).unwrap();
    assert_eq!(code(study(&file, &out, &[])), 0);
    assert_eq!(found(&out), expected);
}

#[test]
fn limits_of_time_and_memory_are_verdicts() {
    let folder = tempfile::tempdir().unwrap();
    let file = sweep(folder.path(), &["hybrid"], 2);
    let at = |name: &str| folder.path().join(name);
    // No cell is measured within a microsecond; all have a record.
    assert_eq!(
        code(study(&file, &at("time"), &["--time-limit", "1e-6"])),
        0
    );
    let timed_out = found(&at("time"));
    assert_eq!(timed_out.len(), 2);
    let ended = |r: &Record| r.found.verdict == Verdict::TimedOut && r.limits.is_some();
    assert!(timed_out.values().all(ended));

    let text = fs::read_to_string(&file)
        .unwrap()
        .replace("refine = [1]", "refine = [32, 8, 1]");
    fs::write(&file, text).unwrap();
    // The coarse mesh fits into 70 MB of address space; of 176 × 176 cells the factor does not, which an error says; of
    // 704 × 704 nothing does, and the process dies.
    let out = at("memory");
    assert_eq!(code(study(&file, &out, &["--memory-limit", "70"])), 0);
    let verdict = |part: &str| {
        let records = found(&out);
        let own = records.values().filter(|r| r.id.contains(part));
        own.map(|r| (r.found.verdict.clone(), r.limits.is_some()))
            .collect::<Vec<_>>()
    };
    let (denied, solved) = ((Verdict::OutOfMemory, true), (Verdict::Solved, false));
    for mesh in [".r32.", ".r8."] {
        assert_eq!(verdict(mesh), [denied.clone(), denied.clone()]);
    }
    assert_eq!(verdict(".r1."), [solved.clone(), solved]);
}

#[test]
fn bad_sweep_files_are_refused_at_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sweep.toml");
    let good = "title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\n";
    for (text, place, part) in [
        ("title = \"t\"\n".to_owned(), "1:1", "[[cells]]"),
        (good.replace("cyclic", "cyclik"), "3:10", "unknown case"),
        (good.replace("cyclic", "no.toml"), "", "no.toml"),
        (
            format!("{good}methods = [\"newton\"]\n"),
            "4:12",
            "unknown method `newton`",
        ),
        (
            format!("{good}methods = [\"penalty:normal=-1\"]\n"),
            "4:12",
            "normal",
        ),
        (format!("{good}methods = []\n"), "4:11", "empty list"),
        (
            format!("{good}tolerances = [2.0]\n"),
            "4:15",
            "out of range",
        ),
        (
            format!("{good}tolerances = [1e-3, \"x\"]\n"),
            "4:21",
            "wrong type",
        ),
        (format!("{good}refine = [0]\n"), "4:11", "out of range"),
        (
            format!("{good}contact = [\"stars\"]\n"),
            "4:12",
            "did you mean `star`?",
        ),
        (format!("{good}friction = [-0.1]\n"), "4:13", "out of range"),
        (
            format!("{good}random = {{ dimension = 2, problems = 3 }}\n"),
            "4:10",
            "exclude each other",
        ),
        (
            format!("{good}bodies = {{ dimension = 2, points = [100], of_each = 3 }}\n"),
            "4:10",
            "exclude each other",
        ),
        (
            good.replace(
                "cases = [\"cyclic\"]",
                "bodies = { dimension = 2, points = [3], of_each = 1 }",
            ),
            "3:",
            "out of range",
        ),
        (format!("{good}increments = [0]\n"), "4:15", "out of range"),
        (format!("{good}increments = []\n"), "4:14", "empty list"),
        (
            format!("{good}start = [\"warm\", \"cool\"]\n"),
            "4:18",
            "did you mean `cold`?",
        ),
        (
            good.replace(
                "cases = [\"cyclic\"]",
                "files = [\"x.hdf5\"]\nstart = [\"cold\"]",
            ),
            "4:9",
            "one increment from rest",
        ),
        (format!("{good}meshes = [1]\n"), "4:1", "unknown key"),
        (format!("{good}options = {{}}\n"), "4:11", "empty table"),
        (format!("{good}options.r = 1\n"), "4:13", "wrong type"),
        (format!("{good}options.r = []\n"), "4:13", "empty list"),
        (
            format!("{good}options.x = [1]\n"),
            "4:13",
            "no method has an option `x`",
        ),
        (
            format!("{good}options = {{ r = [1], gamma = [2] }}\n"),
            "4:11",
            "no method has all of them",
        ),
        (
            format!("{good}methods = [\"pdas\", \"nsgs\"]\noptions.r = [1]\n"),
            "4:20",
            "no option `r`",
        ),
        (
            format!("{good}methods = [\"pdas:r=2\"]\noptions.r = [1, 3]\n"),
            "4:12",
            "given twice",
        ),
        (
            format!("{good}options.r = [1, 1e4]\n"),
            "4:17",
            "a number from 0.001 to 1000",
        ),
        (
            format!("{good}methods = [\"hybrid\"]\noptions.first = [5, 2.5]\n"),
            "5:21",
            "a whole number from 1 to 10000",
        ),
        (
            format!("{good}options.monolithic = [0, 2]\n"),
            "4:26",
            "a whole number from 0 to 1",
        ),
        (
            format!("{good}options.first = {{ from = 1, to = 10, per_decade = 2 }}\n"),
            "4:17",
            "3.162e0 is not allowed",
        ),
        (
            format!("{good}options.r = {{ from = 1, to = 0.1 }}\n"),
            "4:30",
            "out of range",
        ),
        (
            format!("{good}options.r = {{ from = 0, to = 1 }}\n"),
            "4:22",
            "out of range",
        ),
        (
            format!("{good}options.r = {{ from = 1 }}\n"),
            "4:13",
            "missing `to`",
        ),
        (
            good.replace("[[cells]]", "repeats = { least = 0 }\n[[cells]]"),
            "2:21",
            "out of range",
        ),
        (good.replace("title", "title = "), "1:", "not valid TOML"),
    ] {
        fs::write(&file, &text).unwrap();
        let out = folder.path().join("out");
        let output = study(&file, &out, &[])
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}\n{error}");
        assert!(
            error.contains(&format!("sweep.toml:{place}")) || place.is_empty(),
            "{text}\n{error}"
        );
        assert!(error.contains(part), "{text}\n{error}");
        assert!(!out.exists(), "{text}");
    }
}

/// Methods and options of the cells of a sweep of one case at one tolerance.
fn listed(folder: &Path, block: &str) -> Vec<String> {
    let file = folder.join("options.toml");
    let text =
        format!("title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\ntolerances = [1e-6]\n{block}\n");
    fs::write(&file, text).unwrap();
    let output = study(&file, &folder.join("none"), &["--list"])
        .stdout(Stdio::piped())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{block}");
    let ids = String::from_utf8(output.stdout).unwrap();
    let mut found: Vec<String> = (ids.lines())
        .map(|id| {
            let (_, method) = id.split_once(".mu-0.3.").unwrap();
            method.split_once(".tol-").unwrap().0.to_owned()
        })
        .collect();
    found.sort();
    found
}

/// Goal: an option is an axis; ids name the value as on the command line, and the default is the plain method.
#[test]
fn options_of_methods_are_axes_of_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    let listed = |block: &str| listed(folder.path(), block);
    let grid = "methods = [\"pdas\"]\noptions.r = { from = 0.1, to = 10, per_decade = 2 }";
    let expected = [
        "pdas",
        "pdas-r=1e-1",
        "pdas-r=1e1",
        "pdas-r=3.162e-1",
        "pdas-r=3.162e0",
    ];
    assert_eq!(listed(grid), expected);
    // The default stands between the values of a grid, and is not added to a list.
    let off = "methods = [\"pdas\"]\noptions.r = { from = 0.5, to = 5 }";
    assert_eq!(listed(off), ["pdas", "pdas-r=5e-1", "pdas-r=5e0"]);
    let list = "methods = [\"pdas\"]\noptions.r = [0.5, 2]";
    assert_eq!(listed(list), ["pdas-r=2e0", "pdas-r=5e-1"]);
    // Without names every method that has all options, with every combination.
    let both = "options = { r = [1, 2], monolithic = [0, 1] }";
    let expected: Vec<String> = ["b-newton", "gnm", "ncp-newton", "newton-ac", "pdas"]
        .iter()
        .flat_map(|name| {
            let ends = ["", "-monolithic=1e0", "-r=2e0", "-r=2e0-monolithic=1e0"];
            ends.map(|end| format!("{name}{end}"))
        })
        .collect();
    assert_eq!(listed(both), expected);
    // Beside options that a method is given by name.
    let beside = "methods = [\"hybrid:first=3\"]\noptions.r = [2]";
    assert_eq!(listed(beside), ["hybrid-r=2e0-first=3e0"]);
}

/// Goal: both axes stand in ids; without them a cell has the id that it always had.
#[test]
fn increments_and_starts_are_axes_of_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    let listed = |block: &str| listed(folder.path(), &format!("methods = [\"pdas\"]\n{block}"));
    assert_eq!(listed("increments = [1]\nstart = [\"warm\"]"), ["pdas"]);
    let both = "increments = [10, 1]\nstart = [\"warm\", \"cold\"]";
    let expected = [
        "cold.pdas",
        "increments-10.cold.pdas",
        "increments-10.pdas",
        "pdas",
    ];
    assert_eq!(listed(both), expected);
}

/// Goal: what they change, through the program: a path in more increments, other counts of iterations, the same answers.
#[test]
fn records_and_tables_tell_increments_and_starts_apart() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (folder.path().join("sweep.toml"), folder.path().join("out"));
    let text = "title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\nmethods = [\"nsgs\", \"penalty\"]\n\
                increments = [1, 2]\nstart = [\"warm\", \"cold\"]\ntolerances = [1e-6]\n";
    fs::write(&file, text).unwrap();
    assert_eq!(code(study(&file, &out, &["--untimed"])), 0);
    let records = found(&out);
    assert_eq!(records.len(), 8);
    for record in records.values() {
        let (cell, found) = (&record.cell, &record.found);
        assert_eq!(
            found.increments.len(),
            16 * cell.increments,
            "{}",
            record.id
        );
        assert!(found.verdict.is_honest(), "{}", record.id);
        // Of the converged solution in the same increments: soft springs are off by their modelling error, from either start.
        let error = found.solver_error.as_ref().unwrap().energy;
        assert!(error < 1e-2, "{}: {error:e}", record.id);
        let warm = |o: &&Record| {
            !o.cell.cold && (&o.cell.method, o.cell.increments) == (&cell.method, cell.increments)
        };
        let twin = records.values().find(warm).unwrap();
        let other = twin.found.solver_error.as_ref().unwrap().energy;
        assert!(
            (error - other).abs() < 1e-5,
            "{}: {error:e} {other:e}",
            record.id
        );
        if cell.cold && cell.method == "nsgs" {
            let [cold, warm] = [found, &twin.found].map(|f| f.sum(|i| i.iterations));
            assert!(cold > warm, "{}: {cold} {warm}", record.id);
        }
    }
    let table = fs::read_to_string(out.join("starts.csv")).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(rows.len(), 4, "{table}");
    assert!(
        rows[1].starts_with("cyclic,nsgs,1e-6,2,32,1,1,1,"),
        "{table}"
    );
}

/// Goal: whoever cannot write gets an error that names the path, and nothing half-written.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_written_is_an_error_and_holds_no_half_record() {
    let folder = tempfile::tempdir().unwrap();
    let file = sweep(folder.path(), &METHODS[..1], 2);
    // What cannot become a folder.
    let out = folder.path().join("full");
    assert_eq!(code(study(&file, &out, &["--shard", "1/2"])), 0);
    let error = refused(study(&file, Path::new("/dev/null/x"), &[]));
    assert!(error.contains("/dev/null"), "{error}");

    // The folder of the records becomes a file.
    fs::rename(out.join("cells"), out.join("elsewhere")).unwrap();
    fs::write(out.join("cells"), "in the way").unwrap();
    let error = refused(study(&file, &out, &[]));
    assert!(error.contains("cells"), "{error}");
    assert_eq!(fs::read_to_string(out.join("cells")).unwrap(), "in the way");
}

/// Goal: an interruption ends the run with whole records; the next run takes it up.
#[cfg(unix)]
#[test]
fn an_interrupted_sweep_finishes_its_cell_and_says_what_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let file = sweep(folder.path(), &METHODS, 40);
    let out = folder.path().join("out");
    let run = study(&file, &out, &[])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let clock = Instant::now();
    while fs::read_dir(out.join("cells")).map_or(0, Iterator::count) < 10 {
        assert!(clock.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(1));
    }
    let kill = Command::new("kill")
        .arg("-INT")
        .arg(run.id().to_string())
        .status();
    assert!(kill.unwrap().success());
    let output = run.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let (text, errors) = (
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    );
    let kept = found(&out).len();
    assert!((10..200).contains(&kept), "{kept}");
    assert!(
        text.contains(&format!("{kept} now, {} left", 200 - kept)),
        "{text}"
    );
    assert!(errors.contains("Interrupted"), "{errors}");
    // One line per cell where nobody looks at a bar.
    let lines = errors.lines().filter(|l| l.starts_with('[')).count();
    assert_eq!(lines, kept);
    assert_eq!(code(study(&file, &out, &[])), 0);
    assert_eq!(found(&out).len(), 200);
}
