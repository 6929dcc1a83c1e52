//! Self-verifying runs on scenes that once gave wrong results without a warning.

use std::time::Duration;

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::auto::{self, TARGET};
use pinwheel_gearbox::native::{self, NativeError, NativeRun};
use pinwheel_gearbox::resolve::{BUDGET, Uncertainty, Verdict, remedy, roughness, run_resolved};
use pinwheel_scene::{BodyMass, Override, Scene};
use pinwheel_timeseries::Ending;
use pinwheel_timeseries::convergence::Rough;

fn scene(name: &str, sets: &[&str]) -> Scene {
    let sets: Vec<Override> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Scene::load(name, &sets).unwrap().into_scene()
}

fn resolved(scene: &Scene) -> (NativeRun, Uncertainty) {
    let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
    run_resolved(&gearbox, TARGET, BUDGET, &mut |_| false).unwrap()
}

fn named(scene: &Scene, integrator: &str, tolerance: f64) -> NativeRun {
    let mut scene = scene.clone();
    integrator.clone_into(&mut scene.solver.integrator);
    scene.solver.tolerance = tolerance;
    native::run(
        &Gearbox::new(&scene.clone().check().unwrap()).unwrap(),
        &mut |_| false,
    )
    .unwrap()
    .finished()
    .unwrap()
}

/// Returns the true error of `auto`, against another method at another tolerance.
fn error(scene: &Scene, integrator: &str, tolerance: f64) -> (f64, Uncertainty) {
    let (run, uncertainty) = resolved(scene);
    let truth = named(scene, integrator, tolerance);
    let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
    let off = gearbox.distance(&run.time_series, &truth.time_series);
    (off.worst(), uncertainty)
}

/// Light friction on stiff contacts: a step chosen for the spins alone leaves an error of 78 % in the forces.
#[test]
fn regress_friction_does_not_hide_stiff_contacts() {
    let sets = [
        "contact.stiffness_multiplier=0.3",
        "contact.friction_coefficient=0.01",
        "solver.duration_s=0.03",
    ];
    let (error, uncertainty) = error(&scene("paper", &sets), "dopri5", 1e-8);
    assert!(uncertainty.is_resolved(), "{}", uncertainty.sentence());
    assert!(error <= TARGET, "{error:e}: {}", uncertainty.sentence());
}

/// A step chosen for the spins alone diverged here.
#[test]
fn regress_steel_with_line_contact_and_friction_is_resolved() {
    let sets = [
        "contact.law=\"line-contact\"",
        "contact.friction_coefficient=0.05",
        "solver.duration_s=0.005",
    ];
    let (error, uncertainty) = error(&scene("steel", &sets), "dopri5", 1e-8);
    assert!(uncertainty.is_resolved(), "{}", uncertainty.sentence());
    assert!(error <= TARGET, "{error:e}: {}", uncertainty.sentence());
}

/// Returns a scene with lengths, masses and times in other units: forces scale by m l/t^2.
fn similar(scene: &Scene, length: f64, mass: f64, time: f64) -> Scene {
    let mut scaled = scene.clone();
    let (force, speed) = (mass * length / (time * time), length / time);
    let gear = &mut scaled.gear;
    for value in [
        &mut gear.eccentricity_m,
        &mut gear.external_sleeve_radius_m,
        &mut gear.internal_sleeve_radius_m,
        &mut gear.internal_circle_radius_m,
        &mut gear.hole_radius_m,
        &mut gear.backlash_m,
        &mut scaled.contact.ramp_m,
    ] {
        *value *= length;
    }
    let of_body = |body: &mut BodyMass| {
        body.mass_kg *= mass;
        body.moment_kg_m2 *= mass * length * length;
    };
    let masses = &mut scaled.mass;
    of_body(&mut masses.input_shaft);
    of_body(&mut masses.output_shaft);
    of_body(&mut masses.wheel);
    of_body(&mut masses.internal_sleeve);
    of_body(&mut masses.external_sleeve);
    scaled.drive.input_speed_rad_s /= time;
    scaled.drive.output_torque_n_m *= force * length;
    scaled.drive.load_ramp_s *= time;
    let contact = &mut scaled.contact;
    contact.young_pa *= force / (length * length);
    contact.damping_n_s_m *= force / speed;
    contact.friction_ramp_m_s *= speed;
    let solver = &mut scaled.solver;
    for value in [
        &mut solver.step_s,
        &mut solver.duration_s,
        &mut solver.sample_s,
    ] {
        *value *= time;
    }
    scaled.clone().check().unwrap();
    scaled
}

