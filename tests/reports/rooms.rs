//! Imports run one way: between the rooms of a package, and between the files of a room.
//!
//! A room is a module below the crate root, with all its files. It imports only rooms that come before it. Files import each
//! other in circles only as pairs that make one concept: two files of a folder, or a file and one of the folder of its name.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Sources of a package, its rooms, each of which may import those before it, and whether its files are looked at too.
#[rustfmt::skip]
const PACKAGES: [(&str, &[&str], bool); 3] = [
    ("methods/src", &["error", "algebra", "contract", "condensed", "newton", "splitting", "conic", "combined", "own_laws"], false),
    ("xfem/src", &[
        "geometry", "material", "mesh", "quadrature", "cut", "enrichment", "stiffness", "fields", "contact", "intensity", "exact",
        "loads", "discretisation",
    ], false),
    ("src", &["files", "case", "model", "run", "studies", "report", "cli"], true),
];

/// Names from the crate root, e.g. `report`, `page`.
type Module = Vec<String>;

/// Text of every module.
type Sources = BTreeMap<Module, String>;

/// A module, the modules it names something of, and the line where it first does.
type Imports = BTreeMap<Module, BTreeMap<Module, usize>>;

/// A path with its line.
type Place = (usize, Vec<String>);

/// Words and signs of a source with their lines, without comments and unit tests; `::` is one sign.
fn tokens(source: &str) -> Vec<(usize, String)> {
    let tests = source.find("#[cfg(test)]\nmod tests {");
    let mut tokens: Vec<(usize, String)> = Vec::new();
    for (index, line) in source[..tests.unwrap_or(source.len())].lines().enumerate() {
        let word = |c: char| c.is_alphanumeric() || c == '_';
        let mut last = ' ';
        for c in line.split("//").next().unwrap_or_default().chars() {
            match tokens.last_mut() {
                Some((_, token)) if word(c) && word(last) => token.push(c),
                Some((_, token)) if c == ':' && token == ":" => token.push(c),
                _ if c.is_whitespace() => {}
                _ => tokens.push((index + 1, c.into())),
            }
            last = c;
        }
    }
    tokens
}

/// Reads the path that begins at a token, in braces all of its paths. Returns the token behind it.
fn read_path(
    tokens: &[(usize, String)],
    at: usize,
    mut path: Vec<String>,
    found: &mut Vec<Place>,
) -> usize {
    let is = |at: usize, sign: &str| tokens.get(at).is_some_and(|(_, token)| token == sign);
    let Some((line, token)) = tokens.get(at) else {
        return at;
    };
    if token == "{" {
        let mut next = at + 1;
        while next < tokens.len() && !is(next, "}") {
            next = read_path(tokens, next, path.clone(), found);
            next += usize::from(is(next, ","));
        }
        return next + 1;
    }
    path.push(token.clone());
    if is(at + 1, "::") {
        return read_path(tokens, at + 2, path, found);
    }
    found.push((*line, path));
    at + if is(at + 1, "as") { 3 } else { 1 }
}

/// Names that a module declares by `use`: others reach them through the module.
type Declared = BTreeMap<String, Vec<String>>;

/// All paths of a module that may lead to modules of its own crate, and what it declares.
fn paths(sources: &Sources, module: &Module) -> (Vec<Place>, Declared) {
    let tokens = tokens(&sources[module]);
    let (mut all, mut declared) = (Vec::new(), BTreeMap::new());
    for (at, (_, token)) in tokens.iter().enumerate() {
        let next = tokens.get(at + 1).is_some_and(|(_, next)| next == "::");
        let begins = at == 0 || tokens[at - 1].1 != "::";
        let own = ["crate", "self", "super"].contains(&token.as_str());
        if next && begins && (own || sources.contains_key(&child(module, token))) {
            let first = all.len();
            read_path(&tokens, at, Vec::new(), &mut all);
            if at > 0 && tokens[at - 1].1 == "use" {
                let name = |path: &Vec<String>| path.iter().rfind(|name| *name != "self").cloned();
                declared.extend(
                    (all[first..].iter()).filter_map(|(_, path)| Some((name(path)?, path.clone()))),
                );
            }
        }
    }
    (all, declared)
}

fn child(module: &Module, name: &str) -> Module {
    module.iter().cloned().chain([name.to_owned()]).collect()
}

