//! Offset of a curve along its normal, over the phase of a lobe: a Fourier series or a periodic cubic spline.
//!
//! ```text
//! w(p) = sum_k c_k cos kp + s_k sin kp                   p = zs a, 0 at a lobe's tip and pi in the pit
//! spline: M_{k-1} + 4 M_k + M_{k+1} = 6/h^2 (w_{k-1} - 2 w_k + w_{k+1}),   M = w'' at n equal steps h = 2 pi/n
//! ```

use std::f64::consts::TAU;

/// Largest number of points or orders: beyond it an offset has ripples shorter than any contact.
const MOST: usize = 1000;
/// Number of sweeps for the equations of the spline; each at least halves the error.
const SWEEPS: usize = 60;

/// Periodic function of a lobe's phase with two continuous derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct LobeOffset {
    /// Amplitudes of cosine and sine of each order, m; empty for a spline.
    series: Vec<[f64; 2]>,
    /// Value and second derivative at equal steps of the phase, m; empty for a series.
    knots: Vec<[f64; 2]>,
}

impl LobeOffset {
    /// Creates the series with amplitudes of cosines from order 0 on and of sines from order 1 on, m.
    pub fn series(cos: &[f64], sin: &[f64]) -> Option<Self> {
        let orders = cos.len().max(sin.len() + 1);
        let amplitude = |list: &[f64], k: usize| list.get(k).copied().unwrap_or(0.0);
        let sine = |k: usize| k.checked_sub(1).map_or(0.0, |k| amplitude(sin, k));
        let series: Vec<_> = (0..orders).map(|k| [amplitude(cos, k), sine(k)]).collect();
        Self {
            series,
            knots: Vec::new(),
        }
        .sound()
    }

    /// Creates the cubic spline through `values` (m) at equal steps of the phase from 0 on, 3 or more.
    pub fn spline(values: &[f64]) -> Option<Self> {
        let n = values.len();
        if n < 3 {
            return None;
        }
        let mut knots: Vec<_> = values.iter().map(|&value| [value, 0.0]).collect();
        let scale = 6.0 * (n as f64 / TAU).powi(2);
        for k in (0..SWEEPS).flat_map(|_| 0..n) {
            let (before, after) = (knots[(k + n - 1) % n], knots[(k + 1) % n]);
            let bend = scale * (before[0] - 2.0 * knots[k][0] + after[0]);
            knots[k][1] = 0.25 * (bend - before[1] - after[1]);
        }
        Self {
            series: Vec::new(),
            knots,
        }
        .sound()
    }

    fn sound(self) -> Option<Self> {
        let mut all = self.series.iter().chain(&self.knots).flatten();
        let sound = all.all(|x| x.is_finite()) && self.series.len().max(self.knots.len()) <= MOST;
        sound.then_some(self)
    }

    /// Returns w, w' and w'' at a phase, m.
    pub fn at(&self, phase: f64) -> [f64; 3] {
        if self.knots.is_empty() {
            let mut sum = [0.0; 3];
            for (k, &[c, s]) in self.series.iter().enumerate() {
                let order = k as f64;
                let (sin, cos) = (order * phase).sin_cos();
                sum[0] += c * cos + s * sin;
                sum[1] += order * (s * cos - c * sin);
                sum[2] -= order * order * (c * cos + s * sin);
            }
            return sum;
        }
        let n = self.knots.len();
        let h = TAU / n as f64;
        let place = (phase / h).rem_euclid(n as f64);
        let k = (place as usize).min(n - 1);
        let ([w0, m0], [w1, m1]) = (self.knots[k], self.knots[(k + 1) % n]);
        let (b, a) = (place - k as f64, 1.0 - (place - k as f64));
        let sixth = h * h / 6.0;
        [
            a * w0 + b * w1 + sixth * ((a * a * a - a) * m0 + (b * b * b - b) * m1),
            (w1 - w0) / h + h / 6.0 * ((1.0 - 3.0 * a * a) * m0 + (3.0 * b * b - 1.0) * m1),
            a * m0 + b * m1,
        ]
    }

    /// Returns the number of samples of a lobe that resolve every wave and every piece.
    pub fn samples(&self) -> u32 {
        16 * self.series.len().max(self.knots.len()).max(6) as u32
    }

    /// Returns the largest |w| of these samples, m.
    pub fn largest(&self) -> f64 {
        let n = self.samples();
        let all = (0..n).map(|k| self.at(TAU * f64::from(k) / f64::from(n))[0].abs());
        all.fold(0.0, f64::max)
    }
}
