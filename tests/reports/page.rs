//! The page of a report folder: well-formed, self-contained, deaf to what tables and figures say, and honest about files
//! that are broken.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::report_data::results;
use stickslip::report::figures::{cost, error};
use stickslip::report::page::{self, Budget, Folder};
use stickslip::report::{Claim, Provenance, plan, standard};

const TABLE1: &str = "mesh,friction,method,reaction_mn_per_m,printed_mn_per_m,relative_difference,verdict\n\
                      I,0.1,b-newton,973.54321,973.3,0.00025,solved\n\
                      I,1.2,penalty,,1137.5,,gave-up: max-iterations\n";

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let dir = tempfile::tempdir().expect("a folder");
    for (path, text) in files {
        let path = dir.path().join(path);
        fs::create_dir_all(path.parent().expect("a folder")).expect("folders");
        fs::write(path, text).expect("a file");
    }
    dir
}

fn page(dir: &Path) -> String {
    page::of_folder(dir).expect("a page")
}

fn refusal(files: &[(&str, &str)]) -> String {
    let dir = folder(files);
    let error = page::of_folder(dir.path())
        .expect_err("refused")
        .to_string();
    assert!(
        page::write(dir.path()).is_err() && !dir.path().join(page::FILE).exists(),
        "nothing is written"
    );
    error.replace(&format!("{}/", dir.path().display()), "")
}

fn svg(body: &str) -> String {
    format!(
        "<svg width=\"85.00mm\" height=\"60.00mm\" viewBox=\"0 0 1700 1200\" xmlns=\"http://www.w3.org/2000/svg\">\n{body}\n</svg>\n"
    )
}

/// Elements in the order they open, with attributes. Panics where one is not closed, or closes what is not open.
fn elements(html: &str) -> Vec<(String, Vec<(String, String)>)> {
    const VOID: [&str; 5] = ["meta", "link", "input", "br", "img"];
    let (mut found, mut open) = (Vec::new(), Vec::<String>::new());
    let mut rest = html;
    while let Some(at) = rest.find('<') {
        rest = &rest[at..];
        let raw = open
            .last()
            .is_some_and(|name| name == "script" || name == "style");
        let end_tag = open.last().map(|name| format!("</{name}>"));
        if raw && !rest.starts_with(end_tag.as_deref().unwrap_or("</")) {
            rest = &rest[1..];
            continue;
        }
        let mut quoted = false;
        let end = rest.char_indices().find(|(_, c)| {
            quoted ^= *c == '"';
            *c == '>' && !quoted
        });
        let end = end
            .unwrap_or_else(|| panic!("no end: {}", &rest[..rest.len().min(60)]))
            .0;
        let inside = &rest[1..end];
        rest = &rest[end + 1..];
        if inside.starts_with('!') {
            assert_eq!(inside, "!DOCTYPE html");
        } else if let Some(name) = inside.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "closed out of order");
        } else {
            let (inside, empty) = match inside.strip_suffix('/') {
                Some(inside) => (inside, true),
                None => (inside, false),
            };
            let (name, mut tail) = inside.split_once([' ', '\n']).unwrap_or((inside, ""));
            let mut attributes = Vec::new();
            while !tail.trim().is_empty() {
                tail = tail.trim_start();
                let word = tail.find([' ', '=']).unwrap_or(tail.len());
                let key = tail[..word].to_owned();
                tail = &tail[word..];
                let mut value = String::new();
                if let Some(quoted) = tail.strip_prefix("=\"") {
                    let (inner, after) = quoted.split_once('"').expect("a closing quote");
                    value = inner.to_owned();
                    tail = after;
                }
                attributes.push((key, value));
            }
            if !empty && !VOID.contains(&name) {
                open.push(name.to_owned());
            }
            found.push((name.to_owned(), attributes));
        }
    }
    assert!(open.is_empty(), "not closed: {open:?}");
    found
}

/// Claims that hold of every page.
fn check(html: &str) {
    let elements = elements(html);
    let mut ids = BTreeSet::new();
    for (name, attributes) in &elements {
        for (key, value) in attributes {
            assert!(!key.starts_with("on"), "<{name} {key}>");
            if key == "id" {
                assert!(ids.insert(value.clone()), "id {value} twice");
            }
            if ["src", "href", "action", "srcset", "poster"].contains(&key.as_str()) {
                assert!(
                    value.starts_with("data:image/svg+xml;base64,") || !value.contains("//"),
                    "<{name} {key}={value}> leaves the folder"
                );
            }
        }
    }
    for (name, attributes) in &elements {
        for (key, value) in attributes {
            let anchor = value.strip_prefix('#').filter(|_| key == "href");
            if let Some(anchor) = anchor {
                assert!(ids.contains(anchor), "<{name}> leads to #{anchor}");
            }
        }
    }
    let count = |name: &str| elements.iter().filter(|e| e.0 == name).count();
    assert_eq!((count("script"), count("style"), count("h1")), (1, 1, 1));
    let addresses = html.matches("http://").count() + html.matches("https://").count();
    assert_eq!(addresses, 0, "a page needs no network");
}

