//! Columns over time.

use pinwheel_timeseries::{TimeSeries, TimeSeriesError, group_of};

#[test]
fn window_takes_both_ends() {
    let time_series = TimeSeries::new((0..=10).map(|k| f64::from(k) * 0.1).collect()).unwrap();
    assert_eq!(time_series.window(0.3, 0.6), 3..7);
    assert_eq!(time_series.window(2.0, 3.0), 11..11);
    assert_eq!(time_series.window(0.3, f64::INFINITY), 3..11);
}

#[test]
fn faults_are_named() {
    assert!(matches!(
        TimeSeries::new(vec![0.0, 1.0, 1.0]),
        Err(TimeSeriesError::Time { row: 3, .. })
    ));
    assert!(TimeSeries::new(vec![0.0, f64::NAN]).is_err());
    let mut time_series = TimeSeries::new(vec![0.0, 1.0]).unwrap();
    assert!(time_series.push("a_n", vec![1.0]).is_err());
    time_series.push("a_n", vec![1.0, 2.0]).unwrap();
    assert!(matches!(
        time_series.push("a_n", vec![1.0, 2.0]),
        Err(TimeSeriesError::Duplicate(_))
    ));
}

#[test]
fn groups() {
    assert_eq!(
        group_of("external_sleeve_force_n_12"),
        ("external_sleeve_force_n", Some(12))
    );
    assert_eq!(group_of("input_torque_n_m"), ("input_torque_n_m", None));
    let mut time_series = TimeSeries::new(vec![0.0]).unwrap();
    time_series.push("f_n_0", vec![1.0]).unwrap();
    time_series.push("f_n_1", vec![2.0]).unwrap();
    assert_eq!(time_series.group("f_n"), vec![&[1.0][..], &[2.0][..]]);
}
