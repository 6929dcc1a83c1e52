//! Refusals of every kind of fault with key, line and remedy, on one line.

use pinwheel_scene::{Location, Override, Scene, SceneError, preset};

fn overrides(texts: &[&str]) -> Vec<Override> {
    texts.iter().map(|text| text.parse().unwrap()).collect()
}

/// Returns the error of `paper` with these overrides.
fn refused(texts: &[&str]) -> String {
    let error = Scene::load("paper", &overrides(texts)).expect_err(&texts.join(" "));
    assert!(matches!(error, SceneError::Key { .. }), "{error:?}");
    followed(texts, &error);
    let line = error.to_string();
    assert!(!line.contains('\n'), "{line}");
    assert!(line.contains("; "), "no remedy: {line}");
    line
}

/// Returns the settings in a remedy, each a separate way: `key = value`, an intended value, a bound, another key.
fn ways(key: &str, remedy: &str) -> Vec<String> {
    let table = key.rsplit_once('.').map_or("", |(table, _)| table);
    let mut ways = Vec::new();
    let words: Vec<&str> = remedy.split_whitespace().collect();
    let bare = |word: &str| word.trim_matches([',', '?', ';', ':']).to_owned();
    for (k, word) in words.iter().enumerate() {
        let before = |n: usize| k.checked_sub(n).map_or("", |k| words[k]);
        let value = bare(word);
        let is_number = value.parse::<f64>().is_ok();
        if before(1) == "=" && (is_number || value.starts_with('"')) {
            let of = before(2);
            let dot = if of.contains('.') || table.is_empty() {
                ""
            } else {
                "."
            };
            let table = if dot.is_empty() { "" } else { table };
            ways.push(format!("{table}{dot}{of}={value}"));
        } else if is_number && ["give", "least", "most", "mean"].contains(&before(1)) {
            ways.push(format!("{key}={value}"));
        }
    }
    ways
}

/// Checks that the settings of a remedy pass the check that refused.
fn followed(texts: &[&str], error: &SceneError) {
    let SceneError::Key {
        key, what, remedy, ..
    } = error
    else {
        return;
    };
    for way in ways(key, remedy) {
        let all: Vec<&str> = texts.iter().copied().chain([way.as_str()]).collect();
        if let Err(SceneError::Key {
            key: again,
            what: still,
            ..
        }) = Scene::load("paper", &overrides(&all))
        {
            let is_other = again != *key || still.split(", ").last() != what.split(", ").last();
            assert!(is_other, "{error}\nfollowed by {way}: {again} {still}");
        }
    }
}

/// Returns the error of this text, read as `mine.toml`.
fn refused_text(text: &str) -> String {
    let line = Scene::from_toml(text, "mine.toml", &[])
        .expect_err(text)
        .to_string();
    assert!(!line.contains('\n') && line.contains("; "), "{line}");
    line
}

#[test]
fn overrides_are_taken_as_toml_or_bare_words() {
    let set = overrides(&[
        "gear.backlash_m=0.0006",
        "drive.input_speed_rad_s = 50",
        "solver.integrator=rk4",
        "contact.detection=\"points\"",
        "name=2024",
        "mass.wheel.mass_kg=0.7",
        "drive={ output_torque_n_m = 11 }",
        "gear.wheels=3",
        "gear.wheels=1",
    ]);
    let scene = Scene::load("paper", &set).unwrap();
    assert_eq!(scene.gear.backlash_m, 0.0006);
    assert_eq!(scene.drive.input_speed_rad_s, 50.0);
    assert_eq!(scene.drive.output_torque_n_m, 11.0);
    assert_eq!(scene.solver.integrator, "rk4");
    assert_eq!(scene.name, "2024");
    assert_eq!(scene.mass.wheel.mass_kg, 0.7);
    assert_eq!(scene.mass.wheel.moment_kg_m2, 1.57538e-4);
    assert_eq!(scene.gear.wheels, 1, "the last one counts");
}

