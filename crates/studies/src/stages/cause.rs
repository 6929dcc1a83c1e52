//! The cause: the change of the model that explains a residual best.

use pinwheel_gearbox::Gearbox;
use serde::Serialize;

use super::fit::{Fit, fit};
use super::judged::{ROUNDING, Stage};
use super::model::{Change, Model};
use super::suspects::{self, Size, Suspect};

/// A likely cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cause {
    /// Stage in which it acts.
    pub stage: Stage,
    /// One word: `inertia`, `load`, `friction`, `stiffness`, `damping`, `curvature`, `phase`, `step`, ...
    pub word: &'static str,
    /// The cause with its size, in words.
    pub what: String,
    /// Size of the change: factor less 1; of angles the angle, rad; of forms that are or are not, 1.
    pub size: f64,
    /// Standard error of the size.
    pub plus_minus: f64,
    /// Share of the residual's square that it explains.
    pub explained: f64,
    /// Relative L2 distance of the run's forces from a native run, without the change and with it.
    pub distance: Option<[f64; 2]>,
}

/// Values of a model that a run is held against.
type Values<'a> = &'a dyn Fn(&mut Model<'_>) -> Option<Vec<f64>>;

/// Changes that explain almost the same are told apart by their factor: a sign or a missing part is more likely than any.
const ALIKE: f64 = 1e-4;

/// Factor on a mass that is missing.
const LIGHTEST: f64 = 1e-9;

/// Fits every suspect to a run's values and the native ones, and returns the best that explains at least `least`.
pub(super) fn cause(
    gearbox: &Gearbox,
    [run, native]: [&[f64]; 2],
    least: f64,
    values: Values<'_>,
) -> Option<(Cause, Change)> {
    let fitted = suspects::of(gearbox).into_iter().filter_map(|suspect| {
        let small = match suspect.size {
            Size::Angle => 1e-6,
            Size::Factor | Size::Switch => 1e-4,
        };
        let lightest = match suspect.change {
            Change::Mass(_) => LIGHTEST - 1.0,
            _ => f64::NEG_INFINITY,
        };
        let fit = fit(run, native, [small, lightest], &mut |size| {
            values(&mut Model::new(gearbox, &suspect.change, size)?)
        })?;
        (fit.explained >= least).then_some((suspect, fit))
    });
    let mut fitted: Vec<(Suspect, Fit)> = fitted.collect();
    let most = fitted
        .iter()
        .map(|(_, fit)| fit.explained)
        .fold(0.0, f64::max);
    let alike = fitted
        .iter()
        .enumerate()
        .filter(|(_, (_, fit))| most - fit.explained < ALIKE);
    // The first of those that look alike.
    let best = alike.min_by_key(|(_, (suspect, fit))| usize::from(!suspect.size.is_telling(fit)));
    let best = best.map(|(k, _)| k)?;
    let (suspect, fit) = fitted.swap_remove(best);
    let cause = Cause {
        stage: suspect.stage,
        word: suspect.cause,
        what: suspect.size.words(&suspect.what, &fit),
        size: fit.size,
        plus_minus: fit.plus_minus,
        explained: fit.explained,
        distance: None,
    };
    Some((cause, suspect.change))
}

impl Size {
    /// True for a size that faults have: the other sign, nothing, twice, the other form.
    fn is_telling(self, fit: &Fit) -> bool {
        let known: &[f64] = match self {
            Self::Factor => &[-2.0, -1.0, 1.0],
            Self::Switch => &[1.0],
            Self::Angle => &[],
        };
        known.iter().any(|known| (fit.size - known).abs() < 0.02)
    }

    /// The change in words, with its size.
    fn words(self, what: &str, fit: &Fit) -> String {
        let (size, off) = (fit.size, fit.plus_minus.max(ROUNDING));
        let telling = self.is_telling(fit);
        match self {
            Self::Factor if telling && size < -1.5 => format!("{what} with the other sign"),
            Self::Factor if telling && size < 0.0 => format!("{what}, missing"),
            Self::Factor if telling => format!("{what} twice"),
            Self::Factor => format!("{what} times {:.6} +- {off:.0e}", 1.0 + size),
            Self::Angle => format!("{what} off by {size:.3e} +- {off:.0e} rad"),
            Self::Switch if telling => what.to_owned(),
            Self::Switch => format!("{what}, to {:.3} +- {off:.0e}", size),
        }
    }
}
