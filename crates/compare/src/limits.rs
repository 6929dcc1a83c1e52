//! Limits that users state, and which quantities and engines they are about.
//!
//! Patterns: `*` stands for any characters, `|` separates alternatives.

use serde::Serialize;

use crate::metrics::Metric;
use crate::windows::WindowKind;

/// Which scenes a tolerance applies to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Friction {
    /// All.
    Any,
    /// mu = 0.
    Without,
    /// mu > 0.
    With,
}

/// A limit that the owner of measured data states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StatedLimit {
    /// Name of the participant.
    pub engine: String,
    /// Window.
    pub window: WindowKind,
    /// Quantity, a pattern.
    pub quantity: String,
    /// Metric.
    pub metric: Metric,
    /// The limit itself.
    pub limit: f64,
    /// Why it is what it is.
    pub reason: String,
}

/// Forces and torques below this share of the scene's own scale are rounding, and are not judged: 16 digits, times
/// some ten thousand for what 28 bodies and a solver add.
pub const NEGLIGIBLE_SHARE: f64 = 1e-11;

/// Whether `text` fits `pattern`: `*` stands for any characters, `|` separates alternatives.
#[must_use]
pub fn fits(pattern: &str, text: &str) -> bool {
    pattern.split('|').any(|pattern| fits_one(pattern, text))
}

/// The walk with one place to fall back to: a pattern of many `*`, which a map may hold, takes no longer than others.
fn fits_one(pattern: &str, text: &str) -> bool {
    let (pattern, text) = (pattern.as_bytes(), text.as_bytes());
    let (mut p, mut t) = (0, 0);
    let mut star: Option<(usize, usize)> = None;
    while t < text.len() {
        match (pattern.get(p), &mut star) {
            (Some(b'*'), _) => {
                star = Some((p, t));
                p += 1;
            }
            (Some(c), _) if *c == text[t] => (p, t) = (p + 1, t + 1),
            (_, Some((at, from))) => {
                *from += 1;
                (p, t) = (*at + 1, *from);
            }
            (_, None) => return false,
        }
    }
    pattern[p..].iter().all(|&c| c == b'*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns() {
        for (pattern, text, wanted) in [
            ("*", "", true),
            ("*", "anything", true),
            ("native*", "native", true),
            ("native*", "native-reduced", true),
            ("native", "native-reduced", false),
            ("*_force_n", "external_sleeve_force_n", true),
            ("*_force_n", "force_n", false),
            ("rapier*hook*", "rapier-contact-hook", true),
            ("rapier*hook*", "rapier-shared-law", false),
            ("a|b*", "bc", true),
            ("a|b*", "ab", false),
            ("", "a", false),
            ("*a*b", "aab", true),
            ("*ab", "aab", true),
            ("*\u{e9}", "caf\u{e9}", true),
        ] {
            assert_eq!(fits(pattern, text), wanted, "{pattern} {text}");
        }
    }

    /// One fallback for every star would take 1e26 steps here.
    #[test]
    fn bad_input_patterns_of_many_stars_end() {
        let stars = "*".repeat(60_000);
        assert!(fits(&stars, "external_sleeve_force_n"));
        assert!(!fits(&format!("{stars}x"), "external_sleeve_force_n"));
        assert!(!fits(&"*e".repeat(9), "external_sleeve_force_n"));
    }
}
