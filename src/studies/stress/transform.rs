//! Changes of a case that leave its answer as it is: other units, another place, other names of sides, sides of cracks and axes.
//!
//! They act on the text, so that everything the program does with it is under test.

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::uniform::{lines, number, numbers, set_lines, sides};

/// A change of a case.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Transform {
    /// Every place moved along the diagonal by so many sizes of the body.
    Shift(f64),
    /// Lengths in another unit, as many times as long.
    Length(f64),
    /// Stresses in another unit.
    Stress(f64),
    /// x to −x: sides left and right change their names.
    Mirror,
    /// x and y change places: nodes and cells are numbered another way.
    Swap,
    /// Every crack runs the other way, or its normal points the other way: its faces change their names.
    Reverse,
    /// The last crack first.
    Order,
}

/// Powers of two, by which numbers are multiplied without rounding.
const TWO_20: f64 = (1u64 << 20) as f64;
const TWO_30: f64 = (1u64 << 30) as f64;

/// Lists of coordinates in `[[crack]]`, and lengths without a place.
const PLACES: [&str; 3] = ["points_m", "centre_m", "point_m"];
const LENGTHS: [&str; 3] = ["radius_m", "half_axes_m", "branch_radius_m"];

impl Transform {
    /// All that are tried.
    pub const ALL: [Self; 11] = [
        Self::Length(TWO_20),
        Self::Length(1.0 / TWO_20),
        Self::Stress(1.0 / TWO_30),
        Self::Shift(10.0),
        Self::Shift(1e3),
        Self::Length(39.37),
        Self::Stress(145.038e-6),
        Self::Mirror,
        Self::Swap,
        Self::Reverse,
        Self::Order,
    ];

    /// As tables name it.
    pub fn name(&self) -> String {
        match self {
            Self::Shift(sizes) => format!("moved by {sizes:e} sizes"),
            Self::Length(factor) => format!("lengths times {}", times(*factor)),
            Self::Stress(factor) => format!("stresses times {}", times(*factor)),
            Self::Mirror => "mirrored".into(),
            Self::Swap => "axes x and y swapped".into(),
            Self::Reverse => "cracks reversed".into(),
            Self::Order => "cracks in another order".into(),
        }
    }

    /// The case changed; `None` where the change means nothing: one crack has one order, random moves of grid points have no
    /// mirror image.
    pub fn apply(&self, text: &str) -> Option<String> {
        let mut case: Table = text.parse().ok()?;
        let dim = lines(case.get("mesh")?.as_table()?)?.len();
        let moved = case["mesh"].get("distort").is_some();
        match self {
            Self::Mirror | Self::Swap if moved => return None,
            Self::Order if case.get("crack")?.as_array()?.len() < 2 => return None,
            Self::Reverse => each(&mut case, "crack", reverse),
            Self::Order => case.get_mut("crack")?.as_array_mut()?.reverse(),
            Self::Stress(factor) => {
                scale(case.get_mut("material")?.get_mut("young_pa")?, *factor);
                each(&mut case, "load", |load| {
                    for key in ["pressure_pa", "traction_pa"] {
                        if let Some(value) = load.get_mut(key) {
                            scale(value, *factor);
                        }
                    }
                });
            }
            _ => {
                let map = Map::of(self, &case)?;
                map.mesh(case.get_mut("mesh")?.as_table_mut()?)?;
                each(&mut case, "crack", |crack| map.crack(crack));
                each(&mut case, "support", |support| map.side(support, dim));
                each(&mut case, "load", |load| map.side(load, dim));
            }
        }
        toml::to_string(&case).ok()
    }

    /// Where the points of a case are after the change.
    pub fn places(&self, text: &str) -> Option<Map> {
        Map::of(self, &text.parse().ok()?)
    }

    /// Number of a crack after the change, from 1, of so many.
    pub fn crack(&self, number: usize, cracks: usize) -> usize {
        match self {
            Self::Order => cracks + 1 - number,
            _ => number,
        }
    }

    /// Whether every number of the case is what it was, or a power of two times that. The others round coordinates, of which
    /// a crack 1e-14 of a cell beside a node keeps little, or give sides, faces and axes other names: the program may then
    /// choose other contact points, or the other of two cells that share a tip, and the answer change by the error of the mesh.
    pub fn is_exact(&self) -> bool {
        match self {
            Self::Length(factor) | Self::Stress(factor) => factor.log2().fract() == 0.0,
            Self::Shift(_) | Self::Mirror | Self::Swap | Self::Reverse | Self::Order => false,
        }
    }

    /// Factor of energies; in 2D they are per length.
    pub fn energy(&self, dim: usize) -> f64 {
        self.force(dim) * self.length()
    }

    /// Factor of contact forces; in 2D they are per length.
    pub fn force(&self, dim: usize) -> f64 {
        match self {
            Self::Length(factor) => factor.powi(dim as i32 - 1),
            Self::Stress(factor) => *factor,
            _ => 1.0,
        }
    }

    /// Factor of lengths.
    pub fn length(&self) -> f64 {
        match self {
            Self::Length(factor) => *factor,
            _ => 1.0,
        }
    }
}

fn times(factor: f64) -> String {
    match factor.log2() {
        power if power.fract() == 0.0 => format!("2^{power}"),
        _ => format!("{factor}"),
    }
}

/// x' = factor R x + shift, R a reflection.
pub struct Map {
    dim: usize,
    factor: f64,
    shift: f64,
    mirror: bool,
    swap: bool,
}

