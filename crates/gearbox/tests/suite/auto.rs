//! Plans of `integrator = "auto"`.

use pinwheel_gearbox::auto::{AUTO, Plan, TARGET, chain, integrator, plan};
use pinwheel_gearbox::{Frequencies, Gearbox};
use pinwheel_scene::{Detection, Formulation, FrictionLaw, Scene};

/// Name of the method for gears without friction.
const EXPONENTIAL: &str = "etd-adams";

#[test]
fn auto_follows_what_the_scene_holds() {
    let mut scene = Scene::paper();
    assert_eq!(integrator(&scene).0, "rk2", "named");
    scene.solver.integrator = AUTO.to_owned();
    assert_eq!(integrator(&scene).0, EXPONENTIAL);
    let names: Vec<&str> = chain(&scene, TARGET)
        .iter()
        .map(|plan| plan.integrator)
        .collect();
    assert_eq!(names, [EXPONENTIAL, "dopri5", "rk4"]);
    scene.solver.formulation = Formulation::Lagrange;
    assert_eq!(integrator(&scene).0, "dopri5", "no Jacobian");
    scene.solver.formulation = Formulation::Reduced;
    scene.contact.detection = Detection::Points;
    assert_eq!(integrator(&scene).0, "rk4");
    scene.contact.friction_coefficient = 0.1;
    assert_eq!(integrator(&scene).0, "imex2", "points");
    scene.contact.detection = Detection::Exact;
    assert_eq!(integrator(&scene).0, "rodas5p");
    // Without a Jacobian in closed form a Rosenbrock step is expensive.
    scene.solver.formulation = Formulation::Lagrange;
    assert_eq!(integrator(&scene).0, "imex2-adaptive");
    scene.solver.formulation = Formulation::Reduced;
    scene.contact.law = "paper-conservative".to_owned();
    assert_eq!(integrator(&scene).0, "rodas5p");
    // Slow friction, and an accuracy that is expensive for an implicit method of order two.
    assert_eq!(plan(&scene, 1e-7).integrator, "dopri5");
    scene.contact.friction_ramp_m_s = 1e-3;
    assert_eq!(integrator(&scene).0, "dopri5");
    scene.contact.friction_ramp_m_s = 5e-5;
    scene.contact.friction_law = FrictionLaw::Adams;
    assert_eq!(integrator(&scene).0, "dopri5");
    let chain = chain(&scene, TARGET);
    assert!(
        chain
            .iter()
            .all(|plan| !plan.integrator.starts_with("imex"))
    );
}

/// The paper's step follows from its frequencies alone; ten times the stiffness shortens the step by the cube root of ten, and
/// the scene's own step is not used.
#[test]
fn steps_come_from_the_scenes_frequencies() {
    let mut scene = Scene::paper();
    let paper = plan(&scene, TARGET);
    assert!((paper.step_s / 1e-5 - 1.0).abs() < 0.3, "{}", paper.step_s);
    let frequencies = Frequencies::of(&scene);
    // Two runs by it must not take equal steps, which end at samples and at entries of the account.
    let taken = (scene.solver.sample_s / (10.0 * paper.step_s)).ceil();
    let longest = (1.25 * frequencies.longest_step_s()).min(scene.solver.sample_s / taken);
    assert!((paper.longest_step_s / longest - 1.0).abs() < 1e-12);
    let (samples, radians) = (
        scene.solver.duration_s / scene.solver.sample_s,
        scene.solver.duration_s * frequencies.contact_rad_s,
    );
    let counted = [samples.max(radians / 1.25), samples + 6.0 * radians];
    for count in counted {
        assert!(
            paper.reason.contains(&format!("{count:.0e}")),
            "{}",
            paper.reason
        );
    }
    assert!((paper.tolerance / 5e-7 - 1.0).abs() < 1e-12);
    // Nine entries of the account between samples, at which steps end, too.
    let mut sparse = scene.clone();
    sparse.solver.sample_s = 1e-3;
    let longest = plan(&sparse, TARGET).longest_step_s;
    assert!((longest * 9.0 / 1e-3 - 1.0).abs() < 1e-12, "{longest}");
    scene.contact.stiffness_multiplier *= 10.0;
    scene.solver.step_s = 1e-3;
    let stiff = plan(&scene, TARGET);
    assert!((paper.step_s / stiff.step_s / 10.0_f64.cbrt() - 1.0).abs() < 1e-9);
    // Pins that pass faster than contacts oscillate limit the steps.
    scene.drive.input_speed_rad_s = 1e4;
    let fast = plan(&scene, TARGET);
    assert_eq!(
        fast.longest_step_s,
        1.25 * Frequencies::of(&scene).longest_step_s()
    );
}

/// Methods to try, the best first, without those that the forces exclude.
#[test]
fn chains_leave_out_what_cannot_work() {
    let names = |detection, law| -> Vec<&'static str> {
        let mut scene = Scene::paper();
        scene.contact.friction_coefficient = 0.1;
        (scene.contact.detection, scene.contact.friction_law) = (detection, law);
        let plans = chain(&scene, TARGET);
        plans.iter().map(|plan| plan.integrator).collect()
    };
    let (exact, points) = (Detection::Exact, Detection::Points);
    assert_eq!(
        names(exact, FrictionLaw::Regularised),
        ["rodas5p", "imex2-adaptive", "dopri5", "rk4", "imex2"]
    );
    assert_eq!(names(exact, FrictionLaw::Adams), ["dopri5", "rk4"]);
    assert_eq!(names(points, FrictionLaw::Regularised), ["imex2", "rk4"]);
}

