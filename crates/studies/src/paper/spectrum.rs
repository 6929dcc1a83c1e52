//! Amplitude spectra over orders, multiples of the input's frequency.
//!
//! Hann window, `w_k = (1 - cos(2 pi k/N))/2`; amplitude `2 |X_k| / sum w`: a wave `A cos` on a bin gives `A`.
//! Over a whole number n of input turns bin k is the order k/n exactly.

use std::f64::consts::TAU;

use realfft::RealFftPlanner;

use super::figure::{Curve, Figure, Number, Plot, number, verdict};
use super::read::{INPUT, OUTPUT, mean, part};
use super::runs::{Model, Runs};
use crate::StudyError;
use pinwheel_scene::{Scene, derived};

/// Input turns until the start has died down, and turns analysed: 15, in which a wheel turns once, so that every
/// order a wheel can make is a bin.
const TURNS: (usize, usize) = (3, 15);
/// Samples in a turn: up to order 256.
const SAMPLES: usize = 512;
/// Orders drawn.
const HIGHEST: usize = 70;
/// Bins to both sides that a line spreads over.
const SPREAD: usize = 2;

/// Single-sided amplitudes of `values` less their mean, bin 0 to N/2.
pub(super) fn amplitudes(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    if n == 0 {
        return Vec::new();
    }
    let middle = mean(values);
    let mut sum = 0.0;
    let mut windowed: Vec<f64> = values
        .iter()
        .enumerate()
        .map(|(k, v)| {
            let w = 0.5 * (1.0 - (TAU * k as f64 / n as f64).cos());
            sum += w;
            w * (v - middle)
        })
        .collect();
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    let mut bins = plan.make_output_vec();
    // It fails only for buffers of other lengths than its own.
    if plan.process(&mut windowed, &mut bins).is_err() {
        return Vec::new();
    }
    bins.iter().map(|bin| 2.0 * bin.norm() / sum).collect()
}

/// Predicted orders up to `highest`, of the input: multiples of the external mesh (zk) and of the internal one (zi zk/zs).
fn predicted(scene: &Scene, highest: f64) -> Vec<(f64, &'static str)> {
    let external = scene.gear.external_sleeves as f64;
    let internal = scene.gear.internal_sleeves as f64 * external / scene.gear.lobes() as f64;
    let multiples = |order: f64, name| {
        (1..)
            .map(move |k| f64::from(k) * order)
            .take_while(move |o| *o <= highest)
            .map(move |o| (o, name))
    };
    multiples(external, "external mesh")
        .chain(multiples(internal, "internal mesh"))
        .collect()
}

/// Share of the variation within [`SPREAD`] bins of the predicted orders.
fn share(bins: &[f64], orders: &[(f64, &str)]) -> f64 {
    let power = |range: std::ops::Range<usize>| -> f64 {
        range.filter_map(|k| bins.get(k)).map(|a| a * a).sum()
    };
    let mut wanted = vec![false; bins.len()];
    for (order, _) in orders {
        let at = (order * TURNS.1 as f64).round() as usize;
        for k in at.saturating_sub(SPREAD)..=at + SPREAD {
            if let Some(bin) = wanted.get_mut(k) {
                *bin = true;
            }
        }
    }
    let within: f64 = bins
        .iter()
        .zip(&wanted)
        .filter(|(_, on)| **on)
        .map(|(a, _)| a * a)
        .sum();
    within / power(SPREAD + 1..bins.len()).max(f64::MIN_POSITIVE)
}

