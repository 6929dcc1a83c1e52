//! Numbers as text with significant digits only.

/// Text for a missing value.
pub const NONE: &str = "\u{2013}";

/// Formats a figure with five significant digits, e.g. `1.4529`, `100.42`, `-22.000`.
pub fn figure(value: f64) -> String {
    significant(value, 5)
}

/// Formats `digits` significant digits; powers of ten outside 1e-3 .. 1e6.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "not finite".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = exponent_after_rounding(value, digits);
    if (-3..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        minus(&format!("{value:.decimals$}"))
    } else {
        power(value, digits)
    }
}

/// Formats a relative difference with two significant digits: per cent from 1e-3 on, powers of ten below.
pub fn relative(value: f64) -> String {
    if value.is_finite() && value.abs() >= 1e-3 {
        format!("{}\u{202f}%", significant(100.0 * value, 2))
    } else if value == 0.0 {
        "0".to_owned()
    } else {
        power(value, 2)
    }
}

/// Formats a relative difference, if any.
pub fn relative_or_none(value: Option<f64>) -> String {
    value.map_or_else(|| NONE.to_owned(), relative)
}

/// Formats a limit with its original digits, at most three.
pub fn limit(value: f64) -> String {
    let value: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if value >= 1e-3 {
        let percent = format!("{:.10}", 100.0 * value);
        return format!("{}\u{202f}%", minus(trim_zeros(&percent)));
    }
    let text = raised(&format!("{value:e}"));
    text.strip_prefix("1\u{b7}").unwrap_or(&text).to_owned()
}

/// Formats a duration with a prefix, e.g. `10 µs`, `0.42 s`, `3.1 min`.
pub fn seconds(value: f64) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    let (scaled, unit) = match value.abs() {
        v if v < 1e-6 && v > 0.0 => (value * 1e9, "ns"),
        v if v < 1e-3 && v > 0.0 => (value * 1e6, "\u{b5}s"),
        v if v < 0.1 && v > 0.0 => (value * 1e3, "ms"),
        v if v < 120.0 => (value, "s"),
        _ => (value / 60.0, "min"),
    };
    format!("{}\u{202f}{unit}", trim_zeros(&significant(scaled, 3)))
}

/// Formats a length of any size, e.g. `1.2 nm`.
pub fn metres(value: f64) -> String {
    let (scaled, unit) = match value.abs() {
        0.0 => return "0".to_owned(),
        v if v < 1e-12 => return format!("{}\u{202f}m", power(value, 2)),
        v if v < 1e-9 => (value * 1e12, "pm"),
        v if v < 1e-6 => (value * 1e9, "nm"),
        v if v < 1e-3 => (value * 1e6, "\u{b5}m"),
        v if v < 1.0 => (value * 1e3, "mm"),
        _ => (value, "m"),
    };
    format!("{}\u{202f}{unit}", significant(scaled, 2))
}

/// Formats a share in percent with its sign; 0 has a plus.
pub fn signed_percent(share: f64) -> String {
    let hundredths = (1e4 * share).round() + 0.0;
    format!("{:+.2}", hundredths / 100.0)
}

/// Formats a setting with at most six digits: `1e-6`, not `1.0000000000000002e-6`.
pub fn plain(value: f64) -> String {
    let meant: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if value != 0.0 && !(1e-4..1e6).contains(&meant.abs()) {
        return format!("{meant:e}");
    }
    minus(&meant.to_string())
}

/// Formats a figure without digits below those of its uncertainty; a value below the uncertainty is 0. Returns the figure
/// and its bound (`± 3·10⁻⁷`), which may be empty.
pub fn bounded(value: f64, uncertainty: Option<f64>) -> (String, String) {
    let uncertainty = uncertainty.filter(|u| u.is_finite());
    let bound = uncertainty.unwrap_or(0.0);
    if value.is_finite() && value.abs() <= bound {
        return ("0".to_owned(), plus_minus(bound));
    }
    let Some(u) = uncertainty.filter(|u| *u > 0.0) else {
        return (figure(value), String::new());
    };
    let first = exponent_after_rounding(value, 5);
    let last = exponent_after_rounding(u, 1);
    let digits = first - last + 1;
    let text = if digits >= 5 {
        figure(value)
    } else if (-3..6).contains(&first) {
        // Decimals of the uncertainty, not significant digits: rounding may add a leading digit.
        minus(&format!("{value:.*}", (-last).max(0) as usize))
    } else {
        significant(value, digits.max(1) as usize)
    };
    (text, plus_minus(u))
}

