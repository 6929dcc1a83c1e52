//! What a scene assumes.

use pinwheel_scene::{Scene, assumptions};

fn keys(scene: Scene) -> Vec<String> {
    let scene = scene.check().unwrap();
    let list = assumptions(&scene).into_iter();
    list.map(|assumption| assumption.key).collect()
}

#[test]
fn the_papers_gear_names_fig_3_mu_and_tab_2() {
    let keys = keys(Scene::paper());
    for key in [
        "gear.internal_sleeve_radius_m",
        "gear.hole_radius_m",
        "gear.internal_circle_radius_m",
        "contact.friction_coefficient",
        "mass",
    ] {
        assert!(keys.iter().any(|k| k == key), "{key} missing in {keys:?}");
    }
}

#[test]
fn a_base_is_one_entry() {
    let scene = Scene::from_toml("base = \"forty-pins\"", "mine.toml", &[]).unwrap();
    let list = assumptions(&scene);
    assert_eq!(list.len(), 1);
    assert_eq!(
        (list[0].key.as_str(), list[0].value.as_str()),
        ("base", "forty-pins")
    );
    assert!(list[0].reason.contains("gear.wheels"));
}