#[test]
fn malformed_overrides() {
    for (text, part) in [
        ("gear.wheels", "no `=`"),
        ("=3", "no key"),
        ("gear.wheels=", "no value"),
    ] {
        let line = text.parse::<Override>().unwrap_err().to_string();
        assert!(
            line.contains(part) && line.contains("--set key=value"),
            "{line}"
        );
    }
    let error = Scene::load("paper", &[Override::new("gear..x", "1")]).unwrap_err();
    assert!(error.to_string().contains("no key"), "{error}");
}

#[test]
fn unknown_keys_suggest_the_nearest() {
    for (set, suggestion) in [
        ("gear.backlsh_m=0.1", "did you mean `gear.backlash_m`?"),
        ("backlash_m=0.1", "did you mean `gear.backlash_m`?"),
        (
            "drive.contact.law=\"paper\"",
            "`contact` is a table of its own: write it above [drive], or as [contact]",
        ),
        ("gaer.wheels=1", "did you mean `gear`?"),
        ("solver.young_pa=1", "did you mean `contact.young_pa`?"),
        ("mass.wheel.mass=1", "did you mean `mass.wheel.mass_kg`?"),
        ("gear.zzzz=1", "known here: "),
    ] {
        let line = refused(&[set]);
        assert!(line.starts_with(&format!("--set {set}: ")), "{line}");
        assert!(
            line.contains("is no key") && line.contains(suggestion),
            "{line}"
        );
    }
    let line = refused_text("name = \"x\"\n[gear]\n\nhole_radius = 0.0088\n");
    assert_eq!(
        line,
        "mine.toml, line 4: `gear.hole_radius` is no key of a scene; did you mean `gear.hole_radius_m`?"
    );
}