/// A gear of a few millimetres under a fraction of a millinewton metre is as accurate as a similar gear of ordinary size: no
/// limit is in newtons or seconds. Factors are powers of two, so that only roundings of powers differ.
#[test]
fn regress_results_do_not_depend_on_the_size() {
    for (preset, sets) in [
        ("paper", vec!["solver.duration_s=0.01"]),
        (
            "backlash-0.6",
            vec![
                "solver.duration_s=0.01",
                "contact.friction_coefficient=0.05",
            ],
        ),
        (
            "paper",
            vec!["solver.duration_s=0.01", "drive.output_torque_n_m=0"],
        ),
    ] {
        let counted = ["output.channels=[\"*_contact_ratio_*\"]"];
        let ordinary = scene(preset, &[sets.as_slice(), &counted].concat());
        let (length, mass, time) = (1.0 / 16.0, 1.0 / 4096.0, 1.0 / 4.0);
        let small = similar(&ordinary, length, mass, time);
        let ((one, a), (other, b)) = (resolved(&ordinary), resolved(&small));
        assert_eq!(one.counts, other.counts, "{preset}: the same steps");
        let (of_a, of_b) = (a.error.unwrap(), b.error.unwrap());
        assert!(
            (of_a.worst() - of_b.worst()).abs() <= 1e-3 * of_a.worst() + 1e-11,
            "{preset}: {of_a:?} {of_b:?}"
        );
        let force = mass * length / (time * time);
        let (x, y) = (
            one.time_series.group("external_sleeve_force_n"),
            other.time_series.group("external_sleeve_force_n"),
        );
        let most = x
            .iter()
            .flat_map(|c| c.iter())
            .fold(1e-9, |m: f64, &v| m.max(v));
        for (x, y) in x.iter().zip(&y) {
            for (x, y) in x.iter().zip(*y) {
                assert!((x - y / force).abs() <= 1e-9 * most, "{preset}: {x} {y}");
            }
        }
        for ratio in ["external_contact_ratio", "internal_contact_ratio"] {
            let (x, y) = (one.time_series.group(ratio), other.time_series.group(ratio));
            assert!(!x.is_empty() && x == y, "{preset}: as many press: {ratio}");
        }
    }
}

/// A 5 mm gear whose millinewton forces were once below a floor of 1 N: Heun at a step twice too long is detected.
#[test]
fn regress_small_forces_are_judged_too() {
    let ordinary = scene("paper", &["solver.duration_s=0.01"]);
    let small = similar(&ordinary, 1.0 / 16.0, 1.0 / 4096.0, 1.0);
    let gearbox = Gearbox::new(&small.clone().check().unwrap()).unwrap();
    let run = |step_s: f64| {
        let gearbox = gearbox
            .with_solver(|solver| solver.step_s = step_s)
            .unwrap();
        native::run(&gearbox, &mut |_| false)
            .unwrap()
            .finished()
            .unwrap()
            .time_series
    };
    let (coarse, fine) = (run(5e-5), run(5e-6));
    let peak = fine.group("external_sleeve_force_n").concat();
    assert!(peak.iter().all(|&force| force < 1.0), "below the old floor");
    let off = gearbox.distance(&coarse, &fine).forces;
    assert!(off > 0.05, "{off}");
}

/// Verification of an easy scene costs less than another run, and the paper's run needs no refinement.
#[test]
fn easy_scenes_are_verified_at_less_than_twice_the_cost() {
    for name in ["paper", "paper-2019", "forty-pins", "eleven-pins"] {
        let (_, uncertainty) = resolved(&scene(name, &["solver.duration_s=0.1"]));
        assert!(uncertainty.is_resolved(), "{}", uncertainty.sentence());
        println!("{name}: {}", uncertainty.sentence());
        assert!(uncertainty.cost() <= 1.75, "{name}: {}", uncertainty.cost());
    }
}

