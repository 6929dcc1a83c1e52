//! Time shift at which a record fits a run best.
//!
//! Run and record are interpolated on one uniform grid, four times as fine as the finer of the two. Pearson's correlation of
//! each common column is computed at every shift that leaves at least half of the shorter one overlapping: products by Fourier
//! transform, means and variances by running sums. The shift is the highest peak of the mean over the columns, refined by a
//! parabola through three points. Gains and offsets of the sensors do not matter.
//!
//! Near its peak the correlation falls as `c - k t^2/2`. A systematic misfit `1 - c^2` moves the peak by up to `sqrt((1 -
//! c^2)/k)`, the stated uncertainty of the shift; noise of single samples moves it less.

use super::Offset;
use super::resample::{usual_spacing, value_at};
use crate::{TimeSeries, fourier};

/// Points of the uniform grid per sample: between the points of an oscillation of 8 samples the correlation falls by 1/15.
const FINE: f64 = 4.0;
/// Largest number of points of the uniform grid, run and record together.
const MOST: f64 = 1_048_576.0;
/// Smallest number of points of the shorter one.
const FEWEST: usize = 40;
/// Largest loss, as a share of the misfit `1 - c`, with which another shift fits as well.
const AS_WELL: f64 = 0.05;
/// Smallest gain of correlation that counts.
const GAIN: f64 = 1e-3;
/// Share of a grid step by which the parabola may miss the peak of an oscillation of 5 samples or more. Measured: 0.03.
const PARABOLA: f64 = 0.05;
/// Smallest variation of a column in an overlap, as a share of its entire variation; a flatter column is ignored there.
const FLAT: f64 = 1e-9;
/// Largest variation of a column, as a share of its size, that counts as rounding.
const ROUNDING: f64 = 1e-12;
/// Correlation, a quarter of the variation, below which record and run are unrelated.
const UNLIKE: f64 = 0.5;
/// Overlap, as a share of the shorter one, below which a warning is given.
const SMALL_OVERLAP: f64 = 0.9;

/// Time shift with its quality of fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Shift {
    /// Shift to be added to the record's times, s.
    pub seconds: f64,
    /// Uncertainty of the shift, s.
    pub uncertainty_s: f64,
    /// Mean correlation at the shift, at most 1.
    pub correlation: f64,
    /// Mean correlation without a shift; 0 with less than half overlapping.
    pub unshifted: f64,
    /// Nearest other shift that fits as well, s.
    pub rival: Option<f64>,
    /// Overlap at the shift, as a share of the shorter one.
    pub overlap: f64,
}

impl Shift {
    /// True if the record fits clearly better when shifted.
    pub fn matters(&self) -> bool {
        self.seconds.abs() > 2.0 * self.uncertainty_s
            && self.correlation - self.unshifted > GAIN
            && 1.0 - self.correlation < 0.7 * (1.0 - self.unshifted)
    }

    /// Returns a message with the offset to write into the map. `before` is its present offset.
    pub fn message(&self, reference: &str, before: Offset) -> String {
        let tidy = |seconds: f64| {
            let decimals = (1.0 - self.uncertainty_s.log10().floor()).clamp(0.0, 12.0) as usize;
            format!("{seconds:.decimals$}")
        };
        let (by, off) = (tidy(self.seconds), self.uncertainty_s);
        let (shifted, unshifted) = (self.correlation, self.unshifted);
        let mut fit = format!("correlation {shifted:.4} instead of {unshifted:.4}");
        if let Some(rival) = self.rival {
            let rival = tidy(rival);
            fit += &format!(
                "; two maxima are equal: it fits as well shifted by {rival} s, because its signals repeat"
            );
        }
        if self.overlap < SMALL_OVERLAP {
            let share = 100.0 * self.overlap;
            fit += &format!("; only {share:.0} % of the shorter one overlap there");
        }
        match before {
            Offset::Word(_) => format!(
                "{by} s were added to its times, where it fits {reference} best (+- {off:.0e} s; {fit})."
            ),
            Offset::Seconds(offset) => format!(
                "It fits {reference} best shifted by {by} s (+- {off:.0e} s; {fit}): offset_s = {} in its map does that, \
                 or offset_s = \"align\".",
                tidy(offset + self.seconds)
            ),
        }
    }
}

