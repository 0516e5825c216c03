//! Tells the program which source it was built from: commit, whether the sources differ from it, compiler, features.
//!
//! A missing git, a missing repository or a source archive gives `unknown`, never a failed build.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;
use std::process::Command;

/// Files that decide about results; a changed report does not make the build dirty.
const SOURCES: [&str; 7] = [
    "src",
    "methods",
    "xfem",
    "cases",
    "build.rs",
    "Cargo.toml",
    "Cargo.lock",
];

fn main() {
    for path in SOURCES {
        println!("cargo::rerun-if-changed={path}");
    }
    // In a worktree these lie elsewhere, so git is asked; HEAD alone does not change when a branch moves.
    for name in ["HEAD", "index", "logs/HEAD"] {
        let path = output("git", &["rev-parse", "--git-path", name]);
        if let Some(path) = path.filter(|path| Path::new(path).exists()) {
            println!("cargo::rerun-if-changed={path}");
        }
    }

    // Sources unpacked inside a foreign repository are not that repository's commit.
    let tracked = output("git", &["ls-files", "--error-unmatch", "Cargo.toml"]).is_some();
    let commit = tracked
        .then(|| output("git", &["rev-parse", "HEAD"]))
        .flatten();
    let dirty = commit.as_ref().and_then(|_| {
        let mut arguments = vec!["status", "--porcelain", "--untracked-files=normal", "--"];
        arguments.extend(SOURCES);
        output("git", &arguments).map(|changes| (!changes.is_empty()).to_string())
    });
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());

    embed_cases();

    set("SOURCES", Some(format!("{:016x}", digest_of_sources())));
    set("COMMIT", commit);
    set("DIRTY", dirty);
    set("RUSTC", output(&rustc, &["--version"]));
    set("TARGET", std::env::var("TARGET").ok());
    set("PROFILE", std::env::var("PROFILE").ok());
}

/// Digest of names and contents of the sources: tells builds of one commit with different changes apart.
fn digest_of_sources() -> u64 {
    fn visit(path: &Path, hasher: &mut DefaultHasher) {
        if let Ok(entries) = std::fs::read_dir(path) {
            let mut paths: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
            paths.sort();
            paths.iter().for_each(|path| visit(path, hasher));
        } else if let Ok(contents) = std::fs::read(path) {
            path.hash(hasher);
            contents.hash(hasher);
        }
    }
    let mut hasher = DefaultHasher::new();
    for path in SOURCES {
        visit(Path::new(path), &mut hasher);
    }
    hasher.finish()
}

/// Writes the list of the shipped cases, so that a new file in `cases/` is all it takes to add one.
fn embed_cases() {
    let root = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_else(|_| ".".into());
    let mut names: Vec<String> = std::fs::read_dir(Path::new(&root).join("cases"))
        .into_iter()
        .flatten()
        .flatten()
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter_map(|name| name.strip_suffix(".toml").map(str::to_owned))
        .collect();
    names.sort();
    let entries: String = names
        .iter()
        .map(|name| {
            format!(
                "    ({name:?}, include_str!({:?})),\n",
                format!("{root}/cases/{name}.toml")
            )
        })
        .collect();
    let target = std::env::var("OUT_DIR").unwrap_or_else(|_| ".".into());
    let list = format!("&[\n{entries}]\n");
    if let Err(error) = std::fs::write(Path::new(&target).join("cases.rs"), list) {
        println!("cargo::error=cannot write the list of cases: {error}");
    }
}

fn set(name: &str, value: Option<String>) {
    let value = value.unwrap_or_else(|| "unknown".into());
    println!("cargo::rustc-env=STICKSLIP_BUILD_{name}={value}");
}

/// Standard output of a command that succeeded, without surrounding white space.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
