//! Compact time series: rounded to readable digits, predicted, deflated, in base64.
//!
//! A column is cut into blocks of [`BLOCK`] values, stored as integer multiples of a quantum, a power of two. Curves have
//! one quantum for the column. Differences have one for each block, so that a difference that decays by ten decades keeps
//! its digits. The page has the distance of each value from its prediction, the continuation of a constant, a line or a
//! parabola through the previous values, as integers of variable length. Reader and writer predict from the same rounded
//! values, so errors do not accumulate: the largest is half a quantum of the block.

use crate::script;

/// Number of values with a common quantum.
pub(crate) const BLOCK: usize = 32;
/// Smallest quantum over a column's largest value: the resolution of double precision.
const FINEST: i32 = 46;
/// Largest magnitude of a column that counts as zero.
const TINY: f64 = 1e-280;

/// Rounding of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rounding {
    /// Rounds to this many binary digits of the column's largest value.
    OfPeak(i32),
    /// Rounds to this many binary digits of each block's root mean square.
    OfBlock(i32),
}

/// Writer of columns in sequence.
#[derive(Debug, Default)]
pub(crate) struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// Writes a non-negative integer.
    pub(crate) fn number(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.bytes.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.bytes.push(value as u8);
    }

    /// Writes an integer.
    fn signed(&mut self, value: i64) {
        self.number(((value << 1) ^ (value >> 63)) as u64);
    }

    /// Writes increasing indices, e.g. of samples.
    pub(crate) fn places(&mut self, places: &[usize]) {
        self.number(places.len() as u64);
        let mut last = 0;
        for &place in places {
            self.number((place - last) as u64);
            last = place;
        }
    }

    /// Writes a column; non-finite values are gaps.
    pub(crate) fn column(&mut self, values: &[f64], rounding: Rounding) {
        self.number(values.len() as u64);
        // Indices at which gaps begin and end alternately.
        let mut edges = Vec::new();
        let mut kept = Vec::with_capacity(values.len());
        for (k, value) in values.iter().enumerate() {
            let gap = edges.len() % 2 == 1;
            if value.is_finite() == gap {
                edges.push(k);
            }
            if value.is_finite() {
                kept.push(*value);
            }
        }
        self.places(&edges);
        let exponents = exponents(&kept, rounding);
        let all = (0..3).map(|order| residuals(&kept, &exponents, order));
        let size = |list: &[i64]| -> u32 {
            let bits = |v: &i64| 64 - v.unsigned_abs().leading_zeros();
            list.iter().map(bits).sum()
        };
        let best = all.enumerate().min_by_key(|(_, list)| size(list));
        let (order, list) = best.unwrap_or_default();
        self.number(order as u64);
        let mut last = 0;
        for &exponent in &exponents {
            self.signed(i64::from(exponent - last));
            last = exponent;
        }
        for residual in list {
            self.signed(residual);
        }
    }

    /// Returns the deflated data as base64.
    pub(crate) fn finish(self) -> String {
        script::packed(&self.bytes)
    }
}

/// Returns the exponent of the power of two at or below a positive number.
fn log2(value: f64) -> i32 {
    value.log2().floor() as i32
}

/// Returns the quantum of each block as a power of two.
fn exponents(values: &[f64], rounding: Rounding) -> Vec<i32> {
    let peak = values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    // A column that is practically zero has no quantum.
    if peak < TINY {
        return vec![0; values.len().div_ceil(BLOCK)];
    }
    let finest = log2(peak) - FINEST;
    let mut last = finest;
    let of = |block: &[f64]| {
        let exponent = match rounding {
            Rounding::OfPeak(digits) => log2(peak) - digits,
            Rounding::OfBlock(digits) => {
                let square = block.iter().map(|v| v * v).sum::<f64>() / block.len() as f64;
                if square > 0.0 {
                    log2(square.sqrt()) - digits
                } else {
                    last
                }
            }
        };
        last = exponent.max(finest);
        last
    };
    values.chunks(BLOCK).map(of).collect()
}

/// Returns the difference of each value from its prediction, in quanta.
fn residuals(values: &[f64], exponents: &[i32], order: usize) -> Vec<i64> {
    let (mut one, mut two) = (0.0, 0.0);
    let mut list = Vec::with_capacity(values.len());
    for (block, &exponent) in values.chunks(BLOCK).zip(exponents) {
        let quantum = 2f64.powi(exponent);
        list.extend(block.iter().map(|value| {
            let predicted = match order {
                0 => 0.0,
                1 => one,
                _ => 2.0 * one - two,
            };
            let residual = ((value - predicted) / quantum).round();
            (two, one) = (one, predicted + residual * quantum);
            residual as i64
        }));
    }
    list
}

