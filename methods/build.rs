//! Lists the methods of this package, so that a new one is one file and the `mod` line that makes it part of its family.

use std::path::Path;

/// Families in the order of tables; a family's methods stand in the order of its `mod` lines.
const FAMILIES: [&str; 5] = ["newton", "splitting", "conic", "combined", "own_laws"];

fn main() {
    let mut methods = String::new();
    for family in FAMILIES {
        let list = format!("src/{family}.rs");
        println!("cargo::rerun-if-changed={list}");
        println!("cargo::rerun-if-changed=src/{family}");
        let text = std::fs::read_to_string(&list).unwrap_or_default();
        let names = text.lines().filter_map(|line| {
            let line = line.strip_prefix("pub mod ")?;
            line.strip_suffix(';')
        });
        for name in names {
            let source = std::fs::read_to_string(format!("src/{family}/{name}.rs"));
            if source.is_ok_and(|text| text.contains("pub static METHOD: Method")) {
                methods += &format!("    &{family}::{name}::METHOD,\n");
            }
        }
    }
    let folder = std::env::var("OUT_DIR").unwrap_or_else(|_| ".".into());
    let list = format!("static STANDARD: &[&Method] = &[\n{methods}];\n");
    if let Err(error) = std::fs::write(Path::new(&folder).join("standard.rs"), list) {
        println!("cargo::error=cannot write the list of methods: {error}");
    }
}
