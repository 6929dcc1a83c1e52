//! Amplitude spectra over orders.

use std::f64::consts::TAU;

use pinwheel_scene::Scene;
use pinwheel_studies::internals::{SAMPLES, TURNS, amplitudes, predicted, share};

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