/// Formats a bound, `± 0.2`; empty for 0.
pub fn plus_minus(bound: f64) -> String {
    match bound > 0.0 {
        true => format!("\u{b1}\u{202f}{}", significant(bound, 1)),
        false => String::new(),
    }
}

/// Returns a readable unit for values of that size, and the factor to it: micrometres, minutes of arc.
pub fn readable_unit(unit: &str, largest: f64) -> (String, f64) {
    const ARCMIN: f64 = 60.0 * 180.0 / std::f64::consts::PI;
    let steps: &[(f64, &str, f64)] = match unit {
        "m" => &[(1e-3, "\u{b5}m", 1e6), (1.0, "mm", 1e3)],
        "s" => &[(1e-3, "\u{b5}s", 1e6), (0.1, "ms", 1e3)],
        "rad" => &[(0.02, "arcmin", ARCMIN)],
        _ => &[],
    };
    let fits = |(most, ..): &&(f64, &str, f64)| largest < *most;
    let fitting = steps.iter().find(fits).filter(|_| largest > 0.0);
    let (_, unit, factor) = fitting.copied().unwrap_or((0.0, unit, 1.0));
    (unit.to_owned(), factor)
}

/// Formats a count in groups of three digits.
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Returns a count with its noun: `1 figure`, `2 figures`.
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Groups values by key, in the order of the keys' first appearance.
pub fn grouped<K: PartialEq, V>(all: impl IntoIterator<Item = (K, V)>) -> Vec<(K, Vec<V>)> {
    let mut groups: Vec<(K, Vec<V>)> = Vec::new();
    for (key, value) in all {
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, values)) => values.push(value),
            None => groups.push((key, vec![value])),
        }
    }
    groups
}

/// Removes duplicates, in the order of their first appearance.
pub fn distinct<T: PartialEq>(all: impl IntoIterator<Item = T>) -> Vec<T> {
    let groups = grouped(all.into_iter().map(|one| (one, ()))).into_iter();
    groups.map(|(one, _)| one).collect()
}

/// Joins words.
pub fn joined<W: AsRef<str>>(separator: &str, words: impl IntoIterator<Item = W>) -> String {
    let mut text = String::new();
    for (k, word) in words.into_iter().enumerate() {
        text.push_str(if k > 0 { separator } else { "" });
        text.push_str(word.as_ref());
    }
    text
}

/// Returns the text without trailing zeros of the decimals.
fn trim_zeros(text: &str) -> &str {
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => text,
    }
}

fn exponent_after_rounding(value: f64, digits: usize) -> i32 {
    // The format rounds, so 9.99996 with five digits has exponent 1.
    let text = format!("{value:.precision$e}", precision = digits.saturating_sub(1));
    let exponent = text.rsplit_once('e').map(|(_, exponent)| exponent);
    exponent
        .and_then(|exponent| exponent.parse().ok())
        .unwrap_or(0)
}

fn power(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "not finite".to_owned();
    }
    let precision = digits.saturating_sub(1);
    raised(&format!("{value:.precision$e}"))
}

/// Writes the exponent of a number such as `1.2e-7` raised: `1.2·10⁻⁷`.
fn raised(text: &str) -> String {
    const RAISED: [char; 10] = [
        '\u{2070}', '\u{b9}', '\u{b2}', '\u{b3}', '\u{2074}', '\u{2075}', '\u{2076}', '\u{2077}',
        '\u{2078}', '\u{2079}',
    ];
    let digit = |c: char| c.to_digit(10).map_or('\u{207b}', |d| RAISED[d as usize]);
    let Some((mantissa, exponent)) = text.split_once('e') else {
        return text.to_owned();
    };
    let exponent: String = exponent.chars().map(digit).collect();
    format!("{}\u{b7}10{exponent}", minus(mantissa))
}

