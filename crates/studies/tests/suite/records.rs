//! One native run as written by many programs: each file is read correctly and judged by its limit.

use pinwheel_compare::{Against, Verdict};
use pinwheel_engines::{Engine, by_name};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Override, Scene};
use pinwheel_studies::comparison::{self, Input, Outcome, foreign};
use pinwheel_studies::{Control, StudyError};
use pinwheel_timeseries::TimeSeries;

/// Limit above the interpolation error at 8 samples per vibration (measured: 1.3 %, for the record aligned between samples).
const LIMIT: f64 = 0.03;

fn gearbox(duration_s: &str, sample_s: &str) -> Gearbox {
    let sets = [
        ("solver.duration_s", duration_s),
        ("solver.step_s", "1e-5"),
        ("solver.sample_s", sample_s),
    ];
    let sets: Vec<Override> = sets.map(|(key, value)| Override::new(key, value)).to_vec();
    Gearbox::new(&Scene::load("paper", &sets).unwrap()).unwrap()
}

fn engine(gearbox: &Gearbox) -> Box<dyn Engine> {
    by_name("native-reduced", &gearbox.scene).unwrap()
}

/// Name of a record, its map, the quantity of its limit, and its file.
type Record = (&'static str, &'static str, &'static str, Vec<u8>);

const TORQUE: &str = "input_torque_n_m";
const ANGLE: &str = "output_angle_rad";
const FORCE: &str = "external_sleeve_force_n";

/// Returns records from samples every 5 us, of which number 20 k is the run's k; torques and angles are `gain` times too large.
#[allow(clippy::too_many_lines, reason = "a table")]
fn records(fine: &TimeSeries, gain: f64) -> Vec<Record> {
    let column = |name: &str| {
        fine.channel(name)
            .unwrap()
            .iter()
            .map(|v| gain * v)
            .collect()
    };
    let [torque, angle]: [Vec<f64>; 2] = [TORQUE, ANGLE].map(column);
    let forces: Vec<Vec<f64>> = (0..3).map(|k| column(&format!("{FORCE}_{k}"))).collect();
    let (torque, angle) = (|k: usize| torque[k], |k: usize| angle[k]);
    let time = |k: usize| 5e-6 * k as f64;
    let all = || (0..fine.len()).step_by(20);
    let text =
        |header: &str, rows: &mut dyn Iterator<Item = usize>, row: &dyn Fn(usize) -> String| {
            let rows: Vec<String> = rows.map(row).collect();
            format!("{header}\n{}\n", rows.join("\n")).into_bytes()
        };
    let plain = |rows: &mut dyn Iterator<Item = usize>, shift: f64| {
        text("time_s,T", rows, &|k| {
            format!("{:.9},{}", time(k) - shift, torque(k))
        })
    };
    let factor = |factor: f64| {
        text("time_s,T", &mut all(), &|k| {
            format!("{},{}", time(k), torque(k) / factor)
        })
    };
    let comma = |x: f64| x.to_string().replace('.', ",");
    let wide = |bytes: fn(u16) -> [u8; 2], text: &[u8]| -> Vec<u8> {
        let text = String::from_utf8_lossy(text).replace('\n', "\r\n");
        format!("\u{feff}{text}")
            .encode_utf16()
            .flat_map(bytes)
            .collect()
    };
    // Adaptive steps: long, bursts of short ones, growing.
    let burst = (0..fine.len()).filter(|k| k % 20 == 0 || (2000..2400).contains(k));
    let mut growing: Vec<usize> = vec![0];
    while let Some(&last) = growing.last().filter(|last| **last < 4000) {
        growing.push((last + [1, 2, 4, 8, 12, 16, 20, 20, 20][growing.len() % 9]).min(4000));
    }
    let named = "[columns]\ninput_torque_n_m = \"T\"\n";
    vec![
        ("plain", named, TORQUE, plain(&mut all(), 0.0)),
        ("burst", named, TORQUE, plain(&mut burst.clone(), 0.0)),
        (
            "growing",
            named,
            TORQUE,
            plain(&mut growing.into_iter(), 0.0),
        ),
        ("dense", named, TORQUE, plain(&mut (0..fine.len()), 0.0)),
        ("part", named, TORQUE, plain(&mut all().skip(150), 0.0)),
        (
            "clock",
            "[time]\noffset_s = 12.5\n[columns]\ninput_torque_n_m = \"T\"\n",
            TORQUE,
            plain(&mut all(), 12.5),
        ),
        (
            "align",
            "[time]\noffset_s = \"align\"\n[columns]\ninput_torque_n_m = \"T\"\n",
            TORQUE,
            plain(&mut (870..3000).step_by(20), 77.7),
        ),
        (
            "german",
            "[file]\nseparator = \";\"\ndecimal = \",\"\nlines_after_header = 1\n[time]\ncolumn = \"t\"\nunit = \"ms\"\n\
             [columns]\ninput_torque_n_m = { column = \"M\", unit = \"N mm\", factor = -1.0 }\n",
            TORQUE,
            text("t;M\nms;N mm", &mut all(), &|k| {
                format!("{};{}", comma(1e3 * time(k)), comma(-1e3 * torque(k)))
            }),
        ),
        (
            "thousands",
            "[file]\nseparator = \";\"\ndecimal = \",\"\nthousands = \".\"\n[time]\ncolumn = \"t\"\nunit = \"us\"\n[columns]\ninput_torque_n_m = \"M\"\n",
            TORQUE,
            text("t;M", &mut all(), &|k| match 5 * k {
                us @ 0..1000 => format!("{us};{}", comma(torque(k))),
                us => format!("{}.{:03},0;{}", us / 1000, us % 1000, comma(torque(k))),
            }),
        ),
        (
            "utf16",
            named,
            TORQUE,
            wide(u16::to_le_bytes, &plain(&mut all(), 0.0)),
        ),
        (
            "utf16-be",
            named,
            TORQUE,
            wide(u16::to_be_bytes, &plain(&mut all(), 0.0)),
        ),
        (
            "degrees",
            "[columns]\noutput_angle_rad = { column = \"A\", unit = \"deg\", unwrap = true }\n",
            ANGLE,
            text("time_s,A", &mut all(), &|k| {
                format!("{},{}", time(k), angle(k).to_degrees().rem_euclid(360.0))
            }),
        ),
        (
            "counts",
            "[columns]\noutput_angle_rad = { column = \"A\", factor = 1e-5, unwrap = 1000 }\n",
            ANGLE,
            text("time_s,A", &mut all(), &|k| {
                format!("{},{}", time(k), (1e5 * angle(k)).rem_euclid(1000.0))
            }),
        ),
        (
            "kgf-cm",
            "[columns]\ninput_torque_n_m = { column = \"T\", unit = \"kgf*cm\" }\n",
            TORQUE,
            factor(0.0980665),
        ),
        (
            "lb-ft",
            "[columns]\ninput_torque_n_m = { column = \"T\", unit = \"lb-ft\" }\n",
            TORQUE,
            factor(1.3558179483),
        ),
        (
            "ozf-in",
            "[columns]\ninput_torque_n_m = { column = \"T\", unit = \"ozf*in\" }\n",
            TORQUE,
            factor(0.00706155181),
        ),
        (
            "events",
            named,
            TORQUE,
            text("time_s,T", &mut all(), &|k| {
                format!(
                    "{0},{1}\n{0},{2}",
                    time(k),
                    torque(k.saturating_sub(20)),
                    torque(k)
                )
            }),
        ),
        (
            "fortran",
            "[file]\nseparator = \"space\"\n[columns]\ninput_torque_n_m = \"T\"\n",
            TORQUE,
            text("  time_s   T", &mut all(), &|k| {
                format!("  {:e}  {:e}", time(k), torque(k)).replace('e', "D")
            }),
        ),
        (
            "date",
            "[time]\noffset_s = -36000\n[columns]\ninput_torque_n_m = \"T\"\n",
            TORQUE,
            text("time_s,T", &mut all(), &|k| {
                format!("2024-03-05 10:00:{:09.6},{}", time(k), torque(k))
            }),
        ),
        (
            "falling-angle",
            "[time]\ncolumn = \"phi\"\nfactor = -0.019105846388995\n[columns]\ninput_torque_n_m = \"T\"\n",
            TORQUE,
            text("phi,T", &mut all(), &|k| {
                format!("{},{}", -52.34 * time(k), torque(k))
            }),
        ),
        (
            "difference",
            "[columns]\noutput_angle_rad = { sum_of = { OUT = 1.0, IN = -0.0625 } }\n",
            ANGLE,
            text("time_s,IN,OUT", &mut all(), &|k| {
                format!(
                    "{},{},{}",
                    time(k),
                    50.0 * time(k),
                    angle(k) + 3.125 * time(k)
                )
            }),
        ),
        (
            "components",
            "[columns]\n\"external_sleeve_force_n_*\" = { magnitude_of = [\"X*\", \"Y*\"], unit = \"kN\", first = 1 }\n",
            FORCE,
            text("time_s,X1,Y1,X2,Y2,X3,Y3", &mut all(), &|k| {
                let each = forces
                    .iter()
                    .map(|force| format!(",{},{}", -6e-4 * force[k], 8e-4 * force[k]));
                format!("{}{}", time(k), each.collect::<String>())
            }),
        ),
        (
            "by-number",
            "[columns]\ninput_torque_n_m = 3\n",
            TORQUE,
            text("time_s,Torque,Torque", &mut all(), &|k| {
                format!("{},22,{}", time(k), torque(k))
            }),
        ),
        (
            "n-m",
            "[columns]\ninput_torque_n_m = { column = \"T\", unit = \"N-m\" }\n",
            TORQUE,
            factor(1.0),
        ),
        (
            "kilo",
            "[columns]\ninput_torque_n_m = { column = \"T\", unit = \"kNm\" }\n",
            TORQUE,
            factor(1e3),
        ),
        (
            "lbf-in",
            "[columns]\ninput_torque_n_m = { column = \"T\", unit = \"lbf*in\" }\n",
            TORQUE,
            factor(0.1129848290),
        ),
        (
            "tab",
            "[file]\nseparator = \"tab\"\n[columns]\ninput_torque_n_m = \"T\"\n",
            TORQUE,
            text("time_s\tT", &mut all(), &|k| {
                format!("{}\t{}", time(k), torque(k))
            }),
        ),
        (
            "pipe",
            "[file]\nseparator = \"|\"\n[columns]\ninput_torque_n_m = \"T\"\n",
            TORQUE,
            text("time_s|T", &mut all(), &|k| {
                format!("{}|{}", time(k), torque(k))
            }),
        ),
        (
            "minutes",
            "[time]\nunit = \"min\"\n[columns]\ninput_torque_n_m = \"T\"\n",
            TORQUE,
            text("time_s,T", &mut all(), &|k| {
                format!("{},{}", time(k) / 60.0, torque(k))
            }),
        ),
        (
            "comments",
            "[file]\ncomment = \"#\"\n[columns]\ninput_torque_n_m = \"T\"\n",
            TORQUE,
            text("# rig 7\ntime_s,T", &mut all(), &|k| {
                format!("{},{}", time(k), torque(k))
            }),
        ),
        (
            "no-header",
            "[file]\nheader = false\nskip_lines = 1\n[time]\ncolumn = 2\n[columns]\ninput_torque_n_m = 1\n",
            TORQUE,
            text("rig 7", &mut all(), &|k| {
                format!("{},{}", torque(k), time(k))
            }),
        ),
        (
            "noise",
            "[rows]\nbad = \"skip\"\n[columns]\ninput_torque_n_m = \"T\"\n",
            TORQUE,
            text("time_s,T", &mut all(), &|k| match k / 20 {
                30 | 90 => format!("{},overflow", time(k)),
                _ => format!("{},{}", time(k), torque(k) + 0.01 * (7.0 * k as f64).sin()),
            }),
        ),
    ]
}

/// Compares each record, with a limit on its quantity, with these engines.
fn compare(
    gearbox: &Gearbox,
    records: &[Record],
    window: &str,
    engines: &[Box<dyn Engine>],
) -> Result<Outcome, StudyError> {
    let dir = tempfile::tempdir().unwrap();
    let files = records.iter().map(|(name, map, quantity, text)| {
        let [file, of_map] = ["csv", "toml"].map(|end| dir.path().join(format!("{name}.{end}")));
        let map = format!(
            "name = \"{name}\"\n{map}[[limits]]\nquantity = \"{quantity}\"\nwindow = \"{window}\"\nmetric = \"relative-l2\"\nlimit = {LIMIT}\n"
        );
        std::fs::write(&of_map, map).unwrap();
        std::fs::write(&file, text).unwrap();
        (file, of_map)
    });
    let (files, maps): (Vec<_>, Vec<_>) = files.unzip();
    let data = foreign::open_all(&files, &maps)?;
    let gearbox = foreign::with_channels(&data, gearbox.clone())?;
    let input = Input {
        gearbox: &gearbox,
        engines,
        data: &data,
    };
    comparison::run(&input, &Control::quiet())
}

#[test]
fn regress_right_records_are_shown_and_wrong_ones_differ() {
    let fine = gearbox("0.02", "5e-6");
    let run = engine(&fine)
        .run_compiled(&fine, &Control::quiet())
        .unwrap();
    let gearbox = gearbox("0.02", "1e-4");
    for (gain, status, wanted) in [(1.0, 0, Verdict::Agree), (1.19, 1, Verdict::Differ)] {
        let records = records(&run.time_series, gain);
        let outcome = compare(&gearbox, &records, "transient", &[engine(&gearbox)]).unwrap();
        assert_eq!(outcome.exit_status(), status, "{gain}");
        for (name, _, quantity, _) in &records {
            let pairs = outcome.comparison.pairs.iter();
            let mut pair = pairs.filter(|p| p.a == "native-reduced" && p.b == *name);
            let mut entries = pair.next().unwrap().entries.iter();
            let entry = entries.find(|e| e.quantity == *quantity).unwrap();
            let result = &entry.result;
            assert_eq!(
                (result.verdict, result.against),
                (wanted, Against::Limit),
                "{name}: {result:?}"
            );
            let of_name = outcome
                .participants
                .iter()
                .find(|p| p.name == *name)
                .unwrap();
            let notes = of_name.cost.notes.join(" ");
            assert!(
                !notes.contains("shifted") && !notes.contains("gaps"),
                "{name}: {notes}"
            );
        }
        // A record of a part of the run is compared with that part only.
        let most = outcome.largest().unwrap().share();
        assert!(
            (gain - 1.0 - LIMIT..gain - 1.0 + LIMIT).contains(&most),
            "{gain}: {most}"
        );
    }
}

/// Limits that can never be judged are refused before any engine runs.
#[test]
fn bad_input_limits_that_are_never_judged_are_refused() {
    let gearbox = gearbox("0.06", "1e-4");
    let rows = |from: f64, step: f64| {
        let rows = (0..50).map(|k| format!("{:e},{k}\n", from + step * f64::from(k)));
        format!("time_s,T\n{}", rows.collect::<String>()).into_bytes()
    };
    let named = "[columns]\ninput_torque_n_m = \"T\"\n";
    let tiny = "[time]\nfactor = 1e-300\n[columns]\ninput_torque_n_m = \"T\"\n";
    let align = "[time]\noffset_s = \"align\"\n[columns]\ninput_torque_n_m = \"T\"\n";
    for (map, quantity, window, text, part) in [
        (
            named,
            "output_*",
            "transient",
            rows(0.0, 1e-4),
            "`output_*` fits no mapped column, so it can never be judged; write one of input_torque_n_m",
        ),
        (
            named,
            TORQUE,
            "steady",
            rows(0.0, 1e-4),
            "can never be judged in the steady window, which the run does not have (the run lasts 0.06 s;",
        ),
        (
            named,
            TORQUE,
            "transient",
            rows(0.055, 1e-4),
            "s, of which the file has nothing: it covers 0.055 to 0.0599 s",
        ),
        (
            named,
            TORQUE,
            "stead",
            rows(0.0, 1e-4),
            "`stead` is no window; did you mean `steady`?",
        ),
        (
            tiny,
            TORQUE,
            "transient",
            rows(0.0, 1e-4),
            "all rows of the file lie within",
        ),
        (
            named,
            TORQUE,
            "transient",
            rows(0.0, 0.5),
            "the file has 1 rows in the run's 0 to 0.06 s",
        ),
        (
            align,
            TORQUE,
            "transient",
            rows(0.0, 1e-4),
            "nothing to align by: no engine finished; give offset_s in seconds",
        ),
    ] {
        let error = compare(&gearbox, &[("x", map, quantity, text)], window, &[]).unwrap_err();
        let line = error.to_string();
        assert!(matches!(error, StudyError::Input(_)), "{line}");
        assert!(
            line.contains(part) && !line.contains('\n'),
            "{part}: {line}"
        );
    }
}
