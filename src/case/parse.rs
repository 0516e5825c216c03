//! From a file to a checked [`Case`].

use std::fmt::Display;
use std::path::{Path, PathBuf};

use stickslip_methods::Tier;
use stickslip_xfem::exact::{SOLUTIONS, SolutionSpec};
use stickslip_xfem::geometry::Point;
use stickslip_xfem::material::{Dilatation, Lame, Material, Model};
use stickslip_xfem::quadrature::Quadrature;

use super::crack::{CrackSpec, crack};
use super::error::{CaseError, SHOWN, Source, Span, parsed};
use super::exact::{ExactSpec, exact};
use super::expect::{Expect, ProbeSpec, Runs};
use super::load::{LoadSpec, Scene, SupportSpec, load, support};
use super::mesh::{MeshSpec, Sweep, mesh, sweep};
use super::reader::{Table, Value};
use super::settings::{self, MethodSpec, PathSpec, Target};
use crate::files::regular;
use crate::files::visible::visible;

/// One checked case file.
#[derive(Debug, Clone)]
pub struct Case {
    /// File stem, the identifier in every table.
    pub name: String,
    /// File as given on the command line.
    pub file: PathBuf,
    /// Full text of the file; spans index into it.
    pub source: String,
    /// One-line title.
    pub title: String,
    /// Kinematics: plane strain, plane stress or a 3D solid.
    pub model: Model,
    /// Isotropic linear elasticity.
    pub material: Material,
    /// The dilatation of the stress of the gradient, which the file forces in every cell.
    pub dilatation: Option<Dilatation>,
    /// Origin of the frame of the body in the coordinates of the file [m]: mesh, cracks, loads and probes are in this frame.
    pub origin: Point,
    /// Structured mesh.
    pub mesh: MeshSpec,
    /// Cracks, in file order.
    pub cracks: Vec<CrackSpec>,
    /// Prescribed displacements, in file order; at a node and component named twice the later one wins.
    pub supports: Vec<SupportSpec>,
    /// Loads, in file order; they add up.
    pub loads: Vec<LoadSpec>,
    /// The closed form the case has, if it names one.
    pub exact: Option<ExactSpec>,
    /// Quadrature of cut cells.
    pub quadrature: Quadrature,
    /// Load path.
    pub path: PathSpec,
    /// Purpose of the runs of the case.
    pub sweep: Sweep,
    /// Methods the case runs when the command line names none: (registry name, options as `key=value` pairs).
    pub methods: Vec<MethodSpec>,
    /// Accuracy of the case.
    pub target: Target,
    /// Violation the methods must reach, at most that of the tier; tighter where a closed form is held to more digits.
    pub tolerance: f64,
    /// Named places whose displacement is recorded.
    pub probes: Vec<ProbeSpec>,
    /// Numbers the case must reproduce.
    pub expects: Vec<Expect>,
}

impl Case {
    /// Lamé constants of material and model, with the stress that the file forces.
    pub fn lame(&self) -> Lame {
        let lame = Lame::new(self.material, self.model);
        Lame {
            assumed: self.dilatation.is_none(),
            dilatation: self.dilatation.unwrap_or(lame.dilatation),
            ..lame
        }
    }

    /// The source text at a span, for error messages.
    pub fn text(&self, span: &Span) -> &str {
        self.source.get(span.clone()).unwrap_or_default()
    }

    /// As [`error`](Self::error), with the value as it stands in the file.
    pub fn refuse(&self, span: &Span, allowed: impl Display, message: impl Display) -> CaseError {
        self.error(span, self.text(span), allowed, message)
    }

    /// Error about the value at `span`, found later than by the parser (e.g. a crack wholly outside the mesh).
    ///
    /// `value` is what was found, `allowed` what would be accepted; key, line and column follow from the span.
    pub fn error(
        &self,
        span: &Span,
        value: impl Display,
        allowed: impl Display,
        message: impl Display,
    ) -> CaseError {
        Source {
            file: &self.file,
            text: &self.source,
        }
        .error(span, value, allowed, message)
    }
}

/// Largest case file read [bytes]; the largest of this project has 8 kB.
const MAX_BYTES: u64 = 1 << 20;

/// Longest name of a case [bytes]: files of its results have longer ones, and file systems take 255.
const MAX_NAME: usize = 120;

