//! Numbers as whole multiples of a quantum, short enough for a diff.

/// The power of ten not above `share` of `size` (1e-300 for nothing).
pub(super) fn quantum(size: f64, share: f64) -> f64 {
    let exponent = (size * share).log10().floor();
    if exponent.is_finite() {
        // Parsed, because powers computed in floating point are not the nearest numbers.
        format!("1e{}", exponent.clamp(-300.0, 300.0))
            .parse()
            .unwrap_or(1e-300)
    } else {
        1e-300
    }
}

/// `12 -3 4`: the values in quanta, rounded.
pub(super) fn to_line(values: &[f64], quantum: f64) -> String {
    let whole: Vec<String> = values
        .iter()
        .map(|value| format!("{:.0}", value / quantum))
        .map(|text| if text == "-0" { "0".to_owned() } else { text })
        .collect();
    whole.join(" ")
}

/// The values of a line; `None` if one is no number.
pub(super) fn from_line(line: &str, quantum: f64) -> Option<Vec<f64>> {
    line.split_whitespace()
        .map(|word| word.parse::<i64>().ok().map(|n| n as f64 * quantum))
        .map(|value| value.filter(|value| value.is_finite()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        assert_eq!(quantum(241.0, 1e-7), 1e-5);
        assert_eq!(quantum(0.0, 1e-7), 1e-300);
        let values = [1.234_567_89, -0.000_01, -3.0, 0.0];
        let q = quantum(3.0, 1e-4);
        let line = to_line(&values, q);
        assert_eq!(line, "12346 0 -30000 0");
        let back = from_line(&line, q).unwrap();
        assert!(
            values
                .iter()
                .zip(&back)
                .all(|(a, b)| (a - b).abs() <= 0.5 * q)
        );
        assert!(from_line("1 x", q).is_none());
    }
}