#[test]
fn the_committed_report_makes_one_page() {
    let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports");
    let html = page(&reports);
    check(&html);
    assert!(html.len() < 1_000_000, "{} bytes", html.len());
    let sections: Vec<String> = elements(&html)
        .into_iter()
        .filter(|(name, _)| name == "section")
        .map(|(_, attributes)| attributes[0].1.clone())
        .collect();
    let expected = [
        "glance",
        "paper",
        "methods",
        "study",
        "stress",
        "accuracy",
        "benchmarks",
        "expected",
        "provenance",
    ];
    assert!(sections.iter().filter(|own| *own != "runs").eq(expected));
    // Figures first: the page opens with what was found.
    let (table, figure) = (html.find("<table"), html.find("<img"));
    assert!(figure < table, "{figure:?} {table:?}");
    for text in [
        "973.540",
        "href=\"figures/cost.svg\"",
        "href=\"accuracy/orders.csv\"",
    ] {
        assert!(html.contains(text), "{text}");
    }
    assert_eq!(page(&reports), html, "the same folder, the same bytes");
}

#[test]
fn the_results_of_a_run_make_a_page() {
    let dir = tempfile::tempdir().expect("a folder");
    let bundle = standard::bundle(&results(), &Provenance::collect(1)).expect("results");
    let claim = Claim::new(dir.path(), plan("run"), false).expect("a folder");
    claim.commit(&bundle).expect("written");
    drop(claim);
    let html = page(dir.path());
    check(&html);
    assert!(html.contains("id=\"runs\"") && !html.contains("id=\"accuracy\""));
    assert!(html.contains("<img "), "figures are inside");
    // The page does not show itself, nor fields for ParaView.
    page::write(dir.path()).expect("written");
    assert_eq!(page(dir.path()), html);
    assert!(!html.contains(".vtu"));
}

#[test]
fn numbers_have_few_digits_and_keep_what_they_are_sorted_by() {
    let dir = folder(&[("table1.csv", TABLE1)]);
    let html = page(dir.path());
    check(&html);
    assert!(
        html.contains("<td class=\"n\" data-v=\"973.54321\">973.543</td>"),
        "{html}"
    );
    for part in [
        "<th scope=\"col\" class=\"n\">printed <span class=\"unit\">[MN/m]</span></th>",
        "<th scope=\"col\" class=\"n\">b-newton</th>",
        "<th scope=\"col\" class=\"n\">penalty, gave-up: max-iterations</th>",
    ] {
        assert!(html.contains(part), "{part}: {html}");
    }
    let no_value = "<td class=\"n\" data-v=\"\">–</td>";
    assert!(html.contains(no_value), "no value is a dash: {html}");
}

#[test]
fn a_folder_with_one_table_shows_what_it_has() {
    let dir = folder(&[("some/where/table1.csv", TABLE1)]);
    let html = page(dir.path());
    check(&html);
    for absent in ["id=\"methods\"", "id=\"provenance\"", "<img"] {
        assert!(!html.contains(absent), "{absent}");
    }
    assert!(html.contains("href=\"some/where/table1.csv\""));
    assert!(!html.contains("(some/where)"), "one of its kind");
    let both = folder(&[("table1.csv", TABLE1), ("some/where/table1.csv", TABLE1)]);
    let html = page(both.path());
    check(&html);
    assert_eq!(html.matches("by method (some/where)</span>").count(), 1);
    let error = refusal(&[("notes.txt", "nothing")]);
    assert!(error.contains("no report in"), "{error}");
}

/// Text of tables, file names, figures and provenance must stay text.
#[test]
fn hostile_text_stays_text() {
    let attack = "<script>alert(1)</script>";
    let table = format!("{TABLE1}{attack},0.1,\"\"\" onclick=\"\"x\",1,1,0,</span><b>\n");
    let figure = svg("<title>&lt;b&gt; \" onload=\"x</title><rect x=\"1\" fill=\"#FFFFFF\"/>");
    let dir = folder(&[
        ("table1.csv", table.as_str()),
        ("figures/a\"b<i>#?%.10x10.star.mu-0.residual.svg", &figure),
        (
            "<b>/provenance.toml",
            "version = \"<img src=x onerror=alert(1)>\"\n",
        ),
    ]);
    let html = page(dir.path());
    check(&html);
    assert!(!html.contains(attack) && html.contains("&lt;script&gt;alert(1)&lt;/script&gt;"));
    assert_eq!(html.matches("<img").count(), 1, "the figure alone");
    assert!(!html.contains("onerror=alert(1)>") && !html.contains("<b>"));
    assert!(
        html.contains("figures/a%22b%3Ci%3E%23%3F%25.10x10.star.mu-0.residual.svg"),
        "{html}"
    );
}

