//! Many inputs for one reader: none may panic or take long.

use std::any::Any;
use std::env;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use stickslip_xfem::mesh::stream::Stream;

const SEED: u64 = 20_261_122;

/// An input that takes longer hangs: the usual ones take milliseconds.
const HANG: Duration = Duration::from_secs(2);

/// Stack of a reader, that of a main thread.
const STACK: usize = 8 << 20;

fn number(name: &str) -> Option<u64> {
    env::var(name)
        .ok()
        .map(|text| text.parse().expect("a whole number"))
}

/// Draws inputs and gives them to a reader, which says whether it took them. `default_count` of them if nobody asks for more.
pub fn run(
    reader: &'static str,
    default_count: u64,
    draw: impl Fn(&mut Stream) -> Vec<u8> + Send + 'static,
    read: impl Fn(&[u8]) -> bool + Send + 'static,
) {
    let seed = number("STICKSLIP_SEED").unwrap_or(SEED);
    let only = number("STICKSLIP_FUZZ_ONLY");
    let count = number("STICKSLIP_FUZZ").unwrap_or(default_count);
    let numbers = only.map_or(0..count, |k| k..k + 1);
    // What is being read, since when.
    let current = Arc::new(Mutex::new((numbers.start, Instant::now())));
    let own = current.clone();
    let work = move || {
        let (mut taken, mut slowest) = (0, (Duration::ZERO, 0));
        let mut failed: Vec<String> = Vec::new();
        let clock = Instant::now();
        for k in numbers.clone() {
            let input = draw(&mut Stream::numbered(seed, k));
            if only.is_some() {
                println!("{}", String::from_utf8_lossy(&input).escape_debug());
            }
            let start = Instant::now();
            *own.lock().unwrap() = (k, start);
            match catch_unwind(AssertUnwindSafe(|| read(&input))) {
                Ok(accepted) => taken += u64::from(accepted),
                Err(reason) => failed.push(format!("{k}: {}", told(&*reason))),
            }
            slowest = slowest.max((start.elapsed(), k));
            // Enough to see what is wrong.
            if failed.len() == 20 {
                break;
            }
        }
        let total = clock.elapsed().as_secs_f64();
        println!(
            "{reader}: {} inputs from seed {seed}, {taken} taken, {total:.1} s, slowest {:.1} ms (number {}), peak {} MB",
            numbers.end - numbers.start,
            1e3 * slowest.0.as_secs_f64(),
            slowest.1,
            peak_mb()
        );
        (failed, slowest)
    };
    let thread = thread::Builder::new().stack_size(STACK);
    let thread = thread.spawn(work).expect("a thread");
    // A reader that never returns would otherwise hang without a word.
    while !thread.is_finished() {
        thread::sleep(Duration::from_millis(5));
        let (k, start) = *current.lock().unwrap();
        assert!(
            start.elapsed() < 10 * HANG,
            "{reader}: input {k} of seed {seed} hangs"
        );
    }
    let (failed, slowest) = thread.join().expect("inputs are caught one by one");
    assert!(
        failed.is_empty(),
        "{reader}, seed {seed}:\n{}",
        failed.join("\n")
    );
    assert!(slowest.0 < HANG, "{reader}, seed {seed}: {slowest:?}");
}

fn told(reason: &(dyn Any + Send)) -> &str {
    let text = reason.downcast_ref::<&str>().copied();
    let text = text.or_else(|| reason.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("a panic without words")
}

/// Largest resident memory of this process, 0 where the system does not tell.
fn peak_mb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    let kb = line.and_then(|line| line.split_whitespace().nth(1));
    kb.and_then(|kb| kb.parse::<u64>().ok()).unwrap_or(0) / 1024
}