pub(super) fn figure(runs: &Runs<'_>) -> Result<Figure, StudyError> {
    let scene = Scene::paper();
    let turn = TAU / scene.drive.input_speed_rad_s;
    let shown = HIGHEST * TURNS.1;
    let orders = predicted(&scene, SAMPLES as f64 / 2.0);
    let cases = [
        (Model::Ours, 0.0, "exact profile"),
        (Model::Ours, 6e-4, "exact profile, d = 0.6 mm"),
        (Model::Points(4000), 0.0, "4000 points"),
        (Model::Points(600), 0.0, "600 points"),
    ];
    let x: Vec<f64> = (1..=shown).map(|k| k as f64 / TURNS.1 as f64).collect();
    let mut plots: Vec<Plot> = [("spectrum-a", "input", INPUT), ("spectrum-b", "output", OUTPUT)]
        .iter()
        .map(|(key, shaft, _)| Plot {
            key: (*key).into(),
            title: format!("Spectrum of the {shaft} torque"),
            x_label: "Order (multiples of the input's 8.33 Hz)".into(),
            y_label: "Amplitude (N m)".into(),
            y_log: true,
            x: x.clone(),
            curves: Vec::new(),
            note: "Points: predicted orders, 16 and its multiples (external mesh), 8.533 and its multiples (internal mesh).".into(),
        })
        .collect();
    let mut numbers: Vec<Number> = Vec::new();
    let mut shares = Vec::new();
    let mut mesh = [0.0; 2];
    for (model, backlash, words) in cases {
        let run = runs.get(model, |s| {
            s.gear.backlash_m = backlash;
            s.solver.sample_s = turn / SAMPLES as f64;
            s.solver.duration_s = turn * (TURNS.0 + TURNS.1) as f64;
        })?;
        for (plot, name) in plots.iter_mut().zip([INPUT, OUTPUT]) {
            let values = part(&run.courses, name, (0.0, f64::MAX));
            let from = TURNS.0 * SAMPLES;
            let bins = amplitudes(values.get(from..from + TURNS.1 * SAMPLES).unwrap_or(&[]));
            if name == INPUT {
                shares.push(share(&bins, &orders));
                numbers.push(number(
                    format!("predicted_share, {words}"),
                    share(&bins, &orders),
                    "",
                ));
            }
            let at = |order: f64| {
                bins.get((order * TURNS.1 as f64).round() as usize)
                    .copied()
                    .unwrap_or(f64::NAN)
            };
            if name == INPUT && shares.len() == 1 {
                mesh = [at(orders[0].0), at(128.0 / 15.0)];
            }
            if plot.curves.is_empty() {
                // Markers stand on the converged run's lines.
                let mut marks = vec![f64::NAN; shown];
                for (order, _) in &orders {
                    let bin = (order * TURNS.1 as f64).round() as usize;
                    if let Some(mark) = marks.get_mut(bin.wrapping_sub(1)) {
                        *mark = at(*order);
                    }
                }
                plot.curves.push(Curve {
                    points: true,
                    ..Curve::line("predicted orders", marks)
                });
            }
            plot.curves
                .push(Curve::line(words, bins.get(1..=shown).unwrap_or(&[])));
        }
    }
    numbers.push(number("input_amplitude_order_16", mesh[0], "N m"));
    numbers.push(number("input_amplitude_order_8.533", mesh[1], "N m"));
    let hertz = derived(&scene)
        .frequencies
        .iter()
        .find(|f| f.order == 16.0)
        .map_or(f64::NAN, |f| f.hertz);
    Ok(Figure {
        id: "spectrum".into(),
        name: "Spectra".into(),
        title: "Orders in the torques".into(),
        says: "No figure of the paper; it calls the torques random functions of time.".into(),
        found: format!(
            "{:.1} % of the input torque's variation lies at the predicted orders ({:.1} % with 0.6 mm of backlash); with 4000 points {:.1} %, with 600 {:.1} %. \
             Order 16 ({hertz:.1} Hz) has {:.4} N m, order 8.533 {:.4} N m.",
            100.0 * shares[0],
            100.0 * shares[1],
            100.0 * shares[2],
            100.0 * shares[3],
            mesh[0],
            mesh[1]
        ),
        why: "A random function has no lines. zk and zi are even, so the two wheels, half a turn apart, are in phase and nothing cancels."
            .into(),
        numbers,
        verdict: verdict(shares[0] < 0.5, shares.iter().any(|s| *s < 0.5)),
        plots,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_on_a_bin_has_its_amplitude() {
        let n = TURNS.1 * SAMPLES;
        let values: Vec<f64> = (0..n)
            .map(|k| 7.0 + 3.0 * (16.0 * TAU * k as f64 / SAMPLES as f64).cos())
            .collect();
        let bins = amplitudes(&values);
        assert!((bins[16 * TURNS.1] - 3.0).abs() < 1e-9);
        assert!(bins[0] < 1e-9 && bins[100] < 1e-9);
        let orders = predicted(&Scene::paper(), 64.0);
        assert!(share(&bins, &orders) > 0.999);
        let between: Vec<f64> = (0..n)
            .map(|k| (12.0 * TAU * k as f64 / SAMPLES as f64).cos())
            .collect();
        assert!(share(&amplitudes(&between), &orders) < 1e-3);
        assert!(amplitudes(&[]).is_empty());
    }

    #[test]
    fn predicted_orders() {
        let orders: Vec<f64> = predicted(&Scene::paper(), 20.0)
            .into_iter()
            .map(|o| o.0)
            .collect();
        assert_eq!(orders.len(), 3);
        assert!((orders[1] - 8.533_333).abs() < 1e-5 && (orders[2] - 17.066_667).abs() < 1e-5);
    }
}
