//! A table without its rows: for `stickslip show schema` and for the page, which reads files.

use super::readable::escape_markdown;
use super::{About, Pivot, Row};

/// A table that some command writes.
#[derive(Debug, Clone)]
pub struct Description {
    /// Name of the file without ending.
    pub name: &'static str,
    /// Caption.
    pub title: &'static str,
    /// The reader's question that it answers.
    pub question: &'static str,
    /// Further text of its chapter.
    pub notes: &'static str,
    /// Whether there is a `.md` beside the `.csv`.
    pub readable: bool,
    /// Whether there is a `.tex` beside it.
    pub printed: bool,
    /// Columns of the CSV file.
    pub columns: Vec<About>,
    /// How it is turned for reading.
    pub pivot: Option<Pivot>,
}

impl Description {
    /// That of a row type.
    pub fn of<R: Row>() -> Self {
        Self {
            name: R::NAME,
            title: R::TITLE,
            question: R::QUESTION,
            notes: R::NOTES,
            readable: R::READABLE,
            printed: R::READABLE && R::PRINTED,
            columns: R::columns().iter().map(|column| column.about).collect(),
            pivot: R::PIVOT,
        }
    }

    /// Name of the CSV file.
    pub fn file(&self) -> String {
        format!("{}.csv", self.name)
    }

    /// Its chapter of `stickslip show schema`.
    pub fn chapter(&self) -> String {
        let mut text = format!(
            "### `{}`\n\n*{}*\n\n{}.",
            self.file(),
            self.question,
            self.title
        );
        if !self.notes.is_empty() {
            text += &format!(" {}", self.notes);
        }
        if self.readable {
            text += if self.printed {
                " Also as `.md` and `.tex`."
            } else {
                " Also as `.md`."
            };
        }
        text += "\n\n| column | unit | meaning |\n| :--- | :--- | :--- |\n";
        for column in &self.columns {
            let meaning = column.meaning.replace('|', "\\|");
            let unit = escape_markdown(column.unit);
            text += &format!("| `{}` | {unit} | {meaning} |\n", column.name);
        }
        text
    }
}
