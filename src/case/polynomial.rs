//! Polynomials of the place, at most of second degree: `2e5 - 1e4 y + 30 x*y - 2 x^2`.
//!
//! ```text
//! polynomial = [ sign ] term { sign term }       sign   = "+" | "-"
//! term       = factor { [ "*" ] factor }         factor = number | axis [ "^2" ]
//! axis       = "x" | "y" | "z"                   (z only in 3D)
//! ```

use std::ops::Range;

use stickslip_xfem::geometry::{Point, dot};

use super::condition::ConditionError;
use super::reader::computable;

/// c + l · x + x · Q x, x the place in the undeformed body, in its frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Polynomial {
    /// c, in the unit of the value.
    pub constant: f64,
    /// l, per metre; third entry 0 in 2D.
    pub linear: Point,
    /// Q, per square metre; upper triangle, the rest 0.
    pub quadratic: [Point; 3],
}

impl From<f64> for Polynomial {
    fn from(constant: f64) -> Self {
        Polynomial {
            constant,
            ..Polynomial::default()
        }
    }
}

impl Polynomial {
    /// Value at a place.
    pub fn at(&self, x: &Point) -> f64 {
        let second = self.quadratic.map(|row| dot(&row, x));
        self.constant + dot(&self.linear, x) + dot(&second, x)
    }

    /// The same over coordinates with their zero at `origin`.
    pub(super) fn moved(&self, origin: &Point) -> Self {
        let q = &self.quadratic;
        let slope = |a: usize| (0..3).map(|b| (q[a][b] + q[b][a]) * origin[b]).sum::<f64>();
        Polynomial {
            constant: self.at(origin),
            linear: [0, 1, 2].map(|a| self.linear[a] + slope(a)),
            ..*self
        }
    }

    /// Reads a polynomial for a problem of `dim` dimensions.
    pub(super) fn parse(text: &str, dim: usize) -> Result<Self, ConditionError> {
        let axes = &["x", "y", "z"][..dim];
        let mut sum = Polynomial::default();
        // Of a term: where it starts, the product of its numbers, its axes, whether a factor must follow.
        let (mut start, mut factor, mut powers, mut open) = (0, 1.0, Vec::new(), true);
        for (index, (at, word)) in words(text).into_iter().enumerate() {
            let wrong = |at: Range<usize>, allowed: &str| ConditionError {
                at,
                allowed: allowed.to_string(),
                message: "polynomial cannot be read",
            };
            let name = word.strip_suffix("^2").unwrap_or(word);
            if let Some(axis) = axes.iter().position(|a| *a == name) {
                powers.extend(vec![axis; if name == word { 1 } else { 2 }]);
                open = false;
                continue;
            }
            match word {
                "*" if !open => open = true,
                "+" | "-" if index == 0 => factor = if word == "-" { -1.0 } else { 1.0 },
                "+" | "-" | "" if !open => {
                    let term = start..start + text[start..at].trim_end().len();
                    let place = match powers[..] {
                        [] => &mut sum.constant,
                        [a] => &mut sum.linear[a],
                        [a, b] => &mut sum.quadratic[a.min(b)][a.max(b)],
                        _ => return Err(wrong(term, "terms of degree 0, 1 or 2")),
                    };
                    *place += factor;
                    if *place != 0.0 && !computable(*place, "") {
                        return Err(wrong(term, "coefficients of magnitude 1e-25 to 1e25"));
                    }
                    factor = if word == "-" { -1.0 } else { 1.0 };
                    (start, powers, open) = (at, Vec::new(), true);
                }
                _ => match word.parse::<f64>() {
                    Ok(number) if computable(number, word) => {
                        (factor, open) = (factor * number, false)
                    }
                    _ => {
                        let allowed = format!("a number or {}", axes.join(", "));
                        return Err(wrong(at..at + word.len(), &allowed));
                    }
                },
            }
        }
        Ok(sum)
    }
}

/// Numbers without sign, axes with their power, names and other characters of a text with their places, and its end.
fn words(text: &str) -> Vec<(usize, &str)> {
    let mut words = Vec::new();
    let mut at = 0;
    let run = |from: usize, test: fn(char) -> bool| {
        let rest = &text[from..];
        from + rest.len() - rest.trim_start_matches(test).len()
    };
    let digits: fn(char) -> bool = |c| c.is_ascii_digit() || c == '.';
    loop {
        at = run(at, char::is_whitespace);
        let mut end = run(at, digits);
        if end > at {
            let exponent = end + usize::from(text[end..].starts_with(['e', 'E']));
            let number = exponent + usize::from(text[exponent..].starts_with(['+', '-']));
            end = if exponent > end && run(number, digits) > number {
                run(number, digits)
            } else {
                end
            };
        } else if text[at..].starts_with(['x', 'y', 'z']) {
            end += if text[at + 1..].starts_with("^2") {
                3
            } else {
                1
            };
        } else {
            let one = text[at..].chars().next().map_or(0, char::len_utf8);
            end = run(at, char::is_alphabetic).max(at + one);
        }
        words.push((at, &text[at..end]));
        if end == at {
            return words;
        }
        at = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_add_up_and_move_with_the_origin() {
        let p = Polynomial::parse("-1e-3 + 2.5e+1x*y - 3 x^2 + y 4 + .5yx - 2", 2).unwrap();
        let exact = |x: f64, y: f64| -2.001 + 25.5 * x * y - 3.0 * x * x + 4.0 * y;
        for (x, y) in [(0.0, 0.0), (1.0, -2.0), (0.3, 0.7)] {
            assert!((p.at(&[x, y, 0.0]) - exact(x, y)).abs() < 1e-14);
            let moved = p.moved(&[5.0, -3.0, 0.0]);
            assert!((moved.at(&[x, y, 0.0]) - exact(x + 5.0, y - 3.0)).abs() < 1e-12);
        }
        assert_eq!(Polynomial::parse("7", 2).unwrap(), 7.0.into());
        assert_eq!(Polynomial::parse("2 z^2", 3).unwrap().quadratic[2][2], 2.0);
    }

    #[test]
    fn errors_point_at_the_offending_word() {
        let at = |text: &str| Polynomial::parse(text, 2).unwrap_err().at;
        for (text, place) in [
            ("", 0..0),
            ("2 z", 2..3),
            ("2 +", 3..3),
            ("high", 0..4),
            ("x^3", 1..2),
            ("3 x^2 y + 1", 0..7),
            ("1 + x y * x", 2..11),
            ("2 (x)", 2..3),
            ("1e99", 0..4),
            ("x + 1e-400", 4..10),
            ("1e20*1e20 x", 0..11),
            ("inf", 0..3),
            ("1..2", 0..4),
            ("x é", 2..4),
        ] {
            assert_eq!(at(text), place, "{text}");
        }
    }
}