#[test]
fn wrong_types_name_line_and_kind() {
    for (text, line, part) in [
        ("[gear]\nwheels = \"two\"", 2, "the text \"two\""),
        ("[gear]\nwheels = 2.0", 2, "a whole number"),
        ("[gear]\nwheels = -2", 2, "a whole number"),
        ("[gear]\nhole_radius_m = \"8 mm\"", 2, "a number"),
        ("[gear]\nhole_radius_m = [1]", 2, "a list"),
        ("[gear]\nhole_radius_m = true", 2, "true"),
        ("[gear]\nhole_radius_m = 1979-05-27", 2, "a date"),
        ("\n[[gear]]\nwheels = 1", 2, "a list of tables"),
        ("gear = 3", 1, "must be a table"),
        ("[name]\n", 1, "must be text"),
        ("name = 3", 1, "must be text"),
        ("[drive]\nstart = \"warm\"", 2, "kinematic"),
        ("[contact]\ndetection = \"exat\"", 2, "exact"),
        ("[solver]\nformulation = \"lagrangian\"", 2, "lagrange"),
        ("[mass]\nwheel = 3", 2, "must be a table"),
    ] {
        let message = refused_text(text);
        assert!(
            message.starts_with(&format!("mine.toml, line {line}: ")),
            "{message}"
        );
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn broken_toml_names_its_line() {
    for (text, line) in [
        ("[gear]\nwheels = 2\nwheels = 3\n", 3),
        ("[gear\nwheels = 2", 1),
        ("a = \n", 1),
        ("[gear]\nwheels = 2\n[gear]\n", 3),
        ("\n\nx = \"never closed", 3),
    ] {
        let message = refused_text(text);
        assert!(
            message.starts_with(&format!("mine.toml, line {line}: not valid TOML")),
            "{message}"
        );
    }
}

#[test]
fn a_fault_between_keys_is_placed_where_the_user_changed_something() {
    let text = "base = \"paper\"\n[gear]\nhole_radius_m = 0.0085\n";
    let error = Scene::from_toml(text, "mine.toml", &[]).unwrap_err();
    assert!(
        matches!(
            error,
            SceneError::Key {
                place: Location::Line { line: 3, .. },
                ..
            }
        ),
        "{error:?}"
    );
    let error = Scene::from_toml(
        text,
        "mine.toml",
        &overrides(&["gear.eccentricity_m=0.0027"]),
    )
    .unwrap_err();
    assert!(
        matches!(
            error,
            SceneError::Key {
                place: Location::Set(_),
                ..
            }
        ),
        "{error:?}"
    );
    let error = Scene::from_toml(
        "base = \"paper\"\n[gear]\neccentricity_m = 0.004",
        "mine.toml",
        &[],
    )
    .unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("mine.toml, line 3: `gear.hole_radius_m`"),
        "{error}"
    );
}

/// Every number refuses NaN, both infinities, and values beyond its range.
#[test]
fn every_number_has_a_range() {
    let scene: toml::Table = preset("paper").unwrap().parse().unwrap();
    let mut numbers = 0;
    for (group, table) in &scene {
        let Some(table) = table.as_table() else {
            continue;
        };
        for (name, value) in table {
            let mut keys = Vec::new();
            match value {
                toml::Value::Table(body) => {
                    keys.extend(body.keys().map(|k| format!("{group}.{name}.{k}")));
                }
                toml::Value::Float(_) => keys.push(format!("{group}.{name}")),
                _ => {}
            }
            for key in keys {
                numbers += 1;
                for bad in ["nan", "-nan", "inf", "-inf", "1e300", "-1e300"] {
                    let line = refused(&[&format!("{key}={bad}")]);
                    assert!(line.contains(&format!("`{key}`")), "{line}");
                }
            }
        }
    }
    assert_eq!(
        numbers, 37,
        "a new number needs a range, then this count changes"
    );
}

#[test]
fn single_values_out_of_range() {
    for (set, part) in [
        ("gear.external_sleeve_radius_m=-0.006", "is -0.006 m"),
        ("gear.eccentricity_m=2.8", "lengths are in metres"),
        ("gear.eccentricity_m=0", "is 0 m"),
        ("gear.shortening=1.0", "crosses itself"),
        ("gear.shortening=0", "above 0.001 and below 1"),
        ("gear.external_sleeves=2", "from 3 to 1000"),
        ("gear.external_sleeves=1000000", "is 1000000"),
        (
            "gear.external_sleeves=9223372036854775807",
            "from 3 to 1000",
        ),
        ("gear.external_sleeves=0", "from 3 to 1000"),
        ("gear.internal_sleeves=2", "fewer than three"),
        ("gear.internal_sleeves=1000000", "is 1000000"),
        ("gear.wheels=0", "from 1 to 64"),
        ("gear.wheels=65", "memory"),
        ("gear.backlash_m=-1e-6", "from 0"),
        ("mass.wheel.mass_kg=0", "kilograms"),
        ("mass.wheel.moment_kg_m2=-1e-5", "kg m^2"),
        ("contact.young_pa=0", "pascal"),
        ("solver.tolerance=1e-14", "above 1e-14 and below 0.1"),
        ("contact.poisson=0.5", "above -1 and below 0.5"),
        ("contact.poisson=-1", "above -1 and below 0.5"),
        ("contact.stiffness_multiplier=0", "is 0"),
        ("contact.damping_n_s_m=-1", "from 0"),
        ("contact.ramp_m=0", "is 0"),
        ("contact.friction_coefficient=-0.1", "from 0"),
        ("contact.friction_ramp_m_s=0", "is 0"),
        ("contact.wheel_points=1000001", "memory"),
        ("contact.hole_points=7", "from 8"),
        ("drive.load_ramp_s=-1", "from 0"),
        ("solver.step_s=0", "is 0 s"),
        ("solver.sample_s=0", "is 0 s"),
        ("solver.tolerance=0.1", "below 0.1"),
        ("contact.law=papr", "did you mean `paper`?"),
        ("solver.integrator=rk3", "did you mean"),
        ("solver.integrator=euler", "write one of: "),
        ("name=\" \"", "1 to 100"),
    ] {
        let line = refused(&[set]);
        let key = set.split('=').next().unwrap();
        assert!(
            line.contains(&format!("`{key}` ")) && line.contains(part),
            "{line}"
        );
    }
}

#[test]
fn the_cost_of_a_run_is_bounded() {
    for (sets, part) in [
        (
            &["gear.wheels=64", "gear.external_sleeves=1000"][..],
            "pairs",
        ),
        (&["solver.step_s=1"], "longer than the whole run"),
        (&["solver.sample_s=1"], "longer than the whole run"),
        (&["solver.sample_s=1e-8"], "samples"),
        (&["solver.step_s=1e-12", "solver.duration_s=10"], "steps"),
    ] {
        let line = refused(sets);
        assert!(line.contains(part), "{line}");
    }
}

#[test]
fn parts_that_do_not_fit() {
    for (sets, part) in [
        (&["gear.external_sleeve_radius_m=0.0132"][..], "undercut"),
        (
            &["gear.external_sleeve_radius_m=0.0131"],
            "ring pins overlap",
        ),
        (&["gear.shortening=0.98"], "undercut"),
        (&["gear.backlash_m=0.0015"], "hardly reach"),
        (
            &["gear.internal_sleeve_radius_m=0.0088"],
            "larger than its hole",
        ),
        (
            &["gear.internal_sleeve_radius_m=0.009"],
            "larger than its hole",
        ),
        (&["gear.hole_radius_m=0.00879"], "could not orbit"),
        (&["gear.hole_radius_m=0.0146"], "neighbouring holes overlap"),
        (&["gear.internal_sleeves=14"], "neighbouring holes overlap"),
        (&["gear.internal_circle_radius_m=0.0525"], "leave the disc"),
        (&["gear.internal_circle_radius_m=0.07"], "leave the disc"),
        (
            &[
                "gear.internal_sleeves=3",
                "gear.hole_radius_m=0.035",
                "gear.internal_circle_radius_m=0.0405",
            ],
            "leave the disc",
        ),
    ] {
        let line = refused(sets);
        assert!(line.contains(part), "{line}");
    }
}

/// A message's advice must be accepted.
#[test]
fn remedies_hold() {
    for (bad, good) in [
        (
            &["gear.internal_circle_radius_m=0.0525"][..],
            "gear.internal_circle_radius_m",
        ),
        (&["gear.hole_radius_m=0.0080"], "gear.hole_radius_m"),
        (&["gear.backlash_m=0.002"], "gear.backlash_m"),
        (
            &["gear.external_sleeve_radius_m=0.02"],
            "gear.external_sleeve_radius_m",
        ),
        (&["gear.hole_radius_m=0.0146"], "gear.hole_radius_m"),
        (&["solver.sample_s=1e-8"], "solver.sample_s"),
    ] {
        let line = refused(bad);
        let (_, remedy) = line.rsplit_once("; ").unwrap();
        let number = remedy
            .split_whitespace()
            .find_map(|word| word.trim_end_matches(',').parse::<f64>().ok())
            .unwrap_or_else(|| panic!("{remedy}"));
        let mut sets: Vec<String> = bad.iter().map(|set| (*set).to_owned()).collect();
        sets.push(format!("{good}={number:e}"));
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        Scene::load("paper", &overrides(&sets)).unwrap_or_else(|error| panic!("{remedy}: {error}"));
    }
}

#[test]
fn presets_and_files_that_are_not_there() {
    for (spec, part) in [
        ("papr", "did you mean the preset `paper`?"),
        ("no/such/scene.toml", "or a preset: paper,"),
        ("", "preset"),
    ] {
        let error = Scene::load(spec, &[]).unwrap_err();
        assert!(matches!(error, SceneError::NotFound { .. }), "{error:?}");
        let line = error.to_string();
        assert!(line.contains(part) && !line.contains('\n'), "{line}");
    }
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("mine.toml"), "base = \"paper\"").unwrap();
    let typed = dir.path().join("mine.tml").display().to_string();
    let line = Scene::load(&typed, &[]).unwrap_err().to_string();
    assert!(line.contains("mine.toml`?"), "{line}");
    let folder = std::env::temp_dir();
    let error = Scene::load(folder.to_str().unwrap(), &[]).unwrap_err();
    assert!(matches!(error, SceneError::File(_)), "{error:?}");
}

