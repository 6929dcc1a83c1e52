//! States of the explorer.

use pinwheel_scene::{KEYS, Scene};
use pinwheel_studies::explore::{scene, sliders};

/// Messages contain only labels and units that the page shows, for any invalid key.
#[test]
fn bad_input_states_are_refused_in_words_and_units_of_the_page() {
    let mut refused = 0;
    for spec in ["paper", "needle-bearings", "rv-40e-like"] {
        let shown = Scene::load(spec, &[]).unwrap();
        for slider in sliders(&shown) {
            let key = slider["key"].as_str().unwrap().to_owned();
            let own = slider["value"].as_f64().unwrap_or(1.0) / slider["factor"].as_f64().unwrap();
            for value in [-1.0, 0.0, 0.3 * own, 4.0 * own, 1e9] {
                let values = [(key.clone(), value.to_string())];
                let Err(error) = scene(spec, &[], &values) else {
                    continue;
                };
                refused += 1;
                let named = KEYS
                    .iter()
                    .find(|row| row.name.contains('.') && error.contains(row.name));
                assert!(named.is_none(), "{key} = {value}: {error}");
                assert!(!error.contains("metres"), "{key} = {value}: {error}");
                let words: Vec<&str> = error.split([' ', ',', ';', ':', ')']).collect();
                let is_si = |pair: &[&str]| {
                    pair[0].parse::<f64>().is_ok() && ["m", "rad/s", "N/m"].contains(&pair[1])
                };
                assert!(!words.windows(2).any(is_si), "{key} = {value}: {error}");
            }
        }
    }
    assert!(refused > 60, "{refused}");
}
