//! Method pages: what `stickslip show METHOD` prints and `stickslip show methods` collects.
//!
//! The text is the documentation at the head of each method's file, the options are those the method declares: one
//! source for the code, the command line and the manual.

use crate::run::registry::methods;
use stickslip_methods::{Method, Needs, OperatorKind, Options};

/// The page of one method in Markdown.
pub fn page(method: &Method) -> String {
    let kind = if method.exact {
        "Its limit is the solution of the contact laws themselves."
    } else {
        "It solves laws of its own: their distance from the contact laws is a modelling error, reported as the natural map."
    };
    let operator = match needs(method).operator {
        OperatorKind::SemiDefinite => "symmetric and positive semi-definite",
        OperatorKind::Any => "any, symmetric or not",
    };
    let mut text = format!(
        "## `{}`: {}\n\n{kind}\nDelassus operator W: {operator}.\nReference: {}.\n\n",
        method.name, method.label, method.reference
    );
    let mut fenced = false;
    for line in method.page().lines() {
        fenced ^= line.starts_with("```");
        // Headings of the source file become those of a section.
        if !fenced && line.starts_with("# ") {
            text += "##";
        }
        text += line;
        text += "\n";
    }
    text += "\n| option | default | allowed | meaning |\n| :--- | :--- | :--- | :--- |\n";
    for option in method.options {
        text += &format!(
            "| `{}` | {} | {} | {} |\n",
            option.name(),
            option.default(),
            option.allowed(),
            option.help()
        );
    }
    text
}

/// Needs of the method with its default options.
fn needs(method: &Method) -> Needs {
    let defaults = Options::new(method.options, &[]);
    defaults.map_or_else(|_| Needs::default(), |own| (method.build)(&own).needs())
}

/// All pages.
pub fn all() -> String {
    let mut text = String::from(
        "# Methods\n\nOne section per method: equations, options, guarantees, failure modes, what it skips.\n\nAll methods see the same condensed increment,\n\n```text\n\
         v = (g, d) = q + W P + Q β,   Qᵀ P = c\n```\n\nwith W the Delassus operator, q the jump without contact forces, and \
         Q the jumps of rigid motions where the body floats.\n\n| method | laws | what it does |\n| :--- | :--- | :--- |\n",
    );
    for method in methods() {
        let laws = if method.exact {
            "contact laws"
        } else {
            "its own"
        };
        text += &format!(
            "| [`{0}`](#{0}) | {laws} | {1} |\n",
            method.name, method.summary
        );
    }
    for method in methods() {
        text += &format!("\n<a id=\"{}\"></a>\n\n{}", method.name, page(method));
    }
    text
}