#[test]
fn files_that_are_no_text_or_too_long() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("mine.toml");
    let load = || Scene::load(path.to_str().unwrap(), &[]).map_err(|error| error.to_string());

    std::fs::write(&path, b"[gear]\nwheels = 2\n# \xff\n").unwrap();
    assert!(load().unwrap_err().contains("line 3: not UTF-8"));
    std::fs::write(&path, vec![b'#'; pinwheel_scene::MOST_BYTES + 1]).unwrap();
    assert!(load().unwrap_err().contains("longer than"));
    std::fs::write(
        &path,
        "\u{feff}base = \"paper\"\r\n[gear]\r\nwheels = 1\r\n",
    )
    .unwrap();
    let scene = load().unwrap();
    assert_eq!((scene.name.as_str(), scene.gear.wheels), ("mine", 1));
    #[cfg(unix)]
    assert!(
        Scene::load("/dev/zero", &[])
            .unwrap_err()
            .to_string()
            .contains("longer than")
    );
}

#[test]
fn channels_that_do_not_exist() {
    for (line, part) in [
        (
            "channels = [\"eficiency\"]",
            "line 3: `output.channels` has no `eficiency`; did you mean `efficiency`?",
        ),
        (
            "channels = [\"wheel_2_external_penetration_m_0\"]",
            "discs are 0 to 1",
        ),
        ("channels = [3]", "must be a list of texts"),
        ("channels = 3", "must be a list of texts"),
        ("chanels = []", "did you mean `output.channels`?"),
    ] {
        let error = Scene::from_toml(
            &format!("base = \"paper\"\n[output]\n{line}\n"),
            "mine.toml",
            &[],
        )
        .unwrap_err();
        assert!(error.to_string().contains(part), "{error}");
    }
    let laws =
        "base = \"paper\"\n[contact]\nband_laws = [\"lundberg\", \"palmgrem\", \"kunertt\"]\n";
    let error = Scene::from_toml(laws, "mine.toml", &[])
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("line 3: `contact.band_laws` names \"palmgrem\", which is no contact law"),
        "{error}"
    );
    let twice = laws
        .replace("palmgrem", "kunert")
        .replace("kunertt", "kunert");
    let error = Scene::from_toml(&twice, "mine.toml", &[]).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("names \"kunert\" twice; name each once"),
        "{error}"
    );
    let many = "base = \"paper\"\n[output]\nchannels = [\"*\"]\n[solver]\nsample_s = 1e-6\n";
    let error = Scene::from_toml(many, "mine.toml", &[]).unwrap_err();
    assert!(
        error.to_string().contains("fewer output.channels"),
        "{error}"
    );
}

