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

/// Words of any kind are written as the crate `csv` writes them.
#[test]
fn words_are_quoted_where_they_must_be() {
    for words in [
        "",
        "a b",
        "a,b",
        "say \"a\"",
        "\"",
        "two\nlines",
        "\r",
        "#1",
        "'",
        " a ",
    ] {
        for columns in 1..3 {
            let head = Table::of("", [words]).text(words, "", |x| *x);
            let table = match columns {
                1 => Table::of("", [words]).text("a", "", |x| *x).done(),
                _ => head.text("b", "", |x| *x).done(),
            };
            let (mut own, mut theirs) = (Vec::new(), csv::Writer::from_writer(Vec::new()));
            table.write_csv(&mut own).unwrap();
            let named: Vec<_> = table
                .columns
                .iter()
                .filter(|one| !one.name.is_empty())
                .collect();
            theirs
                .write_record(named.iter().map(|one| &one.name))
                .unwrap();
            theirs.write_record(named.iter().map(|_| words)).unwrap();
            let theirs = theirs.into_inner().unwrap();
            assert_eq!(own, theirs, "{}", String::from_utf8_lossy(&own));
        }
    }
}
