//! Conditions on coordinates: `z <= 1 or (z >= 2 and x < 0.5)`.
//!
//! ```text
//! any        = all { "or" all }
//! all        = term { "and" term }
//! term       = "(" any ")" | axis relation number
//! axis       = "x" | "y" | "z"            (z only in 3D)
//! relation   = "<=" | ">=" | "<" | ">" | "=="
//! ```
//!
//! A condition is a union of boxes. It cuts a convex part of the border bound by bound, so that boxes may overlap.

use std::fmt;
use std::ops::Range;

use stickslip_xfem::geometry::Point;
use stickslip_xfem::geometry::clip::{clip, snapped};

/// Nesting of parentheses allowed; the parser is recursive and must not exhaust the stack.
const MAX_DEPTH: usize = 32;

/// A condition on a place, e.g. `z <= 1 or z >= 2`; `and` binds tighter than `or`.
///
/// Comparisons allow for rounding by δ [m], a billionth of a cell: `x <= c` means x <= c + δ, `x < c` means x < c − δ, `x == c`
/// means |x − c| <= δ, and likewise for the others. A node on x = c thus fulfils `x <= c` and never `x < c`.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    text: String,
    rule: Rule,
}

/// Parts of a convex polygon, or of a segment, by their corners [m].
pub type Parts = Vec<Vec<Point>>;

/// Places in pairs of parts: what a condition holds of something, and the rest.
const INSIDE: usize = 0;
const OUTSIDE: usize = 1;

#[derive(Debug, Clone, PartialEq)]
enum Rule {
    Any(Vec<Rule>),
    All(Vec<Rule>),
    Bound(Bound),
}

/// sign · (number − x_axis) >= 0, or > 0.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bound {
    axis: usize,
    sign: f64,
    number: f64,
    strict: bool,
}

impl Bound {
    /// A number that must be >= 0, or > 0; 0 within δ.
    fn level(&self, x: &Point, delta: f64) -> f64 {
        snapped(self.sign * (self.number - x[self.axis]), delta)
    }

    /// The parts of a convex one inside and outside.
    fn split(&self, part: Vec<Point>, delta: f64) -> [Parts; 2] {
        let levels: Vec<f64> = part.iter().map(|x| self.level(x, delta)).collect();
        let beyond = |side: f64| levels.iter().any(|f| f * side > 0.0);
        match [beyond(1.0), beyond(-1.0)] {
            [true, true] => [1.0, -1.0].map(|side| {
                let mut own = clip(&part, &levels, side);
                // A segment is cut once, not on the way there and back.
                own.truncate(if part.len() == 2 { 2 } else { usize::MAX });
                vec![own]
            }),
            [false, true] => [vec![], vec![part]],
            [false, false] if self.strict => [vec![], vec![part]],
            _ => [vec![part], vec![]],
        }
    }

    fn range(&self, axis: usize) -> [f64; 2] {
        match (self.axis == axis, self.sign > 0.0) {
            (true, true) => [f64::NEG_INFINITY, self.number],
            (true, false) => [self.number, f64::INFINITY],
            (false, _) => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
}

/// Fault of a condition; `at` is the byte range inside its text.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ConditionError {
    pub(super) at: Range<usize>,
    pub(super) allowed: String,
    pub(super) message: &'static str,
}

impl Condition {
    /// Whether the place `x` [m] fulfils the condition within δ [m]; in 2D the third coordinate is not looked at.
    pub fn holds(&self, x: &Point, delta: f64) -> bool {
        self.rule.holds(x, delta)
    }

    /// The parts of a convex polygon, or of a segment, inside the condition and outside of it; corners within δ [m] of a bound
    /// lie on it. What lies in several boxes is one part.
    pub fn split(&self, polygon: Vec<Point>, delta: f64) -> [Parts; 2] {
        self.rule.split(polygon, delta)
    }

    /// Lowest and highest coordinate along an axis that the condition can hold for, infinite without bound [m].
    pub fn range(&self, axis: usize) -> [f64; 2] {
        self.rule.range(axis)
    }

    /// Union of the conditions.
    pub(super) fn union(conditions: Vec<Condition>) -> Self {
        let texts: Vec<&str> = conditions.iter().map(|c| c.text.as_str()).collect();
        Condition {
            text: texts.join(" or "),
            rule: Rule::Any(conditions.into_iter().map(|c| c.rule).collect()),
        }
    }

