//! Discrete Fourier transform of real samples.

use std::collections::BTreeSet;

use pinwheel_timeseries::fourier::{Complex64, forward, inverse};

/// Least samples of [`resampled`] a cycle of the highest frequency.
const A_CYCLE: usize = 8;

/// Returns `|X_k|` of bins 0 to N/2.
pub(crate) fn moduli(samples: Vec<f64>) -> Vec<f64> {
    let bins = forward(samples);
    bins.iter().map(|bin| bin.norm()).collect()
}

/// True if no two harmonics of these base frequencies (cycles a period) are aliases in `count` samples. The order of a harmonic,
/// at most `orders`, is the sum of its multiples of both.
pub fn resolves(count: usize, base: [usize; 2], orders: i64) -> bool {
    let all = (0..=orders).flat_map(|order| harmonics(order, base));
    let all: BTreeSet<i64> = all.flat_map(|f| [f, -f]).collect();
    let bins = all.iter().map(|f| f.rem_euclid(count as i64));
    bins.collect::<BTreeSet<i64>>().len() == all.len()
}

/// Returns the frequencies of an order, cycles a period, one of each and its opposite.
fn harmonics(order: i64, base: [usize; 2]) -> impl Iterator<Item = i64> {
    let [first, second] = base.map(|base| base as i64);
    let multiples = (0..=order).flat_map(move |a| [(a, order - a), (a, a - order)]);
    multiples.map(move |(a, b)| a * first + b * second)
}

/// Returns a period of the trigonometric polynomial through equidistant samples of one, at more places.
///
/// Its frequencies are sums of multiples of two `base` frequencies, cycles a period. Every bin takes the sum of lowest order
/// that it may be an alias of, so fewer samples than two a cycle give a signal of few orders where they [resolve](resolves) them.
/// The number of samples has no factor in common with a base frequency.
pub fn resampled(samples: Vec<f64>, base: [usize; 2]) -> Vec<f64> {
    let count = samples.len();
    let bins = forward(samples);
    let mut frequencies = vec![None; bins.len()];
    for order in 0..=count as i64 {
        if frequencies.iter().all(Option::is_some) {
            break;
        }
        for frequency in harmonics(order, base) {
            let bin = frequency.rem_euclid(count as i64) as usize;
            let (bin, frequency) = match bin < bins.len() {
                true => (bin, frequency),
                false => (count - bin, -frequency),
            };
            frequencies[bin].get_or_insert(frequency);
        }
    }
    let highest = frequencies
        .iter()
        .flatten()
        .map(|f: &i64| f.unsigned_abs() as usize)
        .max();
    let dense = (A_CYCLE * highest.unwrap_or_default().max(1)).next_power_of_two();
    let mut spectrum = vec![Complex64::default(); dense / 2 + 1];
    for (k, (bin, frequency)) in bins.iter().zip(frequencies).enumerate() {
        let Some(frequency) = frequency else { continue };
        // The middle bin of an even number of samples stands alone, the others for their conjugates too.
        let share = if 2 * k == count { 0.5 } else { 1.0 } / count as f64;
        let bin = if frequency < 0 { bin.conj() } else { *bin };
        spectrum[frequency.unsigned_abs() as usize] += bin * share;
    }
    inverse(spectrum, dense)
}
