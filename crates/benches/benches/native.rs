//! Whole native runs: `cargo bench -p pinwheel-benches --bench native`.
//!
//! Times of these runs when they were set, on one core of a 2-core virtual machine (EPYC, AVX-512), 0.6 s at 1e-5 s:
//! reduced 0.09 s, Lagrange 0.34 s (limits asked for: 0.5 and 1.5 s); 4000 points cost what 600 points cost (at most
//! 1.5 times).

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use pinwheel_gearbox::contacts::Kernel;
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_mbs::{Evaluation, Wrench};
use pinwheel_scene::{Formulation, Scene};

fn preset(name: &str) -> Scene {
    Scene::load(name, &[])
        .expect("presets are valid")
        .into_scene()
}

fn run(scene: &Scene) {
    let gearbox = Gearbox::new(&scene.clone().check().unwrap()).expect("presets can be modelled");
    black_box(
        native::run(&gearbox, &mut |_| false)
            .expect("presets run")
            .finished()
            .expect("presets end"),
    );
}

/// The paper's run, 0.6 s at 1e-5 s.
fn runs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("paper-0.6s");
    group.sample_size(10);
    let paper = preset("paper");
    let mut lagrange = paper.clone();
    lagrange.solver.formulation = Formulation::Lagrange;
    group.bench_function("reduced", |b| b.iter(|| run(&paper)));
    group.bench_function("lagrange", |b| b.iter(|| run(&lagrange)));
    for name in ["paper-rough", "paper-refined", "backlash-0.6"] {
        let scene = preset(name);
        group.bench_function(name, |b| b.iter(|| run(&scene)));
    }
    group.finish();
}

/// One evaluation of all contact forces, for each contact loop.
fn contacts(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("contact-forces");
    for name in ["paper", "backlash-0.6", "paper-friction", "forty-pins"] {
        for kernel in [Kernel::Scalar, Kernel::Lanes] {
            let mut gearbox = Gearbox::new(&preset(name).clone().check().unwrap())
                .expect("presets can be modelled");
            gearbox.kernel = kernel;
            let mut field = gearbox.contact_field().expect("presets can be modelled");
            let mut bodies = gearbox.initial_states();
            // Twist every disc into contact: the free play and 0.3 mrad of load.
            let play = 17.003 * gearbox.scene.gear.backlash_m;
            for wheel in gearbox.layout.wheel_bodies() {
                bodies[wheel].angle += play + 3e-4;
            }
            let mut loads = vec![Wrench::default(); bodies.len()];
            group.bench_function(format!("{name}/{kernel:?}"), |b| {
                b.iter(|| {
                    loads.fill(Wrench::default());
                    field.add_loads(black_box(&bodies), &mut loads);
                    black_box(&loads);
                });
            });
            let mut moments = vec![0.0; bodies.len()];
            group.bench_function(format!("{name}/{kernel:?}/moments"), |b| {
                b.iter(|| {
                    let mut request = Evaluation::of_moments(&mut moments);
                    field.evaluate(black_box(&bodies), &mut request);
                });
            });
            let mut sum = 0.0;
            group.bench_function(format!("{name}/{kernel:?}/listed"), |b| {
                b.iter(|| {
                    field.touching(black_box(&bodies), &mut |pair| sum += pair.normal_force_n)
                });
            });
            group.bench_function(format!("{name}/{kernel:?}/energy"), |b| {
                b.iter(|| black_box(field.energy(black_box(&bodies))));
            });
            black_box(sum);
        }
    }
    group.finish();
}

/// The paper's gear with other numbers of discs and pins: the same teeth on a larger circle, about the same force in
/// every contact.
fn gear(wheels: usize, external: usize, internal: usize) -> Scene {
    let mut scene = Scene::paper();
    let growth = external as f64 / scene.gear.external_sleeves as f64;
    let gear = &mut scene.gear;
    (gear.wheels, gear.external_sleeves, gear.internal_sleeves) = (wheels, external, internal);
    gear.internal_circle_radius_m *= growth;
    for body in [&mut scene.mass.wheel, &mut scene.mass.output_shaft] {
        body.mass_kg *= growth * growth;
        body.moment_kg_m2 *= growth.powi(4);
    }
    scene.drive.output_torque_n_m *= growth * growth * wheels as f64 / 2.0;
    scene.solver.duration_s = 0.02;
    scene
}

/// 2000 steps of Heun's method over the size of the gear: cost grows linearly with discs times pins.
fn sizes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gear-size");
    group.sample_size(10);
    for (wheels, external, internal) in [
        (1, 12, 6),
        (2, 16, 8),
        (2, 40, 12),
        (2, 80, 20),
        (4, 200, 40),
    ] {
        let mut scene = gear(wheels, external, internal);
        for formulation in [Formulation::Reduced, Formulation::Lagrange] {
            scene.solver.formulation = formulation;
            let name = format!("{formulation:?}/{wheels} x ({external} + {internal})");
            group.bench_function(name, |b| b.iter(|| run(&scene)));
        }
    }
    group.finish();
}

/// One gear of a sweep: read, checked, built, and run by a method with step control.
fn batch(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gear-of-a-sweep");
    group.sample_size(20);
    let mut scene = preset("paper");
    scene.solver.tolerance = 8e-6;
    for method in ["etd-adams", "dopri5"] {
        method.clone_into(&mut scene.solver.integrator);
        let text = scene.to_toml();
        let read = || Scene::from_toml(&text, "paper", &[]).expect("it was written by us");
        group.bench_function(format!("{method}/set-up"), |b| {
            b.iter(|| black_box(Gearbox::new(&read()).expect("presets can be modelled")));
        });
        group.bench_function(format!("{method}/whole"), |b| b.iter(|| run(&read())));
    }
    group.finish();
}

criterion_group!(benches, runs, contacts, sizes, batch);
criterion_main!(benches);
