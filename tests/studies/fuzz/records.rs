//! Records of a study: no changed byte is believed, and one who seals again what he changed gets a record or an error.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use stickslip::studies::sweep::store::{Store, sealed};
use stickslip_xfem::mesh::stream::Stream;

use super::bytes::{Kind, changed};
use super::{assert_clear, campaign};

/// Times and memory of a cell, in place of measured ones: inputs are to be the same every time.
const SPENT: &str = "{\n    \"setup_s\": 0.1,\n    \"assembly_s\": 0.2,\n    \"factorisation_s\": 0.3,\n    \"condensation_s\": 0.4,\n    \
                     \"prepare\": {\"median_s\": 2e-3, \"min_s\": 1e-3, \"low_s\": 1e-3, \"high_s\": 3e-3, \"samples\": 2},\n    \
                     \"solve\": {\"median_s\": 2e-3, \"min_s\": 1e-3, \"low_s\": 1e-3, \"high_s\": 3e-3, \"samples\": 2},\n    \
                     \"enforcement\": {\"median_s\": 2e-3, \"min_s\": 1e-3, \"low_s\": 1e-3, \"high_s\": 3e-3, \"samples\": 2},\n    \
                     \"output_s\": 0.5,\n    \"peak_mb\": 20.5\n  }";

/// A study of two cells: its folder, and the files in it.
fn study() -> (tempfile::TempDir, [PathBuf; 3]) {
    let dir = tempfile::tempdir().unwrap();
    let sweep = "title = \"t\"\nrepeats = { least = 1, most = 2, seconds = 0.0 }\n[[cells]]\ncases = [\"plate_mesh1\"]\n\
                 refine = [1]\nfriction = [0.1]\nmethods = [\"b-newton\", \"penalty\"]\ntolerances = [1e-6]\n";
    fs::write(dir.path().join("sweep.toml"), sweep).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    program.args(["study", "sweep.toml", "--out", "out", "--untimed"]);
    let output = program.current_dir(dir.path()).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let out = dir.path().join("out");
    let mut cells: Vec<PathBuf> = fs::read_dir(out.join("cells"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    cells.sort();
    for cell in &cells {
        let text = fs::read_to_string(cell).unwrap();
        assert_eq!(text.matches("\"spent\": null").count(), 1);
        let timed = text.replace("\"spent\": null", &format!("\"spent\": {SPENT}"));
        fs::write(cell, sealed(&timed)).unwrap();
    }
    assert!(believed(&out, &cells[0]));
    let [one, two] = cells.try_into().expect("two cells");
    (dir, [out.join("sweep.json"), one, two])
}

fn draw(seeds: &[Vec<u8>], stream: &mut Stream) -> Vec<u8> {
    // Which file it is to stand for, then its contents.
    let file = stream.whole(0, 2) as u8;
    let own = [vec![file], changed(seeds, Kind::Text, stream)];
    own.concat()
}

/// Reads a folder with one file changed; true if all of it was believed.
fn believed(out: &Path, file: &Path) -> bool {
    let records = Store::open(out).and_then(|store| store.records());
    match records {
        Ok(records) => {
            assert!(records.iter().all(|record| record.id == record.cell.id()));
            true
        }
        Err(error) => {
            let name = file.file_name().unwrap().to_str().unwrap();
            let message = error.to_string();
            assert!(
                message.contains(name) || message.contains("sweep.json"),
                "{message}"
            );
            assert_clear(&message, "", 1);
            false
        }
    }
}

#[test]
fn no_changed_byte_of_a_record_is_believed() {
    let (dir, files) = study();
    let seeds: Vec<Vec<u8>> = files.iter().map(|file| fs::read(file).unwrap()).collect();
    let originals = seeds.clone();
    let draw = move |stream: &mut Stream| draw(&seeds, stream);
    let read = move |input: &[u8]| {
        let file = usize::from(input[0]);
        fs::write(&files[file], &input[1..]).unwrap();
        let taken = believed(&dir.path().join("out"), &files[file]);
        assert_eq!(taken, input[1..] == originals[file], "changed and believed");
        fs::write(&files[file], &originals[file]).unwrap();
        taken
    };
    campaign::run("records", 250, draw, read);
}

#[test]
fn what_is_sealed_again_is_a_record_or_refused() {
    let (dir, files) = study();
    let seeds: Vec<Vec<u8>> = files.iter().map(|file| fs::read(file).unwrap()).collect();
    let originals = seeds.clone();
    let draw = move |stream: &mut Stream| draw(&seeds, stream);
    let read = move |input: &[u8]| {
        let file = usize::from(input[0]);
        let text = String::from_utf8_lossy(&input[1..]);
        fs::write(&files[file], sealed(&text)).unwrap();
        let taken = believed(&dir.path().join("out"), &files[file]);
        fs::write(&files[file], &originals[file]).unwrap();
        taken
    };
    campaign::run("records sealed again", 250, draw, read);
}