impl Map {
    fn of(transform: &Transform, case: &Table) -> Option<Self> {
        let lines = lines(case.get("mesh")?.as_table()?)?;
        let size = |l: &Vec<f64>| l[l.len() - 1] - l[0];
        let largest = lines.iter().map(size).fold(0.0, f64::max);
        Some(Map {
            dim: lines.len(),
            factor: transform.length(),
            shift: match transform {
                Transform::Shift(sizes) => sizes * largest,
                _ => 0.0,
            },
            mirror: *transform == Transform::Mirror,
            swap: *transform == Transform::Swap,
        })
    }

    /// Where a contact point is; z is 0 in 2D.
    pub fn point(&self, x: [f64; 3]) -> [f64; 3] {
        let mut found = [0.0; 3];
        found[..self.dim].copy_from_slice(&self.place(&x[..self.dim]));
        found
    }

    fn place(&self, x: &[f64]) -> Vec<f64> {
        let moved = self.direction(x);
        moved.iter().map(|v| v * self.factor + self.shift).collect()
    }

    fn direction(&self, v: &[f64]) -> Vec<f64> {
        let mut v = v.to_vec();
        if self.mirror {
            v[0] = -v[0];
        }
        if self.swap {
            v.swap(0, 1);
        }
        v
    }

    /// Grid lines for the mesh; a box becomes lines, so that both are the same to the last bit wherever they can be.
    fn mesh(&self, mesh: &mut Table) -> Option<()> {
        let mut lines = lines(mesh)?;
        if self.mirror {
            lines[0].reverse();
            lines[0].iter_mut().for_each(|x| *x = -*x);
        }
        if self.swap {
            lines.swap(0, 1);
        }
        let places = lines.iter_mut().flatten();
        places.for_each(|x| *x = *x * self.factor + self.shift);
        set_lines(mesh, lines);
        // A reflection turns the other way round.
        if let Some(angle) = mesh.get_mut("twist").and_then(|t| t.get_mut("angle_deg"))
            && (self.mirror || self.swap)
        {
            scale(angle, -1.0);
        }
        Some(())
    }

    fn crack(&self, crack: &mut Table) {
        for (key, value) in crack.iter_mut() {
            self.entry(key, value);
        }
        if let Some(arc) = crack.get_mut("arc").and_then(Value::as_table_mut) {
            let about = if self.mirror { 180.0 } else { 90.0 };
            for key in ["from_deg", "to_deg"] {
                if let Some(angle) = arc.get_mut(key)
                    && let Some(degrees) = number(angle)
                    && (self.mirror || self.swap)
                {
                    *angle = Value::from(about - degrees);
                }
            }
        }
    }

    fn entry(&self, key: &str, value: &mut Value) {
        if let Value::Table(inner) = value {
            for (key, value) in inner.iter_mut() {
                self.entry(key, value);
            }
        } else if PLACES.contains(&key) {
            let of = |value: &Value| numbers(value).map(|x| Value::from(self.place(&x)));
            match value.as_array_mut() {
                Some(list) if list.iter().all(Value::is_array) => {
                    for point in list {
                        if let Some(moved) = of(point) {
                            *point = moved;
                        }
                    }
                }
                _ => {
                    if let Some(moved) = of(value) {
                        *value = moved;
                    }
                }
            }
        } else if LENGTHS.contains(&key) {
            scale(value, self.factor);
        } else if ["normal", "axis"].contains(&key)
            && let Some(v) = numbers(value)
        {
            *value = Value::from(self.direction(&v));
        }
    }

    /// A support or a load on a side.
    fn side(&self, table: &mut Table, dim: usize) {
        if let Some(on) = table.get_mut("on")
            && let Some(name) = on.as_str()
            && let Some(named) = self.named(name, dim)
        {
            *on = Value::from(named);
        }
        if let Some(Value::Array(entries)) = table.get_mut("displacement_m") {
            if self.mirror {
                scale(&mut entries[0], -1.0);
            }
            if self.swap {
                entries.swap(0, 1);
            }
            entries.iter_mut().for_each(|u| scale(u, self.factor));
        }
    }

    /// New name of a side.
    fn named(&self, name: &str, dim: usize) -> Option<&'static str> {
        let sides = sides(dim);
        let axis = sides.iter().position(|pair| pair.contains(&name))?;
        let high = usize::from(sides[axis][1] == name);
        Some(match axis {
            0 if self.mirror => sides[0][1 - high],
            0 | 1 if self.swap => sides[1 - axis][high],
            _ => sides[axis][high],
        })
    }
}

fn each(case: &mut Table, list: &str, mut change: impl FnMut(&mut Table)) {
    let tables = case.get_mut(list).and_then(Value::as_array_mut);
    for table in tables.into_iter().flatten().filter_map(Value::as_table_mut) {
        change(table);
    }
}

fn reverse(crack: &mut Table) {
    if let Some(Value::Array(points)) = crack.get_mut("points_m") {
        points.reverse();
    }
    for (key, shape) in crack.iter_mut() {
        let Some(shape) = shape.as_table_mut() else {
            continue;
        };
        if key == "arc"
            && let (Some(from), Some(to)) = (shape.remove("from_deg"), shape.remove("to_deg"))
        {
            shape.insert("from_deg".into(), to);
            shape.insert("to_deg".into(), from);
        }
        if let Some(Value::Array(normal)) = shape.get_mut("normal") {
            normal.iter_mut().for_each(|n| scale(n, -1.0));
        }
    }
}

/// Multiplies a number, or all of a list; words are left as they are.
fn scale(value: &mut Value, factor: f64) {
    if let Value::Array(list) = value {
        list.iter_mut().for_each(|v| scale(v, factor));
    } else if let Some(v) = number(value) {
        *value = Value::from(v * factor);
    }
}
