//! Reading of other programs' files by a map.

use pinwheel_timeseries::foreign::*;

const ROWS: usize = 40;

/// Returns a header and rows, one each 0.1 ms.
fn rows(header: &str, row: impl Fn(usize) -> String) -> String {
    let rows: Vec<String> = (0..ROWS).map(row).collect();
    format!("{header}\n{}\n", rows.join("\n"))
}

fn time(k: usize) -> String {
    format!("{:.4}", 1e-4 * k as f64)
}

fn convert(map: &str, text: impl AsRef<[u8]>) -> Result<Foreign, String> {
    let map = Map::from_toml(map, "m.toml").unwrap();
    read(text.as_ref(), &map).map_err(|error| error.to_string())
}

const TORQUE: &str = "[columns]\ninput_torque_n_m = \"T\"\n";
const ANGLE: &str =
    "[columns]\noutput_angle_rad = { column = \"A\", unit = \"deg\", unwrap = true }\n";

/// Each text has the value k/8 in row k, at k/10000 s.
#[test]
fn regress_writers_of_all_kinds_are_read() {
    let value = |k: usize| k as f64 / 8.0;
    let comma = |x: f64| format!("{x:.3}").replace('.', ",");
    let german = "[file]\nseparator = \";\"\ndecimal = \",\"\n";
    let plain = rows("time_s,T", |k| format!("{},{}", time(k), value(k)));
    let wide = |little: bool, text: &str| -> Vec<u8> {
        let bytes = |unit: u16| {
            if little {
                unit.to_le_bytes()
            } else {
                unit.to_be_bytes()
            }
        };
        text.encode_utf16().flat_map(bytes).collect()
    };
    let marked = format!("\u{feff}{plain}");
    let texts: Vec<(String, Vec<u8>)> = vec![
        (TORQUE.to_owned(), plain.clone().into_bytes()),
        (TORQUE.to_owned(), marked.clone().into_bytes()),
        (TORQUE.to_owned(), wide(true, &marked)),
        (TORQUE.to_owned(), wide(false, &marked)),
        (TORQUE.to_owned(), wide(true, &plain.replace('\n', "\r\n"))),
        (
            format!("{german}{TORQUE}"),
            rows("time_s;T", |k| format!("{};{}", time(k).replace('.', ","), comma(value(k)))).into_bytes(),
        ),
        // Fortran.
        (
            format!("[file]\nseparator = \"space\"\n{TORQUE}"),
            rows(" time_s  T", |k| format!(" {k}.0D-04  {}d-3", 125 * k)).into_bytes(),
        ),
        (
            format!("[time]\ncolumn = \"when\"\noffset_s = -36000\n{TORQUE}"),
            rows("when,T", |k| format!("2024-03-05 10:00:00.{k:04},{}", value(k))).into_bytes(),
        ),
        (
            format!("[time]\ncolumn = \"when\"\noffset_s = -86399.998\n{TORQUE}"),
            rows("when,T", |k| match k {
                0..20 => format!("05.03.2024 23:59:59.{:04},{}", 9980 + k, value(k)),
                _ => format!("06.03.2024 00:00:00.{:04},{}", k - 20, value(k)),
            })
            .into_bytes(),
        ),
        (
            format!("[time]\ncolumn = \"when\"\n{TORQUE}"),
            rows("when,T", |k| format!("0:00:00.{k:04}Z,{}", value(k))).into_bytes(),
        ),
        // Thousands of millimetres.
        (
            "[file]\nseparator = \";\"\nthousands = \",\"\n[columns]\ninput_torque_n_m = { column = \"T\", unit = \"N mm\" }".to_owned(),
            rows("time_s;T", |k| {
                let [integer, part] = [125 * k / 1000, 125 * k % 1000];
                format!("{};{integer},{part:03}.0", time(k))
            }).into_bytes(),
        ),
        (
            format!("{german}thousands = \".\"\n[time]\nunit = \"us\"\n{TORQUE}"),
            rows("time_s;T", |k| match k {
                0..10 => format!("{}00;{}", k, comma(value(k))),
                _ => format!("{}.{}00;{}", k / 10, k % 10, comma(value(k))),
            }).into_bytes(),
        ),
        // A falling angle, a sum, and one name for two columns, chosen by number.
        (
            format!("[time]\ncolumn = \"phi\"\nfactor = -1e-3\n{TORQUE}"),
            rows("phi,T", |k| format!("{},{}", -0.1 * k as f64, value(k))).into_bytes(),
        ),
        (
            "[columns]\ninput_torque_n_m = { sum_of = { A = 1.0, B = -0.5 } }".to_owned(),
            rows("time_s,A,B", |k| format!("{},{},{k}", time(k), value(k) + 0.5 * k as f64)).into_bytes(),
        ),
        (
            "[columns]\ninput_torque_n_m = 3".to_owned(),
            rows("time_s,T,T,", |k| format!("{},7,{},", time(k), value(k))).into_bytes(),
        ),
    ];
    for (map, text) in texts {
        let series = convert(&map, &text).unwrap_or_else(|error| panic!("{map}: {error}"));
        let series = series.time_series;
        let values = series.channel("input_torque_n_m").unwrap();
        assert_eq!(values.len(), ROWS, "{map}");
        for (k, (t, v)) in series.time_s().iter().zip(values).enumerate() {
            assert!((t - 1e-4 * k as f64).abs() < 1e-10, "{map}: {t}");
            assert!((v - value(k)).abs() < 1e-9, "{map}: {v}");
        }
    }
}

