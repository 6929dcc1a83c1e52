//! Numbers in messages: short, and rounded to the safe side for advice.

/// Slightly less than half a unit in the last place, so that a value of four digits is unchanged.
const LEAN: f64 = 0.499_999_99;

/// Formats with six significant digits, without trailing zeros.
pub fn short(value: f64) -> String {
    rounded(value, 6, 0.0)
}

/// Formats with four significant digits, never above `value`.
pub fn below(value: f64) -> String {
    rounded(value, 4, -LEAN)
}

/// Formats with four significant digits, never below `value`.
pub fn above(value: f64) -> String {
    rounded(value, 4, LEAN)
}

/// Formats a value for a scene file, without the rounding error of the last bit: 0.0065, not 0.006500000000000001.
pub fn written(value: f64) -> String {
    format!("{:?}", nearest(value, 12))
}

/// Rounds to `digits` significant digits after moving half a unit in the last place by `lean`.
fn rounded(value: f64, digits: i32, lean: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let unit = 10_f64.powi(value.abs().log10().floor() as i32 + 1 - digits);
    let number = nearest(value + lean * unit, digits);
    if (1e-5..1e9).contains(&number.abs()) {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

/// Rounds a value to `digits` significant digits. Parsing back drops trailing zeros.
pub(crate) fn nearest(value: f64, digits: i32) -> f64 {
    let text = format!("{value:.*e}", (digits - 1) as usize);
    text.parse().unwrap_or(value)
}

/// Rounds a length, m, down to two significant digits in millimetres, as on a drawing.
pub fn rounded_down(length_m: f64) -> f64 {
    let mm = 1e3 * length_m;
    if !(mm > 0.0 && mm.is_finite()) {
        return length_m;
    }
    let unit = 10_f64.powi(mm.log10().floor() as i32 - 1);
    // A number of two digits stays the same in spite of its last bit.
    let digits = (mm / unit + 1e-9).floor();
    nearest(digits * unit * 1e-3, 12)
}
