//! Figures and claims of the paper as data: the paper's statement, our curves and numbers, the verdict.

use pinwheel_timeseries::figure::{Figure, FigureDef};
use serde::{Deserialize, Serialize};

/// Verdict on a statement of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimVerdict {
    /// Our figures confirm the statement.
    Holds,
    /// True under a condition the paper does not make; the remark names it.
    Conditional,
    /// Our figures contradict the statement.
    DoesNotHold,
    /// The claim has no meaning that could be computed.
    Meaningless,
}

impl ClaimVerdict {
    /// Returns the verdict in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Conditional => "holds under a condition",
            Self::DoesNotHold => "does not hold",
            Self::Meaningless => "has no meaning",
        }
    }
}

/// Claim of the paper.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Claim {
    /// Key.
    pub id: String,
    /// Statement of the paper.
    pub claim: String,
    /// Figure or page of the paper.
    pub place: String,
    /// Computation that judges it.
    pub judged_by: String,
    /// Reason for the verdict.
    pub remark: String,
}

/// A claim with our figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JudgedClaim {
    /// The claim.
    pub claim: Claim,
    /// Our figure, in words with units.
    pub figure: String,
    /// The numbers in that figure, in its order.
    pub numbers: Vec<f64>,
    /// The verdict.
    pub verdict: ClaimVerdict,
}

/// Figure of the paper computed again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PaperFigure {
    /// Key, such as `fig-07`; a word where the paper has no such figure.
    pub id: String,
    /// `Fig. 7`, or a word.
    pub name: String,
    /// Title of the drawing.
    pub title: String,
    /// Statement of the paper about the figure.
    pub says: String,
    /// Statement of our runs, with the numbers.
    pub found: String,
    /// Cause of the difference, or the condition of the verdict.
    pub why: String,
    /// The numbers of `found`, for programs.
    pub numbers: Vec<Figure>,
    /// Verdict on whether ours show what the paper says.
    pub verdict: ClaimVerdict,
    /// The curves.
    pub plots: Vec<Plot>,
}

/// Curves on one pair of axes, the paper's.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plot {
    /// `fig-07a`: name of its data file.
    pub key: String,
    /// Heading.
    pub title: String,
    /// Horizontal axis with its unit, e.g. `Time (s)`.
    pub x_label: String,
    /// Vertical axis with its unit.
    pub y_label: String,
    /// True if the vertical axis is logarithmic.
    pub y_log: bool,
    /// Horizontal values.
    #[serde(skip)]
    pub x: Vec<f64>,
    /// Curves over `x`; not a number where a curve has no value.
    #[serde(skip_deserializing)]
    pub curves: Vec<Curve>,
    /// Note on what to look at.
    pub note: String,
}

/// One curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Name in the legend.
    pub label: String,
    /// Drawn as single points instead of a line.
    pub points: bool,
    /// Values, as many as its plot has abscissae.
    #[serde(skip)]
    pub y: Vec<f64>,
}

impl Curve {
    /// A line.
    pub(super) fn line(label: impl Into<String>, y: impl Into<Vec<f64>>) -> Self {
        Self {
            label: label.into(),
            points: false,
            y: y.into(),
        }
    }

    /// Single points.
    pub(super) fn points(label: impl Into<String>, y: impl Into<Vec<f64>>) -> Self {
        Self {
            points: true,
            ..Self::line(label, y)
        }
    }
}

/// Numbers and curves of a figure, without the statements about it.
#[derive(Debug, Default)]
pub struct Measured {
    /// Key of the figure.
    pub(super) id: &'static str,
    /// Numbers by their names.
    pub numbers: Vec<Figure>,
    /// Words of the sentences that are no numbers.
    pub words: Vec<(&'static str, String)>,
    pub(super) plots: Vec<Drawn>,
}

/// Key of a plot, its horizontal values, and its curves over them.
pub(super) type Drawn = (String, Vec<f64>, Vec<Curve>);

impl Measured {
    /// Returns the numbers and curves of a figure.
    pub(super) fn new(id: &'static str, numbers: Vec<Figure>, plots: Vec<Drawn>) -> Self {
        Self {
            id,
            numbers,
            plots,
            ..Self::default()
        }
    }

    /// Returns a number by its name; NaN without one.
    pub(super) fn number(&self, name: &str) -> f64 {
        let found = self.numbers.iter().find(|number| number.def.key == name);
        found.and_then(|number| number.value).unwrap_or(f64::NAN)
    }
}

/// Returns a number with its name in `snake_case`; the unit is empty for ratios.
pub fn number(name: impl Into<String>, value: f64, unit: &'static str) -> Figure {
    let name = name.into();
    let label = name.replace('_', " ");
    FigureDef::named(name, label, unit).of(value, None)
}
