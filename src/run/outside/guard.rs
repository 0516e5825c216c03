//! A folder for a call and a guardian over both: whatever becomes of this process, what the call began is ended and the
//! folder removed.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// The guardian is a shell that reads its standard input to the end, which the system closes however this process ends, by
/// SIGKILL too. It learns a group when a program started in it, and forgets it with the next line, when the group has ended:
/// from then on the number may be another's. Trees are removed by `rm`, which no depth stops; what a program left without
/// the rights to do so gets them.
const GUARDIAN: &str = r#"
if read -r group; then read -r ended || kill -s KILL -- "-$group"; fi
read -r end
command -p rm -rf -- "$1" || { command -p chmod -R u+rwx -- "$1"; command -p rm -rf -- "$1"; }"#;

/// A private folder under guard; dropped, it is gone.
pub struct Guarded {
    path: PathBuf,
    guardian: Child,
}

impl Guarded {
    /// A new folder in that for temporary files.
    ///
    /// # Errors
    /// A folder that cannot be created, or a shell that cannot be started, in words.
    pub fn folder() -> Result<Self, String> {
        let path = std::env::temp_dir().join(format!("stickslip-{}", unique()));
        // The program works in it.
        let path = std::path::absolute(path).map_err(|e| e.to_string())?;
        private(&path).map_err(|e| format!("cannot create `{}`: {e}", path.display()))?;
        let mut shell = Command::new("/bin/sh");
        shell.args(["-c", GUARDIAN, "guardian"]).arg(&path);
        let shell = shell.stdin(Stdio::piped());
        shell.stdout(Stdio::null()).stderr(Stdio::null());
        // An interruption at the terminal reaches whole groups of processes, and this one has to outlive it.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(shell, 0);
        match shell.spawn() {
            Ok(guardian) => Ok(Self { path, guardian }),
            Err(error) => {
                let _still_empty = std::fs::remove_dir(&path);
                Err(format!("cannot start the guardian /bin/sh: {error}"))
            }
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts a group of processes under guard.
    ///
    /// # Errors
    /// A guardian that somebody ended.
    pub fn watch(&mut self, group: u32) -> io::Result<()> {
        self.tell(&format!("{group}\n"))
    }

    /// The group has ended.
    pub fn release(&mut self) {
        let _gone = self.tell("\n");
    }

    fn tell(&mut self, line: &str) -> io::Result<()> {
        let pipe = self.guardian.stdin.as_mut();
        pipe.map_or(Ok(()), |pipe| pipe.write_all(line.as_bytes()))
    }
}

impl Drop for Guarded {
    fn drop(&mut self) {
        // Its input is closed first, which is what it waits for.
        let _status = self.guardian.wait();
    }
}

/// Creates a folder that nobody else looks into, and that was not there.
fn private(path: &Path) -> io::Result<()> {
    let mut builder = std::fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(path)
}

/// A word that no other command uses at the same time, also in containers whose processes have the same numbers.
fn unique() -> String {
    // The standard library seeds its hash maps at random.
    let random = RandomState::new().build_hasher().finish();
    format!("{}-{random:016x}", std::process::id())
}
