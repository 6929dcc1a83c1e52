//! The cause: the change of the model, or the two, that explain a residual best.

use std::cmp::Reverse;

use serde::Serialize;

use super::fit::{Fit, dot, fit, less, sizes, slope};
use super::judged::{ROUNDING, SURE, Stage, percent};
use super::model::{Change, Changes, Model, Work};
use super::suspects::{self, Size, Suspect};

/// A likely cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cause {
    /// Its parts: one, or two where one alone explains too little.
    pub parts: Vec<Part>,
    /// Share of the residual's square that it explains.
    pub explained: f64,
    /// Relative L2 distance of the run's forces from a native run, without the change and with it.
    pub distance: Option<[f64; 2]>,
}

/// One change of the model that is a cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// Stage in which it acts.
    pub stage: Stage,
    /// One word: `inertia`, `load`, `friction`, `stiffness`, `damping`, `curvature`, `phase`, `step`, ...
    pub word: &'static str,
    /// The change with its size, in words.
    pub what: String,
    /// Size of the change: factor less 1; of angles the angle, rad; of forms that are or are not, 1.
    pub size: f64,
    /// Error of the size, if all that is unexplained has one cause.
    pub plus_minus: f64,
}

impl Cause {
    /// First stage in which it acts.
    pub fn stage(&self) -> Option<Stage> {
        self.parts.iter().map(|part| part.stage).min()
    }

    /// The cause with its figure.
    pub fn words(&self) -> String {
        let all = |of: fn(&Part) -> &str| {
            let words: Vec<&str> = self.parts.iter().map(of).collect();
            words.join(" and ")
        };
        let explained = percent(self.explained);
        let verb = if self.parts.len() > 1 {
            "explain"
        } else {
            "explains"
        };
        let (word, what) = (all(|part| part.word), all(|part| &part.what));
        format!("likely {word}: {what} {verb} {explained}")
    }
}

/// A cause with the changes of the model that are its parts.
pub(super) type Found = (Cause, Vec<Change>);

/// Changes of a cause, with their sizes.
pub(super) fn changes((cause, changes): &Found) -> Changes<'_> {
    let sizes = cause.parts.iter().map(|part| part.size);
    changes.iter().zip(sizes).collect()
}

