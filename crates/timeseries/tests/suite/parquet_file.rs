//! Tables and series as Parquet.

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use pinwheel_timeseries::table::{Table, Values};
use pinwheel_timeseries::{ParquetFault, TimeSeries, read_time_series, save_time_series};

#[test]
fn round_trip_is_exact() {
    let mut time_series = TimeSeries::new(vec![0.0, 1e-4, 0.1 + 0.2]).unwrap();
    time_series
        .push("a_n", vec![1.0 / 3.0, -1e-300, f64::MAX])
        .unwrap();
    time_series.push("gear.b_m", vec![1.0, 1.0, -0.0]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("courses.parquet");
    save_time_series(&time_series, &path).unwrap();
    let load = |most| read_time_series(std::fs::File::open(&path).unwrap(), most);
    assert_eq!(load(usize::MAX).unwrap(), time_series);
    let short = load(2);
    assert!(matches!(
        short,
        Err(ParquetFault::Long { rows: 3, most: 2 })
    ));
    std::fs::write(&path, "time_s\n0\n").unwrap();
    assert!(matches!(load(usize::MAX), Err(ParquetFault::Parquet(_))));
}

#[test]
fn cells_may_be_empty() {
    let table = Table::of(
        "",
        [(Some(0.1), None, "\u{e9}, \"x\""), (None, Some(-3), "")],
    )
    .number("n", "", |row| row.0)
    .integers("k", "", |row| row.1)
    .text("t", "", |row| row.2)
    .done();
    let mut bytes = Vec::new();
    table.write_parquet(&mut bytes).unwrap();
    let reader = SerializedFileReader::new(bytes::Bytes::from(bytes)).unwrap();
    let rows: Vec<String> = reader
        .get_row_iter(None)
        .unwrap()
        .map(|row| row.unwrap().to_string())
        .collect();
    assert_eq!(
        rows,
        [
            "{n: 0.1, k: null, t: \"\u{e9}, \"x\"\"}",
            "{n: null, k: -3, t: null}"
        ]
    );
    let mut uneven = table;
    uneven.columns[1].values = Values::Integers(vec![None]);
    assert!(uneven.write_parquet(Vec::new()).is_err());
}
