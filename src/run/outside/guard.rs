//! A folder for a call, a group for its processes and a guardian over both: whatever becomes of this process, what the call
//! began is ended and the folder removed.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// The guardian is a shell that reads its standard input to the end, which the system closes however this process ends, by
/// SIGKILL too. A line before says that the group has ended: from then on its number may be another's. Trees are removed by
/// `rm`, which no depth stops; what a program left without the rights to do so gets them.
const GUARDIAN: &str = r#"
read -r ended || kill -s KILL -- "-$2"
read -r end
command -p rm -rf -- "$1" || { command -p chmod -R u+rwx -- "$1"; command -p rm -rf -- "$1"; }"#;

/// What leads the group waits to be ended with it. So the guardian knows the group before a program begins in it: one that
/// has begun ends however soon this process does.
const LEADER: &str = "read -r end";

/// A private folder and a group of processes under guard; dropped, both are gone.
pub struct Guarded {
    path: PathBuf,
    leader: Child,
    guardian: Child,
}

impl Guarded {
    /// A new folder in that for temporary files, and a group without a program.
    ///
    /// # Errors
    /// A folder that cannot be created, or a shell that cannot be started, in words.
    pub fn folder() -> Result<Self, String> {
        let path = std::env::temp_dir().join(format!("stickslip-{}", unique()));
        // The program works in it.
        let path = std::path::absolute(path).map_err(|e| e.to_string())?;
        private(&path).map_err(|e| format!("cannot create `{}`: {e}", path.display()))?;
        let cannot = |error| {
            let _still_empty = std::fs::remove_dir(&path);
            format!("cannot start the guardian /bin/sh: {error}")
        };
        let mut leader = shell(LEADER).spawn().map_err(cannot)?;
        let group = leader.id().to_string();
        match shell(GUARDIAN).arg(&path).arg(group).spawn() {
            Ok(guardian) => Ok(Self {
                path,
                leader,
                guardian,
            }),
            Err(error) => {
                let _status = leader.wait();
                Err(cannot(error))
            }
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Has a program begin in the group.
    #[cfg(unix)]
    pub fn hold(&self, program: &mut Command) {
        use std::os::unix::process::CommandExt;
        program.process_group(self.leader.id().cast_signed());
    }

    /// Ends the group, whose number is its own until its leader is waited for.
    pub fn end(&mut self) {
        #[cfg(unix)]
        {
            use rustix::process::{Pid, Signal, kill_process_group};
            let _gone = kill_process_group(Pid::from_child(&self.leader), Signal::KILL);
        }
        let pipe = self.guardian.stdin.as_mut();
        let _gone = pipe.map(|pipe| pipe.write_all(b"\n"));
    }
}

impl Drop for Guarded {
    fn drop(&mut self) {
        // Their inputs are closed first, which is what they wait for.
        let _status = self.guardian.wait();
        let _status = self.leader.wait();
    }
}

/// A shell that waits for its standard input, in a group of its own: an interruption at the terminal reaches whole groups of
/// processes, and this one has to outlive it.
fn shell(script: &str) -> Command {
    let mut shell = Command::new("/bin/sh");
    shell.args(["-c", script, "guardian"]);
    shell.stdin(Stdio::piped());
    shell.stdout(Stdio::null()).stderr(Stdio::null());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut shell, 0);
    shell
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
