//! Runs of one engine at several refinements, and what they say of the finest, quantity by quantity.

use std::ops::Range;

use pinwheel_timeseries::TimeSeries;

use super::{QuantityUncertainty, Uncertainty};
use crate::grid;
use crate::quantities::Quantity;
use crate::windows::WindowKind;
use pinwheel_timeseries::convergence::{self as order, Basis, Estimate, Method, Step, Unresolved};
use pinwheel_timeseries::norms::{Statistics, View, peak, rms};

/// The coarser runs beside a participant's own, which is the finest.
#[derive(Debug, Clone, PartialEq)]
pub struct RefinementStudy {
    /// Setting that is refined.
    pub method: Method,
    /// Step (s), tolerance or other refined setting of the finest run, for remedies.
    pub finest: f64,
    /// The other runs.
    pub coarser: Vec<Level>,
}

/// One coarser run.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Step or tolerance over the finest run's, above 1.
    pub refinement: f64,
    /// Time series at the finest run's sample times; or the reason why there are none.
    pub run: Result<TimeSeries, String>,
    /// Wall time, s.
    pub wall_s: f64,
}

/// Known facts of an estimate beside the runs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settings {
    /// Rounding as a share of the quantity's RMS (or peak).
    pub(crate) floor: f64,
    /// True if runs may be compared sample by sample.
    pub(crate) pointwise: bool,
}

/// One pair of neighbouring levels, in every norm.
#[derive(Debug, Clone, Copy)]
struct Gap {
    ratio: f64,
    l2: f64,
    linf: f64,
}

impl RefinementStudy {
    /// The levels from fine to coarse, without the finest.
    fn levels(&self) -> Vec<&Level> {
        let mut levels: Vec<&Level> = self.coarser.iter().collect();
        levels.sort_by(|a, b| a.refinement.total_cmp(&b.refinement));
        levels
    }

    /// The remedy in words: the setting that makes the uncertainty `factor` times finer.
    #[must_use]
    pub fn remedy(&self, factor: f64) -> String {
        let what = match self.method {
            Method::Step { .. } => "step",
            Method::Tolerance { .. } => "tolerance",
        };
        format!("run it at a {what} of {:.1e}", self.finest / factor)
    }

    /// Checks that the refinement study can be evaluated.
    ///
    /// # Errors
    /// A level that failed, has other sample times, or is not coarser than the finest.
    pub fn check(&self, finest: &TimeSeries) -> Result<(), Unresolved> {
        if self.coarser.is_empty() {
            return Err(Unresolved::new(
                "one run alone shows nothing of its error",
                "run it again at a coarser step or tolerance",
            ));
        }
        let mut before = 1.0;
        for level in self.levels() {
            if !(level.refinement > before && level.refinement.is_finite()) {
                return Err(Unresolved::new(
                    format!(
                        "a level of its refinement study has the refinement {}",
                        level.refinement
                    ),
                    "give every level a refinement of its own above 1",
                ));
            }
            before = level.refinement;
            match &level.run {
                Err(reason) => {
                    return Err(Unresolved::new(
                        format!(
                            "its run at {} times the setting failed: {reason}",
                            level.refinement
                        ),
                        self.remedy(level.refinement),
                    ));
                }
                Ok(time_series) if !grid::same(finest, time_series) => {
                    return Err(Unresolved::new(
                        format!(
                            "its run at {} times the setting has other sample times",
                            level.refinement
                        ),
                        "write all runs on one grid",
                    ));
                }
                Ok(_) => {}
            }
        }
        Ok(())
    }

