//! Figures in words: with the digits that their bounds leave them, and with these bounds. A bound is how far a figure may be off
//! numerically, or the band of the contact laws that may be right.

use crate::format::{self, NONE, joined, significant};
use pinwheel_timeseries::table::Shown;

/// Significant digits of a figure of a design: what a data sheet gives.
const DIGITS: u8 = 4;
pub(crate) const SHOWN: Shown = Shown::Digits(DIGITS);

/// A figure of a design.
pub(crate) fn figure(value: f64) -> String {
    significant(value, usize::from(DIGITS))
}

/// A figure and its uncertainty, which may be empty.
pub(crate) fn bounded(value: f64, uncertainty: Option<f64>) -> [String; 2] {
    let (value, off) = format::bounded(value, uncertainty, 0.0);
    [value, off.replace('\u{202f}', " ")]
}

/// A figure of a design and its uncertainty, with no more digits than a data sheet gives.
pub(crate) fn known(value: f64, uncertainty: Option<f64>) -> [String; 2] {
    let [shown, off] = bounded(value, uncertainty);
    let least = 10_f64.powi(-i32::from(DIGITS)) * value.abs();
    match uncertainty {
        Some(u) if u > least => [shown, off],
        _ => [figure(value), off],
    }
}

/// [`known`] in a cell or a sentence.
pub(crate) fn with_uncertainty(value: Option<f64>, uncertainty: Option<f64>) -> String {
    value.map_or(NONE.to_owned(), |value| {
        joined(" ", known(value, uncertainty)).trim_end().to_owned()
    })
}

/// A value with the digits that a band leaves it: no digit below a fifth of the band's width.
pub(crate) fn rounded(value: f64, [low, high]: [f64; 2]) -> String {
    let width = high - low;
    if !(width > 0.0 && value.is_finite()) {
        return significant(value, 4);
    }
    let digit = (0.2 * width).log10().floor();
    if digit < -6.0 {
        let digits = value.abs().max(width).log10().floor() - digit + 1.0;
        return significant(value, digits.clamp(1.0, 4.0) as usize);
    }
    let unit = 10.0_f64.powf(digit);
    let decimals = (-digit).max(0.0) as usize;
    format!("{:.decimals$}", (value / unit).round() * unit)
}

/// `310 to 322`.
pub(crate) fn interval(band: [f64; 2]) -> String {
    let [low, high] = band.map(|end| rounded(end, band));
    format!("{low} to {high}")
}

/// Bounds of a figure: `310 to 322 by contact law; ± 0.2 numerical`. Without a band, or without the uncertainty `off` that has a
/// `cause`, that part is left out.
pub(crate) fn bounds(laws: Option<[f64; 2]>, off: &str, cause: &str) -> String {
    let laws = laws.map(|laws| format!("{} by contact law", interval(laws)));
    let off = (!off.is_empty()).then(|| format!("{off} {cause}"));
    joined("; ", laws.into_iter().chain(off))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_those_that_the_band_leaves() {
        assert_eq!(rounded(319.71, [310.2, 322.4]), "320");
        assert_eq!(interval([310.2, 322.4]), "310 to 322");
        assert_eq!(rounded(358.3, [226.0, 430.0]), "360");
        assert_eq!(rounded(0.05312, [0.048, 0.073]), "0.053");
        assert_eq!(rounded(5.0, [5.0, 5.0]), "5.000");
        assert_eq!(
            interval([2.19e-7, 5.72e-7]),
            "2.2\u{b7}10\u{207b}\u{2077} to 5.7\u{b7}10\u{207b}\u{2077}"
        );
    }
}