/// A target determines the settings of each method: tolerances in proportion, fixed steps by its root.
#[test]
fn settings_follow_the_promise() {
    let mut scene = Scene::paper();
    let of = |scene: &Scene, target: f64| {
        let plans = chain(scene, target);
        move |name: &str| plans.iter().find(|p| p.integrator == name).unwrap().clone()
    };
    let near = |actual: f64, wanted: f64| (actual / wanted - 1.0).abs() < 1e-12;
    let contact = Frequencies::of(&scene).contact_rad_s;
    assert!(near(of(&scene, 1e-3)("rk4").step_s, 0.1 / contact));
    assert!(near(of(&scene, 1e-5)("rk4").step_s, 0.01 / contact));
    assert!(near(of(&scene, 1e-5)("dopri5").tolerance, 5e-9));
    // A law ten times stiffer than Hertz' twists less, so the scale of errors is smaller.
    scene.contact.law = "constant".to_owned();
    scene.contact.constant_stiffness_n_m15 = 1e12;
    let share = Frequencies::depth_share(&scene);
    assert!(share < 0.5, "{share}");
    for name in [EXPONENTIAL, "dopri5"] {
        assert!(near(of(&scene, 1e-3)(name).tolerance, share * 5e-7));
    }
    scene.contact.constant_stiffness_n_m15 = 1e4;
    assert!(near(of(&scene, 1e-3)("dopri5").tolerance, 5e-7));
    scene.contact.friction_coefficient = 0.1;
    scene.contact.friction_ramp_m_s = 5e-5;
    assert!(near(of(&scene, 1e-3)("dopri5").tolerance, 1e-7));
    assert!(near(of(&scene, 1e-3)("imex2-adaptive").tolerance, 5e-5));
    let mut scene = Scene::paper();
    scene.contact.friction_coefficient = 0.1;
    // With a looser tolerance it jumps over the friction's ramp.
    assert!(near(of(&scene, 1e-3)("rodas5p").tolerance, 2.5e-6));
    assert!(near(of(&scene, 1e-5)("rodas5p").tolerance, 2e-7));
}

/// A plan twice as fine has half the setting, and a longest step reduced by the method's order.
#[test]
fn finer_plans_take_shorter_steps() {
    let plan = |integrator| Plan {
        integrator,
        step_s: 1.0,
        tolerance: 1e-6,
        longest_step_s: 1.0,
        reason: String::new(),
    };
    let near = |actual: f64, wanted: f64| (actual / wanted - 1.0).abs() < 1e-12;
    for (name, factor, longest) in [
        ("dopri5", 32.0, 0.5),
        ("imex2-adaptive", 4.0, 0.5),
        (EXPONENTIAL, 10.0, 0.5),
        ("dopri5", 1.0 / 32.0, 2.0),
        // The range of tolerances limits the steps, too.
        ("imex2-adaptive", 1e20, 1e-3_f64.sqrt() * 1e-2),
        ("imex2-adaptive", 1e-20, 100.0),
    ] {
        let finer = plan(name).finer(factor);
        let tolerance = (1e-6 / factor).clamp(1e-13, 1e-2);
        assert!(near(finer.tolerance, tolerance), "{name} {factor}");
        assert!(near(finer.longest_step_s, longest), "{name} {finer:?}");
        assert_eq!(finer.step_s, 1.0);
        assert!(finer.setting().contains("tolerance"), "{name}");
    }
    let finer = plan("rk4").finer(4.0);
    assert_eq!((finer.step_s, finer.tolerance), (0.25, 1e-6));
    assert_eq!(finer.setting(), "a step of 2.50e-1 s");
}

/// A method whose steps end at samples gets half as many samples in the coarser run, so that the runs take different steps.
#[test]
fn the_coarser_run_sees_half_as_much() {
    let mut scene = Scene::paper();
    (scene.solver.duration_s, scene.solver.sample_s) = (4e-3, 1e-3);
    let gearbox = Gearbox::new(&scene.check().unwrap()).unwrap();
    let plan = Plan {
        integrator: EXPONENTIAL,
        step_s: 1e-5,
        tolerance: 1e-6,
        longest_step_s: 1.0,
        reason: String::new(),
    };
    let sparse = |plan: &Plan, duration_s: f64| {
        let changed = gearbox.with_solver(|solver| solver.duration_s = duration_s);
        let applied = plan.applied_sparsely(&changed.unwrap()).unwrap();
        (applied.scene.solver.step_s, applied.scene.solver.sample_s)
    };
    assert_eq!(sparse(&plan, 4e-3), (2e-5, 2e-3));
    // Half of less than four samples would be too few.
    assert_eq!(sparse(&plan, 3.9e-3), (2e-5, 1e-3));
    let explicit = Plan {
        integrator: "dopri5",
        ..plan
    };
    assert_eq!(sparse(&explicit, 4e-3), (1e-5, 1e-3));
}
