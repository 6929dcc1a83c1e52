//! Packages of units: reproducible bytes, and runs in fmpy against the native run.
//!
//! `PINWHEEL_FMPY` names a Python with fmpy; without it that part is skipped with a note, unless `PINWHEEL_REQUIRE_FMPY` is
//! set.

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufWriter, Cursor, Read as _};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

use pinwheel_fmu::internals::{Unit, identifier};
use pinwheel_fmu::{Imprint, Package};
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_scene::{Override, Scene};
use zip::ZipArchive;

use crate::library;

fn gearbox(scene: &str, sets: &[&str]) -> Gearbox {
    let sets: Vec<Override> = sets.iter().map(|set| set.parse().expect(set)).collect();
    Gearbox::new(&Scene::load(scene, &sets).expect(scene)).expect("gearbox")
}

/// Imprint with characters that a description has to escape.
fn imprint() -> Imprint {
    Imprint::here(Some("A. \"B\" & C")).expect("imprint")
}

/// Returns a small file in the library's place, whose bytes nothing but a run reads.
fn stand_in() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let bytes = |sets: &[&str], author: &str| {
        let imprint = Imprint {
            author: author.to_owned(),
            date: SystemTime::UNIX_EPOCH,
        };
        let package = Package::new(&gearbox("paper", sets), &stand_in(), imprint).expect("package");
        (package.guid().to_owned(), package.bytes().expect("bytes"))
    };
    let (one, two) = (bytes(&[], "A. Author"), bytes(&[], "A. Author"));
    assert!(one == two && one.1.starts_with(b"PK"));
    assert_ne!(bytes(&["gear.backlash_m=1e-4"], "A. Author").0, one.0);
    // The imprint does not affect the identifier.
    let other = bytes(&[], "Another");
    assert!(other.0 == one.0 && other.1 != one.1);
    println!("{} bytes", one.1.len());
}

#[test]
fn bad_input_a_library_that_is_not_there() {
    let error = Package::new(
        &gearbox("paper", &[]),
        Path::new("/nowhere/lib.so"),
        imprint(),
    );
    assert!(
        error
            .expect_err("none")
            .to_string()
            .contains("/nowhere/lib.so")
    );
}

/// For any scene name the entries of its unit are the four of the standard, once each, inside the target folder, and named as
/// in the description.
#[test]
fn hard_entries_are_those_of_the_standard() {
    let long = "n".repeat(100);
    let names = [
        "paper",
        "../../x",
        "a\\b/c:d*?",
        "\u{202e}xml.exe",
        "1",
        &long,
    ];
    for name in names {
        let set = format!("name={name}");
        let package = Package::new(&gearbox("paper", &[&set]), &stand_in(), imprint());
        let bytes = package.expect("package").bytes().expect("bytes");
        let mut archive = ZipArchive::new(Cursor::new(bytes)).expect("an archive");
        let mut entries = BTreeMap::new();
        for k in 0..archive.len() {
            let mut entry = archive.by_index(k).expect("an entry");
            let (mut content, size) = (Vec::new(), entry.size());
            // Reading to the end verifies the check sum.
            entry.read_to_end(&mut content).expect("complete");
            assert_eq!(content.len() as u64, size, "{name}");
            assert!(entry.enclosed_name().is_some(), "{name}: {}", entry.name());
            let library = entry.name().starts_with("binaries/");
            let mode = entry.unix_mode().map(|mode| mode & 0o777);
            assert_eq!(mode, Some(if library { 0o755 } else { 0o644 }), "{name}");
            let again = entries.insert(entry.name().to_owned(), content);
            assert!(again.is_none(), "{name}: {} twice", entry.name());
        }
        let description = String::from_utf8(entries["modelDescription.xml"].clone()).expect("text");
        let (_, rest) = description.split_once("modelIdentifier=\"").expect("named");
        let (identifier, _) = rest.split_once('"').expect("named");
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        assert!(
            identifier.chars().all(plain) && identifier.len() <= 64,
            "{identifier}"
        );
        assert!(
            !identifier.starts_with(|c: char| c.is_ascii_digit()),
            "{identifier}"
        );
        let file = format!("{identifier}{}", std::env::consts::DLL_SUFFIX);
        let wanted = [
            "documentation/index.html",
            "modelDescription.xml",
            "resources/scene.toml",
        ];
        let (library, others): (Vec<&String>, Vec<&String>) = entries
            .keys()
            .partition(|entry| entry.starts_with("binaries/"));
        assert_eq!(others, wanted, "{name}");
        assert!(
            matches!(library[..], [one] if one.ends_with(&format!("/{file}"))),
            "{library:?}"
        );
        assert!(
            entries[library[0]] == fs::read(stand_in()).expect("there"),
            "{name}"
        );
    }
}

