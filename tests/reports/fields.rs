//! ParaView files hold the bits that were written, and nothing that readers choke on.

use crate::report_data::{beam, crack_line, plate, results};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::collections::BTreeMap;
use std::io::Read;
use stickslip::model::field_mesh::{CellShape, FieldMesh};
use stickslip::report::{Provenance, standard, vtu};

/// Arrays of a `.vtu` file by name, decoded: base64, header, zlib blocks.
fn decoded(vtu: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let xml = std::str::from_utf8(vtu).expect("UTF-8");
    let mut arrays = BTreeMap::new();
    for element in xml.split("<DataArray ").skip(1) {
        let name = element
            .split("Name=\"")
            .nth(1)
            .and_then(|n| n.split('"').next());
        let data = element.split('>').nth(1).and_then(|d| d.split('<').next());
        let (name, data) = (name.expect("a name"), data.expect("data"));
        let number = |bytes: &[u8], i: usize| {
            u64::from_le_bytes(bytes[8 * i..8 * i + 8].try_into().expect("8 bytes")) as usize
        };
        let first = STANDARD
            .decode(&data[..32])
            .expect("the first three numbers");
        let blocks = number(&first, 0);
        let header_length = (8 * (3 + blocks)).div_ceil(3) * 4;
        let header = STANDARD.decode(&data[..header_length]).expect("a header");
        let body = STANDARD.decode(&data[header_length..]).expect("blocks");
        let mut bytes = Vec::new();
        let mut start = 0;
        for block in 0..blocks {
            let end = start + number(&header, 3 + block);
            let mut inflated = Vec::new();
            flate2::read::ZlibDecoder::new(&body[start..end])
                .read_to_end(&mut inflated)
                .expect("zlib");
            let partial = number(&header, 2);
            let expected = if block + 1 == blocks && partial > 0 {
                partial
            } else {
                number(&header, 1)
            };
            assert_eq!(inflated.len(), expected, "{name}");
            bytes.extend(inflated);
            start = end;
        }
        assert_eq!(start, body.len(), "{name}");
        arrays.insert(name.to_owned(), bytes);
    }
    arrays
}

fn as_f64(bytes: &[u8]) -> Vec<f64> {
    bytes
        .chunks(8)
        .map(|b| f64::from_le_bytes(b.try_into().expect("8 bytes")))
        .collect()
}

fn as_i64(bytes: &[u8]) -> Vec<i64> {
    bytes
        .chunks(8)
        .map(|b| i64::from_le_bytes(b.try_into().expect("8 bytes")))
        .collect()
}

#[test]
fn vtu_files_decode_to_the_bits_that_were_written() {
    for picture in [plate(), beam(), crack_line(), FieldMesh::default()] {
        let file = vtu::vtu(&picture, 0.5, "a -- b").expect("a file");
        let arrays = decoded(&file);
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let same = |name: &str, values: Vec<f64>| {
            assert_eq!(bits(&as_f64(&arrays[name])), bits(&values), "{name}");
        };
        same("TimeValue", vec![0.5]);
        same("Points", picture.points.iter().flatten().copied().collect());
        for (name, values) in &picture.point_vectors {
            same(name, values.iter().flatten().copied().collect());
        }
        for (name, values) in picture.point_scalars.iter().chain(&picture.cell_scalars) {
            same(name, values.clone());
        }
        let connectivity: Vec<i64> = picture
            .cells
            .iter()
            .flat_map(|cell| &cell.points)
            .map(|p| *p as i64)
            .collect();
        assert_eq!(as_i64(&arrays["connectivity"]), connectivity);
        assert_eq!(arrays["types"].len(), picture.cells.len());
        let end = as_i64(&arrays["offsets"]).last().copied().unwrap_or(0);
        assert_eq!(end, connectivity.len() as i64);

        let xml = String::from_utf8(file).expect("UTF-8");
        assert!(xml.contains(&format!("NumberOfPoints=\"{}\"", picture.points.len())));
        assert!(
            xml.contains("<!-- a - - b -->"),
            "two hyphens end a comment"
        );
        assert!(
            !xml.contains("type=\"String\""),
            "meshio ends the process on those"
        );
    }
}

#[test]
fn large_arrays_span_several_blocks() {
    let mut picture = FieldMesh {
        dim: 2,
        ..FieldMesh::default()
    };
    picture.points = (0..4096).map(|i| [f64::from(i), 0.5, -1.0]).collect();
    let arrays = decoded(&vtu::vtu(&picture, 0.0, "").expect("a file"));
    let points: Vec<f64> = picture.points.iter().flatten().copied().collect();
    assert_eq!(as_f64(&arrays["Points"]), points);
    assert_eq!(
        arrays["Points"].len(),
        3 * 32768,
        "whole blocks only, the case without a partial one"
    );
}

#[test]
fn vtu_refuses_arrays_that_do_not_fit() {
    let mut short = plate();
    short.point_scalars[0].1.pop();
    let error = vtu::vtu(&short, 0.0, "").expect_err("a value is missing");
    assert!(
        error
            .to_string()
            .contains("`side`: 539 values for 540 points"),
        "{error}"
    );
    let mut far = plate();
    far.cells[7].points[0] = 9999;
    assert!(vtu::vtu(&far, 0.0, "").is_err());
    let mut wrong = plate();
    wrong.cells[0].shape = CellShape::Hexahedron;
    assert!(vtu::vtu(&wrong, 0.0, "").is_err());
}

#[test]
fn collections_name_files_that_exist() {
    let results = results();
    let bundle = standard::bundle(&results, &Provenance::collect(1)).expect("a bundle");
    let pvd = bundle
        .paths()
        .find(|path| path.ends_with(".pvd"))
        .expect("a collection")
        .to_owned();
    let xml = String::from_utf8(bundle.get(&pvd).expect("a file").to_vec()).expect("UTF-8");
    let files: Vec<&str> = xml
        .split("file=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .collect();
    assert_eq!(files.len(), 4, "body and crack at two times");
    for file in files {
        assert!(bundle.get(&format!("fields/{file}")).is_some(), "{file}");
    }
    assert!(xml.contains("timestep=\"0.5\" part=\"1\""));
}