/// Returns the shift at which `record` fits `run` best.
///
/// # Errors
/// Reason for a missing shift: no common column that varies, too little overlap, or no similarity.
pub fn shift(run: &TimeSeries, record: &TimeSeries) -> Result<Shift, String> {
    let ends = |series: &TimeSeries| {
        let times = series.time_s();
        let ends = times.first().copied().zip(times.last().copied());
        ends.ok_or_else(|| "there are no samples".to_owned())
    };
    let (from, to) = (ends(run)?, ends(record)?);
    let spans = [from.1 - from.0, to.1 - to.0];
    let spacings = [run, record].map(|series| usual_spacing(series.time_s()));
    let step = spacings[0].min(spacings[1]) / FINE;
    let step = step.max((spans[0] + spans[1]) / MOST);
    if step > spacings[0] {
        let times = (spans[1] / spans[0]).round();
        return Err(format!("it lasts {times} times as long as the run"));
    }
    let [n, m] = spans.map(|span| (span / step) as usize + 1);
    let shorter = n.min(m);
    if shorter < FEWEST {
        return Err("it has too few samples".to_owned());
    }
    let half = (shorter / 2) as isize;
    let (n, m) = (n as isize, m as isize);
    // Sample 0 of the record is at sample `first + k` of the run.
    let first = half - m;
    let mut fits = vec![0.0; (n + m - 2 * half + 1) as usize];
    let mut columns = 0.0;
    for channel in record.channels() {
        let Some(values) = run.channel(&channel.name) else {
            continue;
        };
        let on_grid = |series: &TimeSeries, values: &[f64], from: f64, count: isize| {
            let at = |k: isize| value_at(series.time_s(), values, from + k as f64 * step);
            Evaluation::of((0..count).map(at).collect())
        };
        let both = on_grid(run, values, from.0, n).zip(on_grid(record, &channel.values, to.0, m));
        let Some((a, b)) = both else { continue };
        let products = products(&a.values, &b.values);
        if products.is_empty() {
            continue;
        }
        columns += 1.0;
        for (k, fit) in fits.iter_mut().enumerate() {
            let place = first + k as isize;
            let product = products[place.rem_euclid(products.len() as isize) as usize];
            *fit += correlation(&a, &b, place, product);
        }
    }
    if columns == 0.0 {
        return Err("no column that both have changes".to_owned());
    }
    fits.iter_mut().for_each(|fit| *fit /= columns);
    let three = |k: usize| [fits[k - 1], fits[k], fits[k + 1]];
    // Peaks with their heights.
    let peaks = (1..fits.len() - 1).filter_map(|k| {
        let [left, middle, right] = three(k);
        let bend = 2.0 * middle - left - right;
        let is_peak = middle >= left && middle >= right && bend > 0.0;
        is_peak.then(|| (k, (middle + (right - left).powi(2) / (8.0 * bend)).min(1.0)))
    });
    let peaks: Vec<(usize, f64)> = peaks.collect();
    let highest = peaks.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let ends = fits[0].max(fits[fits.len() - 1]);
    let Some(&(best, height)) = highest.filter(|(_, height)| *height >= ends) else {
        return Err("it fits best where only half of it overlaps the run".to_owned());
    };
    if height < UNLIKE {
        return Err(format!(
            "it resembles the run nowhere (correlation {height:.2} at most)"
        ));
    }
    let seconds = |k: f64| from.0 + (first as f64 + k) * step - to.0;
    let [left, middle, right] = three(best);
    let bend = 2.0 * middle - left - right;
    let misfit = 1.0 - height * height;
    let uncertainty_s = step * (misfit / bend).sqrt().hypot(PARABOLA);
    let apart = |k: usize| (k as f64 - best as f64).abs();
    let as_well = height - AS_WELL * (1.0 - height) - 1e-4;
    let rivals = peaks.iter().filter(|&&(k, height)| {
        height >= as_well && apart(k) > FINE && apart(k) * step > 2.0 * uncertainty_s
    });
    let rival = rivals.min_by(|a, b| apart(a.0).total_cmp(&apart(b.0)));
    let place = first + best as isize;
    let common = n.min(place + m) - place.max(0);
    let still = (to.0 - from.0) / step - first as f64;
    let near = still.round();
    let unshifted = if (1.0..fits.len() as f64 - 1.0).contains(&near) {
        let ([left, middle, right], x) = (three(near as usize), still - near);
        middle + 0.5 * x * (right - left + x * (left + right - 2.0 * middle))
    } else {
        0.0
    };
    Ok(Shift {
        seconds: seconds(best as f64 + 0.5 * (right - left) / bend),
        uncertainty_s,
        correlation: height,
        unshifted,
        rival: rival.map(|&(k, _)| seconds(k as f64)),
        overlap: common as f64 / shorter as f64,
    })
}