    /// The uncertainties of one quantity of the finest run in the samples of one window.
    /// [`RefinementStudy::check`] must have passed.
    pub(crate) fn assess(
        &self,
        finest: &TimeSeries,
        quantity: &Quantity,
        window: WindowKind,
        samples: Range<usize>,
        settings: Settings,
    ) -> QuantityUncertainty {
        let unresolved = |reason: String| {
            let what = Uncertainty::Unknown(Unresolved::new(
                reason,
                "look at the runs of its refinement study",
            ));
            QuantityUncertainty::everywhere(&quantity.name, window, &what)
        };
        let Some(views) = self.views(finest, quantity, samples) else {
            return unresolved("a run of its refinement study lacks a channel".to_owned());
        };
        let figures: Option<Vec<Statistics>> =
            views.iter().map(|(_, v)| Statistics::of(v)).collect();
        let (Some(figures), Some(gaps)) = (figures, gaps(&views)) else {
            return unresolved("a run of its refinement study is not finite".to_owned());
        };
        let own = figures[0];
        let (floor_rms, floor_peak) = (settings.floor * own.rms, settings.floor * own.peak);
        let steps = |norm: fn(&Gap) -> f64| -> Vec<Step> {
            let step = |gap: &Gap| Step {
                ratio: gap.ratio,
                difference: norm(gap),
            };
            gaps.iter().map(step).collect()
        };
        let cosine = alignment(&views);
        let (l2, linf) = if settings.pointwise {
            (
                order::estimate(&steps(|g| g.l2), cosine, self.method, floor_rms),
                order::estimate(&steps(|g| g.linf), cosine, self.method, floor_peak),
            )
        } else {
            let beyond = || {
                Err(Unresolved::new(
                    "beyond the divergence horizon a rounding parts two runs: only statistics can be compared",
                    "shorten the run",
                ))
            };
            (beyond(), beyond())
        };
        let figure =
            |of: fn(&Statistics) -> f64, floor: f64, series: &Result<Estimate, Unresolved>| {
                let values: Vec<f64> = figures.iter().map(of).collect();
                if settings.pointwise {
                    self.figure(&gaps, &values, floor, series)
                } else {
                    Ok(spread(&values, floor))
                }
            };
        let relative_l2 = l2.as_ref().ok().map(|e| e.u / own.rms);
        QuantityUncertainty {
            quantity: quantity.name.clone(),
            window,
            mean: figure(|s| s.mean, floor_rms, &l2).into(),
            peak: figure(|s| s.peak, floor_peak, &linf).into(),
            rms: figure(|s| s.rms, floor_rms, &l2).into(),
            relative_l2: relative_l2.filter(|u| u.is_finite()),
            l2: l2.into(),
            linf: linf.into(),
        }
    }

    /// A scalar figure. Where the series showed the stated order, the figure's own differences are used with that
    /// order, which all samples vote for: the error of one number passes through zero and would show any. No figure
    /// is off by more than its series; where that order was not confirmed, that bound is all there is.
    fn figure(
        &self,
        gaps: &[Gap],
        values: &[f64],
        floor: f64,
        series: &Result<Estimate, Unresolved>,
    ) -> Result<Estimate, Unresolved> {
        let series = series.clone()?;
        let bound = Estimate {
            basis: Basis::Series,
            ..series
        };
        let (Method::Step { .. }, Basis::Observed, Some(order)) =
            (self.method, series.basis, series.order)
        else {
            return Ok(bound);
        };
        let steps = values.windows(2).zip(gaps).map(|(pair, gap)| Step {
            ratio: gap.ratio,
            difference: (pair[1] - pair[0]).abs(),
        });
        let steps: Vec<Step> = steps.collect();
        let sign = match values {
            [one, two, three, ..] => Some(((two - one) * (three - two)).signum()),
            _ => None,
        };
        let own = order::estimate(&steps, sign, Method::Step { order, rough: None }, floor);
        Ok(own.ok().filter(|own| own.u <= bound.u).unwrap_or(bound))
    }

    /// Refinement and view of every run, the finest first.
    fn views<'a>(
        &'a self,
        finest: &'a TimeSeries,
        quantity: &Quantity,
        samples: Range<usize>,
    ) -> Option<Vec<(f64, View<'a>)>> {
        let mut views = vec![(1.0, View::of(finest, &quantity.channels, samples.clone())?)];
        for level in self.levels() {
            let time_series = level.run.as_ref().ok()?;
            views.push((
                level.refinement,
                View::of(time_series, &quantity.channels, samples.clone())?,
            ));
        }
        Some(views)
    }
}

fn gaps(views: &[(f64, View<'_>)]) -> Option<Vec<Gap>> {
    let gap = |pair: &[(f64, View<'_>)]| {
        let [(fine, of_fine), (coarse, of_coarse)] = pair else {
            return None;
        };
        let linf = peak(of_coarse.less(of_fine))?;
        Some(Gap {
            ratio: coarse / fine,
            l2: rms(of_coarse.less(of_fine), linf)?,
            linf,
        })
    };
    views.windows(2).map(gap).collect()
}

/// Cosine between `f3 - f2` and `f2 - f1`: 1 where every sample converges along one line.
fn alignment(views: &[(f64, View<'_>)]) -> Option<f64> {
    let [(_, one), (_, two), (_, three), ..] = views else {
        return None;
    };
    let differences = || {
        let both = one.values().zip(two.values()).zip(three.values());
        both.map(|((a, b), c)| (c - b, b - a))
    };
    // Scaled, so that no square vanishes or overflows.
    let (large, small) = (
        peak(differences().map(|d| d.0))?,
        peak(differences().map(|d| d.1))?,
    );
    if large == 0.0 || small == 0.0 {
        return None;
    }
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in differences() {
        let (x, y) = (x / large, y / small);
        xy += x * y;
        xx += x * x;
        yy += y * y;
    }
    Some(xy / (xx * yy).sqrt())
}

/// Beyond the divergence horizon every level is a sample of the same statistics.
fn spread(values: &[f64], floor: f64) -> Estimate {
    let furthest = values
        .iter()
        .map(|v| (v - values[0]).abs())
        .fold(0.0, f64::max);
    Estimate::spread(furthest, floor)
}
