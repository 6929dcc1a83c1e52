//! Tables of studies.

use pinwheel_timeseries::table::Table;

#[test]
fn columns_without_a_name_are_in_no_file() {
    let table = Table::of("", [1.0, f64::NAN])
        .number("a_m", "", |x| *x)
        .text("", "words", |x| x.to_string())
        .integers("k", "", |x| (*x == 1.0).then_some(u64::MAX))
        .done();
    let mut csv = Vec::new();
    table.write_csv(&mut csv).unwrap();
    assert_eq!(csv, b"a_m,k\n1,\n,\n");
    assert_eq!(table.number("a_m", 0), Some(1.0));
    let second = table.clone().rows(|row| row == 1);
    assert_eq!((second.len(), second.number("a_m", 0)), (1, None));
    assert_eq!(table.only(&["k", "z"]).columns.len(), 1);
}
