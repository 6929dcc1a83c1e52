//! exudyn and MuJoCo against the native solver.
use pinwheel_engines::{Control, by_name};
use pinwheel_gearbox::scene::{Override, Scene};

#[test]
fn crossval_python_smoke() {
    for engine in [
        "mujoco-shared-law",
        "exudyn-shared-law-explicit",
        "exudyn-shared-law-constrained",
        "mujoco-own-contact",
        "exudyn-own-contact",
    ] {
        let scene = Scene::load("paper", &[Override::new("solver.duration_s", "0.01")]).unwrap();
        let t = std::time::Instant::now();
        let run = by_name(engine, &scene)
            .unwrap()
            .run(&scene, &Control::quiet())
            .unwrap();
        println!("{engine}: {:?} {:?}", t.elapsed(), run.stats);
    }
}
