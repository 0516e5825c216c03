//! ParaView files: `.vtu` (VTK XML unstructured grid) and `.pvd` (collection over increments).
//!
//! Arrays are inline binary: zlib blocks in base64 with 64-bit headers, little endian. Points and fields are Float64,
//! connectivity Int64. There are no string arrays (meshio ends the whole process on one); the origin stands in an XML
//! comment, the time in a numeric `TimeValue`. Format: VTK file formats, <https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>.

use super::{Bundle, ReportError};
use crate::model::field_mesh::{CellShape, FieldCell, FieldMesh};
use crate::studies::rows::RunFields;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::fmt::Write as _;
use std::io::Write as _;

/// Uncompressed size of a zlib block [bytes], VTK's default.
const BLOCK: usize = 1 << 15;

/// The contents of a `.vtu` file.
///
/// `comment` tells the origin (no `--` inside: it is replaced); `time` becomes `TimeValue`.
///
/// # Errors
/// [`ReportError::FieldMesh`] where an array does not fit the points or cells.
pub fn vtu(picture: &FieldMesh, time: f64, comment: &str) -> Result<Vec<u8>, ReportError> {
    check(picture)?;
    let mut xml = String::from("<?xml version=\"1.0\"?>\n");
    let comment = comment.replace("--", "- -");
    // A comment must not end in a hyphen either; the space before its end sees to that.
    let _ = writeln!(xml, "<!-- {comment} -->");
    xml += "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
            header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n";
    xml += "<FieldData>\n";
    floats(&mut xml, "TimeValue", "NumberOfTuples=\"1\"", [time])?;
    xml += "</FieldData>\n";
    let _ = writeln!(
        xml,
        "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">",
        picture.points.len(),
        picture.cells.len()
    );

    const VECTOR: &str = "NumberOfComponents=\"3\"";
    xml += "<PointData>\n";
    for (name, values) in &picture.point_vectors {
        floats(&mut xml, name, VECTOR, values.iter().flatten().copied())?;
    }
    for (name, values) in &picture.point_scalars {
        floats(&mut xml, name, "", values.iter().copied())?;
    }
    xml += "</PointData>\n<CellData>\n";
    for (name, values) in &picture.cell_scalars {
        floats(&mut xml, name, "", values.iter().copied())?;
    }
    xml += "</CellData>\n<Points>\n";
    let coordinates = picture.points.iter().flatten().copied();
    floats(&mut xml, "Points", VECTOR, coordinates)?;

    xml += "</Points>\n<Cells>\n";
    let connectivity = i64_bytes(picture.cells.iter().flat_map(|cell| &cell.points).copied());
    let mut end = 0;
    let offsets = i64_bytes(picture.cells.iter().map(|cell| {
        end += cell.points.len();
        end
    }));
    let types: Vec<u8> = picture.cells.iter().map(|c| vtk(c.shape).0).collect();
    data_array(&mut xml, "Int64", "connectivity", "", &connectivity)?;
    data_array(&mut xml, "Int64", "offsets", "", &offsets)?;
    data_array(&mut xml, "UInt8", "types", "", &types)?;
    xml += "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    Ok(xml.into_bytes())
}

/// Adds the fields of one run as `<folder>/<stem>.body.0001.vtu`, `….crack.0001.vtu`, … and the collection
/// `<folder>/<stem>.pvd` with the body as part 0 and the crack as part 1. An empty crack picture gives no file.
///
/// # Errors
/// Those of [`vtu`] and [`Bundle::add`].
pub fn add_fields(
    bundle: &mut Bundle,
    folder: &str,
    stem: &str,
    fields: &RunFields<'_>,
    comment: &str,
) -> Result<(), ReportError> {
    let mut collection = Vec::new();
    for (number, step) in fields.steps.iter().enumerate() {
        let parts = [("body", &step.body), ("crack", &step.crack)];
        for (part, (name, picture)) in parts.into_iter().enumerate() {
            if picture.points.is_empty() {
                continue;
            }
            let file = format!("{stem}.{name}.{:04}.vtu", number + 1);
            bundle.add(
                format!("{folder}/{file}"),
                vtu(picture, step.time, comment)?,
            )?;
            collection.push(PvdEntry {
                time: step.time,
                part,
                file,
            });
        }
    }
    Ok(bundle.add(format!("{folder}/{stem}.pvd"), pvd(&collection, comment))?)
}

/// One data set of a `.pvd` collection.
#[derive(Debug, Clone, PartialEq)]
pub struct PvdEntry {
    /// Time of the increment.
    pub time: f64,
    /// Part: 0 body, 1 crack.
    pub part: usize,
    /// File name relative to the collection.
    pub file: String,
}

