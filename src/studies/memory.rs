//! Peak of the resident memory, and a bound on memory, as far as the operating system offers them.

/// Largest resident memory of this process since it began, or since [`reset_peak`] [MB]; none where the system does not
/// tell (outside Linux).
pub fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024.0 / 1e6)
}

/// Starts the peak anew, where Linux allows it; otherwise the peak is that of the whole process.
pub fn reset_peak() {
    // 5: "reset the peak resident set size" (proc_pid_clear_refs(5)).
    let _not_allowed = std::fs::write("/proc/self/clear_refs", "5");
}

/// The bound on a process of this one that asks for some [MB]: no more than this one may have itself. A process that asks for
/// none inherits that.
#[cfg(unix)]
pub fn allowed(megabytes: Option<u64>) -> Option<u64> {
    use rustix::process::{Resource, getrlimit};
    let own = getrlimit(Resource::As);
    let most = megabytes.map_or(own.current, |_| own.maximum);
    let most = most.map(|bytes| bytes / 1_000_000);
    megabytes.into_iter().chain(most).min()
}

/// As asked for: this system has no such bound.
#[cfg(not(unix))]
pub fn allowed(megabytes: Option<u64>) -> Option<u64> {
    megabytes
}

/// Bounds the address space of this process [MB]; an allocation beyond it ends the process.
///
/// # Errors
/// A system without such a bound, or one that refuses it.
#[cfg(unix)]
pub fn bound(megabytes: u64) -> std::io::Result<()> {
    use rustix::process::{Resource, Rlimit, setrlimit};
    let bytes = Some(megabytes.saturating_mul(1_000_000));
    let limit = Rlimit {
        current: bytes,
        maximum: bytes,
    };
    Ok(setrlimit(Resource::As, limit)?)
}

/// Bounds the address space of this process [MB].
///
/// # Errors
/// Always: this system has no such bound.
#[cfg(not(unix))]
pub fn bound(_megabytes: u64) -> std::io::Result<()> {
    Err(std::io::ErrorKind::Unsupported.into())
}