    /// The same on coordinates that are larger by `by`.
    pub(super) fn moved(&self, by: &Point) -> Self {
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
    fn holds(&self, x: &Point, delta: f64) -> bool {
        match self {
            Rule::Any(rules) => rules.iter().any(|r| r.holds(x, delta)),
            Rule::All(rules) => rules.iter().all(|r| r.holds(x, delta)),
            Rule::Bound(bound) => {
                let level = bound.level(x, delta);
                level > 0.0 || level == 0.0 && !bound.strict
            }
        }
    }

    fn split(&self, part: Vec<Point>, delta: f64) -> [Parts; 2] {
        match self {
            Rule::Any(rules) => one_by_one(rules, part, delta, OUTSIDE),
            Rule::All(rules) => one_by_one(rules, part, delta, INSIDE),
            Rule::Bound(bound) => bound.split(part, delta),
        }
    }

    fn range(&self, axis: usize) -> [f64; 2] {
        const NONE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
        const ALL: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
        let ranges = |rules: &[Rule]| rules.iter().map(|r| r.range(axis)).collect::<Vec<_>>();
        match self {
            Rule::Any(rules) => (ranges(rules).iter())
                .fold(NONE, |all, own| [all[0].min(own[0]), all[1].max(own[1])]),
            Rule::All(rules) => (ranges(rules).iter())
                .fold(ALL, |all, own| [all[0].max(own[0]), all[1].min(own[1])]),
            Rule::Bound(bound) => bound.range(axis),
        }
    }

    fn moved(&self, by: &Point) -> Self {
        let all = |rules: &[Rule]| rules.iter().map(|r| r.moved(by)).collect();
        match self {
            Rule::Any(rules) => Rule::Any(all(rules)),
            Rule::All(rules) => Rule::All(all(rules)),
            Rule::Bound(bound) => Rule::Bound(Bound {
                number: bound.number + by[bound.axis],
                ..*bound
            }),
        }
    }
}

/// Rule after rule on the parts still undecided: those inside all so far, or outside.
fn one_by_one(rules: &[Rule], part: Vec<Point>, delta: f64, undecided: usize) -> [Parts; 2] {
    let mut found = [vec![], vec![]];
    let mut rest = vec![part];
    for rule in rules {
        for part in std::mem::take(&mut rest) {
            let mut own = rule.split(part, delta);
            rest.append(&mut own[undecided]);
            found[1 - undecided].append(&mut own[1 - undecided]);
        }
    }
    found[undecided] = rest;
    found
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
        Ok(Rule::Any(rules))
    }

    fn all(&mut self, depth: usize) -> Result<Rule, ConditionError> {
        let mut rules = vec![self.term(depth)?];
        while self.accept("and") {
            rules.push(self.term(depth)?);
        }
        Ok(Rule::All(rules))
    }

