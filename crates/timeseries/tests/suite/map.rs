//! Maps of foreign files.

use pinwheel_timeseries::foreign::*;

fn fault(text: &str) -> String {
    Map::from_toml(text, "m.toml").unwrap_err().to_string()
}

#[test]
fn a_short_map_is_enough() {
    let map = Map::from_toml(
        "[columns]\ninput_torque_n_m = \"T\"\noutput_angle_rad = 3\n",
        "m.toml",
    )
    .unwrap();
    assert_eq!(map.columns.len(), 2);
    assert_eq!(
        (map.file.separator.as_str(), map.rows.bad),
        (",", BadRows::Refuse)
    );
    assert_eq!(
        map.columns["output_angle_rad"].full().column,
        Some(ColumnRef::Number(3))
    );
}

#[test]
fn faults_have_a_remedy() {
    for (text, part) in [
        ("", "names nothing"),
        ("[columns]\na_n = 1\nx = [", "line 3"),
        ("colums = 1", "did you mean `columns`?"),
        (
            "[columns]\na_n = { column = \"F\", unit = \"mm\" }",
            "write one of N, newton",
        ),
        (
            "[columns]\na_n = { unit = \"N\" }",
            "one of `column`, `magnitude_of` and `sum_of`",
        ),
        (
            "[columns]\na_n = { column = \"F\", sum_of = { A = 1.0 } }",
            "one of `column`, `magnitude_of` and `sum_of`",
        ),
        (
            "[columns]\na_n = { column = \"F\", unwrap = true }",
            "is no angle",
        ),
        (
            "[columns]\na_rad = { column = \"F\", unwrap = -360 }",
            "is no angle",
        ),
        (
            "[columns]\na_rad = { column = \"F\", unwrap = \"yes\" }",
            "a column is",
        ),
        (
            "[columns]\na_n = \"F\"\n[time]\nunit = \"deg\"",
            "is an angle's; leave it out, and write factor = ",
        ),
        ("[columns]\na_n = \"F\"\n[time]\nfactor = 0.0", "not 0"),
        (
            "[columns]\na_n = \"F\"\n[file]\nthousands = \",\"",
            "neither the decimal mark nor the separator",
        ),
        ("[columns]\na_n = { column = \"F\", factor = 0.0 }", "not 0"),
        ("[columns]\n\"a_n_*\" = \"F\"", "both hold one `*`"),
        (
            "[columns]\na_n = \"F\"\n[time]\nunit = \"N\"",
            "no unit of time",
        ),
        (
            "[columns]\na_n = \"F\"\n[file]\ndecimal = \",\"",
            "set file.separator too",
        ),
        (
            "[columns]\na_n = \"F\"\n[file]\nseparator = \"x\"",
            "\"tab\"",
        ),
        (
            "name = \"Index.html\"\n[columns]\na_n = \"F\"",
            "of the report",
        ),
        (
            "[columns]\na_n = \"F\"\n[file]\nskip_lines = 9000000000000000000",
            "more than 1000000",
        ),
        (
            "[columns]\n\"a_*\" = { column = \"F*\", first = 9000000000000000000 }",
            "`first`",
        ),
        ("name = \"../x\"\n[columns]\na_n = \"F\"", "letters, digits"),
        (
            "[columns]\na_n = \"F\"\n[[limits]]\nquantity = \"*\"\nwindow = \"steady\"\nmetric = \"mean\"\nlimit = 0.0",
            "above 0",
        ),
    ] {
        let line = fault(text);
        assert!(
            line.contains(part) && !line.contains('\n'),
            "{text}: {line}"
        );
    }
}
