//! The results of the benchmarks are read as they are, and only those of this build.

use std::fs;
use std::path::Path;
use std::time::{Duration, SystemTime};

use stickslip::report::Bundle;
use stickslip::report::timings::{
    BenchmarkName, Expected, Harvest, Ignored, add_to, harvest, last_built,
};
use stickslip::run::verdict::Verdict;

const HEADER: &str = "group,function,value,throughput_num,throughput_type,sample_measured_value,unit,iteration_count";

/// When the benchmarks were built.
fn built() -> SystemTime {
    SystemTime::UNIX_EPOCH + Duration::from_secs(1_700_000_000)
}

/// So many seconds after the build.
fn after_build(seconds: i64) -> SystemTime {
    match u64::try_from(seconds) {
        Ok(later) => built() + Duration::from_secs(later),
        Err(_) => built() - Duration::from_secs(seconds.unsigned_abs()),
    }
}

/// A file with a time.
fn write(path: &Path, text: &str, modified: SystemTime) {
    fs::write(path, text).unwrap();
    let file = fs::File::options().append(true).open(path).unwrap();
    file.set_modified(modified).unwrap();
}

/// A folder like criterion's with one result, so many seconds after the build.
fn plant(home: &Path, folder: &str, text: &str, seconds: i64) {
    let folder = home.join(folder);
    fs::create_dir_all(&folder).unwrap();
    write(&folder.join("raw.csv"), text, after_build(seconds));
}

/// `raw.csv` of the benchmark g/solve/<method> from (ns of the sample, calls in it).
fn raw(method: &str, samples: &[(f64, u64)]) -> String {
    let line = |(ns, calls): &(f64, u64)| format!("g,solve,{method},,,{ns},ns,{calls}\n");
    let lines: String = samples.iter().map(line).collect();
    format!("{HEADER}\n{lines}")
}

fn expected(method: &str) -> Expected {
    Expected {
        name: BenchmarkName::new("g", "solve", method),
        verdict: Some(Verdict::Solved),
        newer_than: built(),
    }
}

fn methods(harvest: &Harvest) -> Vec<&str> {
    let names = harvest.rows.iter().map(|row| row.name.value.as_str());
    names.collect()
}

#[test]
fn a_sample_of_many_calls_counts_as_its_mean() {
    let home = tempfile::tempdir().unwrap();
    // 2, 4, …, 20 µs per call, in samples of 1 to 10 calls.
    let samples: Vec<(f64, u64)> = (1..=10).map(|k| (2000.0 * (k * k) as f64, k)).collect();
    plant(home.path(), "g/solve/latin/new", &raw("latin", &samples), 1);
    let found = harvest(home.path(), &[expected("latin")]);
    assert!(found.missing.is_empty() && found.ignored.is_empty());
    let mut bundle = Bundle::new();
    add_to(&mut bundle, &found.rows).unwrap();
    let text = |name: &str| String::from_utf8(bundle.get(name).unwrap().to_vec()).unwrap();
    assert_eq!(
        text("timings.csv"),
        "group,function,value,verdict,samples,median_s,low_s,high_s,min_s\n\
         g,solve,latin,solved,10,1.1e-5,4e-6,1.8e-5,2e-6\n"
    );
    let row = "| g | solve | latin | solved | 10 | 1.1e-5 | 4e-6 | 1.8e-5 | 2e-6 |";
    assert!(text("timings.md").contains(row), "{}", text("timings.md"));
    assert!(text("timings.tex").contains("\\label{tab:timings}"));
}

#[test]
fn results_of_another_build_another_list_or_a_baseline_are_left_aside() {
    let home = tempfile::tempdir().unwrap();
    let one = |method: &str| raw(method, &[(1000.0, 1)]);
    plant(home.path(), "g/solve/latin/new", &one("latin"), 1);
    plant(home.path(), "g/solve/latin/v1", &one("latin"), 2);
    plant(home.path(), "g/solve/nsgs/new", &one("nsgs"), -1);
    plant(home.path(), "g/solve/pdas/new", &one("pdas"), 0);
    plant(home.path(), "g/solve/renamed/new", &one("renamed"), 1);
    let list = ["latin", "nsgs", "pdas", "admm"].map(expected);
    let found = harvest(home.path(), &list);
    assert_eq!(methods(&found), ["latin"]);
    let missing: Vec<&str> = found
        .missing
        .iter()
        .map(|name| name.value.as_str())
        .collect();
    assert_eq!(missing, ["admm", "nsgs", "pdas"]);
    let file = |method: &str| home.path().join(format!("g/solve/{method}/new/raw.csv"));
    let left_aside = vec![
        (file("nsgs"), Ignored::Stale),
        (file("pdas"), Ignored::Stale),
        (file("renamed"), Ignored::Unknown),
    ];
    assert_eq!(found.ignored, left_aside);
}

