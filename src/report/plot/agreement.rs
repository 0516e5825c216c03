//! Curves that a picture cannot tell apart.

use crate::report::number::{RESIDUAL_FLOOR, significant};

/// Difference that no picture shows, as a fraction of the range: a panel is about 600 pixels high.
const INVISIBLE: f64 = 1e-3;

/// Curves drawn as one, by index; the first is the one drawn.
pub struct Group {
    pub members: Vec<usize>,
    /// Largest difference of any two of them at any point.
    pub apart: f64,
}

/// Groups of curves, given by their values divided by the largest one: those that `may_join` join the first curve from
/// which they cannot be told and which is `alike`, all others stay alone.
pub fn groups(
    curves: &[Vec<f64>],
    may_join: impl Fn(usize) -> bool,
    alike: impl Fn(usize, usize) -> bool,
) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for index in 0..curves.len() {
        let fits = |group: &&mut Group| {
            let first = group.members[0];
            let close = difference(&curves[first], &curves[index]) <= INVISIBLE;
            may_join(first) && alike(first, index) && close
        };
        match groups.iter_mut().find(fits).filter(|_| may_join(index)) {
            Some(group) => group.members.push(index),
            None => groups.push(Group {
                members: vec![index],
                apart: 0.0,
            }),
        }
    }
    for group in &mut groups {
        let pairs = group.members.iter().enumerate();
        let pairs = pairs.flat_map(|(n, a)| group.members[..n].iter().map(move |b| (a, b)));
        let differences = pairs.map(|(a, b)| difference(&curves[*a], &curves[*b]));
        group.apart = differences.fold(0.0, f64::max);
    }
    groups
}

/// Largest difference at a point; infinite where the curves have different points or a value is not a number.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    if a.len() != b.len() {
        return f64::INFINITY;
    }
    let differences = a.iter().zip(b).map(|(x, y)| (x - y).abs());
    differences.fold(
        0.0,
        |m, d| if d.is_nan() { f64::INFINITY } else { d.max(m) },
    )
}

/// A difference in words: one digit, rounded up, and no round-off, which would differ between machines.
pub fn at_most(difference: f64) -> String {
    if difference < RESIDUAL_FLOOR {
        return format!("less than {}", significant(RESIDUAL_FLOOR, 1));
    }
    let power = 10f64.powi(difference.log10().floor() as i32);
    let up = (difference / power - 1e-9).ceil() * power;
    format!("at most {}", significant(up, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_join_what_they_cannot_be_told_from() {
        let curves = vec![
            vec![0.0, 1.0],
            vec![0.0, 1.0 - 4e-4],
            vec![0.0, 0.9],
            vec![0.0, 1.0 + 5e-4],
            vec![0.0, 0.9],
            vec![0.0, 1.0],
            vec![0.0, f64::NAN],
            vec![0.0],
        ];
        // The fifth is approximate, the sixth slips where the first sticks.
        let found = groups(&curves, |i| i != 4, |a, b| (a == 5) == (b == 5));
        let members: Vec<&[usize]> = found.iter().map(|g| g.members.as_slice()).collect();
        let expected: [&[usize]; 6] = [&[0, 1, 3], &[2], &[4], &[5], &[6], &[7]];
        assert_eq!(members, expected);
        assert!((found[0].apart - 9e-4).abs() < 1e-12, "of any two");
    }

    #[test]
    fn differences_are_rounded_up() {
        assert_eq!(at_most(3.2e-10), "at most 4e-10");
        assert_eq!(at_most(3e-10), "at most 3e-10");
        assert_eq!(at_most(9.7e-4), "at most 0.001");
        assert_eq!(at_most(2e-16), "less than 1e-12");
    }
}