/// The contents of a `.pvd` file.
pub fn pvd(entries: &[PvdEntry], comment: &str) -> String {
    let comment = comment.replace("--", "- -");
    let mut xml = format!("<?xml version=\"1.0\"?>\n<!-- {comment} -->\n");
    xml +=
        "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
    for PvdEntry { time, part, file } in entries {
        let time = super::number::value(*time);
        let file = attribute(file);
        let _ = writeln!(
            xml,
            "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{file}\"/>"
        );
    }
    xml += "</Collection>\n</VTKFile>\n";
    xml
}

fn check(picture: &FieldMesh) -> Result<(), ReportError> {
    let points = picture.points.len();
    let cells = picture.cells.len();
    let vectors = picture
        .point_vectors
        .iter()
        .map(|(n, v)| (n, v.len(), points, "points"));
    let scalars = picture
        .point_scalars
        .iter()
        .map(|(n, v)| (n, v.len(), points, "points"));
    let of_cells = picture
        .cell_scalars
        .iter()
        .map(|(n, v)| (n, v.len(), cells, "cells"));
    for (name, found, expected, what) in vectors.chain(scalars).chain(of_cells) {
        if found != expected {
            return Err(ReportError::FieldMesh {
                name: name.clone(),
                reason: format!("{found} values for {expected} {what}"),
            });
        }
    }
    for (index, cell) in picture.cells.iter().enumerate() {
        let reason = match cell.points.iter().find(|p| **p >= points) {
            Some(point) => format!("cell {index} names point {point} of {points}"),
            None if !fits(cell) => {
                let (shape, points) = (cell.shape, cell.points.len());
                format!("cell {index} is a {shape:?} of {points} points")
            }
            None => continue,
        };
        return Err(ReportError::FieldMesh {
            name: "cells".into(),
            reason,
        });
    }
    Ok(())
}

fn fits(cell: &FieldCell) -> bool {
    let points = cell.points.len();
    vtk(cell.shape).1.map_or(points >= 3, |own| points == own)
}

/// Number of a shape in VTK, and of its points; none: three or more.
fn vtk(shape: CellShape) -> (u8, Option<usize>) {
    match shape {
        CellShape::Vertex => (1, Some(1)),
        CellShape::Line => (3, Some(2)),
        CellShape::Triangle => (5, Some(3)),
        CellShape::Polygon => (7, None),
        CellShape::Quad => (9, Some(4)),
        CellShape::Tetra => (10, Some(4)),
        CellShape::Hexahedron => (12, Some(8)),
    }
}

fn floats(
    xml: &mut String,
    name: &str,
    more: &str,
    values: impl IntoIterator<Item = f64>,
) -> Result<(), ReportError> {
    let bytes: Vec<u8> = values.into_iter().flat_map(f64::to_le_bytes).collect();
    data_array(xml, "Float64", name, more, &bytes)
}

fn data_array(
    xml: &mut String,
    kind: &str,
    name: &str,
    more: &str,
    bytes: &[u8],
) -> Result<(), ReportError> {
    let name = attribute(name);
    let encoded = encode(bytes).map_err(|e| ReportError::FieldMesh {
        name: name.clone(),
        reason: e.to_string(),
    })?;
    let _ = writeln!(
        xml,
        "<DataArray type=\"{kind}\" Name=\"{name}\" {more} format=\"binary\">{encoded}</DataArray>"
    );
    Ok(())
}

/// Header (number of blocks, block size, size of a partial last block or 0, compressed sizes), then the blocks.
fn encode(bytes: &[u8]) -> std::io::Result<String> {
    let mut header = vec![
        bytes.len().div_ceil(BLOCK) as u64,
        BLOCK as u64,
        (bytes.len() % BLOCK) as u64,
    ];
    let mut body = Vec::new();
    for block in bytes.chunks(BLOCK) {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(block)?;
        let compressed = encoder.finish()?;
        header.push(compressed.len() as u64);
        body.extend(compressed);
    }
    let header: Vec<u8> = header.into_iter().flat_map(u64::to_le_bytes).collect();
    // Header and body are two base64 texts, each padded on its own.
    Ok(STANDARD.encode(header) + &STANDARD.encode(body))
}

fn i64_bytes(values: impl IntoIterator<Item = usize>) -> Vec<u8> {
    values
        .into_iter()
        .flat_map(|v| (v as i64).to_le_bytes())
        .collect()
}

fn attribute(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
