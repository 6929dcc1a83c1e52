//! Ladder of refinements: runs of one engine at several settings, and the uncertainty of the finest run.
//!
//! [`convergence`] has the formulas for plain numbers. A [`Ladder`] applies them to time series: to all channels of a quantity
//! jointly, in the norms of a comparison ([`Ladder::estimate`]), or to the distances of runs ([`error`]).

use std::borrow::Cow;
use std::ops::Range;

use crate::TimeSeries;
use crate::convergence::{self, Basis, Estimate, Method, Step, Unresolved};
use crate::norms::{Distance, Statistics, View, peak, rms, rows_at};

/// Finest run of an engine with its coarser runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// Kind of setting that is refined, with its order.
    pub method: Method,
    /// Step (s), tolerance or other setting of the finest run, whose time series are stored beside the ladder.
    pub finest: f64,
    /// Error common to all runs, as a share of every quantity, which no level reveals.
    pub floor: f64,
    /// Coarser runs.
    pub coarser: Vec<Level>,
}

/// Coarser run.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// Step, tolerance or other refined setting, above the finest.
    pub setting: f64,
    /// Time series at the finest run's sample times, or at every second one; or the reason for their absence.
    pub run: Result<TimeSeries, String>,
    /// Wall time, s.
    pub wall_s: f64,
}

/// Uncertainty, or the reason for its absence.
pub type Known = Result<Estimate, Unresolved>;

/// Uncertainties of one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimates {
    /// Root mean square and largest error of the series; errors of mean, largest magnitude and root mean square.
    pub norms: [Known; 5],
    /// Root mean square error over the quantity's own root mean square; `None` for a series of zeros.
    pub relative_l2: Option<f64>,
}

/// Differences of two neighbouring levels in every norm.
#[derive(Debug, Clone, Copy)]
struct Gap {
    ratio: f64,
    l2: f64,
    linf: f64,
}

impl Ladder {
    /// Returns a level's setting over the finest run's.
    pub fn refinement(&self, level: &Level) -> f64 {
        level.setting / self.finest
    }

    /// Makes a finer run the finest. The previous one becomes a level, and the coarsest of three is dropped.
    pub fn refine(&mut self, setting: f64, before: Level) {
        self.finest = setting;
        self.coarser.insert(0, before);
        self.coarser.truncate(2);
    }

    /// Returns the uncertainties of some channels of the finest run, jointly over the samples. `floor`: rounding as a share of
    /// their root mean square and peak. `pointwise`: true if runs may be compared sample by sample.
    ///
    /// # Errors
    /// A level that failed, has other sample times, lacks a channel or is not coarser than the finest run.
    pub fn estimate(
        &self,
        finest: &TimeSeries,
        channels: &[String],
        samples: &Range<usize>,
        floor: f64,
        pointwise: bool,
    ) -> Result<Estimates, Unresolved> {
        let runs = self.runs(finest)?;
        let spoiled = |what: &str| {
            let reason = format!("a run of its refinement study {what}");
            Unresolved::new(reason, "look at the runs of its refinement study")
        };
        let thinned = runs.iter().any(|(_, run)| run.len() < finest.len());
        let values = runs.iter().map(|(_, run)| {
            let is_thin = run.len() < finest.len();
            cut(run, channels, samples, thinned, is_thin)
        });
        let values: Option<Vec<Vec<Cow<'_, [f64]>>>> = values.collect();
        let values = values.ok_or_else(|| spoiled("lacks a channel"))?;
        let views = values
            .iter()
            .map(|run| View::new(run.iter().map(AsRef::as_ref).collect()));
        let views: Vec<View<'_>> = views.collect();
        let figures: Option<Vec<Statistics>> = views.iter().map(Statistics::of).collect();
        let (Some(figures), Some(gaps)) = (figures, gaps(&runs, &views)) else {
            return Err(spoiled("is not finite"));
        };
        let own = figures[0];
        let floor = floor.max(self.floor);
        let (floor_rms, floor_peak) = (floor * own.rms, floor * own.peak);
        let cosine = alignment(&views);
        let series = |norm: fn(&Gap) -> f64, floor: f64| {
            if !pointwise {
                return Err(Unresolved::new(
                    "beyond the divergence horizon a rounding parts two runs: only statistics can be compared",
                    "shorten the run",
                ));
            }
            let steps: Vec<Step> = gaps.iter().map(|gap| gap.step(norm(gap))).collect();
            convergence::estimate(&steps, cosine, self.method, floor)
        };
        let l2 = series(|gap| gap.l2, floor_rms);
        let linf = series(|gap| gap.linf, floor_peak);
        let figure = |of: fn(&Statistics) -> f64, floor: f64, series: &Known| {
            let values: Vec<f64> = figures.iter().map(of).collect();
            if pointwise {
                self.figure(&gaps, &values, floor, series)
            } else {
                Ok(spread(&values, floor))
            }
        };
        let relative_l2 = l2.as_ref().ok().map(|e| e.u / own.rms);
        let mean = figure(|s| s.mean, floor_rms, &l2);
        let peak = figure(|s| s.peak, floor_peak, &linf);
        let rms = figure(|s| s.rms, floor_rms, &l2);
        Ok(Estimates {
            norms: [l2, linf, mean, peak, rms],
            relative_l2: relative_l2.filter(|u| u.is_finite()),
        })
    }