/// Keys of the document itself.
const KEYS: [&str; 16] = [
    "title",
    "model",
    "quadrature",
    "tier",
    "tolerance",
    "material",
    "mesh",
    "crack",
    "support",
    "load",
    "exact",
    "path",
    "sweep",
    "method",
    "probe",
    "expect",
];

/// Reads and checks a case file; the file stem becomes the name of the case.
///
/// # Errors
/// All faults that do not follow from each other, of a table the first, with their places: a file that cannot be read, is
/// larger than 1 MiB or not UTF-8, text that is not TOML, unknown or missing keys, wrong types, numbers that are not finite or out of range, contradictions.
pub fn read(path: impl AsRef<Path>) -> Result<Case, CaseError> {
    let path = path.as_ref();
    parse(path, read_text(path)?)
}

/// The text of a file.
pub(crate) fn read_text(path: &Path) -> Result<String, CaseError> {
    let unreadable = |e: std::io::Error| {
        CaseError::unreadable(path, e, "a readable TOML file", "cannot be read")
    };
    let (file, len) = regular::open(path).map_err(unreadable)?;
    if len > MAX_BYTES {
        return Err(too_large(path, &format!("{len} bytes")));
    }
    let bytes = regular::rest(file, MAX_BYTES).map_err(unreadable)?;
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(e.as_bytes());
        let value = format!("byte 0x{:02X}", e.as_bytes()[at]);
        // The text before the first bad byte is unchanged, so its place is the same in the repaired text.
        let source = Source {
            file: path,
            text: &text,
        };
        source.error(&(at..at + 1), value, "UTF-8 text", "not a text file")
    })
}

fn too_large(path: &Path, size: &str) -> CaseError {
    let source = Source {
        file: path,
        text: "",
    };
    source.error(
        &(0..0),
        size,
        format_args!("at most {MAX_BYTES} bytes"),
        "file too large for a case",
    )
}

/// Checks the text of a case file; `file` names it in messages and gives the case its name.
///
/// # Errors
/// As for [`read`], from the size on.
pub fn parse(file: impl Into<PathBuf>, source: impl Into<String>) -> Result<Case, CaseError> {
    parse_with(file, source, SOLUTIONS)
}

/// As [`parse`], with closed forms of one's own instead of [`SOLUTIONS`].
///
/// # Errors
/// As for [`parse`].
pub fn parse_with(
    file: impl Into<PathBuf>,
    source: impl Into<String>,
    solutions: &'static [SolutionSpec],
) -> Result<Case, CaseError> {
    let (file, text): (PathBuf, String) = (file.into(), source.into());
    if text.len() as u64 > MAX_BYTES {
        return Err(too_large(&file, &format!("{} bytes", text.len())));
    }
    let document = document(&file, &text, &KEYS, |root| read_document(root, solutions))?;
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    if stem.len() > MAX_NAME {
        let source = Source {
            file: &file,
            text: "",
        };
        let size = format!("{} bytes", stem.len());
        let allowed = format!("at most {MAX_NAME} bytes");
        return Err(source.error(&(0..0), size, allowed, "file name too long for a case"));
    }
    let name = visible(&stem);
    Ok(Case {
        name,
        file,
        source: text,
        ..document
    })
}