/// The module a path leads to, through what the modules on its way declare.
fn resolve(
    sources: &Sources,
    declared: &BTreeMap<Module, Declared>,
    module: &Module,
    path: &[String],
    depth: usize,
) -> Module {
    let mut at = module.clone();
    for (index, name) in path.iter().enumerate() {
        match name.as_str() {
            "crate" => at = Module::new(),
            "self" => {}
            "super" => {
                at.pop();
            }
            name if sources.contains_key(&child(&at, name)) => at = child(&at, name),
            name => {
                // A name of its own, unless the module has it from another one.
                return match declared.get(&at).and_then(|names| names.get(name)) {
                    Some(path) if depth > 0 && index > 0 => {
                        resolve(sources, declared, &at, path, depth - 1)
                    }
                    _ => at,
                };
            }
        }
    }
    at
}

fn imports(sources: &Sources) -> Imports {
    let read = sources
        .keys()
        .map(|module| (module.clone(), paths(sources, module)));
    let (mut all, mut declared) = (BTreeMap::new(), BTreeMap::new());
    for (module, (paths, names)) in read {
        all.insert(module.clone(), paths);
        declared.insert(module, names);
    }
    let of = |module: &Module, paths: &[Place]| {
        let mut found = BTreeMap::new();
        for (line, path) in paths {
            let to = resolve(sources, &declared, module, path, 4);
            if to != *module && !to.is_empty() {
                found.entry(to).or_insert(*line);
            }
        }
        found
    };
    let modules = all.iter().filter(|(module, _)| !module.is_empty());
    modules
        .map(|(module, paths)| (module.clone(), of(module, paths)))
        .collect()
}

/// Imports of later rooms, and rooms that are not in the list.
fn upward(imports: &Imports, rooms: &[&str]) -> Vec<String> {
    let room = |module: &Module| rooms.iter().position(|room| *room == module[0]);
    let mut wrong = Vec::new();
    for (from, to) in imports {
        if room(from).is_none() {
            wrong.push(format!("{} is in no room of the list", file(from)));
        }
        for (to, line) in to {
            match (room(from), room(to)) {
                (Some(own), Some(other)) if other <= own => {}
                _ => wrong.push(format!("{}:{line} imports {}", file(from), file(to))),
            }
        }
    }
    wrong
}

/// Circles longer than a pair, and pairs that are not in one folder.
fn circles(imports: &Imports) -> Vec<String> {
    let reached = |from: &Module| {
        let mut reached = BTreeSet::new();
        let mut open = vec![from.clone()];
        while let Some(module) = open.pop() {
            let next = imports[&module].keys();
            open.extend(next.filter(|to| reached.insert((*to).clone())).cloned());
        }
        reached
    };
    let reached: BTreeMap<&Module, BTreeSet<Module>> = imports
        .keys()
        .map(|module| (module, reached(module)))
        .collect();
    let circle = |module: &Module| -> BTreeSet<Module> {
        let mutual = reached[module]
            .iter()
            .filter(|to| reached[to].contains(module));
        mutual.cloned().collect()
    };
    let near = |circle: &BTreeSet<Module>| {
        let folder = |module: &Module| module[..module.len() - 1].to_vec();
        let pair: Vec<&Module> = circle.iter().collect();
        pair.len() == 2 && (folder(pair[0]) == folder(pair[1]) || folder(pair[1]) == *pair[0])
    };
    let found: BTreeSet<BTreeSet<Module>> = imports.keys().map(circle).collect();
    let wrong = found
        .iter()
        .filter(|circle| !circle.is_empty() && !near(circle));
    let names = |circle: &BTreeSet<Module>| {
        let inner = |from: &Module| -> Vec<String> {
            let to = imports[from].iter().filter(|(to, _)| circle.contains(*to));
            to.map(|(to, line)| format!("  {}:{line} imports {}", file(from), file(to)))
                .collect()
        };
        let lines: Vec<String> = circle.iter().flat_map(inner).collect();
        format!("a circle of {} files:\n{}", circle.len(), lines.join("\n"))
    };
    wrong.map(names).collect()
}

fn file(module: &Module) -> String {
    format!("{}.rs", module.join("/"))
}

fn read(root: &Path, module: &Module, sources: &mut Sources) {
    for entry in std::fs::read_dir(root).unwrap() {
        let path = entry.unwrap().path();
        let own = child(module, path.file_stem().unwrap().to_str().unwrap());
        if path.is_dir() {
            read(&path, &own, sources);
        } else if path.extension().is_some_and(|end| end == "rs") {
            let module = match own.last().unwrap().as_str() {
                "lib" => Module::new(),
                "main" => continue,
                _ => own,
            };
            sources.insert(module, std::fs::read_to_string(&path).unwrap());
        }
    }
}

fn package(root: &str) -> Sources {
    let mut sources = Sources::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(root);
    read(&root, &Module::new(), &mut sources);
    sources
}

