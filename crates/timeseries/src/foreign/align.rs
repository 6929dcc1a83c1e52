//! The shift in time at which a record fits a run best.
//!
//! Both are put onto one even grid, and the mean correlation of the channels they share is looked for its largest value:
//! over all shifts that leave half of the shorter one in common, then between the grid's points by a parabola. Gains and
//! offsets of the sensors do not matter. A periodic signal fits as well one period on: then other shifts are named.

use super::Offset;
use crate::TimeSeries;

/// Samples of the even grid at most.
const MOST: usize = 4000;
/// Samples that are compared at every shift at most: the search is for the peak, not for its height.
const COMPARED: usize = 1000;
/// Shifts that fit this much worse, as a share of what is missing to a perfect fit, fit as well.
const AS_WELL: f64 = 0.05;

/// A shift that fits.
#[derive(Debug, Clone, PartialEq)]
pub struct Shift {
    /// To be added to the record's times, s.
    pub seconds: f64,
    /// Mean correlation there, at most 1.
    pub correlation: f64,
    /// The same without a shift.
    pub unshifted: f64,
    /// The nearest other shift that fits as well, s.
    pub rival: Option<f64>,
    /// Spacing of the grid, s: shifts below it mean nothing.
    pub resolution_s: f64,
}

impl Shift {
    /// Whether the record fits clearly better when shifted.
    #[must_use]
    pub fn matters(&self) -> bool {
        self.seconds.abs() > self.resolution_s
            && 1.0 - self.correlation < 0.7 * (1.0 - self.unshifted)
    }

    /// What one would write into the map, which now says `before`.
    #[must_use]
    pub fn message(&self, reference: &str, before: Offset) -> String {
        let by = tidy(self.seconds, self.resolution_s);
        let rival = self.rival.map_or_else(String::new, |rival| {
            format!(
                "; so it does shifted by {} s, for its signals repeat",
                tidy(rival, self.resolution_s)
            )
        });
        let fit = format!(
            "correlation {:.4} instead of {:.4}{rival}",
            self.correlation, self.unshifted
        );
        match before {
            Offset::Word(_) => {
                format!("{by} s were added to its times, where it fits {reference} best ({fit}).")
            }
            Offset::Seconds(offset) => format!(
                "It fits {reference} best shifted by {by} s ({fit}): offset_s = {} in its map does that, or offset_s = \"align\".",
                tidy(offset + self.seconds, self.resolution_s)
            ),
        }
    }
}

/// Digits down to a tenth of the resolution.
fn tidy(value: f64, resolution: f64) -> String {
    let decimals = (1.0 - resolution.log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$}")
}

/// The shift at which `record` fits `run` best; `None` if they share no channel that changes, or less than half.
#[must_use]
pub fn shift(run: &TimeSeries, record: &TimeSeries) -> Option<Shift> {
    let ends = |time_series: &TimeSeries| {
        Some((
            *time_series.time_s().first()?,
            *time_series.time_s().last()?,
        ))
    };
    let ((run_from, run_to), (from, to)) = (ends(run)?, ends(record)?);
    let shorter = (run_to - run_from).min(to - from);
    let samples = run.time_s().len().min(record.time_s().len()).clamp(2, MOST);
    let step = (run_to - run_from).max(to - from) / (samples - 1) as f64;
    if !(shorter > 4.0 * step) {
        return None;
    }
    let on_grid =
        |time_series: &TimeSeries, name: &str, (from, to): (f64, f64)| -> Option<Vec<f64>> {
            let values = time_series.channel(name)?;
            let count = ((to - from) / step) as usize + 1;
            let at = |k: usize| between(time_series.time_s(), values, from + k as f64 * step);
            Some((0..count).map(at).collect())
        };
    let shared = record.channels().iter().filter_map(|channel| {
        let a = on_grid(run, &channel.name, (run_from, run_to))?;
        let b = on_grid(record, &channel.name, (from, to))?;
        Some((a, b))
    });
    let shared: Vec<(Vec<f64>, Vec<f64>)> = shared.collect();
    // The record's sample 0 lies at this sample of the run.
    let fit = |place: isize| -> Option<f64> {
        let each = shared.iter().filter_map(|(a, b)| correlation(a, b, place));
        let (sum, count) = each.fold((0.0, 0.0), |(sum, count), c| (sum + c, count + 1.0));
        (count > 0.0).then(|| sum / count)
    };
    let unshifted = ((from - run_from) / step).round() as isize;
    let lengths = shared
        .first()
        .map(|(a, b)| (a.len() as isize, b.len() as isize))?;
    let half = lengths.0.min(lengths.1) / 2;
    let fits: Vec<(isize, f64)> = (half - lengths.1..=lengths.0 - half)
        .filter_map(|place| Some((place, fit(place)?)))
        .collect();
    let &(best, height) = fits.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let fine = match (fit(best - 1), fit(best + 1)) {
        (Some(left), Some(right)) if 2.0 * height - left - right > 0.0 => {
            0.5 * (right - left) / (2.0 * height - left - right)
        }
        _ => 0.0,
    };
    let as_well = height - AS_WELL * (1.0 - height) - 1e-4;
    let peak = |k: &usize| {
        fits[*k].1 >= as_well && fits[*k].1 >= fits[k - 1].1 && fits[*k].1 >= fits[k + 1].1
    };
    let others = (1..fits.len().saturating_sub(1)).filter(peak);
    let apart = others.map(|k| fits[k].0 - best).filter(|d| d.abs() > 2);
    let seconds = |place: f64| run_from + place * step - from;
    Some(Shift {
        seconds: seconds(best as f64 + fine),
        correlation: height,
        unshifted: fit(unshifted).unwrap_or(0.0),
        rival: apart
            .min_by_key(|d| d.abs())
            .map(|d| seconds((best + d) as f64)),
        resolution_s: step,
    })
}

