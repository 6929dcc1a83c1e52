//! Difference of two figures of one definition, and its judgement.

use serde::Serialize;

use super::{Figure, FigureDef};

/// Judgement of two values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Judged {
    /// Equal to the last digit.
    Same,
    /// Values differ by no more than the sum of both uncertainties.
    BelowUncertainty,
    /// Values differ by more than the sum of both uncertainties.
    Differ,
    /// Values differ, but their uncertainty is unknown.
    NotKnown,
    /// Missing value on one side or both.
    Missing,
}

/// Figure of two gears or runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Diff {
    /// Definition.
    #[serde(flatten)]
    pub def: FigureDef,
    /// Both values.
    pub values: [Option<f64>; 2],
    /// Numerical uncertainty of each value; `None` if unknown.
    pub uncertainty: [Option<f64>; 2],
    /// Judgement of the change.
    pub judged: Judged,
}

/// Compares two figures of the definition of `a`.
pub fn diff(a: &Figure, b: &Figure) -> Diff {
    let values = [a.value, b.value];
    let uncertainty = [a.uncertainty, b.uncertainty];
    let judged = match (values, uncertainty) {
        ([Some(a), Some(b)], _) if a == b => Judged::Same,
        ([Some(a), Some(b)], [Some(u), Some(v)]) => match (a - b).abs() <= u + v {
            true => Judged::BelowUncertainty,
            false => Judged::Differ,
        },
        ([Some(_), Some(_)], _) => Judged::NotKnown,
        _ => Judged::Missing,
    };
    Diff {
        def: a.def.clone(),
        values,
        uncertainty,
        judged,
    }
}

impl Diff {
    /// Returns one of the two figures.
    pub fn figure(&self, k: usize) -> Figure {
        self.def.of(self.values[k], self.uncertainty[k])
    }

    /// Returns the relative change from the first to the second; `None` without a reference.
    pub fn change(&self) -> Option<f64> {
        let [a, b] = self.values;
        let (a, b) = (a?, b?);
        (a != 0.0).then(|| (b - a) / a.abs())
    }
}
