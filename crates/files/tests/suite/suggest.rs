//! Patterns of names and suggestions.

use pinwheel_files::{did_you_mean, fits, nearest};

#[test]
fn finds_what_was_meant() {
    let known = ["backlash_m", "wheels", "hole_radius_m"];
    assert_eq!(nearest("backlsah_m", known), Some("backlash_m"));
    let engines = ["native", "rapier-shared-law", "mujoco-shared-law"];
    assert_eq!(nearest("mujocco", engines), Some("mujoco-shared-law"));
    assert_eq!(nearest("ripaer", engines), Some("rapier-shared-law"));
    assert_eq!(nearest("hole_radius", known), Some("hole_radius_m"));
    assert_eq!(nearest("Wheels", known), Some("wheels"));
    assert_eq!(nearest("teeth", known), None);
    assert_eq!(nearest("", known), None);
    assert_eq!(did_you_mean("zzz", &["a", "b"]), "write one of: a, b");
}

#[test]
fn patterns() {
    for (pattern, text, wanted) in [
        ("*", "", true),
        ("*", "anything", true),
        ("native*", "native", true),
        ("*_force_n", "external_sleeve_force_n", true),
        ("*_force_n", "force_n", false),
        ("a*c", "abcd", false),
        ("a*b*c", "abbbc", true),
        ("*_3", "wheel_0_x_13", false),
        ("", "a", false),
        ("*a*b", "aab", true),
        ("*ab", "aab", true),
        ("*\u{e9}", "caf\u{e9}", true),
    ] {
        assert_eq!(fits(pattern, text), wanted, "{pattern} {text}");
    }
}

/// A fallback for every star would take 1e26 steps here.
#[test]
fn bad_input_patterns_of_many_stars_end() {
    let stars = "*".repeat(60_000);
    assert!(fits(&stars, "external_sleeve_force_n"));
    assert!(!fits(&format!("{stars}x"), "external_sleeve_force_n"));
    assert!(!fits(&"*e".repeat(9), "external_sleeve_force_n"));
}
