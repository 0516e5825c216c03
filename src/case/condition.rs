//! Conditions on coordinates: `z <= 1 or (z >= 2 and x < 0.5)`.
//!
//! ```text
//! any        = all { "or" all }
//! all        = term { "and" term }
//! term       = "(" any ")" | axis relation number
//! axis       = "x" | "y" | "z"            (z only in 3D)
//! relation   = "<=" | ">=" | "<" | ">" | "=="
//! ```

use std::fmt;
use std::ops::Range;

/// Nesting of parentheses allowed; the parser is recursive and must not exhaust the stack.
const MAX_DEPTH: usize = 32;

/// Tolerance of every comparison, times max(1, |number|): node coordinates are computed and carry rounding errors.
const TOLERANCE: f64 = 1e-9;

/// A condition on a place, e.g. `z <= 1 or z >= 2`; `and` binds tighter than `or`.
///
/// Comparisons allow for rounding: with δ = 1e-9 · max(1, |c|) [m], `x <= c` means x <= c + δ, `x < c` means x < c − δ,
/// `x == c` means |x − c| <= δ, and likewise for the others. A node on x = c thus fulfils `x <= c` and never `x < c`.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    text: String,
    rule: Rule,
}

#[derive(Debug, Clone, PartialEq)]
enum Rule {
    Any(Vec<Rule>),
    All(Vec<Rule>),
    Compare {
        axis: usize,
        relation: Relation,
        number: f64,
        /// δ [m].
        tolerance: f64,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Relation {
    AtMost,
    AtLeast,
    Below,
    Above,
    Equal,
}

/// What is wrong with a condition; `at` is the byte range inside its text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ConditionError {
    pub(super) at: Range<usize>,
    pub(super) allowed: String,
    pub(super) message: &'static str,
}

impl Condition {
    /// Whether the place `x` [m] fulfils the condition; in 2D the third coordinate is not looked at.
    pub fn holds(&self, x: &[f64; 3]) -> bool {
        self.rule.holds(x)
    }

    /// The same on coordinates that are larger by `by`.
    pub(super) fn moved(&self, by: &[f64; 3]) -> Self {
        Condition {
            text: self.text.clone(),
            rule: self.rule.moved(by),
        }
    }

