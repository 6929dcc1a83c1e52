//! No input panics the reader, and accepted scenes are valid.

use proptest::prelude::*;

use pinwheel_scene::{CheckedScene, Override, Scene, assumptions, derived, preset};

/// Checks any outcome: no panic, one line of message, finite figures.
fn survives(result: Result<CheckedScene, pinwheel_scene::SceneError>) {
    match result {
        Ok(scene) => {
            let figures = derived(&scene);
            assert!(figures.smallest_convex_radius_m > scene.gear.external_sleeve_radius_m);
            assert!(figures.hole_clearance_m > -1e-9);
            let _ = assumptions(&scene);
            let again = Scene::from_toml(&scene.to_toml(), "again.toml", &[]).unwrap();
            assert_eq!(again, scene);
        }
        Err(error) => {
            let line = error.to_string();
            assert!(!line.chars().any(char::is_control), "{line:?}");
        }
    }
}

fn keys() -> Vec<String> {
    let table: toml::Table = Scene::paper().to_toml().parse().unwrap();
    let mut keys = Vec::new();
    for (group, value) in &table {
        let Some(inner) = value.as_table() else {
            continue;
        };
        for (name, value) in inner {
            match value.as_table() {
                Some(body) => keys.extend(body.keys().map(|k| format!("{group}.{name}.{k}"))),
                None => keys.push(format!("{group}.{name}")),
            }
        }
    }
    keys
}

proptest! {
    #[test]
    fn garbage_never_panics(text in ".{0,300}") {
        survives(Scene::from_toml(&text, "mine.toml", &[]));
    }

    #[test]
    fn toml_like_garbage_never_panics(text in "[\\[\\]a-z_.={}\"'#0-9\\-+ \n]{0,200}") {
        survives(Scene::from_toml(&text, "mine.toml", &[]));
    }

    #[test]
    fn garbage_overrides_never_panic(text in ".{0,80}") {
        if let Ok(set) = text.parse::<Override>() {
            survives(Scene::load("paper", &[set]));
        }
    }

    #[test]
    fn mutated_paper_never_panics(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<char>(), 0..3u8), 1..8),
    ) {
        let mut text: Vec<char> = preset("paper").unwrap().chars().collect();
        for (at, c, kind) in edits {
            let at = at.index(text.len());
            match kind {
                0 => text[at] = c,
                1 => text.insert(at, c),
                _ => { text.remove(at); }
            }
        }
        let text: String = text.into_iter().collect();
        survives(Scene::from_toml(&text, "mine.toml", &[]));
    }

    #[test]
    fn any_number_anywhere_never_panics(
        key in prop::sample::select(keys()),
        other in prop::sample::select(keys()),
        value in prop_oneof![any::<f64>().prop_map(|x| format!("{x:?}")), any::<i64>().prop_map(|x| x.to_string())],
        factor in 1e-3..1e3_f64,
    ) {
        survives(Scene::load("paper", &[Override::new(key, value.to_lowercase())]));
        survives(Scene::load("paper", &[Override::new(other, format!("{factor}"))]));
    }

    /// Random gears of sensible size: accepted or refused, never a panic, in bounded time.
    #[test]
    fn random_gears(
        zk in 3..1000_usize, zi in 3..40_usize, wheels in 1..64_usize,
        e in 1e-4..1e-2_f64, m in 0.01..0.999_f64,
        q in 0.01..1.2_f64, rs in 0.01..0.5_f64, rw in 0.1..1.2_f64,
    ) {
        let r = e * zk as f64 / m;
        let q = q * r * (std::f64::consts::PI / zk as f64).sin();
        let rs = rs * r / zi as f64;
        let sets = [
            ("gear.external_sleeves", zk.to_string()),
            ("gear.internal_sleeves", zi.to_string()),
            ("gear.wheels", wheels.to_string()),
            ("gear.eccentricity_m", format!("{e:e}")),
            ("gear.shortening", format!("{m}")),
            ("gear.external_sleeve_radius_m", format!("{q:e}")),
            ("gear.internal_sleeve_radius_m", format!("{rs:e}")),
            ("gear.hole_radius_m", format!("{:e}", rs + e * 1.001)),
            ("gear.internal_circle_radius_m", format!("{:e}", rw * r)),
        ].map(|(key, value)| Override::new(key, value));
        survives(Scene::load("paper", &sets));
    }
}
