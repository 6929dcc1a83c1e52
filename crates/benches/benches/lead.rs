//! The native solver against rapier at the same error, in one run:
//! `cargo bench -p pinwheel-benches --bench lead`.
//!
//! Settings that leave 1e-4 (relative L2, all pin forces, 0.6 s, start-up included), from `pinwheel bench`: on
//! `paper` dopri5 at 8e-6 (saddle-point form 1.6e-6) and rapier at 3.7e-6 s (1e-4 s of sampling divided by
//! 27). What is compared is the quotient.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use pinwheel_engines::{Control, Engine, by_name};
use pinwheel_scene::Scene;

fn run(engine: &dyn Engine, scene: &Scene) {
    black_box(
        engine
            .run(&scene.clone().check().unwrap(), &Control::quiet())
            .expect("presets run to their end"),
    );
}

fn lead(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("paper-at-1e-4");
    group.sample_size(10);
    let mut scene = Scene::load("paper", &[])
        .expect("presets are valid")
        .into_scene();
    "dopri5".clone_into(&mut scene.solver.integrator);
    scene.solver.step_s = scene.solver.sample_s / 27.0;
    for (name, tolerance) in [
        ("native-reduced", 8e-6),
        ("native-lagrange", 1.6e-6),
        ("rapier-shared-law", 8e-6),
    ] {
        scene.solver.tolerance = tolerance;
        let Some(engine) = by_name(name, &scene) else {
            continue;
        };
        group.bench_function(name, |b| b.iter(|| run(engine.as_ref(), &scene)));
    }
    group.finish();
}

criterion_group!(benches, lead);
criterion_main!(benches);
