//! Norms, statistics and distances.

use pinwheel_timeseries::norms::*;
use pinwheel_timeseries::{TimeSeries, columns};

#[test]
fn known_values() {
    let view = View::new(vec![&[1.0, -7.0], &[3.0, 1.0]]);
    let figures = Statistics::of(&view).unwrap();
    assert_eq!(
        (figures.mean, figures.min, figures.max, figures.peak),
        (-0.5, -7.0, 3.0, 7.0)
    );
    assert!((figures.rms - 15f64.sqrt()).abs() < 1e-15);
}

#[test]
fn huge_values_do_not_overflow() {
    let figures = Statistics::of(&View::new(vec![&[1e200, -1e200, 1e200]])).unwrap();
    assert!((figures.rms / 1e200 - 1.0).abs() < 1e-15);
    let largest = Statistics::of(&View::new(vec![&[f64::MAX, f64::MAX]])).unwrap();
    assert!(largest.mean.is_finite() && largest.rms.is_finite());
    // Below the smallest normal number.
    let tiny = Statistics::of(&View::new(vec![&[3e-320, -1e-320]])).unwrap();
    assert_eq!((tiny.mean, tiny.peak), (1e-320, 3e-320));
}

#[test]
fn nothing_and_non_finite() {
    assert!(Statistics::of(&View::new(vec![])).is_none());
    assert!(Statistics::of(&View::new(vec![&[]])).is_none());
    // At any position: values are processed four at a time.
    for place in 0..6 {
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut values = [1.0; 6];
            values[place] = odd;
            let view = View::new(vec![&values]);
            assert!(Statistics::of(&view).is_none() && view.mean().is_none());
        }
    }
    assert!(View::new(vec![&[]]).mean().is_none());
}

/// A distance that is NaN does not count as small.
#[test]
fn the_worst_of_two_distances() {
    let of = |forces: f64, driver_torque: f64| Distance {
        forces,
        driver_torque,
        force_at_most: 3.0,
        torque_at_most: 6.0,
    };
    assert_eq!((of(1.0, 2.0).worst(), of(2.0, 1.0).worst()), (2.0, 2.0));
    assert!(of(f64::NAN, 1.0).worst().is_nan() && of(1.0, f64::NAN).worst().is_nan());
    let sum = of(2.0, 4.0).plus(&of(1.0, 2.0));
    assert_eq!((sum.forces, sum.driver_torque), (3.0, 6.0));
    assert_eq!((sum.force_at_most, sum.torque_at_most), (6.0, 12.0));
    assert_eq!(of(2.0, 4.0).at_least(3.0), of(3.0, 4.0));
}

/// Returns a force and a torque that are linear in time.
fn time_series(times: &[f64], force: f64, torque: f64) -> TimeSeries {
    let mut time_series = TimeSeries::new(times.to_vec()).unwrap();
    let values = |slope: f64| times.iter().map(|t| slope * t).collect();
    time_series
        .push(columns::INPUT_TORQUE, values(torque))
        .unwrap();
    time_series
        .push("external_sleeve_force_n_0", values(force))
        .unwrap();
    time_series
}

#[test]
fn what_is_nothing_is_measured_by_the_least_load() {
    let least = LoadFloor {
        force_n: 0.5,
        torque_n_m: 2e-3,
    };
    let times = [0.0, 3.0, 4.0];
    let nothing = time_series(&times, 0.0, 0.0);
    let off = Distance::between(&time_series(&times, 0.5, 2e-3), &nothing, least);
    // sqrt((3^2 + 4^2)/3 samples)
    let expected = (25.0_f64 / 3.0).sqrt();
    for actual in [off.forces, off.driver_torque] {
        assert!((actual / expected - 1.0).abs() < 1e-12, "{off:?}");
    }
    let something = time_series(&times, 1.0, 1.0);
    let against_nothing = Distance::between(&something, &nothing, LoadFloor::default());
    assert_eq!(
        (against_nothing.forces, against_nothing.worst()),
        (1.0, 1.0)
    );
    assert_eq!(
        Distance::between(&nothing, &nothing, LoadFloor::default()).worst(),
        0.0
    );
}

/// A series with fewer samples, or with rounded times, is compared at its own times.
#[test]
fn samples_are_compared_at_their_times() {
    let fine = time_series(&[0.0, 1.0, 2.0, 3.0, 4.0], 100.0, 10.0);
    for coarse in [[0.0, 2.0, 4.0], [0.0, 2.0 + 1e-9, 4.0 - 1e-9]] {
        let off = Distance::between(
            &time_series(&coarse, 110.0, 10.0),
            &fine,
            LoadFloor::default(),
        );
        assert!((off.forces - 0.1).abs() < 1e-8, "{off:?}");
        assert!(off.driver_torque < 1e-8, "{off:?}");
        assert!((off.force_at_most - 0.1).abs() < 1e-8 && off.torque_at_most < 1e-8);
    }
    let rows: Vec<_> = rows_at(&[0.0, 1.5, 2.0], &[0.0, 1.0, 2.0]).collect();
    assert_eq!(rows, [Some(0), None, Some(2)]);
}

#[test]
fn norms_by_hand() {
    let (a, b) = ([3.0, 4.0, 1.0], [3.0, 4.0, 0.0]);
    let norms = |from: usize, least: f64| {
        let (a, b) = (View::from(&a[from..]), View::from(&b[from..]));
        (
            (1e15 * relative_l2(&a, &b, least)).round() * 1e-15,
            relative_linf(&a, &b, least),
        )
    };
    assert_eq!(norms(0, 0.5), (0.2, 0.25));
    assert_eq!(norms(2, 0.5), (2.0, 2.0), "of the least value");
    let short = View::from(&a[..2]);
    assert!(relative_l2(&short, &View::from(&b[..]), 0.0).is_nan());
    assert!(relative_linf(&short, &View::from(&b[..]), 0.0).is_nan());
    assert_eq!(
        (range(&a), range(&[]), mean(&[]), mean(&a)),
        (3.0, 0.0, 0.0, 8.0 / 3.0)
    );
}