#[test]
fn tables_that_are_broken_are_named_with_file_and_line() {
    let short = format!("{TABLE1}II,0.1,latin\n");
    assert_eq!(
        refusal(&[("table1.csv", &short)]),
        "table1.csv:4: 3 cells, the header has 7"
    );
    let runs = "case,verdict\na,solved\na,splendid\n";
    assert_eq!(
        refusal(&[("runs.csv", runs)]),
        "runs.csv:3: `splendid` does not belong into column `verdict`"
    );
    let renamed = TABLE1.replace("verdict", "verdikt");
    assert_eq!(
        refusal(&[("table1.csv", &renamed)]),
        "table1.csv:1: no column `verdict`"
    );
    assert_eq!(refusal(&[("runs.csv", "")]), "runs.csv:1: no header");
    let dir = folder(&[]);
    fs::write(dir.path().join("penalty.csv"), b"a\n\xff\xfe\n").expect("a file");
    let error = page::of_folder(dir.path())
        .expect_err("no text")
        .to_string();
    assert!(
        error.ends_with("penalty.csv:2: is no UTF-8 text"),
        "{error}"
    );
    let error = refusal(&[("table1.csv", TABLE1), ("provenance.toml", "version = \n")]);
    assert!(error.starts_with("provenance.toml: "), "{error}");
}

/// As images they can neither fetch nor act; what is no drawing is refused.
#[test]
fn figures_are_images_and_nothing_else() {
    let name = "figures/a.10x10.star.mu-0.residual.svg";
    let error = refusal(&[(name, "hello")]);
    assert_eq!(error, format!("{name}: is no SVG drawing"));
    let dir = folder(&[(name, &svg("<script>alert(1)</script>"))]);
    let html = page(dir.path());
    check(&html);
    assert!(!html.contains("alert") && html.contains("<img src=\"data:image/svg+xml;base64,"));
}

#[test]
fn figures_beyond_the_budget_are_linked() {
    let figure = svg("<rect x=\"1\"/>");
    let files = [("a.error.svg", figure.as_str()), ("b.error.svg", &figure)];
    let dir = folder(&files);
    let own = figure.len();
    let folder = Folder::open(dir.path()).expect("a folder");
    for (room, inside) in [(2 * own, 2), (2 * own - 1, 1), (own - 1, 0)] {
        let group = folder.figures(&error::KIND, &mut Budget::new(room));
        let group = group.expect("figures").expect("a group");
        assert_eq!(
            (group.figures.len(), group.links.len()),
            (inside, 2 - inside)
        );
    }
    let none = folder.figures(&cost::KIND, &mut Budget::new(own));
    assert!(none.expect("no figures").is_none());
}

/// A method that lies must not look fast.
#[test]
fn times_of_dishonest_runs_are_not_shown() {
    let header = "case,method,increments,verdict,natural_map,iterations,tangent_factorisations,local_solves,solve_s\n";
    let row = |verdict: &str, time: &str| format!("c,liar,1,{verdict},0.2,1,1,0,{time}\n");
    let text = [
        header,
        &row("false-claim", "0.00123"),
        &row("gave-up: stalled", "0.00124"),
        &row("solved", "0.00125"),
    ];
    let dir = folder(&[("comparison.csv", &text.concat())]);
    let html = page(dir.path());
    check(&html);
    assert!(
        !html.contains("0.00123") && !html.contains("0.00124"),
        "{html}"
    );
    assert!(html.contains("0.00125") && html.contains("<span class=\"v bad\">false-claim</span>"));
}

#[test]
fn the_verb_writes_the_page_or_names_what_is_wrong() {
    let dir = folder(&[("out/table1.csv", TABLE1)]);
    let run = |arguments: &[&str]| {
        let mut program = std::process::Command::new(env!("CARGO_BIN_EXE_stickslip"));
        let program = program.args(arguments).current_dir(dir.path());
        program.output().expect("it runs")
    };
    let output = run(&["show", "out"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("out/index.html: "));
    check(&fs::read_to_string(dir.path().join("out/index.html")).expect("the page"));
    fs::write(dir.path().join("out/penalty.csv"), "friction\n0.1,2\n").expect("a file");
    let output = run(&["show", "out"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("out/penalty.csv:2: 2 cells"), "{message}");
    assert_eq!(run(&["show", "nowhere"]).status.code(), Some(2));
}