    /// Reads a condition for a problem of `dim` dimensions.
    pub(super) fn parse(text: &str, dim: usize) -> Result<Self, ConditionError> {
        let mut parser = Parser { text, at: 0, dim };
        let rule = parser.any(0)?;
        let rest = parser.peek();
        if !rest.is_empty() {
            return Err(parser.unexpected(rest, "`and`, `or` or the end of the condition"));
        }
        Ok(Condition {
            text: text.to_string(),
            rule,
        })
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Rule {
    fn holds(&self, x: &[f64; 3]) -> bool {
        match self {
            Rule::Any(rules) => rules.iter().any(|r| r.holds(x)),
            Rule::All(rules) => rules.iter().all(|r| r.holds(x)),
            Rule::Compare {
                axis,
                relation,
                number,
                tolerance: delta,
            } => {
                let difference = x[*axis] - number;
                match relation {
                    Relation::AtMost => difference <= *delta,
                    Relation::AtLeast => difference >= -delta,
                    Relation::Below => difference < -delta,
                    Relation::Above => difference > *delta,
                    Relation::Equal => difference.abs() <= *delta,
                }
            }
        }
    }

    fn moved(&self, by: &[f64; 3]) -> Self {
        let all = |rules: &[Rule]| rules.iter().map(|r| r.moved(by)).collect();
        match self {
            Rule::Any(rules) => Rule::Any(all(rules)),
            Rule::All(rules) => Rule::All(all(rules)),
            &Rule::Compare {
                axis,
                relation,
                number,
                tolerance,
            } => Rule::Compare {
                axis,
                relation,
                number: number + by[axis],
                tolerance,
            },
        }
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    dim: usize,
}

impl<'a> Parser<'a> {
    fn any(&mut self, depth: usize) -> Result<Rule, ConditionError> {
        let mut rules = vec![self.all(depth)?];
        while self.accept("or") {
            rules.push(self.all(depth)?);
        }
        Ok(if rules.len() == 1 {
            rules.swap_remove(0)
        } else {
            Rule::Any(rules)
        })
    }

    fn all(&mut self, depth: usize) -> Result<Rule, ConditionError> {
        let mut rules = vec![self.term(depth)?];
        while self.accept("and") {
            rules.push(self.term(depth)?);
        }
        Ok(if rules.len() == 1 {
            rules.swap_remove(0)
        } else {
            Rule::All(rules)
        })
    }

    fn term(&mut self, depth: usize) -> Result<Rule, ConditionError> {
        if self.peek() != "(" {
            return self.comparison();
        }
        let open = self.at..self.at + 1;
        if depth == MAX_DEPTH {
            let allowed = format!("at most {MAX_DEPTH} parentheses inside each other");
            return Err(ConditionError {
                at: open,
                allowed,
                message: "parentheses nest too deeply",
            });
        }
        self.at = open.end;
        let rule = self.any(depth + 1)?;
        if !self.accept(")") {
            let found = self.peek();
            return Err(self.unexpected(found, "`)`, `and` or `or`"));
        }
        Ok(rule)
    }

    fn comparison(&mut self) -> Result<Rule, ConditionError> {
        let name = self.peek();
        let axes = &["x", "y", "z"][..self.dim];
        let Some(axis) = axes.iter().position(|a| *a == name) else {
            return Err(self.unexpected(
                name,
                if self.dim == 3 {
                    "x, y, z or `(`"
                } else {
                    "x, y or `(` (2D)"
                },
            ));
        };
        self.at += name.len();
        let sign = self.peek();
        let relation = match sign {
            "<=" => Relation::AtMost,
            ">=" => Relation::AtLeast,
            "<" => Relation::Below,
            ">" => Relation::Above,
            "==" => Relation::Equal,
            _ => return Err(self.unexpected(sign, "<=, >=, <, > or ==")),
        };
        self.at += sign.len();
        let word = self.peek();
        match word.parse::<f64>() {
            // Rust also reads `inf` and `nan`; those fail the test.
            Ok(number) if number.is_finite() => {
                self.at += word.len();
                Ok(Rule::Compare {
                    axis,
                    relation,
                    number,
                    tolerance: TOLERANCE * number.abs().max(1.0),
                })
            }
            _ => Err(self.unexpected(word, "a finite number")),
        }
    }

    fn accept(&mut self, word: &str) -> bool {
        let found = self.peek() == word;
        if found {
            self.at += word.len();
        }
        found
    }

    /// Skips blanks and returns the next word without taking it; empty at the end.
    fn peek(&mut self) -> &'a str {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        let rest = &self.text[self.at..];
        let end = match rest.chars().next() {
            None => 0,
            Some(c @ ('(' | ')')) => c.len_utf8(),
            Some('<' | '>' | '=') => rest
                .find(|c| !matches!(c, '<' | '>' | '='))
                .unwrap_or(rest.len()),
            Some(_) => rest
                .find(|c: char| c.is_whitespace() || matches!(c, '(' | ')' | '<' | '>' | '='))
                .unwrap_or(rest.len()),
        };
        &rest[..end]
    }

    /// Error at the word just peeked.
    fn unexpected(&self, word: &str, allowed: &str) -> ConditionError {
        let message = if word.is_empty() {
            "condition ends too early"
        } else {
            "condition cannot be read"
        };
        ConditionError {
            at: self.at..self.at + word.len(),
            allowed: allowed.to_string(),
            message,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holds(text: &str, x: [f64; 3]) -> bool {
        Condition::parse(text, 3).unwrap().holds(&x)
    }

    #[test]
    fn and_binds_tighter_than_or() {
        let text = "x <= 1 or x >= 2 and y > 5";
        assert!(holds(text, [0.0, 0.0, 0.0]));
        assert!(!holds(text, [3.0, 0.0, 0.0]));
        assert!(holds(text, [3.0, 6.0, 0.0]));
        assert!(!holds("(x <= 1 or x >= 2) and y > 5", [0.0, 0.0, 0.0]));
    }

    #[test]
    fn comparisons_forgive_rounding_but_not_more() {
        let third = 1.0 / 3.0 * 3.0 + 1e-15;
        assert!(holds("z<=1", [0.0, 0.0, third]) && holds("z>=1", [0.0, 0.0, 1.0 - 1e-15]));
        assert!(holds("z == 1", [0.0, 0.0, third]));
        assert!(!holds("z < 1", [0.0, 0.0, 1.0 - 1e-15]) && !holds("z > 1", [0.0, 0.0, third]));
        assert!(
            !holds("z <= 1", [0.0, 0.0, 1.0 + 2e-9]) && !holds("z == 1", [0.0, 0.0, 1.0 - 2e-9])
        );
        assert!(
            holds("x <= -1e6", [-1e6 + 1e-4, 0.0, 0.0])
                && !holds("x <= -1e6", [-1e6 + 2e-3, 0.0, 0.0])
        );
    }

    #[test]
    fn errors_point_at_the_offending_word() {
        let at = |text: &str, dim| Condition::parse(text, dim).unwrap_err().at;
        assert_eq!(at("x <= 1 or w > 2", 3), 10..11);
        assert_eq!(at("x <= 1 or z > 2", 2), 10..11);
        assert_eq!(at("x <= nan", 3), 5..8);
        assert_eq!(at("x <= 1e999", 3), 5..10);
        assert_eq!(at("x = 1", 3), 2..3);
        assert_eq!(at("x <= 1 y", 3), 7..8);
        assert_eq!(at("(x <= 1", 3), 7..7);
        assert_eq!(at("x <= 1)", 3), 6..7);
        assert_eq!(at("", 3), 0..0);
        assert_eq!(at("é < 1", 3), 0..2);
        assert_eq!(at(&"(".repeat(100_000), 3), 32..33);
    }

    #[test]
    fn display_returns_the_text() {
        assert_eq!(
            Condition::parse("x<=1  or y > 2", 2).unwrap().to_string(),
            "x<=1  or y > 2"
        );
    }
}
