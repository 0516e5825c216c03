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

/// Memory that this process holds [GB]; 0 where the system does not tell.
pub(crate) fn resident_gb() -> f64 {
    let about = read_to_string("/proc/self/status").ok();
    let held = about.and_then(|about| kilobytes(&about, "VmRSS:"));
    1024e-9 * held.unwrap_or(0.0)
}

/// The number of a line that begins so.
fn kilobytes(about: &str, name: &str) -> Option<f64> {
    let line = about.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}
