//! One process per scene: what eats all memory, never ends or aborts is one broken scene, not the end of a survey.

use std::io::Read;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use super::generator::Scene;
use super::referee::{OUTCOMES, Report, judge};

/// What a scene may take [s] and [KiB].
const LIMIT_S: u64 = 60;
const LIMIT_KIB: u64 = 8_000_000;

/// Head of the line in which a child reports.
const HEAD: &str = "stickslip-scene\t";

/// Judges a scene and prints what [`judge_alone`] reads.
pub fn report_to_parent(scene: &Scene) {
    let found = judge(scene);
    let Report {
        outcome,
        reason,
        seconds,
        error,
        ..
    } = found;
    println!("\n{HEAD}{outcome}\t{seconds}\t{error:e}\t{reason}");
}

/// Judges a scene in a process of its own, with limits of time and memory.
pub fn judge_alone(scene: &Scene, seed: u64) -> Report {
    let clock = Instant::now();
    let broken = |reason: String| Report {
        number: scene.number,
        category: scene.category,
        outcome: "broken".into(),
        reason,
        seconds: clock.elapsed().as_secs_f64(),
        error: f64::NAN,
    };
    let program = std::env::current_exe().expect("the test program");
    let child = Command::new("sh")
        .arg("-c")
        .arg(format!("ulimit -v {LIMIT_KIB}; exec \"$0\" \"$@\""))
        .arg(program)
        .args([
            "random_scenes::scene_of_a_survey",
            "--exact",
            "--ignored",
            "--nocapture",
        ])
        .env(
            "STICKSLIP_SCENE",
            format!("{} {seed} {}", scene.exact.dim, scene.number),
        )
        .env("RAYON_NUM_THREADS", "1")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = child.expect("a shell");
    let (mut out, mut err) = (child.stdout.take(), child.stderr.take());
    let text = |pipe: &mut dyn Read| {
        let mut bytes = Vec::new();
        let _ = pipe.read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    };
    let (out, err, ended) = thread::scope(|scope| {
        let out = scope.spawn(|| out.as_mut().map(|p| text(p)).unwrap_or_default());
        let err = scope.spawn(|| err.as_mut().map(|p| text(p)).unwrap_or_default());
        let ended = loop {
            match child.try_wait() {
                Ok(None) if clock.elapsed() > Duration::from_secs(LIMIT_S) => {
                    let _ = child.kill();
                    let _ = child.wait();
                    break false;
                }
                Ok(None) => thread::sleep(Duration::from_millis(5)),
                _ => break true,
            }
        };
        (
            out.join().unwrap_or_default(),
            err.join().unwrap_or_default(),
            ended,
        )
    });
    if !ended {
        return broken(format!("no answer in {LIMIT_S} s"));
    }
    // `panicked at file:line:column` and `memory allocation failed` stand here alone.
    let mut complaints = err.lines().chain(out.lines());
    let word = |line: &&str| line.contains("panicked at") || line.contains("memory allocation");
    let complaint = complaints.find(word).unwrap_or_default();
    let Some(line) = out.lines().find_map(|line| line.strip_prefix(HEAD)) else {
        return broken(format!("no answer: {complaint}"));
    };
    let parts: Vec<&str> = line.splitn(4, '\t').collect();
    let [outcome, seconds, error, reason] = parts[..] else {
        return broken(format!("unreadable: {line}"));
    };
    let outcome = OUTCOMES
        .into_iter()
        .find(|o| *o == outcome)
        .unwrap_or("other");
    Report {
        outcome: outcome.into(),
        reason: format!("{reason} {complaint}").trim().to_owned(),
        seconds: seconds.parse().unwrap_or(f64::NAN),
        error: error.parse().unwrap_or(f64::NAN),
        ..broken(String::new())
    }
}