#[test]
fn regress_angles_are_unwrapped() {
    let angle = |k: usize| 40.0 - 25.0 * k as f64;
    for (unit, turn) in [
        ("unit = \"deg\"", 360.0),
        ("factor = 0.0174532925199433", 360.0),
        ("unit = \"rev\"", 1.0),
    ] {
        let text = rows("time_s,A", |k| {
            format!("{},{}", time(k), (angle(k) / 360.0 * turn).rem_euclid(turn))
        });
        for unwrap in ["true".to_owned(), turn.to_string()] {
            let map = format!(
                "[columns]\noutput_angle_rad = {{ column = \"A\", {unit}, unwrap = {unwrap} }}"
            );
            let series = convert(&map, &text).unwrap().time_series;
            for (k, value) in series.channels()[0].values.iter().enumerate() {
                assert!(
                    (value.to_degrees() - angle(k)).abs() < 1e-6,
                    "{map} {k}: {value}"
                );
            }
        }
        let map = format!("[columns]\noutput_angle_rad = {{ column = \"A\", {unit} }}");
        let error = convert(&map, &text).unwrap_err();
        assert!(
            error.contains("line 4: column `A` goes from 0.0") || error.contains("line 4"),
            "{error}"
        );
        assert!(
            error.ends_with("write unwrap = true for `output_angle_rad` in the map"),
            "{error}"
        );
    }
    // Angles between -180 and 180 with a ratio, each unwrapped before the sum.
    let half = |x: f64| (x + 180.0).rem_euclid(360.0) - 180.0;
    let text = rows("time_s,A,B", |k| {
        format!(
            "{},{},{}",
            time(k),
            half(-8.0 * k as f64),
            half(120.0 * k as f64)
        )
    });
    let map = "[columns]\ntransmission_error_arcmin = { sum_of = { A = 1.0, B = 0.0666666666666667 }, unit = \"deg\", unwrap = true }";
    let series = convert(map, &text).unwrap().time_series;
    assert!(series.channels()[0].values.iter().all(|v| v.abs() < 1e-6));
    // A slow record of a fast shaft also jumps, always in one direction.
    let fast = rows("time_s,A", |k| format!("{},{}", time(k), 400 * k));
    assert!(convert(&ANGLE.replace(", unwrap = true", ""), fast).is_ok());
}

