//! Two runs of the program into one folder at the same time: the second is refused, so that all files are of one run.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::common::{ends_with, files};

fn start(arguments: &[&str], dir: &Path) -> Child {
    let mut program = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    program.args(arguments).current_dir(dir);
    program.stdout(Stdio::null()).stderr(Stdio::piped());
    program.spawn().unwrap()
}

/// Exit code and complaints.
fn end(child: Child) -> (Option<i32>, String) {
    let output = child.wait_with_output().unwrap();
    (
        output.status.code(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

/// A sweep that takes seconds.
fn long(dir: &Path) {
    let tolerances: Vec<String> = (0..60)
        .map(|k| format!("{:e}", 10f64.powf(-2.0 - 0.1 * f64::from(k))))
        .collect();
    let text = format!(
        "title = \"Long\"\nrepeats = {{ least = 30, most = 200, seconds = 0.1 }}\n[[cells]]\ncases = [\"plate_mesh1\"]\n\
         refine = [1]\nfriction = [0.1]\nmethods = [\"b-newton\", \"nsgs\"]\ntolerances = [{}]\n",
        tolerances.join(", ")
    );
    fs::write(dir.join("sweep.toml"), text).unwrap();
}

fn wait_for(found: impl Fn() -> bool) {
    let start = Instant::now();
    while !found() {
        assert!(start.elapsed() < Duration::from_secs(60));
        thread::sleep(Duration::from_millis(2));
    }
}

#[cfg(unix)]
#[test]
fn a_second_run_into_a_folder_in_use_is_refused_and_changes_nothing() {
    let dir = tempfile::tempdir().unwrap();
    long(dir.path());
    let study = ["study", "sweep.toml", "--out", "out"];
    let mut first = start(&study, dir.path());
    wait_for(|| dir.path().join("out/sweep.json").exists());
    for second in [
        &study[..],
        &["study", "sweep.toml", "--out", "out", "--shard", "1/2"],
        &["run", "cyclic", "--out", "out"],
        &["export", "cyclic", "--out", "out"],
        &["merge", "out", "--out", "out"],
    ] {
        let (_, complaints) = ends_with(2, second, dir.path());
        assert!(
            complaints.contains("another run is writing into `out`"),
            "{complaints}"
        );
        assert_eq!(complaints.lines().count(), 1, "{complaints}");
    }
    assert!(
        first.try_wait().unwrap().is_none(),
        "ended too early to tell"
    );
    let found = files(&dir.path().join("out"));
    let stranger = |name: &String| name.ends_with(".csv") || name.ends_with(".hdf5");
    assert!(!found.keys().any(stranger), "{:?}", found.keys());
    // The lock goes with the process, however it ends.
    first.kill().unwrap();
    first.wait().unwrap();
    ends_with(0, &["export", "cyclic", "--out", "out"], dir.path());
}

/// Goal: shards may share a folder, also the same one twice: records are whole whoever wrote them.
#[test]
fn shards_share_a_folder() {
    let dir = tempfile::tempdir().unwrap();
    let sweep = "title = \"t\"\nrepeats = { least = 1, most = 2, seconds = 0.0 }\n[[cells]]\ncases = [\"plate_mesh1\"]\n\
                 refine = [1]\nfriction = [0.1]\nmethods = [\"b-newton\", \"nsgs\", \"latin\"]\n";
    fs::write(dir.path().join("sweep.toml"), sweep).unwrap();
    let shard = |part| {
        start(
            &["study", "sweep.toml", "--out", "out", "--shard", part],
            dir.path(),
        )
    };
    for (code, complaints) in [shard("1/2"), shard("2/2"), shard("1/2")].map(end) {
        assert_eq!(code, Some(0), "{complaints}");
    }
    ends_with(0, &["merge", "out", "--out", "all"], dir.path());
    assert_eq!(
        fs::read_dir(dir.path().join("out/cells")).unwrap().count(),
        9
    );
}