#[test]
fn imports_run_one_way() {
    let mut wrong = Vec::new();
    for (root, rooms, files) in PACKAGES {
        let imports = imports(&package(root));
        let mut found = upward(&imports, rooms);
        if files {
            found.extend(circles(&imports));
        }
        wrong.extend(found.into_iter().map(|line| format!("{root}/{line}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Lines that a room may have, unit tests and the file of its name included: what a change adds it pays for in its room. The
/// count is that of the default formatting.
#[rustfmt::skip]
const BUDGETS: [(&str, usize); 14] = [
    ("methods/src", 19_300), ("xfem/src", 24_600), ("src/files", 2075), ("src/case", 3323), ("src/model", 3210), ("src/run", 2325),
    ("src/studies", 17_195), ("src/report", 10_545), ("src/cli", 2100), ("benches", 570), ("python/src", 1090), ("methods/tests", 3300), ("xfem/tests", 125),
    ("tests", 18_840),
];

/// Lines of all sources in a folder and below.
fn lines(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let paths = entries.map(|entry| entry.unwrap().path());
    let own = |path: PathBuf| match path.is_dir() {
        true => lines(&path),
        false if path.extension().is_some_and(|end| end == "rs") => {
            std::fs::read_to_string(&path).unwrap().lines().count()
        }
        false => 0,
    };
    paths.map(own).sum()
}

#[test]
fn rooms_keep_their_budgets() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut over = Vec::new();
    for (room, most) in BUDGETS {
        let own = std::fs::read_to_string(root.join(room).with_extension("rs"));
        let found = lines(&root.join(room)) + own.map_or(0, |text| text.lines().count());
        if found > most {
            over.push(format!("{room}: {found} lines of {most}"));
        }
    }
    assert!(over.is_empty(), "{}", over.join("\n"));
}

/// Sources of planted modules, e.g. `case/mesh`, and of those around them.
fn planted(modules: &[(&str, &str)]) -> Imports {
    let mut sources = Sources::new();
    for (name, text) in modules {
        let module: Module = name.split('/').map(str::to_owned).collect();
        sources.entry(module[..1].to_vec()).or_default();
        sources.insert(module, (*text).to_owned());
    }
    imports(&sources)
}

#[test]
fn upward_imports_are_found_with_file_and_line() {
    let below = [
        ("run", "pub mod record;"),
        ("run/record", "pub struct Row;"),
    ];
    for (text, line) in [
        ("use crate::run::record::Row;", 1),
        (
            "//! Text.\nuse crate::{\n    case::Case,\n    run::{self, record::Row},\n};",
            4,
        ),
        ("use std::fmt;\n\nfn f(row: &crate::run::record::Row) {}", 3),
        ("mod mesh;\nuse super::run::record as rows;", 2),
    ] {
        let modules = [&below[..], &[("case", text)]].concat();
        let found = upward(&planted(&modules), &["case", "run"]);
        assert!(
            found[0].starts_with(&format!("case.rs:{line} imports run")),
            "{text}: {found:?}"
        );
        assert!(upward(&planted(&modules), &["run", "case"]).is_empty());
    }
    for text in [
        "// use crate::run::record::Row;",
        "#[cfg(test)]\nmod tests {\n    use crate::run::record::Row;\n}",
        "use stickslip_methods::run::Row;",
    ] {
        let modules = [&below[..], &[("case", text)]].concat();
        assert!(
            upward(&planted(&modules), &["case", "run"]).is_empty(),
            "{text}"
        );
    }
    // A room that nobody put in its place.
    assert!(!upward(&planted(&below), &["case"]).is_empty());
}

#[test]
fn circles_are_found_unless_they_are_pairs_of_one_concept() {
    let circle = |modules: &[(&str, &str)]| circles(&planted(modules)).len();
    let three = [
        ("a/x", "use super::y::Y;"),
        ("a/y", "use crate::a::z::Z;"),
        ("a/z", "fn f() { crate::a::x::f() }"),
    ];
    assert_eq!((circle(&three), circle(&three[..2])), (1, 0));
    #[rustfmt::skip]
    let pairs = [
        // Two files of a folder, and a file with one of the folder of its name.
        (["a/x", "use super::y::Y;"], ["a/y", "use super::x::X;"], 0),
        (["a", "mod x;\nuse x::X;"], ["a/x", "use super::A;"], 0),
        (["a/x", "use crate::b::B;"], ["b", "use crate::a::x::X;"], 1),
    ];
    for ([a, x], [b, y], count) in pairs {
        assert_eq!(circle(&[(a, x), (b, y)]), count, "{a} {b}");
    }
    // A name that a module passes on is the business of where it comes from.
    let passed = [
        ("a", "mod x;\nmod y;\npub use x::X;\npub use y::Y;"),
        ("a/x", "pub struct X;"),
        ("a/y", "use super::X;"),
    ];
    assert_eq!(circle(&passed), 0);
}