/// Rows before and after an event, at one time or 1e-12 s apart.
#[test]
fn regress_an_instant_written_twice_has_the_value_after() {
    for apart in [0.0, 1e-12] {
        let text = rows("time_s,T", |k| {
            let t = 1e-4 * (k / 2) as f64 + apart * (k % 2) as f64;
            format!("{t:e},{}", k % 2)
        });
        for (rows, value) in [
            ("", 1.0),
            ("[rows]\ntwice = \"last\"\n", 1.0),
            ("[rows]\ntwice = \"first\"\n", 0.0),
        ] {
            let read = convert(&format!("{TORQUE}{rows}"), &text).unwrap();
            assert_eq!(read.twice, Some((ROWS / 2, 0.0)));
            assert_eq!((read.time_series.len(), read.bad.len()), (ROWS / 2, 0));
            assert!(
                read.time_series.channels()[0]
                    .values
                    .iter()
                    .all(|v| *v == value)
            );
        }
        let error = convert(&format!("{TORQUE}[rows]\ntwice = \"refuse\""), &text).unwrap_err();
        assert!(
            error.contains("20 instants are written more than once, the first 0 s"),
            "{error}"
        );
    }
}

#[test]
fn bad_input_is_refused_by_what_it_is() {
    let forces = |columns: &[usize]| {
        let names: Vec<String> = columns.iter().map(|k| format!("F_{k}")).collect();
        rows(&format!("time_s,{}", names.join(",")), |k| {
            format!("{}{}", time(k), ",3".repeat(columns.len()))
        })
    };
    let pattern = |first: usize| {
        format!(
            "[columns]\n\"external_sleeve_force_n_*\" = {{ column = \"F_*\", first = {first} }}"
        )
    };
    let german = format!("[file]\nseparator = \";\"\ndecimal = \",\"\n{TORQUE}");
    let semicolons = format!("[file]\nseparator = \";\"\n{TORQUE}");
    let blanks = format!("[file]\nseparator = \"space\"\n{TORQUE}");
    let force = "[columns]\nexternal_sleeve_force_n_0 = \"T\"".to_owned();
    let of = |header: &str, value: &str| rows(header, |k| format!("{}{value}", time(k)));
    for (map, text, part) in [
        (
            TORQUE.to_owned(),
            of("time_s,T,T", ",1,2"),
            "the columns 2 and 3 are both called `T`; write the number",
        ),
        (pattern(1), forces(&[1, 2, 4]), "no column `F_3`, but `F_4`"),
        (
            pattern(1),
            forces(&[0, 1, 2]),
            "no column `F_3`, but `F_0`; set `first`",
        ),
        (
            TORQUE.to_owned(),
            of("time_s,T", ",1,5"),
            "line 2: 3 cells, but the header has 2",
        ),
        (
            blanks,
            of("% time_s T", " 1"),
            "line 2: 2 cells, but the header has 3",
        ),
        (
            german.clone(),
            rows("time_s;T", |k| format!("0,{k:03};1.234")),
            "thousands = \".\" or decimal = \".\"",
        ),
        (
            semicolons,
            of("time_s;T", ";1,234"),
            "decimal = \",\" or thousands = \",\"",
        ),
        (
            german.replace("decimal = \",\"", "decimal = \",\"\nthousands = \".\""),
            rows("time_s;T", |k| format!("0,{k:03};1.2345,6")),
            "has marks of thousands elsewhere",
        ),
        (
            force.clone(),
            rows("time_s,T", |k| format!("{},{}", time(k), [-5, 9][k % 2])),
            "`external_sleeve_force_n_0` goes down to -5 N, but is the magnitude",
        ),
        (
            TORQUE.to_owned(),
            rows("time_s,T", |k| format!("{},1", time(ROWS - k))),
            "time falls in 39 of 40 rows; sort them",
        ),
        (
            TORQUE.to_owned(),
            rows("time_s,T", |k| format!("10:00:00.{k:03} PM,1")),
            "no clock time as it is read",
        ),
        (
            format!("[time]\nunit = \"ms\"\n{TORQUE}"),
            rows("time_s,T", |k| format!("10:00:00.{k:03},1")),
            "a clock time: leave time.unit out",
        ),
    ] {
        let error = convert(&map, &text).unwrap_err();
        assert!(
            error.contains(part) && !error.contains('\n'),
            "{part}: {error}"
        );
    }
    // Noise of a load cell about zero is no negative force.
    let noise = rows("time_s,T", |k| {
        format!("{},{}", time(k), [-0.1, 9.0][k % 2])
    });
    assert!(convert(&force, noise).is_ok());
}