/// Returns the text of a number with a minus sign for its hyphen.
pub fn minus(text: &str) -> String {
    text.replacen('-', "\u{2212}", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures() {
        for (value, text) in [
            (1.452_88, "1.4529"),
            (100.417_2, "100.42"),
            (-22.0, "\u{2212}22.000"),
            (9.999_96, "10.000"),
            (0.0, "0"),
            (1.234_56e-7, "1.2346\u{b7}10\u{207b}\u{2077}"),
            (f64::NAN, "not finite"),
        ] {
            assert_eq!(figure(value), text);
        }
        assert_eq!(significant(123_456.0, 2), "123456");
    }

    #[test]
    fn relatives_and_limits() {
        assert_eq!(relative(0.0151), "1.5\u{202f}%");
        assert_eq!(relative(1.84e-5), "1.8\u{b7}10\u{207b}\u{2075}");
        assert_eq!(relative(0.0), "0");
        assert_eq!(limit(1e-4), "10\u{207b}\u{2074}");
        assert_eq!(limit(2e-3), "0.2\u{202f}%");
        assert_eq!(limit(1.5e-2), "1.5\u{202f}%");
        assert_eq!(limit(2.5e-9), "2.5\u{b7}10\u{207b}\u{2079}");
        assert_eq!(limit(0.1), "10\u{202f}%");
        assert_eq!(limit(5.459_159e-5), "5.46\u{b7}10\u{207b}\u{2075}");
    }

    #[test]
    fn settings_and_what_is_nothing() {
        assert_eq!(plain(1.000_000_000_000_000_2e-6), "1e-6");
        assert_eq!(plain(0.1 + 0.2), "0.3");
        assert_eq!(plain(-0.000_25), "\u{2212}0.00025");
        assert_eq!(plain(0.0), "0");
        let zero = |text: &str| ("0".to_owned(), text.to_owned());
        assert_eq!(
            bounded(-3.5867e-30, None),
            (
                "\u{2212}3.5867\u{b7}10\u{207b}\u{b3}\u{2070}".to_owned(),
                String::new()
            )
        );
        assert_eq!(
            bounded(-3.5867e-30, Some(2.2e-11)),
            zero("\u{b1}\u{202f}2\u{b7}10\u{207b}\u{b9}\u{b9}")
        );
        assert_eq!(bounded(0.003, Some(0.004)), zero("\u{b1}\u{202f}0.004"));
        assert_eq!(
            bounded(1.5, Some(0.004)),
            ("1.500".to_owned(), "\u{b1}\u{202f}0.004".to_owned())
        );
        for (value, u, text) in [
            (1.4564, 0.03, "1.46"),
            (99.919, 2.0, "100"),
            (132.45, 1.7, "132"),
            (1.452_88, 1e-7, "1.4529"),
            (9.9999, 0.01, "10.00"),
        ] {
            assert_eq!(bounded(value, Some(u)).0, text);
        }
    }

    #[test]
    fn units_that_people_use() {
        assert_eq!(readable_unit("m", 6e-4), ("\u{b5}m".to_owned(), 1e6));
        assert_eq!(readable_unit("m", 0.05), ("mm".to_owned(), 1e3));
        assert_eq!(readable_unit("N m", 1e-9), ("N m".to_owned(), 1.0));
        assert_eq!(readable_unit("rad", 1e-3).0, "arcmin");
        assert_eq!(readable_unit("s", 0.0), ("s".to_owned(), 1.0));
    }

    #[test]
    fn durations_and_counts() {
        assert_eq!(seconds(1e-5), "10\u{202f}\u{b5}s");
        assert_eq!(seconds(2e-7), "200\u{202f}ns");
        assert_eq!(seconds(0.423), "0.423\u{202f}s");
        assert_eq!(seconds(3600.0), "60\u{202f}min");
        assert_eq!(seconds(0.0), "0\u{202f}s");
        assert_eq!(metres(1.24e-9), "1.2\u{202f}nm");
        assert_eq!(count(1_200_000), "1\u{202f}200\u{202f}000");
        assert_eq!(count(999), "999");
    }
}
