//! `stickslip show schema`: the manual of the output files, made of the catalogues of tables and figures.

use super::figures;
use super::tables::{Chapter, catalogue};

/// The text around the catalogues.
const TEMPLATE: &str = include_str!("schema.md");

/// The manual.
pub fn manual() -> String {
    let (mut tables, all) = (String::new(), catalogue());
    for chapter in Chapter::ALL {
        tables += &format!("## {}\n\n{}\n\n", chapter.title(), chapter.lead());
        for (_, table) in all.iter().filter(|(own, _)| *own == chapter) {
            tables += &table.chapter();
            tables.push('\n');
        }
    }
    let row = |(_, kind): &(Chapter, &figures::Kind)| {
        let cell = |text: &str| text.replace('|', "\\|");
        let (question, shows) = (cell(kind.question), cell(kind.shows));
        format!("| `{}` | {question} | {shows} |\n", kind.file)
    };
    let figures: String = figures::CATALOGUE.iter().map(row).collect();
    TEMPLATE
        .replace("{tables}\n", &tables)
        .replace("{figures}\n", &(figures + "\n"))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_table_has_a_name_of_its_own_and_every_column_a_meaning() {
        let mut names = BTreeSet::new();
        for (_, table) in catalogue() {
            assert!(names.insert(table.name), "{}", table.name);
            assert!(table.question.ends_with('?'), "{}", table.name);
            let mut columns = BTreeSet::new();
            for column in &table.columns {
                assert!(
                    columns.insert(column.name),
                    "{}: {}",
                    table.name,
                    column.name
                );
                assert!(column.meaning.len() > 3, "{}: {}", table.name, column.name);
                let unit = column.unit.to_lowercase().replace('/', "_per_");
                let plain = unit.chars().all(|c| c.is_ascii_alphabetic() || c == '_');
                let tells = unit.is_empty() || unit == "si" || !plain;
                assert!(
                    tells
                        || column.name.ends_with(&format!("_{unit}"))
                        || column.name.contains("_s_"),
                    "{}: {} without its unit {}",
                    table.name,
                    column.name,
                    column.unit
                );
            }
        }
    }
}