    /// Returns refinement and time series of every run, the finest first.
    fn runs<'a>(
        &'a self,
        finest: &'a TimeSeries,
    ) -> Result<Vec<(f64, &'a TimeSeries)>, Unresolved> {
        if self.coarser.is_empty() {
            return Err(Unresolved::new(
                "one run alone shows nothing of its error",
                "run it again at a coarser step or tolerance",
            ));
        }
        let levels = self.coarser.iter();
        let levels = levels.map(|level| (self.refinement(level), level));
        let mut levels: Vec<(f64, &Level)> = levels.collect();
        levels.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut runs = vec![(1.0, finest)];
        for (refinement, level) in levels {
            if !(refinement > runs[runs.len() - 1].0 && refinement.is_finite()) {
                return Err(Unresolved::new(
                    format!("a level of its refinement study has the refinement {refinement}"),
                    "give every level a refinement of its own above 1",
                ));
            }
            match &level.run {
                Err(reason) => {
                    let what = match self.method {
                        Method::Step { .. } => "step",
                        Method::Tolerance { .. } => "tolerance",
                    };
                    let finer = self.finest / refinement;
                    return Err(Unresolved::new(
                        format!("its run at {refinement} times the setting failed: {reason}"),
                        format!("run it at a {what} of {finer:.1e}"),
                    ));
                }
                Ok(run) if !stands_on(run, finest) => {
                    return Err(Unresolved::new(
                        format!("its run at {refinement} times the setting has other sample times"),
                        "write all runs on one grid",
                    ));
                }
                Ok(run) => runs.push((refinement, run)),
            }
        }
        Ok(runs)
    }

    /// Returns the uncertainty of a scalar figure. If the series showed the stated order, the figure's own differences are used
    /// with it: the error of a single number passes through zero and would show any order. A figure's error never exceeds that
    /// of its series, which is the only bound if the order was not confirmed.
    fn figure(&self, gaps: &[Gap], values: &[f64], floor: f64, series: &Known) -> Known {
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
        let apart = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let steps = gaps.iter().zip(apart).map(|(gap, apart)| gap.step(apart));
        let steps: Vec<Step> = steps.collect();
        let sign = match values {
            [one, two, three, ..] => Some(((two - one) * (three - two)).signum()),
            _ => None,
        };
        let method = Method::Step { order, rough: None };
        let own = convergence::estimate(&steps, sign, method, floor);
        Ok(own.ok().filter(|own| own.u <= bound.u).unwrap_or(bound))
    }
}

/// Returns a bound of a run's error from its distance to a coarser run, and that run's to the next; NaN if the distances show
/// no order. Each distance comes with the ratio of the settings.
pub fn error(
    apart: &[(Distance, f64)],
    alignment: Option<f64>,
    method: Method,
    floor: f64,
) -> Distance {
    Distance::of_each(|part| {
        let step = |(distance, ratio): &(Distance, f64)| Step {
            ratio: *ratio,
            difference: part(distance),
        };
        let steps: Vec<Step> = apart.iter().map(step).collect();
        let known = convergence::estimate(&steps, alignment, method, floor);
        known.map_or(f64::NAN, |known| known.u)
    })
}

/// True if a run has the sample times of `finest`, to rounding, or every second one; it may have one more at its end, which no
/// estimate reads.
fn stands_on(run: &TimeSeries, finest: &TimeSeries) -> bool {
    let on = |every: usize, more: usize| {
        let count = finest.len().div_ceil(every);
        let mut rows = rows_at(run.time_s(), finest.time_s()).take(count);
        (count..=count + more).contains(&run.len())
            && (0..count).all(|k| rows.next() == Some(Some(every * k)))
    };
    on(1, 0) || on(2, 1)
}

/// Returns channels over some samples of the finest run; if `thinned`, at every second one, the only samples of a run that
/// `is_thin`.
fn cut<'a>(
    run: &'a TimeSeries,
    channels: &[String],
    samples: &Range<usize>,
    thinned: bool,
    is_thin: bool,
) -> Option<Vec<Cow<'a, [f64]>>> {
    let half = samples.start.div_ceil(2)..samples.end.div_ceil(2);
    let channel = |name: &String| {
        let values = run.channel(name)?;
        if is_thin {
            return values.get(half.clone()).map(Cow::Borrowed);
        }
        let all = values.get(samples.clone())?;
        let odd = samples.start % 2;
        Some(match thinned {
            true => Cow::Owned(all.iter().skip(odd).step_by(2).copied().collect()),
            false => Cow::Borrowed(all),
        })
    };
    channels.iter().map(channel).collect()
}

impl Gap {
    fn step(&self, difference: f64) -> Step {
        Step {
            ratio: self.ratio,
            difference,
        }
    }
}

fn gaps(runs: &[(f64, &TimeSeries)], views: &[View<'_>]) -> Option<Vec<Gap>> {
    let pairs = runs.windows(2).zip(views.windows(2));
    let gap = |(runs, views): (&[(f64, &TimeSeries)], &[View<'_>])| {
        let linf = peak(views[1].less(&views[0]))?;
        Some(Gap {
            ratio: runs[1].0 / runs[0].0,
            l2: rms(views[1].less(&views[0]), linf)?,
            linf,
        })
    };
    pairs.map(gap).collect()
}
/// Returns the cosine between `f3 - f2` and `f2 - f1`: 1 where every sample converges along one line.
fn alignment(views: &[View<'_>]) -> Option<f64> {
    let [one, two, three, ..] = views else {
        return None;
    };
    let differences = || {
        let both = one.values().zip(two.values()).zip(three.values());
        both.map(|((a, b), c)| (c - b, b - a))
    };
    // Scaled, so that no square vanishes or overflows.
    let large = peak(differences().map(|d| d.0))?;
    let small = peak(differences().map(|d| d.1))?;
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

/// Returns the spread of levels beyond the divergence horizon, where each is a sample of one distribution.
fn spread(values: &[f64], floor: f64) -> Estimate {
    let apart = values.iter().map(|v| (v - values[0]).abs());
    Estimate::spread(apart.fold(0.0, f64::max), floor)
}
