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

/// Whether the shell denies processes of this one the memory [MB] that they ask for, or all there is (`ulimit -v`, `-d`).
#[cfg(unix)]
pub fn is_short(megabytes: Option<u64>) -> bool {
    use rustix::process::{Resource, getrlimit};
    let space = getrlimit(Resource::As);
    let space = megabytes.map_or(space.current, |_| space.maximum);
    let least = [space, getrlimit(Resource::Data).current]
        .into_iter()
        .flatten()
        .min();
    least.is_some_and(|bytes| megabytes.is_none_or(|asked| bytes / 1_000_000 < asked))
}

/// This system has no such bound.
#[cfg(not(unix))]
pub fn is_short(_megabytes: Option<u64>) -> bool {
    false
}

/// Bounds the address space of this process [MB], to what it may have at most; an allocation beyond it ends the process.
///
/// # Errors
/// A system without such a bound, or one that refuses it.
#[cfg(unix)]
pub fn bound(megabytes: u64) -> std::io::Result<()> {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let asked = megabytes.saturating_mul(1_000_000);
    let most = getrlimit(Resource::As).maximum;
    let bytes = Some(most.map_or(asked, |most| most.min(asked)));
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
