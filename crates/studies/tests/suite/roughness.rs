//! Figures read off time series.

use pinwheel_studies::internals::{off, roughness};
use pinwheel_timeseries::norms::range;

#[test]
fn a_wave_is_as_rough_as_it_is_high() {
    let wave: Vec<f64> = (0..1000)
        .map(|k| 5.0 + 2.0 * (f64::from(k) * 0.1 * std::f64::consts::TAU).sin())
        .collect();
    // Ten samples a wave: of the 21 around a sample two complete waves vanish from the mean, the sample itself
    // counts once too often. The ends are less regular.
    assert!((roughness(&wave, 10) - 20.0 / 21.0 * 2.0_f64.sqrt()).abs() < 0.02);
    assert!(roughness(&[3.0; 50], 5) < 1e-12);
    assert!((range(&wave) - 4.0).abs() < 0.2 && range(&[]) == 0.0);
    assert!((off(&[1.1, 2.2], &[1.0, 2.0]) - 0.1).abs() < 1e-12);
}
