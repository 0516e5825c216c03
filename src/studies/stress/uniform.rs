//! The closed form of a case in uniform stress, read from its text: nothing here knows how a body is discretised.
//!
//! ```text
//!   σ = diag(σx, σy[, σz])     ε_a = (σ_a − ν (Σσ − σ_a)) / E     u_a = ε_a (x_a − min_a)
//!   W = ½ σ : ε V              P = −w σ n on side 1, in space     all cracks stick, no jump
//! ```

use toml::{Table, Value};

use crate::case::even_lines;

/// Low and high side of every axis, in 2D and in 3D.
const SIDES: [&[[&str; 2]]; 2] = [
    &[["left", "right"], ["bottom", "top"]],
    &[["left", "right"], ["front", "back"], ["bottom", "top"]],
];

/// Names of the sides of a body.
pub fn sides(dim: usize) -> &'static [[&'static str; 2]] {
    SIDES[dim - 2]
}

/// Uniform stress in a box.
pub struct Uniform {
    pub dim: usize,
    pub min: [f64; 3],
    pub max: [f64; 3],
    /// Principal stresses along the axes [Pa]; that along z is 0 in 2D: it has no part in anything that is compared.
    pub stress: [f64; 3],
    pub strain: [f64; 3],
    /// Diagonal of the largest cell [m].
    pub cell: f64,
}

impl Uniform {
    /// Of a box whose lower sides are held by rollers and whose upper ones have all a pressure or all a displacement;
    /// `None` of another case.
    pub fn of(text: &str) -> Option<Self> {
        let case: Table = text.parse().ok()?;
        let model = case.get("model")?.as_str()?;
        let material = case.get("material")?.as_table()?;
        let [young, poisson] = ["young_pa", "poisson"].map(|key| number(material.get(key)?));
        let (young, poisson) = (young?, poisson?);
        let lines = lines(case.get("mesh")?.as_table()?)?;
        let dim = lines.len();
        let end = |a: usize, last: bool| {
            let own = lines
                .get(a)
                .map(|l| if last { l[l.len() - 1] } else { l[0] });
            own.unwrap_or(0.0)
        };
        let [min, max] = [false, true].map(|last| [0, 1, 2].map(|a| end(a, last)));
        let longest = |l: &Vec<f64>| l.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        let cell = lines.iter().map(|l| longest(l).powi(2)).sum::<f64>().sqrt();
        let on_side = |list: &str, key: &str, side: &str| -> Option<Value> {
            let tables = case.get(list)?.as_array()?.iter();
            let mut own = tables.filter(|t| t.get("on").and_then(Value::as_str) == Some(side));
            own.find_map(|t| t.get(key).cloned())
        };
        let (mut stress, mut strain) = ([0.0; 3], [0.0; 3]);
        let (mut loaded, mut moved) = (0, 0);
        for (a, [_, high]) in sides(dim).iter().enumerate() {
            if let Some(p) = on_side("load", "pressure_pa", high)
                .as_ref()
                .and_then(number)
            {
                stress[a] = -p;
                loaded += 1;
            } else {
                let u = on_side("support", "displacement_m", high)?;
                strain[a] = number(u.get(a)?)? / (max[a] - min[a]);
                moved += 1;
            }
        }
        if loaded != dim && moved != dim {
            return None;
        }
        // Across the plane: no strain, or no stress.
        let plane_strain = model == "plane-strain";
        if loaded == dim {
            let mut across = stress;
            if plane_strain {
                across[2] = poisson * (stress[0] + stress[1]);
            }
            let total: f64 = across.iter().sum();
            for a in 0..dim {
                strain[a] = (across[a] - poisson * (total - across[a])) / young;
            }
        } else {
            let trace: f64 = strain.iter().sum();
            let shear = young / (2.0 * (1.0 + poisson));
            let lambda = if model == "plane-stress" {
                2.0 * shear * poisson / (1.0 - poisson)
            } else {
                2.0 * shear * poisson / (1.0 - 2.0 * poisson)
            };
            for a in 0..dim {
                stress[a] = lambda * trace + 2.0 * shear * strain[a];
            }
        }
        Some(Uniform {
            dim,
            min,
            max,
            stress,
            strain,
            cell,
        })
    }

    /// Displacement at a place [m].
    pub fn displacement(&self, x: &[f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|a| self.strain[a] * (x[a] - self.min[a]))
    }

    /// Largest displacement in the body [m].
    pub fn largest(&self) -> f64 {
        let corner = self.displacement(&self.max);
        corner.iter().map(|u| u * u).sum::<f64>().sqrt()
    }

    /// Largest stress [Pa].
    pub fn size(&self) -> f64 {
        self.stress.iter().fold(0.0, |m: f64, s| m.max(s.abs()))
    }

    /// ½ σ : ε V [J, in 2D J/m].
    pub fn energy(&self) -> f64 {
        let density: f64 = (0..self.dim).map(|a| self.stress[a] * self.strain[a]).sum();
        let volume: f64 = (0..self.dim).map(|a| self.max[a] - self.min[a]).product();
        0.5 * density * volume
    }

    /// Traction −σ n that side 1 feels [Pa].
    pub fn traction(&self, n: &[f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|a| -self.stress[a] * n[a])
    }

    /// Rounding of coordinates and their differences in cells [-]: far from the origin a cell holds no more digits.
    pub fn place(&self) -> f64 {
        let largest = self
            .min
            .iter()
            .chain(&self.max)
            .fold(0.0, |m: f64, x| m.max(x.abs()));
        4.0 * f64::EPSILON * largest / self.cell
    }

    /// |τ| / p on a plane: the friction it needs to stick.
    pub fn steepness(&self, n: &[f64; 3]) -> f64 {
        let t = self.traction(n);
        let pressure: f64 = (0..3).map(|a| t[a] * n[a]).sum();
        // Not as the root of a difference of squares, of which hydrostatic stress leaves rounding.
        let shear = [0, 1, 2].map(|a| t[a] - pressure * n[a]);
        shear.iter().map(|v| v * v).sum::<f64>().sqrt() / pressure
    }
}

/// A number of TOML, whole or not.
pub fn number(value: &Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|i| i as f64))
}

/// Numbers of a list.
pub fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(number).collect()
}

/// Gives `[mesh]` grid lines, in place of a box too.
pub fn set_lines(mesh: &mut Table, lines: Vec<Vec<f64>>) {
    mesh.remove("box");
    mesh.insert("lines_m".into(), Value::from(lines));
}

/// Grid lines of `[mesh]`, given themselves or as a box.
pub fn lines(mesh: &Table) -> Option<Vec<Vec<f64>>> {
    if let Some(lines) = mesh.get("lines_m") {
        return lines.as_array()?.iter().map(numbers).collect();
    }
    let grid = mesh.get("box")?.as_table()?;
    let [min, max, cells] = ["min_m", "max_m", "cells"].map(|key| numbers(grid.get(key)?));
    let (min, max, cells) = (min?, max?, cells?);
    // As the reader of cases rounds them: another last digit may choose other contact points.
    let axis = |a: usize| even_lines(min[a], max[a], cells[a] as usize);
    Some((0..min.len()).map(axis).collect())
}
