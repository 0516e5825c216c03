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

pub fn study(file: &Path, out: &Path, more: &[&str]) -> Command {
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

pub fn code(mut command: Command) -> i32 {
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
pub fn found(out: &Path) -> BTreeMap<String, Record> {
    let files = fs::read_dir(out.join("cells")).into_iter().flatten();
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
    let partial = killed.join(".stickslip-staging-1");
    fs::write(&partial, "{\"sch").unwrap();
    let (code_again, text) = printed(study(&file, &killed, &[]));
    assert_eq!(code_again, Some(0));
    assert!(text.starts_with("200 cells: "), "{text}");
    assert!(!text.starts_with("200 cells: 0 measured before"), "{text}");
    assert_eq!((found(&killed), partial.exists()), (expected, false));

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
    // Records of the target without its list keep their times, and what is no record there is left alone.
    fs::remove_file(at("one/sweep.json")).unwrap();
    let into_one = || {
        let mut command = Command::new(PROGRAM);
        command
            .arg("merge")
            .arg(at("two"))
            .arg("--out")
            .arg(at("one"));
        command.output().unwrap().status.code()
    };
    assert_eq!((into_one(), spent("one")), (Some(0), 15));
    let mine = fs::read_dir(at("one/cells"))
        .unwrap()
        .next()
        .unwrap()
        .unwrap()
        .path();
    let record = fs::read(&mine).unwrap();
    fs::write(&mine, "mine").unwrap();
    fs::remove_file(at("one/sweep.json")).unwrap();
    assert_eq!(into_one(), Some(2));
    assert_eq!(fs::read(&mine).unwrap(), b"mine");
    fs::write(&mine, record).unwrap();
    fs::write(
        at("one/sweep.json"),
        fs::read(at("two/sweep.json")).unwrap(),
    )
    .unwrap();

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

/// Goal: what somebody else's limit or hand ends is an error of the run; no record says that a method failed of it.
#[cfg(target_os = "linux")]
#[test]
fn limits_of_the_shell_and_kills_from_outside_leave_no_record() {
    let folder = tempfile::tempdir().unwrap();
    let file = sweep(folder.path(), &METHODS[..1], 40);
    let limited = |kilobytes: u64, out: &Path, more: &[&str]| {
        let shell = format!("ulimit -v {kilobytes} && exec \"$0\" \"$@\"");
        let study = study(
            &file,
            out,
            &[&["--untimed", "--memory-limit", "8000"], more].concat(),
        );
        let mut command = Command::new("sh");
        command.args(["-c", &shell]).arg(PROGRAM);
        command.args(study.get_args()).stdout(Stdio::null());
        command
    };
    // A limit below the one asked for bounds the cells instead of it, as long as it lasts.
    let out = folder.path().join("out");
    let warned = limited(4_000_000, &out, &["--shard", "1/20"])
        .output()
        .unwrap();
    assert_eq!(warned.status.code(), Some(0));
    assert!(
        String::from_utf8(warned.stderr)
            .unwrap()
            .contains("the shell bounds memory")
    );
    assert!(
        found(&out)
            .values()
            .all(|r| r.found.verdict == Verdict::Solved)
    );

    let out = folder.path().join("killed");
    let mut run = study(&file, &out, &[])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let tasks = format!("/proc/{}/task", run.id());
    let children = || {
        let tasks = fs::read_dir(&tasks).into_iter().flatten().flatten();
        let own = tasks.map(|task| fs::read_to_string(task.path().join("children")));
        own.flatten().find(|own| !own.is_empty())
    };
    let worker = loop {
        match children() {
            Some(own) => break own.trim().to_owned(),
            None => assert!(run.try_wait().unwrap().is_none(), "ended first"),
        }
    };
    assert!(
        Command::new("kill")
            .args(["-9", &worker])
            .status()
            .unwrap()
            .success()
    );
    let output = run.wait_with_output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("signal: 9"), "{error}");
    assert!(
        found(&out)
            .values()
            .all(|r| r.found.verdict == Verdict::Solved)
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
