//! Memory of this machine.

use std::fs::read_to_string;

/// Memory of this machine, or what the system grants this process of it [GB]; none where it does not tell (outside Linux).
pub fn machine_gb() -> Option<f64> {
    let about = read_to_string("/proc/meminfo").ok()?;
    let kilobytes = kilobytes(&about, "MemTotal:")?;
    let granted = read_to_string("/sys/fs/cgroup/memory.max").ok();
    let granted = granted.and_then(|text| text.trim().parse().ok());
    Some(1e-9 * (1024.0 * kilobytes).min(granted.unwrap_or(f64::INFINITY)))
}

/// Memory of this machine that this process does not hold yet [GB].
pub(crate) fn free_gb() -> f64 {
    /// Where the system does not tell: W of 20 000 rows with a tangent.
    const UNKNOWN: f64 = 6.4;
    let about = read_to_string("/proc/self/status").ok();
    let held = about.and_then(|about| kilobytes(&about, "VmRSS:"));
    machine_gb().map_or(UNKNOWN, |all| all - 1024e-9 * held.unwrap_or(0.0))
}

/// The number of a line that begins so.
fn kilobytes(about: &str, name: &str) -> Option<f64> {
    let line = about.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}