/// An insufficient budget is reported with the accuracy reached.
#[test]
fn bad_input_a_budget_too_small_is_reported() {
    let scene = scene("paper", &["solver.duration_s=0.02"]);
    let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
    // Sufficient for the first run of 1e-7 and not for the second.
    let budget = named(&scene, "etd-adams", 5e-10).counts.evaluations * 6 / 5;
    let outcome = run_resolved(&gearbox, 1e-7, budget, &mut |_| false);
    let Ok((run, uncertainty)) = outcome else {
        panic!("one run fits the budget");
    };
    // The coarsest run had only half of the samples.
    assert_eq!(run.time_series.time_s(), scene.solver.sample_times_s());
    let Verdict::NotResolved { reason, .. } = &uncertainty.verdict else {
        panic!("{}", uncertainty.sentence());
    };
    assert!(reason.contains("budget"), "{reason}");
    assert!(uncertainty.sentence().contains("Not resolved"));
}

/// Nearly massless pins, on which explicit methods never finish: the chain begins with a method that does.
#[test]
fn hard_auto_ends_where_one_method_does() {
    for name in [
        "hard-feather-sleeves",
        "hard-all-open",
        "hard-steel",
        "hard-zero-load-friction",
    ] {
        let scene = scene(name, &["solver.duration_s=0.005"]);
        let (run, uncertainty) = resolved(&scene);
        println!("{name}: {}", uncertainty.sentence());
        assert!(
            uncertainty.is_resolved(),
            "{name}: {}",
            uncertainty.sentence()
        );
        assert!((run.end_s - 0.005).abs() < 1e-3);
    }
}

#[test]
fn remedies_are_tried_before_they_are_offered() {
    let steel = scene("steel", &["solver.duration_s=0.01"]);
    let failed = native::run(
        &Gearbox::new(&steel.clone().check().unwrap()).unwrap(),
        &mut |_| false,
    );
    assert!(matches!(failed.unwrap().ending, Ending::Diverged { .. }));
    let advice =
        remedy(&steel.clone().check().unwrap(), Duration::from_secs(60)).expect("auto resolves it");
    assert!(advice.contains("solver.integrator = \"auto\""));
    assert!(
        remedy(&steel.clone().check().unwrap(), Duration::ZERO).is_none(),
        "no time to try"
    );
    let auto = scene("steel", &["solver.integrator=auto"]);
    assert!(remedy(&auto.clone().check().unwrap(), Duration::from_secs(60)).is_none());
}

#[test]
fn stopping_is_heard() {
    let gearbox = Gearbox::new(&scene("paper", &[]).clone().check().unwrap()).unwrap();
    let outcome = run_resolved(&gearbox, TARGET, BUDGET, &mut |t| t > 1e-3);
    assert!(matches!(outcome, Err(NativeError::Stopped)));
    assert_eq!(
        auto::chain(&gearbox.scene, TARGET)[0].integrator,
        "etd-adams"
    );
}

/// Damping with a ramp jumps, in contacts and in bearings with clearance; that of hysteresis laws grows with the penetration.
#[test]
fn what_is_not_smooth_is_known() {
    let of = |sets: &[&str]| roughness(&scene("paper", sets));
    let undamped = "contact.damping_n_s_m=0";
    assert_eq!(of(&[]), Rough::Jumps);
    assert_eq!(of(&[undamped]), Rough::Kinks);
    assert_eq!(of(&["contact.law=hunt-crossley"]), Rough::Kinks);
    let bearing = "bearings.eccentric.stiffness_n_m=1e8";
    assert_eq!(of(&[undamped, bearing]), Rough::Kinks);
    let clearance = "bearings.eccentric.clearance_m=1e-6";
    assert_eq!(of(&[undamped, bearing, clearance]), Rough::Jumps);
    assert_eq!(of(&["contact.detection=points"]), Rough::Points);
    assert_eq!(of(&["contact.friction_coefficient=0.1"]), Rough::Friction);
}
