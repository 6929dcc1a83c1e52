//! Manifests of solvers.

use std::path::Path;

use pinwheel_engines::external::Manifest;
use pinwheel_files::FileError;
use pinwheel_scene::Scene;

const GOOD: &str = r#"
protocol = 1
name = "mine"
version = "0.1"
track = "own-contact"
summary = "a solver"
command = ["{here}/solver", "--job={job}", "{law}", "{python}"]
timeout_s = 30
[honours]
laws = ["paper*", "constant"]
friction = true
[refine]
key = "solver.step_s"
order = 4
[model]
input_torque_n_m = { tolerance = 0.01, reason = "bed of springs" }
"#;

fn read(text: &str) -> Result<Manifest, FileError> {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("solver.toml");
    std::fs::write(&path, text).expect("written");
    Manifest::read(&path)
}

#[test]
fn a_manifest_as_documented() {
    let manifest = read(GOOD).expect("good");
    assert_eq!(manifest.refine.map(|refine| refine.order), Some(4.0));
    let places = [
        ("here", "/h"),
        ("job", "/j b"),
        ("law", "/l"),
        ("python", "py"),
    ];
    let argv = manifest.argv(&places.map(|(name, path)| (name, Path::new(path))));
    assert_eq!(argv, ["/h/solver", "--job=/j b", "/l", "py"]);
    assert!(manifest.wants("law") && manifest.wants("python"));
    let scene = |sets: &[&str]| {
        let sets: Vec<_> = sets.iter().map(|set| set.parse().expect("one")).collect();
        Scene::load("paper", &sets).expect("paper")
    };
    assert_eq!(
        manifest.refuses(&scene(&["contact.friction_coefficient=0.1"])),
        None
    );
    assert_eq!(
        manifest.refuses(&scene(&["contact.law=paper-conservative"])),
        None
    );
    let law = manifest
        .refuses(&scene(&["contact.law=flores"]))
        .expect("refused");
    assert!(law.contains("paper*, constant, not `flores`"), "{law}");
    let load = "drive.load_changes=[{time_s=0.1,output_torque_n_m=30.0}]";
    assert!(manifest.refuses(&scene(&[load])).is_some());
    let speed = "drive.speed_changes=[{time_s=0.1,input_speed_rad_s=30.0,ramp_s=0.1}]";
    for (set, key) in [
        (speed, "honours.speed_changes"),
        ("drive.output=ring", "honours.ring"),
    ] {
        let refused = manifest.refuses(&scene(&[set]));
        assert!(refused.is_some_and(|why| why.contains(key)), "{key}");
    }
    // The law's library includes seats, slots, shared pins and warm parts; flanges are behind the output.
    for (key, size, refuses) in [
        ("ring_seat_length_m", "0.008", true),
        ("ring_slot_clearance_m", "2e-6", true),
        ("input_torsion_n_m_rad", "1e4", false),
    ] {
        let refused = manifest.refuses(&scene(&[&format!("structure.{key}={size}")]));
        let named = |why: String| why.contains("honours.structure") && why.contains(key);
        assert_eq!(refused.is_some_and(named), refuses, "{key}");
    }
    let warm = scene(&["contact.material=\"steel\"", "temperature.housing_k=5"]);
    let refused = manifest.refuses(&warm).expect("refused");
    assert!(refused.contains("honours.structure") && refused.contains("[temperature]"));
    let shares = read(&GOOD.replace("friction = true", "friction = true\nstructure = true"));
    assert_eq!(shares.expect("good").refuses(&warm), None);
}

#[test]
fn bad_input_is_named_with_its_remedy() {
    for (from, to, words) in [
        ("protocol = 1", "protocol = 2", "write protocol = 1"),
        ("\"mine\"", "\"Mine!\"", "small letters"),
        ("\"mine\"", "\"native-reduced\"", "choose another name"),
        ("version = \"0.1\"", "", "missing field `version`"),
        (
            "version = \"0.1\"",
            "verzion = \"0.1\"",
            "did you mean `version`?",
        ),
        ("own-contact", "measured", "write \"shared-law\""),
        ("own-contact", "shared-law", "leave [model] out"),
        (
            "{here}/solver",
            "{hear}/solver",
            "known are {here}, {job}, {law} and {python}",
        ),
        (
            "[\"{here}/solver\", \"--job={job}\", \"{law}\", \"{python}\"]",
            "[]",
            "write the program",
        ),
        ("timeout_s = 30", "timeout_s = -1", "write seconds"),
        ("timeout_s = 30", "timeout_s = inf", "write seconds"),
        ("\"constant\"", "\"konstant\"", "`pinwheel laws` lists them"),
        (
            "solver.step_s",
            "gear.wheels",
            "write one of: solver.step_s, solver.tolerance",
        ),
        ("order = 4", "order = 0", "write the order of the method"),
        ("tolerance = 0.01", "tolerance = -1", "needs a tolerance"),
    ] {
        let error = read(&GOOD.replace(from, to)).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
        assert!(!error.contains('\n'), "{error}");
    }
    let error = Manifest::read(Path::new("/nowhere.toml")).expect_err("missing");
    assert!(error.to_string().contains("cannot be read"), "{error}");
    assert!(Manifest::read(Path::new("/dev/zero")).is_err());
}