/// Values of a model that a run is held against.
pub(super) type Values<'a> = &'a dyn Fn(&mut Model<'_>) -> Option<Vec<f64>>;

/// Changes that explain almost the same are told apart by their factor: a sign or a missing part is more likely than any.
const ALIKE: f64 = 1e-4;
/// Ratio of what two changes leave from which on they are not alike, unless both leave roundings.
const NEARLY: f64 = 10.0;
const SAME: f64 = 1e-8;
/// Factor on a mass that is missing.
const LIGHTEST: f64 = 1e-9;
/// Share that a change explains linearly before it is followed further: large ones are far from linear.
const LEAST: f64 = 0.05;
/// Changes, and pairs of changes, that are followed.
const FOLLOWED: usize = 6;
/// Share of a small size that is none.
const NOTHING: f64 = 1e-2;
/// Standard errors that each size is above 0.
const CLEAR: f64 = 10.0;

/// Fits every suspect that is asked for to a run's values and the native ones, and returns the best that explains at least `least`.
/// Two may where one explains too little and the step's own error is known.
pub(super) fn cause(
    work: &Work<'_>,
    [run, native]: [&[f64]; 2],
    least: f64,
    is_asked: fn(&Suspect) -> bool,
    values: Values<'_>,
) -> Option<Found> {
    let mut suspects = suspects::of(work.gearbox);
    suspects.retain(is_asked);
    let predict = |of: &[usize], sizes: &[f64]| {
        let of = of.iter().map(|k| &suspects[*k].change);
        let changes = of.zip(sizes.iter().copied()).collect();
        values(&mut Model::new(work, changes).filter(|_| work.left() > 0)?)
    };
    let slopes = |k: usize| {
        let near = &mut |sizes: &[f64]| predict(&[k], sizes);
        let slope = slope(suspects[k].limits()[0], native, near)?;
        (dot(&slope, &slope) > 0.0).then_some((k, slope))
    };
    let slopes: Vec<(usize, Vec<f64>)> = (0..suspects.len()).filter_map(slopes).collect();
    let residual = less(run, native);
    let whole = dot(&residual, &residual);
    // Share that changes explain linearly.
    let share = |of: &[usize]| {
        let views: Vec<&[f64]> = of.iter().map(|k| slopes[*k].1.as_slice()).collect();
        let sizes = sizes(&views, &residual);
        let each = sizes.iter().zip(&views);
        each.map(|([size, _], slope)| size * dot(slope, &residual))
            .sum::<f64>()
            / whole
    };
    let best = |sets: Vec<Vec<usize>>, least: f64| {
        // The first of those that look alike.
        let telling = |(of, fit): &(Vec<usize>, Fit)| {
            let each = of.iter().zip(&fit.sizes);
            each.filter(|(k, [size, _])| suspects[**k].size.is_telling(*size))
                .count()
        };
        let mut fits: Vec<(Vec<usize>, Fit)> = Vec::new();
        for set in sets {
            let of: Vec<usize> = set.iter().map(|k| slopes[*k].0).collect();
            let limits: Vec<_> = of.iter().map(|k| suspects[*k].limits()).collect();
            let begun = set.iter().map(|k| slopes[*k].1.clone()).collect();
            let near = &mut |sizes: &[f64]| predict(&of, sizes);
            let Some(fit) = fit(run, native, begun, &limits, near) else {
                continue;
            };
            let free = (run.len() as f64).sqrt();
            let mut sizes = fit.sizes.iter();
            let is_clear = sizes.all(|[size, error]| free * size.abs() > CLEAR * error);
            if fit.explained >= least && is_clear {
                fits.push((of, fit));
                // No other explains more, or is more likely.
                let is_last = |it: &(Vec<usize>, Fit)| {
                    1.0 - it.1.explained < ALIKE && telling(it) == it.0.len()
                };
                if fits.last().is_some_and(is_last) {
                    break;
                }
            }
        }
        fits.sort_unstable_by(|a, b| a.0.cmp(&b.0));
        let each = fits.iter().map(|(_, fit)| fit.explained);
        let most = each.fold(0.0, f64::max);
        // What is exact is told from what is almost so.
        let apart = ALIKE.min(SAME + NEARLY * (1.0 - most));
        fits.retain(|(_, fit)| most - fit.explained < apart);
        fits.into_iter().min_by_key(|found| Reverse(telling(found)))
    };
    let nearest = |sets: Vec<Vec<usize>>| -> Vec<Vec<usize>> {
        let mut sets: Vec<(f64, Vec<usize>)> =
            sets.into_iter().map(|set| (share(&set), set)).collect();
        sets.retain(|(share, _)| *share > LEAST);
        sets.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        // Those that look alike belong together.
        let last = sets
            .iter()
            .map(|(share, _)| share - ALIKE)
            .nth(FOLLOWED - 1);
        sets.retain(|(share, _)| last.is_none_or(|last| *share >= last));
        sets.into_iter().map(|(_, set)| set).collect()
    };
    let singles = (0..slopes.len()).map(|k| vec![k]).collect();
    let mut found = best(nearest(singles), least);
    if found.is_none() && least != SURE {
        let pairs = (0..slopes.len()).flat_map(|i| (0..i).map(move |j| vec![j, i]));
        found = best(nearest(pairs.collect()), least.max(SURE));
    }
    // The best may be among those that were not followed.
    let (of, fit) = found.filter(|_| work.left() > 0)?;
    // One of two may be nothing.
    let both = of.into_iter().zip(fit.sizes);
    let of: Vec<(usize, [f64; 2])> = both
        .filter(|(k, [size, _])| size.abs() > NOTHING * suspects[*k].limits()[0])
        .collect();
    let part = |&(k, [size, plus_minus]): &(usize, [f64; 2])| {
        let suspect = &suspects[k];
        Part {
            stage: suspect.stage,
            word: suspect.cause,
            what: suspect.size.words(&suspect.what, size, plus_minus),
            size,
            plus_minus,
        }
    };
    let parts = of.iter().map(part).collect();
    let cause = Cause {
        parts,
        explained: fit.explained,
        distance: None,
    };
    let changes = suspects.into_iter().enumerate();
    let changes = changes.filter(|(number, _)| of.iter().any(|(k, _)| k == number));
    Some((cause, changes.map(|(_, suspect)| suspect.change).collect()))
}

impl Suspect {
    /// A size that changes the model linearly, and the least size.
    fn limits(&self) -> [f64; 2] {
        let small = match self.size {
            Size::Shift(_, small) => small,
            Size::Factor | Size::Switch => 1e-4,
        };
        let least = match self.change {
            Change::Mass(_) => LIGHTEST - 1.0,
            _ => f64::NEG_INFINITY,
        };
        [small, least]
    }
}

impl Size {
    /// True for a size that faults have: the other sign, nothing, twice, the other form.
    fn is_telling(self, size: f64) -> bool {
        let known: &[f64] = match self {
            Self::Factor => &[-2.0, -1.0, 1.0],
            Self::Switch => &[1.0],
            _ => &[],
        };
        known.iter().any(|known| (size - known).abs() < 0.02)
    }

    /// The change in words, with its size.
    fn words(self, what: &str, size: f64, plus_minus: f64) -> String {
        let off = plus_minus.max(ROUNDING);
        let telling = self.is_telling(size);
        match self {
            Self::Factor if telling && size < -1.5 => format!("{what} with the other sign"),
            Self::Factor if telling && size < 0.0 => format!("{what}, missing"),
            Self::Factor if telling => format!("{what} twice"),
            Self::Factor => format!("{what} times {:.6} +- {off:.0e}", 1.0 + size),
            Self::Shift(unit, small) => {
                format!(
                    "{what} off by {size:.3e} +- {:.0e}{unit}",
                    plus_minus.max(small)
                )
            }
            Self::Switch if telling => what.to_owned(),
            Self::Switch => format!("{what}, to {:.3} +- {off:.0e}", size),
        }
    }
}
