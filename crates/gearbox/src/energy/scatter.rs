//! Uncertainty of an energy account between its entries, as for sampled means, from the sixth difference of seven entries
//! ([`pinwheel_timeseries::sampling`]).

use pinwheel_timeseries::sampling::{POINTS, sixth_difference};

/// Two powers, W: the one whose integral is the remainder, except for the growth of kinetic and stored energy, and that of the
/// losses.
pub(super) type Two = [f64; 2];

/// Squares of the uncertainties of both integrals, J^2, up to the last entry but three.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Scatter {
    /// Sums of squares of completed segments and of the present one.
    squares: Two,
    /// Values of the last evaluated interval.
    last: Two,
    /// Number of stored entries of the present segment, at most seven.
    len: usize,
    is_known: bool,
    times: [f64; POINTS],
    powers: [Two; POINTS],
}

impl Scatter {
    #[inline]
    pub(super) fn add(&mut self, time: f64, powers: Two) {
        if self.len == POINTS {
            self.times.copy_within(1.., 0);
            self.powers.copy_within(1.., 0);
            self.len -= 1;
        }
        self.times[self.len] = time;
        self.powers[self.len] = powers;
        self.len += 1;
        if self.len < POINTS {
            return;
        }
        let weights = sixth_difference(&self.times);
        let h = self.times[4] - self.times[3];
        self.last = [0, 1].map(|k| {
            let parts = self.powers.iter().zip(weights).map(|(p, w)| w * p[k]);
            (h * parts.sum::<f64>()).powi(2)
        });
        // The first value of a segment also represents the intervals before it.
        let intervals = if self.is_known { 1.0 } else { 4.0 };
        self.is_known = true;
        self.count(self.last, intervals);
    }

    fn count(&mut self, squares: Two, intervals: f64) {
        for (sum, square) in self.squares.iter_mut().zip(squares) {
            *sum += intervals * square;
        }
    }

    /// Returns the squares so far; with fewer than seven entries their range applies.
    pub(super) fn squares(&self) -> Two {
        let mut all = self.squares;
        if self.is_known || self.len == 0 {
            return all;
        }
        let (times, powers) = (&self.times[..self.len], &self.powers[..self.len]);
        for (k, sum) in all.iter_mut().enumerate() {
            let values = powers.iter().map(|p| p[k]);
            let least = values.clone().fold(f64::INFINITY, f64::min);
            let range = values.fold(f64::NEG_INFINITY, f64::max) - least;
            *sum += (range * (times[self.len - 1] - times[0])).powi(2);
        }
        all
    }

    /// Starts a new segment with the next entry.
    pub(super) fn restart(&mut self) {
        if self.is_known {
            self.count(self.last, 3.0);
        } else {
            self.squares = self.squares();
        }
        (self.len, self.is_known) = (0, false);
    }
}