#[test]
fn channels_from_file_and_command_line() {
    let read = |text: &str, sets: &[Override]| Scene::from_toml(text, "mine.toml", sets).unwrap();
    let scene = read(
        "base = \"paper\"\n[output]\nchannels = [\"efficiency\"]\n",
        &[],
    );
    assert_eq!(scene.output.channels, ["efficiency"]);
    assert_eq!(read(&scene.to_toml(), &[]), scene);
    let set = |value: &str| {
        read(
            "base = \"paper\"",
            &[Override::new("output.channels", value)],
        )
    };
    assert_eq!(set("efficiency"), scene);
    assert_eq!(
        set("[\"efficiency\", \"input_power_w\"]")
            .output
            .channels
            .len(),
        2
    );
    // An empty selection writes nothing, so that earlier files stay unchanged.
    assert!(!Scene::paper().to_toml().contains("output]"));
}

/// Returns the error of the paper's gear with these lines at its end.
fn refused_deviation(lines: &str) -> String {
    refused_text(&format!("base = \"paper\"\n{lines}"))
}

#[test]
fn bad_input_modifications() {
    let cases: [(&str, &[&str]); 7] = [
        (
            "gear.modification.rotational_rad = -1e-4",
            &["rotational_rad", "from 0 to"],
        ),
        (
            "gear.modification.equidistant_m = 0.01",
            &[
                "line 2",
                "equidistant_m",
                "that is another gear",
                "would do: gear.modification.equidistant_m = 0.0014",
            ],
        ),
        (
            "gear.modification.rotational_rad = 0.5",
            &[
                "rotational_rad",
                "would do: gear.modification.rotational_rad = ",
            ],
        ),
        (
            "gear.modification.equidistant_um = 10",
            &["did you mean `gear.modification.equidistant_m`?"],
        ),
        (
            "gear.external_sleeve_radius_m = 0.0124\ngear.modification.equidistant_m = 0.001",
            &["line 3", "undercut", "equidistant_m = 0.00072"],
        ),
        (
            "gear.modification.equidistant_m = -0.0005",
            &[
                "line 2",
                "0.0005 m larger",
                "pits are only 0.000564",
                "equidistant_m = -0.00045",
            ],
        ),
        (
            "gear.shortening = 0.98\ngear.external_sleeve_radius_m = 0.002\ngear.modification.radial_m = -0.00099",
            &[
                "radial_m",
                "crosses itself",
                "would do: gear.shortening = 0.85",
            ],
        ),
    ];
    for (lines, parts) in cases {
        let line = refused_deviation(lines);
        for part in parts {
            assert!(line.contains(part), "{lines}: {line}");
        }
    }
}