    fn term(&mut self, depth: usize) -> Result<Rule, ConditionError> {
        if self.peek() != "(" {
            return self.comparison();
        }
        let open = self.at..self.at + 1;
        if depth == MAX_DEPTH {
            return Err(ConditionError {
                at: open,
                allowed: format!("at most {MAX_DEPTH} parentheses inside each other"),
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
            let allowed = ["x, y or `(` (2D)", "x, y, z or `(`"][usize::from(self.dim == 3)];
            return Err(self.unexpected(name, allowed));
        };
        self.at += name.len();
        let sign = self.peek();
        // `==` is both.
        let (signs, strict): (&[f64], bool) = match sign {
            "<=" => (&[1.0], false),
            ">=" => (&[-1.0], false),
            "<" => (&[1.0], true),
            ">" => (&[-1.0], true),
            "==" => (&[1.0, -1.0], false),
            _ => return Err(self.unexpected(sign, "<=, >=, <, > or ==")),
        };
        self.at += sign.len();
        let word = self.peek();
        match word.parse::<f64>() {
            // Rust also reads `inf` and `nan`; those fail the test.
            Ok(number) if number.is_finite() => {
                self.at += word.len();
                let bound = |&sign| {
                    Rule::Bound(Bound {
                        axis,
                        sign,
                        number,
                        strict,
                    })
                };
                Ok(Rule::All(signs.iter().map(bound).collect()))
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
        let relation = |c: char| "<>=".contains(c);
        let ends = |c: char| c.is_whitespace() || "()".contains(c) || relation(c);
        let end = match rest.chars().next() {
            Some('(' | ')') => Some(1),
            Some(first) if relation(first) => rest.find(|c| !relation(c)),
            _ => rest.find(ends),
        };
        &rest[..end.unwrap_or(rest.len())]
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
    use stickslip_xfem::geometry::polygon::space_area;

    use super::*;

    fn holds(text: &str, x: [f64; 3]) -> bool {
        Condition::parse(text, 3).unwrap().holds(&x, 1e-9)
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
        for (text, z, expected) in [
            ("z<=1", third, true),
            ("z>=1", 1.0 - 1e-15, true),
            ("z == 1", third, true),
            ("z < 1", 1.0 - 1e-15, false),
            ("z > 1", third, false),
            ("z <= 1", 1.0 + 2e-9, false),
            ("z == 1", 1.0 - 2e-9, false),
        ] {
            assert_eq!(holds(text, [0.0, 0.0, z]), expected, "{text} at {z}");
        }
    }

    /// Boxes that overlap, touch and nest: inside and outside fill the square, and the inside is that of the grid of bounds.
    #[test]
    fn parts_of_a_polygon_fill_it_and_overlaps_count_once() {
        let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        for (text, area) in [
            ("x <= 0.3", 0.3),
            ("x <= 0.3 or y >= 0.4", 0.3 + 0.6 - 0.18),
            (
                "x <= 0.5 and y <= 0.5 or x >= 0.2 and y <= 0.7 and x <= 0.8",
                0.25 + 0.42 - 0.15,
            ),
            (
                "(x < 0.5 or x > 0.7) and (y < 0.1 or y >= 0.2) and x >= 0.4",
                0.4 * 0.9,
            ),
            ("x == 0.5", 0.0),
            ("x >= -3 and x <= 4", 1.0),
        ] {
            let condition = Condition::parse(text, 2).unwrap();
            let parts = condition.split(square.clone(), 1e-9);
            let sums = parts.map(|parts| parts.iter().map(|p| space_area(p)).sum::<f64>());
            assert!((sums[0] - area).abs() < 1e-15, "{text}: {sums:?}");
            assert!((sums[0] + sums[1] - 1.0).abs() < 1e-15, "{text}: {sums:?}");
        }
        let segment = |text| {
            let condition = Condition::parse(text, 2).unwrap();
            condition.split(vec![[0.0, 1.0, 0.0], [1.0, 1.0, 0.0]], 1e-9)
        };
        let ends = |a: f64, b: f64| vec![[a, 1.0, 0.0], [b, 1.0, 0.0]];
        let [inside, outside] = segment("x >= 0.25 and x <= 0.75");
        assert_eq!(inside, [ends(0.25, 0.75)]);
        assert_eq!(outside, [ends(0.0, 0.25), ends(0.75, 1.0)]);
        // On the bound itself, and within rounding of its ends.
        assert_eq!(segment("y == 1")[0], [ends(0.0, 1.0)]);
        assert!(segment("y < 1")[0].is_empty() && segment("x <= 1e-10")[0].is_empty());
        assert_eq!(segment("x <= 0.9999999999")[0], [ends(0.0, 1.0)]);
    }

    #[test]
    fn ranges_hold_what_the_condition_does() {
        let range = |text| Condition::parse(text, 2).unwrap().range(0);
        assert_eq!(range("x <= 1 and x > -2 or x == 3"), [-2.0, 3.0]);
        assert_eq!(range("y <= 1 and x > -2"), [-2.0, f64::INFINITY]);
        assert_eq!(
            range("y <= 1 or x > -2"),
            [f64::NEG_INFINITY, f64::INFINITY]
        );
    }

    #[test]
    fn errors_point_at_the_offending_word() {
        let deep = "(".repeat(100_000);
        for (text, dim, place) in [
            ("x <= 1 or w > 2", 3, 10..11),
            ("x <= 1 or z > 2", 2, 10..11),
            ("x <= nan", 3, 5..8),
            ("x <= 1e999", 3, 5..10),
            ("x = 1", 3, 2..3),
            ("x <= 1 y", 3, 7..8),
            ("(x <= 1", 3, 7..7),
            ("x <= 1)", 3, 6..7),
            ("", 3, 0..0),
            ("é < 1", 3, 0..2),
            (&deep, 3, 32..33),
        ] {
            assert_eq!(
                Condition::parse(text, dim).unwrap_err().at,
                place,
                "{text:.20}"
            );
        }
    }
}
