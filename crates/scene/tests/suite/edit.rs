//! Keys of a text changed in place.

use std::path::Path;

use pinwheel_scene::{Override, edited};

#[test]
fn regress_one_key_changes_and_all_else_stays() {
    let own = "# mine\n[gear] # dimensions\nbacklash_m = 1e-5 # as measured\n\n# the drive\n[drive]\noutput_torque_n_m = 200\n\
               [bearings.eccentric]\nrollers = 16 # needles\nclearance_m = 5e-6\n";
    let changed = |sets: &[(&str, &str)], removed: &[&str]| {
        let sets = sets.iter().map(|&(key, value)| Override::new(key, value));
        edited(own, &sets.collect::<Vec<_>>(), removed, Path::new("")).unwrap()
    };
    let loose = changed(&[("gear.backlash_m", "36e-6")], &[]);
    assert_eq!(loose, own.replace("1e-5 #", "36e-6 #"));
    let added = changed(
        &[
            ("gear.modification.radial_m", "1e-6"),
            ("contact.law", "paper"),
        ],
        &[],
    );
    let expected = own.replace("measured\n", "measured\nmodification.radial_m = 1e-6\n");
    assert_eq!(added, format!("contact.law = \"paper\"\n{expected}"));
    let plain = changed(
        &[("bearings.eccentric.stiffness_n_m", "3e8")],
        &["bearings.eccentric.rollers"],
    );
    assert_eq!(
        plain,
        own.replace("rollers = 16 # needles\n", "") + "stiffness_n_m = 3e8\n"
    );
    let rigid = changed(&[], &["bearings.eccentric", "cranks.none"]);
    assert_eq!(rigid, own.split("[bearings").next().unwrap());
    let on = |base: &str| {
        edited(
            &format!("base = \"{base}\"\n"),
            &[],
            &[],
            Path::new("gears"),
        )
    };
    assert_eq!(on("paper").unwrap(), "base = \"paper\"\n");
    assert_eq!(on("own.toml").unwrap(), "base = \"gears/own.toml\"\n");
    assert_eq!(edited("{\"gear\": 1}", &[], &[], Path::new("")), None);
}
