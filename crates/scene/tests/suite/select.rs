//! Selection of channels by pattern.

use pinwheel_scene::Layout;
use pinwheel_scene::channels::{MOST_PATTERNS, select};

const LAYOUT: Layout = Layout {
    wheels: 2,
    external_sleeves: 16,
    internal_sleeves: 8,
};

fn names(patterns: &[&str]) -> Vec<String> {
    let patterns: Vec<String> = patterns.iter().map(|&p| p.to_owned()).collect();
    let chosen = select(&patterns, LAYOUT).unwrap();
    chosen.into_iter().map(|c| c.name).collect()
}

fn remedy(pattern: &str) -> String {
    select(&[pattern.to_owned()], LAYOUT).unwrap_err().remedy
}

#[test]
fn asks_for_columns_by_name_and_pattern() {
    assert!(names(&[]).is_empty());
    assert_eq!(
        names(&["wheel_1_internal_stiffness_n_m15_7", "efficiency", "eff*"]),
        ["efficiency", "wheel_1_internal_stiffness_n_m15_7"]
    );
    assert_eq!(names(&["wheel_*_external_penetration_m_3"]).len(), 2);
    // Recorded without request.
    assert!(names(&["input_torque_n_m"]).is_empty());
    // The gear, discs, shafts' bearings, eccentrics', pins, pairs.
    let all = 7 + 2 * 9 + 2 * 3 + 2 * 7 + 24 * 4 + 2 * 24 * 12;
    assert_eq!(names(&["*"]).len(), all);
}

#[test]
fn says_what_was_meant() {
    assert_eq!(
        remedy("wheel_0_external_penetraton_m_3"),
        "did you mean `wheel_0_external_penetration_m_3`?"
    );
    assert_eq!(
        remedy("wheel_*_internal_stifness_n_m15_2"),
        "did you mean `wheel_*_internal_stiffness_n_m15_2`?"
    );
    assert_eq!(remedy("eficiency"), "did you mean `efficiency`?");
    assert!(remedy("wheel_2_external_penetration_m_3").contains("discs are 0 to 1"));
    assert!(remedy("external_sleeve_force_n_16").contains("ring pins 0 to 15"));
    assert!(remedy("").contains("pinwheel explain"));
    assert!(remedy(&"x".repeat(1000)).contains('*'));
    let many = vec!["*".to_owned(); MOST_PATTERNS + 1];
    assert!(select(&many, LAYOUT).is_err());
}