/// On the straight line between two samples; not a number outside.
fn between(time: &[f64], values: &[f64], t: f64) -> f64 {
    let after = time.partition_point(|&x| x < t).clamp(1, time.len() - 1);
    let part = (t - time[after - 1]) / (time[after] - time[after - 1]);
    if !(-1e-6..=1.0 + 1e-6).contains(&part) {
        return f64::NAN;
    }
    values[after - 1] + part * (values[after] - values[after - 1])
}

/// Pearson's correlation where both are there; `None` where one of them does not change.
fn correlation(a: &[f64], b: &[f64], place: isize) -> Option<f64> {
    let from = place.max(0) as usize;
    let to = (place + b.len() as isize).clamp(0, a.len() as isize) as usize;
    let stride = to.saturating_sub(from).div_ceil(COMPARED).max(1);
    let both = || {
        let pairs = (from..to)
            .step_by(stride)
            .map(|k| (a[k], b[(k as isize - place) as usize]));
        pairs.filter(|(x, y)| x.is_finite() && y.is_finite())
    };
    let (n, sx, sy) = both().fold((0.0, 0.0, 0.0), |(n, p, q), (x, y)| (n + 1.0, p + x, q + y));
    let (mx, my) = (sx / n, sy / n);
    let (xx, yy, xy) = both().fold((0.0, 0.0, 0.0), |(xx, yy, xy), (x, y)| {
        let (x, y) = (x - mx, y - my);
        (xx + x * x, yy + y * y, xy + x * y)
    });
    let scale = (xx * yy).sqrt();
    (scale > 0.0 && scale.is_finite()).then(|| xy / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time_series(from: f64, to: f64, step: f64, of: impl Fn(f64) -> f64) -> TimeSeries {
        let count = ((to - from) / step).round() as usize + 1;
        let time: Vec<f64> = (0..count).map(|k| from + k as f64 * step).collect();
        let values = time.iter().map(|t| of(*t)).collect();
        let mut time_series = TimeSeries::new(time).unwrap();
        time_series.push("input_torque_n_m", values).unwrap();
        time_series
    }

    fn swing(t: f64) -> f64 {
        1.4 + (-t / 0.05).exp() * (900.0 * t).sin() + 0.02 * (60.0 * t).sin()
    }

    #[test]
    fn a_shift_is_found_whatever_gain_and_noise() {
        let run = time_series(0.0, 0.6, 1e-4, swing);
        // Its clock began 12.34 ms after the run's.
        let noise = |t: f64| 0.01 * (31_337.0 * t).sin();
        let record = time_series(0.02, 0.5, 5e-5, |t| {
            3.0 + 1.02 * swing(t + 0.012_34) + noise(t)
        });
        let found = shift(&run, &record).unwrap();
        assert!((found.seconds - 0.012_34).abs() < 3e-5, "{found:?}");
        assert!(found.matters() && found.correlation > 0.98, "{found:?}");
        let message = found.message("native-reduced", Offset::Seconds(0.1));
        assert!(message.contains("offset_s = 0.1123"), "{message}");
    }

    #[test]
    fn nothing_is_said_of_what_fits() {
        let run = time_series(0.0, 0.6, 1e-4, swing);
        let found = shift(&run, &time_series(0.05, 0.55, 1e-4, swing)).unwrap();
        assert!(!found.matters(), "{found:?}");
        assert_eq!(found.rival, None);
        assert_eq!(shift(&run, &time_series(0.0, 0.6, 1e-4, |_| 2.0)), None);
        let mut other = TimeSeries::new(vec![0.0, 0.1, 0.2, 0.3]).unwrap();
        other.push("else_n", vec![0.0, 1.0, 0.0, 1.0]).unwrap();
        assert_eq!(shift(&run, &other), None);
    }

    #[test]
    fn what_repeats_has_rivals() {
        let wave = |t: f64| (100.0 * t).sin();
        let found = shift(
            &time_series(0.0, 0.6, 1e-4, wave),
            &time_series(0.0, 0.5, 1e-4, |t| wave(t + 0.01)),
        );
        let found = found.unwrap();
        let rival = found.rival.unwrap();
        let period = std::f64::consts::TAU / 100.0;
        let periods = (rival - found.seconds) / period;
        assert!((periods.abs() - 1.0).abs() < 0.02, "{found:?}");
    }
}
