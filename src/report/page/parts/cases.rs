//! Figures of the cases: tractions, slip, residuals and fields, a group per case.

use std::collections::{BTreeMap, BTreeSet};

use super::blocks::made;
use crate::report::page::folder::split;
use crate::report::page::{Block, Budget, Figures, Folder, Link, PageError, Section};

/// Cases whose figures get room first: those of the founding paper.
const FIRST: [&str; 3] = ["plate_", "beam_", "cyclic"];

/// Kinds of figures by the end of their name, the most telling first; others come behind.
const KINDS: [&str; 4] = ["traction", "slip", "displacement", "residual"];

/// The section.
pub fn section(folder: &Folder, budget: &mut Budget) -> Result<Option<Section>, PageError> {
    let mut groups: BTreeMap<(usize, &str), Vec<&str>> = BTreeMap::new();
    for path in folder.of_kind("svg") {
        // `case.mesh.space.….kind.svg`; figures of whole reports and of error studies have sections of their own.
        let parts: Vec<&str> = split(path).1.split('.').collect();
        let elsewhere = parts.len() < 5 || parts[0] == "converged";
        if elsewhere || ["error", "error-time"].contains(&parts[parts.len() - 2]) {
            continue;
        }
        let rank = FIRST.iter().position(|start| parts[0].starts_with(start));
        let key = (rank.unwrap_or(FIRST.len()), parts[0]);
        groups.entry(key).or_default().push(path);
    }
    let mut blocks = Vec::new();
    for ((_, case), mut paths) in groups {
        paths.sort_by_key(|path| (rank(path), *path));
        // One of each kind is shown, the others are linked.
        let mut kinds = BTreeSet::new();
        let (inside, linked): (Vec<&str>, Vec<&str>) =
            paths.into_iter().partition(|path| kinds.insert(kind(path)));
        let group = folder.figures(case, inside, budget)?;
        let mut group = group.unwrap_or(Figures {
            title: case.to_owned(),
            open: false,
            figures: Vec::new(),
            links: Vec::new(),
        });
        let link = |path: &str| {
            let name = split(path).1;
            Link::new(name.strip_suffix(".svg").unwrap_or(name), path)
        };
        group.links.extend(linked.into_iter().map(link));
        blocks.push(Block::Figures(group));
    }
    let lead = "The last increment: contact forces and slip along the crack, displacements, residuals of all methods. One \
                figure of each kind is shown, the others are files beside this page.";
    Ok(made("cases", "Cases in figures", lead, blocks))
}

fn kind(path: &str) -> &str {
    let name = path.strip_suffix(".svg").unwrap_or(path);
    name.rsplit('.').next().unwrap_or(name)
}

fn rank(path: &str) -> usize {
    let found = KINDS.iter().position(|own| *own == kind(path));
    found.unwrap_or(KINDS.len())
}
