//! The script for job arrays calls the program as its head says, without a Slurm around it.
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn of_the_project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Runs the script as Slurm would, with a program that prints its arguments.
fn task(environment: &[(&str, &str)], arguments: &[&str]) -> Output {
    // Nothing of a Slurm that may surround the tests.
    Command::new("bash")
        .env_clear()
        .env("PATH", std::env::var_os("PATH").unwrap_or_default())
        .env("STICKSLIP", of_the_project("tests/data/print-arguments"))
        .envs(environment.iter().copied())
        .arg(of_the_project("scripts/slurm-array.sh"))
        .args(arguments)
        .output()
        .unwrap()
}

fn printed(output: &Output) -> Vec<&str> {
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    std::str::from_utf8(&output.stdout)
        .unwrap()
        .lines()
        .collect()
}

#[test]
fn bash_accepts_the_array_script() {
    let script = of_the_project("scripts/slurm-array.sh");
    let status = Command::new("bash").arg("-n").arg(script).status();
    assert!(status.unwrap().success());
}

#[test]
fn a_task_measures_its_shard_with_the_options_given() {
    let array = [
        ("SLURM_ARRAY_TASK_ID", "1"),
        ("SLURM_ARRAY_TASK_COUNT", "2"),
    ];
    let sweep = ["my sweep.toml", "out-%a", "--memory-limit", "4000"];
    let output = task(&array, &sweep);
    let shard = ["--out", "out-1", "--shard", "1/2"];
    let expected = [
        &["study", "my sweep.toml"],
        &shard[..],
        &["--memory-limit", "4000"],
    ];
    assert_eq!(printed(&output), expected.concat());
}

/// `sbatch --array=1,5` says that there are two tasks: without the number of shards even task 1 would take a wrong part.
#[test]
fn a_part_of_an_array_needs_the_number_of_shards() {
    for id in ["1", "5"] {
        let array = [
            ("SLURM_ARRAY_TASK_ID", id),
            ("SLURM_ARRAY_TASK_COUNT", "2"),
            ("SLURM_ARRAY_TASK_MIN", "1"),
            ("SLURM_ARRAY_TASK_MAX", "5"),
        ];
        let refused = task(&array, &["sweep.toml", "out"]);
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        assert!(refused.stdout.is_empty(), "{refused:?}");
        let complaint = String::from_utf8_lossy(&refused.stderr);
        assert!(complaint.contains("set SHARDS"), "{complaint}");

        let given = [array.as_slice(), &[("SHARDS", "8")]].concat();
        let output = task(&given, &["sweep.toml", "out"]);
        let shard = format!("{id}/8");
        let expected = ["study", "sweep.toml", "--out", "out", "--shard", &shard];
        assert_eq!(printed(&output), expected);
    }
}

#[test]
fn no_task_of_an_array_is_no_shard() {
    let refused = task(&[], &["sweep.toml", "out"]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert!(refused.stdout.is_empty(), "{refused:?}");
}
