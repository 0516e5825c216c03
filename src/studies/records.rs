//! A folder of records: one file a problem, a line a task.
//!
//! ```text
//!   DIR/records/<problem>.jsonl     records in the order in which they were measured; of one task the last one holds
//! ```
//! A line is appended by one call, so that a program that is killed loses the task in hand alone: what is left of a last line
//! without its end is dropped. Lines of other tasks, or of programs with other records, are nobody's business here: they stay.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::studies::record::Record;
use crate::studies::task::Task;

/// Name of the folder with the records.
pub const RECORDS: &str = "records";

/// A folder of records.
#[derive(Debug)]
pub struct Records {
    dir: PathBuf,
}

/// A file of records that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("cannot {doing} `{}`: {source}", path.display())]
pub struct RecordsError {
    /// read or write.
    pub doing: &'static str,
    /// Which file.
    pub path: PathBuf,
    /// Why.
    pub source: std::io::Error,
}

impl Records {
    /// The records in a folder of results; the folder need not be there yet.
    pub fn of(dir: &Path) -> Self {
        Self {
            dir: dir.join(RECORDS),
        }
    }

    /// The records of some tasks that there are, by id.
    ///
    /// # Errors
    /// A file that is there and cannot be read.
    pub fn read(&self, tasks: &[Task]) -> Result<BTreeMap<String, Record>, RecordsError> {
        let mut files: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for task in tasks {
            files.entry(task.asked.file()).or_default().push(task.id());
        }
        let mut records = BTreeMap::new();
        for (name, ids) in files {
            let path = self.dir.join(name);
            let text = match fs::read(&path) {
                Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
                Err(e) if e.kind() == ErrorKind::NotFound => continue,
                Err(source) => {
                    let doing = "read";
                    return Err(RecordsError {
                        doing,
                        path,
                        source,
                    });
                }
            };
            // A record that is cut off, or of another format, is measured again.
            let whole = text
                .split_inclusive('\n')
                .filter(|line| line.ends_with('\n'));
            let known = whole.filter_map(|line| serde_json::from_str::<Record>(line).ok());
            for record in known.filter(|own| own.id == own.asked.id() && ids.contains(&own.id)) {
                records.insert(record.id.clone(), record);
            }
        }
        Ok(records)
    }

    /// Keeps a record.
    ///
    /// # Errors
    /// The file system.
    pub fn append(&self, record: &Record) -> Result<(), RecordsError> {
        let path = self.dir.join(record.asked.file());
        let written = || {
            fs::create_dir_all(&self.dir)?;
            let mut line = serde_json::to_vec(record)?;
            line.push(b'\n');
            drop_partial_line(&path)?;
            let mut file = OpenOptions::new().append(true).create(true).open(&path)?;
            file.write_all(&line)
        };
        let doing = "write";
        written().map_err(|source| RecordsError {
            doing,
            path,
            source,
        })
    }
}

/// Cuts off what follows the last whole line.
fn drop_partial_line(path: &Path) -> std::io::Result<()> {
    let mut file = match File::options().read(true).write(true).open(path) {
        Ok(file) => file,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(error),
    };
    let mut last = [b'\n'];
    if file.metadata()?.len() > 0 {
        file.seek(SeekFrom::End(-1))?;
        file.read_exact(&mut last)?;
    }
    if last != [b'\n'] {
        let bytes = fs::read(path)?;
        let whole = bytes
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |end| end + 1);
        file.set_len(whole as u64)?;
    }
    Ok(())
}
