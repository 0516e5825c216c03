//! Numbers as text: fixed significant digits, so that equal results give equal files.

/// Significant digits of values in CSV files.
pub const VALUE_DIGITS: usize = 10;

/// Significant digits of times.
pub const TIME_DIGITS: usize = 4;

/// Significant digits of residuals.
pub const RESIDUAL_DIGITS: usize = 2;

/// Residuals below this are printed as 0: they are round-off, and would differ between machines.
pub const RESIDUAL_FLOOR: f64 = 1e-12;

/// A value with `digits` significant digits, trailing zeros dropped.
///
/// Plain notation for decimal exponents −4 to 9, otherwise scientific (`1.5e-7`). −0 is `0`; not-a-number is `NaN`,
/// infinities are `inf` and `-inf`, as pandas and numpy read them.
pub fn significant(value: f64, digits: usize) -> String {
    if value.is_nan() {
        return "NaN".into();
    }
    if value.is_infinite() {
        return if value > 0.0 { "inf" } else { "-inf" }.into();
    }
    if value == 0.0 {
        return "0".into();
    }
    let digits = digits.max(1);
    let scientific = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = scientific.split_once('e') else {
        return scientific;
    };
    let Ok(exponent) = exponent.parse::<i32>() else {
        return scientific;
    };
    if (-4..=9).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        // Where the digits end left of the point, round to them first: 4 digits of 123456 are 123500.
        let rounded: f64 = scientific.parse().unwrap_or(value);
        strip(&format!("{rounded:.decimals$}"))
    } else {
        format!("{}e{exponent}", strip(mantissa))
    }
}

/// A value of a CSV column.
pub fn value(value: f64) -> String {
    significant(value, VALUE_DIGITS)
}

/// A time in seconds.
pub fn time(seconds: f64) -> String {
    significant(seconds, TIME_DIGITS)
}

/// A residual; see [`RESIDUAL_FLOOR`].
pub fn residual(residual: f64) -> String {
    if residual.abs() < RESIDUAL_FLOOR {
        "0".into()
    } else {
        significant(residual, RESIDUAL_DIGITS)
    }
}

/// A value with a fixed number of decimals; never `-0.00`.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.starts_with('-') && text.chars().all(|c| matches!(c, '-' | '0' | '.')) {
        text[1..].into()
    } else {
        text
    }
}

fn strip(text: &str) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').into()
    } else {
        text.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_are_fixed_and_zeros_dropped() {
        for (number, text) in [
            (973.543_210_987_65e6, "973543211"),
            (0.1, "0.1"),
            (-1.0 / 3.0, "-0.3333333333"),
            (1e10, "1e10"),
            (1.234_567_890_123e-7, "1.23456789e-7"),
            (9_999_999_999.9, "1e10"),
            (0.000_02, "2e-5"),
            (-0.0, "0"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(value(number), text);
        }
        assert_eq!(time(123_456.0), "123500");
        assert_eq!(time(0.001_234_56), "0.001235");
    }

    #[test]
    fn residuals_below_the_floor_print_as_zero() {
        assert_eq!(residual(9.9e-13), "0");
        assert_eq!(residual(1.04e-12), "1e-12");
        assert_eq!(residual(3.456e-10), "3.5e-10");
        assert_eq!(residual(f64::NAN), "NaN");
    }

    #[test]
    fn fixed_decimals_have_no_negative_zero() {
        assert_eq!(fixed(-1e-9, 3), "0.000");
        assert_eq!(fixed(-1.782_853, 4), "-1.7829");
    }
}