#[test]
fn bad_input_errors_of_parts() {
    let list = |count: usize, value: &str| format!("[{}]", vec![value; count].join(", "));
    let cases: [(&str, String, &[&str]); 8] = [
        (
            "external_sleeve_radius_m",
            list(15, "1e-6"),
            &["has 15 entries", "16 ring pins", "give 16 numbers"],
        ),
        (
            "hole_radial_m",
            list(8, "1e-6"),
            &["has 8 entries", "16 holes, disc by disc"],
        ),
        (
            "phase_rad",
            "0.1".to_owned(),
            &["must be a list of numbers"],
        ),
        ("phase_rad", list(2, "nan"), &["entry 0"]),
        ("phase_rad", "[0.0, \"1\"]".to_owned(), &["list of numbers"]),
        (
            "eccentricity_m",
            list(2, "0.003"),
            &["eccentricity_m", "at most 0.0014 m"],
        ),
        (
            "hole_radius_m",
            list(16, "-5.0"),
            &["entry 0", "from -1 to 1"],
        ),
        (
            "external_radius_m",
            list(16, "0.0"),
            &["did you mean `gear.errors.external_sleeve_radius_m`?"],
        ),
    ];
    for (key, value, parts) in cases {
        let line = refused_deviation(&format!("gear.errors.{key} = {value}"));
        for part in parts {
            assert!(line.contains(part), "{key}: {line}");
        }
    }
    // Pins so large that neighbours meet: half a pitch is 12.486 mm.
    let line = refused_deviation(&format!(
        "gear.external_sleeve_radius_m = 0.0124\ngear.errors.external_sleeve_radius_m = {}",
        list(16, "9e-5")
    ));
    assert!(line.contains("ring pins 0 and 1 overlap"), "{line}");
    // One hole smaller than its pin.
    let line = refused_deviation(&format!(
        "gear.eccentricity_m = 0.0014\ngear.hole_radius_m = 0.0074\ngear.external_sleeve_radius_m = 0.002\n\
         gear.errors.hole_radius_m = {}\ngear.errors.internal_sleeve_radius_m = {}",
        list(16, "-7e-4"),
        list(8, "7e-4")
    ));
    assert!(line.contains("larger than its hole"), "{line}");
}

/// Modified and unmodified walls: a smaller disc leaves less between hole and edge.
#[test]
fn walls_follow_the_modification() {
    let wall = |lines: &str| {
        let text = format!("base = \"paper\"\n{lines}");
        let scene = Scene::from_toml(&text, "mine.toml", &[]).unwrap();
        pinwheel_scene::derived(&scene).walls.hole_to_profile_m
    };
    let plain = wall("");
    let thinner = wall("gear.modification.equidistant_m = 1e-4");
    assert!((plain - thinner - 1e-4).abs() < 1e-12, "{plain} {thinner}");
    let smaller = wall("gear.modification.radial_m = -1e-4");
    assert!(
        (5e-5..1.5e-4).contains(&(plain - smaller)),
        "{plain} {smaller}"
    );
    let list = |value: &str| format!("[{}]", vec![value; 16].join(", "));
    let larger = wall(&format!("gear.errors.hole_radius_m = {}", list("1e-4")));
    assert!((plain - larger - 1e-4).abs() < 1e-12, "{plain} {larger}");
}
