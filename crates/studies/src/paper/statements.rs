//! Statements of the paper with verdicts: rows of `reference/published/paper.toml`, filled with the numbers of the figures.
//!
//! Each number is computed once, for a figure; figures and claims are rows of that file, judged only by these numbers and the
//! file's conditions.

use serde::Deserialize;

use super::figure::{Claim, ClaimVerdict, JudgedClaim, Measured, PaperFigure, Plot};

/// Content of the file.
#[derive(Debug, Deserialize)]
pub struct Statements {
    /// Statements of figures.
    pub figure: Vec<Statement>,
    /// Statements in words.
    pub claim: Vec<Statement>,
}

/// Row of the file.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Statement {
    /// Key of the statement; for a figure that of its numbers.
    pub id: String,
    /// Figure or page of the paper.
    place: String,
    /// Title of the figure.
    title: String,
    /// Figure with the numbers for a claim.
    pub figure: String,
    /// Statement of the paper.
    says: String,
    /// Statement on Pinwheel's runs: a sentence with names of numbers in braces.
    found: String,
    /// Reason, with names of numbers in braces.
    pub why: String,
    /// Rule for the verdict on a claim, in words.
    pub judged_by: String,
    /// Axes and words of the figure's plots.
    plots: Vec<Plot>,
    holds_if: Vec<Condition>,
    partly_if: Vec<Condition>,
    partly_if_any: Vec<Condition>,
    /// Verdict on a statement that is not computed.
    verdict: Option<ClaimVerdict>,
}

/// Condition that a number, or its ratio to another, is within bounds.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Condition {
    number: String,
    over: Option<String>,
    above: Option<f64>,
    below: Option<f64>,
}

impl Condition {
    /// True if the condition is satisfied; false if a number is missing.
    fn holds(&self, of: &Measured) -> bool {
        let over = self.over.as_ref().map_or(1.0, |name| of.number(name));
        let value = of.number(&self.number) / over;
        value > self.above.unwrap_or(f64::NEG_INFINITY)
            && value < self.below.unwrap_or(f64::INFINITY)
    }
}

impl Statements {
    /// Reads the embedded file.
    ///
    /// # Errors
    /// The file is invalid, which a test excludes.
    pub fn read() -> Result<Self, toml::de::Error> {
        pinwheel_files::parse(include_str!(concat!(
            env!("PINWHEEL_SHIPPED"),
            "/reference/published/paper.toml"
        )))
    }
}

impl Statement {
    fn verdict(&self, of: &Measured) -> ClaimVerdict {
        let all = |list: &[Condition]| !list.is_empty() && list.iter().all(|one| one.holds(of));
        let sometimes =
            || all(&self.partly_if) || self.partly_if_any.iter().any(|one| one.holds(of));
        match self.verdict {
            Some(verdict) => verdict,
            None if all(&self.holds_if) => ClaimVerdict::Holds,
            None if sometimes() => ClaimVerdict::Conditional,
            None => ClaimVerdict::DoesNotHold,
        }
    }

    /// Returns the figure of these numbers and curves.
    pub(super) fn figure(&self, of: Measured) -> PaperFigure {
        let plots = of.plots.iter().map(|(key, x, curves)| {
            let words = self.plots.iter().find(|plot| plot.key == *key);
            let words = words.cloned().unwrap_or_default();
            Plot {
                key: key.clone(),
                title: filled(&words.title, &of).0,
                x: x.clone(),
                curves: curves.clone(),
                ..words
            }
        });
        PaperFigure {
            id: self.id.clone(),
            name: self.place.clone(),
            title: self.title.clone(),
            says: self.says.clone(),
            found: filled(&self.found, &of).0,
            why: filled(&self.why, &of).0,
            verdict: self.verdict(&of),
            plots: plots.collect(),
            numbers: of.numbers,
        }
    }

    /// Returns the claim, judged by these numbers.
    pub fn claim(&self, of: &Measured) -> JudgedClaim {
        let (figure, numbers) = filled(&self.found, of);
        JudgedClaim {
            claim: Claim {
                id: self.id.clone(),
                claim: self.says.clone(),
                place: self.place.clone(),
                judged_by: self.judged_by.clone(),
                remark: self.why.clone(),
            },
            figure,
            numbers,
            verdict: self.verdict(of),
        }
    }
}

/// Returns a sentence with its numbers and words filled in, and the numbers in their order.
fn filled(text: &str, of: &Measured) -> (String, Vec<f64>) {
    let (mut sentence, mut numbers) = (String::new(), Vec::new());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('{') {
        let (name, tail) = after.split_once('}').unwrap_or((after, ""));
        sentence.push_str(before);
        if let Some((name, format)) = name.rsplit_once(':') {
            numbers.push(of.number(name));
            sentence.push_str(&formatted(of.number(name), format));
        } else if let Some((_, word)) = of.words.iter().find(|(known, _)| *known == name) {
            sentence.push_str(word);
        }
        rest = tail;
    }
    sentence.push_str(rest);
    (sentence, numbers)
}

/// Formats a number by `.2`, `+.2` or `.2e` as Rust's `format!`; a final `%` gives a percentage.
fn formatted(value: f64, format: &str) -> String {
    let digits = format.trim_matches(|c: char| !c.is_ascii_digit());
    let digits: usize = digits.parse().unwrap_or_default();
    let factor = if format.ends_with('%') { 100.0 } else { 1.0 };
    let value = factor * value;
    if format.starts_with('+') {
        format!("{value:+.digits$}")
    } else if format.ends_with('e') {
        format!("{value:.digits$e}")
    } else {
        format!("{value:.digits$}")
    }
}