/// Reads a TOML document with the given top-level keys.
///
/// # Errors
/// Text that is not TOML, other keys, and those of `read`.
pub(crate) fn document<T>(
    file: &Path,
    text: &str,
    keys: &[&str],
    read: impl FnOnce(&Table<'_>) -> Result<T, CaseError>,
) -> Result<T, CaseError> {
    let source = Source { file, text };
    let parsed = parsed(text).map_err(|e| syntax_error(source, &e))?;
    read(&Table::root(source, parsed.get_ref(), keys)?)
}

/// Everything the document says; name, file and source are filled in by the caller.
fn read_document(root: &Table<'_>, solutions: &'static [SolutionSpec]) -> Result<Case, CaseError> {
    let model = root.required("model")?.one_of(&[
        ("plane-strain", Model::PlaneStrain),
        ("plane-stress", Model::PlaneStress),
        ("solid", Model::Solid),
    ])?;
    let dim = model.dim();
    let scene = Scene {
        dim,
        cracks: root.tables("crack")?.len(),
        exact: root.get("exact").is_some(),
    };
    // What does not build on a fault is read all the same, so that all faults are told at once.
    let title = root.required("title").and_then(|v| v.label());
    let accuracy = accuracy(root);
    let quadrature = settings::quadrature(root);
    let material = settings::material(root, model);
    let mesh = mesh(root, dim);
    let on_mesh = mesh.as_ref().map_err(Clone::clone);
    let sweep = on_mesh.and_then(|mesh| sweep(root, mesh));
    let path = settings::path(root);
    let cracks = each(root, "crack", |v| crack(v, dim));
    let exact = exact(root, solutions, scene.cracks);
    let supports = each(root, "support", |v| support(v, &scene));
    let loads = each(root, "load", |v| load(v, &scene));
    let methods = each(root, "method", settings::method);
    let faults = [
        fault(&title),
        fault(&accuracy),
        fault(&quadrature),
        fault(&material),
        fault(&mesh),
        fault(&sweep),
        fault(&path),
        fault(&cracks),
        fault(&exact),
        fault(&supports),
        fault(&loads),
        fault(&methods),
    ];
    CaseError::all(faults.into_iter().flatten())?;
    let (sweep, path, cracks) = (sweep?, path?, cracks?);
    let ((target, tolerance), (material, dilatation)) = (accuracy?, material?);
    let frictions: Vec<f64> = cracks.iter().map(|c| c.friction).collect();
    let mut runs = Runs::new(dim, &frictions, &sweep, &path);
    let case = Case {
        name: String::new(),
        file: PathBuf::new(),
        source: String::new(),
        title: title?,
        model,
        material,
        dilatation,
        origin: [0.0; 3],
        mesh: mesh?,
        cracks,
        supports: supports?,
        loads: loads?,
        exact: exact?,
        quadrature: quadrature?,
        path,
        sweep,
        methods: methods?,
        target,
        tolerance,
        probes: each(root, "probe", |v| runs.probe(v, dim))?,
        expects: each(root, "expect", |v| runs.expect(v))?,
    };
    // Runs that differ in nothing would write files of one name.
    let swept = case.cracks.is_empty() && !case.sweep.friction.is_empty();
    if let (true, Some(value)) = (swept, root.get("sweep")) {
        return Err(value.refuse("friction only beside cracks", "friction of no crack"));
    }
    Ok(case.in_frame())
}

/// `tier` and `tolerance`.
fn accuracy(root: &Table<'_>) -> Result<(Target, f64), CaseError> {
    let target = root
        .get("tier")
        .map_or(Ok(Target::Tier(Tier::High)), |v| v.one_of(&Target::ALL))?;
    let largest = target.tier().tolerance();
    let tolerance = root.get("tolerance").map_or(Ok(largest), |v| {
        let allowed = format!("1e-14 <= tolerance <= {largest:e}, that of the tier");
        v.number_if(&allowed, |t| (1e-14..=largest).contains(&t))
    })?;
    Ok((target, tolerance))
}

/// What is wrong with it, if anything.
pub(crate) fn fault<T>(read: &Result<T, CaseError>) -> Option<CaseError> {
    read.as_ref().err().cloned()
}

/// Tables of an array of tables, in file order.
fn each<T>(
    root: &Table<'_>,
    key: &str,
    read: impl FnMut(Value<'_>) -> Result<T, CaseError>,
) -> Result<Vec<T>, CaseError> {
    faultless(root.tables(key)?.into_iter().map(read))
}

/// What was read, or its faults, of very many the first.
pub(crate) fn faultless<T>(
    read: impl IntoIterator<Item = Result<T, CaseError>>,
) -> Result<Vec<T>, CaseError> {
    let (mut good, mut faults) = (Vec::new(), Vec::new());
    for own in read {
        match own {
            Ok(own) => good.push(own),
            Err(fault) => faults.push(fault),
        }
        if faults.len() > SHOWN + 1 {
            break;
        }
    }
    CaseError::all(faults).map(|()| good)
}

/// Splits the parser's `what, expected this` into message and allowed text.
fn syntax_error(source: Source<'_>, error: &toml::de::Error) -> CaseError {
    let end = source.text.len();
    let span = error.span().unwrap_or(end..end);
    let (message, allowed) = error
        .message()
        .split_once(", expected ")
        .unwrap_or((error.message(), "valid TOML"));
    let found = source.slice(&span);
    let value = if found.is_empty() {
        "end of line or file"
    } else {
        found
    };
    source.error(
        &span,
        value,
        allowed,
        format_args!("not valid TOML: {message}"),
    )
}
