//! Time series as CSV.

use pinwheel_timeseries::{TimeSeries, TimeSeriesError};

#[test]
fn round_trip_is_exact() {
    let mut time_series = TimeSeries::new(vec![0.0, 1e-4, 0.1 + 0.2]).unwrap();
    time_series
        .push("a_n", vec![1.0 / 3.0, -1e-300, f64::MAX])
        .unwrap();
    let mut bytes = Vec::new();
    time_series.write_csv(&mut bytes).unwrap();
    assert_eq!(TimeSeries::read_csv(bytes.as_slice()).unwrap(), time_series);
}

/// A leading index column of other programs has no name, so it cannot be used.
#[test]
fn columns_without_a_name_are_left_out() {
    let read = TimeSeries::read_csv(",time_s,a_n\nx,0,1\ny,1,2\n".as_bytes()).unwrap();
    let mut bytes = Vec::new();
    read.write_csv(&mut bytes).unwrap();
    assert_eq!(read.channels().len(), 1);
    assert_eq!(TimeSeries::read_csv(bytes.as_slice()).unwrap(), read);
}

#[test]
fn bad_cell_is_named() {
    let error = TimeSeries::read_csv("time_s,a_n\n0,1\n1,x\n".as_bytes()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "row 2, column `a_n`: `x` is not a number"
    );
    assert!(matches!(
        TimeSeries::read_csv("t,a\n0,1\n".as_bytes()),
        Err(TimeSeriesError::NoTime)
    ));
}
