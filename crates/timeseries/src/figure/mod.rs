//! Figure: a number with its definition, numerical uncertainty and bands.
//!
//! ```
//! use pinwheel_timeseries::figure::{FigureDef, Judged, diff};
//!
//! static PLAY: FigureDef = FigureDef::new("play_arcmin", "free play", "arcmin", "largest over the mesh", 4);
//! let [one, other] = [1.2, 1.3].map(|value| PLAY.of(value, 0.06));
//! assert_eq!(diff(&one, &other).judged, Judged::BelowUncertainty);
//! ```

pub mod definitions;
mod diff;
mod spread;

use std::borrow::Cow;

use serde::Serialize;

pub use diff::{Diff, Judged, diff};
pub use spread::Spread;

/// Definition of a figure.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FigureDef {
    /// Name for programs, with the unit at its end.
    pub key: Cow<'static, str>,
    /// Name for people.
    #[serde(rename = "what")]
    pub label: Cow<'static, str>,
    /// Unit for people; empty for counts.
    pub unit: Cow<'static, str>,
    /// Rule by which the figure is evaluated; empty if the label states it.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub how: &'static str,
    /// Significant digits at most.
    #[serde(skip)]
    pub digits: u8,
}

/// Figure: definition, value and uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// Definition.
    #[serde(flatten)]
    pub def: FigureDef,
    /// Value in the definition's unit; `None` if undefined.
    pub value: Option<f64>,
    /// Reason why there is no value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub withheld: Option<String>,
    /// Numerical uncertainty of the value; `None` if unknown.
    #[serde(rename = "numerical_uncertainty")]
    pub uncertainty: Option<f64>,
    /// Part of the uncertainty from sampling; `None` for a figure without samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampling: Option<f64>,
    /// Values over the mesh, for a figure evaluated at each pose.
    #[serde(flatten)]
    pub over_mesh: Option<OverMesh>,
    /// Least and largest over the contact laws that may suit these materials; `None` if none was compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_contact_law: Option<[f64; 2]>,
    /// Least and largest over the possible fits; `None` if none was compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_fit: Option<[f64; 2]>,
}

/// Values of a figure over the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OverMesh {
    /// Least and largest.
    #[serde(rename = "over_the_mesh")]
    pub ends: [f64; 2],
    /// Numerical uncertainty of the least and of the largest.
    #[serde(rename = "over_the_mesh_numerical_uncertainty")]
    pub uncertainty: [f64; 2],
    /// Mean.
    #[serde(rename = "mean_over_the_mesh")]
    pub mean: f64,
}

impl FigureDef {
    /// Makes a definition from literals.
    pub const fn new(
        key: &'static str,
        label: &'static str,
        unit: &'static str,
        how: &'static str,
        digits: u8,
    ) -> Self {
        Self {
            key: Cow::Borrowed(key),
            label: Cow::Borrowed(label),
            unit: Cow::Borrowed(unit),
            how,
            digits,
        }
    }

    /// Makes the definition of a figure of a run or a scene, with computed names.
    pub fn named(
        key: impl Into<Cow<'static, str>>,
        label: impl Into<Cow<'static, str>>,
        unit: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self {
            key: key.into(),
            label: label.into(),
            unit: unit.into(),
            ..Self::new("", "", "", "", 5)
        }
    }

    /// Returns the figure of a value with this uncertainty; a value that is not finite counts as missing.
    pub fn of(&self, value: impl Into<Option<f64>>, uncertainty: impl Into<Option<f64>>) -> Figure {
        let value = value.into().filter(|value| value.is_finite());
        Figure {
            def: self.clone(),
            value,
            withheld: None,
            uncertainty: value.and(uncertainty.into()),
            sampling: None,
            over_mesh: None,
            by_contact_law: None,
            by_fit: None,
        }
    }
}

impl Figure {
    /// True if `def` defines the figure.
    pub fn is(&self, def: &FigureDef) -> bool {
        self.def.key == def.key
    }

    /// Returns the figure without a value, with the reason.
    #[must_use]
    pub fn withheld(self, why: impl Into<Option<String>>) -> Self {
        Self {
            withheld: why.into(),
            ..self.def.of(None, None)
        }
    }

    /// Returns the figure with its values over the mesh, whose relative uncertainty is `off`.
    #[must_use]
    pub fn over(self, spread: &Spread, off: f64) -> Self {
        let ends = [spread.min, spread.max];
        let over_mesh = Some(OverMesh {
            ends,
            uncertainty: ends.map(|end| off * end.abs()),
            mean: spread.mean,
        });
        Self { over_mesh, ..self }
    }

    /// Returns value and uncertainty in another unit, `factor` times as large, without bands.
    pub fn scaled(&self, factor: f64, unit: impl Into<Cow<'static, str>>) -> Self {
        let scaled = |value: Option<f64>| value.map(|value| factor * value);
        let unit = unit.into();
        let def = FigureDef {
            unit,
            ..self.def.clone()
        };
        Self {
            sampling: scaled(self.sampling),
            ..def.of(scaled(self.value), scaled(self.uncertainty))
        }
    }

    /// True if sampling causes more than half of the uncertainty.
    pub fn is_off_by_sampling(&self) -> bool {
        let both = self.sampling.zip(self.uncertainty);
        both.is_some_and(|(sampling, all)| sampling > 0.5 * all)
    }

    /// Returns the intervals by contact law and by fit that exceed the numerical uncertainty, each with its cause, the widest
    /// first.
    pub fn bands(&self) -> Vec<(&'static str, [f64; 2])> {
        let off = self.uncertainty.unwrap_or(0.0);
        let width = |[low, high]: [f64; 2]| high - low;
        let all = [("contact law", self.by_contact_law), ("fit", self.by_fit)];
        let all = all
            .into_iter()
            .filter_map(|(cause, band)| Some((cause, band?)));
        let mut bands: Vec<_> = all.filter(|(_, band)| width(*band) > off).collect();
        bands.sort_by(|a, b| width(b.1).total_cmp(&width(a.1)));
        bands
    }

    /// Returns the widest of the [`bands`](Self::bands).
    pub fn band(&self) -> Option<[f64; 2]> {
        self.bands().first().map(|(_, band)| *band)
    }
}
