//! Roughness and range of time series.

use pinwheel_studies::internals::{off, roughness};
use pinwheel_timeseries::norms::range;

#[test]
fn a_wave_is_as_rough_as_it_is_high() {
    let wave: Vec<f64> = (0..1000)
        .map(|k| 5.0 + 2.0 * (f64::from(k) * 0.1 * std::f64::consts::TAU).sin())
        .collect();
    // Two complete waves of ten samples vanish from the mean of 21 samples, so one sample remains. The tolerance allows for the
    // ends.
    assert!((roughness(&wave, 10) - 20.0 / 21.0 * 2.0_f64.sqrt()).abs() < 0.02);
    assert!(roughness(&[3.0; 50], 5) < 1e-12);
    assert!((range(&wave) - 4.0).abs() < 0.2 && range(&[]) == 0.0);
    assert!((off(&[1.1, 2.2], &[1.0, 2.0]) - 0.1).abs() < 1e-12);
}
