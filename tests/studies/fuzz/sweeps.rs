//! Sweep files, up to the random problems that they ask for: drawing those is work, and not the reader's.

use stickslip::studies::sweep::plan::Outline;

use super::bytes::{Kind, changed};
use super::{assert_clear, campaign};

/// Sweeps of few cells.
const SEEDS: [&str; 4] = [
    "title = \"Methods on two cases\"\nrepeats = { least = 7, most = 200, seconds = 0.05, patience_s = 2.0 }\n\n\
     [[cells]]\ncases = [\"plate_mesh1\", \"cyclic\"]\nrefine = [1, 2]\ncontact = [\"star\", \"edge-pairs\"]\n\
     friction = [0.1, 0.8]\nmethods = [\"hybrid\", \"penalty:normal=1e2,tangential=1e2\"]\n\
     tolerances = [1e-3, 1e-6, 1e-9]\n",
    "title = \"t\"\n[[cells]]\ncases = [\"cyclic\"]\n",
    "title = \"Random\"\n[[cells]]\nrandom = { dimension = 2, seed = 1, problems = 1 }\nmethods = [\"nsgs\"]\n\
     tolerances = [1e-6]\n[[cells]]\ncases = [\"beside.toml\", \"tension_open\"]\nmethods = [\"latin\"]\n",
    "title = \"Two hundred cells\"\nrepeats = { least = 1, most = 2, seconds = 0.0 }\n\n[[cells]]\n\
     cases = [\"plate_mesh1\"]\nrefine = [1]\nfriction = [0.1]\nmethods = [\"b-newton\", \"latin\"]\n\
     tolerances = [1e-2, 6.3e-3, 4e-3]\n",
];

#[test]
fn any_bytes_are_a_sweep_or_refused_at_line_and_column() {
    let dir = tempfile::tempdir().unwrap();
    let beside = std::fs::read(super::folder("cases/cyclic.toml")).unwrap();
    std::fs::write(dir.path().join("beside.toml"), beside).unwrap();
    let file = dir.path().join("sweep.toml");
    let seeds: Vec<Vec<u8>> = SEEDS.map(|text| text.as_bytes().to_vec()).to_vec();
    let draw = move |stream: &mut _| changed(&seeds, Kind::Text, stream);
    let read = move |bytes: &[u8]| {
        std::fs::write(&file, bytes).unwrap();
        match Outline::read(&file) {
            Ok(outline) if outline.problems() > 4 => true,
            Ok(outline) => {
                let plan = outline.draw().unwrap();
                let ids: Vec<&str> = plan.tasks.iter().map(|task| &*task.id).collect();
                assert!(!ids.is_empty() && ids.is_sorted_by(|a, b| a < b));
                let safe = |c: char| c.is_ascii_alphanumeric() || ".-_=".contains(c);
                assert!(ids.iter().all(|id| id.chars().all(safe)), "{ids:?}");
                assert!(!plan.title.chars().any(char::is_control));
                true
            }
            Err(error) => {
                // A case that does not exist has no place in itself.
                let begins = match error.line() {
                    0 => dir.path().display().to_string(),
                    line => format!("{}:{line}:{}: ", error.file().display(), error.column()),
                };
                assert_clear(&error.to_string(), &begins, 3);
                false
            }
        }
    };
    campaign::run("sweep", 250, draw, read);
}