/// Values less their mean, with running sums of values and squares.
struct Evaluation {
    values: Vec<f64>,
    running: Vec<[f64; 2]>,
}

impl Evaluation {
    /// Subtracts the mean and sums; `None` if the values do not vary.
    fn of(mut values: Vec<f64>) -> Option<Self> {
        let size: f64 = values.iter().map(|value| value * value).sum();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let mut running = vec![[0.0; 2]];
        let [mut sum, mut squares] = [0.0; 2];
        for value in &mut values {
            *value -= mean;
            sum += *value;
            squares += *value * *value;
            running.push([sum, squares]);
        }
        (squares > ROUNDING * ROUNDING * size).then_some(Self { values, running })
    }

    fn squares(&self) -> f64 {
        self.running.last().map_or(0.0, |[_, squares]| *squares)
    }

    /// Returns sum and variation of `count` values from `from` on; the variation of flat values is 0.
    fn part(&self, from: isize, count: isize) -> (f64, f64) {
        let [start, end] = [from, from + count].map(|k| self.running[k as usize]);
        let sum = end[0] - start[0];
        let variation = end[1] - start[1] - sum * sum / count as f64;
        let flat = variation <= FLAT * self.squares();
        (sum, if flat { 0.0 } else { variation })
    }
}

/// Returns Pearson's correlation over the overlap of `a` and `b`, where `b` begins at `place` in `a`. `product` is the sum of
/// products over the overlap. The result is 0 where `a` or `b` is constant.
fn correlation(a: &Evaluation, b: &Evaluation, place: isize, product: f64) -> f64 {
    let from = place.max(0);
    let to = (a.values.len() as isize).min(place + b.values.len() as isize);
    let (sum_a, of_a) = a.part(from, to - from);
    let (sum_b, of_b) = b.part(from - place, to - from);
    let scale = (of_a * of_b).sqrt();
    if scale > 0.0 {
        ((product - sum_a * sum_b / (to - from) as f64) / scale).clamp(-1.0, 1.0)
    } else {
        0.0
    }
}

/// Returns the sums of products of `a[k + place]` and `b[k]` at every place; negative places count from the end.
fn products(a: &[f64], b: &[f64]) -> Vec<f64> {
    let length = (a.len() + b.len()).next_power_of_two();
    let spectrum = |values: &[f64]| {
        let mut input = values.to_vec();
        input.resize(length, 0.0);
        fourier::forward(input)
    };
    let (mut bins, of_b) = (spectrum(a), spectrum(b));
    for (bin, other) in bins.iter_mut().zip(&of_b) {
        *bin = *bin * other.conj() / length as f64;
    }
    // The first and the last bin are real up to rounding.
    for end in [0, bins.len() - 1] {
        bins[end].im = 0.0;
    }
    fourier::inverse(bins, length)
}