#[test]
fn of_two_results_of_one_benchmark_the_newer_counts() {
    for (first, second) in [(5, 9), (9, 5)] {
        let home = tempfile::tempdir().unwrap();
        plant(
            home.path(),
            "a/new",
            &raw("latin", &[(f64::from(first), 1)]),
            first.into(),
        );
        plant(
            home.path(),
            "b/new",
            &raw("latin", &[(f64::from(second), 1)]),
            second.into(),
        );
        let found = harvest(home.path(), &[expected("latin")]);
        // 9 ns, to the rounding of the unit.
        assert!((found.rows[0].timing.median_s - 9e-9).abs() < 1e-20);
        assert_eq!(found.ignored.len(), 1);
        assert_eq!(found.ignored[0].1, Ignored::Stale);
    }
}

#[test]
fn a_broken_file_is_named_and_harms_no_other() {
    let home = tempfile::tempdir().unwrap();
    plant(home.path(), "good/new", &raw("latin", &[(1000.0, 1)]), 1);
    let broken = [
        ("empty", String::new()),
        ("header", format!("{HEADER}\n")),
        ("columns", "group,function\ng,solve\n".into()),
        ("cut", format!("{HEADER}\ng,solve,nsgs,,,12")),
        ("unit", format!("{HEADER}\ng,solve,nsgs,,,12,cycles,1\n")),
        ("calls", raw("nsgs", &[(1000.0, 0)])),
        ("number", raw("nsgs", &[(f64::NAN, 1)])),
        ("negative", raw("nsgs", &[(-5.0, 1)])),
        (
            "mixed",
            raw("nsgs", &[(5.0, 1)]) + "g,solve,latin,,,5,ns,1\n",
        ),
    ];
    for (folder, text) in &broken {
        plant(home.path(), &format!("{folder}/new"), text, 1);
    }
    fs::create_dir_all(home.path().join("folder/new/raw.csv")).unwrap();
    let found = harvest(home.path(), &[expected("latin"), expected("nsgs")]);
    assert_eq!(methods(&found), ["latin"]);
    assert_eq!(found.ignored.len(), broken.len());
    for (path, why) in &found.ignored {
        assert!(
            matches!(why, Ignored::Broken(reason) if !reason.is_empty()),
            "{path:?}: {why:?}"
        );
    }
}

#[test]
fn without_any_results_the_table_is_empty() {
    let home = tempfile::tempdir().unwrap();
    let found = harvest(&home.path().join("never written"), &[expected("latin")]);
    assert!(found.rows.is_empty() && found.missing.len() == 1);
    let mut bundle = Bundle::new();
    add_to(&mut bundle, &found.rows).unwrap();
    let csv = String::from_utf8(bundle.get("timings.csv").unwrap().to_vec()).unwrap();
    assert_eq!(csv.lines().count(), 1);
}

/// Goal: of several builds the newest, whatever else cargo leaves beside it.
#[test]
fn a_target_was_built_when_its_newest_executable_was() {
    let folder = tempfile::tempdir().unwrap();
    let suffix = std::env::consts::EXE_SUFFIX;
    let others = [
        ("enforcement-0123456789abcdef.d".to_owned(), 9),
        (format!("enforcement-more-0123456789abcdef{suffix}"), 8),
        (format!("end_to_end-0123456789abcdef{suffix}"), 7),
        (format!("enforcement{suffix}"), 6),
    ];
    for (file, seconds) in &others {
        write(&folder.path().join(file), "", after_build(*seconds));
    }
    assert_eq!(last_built(folder.path(), "enforcement"), None);
    for (hash, seconds) in [("0123456789abcdef", 1), ("fedcba9876543210", 5), ("00", 3)] {
        let file = format!("enforcement-{hash}{suffix}");
        write(&folder.path().join(file), "", after_build(seconds));
    }
    let newest = last_built(folder.path(), "enforcement");
    assert_eq!(newest, Some(after_build(5)));
    assert_eq!(last_built(&folder.path().join("none"), "enforcement"), None);
}
