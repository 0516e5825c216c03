//! Progress of a command.

/// Watches the runs of a command.
pub trait Progress: Sync {
    /// So many runs will follow.
    fn plan(&self, runs: usize);
    /// One run (case, mesh, friction, method) ended.
    fn done(&self, label: &str);
}

/// No progress report.
pub struct Quiet;

impl Progress for Quiet {
    fn plan(&self, _: usize) {}
    fn done(&self, _: &str) {}
}