#[cfg(test)]
pub(crate) mod tests {
    use base64::Engine as _;
    use base64::engine::general_purpose::STANDARD;

    use super::*;

    /// Reader equivalent to the page's script.
    pub(crate) struct Reader {
        bytes: std::vec::IntoIter<u8>,
    }

    impl Reader {
        pub(crate) fn new(text: &str) -> Self {
            let packed = STANDARD.decode(text).unwrap();
            let bytes = miniz_oxide::inflate::decompress_to_vec(&packed).unwrap();
            Self {
                bytes: bytes.into_iter(),
            }
        }

        fn number(&mut self) -> u64 {
            let (mut value, mut shift) = (0, 0);
            loop {
                let byte = self.bytes.next().unwrap();
                value |= u64::from(byte & 0x7f) << shift;
                shift += 7;
                if byte < 0x80 {
                    return value;
                }
            }
        }

        fn signed(&mut self) -> i64 {
            let value = self.number();
            (value >> 1) as i64 ^ -((value & 1) as i64)
        }

        pub(crate) fn places(&mut self) -> Vec<usize> {
            let mut last = 0;
            let count = self.number();
            let next = |_| {
                last += self.number() as usize;
                last
            };
            (0..count).map(next).collect()
        }

        pub(crate) fn column(&mut self) -> Vec<f64> {
            let count = self.number() as usize;
            let edges = self.places();
            let gap = |k: usize| edges.iter().filter(|&&e| e <= k).count() % 2 == 1;
            let kept = (0..count).filter(|&k| !gap(k)).count();
            let order = self.number();
            let mut last = 0;
            let mut exponents = Vec::new();
            for _ in 0..kept.div_ceil(BLOCK) {
                last += self.signed();
                exponents.push(last as i32);
            }
            let (mut one, mut two) = (0.0, 0.0);
            let (mut values, mut place) = (Vec::new(), 0);
            for k in 0..count {
                if gap(k) {
                    values.push(f64::NAN);
                    continue;
                }
                let predicted = [0.0, one, 2.0 * one - two][order as usize];
                let value = predicted + self.signed() as f64 * 2f64.powi(exponents[place / BLOCK]);
                (two, one) = (one, value);
                place += 1;
                values.push(value);
            }
            values
        }
    }

    fn back(values: &[f64], rounding: Rounding) -> (Vec<f64>, usize) {
        let mut writer = Writer::default();
        writer.column(values, rounding);
        let text = writer.finish();
        (Reader::new(&text).column(), text.len())
    }

    #[test]
    fn curves_come_back_to_half_a_quantum() {
        let wave: Vec<f64> = (0..6001)
            .map(|k| 100.0 * (0.02 * f64::from(k)).sin())
            .collect();
        let (read, size) = back(&wave, Rounding::OfPeak(16));
        assert_eq!(read.len(), wave.len());
        for (a, b) in read.iter().zip(&wave) {
            assert!((a - b).abs() <= 0.5 * 64.0 / 65536.0, "{a} {b}");
        }
        // Stored as 32-bit floats the column would take 32 000.
        assert!(size < 9000, "{size}");
    }

    #[test]
    fn a_difference_that_decays_keeps_its_digits() {
        let decay: Vec<f64> = (0..4000)
            .map(|k| (-0.005 * f64::from(k)).exp() * (0.7 * f64::from(k)).sin())
            .collect();
        let (read, _) = back(&decay, Rounding::OfBlock(6));
        for (block, exact) in read.chunks(BLOCK).zip(decay.chunks(BLOCK)) {
            let rms = (exact.iter().map(|v| v * v).sum::<f64>() / exact.len() as f64).sqrt();
            for (a, b) in block.iter().zip(exact) {
                assert!((a - b).abs() <= rms / 128.0, "{a} {b} {rms}");
            }
        }
    }

    #[test]
    fn gaps_ends_and_nothing() {
        let nan = f64::NAN;
        for values in [
            &[][..],
            &[0.0; 40],
            &[nan, nan],
            &[nan, 1.0, nan, nan, -2.0, 3.0, 0.0],
            &[f64::INFINITY, 5e-324],
        ] {
            let (read, _) = back(values, Rounding::OfBlock(6));
            assert_eq!(read.len(), values.len());
            for (a, b) in read.iter().zip(values) {
                let close = (a - b).abs() <= 0.02;
                assert!(if b.is_finite() { close } else { a.is_nan() }, "{a} {b}");
            }
        }
    }
}
