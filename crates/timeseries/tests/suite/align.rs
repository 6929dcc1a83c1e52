//! Time shift between a run and a record.

use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::foreign::{Offset, shift};
use std::f64::consts::TAU;

fn series(from: f64, to: f64, step: f64, of: impl Fn(f64) -> f64) -> TimeSeries {
    let count = ((to - from) / step).round() as usize + 1;
    let time: Vec<f64> = (0..count).map(|k| from + k as f64 * step).collect();
    let values = time.iter().map(|t| of(*t)).collect();
    let mut series = TimeSeries::new(time).unwrap();
    series.push("input_torque_n_m", values).unwrap();
    series
}

/// Start-up of two decaying vibrations on a slow oscillation.
fn swing(t: f64) -> f64 {
    let ring = |decay: f64, hz: f64| (-t / decay).exp() * (TAU * hz * t).sin();
    1.4 + ring(0.05, 1200.0) + 0.5 * ring(0.1, 730.0) + 0.02 * (60.0 * t).sin()
}

/// A record of a twelfth of the run, with 8 samples to an oscillation: 500 points over both would alias.
#[test]
fn regress_a_short_record_is_placed_on_the_finer_grid() {
    let run = series(0.0, 0.6, 1e-4, swing);
    for late in [0.1, 0.100_04, 0.023_456_7] {
        let record = series(0.0, 0.05, 1e-4, |t| 3.0 + 1.02 * swing(t + late));
        let fit = shift(&run, &record).unwrap();
        let off = (fit.seconds - late).abs();
        assert!(off <= fit.uncertainty_s && off < 4e-6, "{late}: {fit:?}");
        assert!(fit.correlation > 0.9995 && fit.matters(), "{fit:?}");
    }
    let exact = shift(&run, &series(0.0, 0.05, 1e-4, |t| swing(t + 0.1))).unwrap();
    let off = (exact.seconds - 0.1).abs();
    assert!(off < 4e-6 && exact.correlation > 0.999_99, "{exact:?}");
    let message = exact.message("native-reduced", Offset::Seconds(0.1));
    assert!(message.contains("offset_s = 0.20000"), "{message}");
    // Sampled 20 times as often, and with bursts of short steps.
    let fine = shift(&run, &series(0.0, 0.05, 5e-6, |t| swing(t + 0.1))).unwrap();
    assert!((fine.seconds - 0.1).abs() < 1e-6, "{fine:?}");
}

/// The stated uncertainty bounds the error for any gain and noise, and with a vibration of another phase that moves the peak.
#[test]
fn regress_the_shifts_uncertainty_holds() {
    let run = series(0.0, 0.2, 1e-4, swing);
    for k in 0..40 {
        let late = 0.01 + 1.37e-5 * f64::from(k);
        let noise = 0.02 * f64::from(k % 5);
        let hum = |t: f64| noise * ((31_337.0 * t).sin() + (TAU * 1200.0 * t).sin());
        let record = series(0.02, 0.12, 9e-5, |t| 2.0 * swing(t + late) + hum(t));
        let fit = shift(&run, &record).unwrap();
        let off = (fit.seconds - late).abs();
        assert!(
            off <= fit.uncertainty_s,
            "{late}, noise {noise}: {off:e} {fit:?}"
        );
        assert!(fit.uncertainty_s < 1e-4, "{fit:?}");
    }
}

#[test]
fn nothing_is_advised_where_times_are_true() {
    let run = series(0.0, 0.6, 1e-4, swing);
    // All of the run, two parts of it, and its last fortieth.
    for (from, to, step) in [
        (0.0, 0.6, 1e-4),
        (0.05, 0.55, 1e-4),
        (0.05, 0.055, 1e-4),
        (0.1, 0.115, 7e-5),
    ] {
        let fit = shift(&run, &series(from, to, step, swing)).unwrap();
        assert!(!fit.matters(), "{from}: {fit:?}");
    }
}

#[test]
fn regress_too_little_to_align_by_is_named() {
    let run = series(0.0, 0.02, 1e-4, swing);
    let mut other = TimeSeries::new(run.time_s().to_vec()).unwrap();
    let values = run.time_s().iter().map(|t| t.sin()).collect();
    other.push("else_n", values).unwrap();
    // The common tip is at the end of one and at the beginning of the other.
    let tip = |at: f64| series(0.0, 0.02, 1e-4, move |t| (t - at).abs());
    for (record, part) in [
        (
            series(0.0, 0.02, 1e-4, |_| 2.0),
            "no column that both have changes",
        ),
        (other, "no column that both have changes"),
        (series(0.0, 4e-4, 1e-4, swing), "too few"),
    ] {
        let why = shift(&run, &record).unwrap_err();
        assert!(why.contains(part), "{part}: {why}");
    }
    let why = shift(&tip(0.019), &tip(0.001)).unwrap_err();
    assert!(why.contains("only half of it overlaps"), "{why}");
}

#[test]
fn regress_equal_maxima_are_named() {
    let wave = |t: f64| (100.0 * t).sin();
    let fit = shift(
        &series(0.0, 0.6, 1e-4, wave),
        &series(0.0, 0.5, 1e-4, |t| wave(t + 0.01)),
    );
    let fit = fit.unwrap();
    let periods = (fit.rival.unwrap() - fit.seconds) / (TAU / 100.0);
    assert!((periods.abs() - 1.0).abs() < 0.02, "{fit:?}");
    let message = fit.message("run", Offset::Seconds(0.0));
    assert!(message.contains("two maxima are equal"), "{message}");
}
