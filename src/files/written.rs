//! The own list of an output folder, `written.toml`: for which plan this program wrote there, and which files.
//!
//! What is not in the list is somebody else's, and so is a listed file whose digest has changed: neither is ever replaced
//! or removed. A folder that was copied without its list is its owner's as a whole.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::bundle::{FolderError, is_inside};
use super::place::{Kind, kind_of};
use super::regular;
use super::visible::excerpt;

/// Name of the list in its folder.
pub const LIST: &str = "written.toml";

/// Largest list read [bytes]: a hundred thousand files.
const MOST: u64 = 16 << 20;

/// Most characters shown of where plans differ.
const SHOWN: usize = 100;

/// What is said to who opens it.
const HEAD: &str = "# What stickslip wrote here, with SHA-256 digests. It replaces and removes these files, unless they \
                    were changed, and no others.\n";

/// What decides the results in a folder, by name: the command, cases, methods, options. Empty: files of several plans,
/// told apart by their names.
pub type Plan = BTreeMap<String, String>;

/// What comes first where plans differ.
pub const COMMAND: &str = "command";

/// The plan of a command without options.
pub fn plan(command: &str) -> Plan {
    Plan::from([(COMMAND.to_owned(), command.to_owned())])
}

/// The list.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Written {
    pub plan: Plan,
    /// Digests by path relative to the folder.
    pub files: BTreeMap<String, String>,
    /// The same of files of no plan.
    #[serde(default)]
    pub beside: BTreeMap<String, String>,
}

impl Written {
    /// The list of a folder; none where there is none.
    pub fn read(dir: &Path) -> Result<Option<Self>, FolderError> {
        let path = dir.join(LIST);
        if kind_of(&path)? == Kind::Nothing {
            return Ok(None);
        }
        let text = regular::read_text(&path, MOST);
        let text = text.map_err(|e| FolderError::io("read file", &path, e))?;
        // A list is believed in what may be removed: never what lies elsewhere.
        let list = toml::from_str::<Self>(&text).ok();
        let list = list.filter(|list| list.paths().all(|path| is_inside(path)));
        let why = "it is no list of this program";
        list.map(Some).ok_or(FolderError::InTheWay { path, why })
    }

    /// All paths.
    pub fn paths(&self) -> impl Iterator<Item = &String> {
        self.files.keys().chain(self.beside.keys())
    }

    /// Digest of a listed file.
    pub fn digest(&self, path: &str) -> Option<&String> {
        self.files.get(path).or_else(|| self.beside.get(path))
    }

    /// Its text.
    pub fn to_text(&self) -> String {
        HEAD.to_owned() + &toml::to_string(self).unwrap_or_default()
    }

    /// Whether the results of a plan may take the place of those listed.
    pub fn allow(&self, plan: &Plan, dir: &Path) -> Result<(), FolderError> {
        let first = [COMMAND.to_owned()];
        let mut names = first.iter().chain(self.plan.keys()).chain(plan.keys());
        let other = names.find(|name| self.plan.get(*name) != plan.get(*name));
        let Some(what) = other.filter(|_| !self.plan.is_empty()) else {
            return Ok(());
        };
        let value = |of: &Plan| {
            of.get(what)
                .map_or(String::new(), |own| excerpt(own, SHOWN))
        };
        Err(FolderError::OtherPlan {
            path: dir.to_path_buf(),
            there: value(&self.plan),
            here: value(plan),
            what: what.clone(),
        })
    }
}
