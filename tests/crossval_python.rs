//! measuring
use pinwheel_engines::python::law_agreement;
use pinwheel_gearbox::scene::{Override, Scene};

#[test]
fn crossval_python_law() {
    for (preset, more) in [
        ("paper", vec![]),
        ("paper-friction", vec![]),
        ("backlash-0.6", vec![]),
        ("backlash-0.6", vec![Override::new("contact.friction_coefficient", "0.1")]),
        ("steel", vec![]),
        ("one-wheel", vec![]),
        ("eleven-pins", vec![]),
        ("forty-pins", vec![]),
        ("paper-rough", vec![]),
        ("paper-rough", vec![Override::new("contact.friction_coefficient", "0.1"), Override::new("gear.backlash_m", "0.0006")]),
        ("paper-refined", vec![]),
    ] {
        let scene = Scene::load(preset, &more).unwrap();
        let t = std::time::Instant::now();
        let a = law_agreement(&scene, 10_000, 1);
        println!("{preset} {:?} {:?}: {:?} {a:?}", scene.contact.detection, scene.contact.friction_coefficient, t.elapsed());
    }
}
