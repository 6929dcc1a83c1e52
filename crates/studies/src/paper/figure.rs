//! Figures and claims of the paper as data: the paper's statement, Pinwheel's curves and numbers, the verdict.

use pinwheel_timeseries::figure::{Figure, FigureDef};
use serde::{Deserialize, Serialize};

/// Verdict on a statement of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimVerdict {
    /// Statement confirmed by Pinwheel's figures.
    Holds,
    /// Statement that is true under a condition missing in the paper, which the remark states.
    Conditional,
    /// Statement contradicted by Pinwheel's figures.
    DoesNotHold,
    /// Claim without a computable meaning.
    Meaningless,
}

impl ClaimVerdict {
    /// Returns the verdict in words.
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
    /// Key of the claim.
    pub id: String,
    /// Statement of the paper.
    pub claim: String,
    /// Figure or page of the paper.
    pub place: String,
    /// Computation for the verdict.
    pub judged_by: String,
    /// Reason for the verdict.
    pub remark: String,
}

/// Claim with Pinwheel's figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JudgedClaim {
    /// Claim of the paper.
    pub claim: Claim,
    /// Pinwheel's figure, in words with units.
    pub figure: String,
    /// Numbers in that figure, in order.
    pub numbers: Vec<f64>,
    /// Verdict on the claim.
    pub verdict: ClaimVerdict,
}

/// Figure of the paper, recomputed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PaperFigure {
    /// Key, such as `fig-07`; a word if the paper has no such figure.
    pub id: String,
    /// Name such as `Fig. 7`, or a word.
    pub name: String,
    /// Title of the drawing.
    pub title: String,
    /// Statement of the paper on the figure.
    pub says: String,
    /// Statement on Pinwheel's runs, with the numbers.
    pub found: String,
    /// Cause of the difference, or the condition of the verdict.
    pub why: String,
    /// Numbers of `found`, for programs.
    pub numbers: Vec<Figure>,
    /// Verdict on the agreement with the paper's statement.
    pub verdict: ClaimVerdict,
    /// Curves of the figure.
    pub plots: Vec<Plot>,
}

/// Curves on one pair of the paper's axes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plot {
    /// Name of its data file, such as `fig-07a`.
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
    /// Curves over `x`; NaN where a curve has no value.
    #[serde(skip_deserializing)]
    pub curves: Vec<Curve>,
    /// Note for the reader of the plot.
    pub note: String,
}

/// Curve of a plot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Name in the legend.
    pub label: String,
    /// True for single points instead of a line.
    pub points: bool,
    /// Values, one for each of the plot's abscissae.
    #[serde(skip)]
    pub y: Vec<f64>,
}

impl Curve {
    /// Makes a line.
    pub(super) fn line(label: impl Into<String>, y: impl Into<Vec<f64>>) -> Self {
        Self {
            label: label.into(),
            points: false,
            y: y.into(),
        }
    }

    /// Makes single points.
    pub(super) fn points(label: impl Into<String>, y: impl Into<Vec<f64>>) -> Self {
        Self {
            points: true,
            ..Self::line(label, y)
        }
    }
}

/// Numbers and curves of a figure, without its statements.
#[derive(Debug, Default)]
pub struct Measured {
    /// Key of the figure.
    pub(super) id: &'static str,
    /// Numbers, by name.
    pub numbers: Vec<Figure>,
    /// Words for the sentences, other than numbers.
    pub words: Vec<(&'static str, String)>,
    pub(super) plots: Vec<Drawn>,
}

/// Key of a plot, its horizontal values, and its curves.
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

    /// Returns a number by its name; NaN if missing.
    pub(super) fn number(&self, name: &str) -> f64 {
        let number = self.numbers.iter().find(|number| number.def.key == name);
        number.and_then(|number| number.value).unwrap_or(f64::NAN)
    }
}

/// Makes a number with its name in `snake_case`; the unit is empty for ratios.
pub fn number(name: impl Into<String>, value: f64, unit: &'static str) -> Figure {
    let name = name.into();
    let label = name.replace('_', " ");
    FigureDef::named(name, label, unit).of(value, None)
}
