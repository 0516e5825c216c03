//! The cases that come with the program: every file of `cases/`, compiled in, so that a copied binary still has them.

use super::error::CaseError;
use super::parse::{Case, parse};

/// Name and text of every shipped case, sorted by name.
pub static CASES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/cases.rs"));

/// The shipped case of that name; `None` if there is none.
pub fn find(name: &str) -> Option<Result<Case, CaseError>> {
    CASES
        .iter()
        .find(|(own, _)| *own == name)
        .map(|(own, text)| parse(format!("cases/{own}.toml"), *text))
}
