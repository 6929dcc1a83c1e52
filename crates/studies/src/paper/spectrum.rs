//! Amplitude spectra over orders, multiples of the input's frequency.
//!
//! Hann window, `w_k = (1 - cos(2 pi k/N))/2`; amplitude `2 |X_k| / sum w`: a wave `A cos` on a bin gives `A`. Over n complete
//! input turns bin k is exactly the order k/n.

use std::f64::consts::TAU;

use super::figure::{Curve, Measured, number};
use super::read::{INPUT, OUTPUT, mean, part};
use super::runs::{Model, Runs};
use crate::StudyError;
use crate::fourier::moduli;
use pinwheel_scene::{Scene, derived};

/// Input turns skipped for the start-up, and turns analysed: 15, one turn of a disc, so that every order of a disc is a bin.
pub const TURNS: (usize, usize) = (3, 15);
/// Samples in a turn: up to order 256.
pub const SAMPLES: usize = 512;
/// Highest order in the plot.
const HIGHEST: usize = 70;
/// Bins on both sides of a line that it spreads over.
const SPREAD: usize = 2;

/// Returns the single-sided amplitudes of `values` less their mean, bin 0 to N/2.
pub fn amplitudes(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let middle = mean(values);
    let weights = (0..n).map(|k| 0.5 * (1.0 - (TAU * k as f64 / n as f64).cos()));
    let sum: f64 = weights.clone().sum();
    let windowed = values.iter().zip(weights).map(|(v, w)| w * (v - middle));
    let bins = moduli(windowed.collect()).into_iter();
    bins.map(|bin| 2.0 * bin / sum).collect()
}

/// Returns the predicted orders of the input up to `highest`: multiples of the external mesh (zk) and of the internal one (zi
/// zk/zs).
pub fn predicted(scene: &Scene, highest: f64) -> Vec<(f64, &'static str)> {
    let external = scene.gear.external_sleeves as f64;
    let internal = scene.gear.internal_sleeves as f64 * external / scene.gear.lobes() as f64;
    let multiples = |order: f64, name| {
        let orders = (1..).map(move |k| f64::from(k) * order);
        let orders = orders.take_while(move |o| *o <= highest);
        orders.map(move |o| (o, name))
    };
    let internal = multiples(internal, "internal mesh");
    multiples(external, "external mesh")
        .chain(internal)
        .collect()
}

/// Returns the bin of an order in a spectrum.
fn bin(order: f64) -> usize {
    (order * TURNS.1 as f64).round() as usize
}

/// Returns the share of the variation within `SPREAD` bins of the predicted orders.
pub fn share(bins: &[f64], orders: &[(f64, &str)]) -> f64 {
    let mut wanted = vec![false; bins.len()];
    for (order, _) in orders {
        let at = bin(*order);
        for k in at.saturating_sub(SPREAD)..=at + SPREAD {
            if let Some(bin) = wanted.get_mut(k) {
                *bin = true;
            }
        }
    }
    let within = bins.iter().zip(&wanted).filter(|(_, on)| **on);
    let within: f64 = within.map(|(a, _)| a * a).sum();
    let all: f64 = bins.iter().skip(SPREAD + 1).map(|a| a * a).sum();
    within / all.max(f64::MIN_POSITIVE)
}

pub(super) fn figure(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let scene = Scene::paper();
    let turn = TAU / scene.drive.input_speed_rad_s;
    let shown = HIGHEST * TURNS.1;
    let orders = predicted(&scene, SAMPLES as f64 / 2.0);
    let cases = [
        (Model::Ours, 0.0, "exact profile"),
        (Model::Ours, 6e-4, "exact profile, d = 0.6 mm"),
        (Model::FINE, 0.0, "4000 points"),
        (Model::ROUGH, 0.0, "600 points"),
    ];
    let x: Vec<f64> = (1..=shown).map(|k| k as f64 / TURNS.1 as f64).collect();
    let mut result = Measured::new("spectrum", Vec::new(), Vec::new());
    for (key, channel) in [("spectrum-a", INPUT), ("spectrum-b", OUTPUT)] {
        let mut curves = Vec::new();
        for (model, backlash, words) in cases {
            let run = runs.get(model, |s| {
                s.gear.backlash_m = backlash;
                s.solver.sample_s = turn / SAMPLES as f64;
                s.solver.duration_s = turn * (TURNS.0 + TURNS.1) as f64;
            })?;
            let values = part(&run.time_series, channel, (0.0, f64::MAX));
            let from = TURNS.0 * SAMPLES;
            let bins = amplitudes(values.get(from..from + TURNS.1 * SAMPLES).unwrap_or(&[]));
            let at = |order: f64| bins.get(bin(order)).copied().unwrap_or(f64::NAN);
            if channel == INPUT {
                let name = format!("predicted_share, {words}");
                result.numbers.push(number(name, share(&bins, &orders), ""));
            }
            if curves.is_empty() {
                if channel == INPUT {
                    result.numbers.extend([
                        number("input_amplitude_order_16", at(16.0), "N m"),
                        number("input_amplitude_order_8.533", at(128.0 / 15.0), "N m"),
                    ]);
                }
                // Markers on the converged run's lines.
                let mut marks = vec![f64::NAN; shown];
                for (order, _) in &orders {
                    if let Some(mark) = marks.get_mut(bin(*order).wrapping_sub(1)) {
                        *mark = at(*order);
                    }
                }
                curves.push(Curve::points("predicted orders", marks));
            }
            curves.push(Curve::line(words, bins.get(1..=shown).unwrap_or(&[])));
        }
        result.plots.push((key.to_owned(), x.clone(), curves));
    }
    let frequencies = derived(&scene).frequencies;
    let mesh = frequencies.iter().find(|f| f.order == 16.0);
    let hertz = mesh.map_or(f64::NAN, |f| f.hertz);
    result.numbers.push(number("order_16_hz", hertz, "Hz"));
    Ok(vec![result])
}