#[test]
fn crossval_a_unit_in_fmpy_is_the_native_run() {
    let python = std::env::var("PINWHEEL_FMPY").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&python).args(["-c", "import fmpy"]).output();
    if !has.is_ok_and(|output| output.status.success()) {
        let what = "no fmpy here; name a Python that has it by PINWHEEL_FMPY";
        assert!(
            std::env::var_os("PINWHEEL_REQUIRE_FMPY").is_none(),
            "{what}"
        );
        println!("skipped: {what}");
        return;
    }
    let folder = tempfile::tempdir().expect("folder");
    let [unit, time_series] = ["unit.fmu", "courses.csv"].map(|name| folder.path().join(name));
    for (scene, method, tolerance) in [
        ("paper", "etd-adams", 1e-9),
        ("paper-friction", "rodas5p", 1e-7),
        ("steel", "etd-adams", 1e-10),
    ] {
        let [method, tolerance] = [
            format!("solver.integrator={method}"),
            format!("solver.tolerance={tolerance:e}"),
        ];
        let sets = [
            method.as_str(),
            tolerance.as_str(),
            "solver.duration_s=0.02",
            "solver.sample_s=1e-4",
            // Characters that a description has to escape.
            "name=a <b> & \"c\"",
            "description=1 < 2 & 'so'",
        ];
        let gearbox = gearbox(scene, &sets);
        let package = Package::new(&gearbox, &library(), imprint()).expect("package");
        fs::write(&unit, package.bytes().expect("bytes")).expect("unit");
        let run = native::run(&gearbox, &mut |_| false)
            .expect("run")
            .finished()
            .expect("complete");
        let file = fs::File::create(&time_series).expect("file");
        run.time_series
            .write_csv(BufWriter::new(file))
            .expect("courses");
        let measured = Command::new(&python)
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fmu.py"))
            .args([&unit, &time_series])
            .output()
            .expect("Python starts");
        println!("{scene}\n{}", String::from_utf8_lossy(&measured.stdout));
        let errors = String::from_utf8_lossy(&measured.stderr);
        assert!(measured.status.success(), "{scene}: {errors}");
    }
}

#[test]
fn units_follow_names() {
    for (name, unit) in [
        ("input_torque_n_m", Some("N.m")),
        ("external_sleeve_force_n_12", Some("N")),
        ("mass.wheel.moment_kg_m2", Some("kg.m2")),
        ("wheel_0_external_stiffness_n_m15_3", Some("N/m1.5")),
        ("transmission_error_arcmin", Some("arcmin")),
        ("contact.damping_n_s_m", Some("N.s/m")),
        ("contact.external_spring_n_m", Some("N/m")),
        ("mass.density_kg_m3", Some("kg/m3")),
        ("contact.friction_ramp_m_s", Some("m/s")),
        ("wheel_0_external_pressure_sliding_w_m2_3", Some("W/m2")),
        ("efficiency", None),
        ("external_contact_ratio_0", None),
    ] {
        assert_eq!(Unit::of(name).map(|unit| unit.name), unit, "{name}");
    }
    let arcmin = Unit::of("transmission_error_arcmin");
    assert!(arcmin.is_some_and(|unit| unit.definition().contains("factor=\"2.908")));
}

#[test]
fn names_become_identifiers() {
    for (name, wanted) in [
        ("paper", "paper"),
        ("backlash-0.6", "backlash_0_6"),
        ("2 wheels", "gear_2_wheels"),
        ("", "gear_"),
        ("\u{e4}", "gear__"),
    ] {
        assert_eq!(identifier(name), wanted);
    }
}
