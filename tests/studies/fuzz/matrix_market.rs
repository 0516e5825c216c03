//! MatrixMarket files: their bytes, and entries of any sizes below a proper banner.

use std::path::Path;

use stickslip::files::interchange::{SparseMatrix, matrix_market};
use stickslip_xfem::mesh::stream::Stream;

use super::bytes::{Kind, changed};
use super::{assert_clear, campaign};

/// Files as the program writes them, and others that it reads.
fn seeds() -> Vec<Vec<u8>> {
    let entries = [
        (0, 0, 4.0),
        (1, 0, 1.0),
        (0, 1, 1.0),
        (1, 1, 3.0),
        (3, 2, -2.5e-300),
    ];
    let matrix = SparseMatrix::from_triplets(4, 4, entries).unwrap();
    let general = matrix_market::general(&matrix);
    let commented = general.replacen('\n', "\n% a comment\n\n", 1);
    let whole = "%%MatrixMarket matrix coordinate integer symmetric\n3 3 2\n1 1 7\n3 2 -1\n";
    let array = "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n";
    let texts = [
        general,
        commented,
        matrix_market::symmetric(&matrix),
        matrix_market::vector(&[0.1, -1e300, 0.0, 5e-324, 1.0 / 3.0]),
        whole.to_owned(),
        array.to_owned(),
    ];
    texts.map(String::into_bytes).to_vec()
}

fn read(bytes: &[u8]) -> bool {
    // Bytes that are no text are the affair of who reads the file, see `devices`.
    let text = String::from_utf8_lossy(bytes);
    match matrix_market::parse(Path::new("fuzz.mtx"), &text) {
        Ok(matrix) => {
            assert!(matrix.entries().all(|e| e.2.is_finite()));
            assert_eq!(matrix.transposed().transposed(), matrix);
            true
        }
        Err(error) => {
            assert_clear(&error.to_string(), "`fuzz.mtx`, line ", 1);
            false
        }
    }
}

#[test]
fn any_text_is_a_matrix_or_refused_at_its_line() {
    let seeds = seeds();
    let draw = move |stream: &mut _| changed(&seeds, Kind::Text, stream);
    campaign::run("MatrixMarket bytes", 5000, draw, read);
}

/// A size or an index.
fn whole(stream: &mut Stream) -> String {
    match stream.whole(0, 30) {
        0 => "18446744073709551615".into(),
        1 => "1000000000000".into(),
        2 => "-1".into(),
        3 => (1u64 << stream.whole(0, 63)).to_string(),
        _ => stream.whole(0, 4).to_string(),
    }
}

fn entries(stream: &mut Stream) -> Vec<u8> {
    let array = stream.chance(0.4);
    let kind = if array { "array" } else { "coordinate" };
    let symmetry = if stream.chance(0.3) {
        "symmetric"
    } else {
        "general"
    };
    let (rows, cols) = (whole(stream), whole(stream));
    let size = |text: &str| text.parse::<u64>().unwrap_or(0);
    let full = size(&rows).saturating_mul(size(&cols)).min(16);
    let lines = if array {
        full
    } else {
        stream.whole(0, 6) as u64
    };
    let mut text = format!("%%MatrixMarket matrix {kind} real {symmetry}\n{rows} {cols}");
    if !array {
        let promised = if stream.chance(0.9) {
            lines.to_string()
        } else {
            whole(stream)
        };
        text += &format!(" {promised}");
    }
    for _ in 0..lines {
        let value = ["1", "-2.5e-3", "1.7e308", "-1.7e308", "nan", "1e309"][if stream.chance(0.95) {
            stream.whole(0, 3)
        } else {
            5
        }];
        text += &match array {
            true => format!("\n{value}"),
            false => format!("\n{} {} {value}", whole(stream), whole(stream)),
        };
    }
    (text + "\n").into_bytes()
}

#[test]
fn any_sizes_and_entries_are_a_matrix_or_refused_at_their_line() {
    campaign::run("MatrixMarket entries", 5000, entries, read);
}
