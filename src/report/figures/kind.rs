//! Description of a kind of figure.

use crate::report::{Bundle, ReportError};

/// A kind of figure, as the reader knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// File name in `figures/`; `*` stands for what tells the files of a kind apart: case, mesh, contact space, method,
    /// friction coefficient, crack, quantity, tier.
    pub file: &'static str,
    /// The reader's question that it answers.
    pub question: &'static str,
    /// Contents of the drawing, for the manual.
    pub shows: &'static str,
}

impl Kind {
    /// Whether a file of this name (without its folder) is of this kind.
    pub fn has(&self, name: &str) -> bool {
        match self.file.split_once('*') {
            Some((start, end)) => name.starts_with(start) && name.ends_with(end),
            None => name == self.file,
        }
    }

    /// Adds a figure of this kind, where there is something to draw.
    pub(super) fn add(
        &self,
        bundle: &mut Bundle,
        own: &str,
        svg: Option<String>,
    ) -> Result<(), ReportError> {
        if let Some(svg) = svg {
            bundle.add(format!("figures/{}", self.file.replacen('*', own, 1)), svg)?;
        }
        Ok(())
    }
}
