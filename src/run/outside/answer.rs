//! Answers of a program from outside: numbers in a file, and what it says of itself on its standard output.

use stickslip_methods::Status;

use crate::files::visible::excerpt;

/// Bytes of the file beside its numbers, and of each.
const BESIDE: u64 = 1 << 20;
const NUMBER: u64 = 64;

/// Largest file of so many numbers [bytes].
pub fn most(numbers: usize) -> u64 {
    BESIDE + NUMBER * numbers as u64
}

/// Most iterations that are believed: of any number of increments their sum is a number.
const MOST_ITERATIONS: usize = 1_000_000_000;

/// Ways to give up that a program may name. Without equilibrium is what the judge says, stopped what the harness does.
const NAMED: [Status; 5] = [
    Status::MaxIterations,
    Status::Stalled,
    Status::SingularTangent,
    Status::Mechanism,
    Status::Diverged,
];

/// The reactions, `dim` numbers per point, then one per rigid motion, apart by blanks or ends of lines.
///
/// # Errors
/// A number that is not finite, with its line, and another count than expected.
pub fn reactions(text: &str, rows: usize, motions: usize, dim: usize) -> Result<Vec<f64>, String> {
    let mut numbers = Vec::new();
    for (index, line) in text.lines().enumerate() {
        for word in line.split_whitespace() {
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() => numbers.push(number),
                _ => {
                    let (line, found) = (index + 1, excerpt(word, 40));
                    return Err(format!(
                        "line {line} of the reactions: `{found}` is no finite number"
                    ));
                }
            }
        }
    }
    if numbers.len() == rows + motions {
        return Ok(numbers);
    }
    let further = match motions {
        0 => "",
        _ => ", then 1 per rigid motion",
    };
    let (found, expected) = (numbers.len(), rows + motions);
    Err(format!(
        "{found} numbers for reactions, expected {expected}: {dim} per point{further}"
    ))
}

/// Account of a program of itself.
#[derive(Debug, Default, PartialEq)]
pub struct Said {
    /// Iterations as it counts them; 0 unless said.
    pub iterations: usize,
    /// Time by its own account [s].
    pub seconds: Option<f64>,
    /// Why it gave up.
    pub status: Option<Status>,
}

/// Reads lines `iterations = 12`, `seconds = 1.5e-3` and `status = stalled`; the last of a kind counts, all others are its
/// own business.
///
/// # Errors
/// Such a line with another value.
pub fn said(text: &str) -> Result<Said, String> {
    let mut said = Said::default();
    for line in text.lines() {
        let Some((key, value)) = line.split_once('=') else {
            continue;
        };
        let (key, value) = (key.trim(), value.trim());
        let known = match key {
            "iterations" => {
                let number = value.parse().ok();
                let number = number.filter(|number| *number <= MOST_ITERATIONS);
                number.map(|number| said.iterations = number)
            }
            "seconds" => {
                let seconds = value.parse::<f64>().ok();
                let seconds = seconds.filter(|s| s.is_finite() && *s >= 0.0);
                seconds.map(|seconds| said.seconds = Some(seconds))
            }
            "status" => {
                let status = NAMED.iter().find(|status| status.as_str() == value);
                status.map(|status| said.status = Some(*status))
            }
            _ => continue,
        };
        if known.is_none() {
            return Err(format!("it printed `{}`", excerpt(line.trim(), 80)));
        }
    }
    Ok(said)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_may_stand_as_they_like_but_must_be_there() {
        for text in ["1 2\n3 4\n", "1\n2\n3\n4", " 1e0\t2.0 3 4\r\n"] {
            assert_eq!(reactions(text, 4, 0, 2).unwrap(), [1.0, 2.0, 3.0, 4.0]);
        }
        let complaint = |text: &str| reactions(text, 3, 1, 3).unwrap_err();
        assert_eq!(
            complaint("1 2 3"),
            "3 numbers for reactions, expected 4: 3 per point, then 1 per rigid motion"
        );
        for word in ["nan", "-inf", "1e999", "1,5", "0x10", "\u{1b}[31m"] {
            let found = complaint(&format!("1 2\n3 {word}\n"));
            assert!(found.starts_with("line 2 of the reactions: `"), "{found}");
            assert!(!found.contains('\u{1b}'));
        }
    }

    #[test]
    fn what_it_says_of_itself_is_found_among_its_chatter() {
        let text =
            "hello = world\niterations = 3\n iterations=12\nseconds = 1.5e-3\nstatus = stalled";
        let expected = Said {
            iterations: 12,
            seconds: Some(1.5e-3),
            status: Some(Status::Stalled),
        };
        assert_eq!(said(text).unwrap(), expected);
        assert_eq!(said("nothing to say").unwrap(), Said::default());
        for line in [
            "iterations = -1",
            "iterations = many",
            "iterations = 1152921504606846976",
            "seconds = nan",
            "seconds = -1",
            "status = solved",
            "status = no-equilibrium",
        ] {
            assert_eq!(said(line).unwrap_err(), format!("it printed `{line}`"));
        }
    }
}
