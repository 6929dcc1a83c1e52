//! Numbers in messages: short, and rounded to the safe side where they are advice.

/// Nearly half a unit in the last place, so that a value of four digits stays what it is.
const LEAN: f64 = 0.499_999_99;

/// Six significant digits, no trailing zeros.
pub(crate) fn short(value: f64) -> String {
    rounded(value, 6, 0.0)
}

/// Four significant digits, never above `value`: advice that keeps its promise.
pub(crate) fn below(value: f64) -> String {
    rounded(value, 4, -LEAN)
}

/// Four significant digits, never below `value`.
pub(crate) fn above(value: f64) -> String {
    rounded(value, 4, LEAN)
}

/// Rounds to `digits` significant digits after moving half a unit in the last place by `lean`.
fn rounded(value: f64, digits: i32, lean: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let unit = 10_f64.powi(value.abs().log10().floor() as i32 + 1 - digits);
    let leaned = value + lean * unit;
    let text = format!("{leaned:.*e}", (digits - 1) as usize);
    // Parsing back drops trailing zeros and lets Display choose the notation.
    let number: f64 = text.parse().unwrap_or(leaned);
    if (1e-5..1e9).contains(&number.abs()) {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roundings_stay_on_their_side() {
        assert_eq!(short(0.0131225849), "0.0131226");
        assert_eq!(short(2.0e11), "2e11");
        assert_eq!(short(16.0), "16");
        assert_eq!(above(0.006 + 0.0028), "0.0088");
        for value in [
            0.013_122_58,
            0.029_299_999,
            1.0e-7,
            12_345.678,
            9.999_99,
            0.0088,
        ] {
            assert!(
                below(value).parse::<f64>().unwrap() <= value,
                "{}",
                below(value)
            );
            assert!(
                above(value).parse::<f64>().unwrap() >= value,
                "{}",
                above(value)
            );
        }
    }
}
