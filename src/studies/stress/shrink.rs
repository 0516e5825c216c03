//! Makes a case smaller as long as it fails for the same cause: fewer cracks, coarser meshes, fewer options, rounder numbers.

use toml::{Table, Value};

use super::uniform::{lines, number, set_lines};

/// Smaller cases that a case could be made to, the largest steps first. In uniform stress cracks must stick: friction and the ratio of the
/// stresses are left alone.
pub fn smaller(text: &str) -> Vec<String> {
    let Ok(case) = text.parse::<Table>() else {
        return Vec::new();
    };
    let mut found: Vec<Table> = Vec::new();
    let mut changed = |change: &dyn Fn(&mut Table) -> Option<()>| {
        let mut other = case.clone();
        if change(&mut other).is_some() && other != case {
            found.push(other);
        }
    };
    let cracks = list(&case, "crack").map_or(0, Vec::len);
    for index in 0..if cracks > 1 { cracks } else { 0 } {
        changed(&|case| {
            case.get_mut("crack")?.as_array_mut()?.remove(index);
            Some(())
        });
    }
    for axis in 0..3 {
        changed(&|case| coarser(case, axis));
    }
    for key in ["twist", "distort"] {
        changed(&|case| case.get_mut("mesh")?.as_table_mut()?.remove(key).map(drop));
    }
    for index in 0..cracks {
        for key in ["tip", "contact"] {
            changed(&|case| crack(case, index)?.remove(key).map(drop));
        }
    }
    changed(&|case| {
        case.get_mut("material")?
            .as_table_mut()?
            .insert("young_pa".into(), 1.0.into());
        Some(())
    });
    for digits in [2, 4, 8] {
        changed(&|case| {
            let mesh = case.get_mut("mesh")?;
            round(mesh, digits);
            Some(())
        });
        for index in 0..cracks {
            changed(&|case| {
                for (key, value) in crack(case, index)?.iter_mut() {
                    if key != "friction" {
                        round(value, digits);
                    }
                }
                Some(())
            });
        }
    }
    found
        .iter()
        .filter_map(|case| toml::to_string(case).ok())
        .collect()
}

fn list<'a>(case: &'a Table, key: &str) -> Option<&'a Vec<Value>> {
    case.get(key)?.as_array()
}

fn crack(case: &mut Table, index: usize) -> Option<&mut Table> {
    case.get_mut("crack")?
        .as_array_mut()?
        .get_mut(index)?
        .as_table_mut()
}

/// Every second grid line of an axis left out, as long as there are two cells.
fn coarser(case: &mut Table, axis: usize) -> Option<()> {
    let mesh = case.get_mut("mesh")?.as_table_mut()?;
    let mut lines = lines(mesh)?;
    let own = lines.get_mut(axis)?;
    let last = own.len() - 1;
    if last < 4 {
        return None;
    }
    let mut kept: Vec<f64> = own.iter().copied().step_by(2).collect();
    if last % 2 == 1 {
        kept.pop();
        kept.push(own[last]);
    }
    *own = kept;
    set_lines(mesh, lines);
    Some(())
}

/// Rounds numbers to significant digits.
fn round(value: &mut Value, digits: usize) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(|v| round(v, digits)),
        Value::Table(table) => table.iter_mut().for_each(|(_, v)| round(v, digits)),
        Value::Float(_) => {
            if let Some(v) = number(value)
                && let Ok(rounded) = format!("{v:.*e}", digits - 1).parse::<f64>()
            {
                *value = Value::from(rounded);
            }
        }
        _ => {}
    }
}
