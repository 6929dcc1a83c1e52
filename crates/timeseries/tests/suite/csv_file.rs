//! Time series as CSV.

use pinwheel_timeseries::table::Table;
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

/// Digits of numbers of usual size, computed in integers alone, are those of `zmij`: any bits, sums of few powers of two, whose
/// digits end early or lie in the middle of two, the neighbours of these, and short decimals.
#[test]
fn digits_are_the_shortest() {
    let mut seed = 1_u64;
    let mut values = Vec::new();
    for k in 0..20_000 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(k);
        let exponent = 1075 - (20 + (seed >> 33) % 50);
        let any = (exponent << 52) | (seed >> 12);
        let few = any & !((1 << (seed >> 58).min(51)) - 1);
        values.extend([any, few - 1, few, few + 1].map(f64::from_bits));
        let short = (seed >> 40) as f64;
        values.extend([1.0, 16.0, -1e3, 1e4, 1e5, 1e6, 1e8].map(|by| short / by));
    }
    let table = Table::of("", values).number("x", "", |value| *value);
    let (table, mut text) = (table.done(), Vec::new());
    table.write_csv(&mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    let mut known = zmij::Buffer::new();
    for (row, own) in text.lines().skip(1).enumerate() {
        let known = known.format(table.number("x", row).unwrap());
        assert_eq!(own, known.strip_suffix(".0").unwrap_or(known));
    }
}
