//! Refinement of a method until its run reaches the required accuracy.

use std::rc::Rc;

use pinwheel_gearbox::auto;
use pinwheel_gearbox::native;
use pinwheel_gearbox::resolve::{Best, Refinement, Search, holds};
use pinwheel_gearbox::{Distance, Gearbox};
use pinwheel_scene::Scene;
use pinwheel_timeseries::convergence::Method;

fn of(forces: f64, driver_torque: f64) -> Distance {
    Distance {
        forces,
        driver_torque,
        ..Distance::default()
    }
}

fn refinement(order: f64) -> Refinement {
    Refinement {
        method: Method::Tolerance { order: 0.5 },
        first: 10.0,
        order,
        cost: 0.2,
        factors: (10.0, 100.0),
        shared_error: 0.0,
    }
}

fn near(actual: f64, wanted: f64) -> bool {
    (actual / wanted - 1.0).abs() < 1e-12
}

/// Error and distance must be within the target; the distance may be four times that after a calm one.
#[test]
fn a_target_is_reached_by_error_and_distance() {
    let (small, large) = (of(1e-4, 1e-4), of(1e-4, 2e-3));
    assert!(holds(1e-3, small, small, None));
    assert!(!holds(1e-3, large, small, None));
    assert!(!holds(1e-3, small, large, None));
    assert!(!holds(1e-3, small, large, Some(of(0.02, 0.0))), "not calm");
    assert!(holds(1e-3, small, large, Some(of(0.009, 0.0))));
    assert!(!holds(1e-3, small, of(5e-3, 0.0), Some(small)));
    assert!(!holds(1e-3, of(f64::NAN, 0.0), small, None));
}

/// Each of the two series has an estimate from its own distances.
#[test]
fn errors_are_estimated_from_distances() {
    // 10^0.5 - 1 = 2.16.
    let first = refinement(1.0).error(of(1e-3, 2e-3), 10.0, None);
    let share = 1.25 / (10_f64.sqrt() - 1.0);
    assert!(near(first.forces, share * 1e-3) && near(first.driver_torque, share * 2e-3));
    // Distances that hardly fall, or rise, show no order: three times their sum.
    let before = Some((of(3e-3, 1.0), 10.0));
    let error = refinement(1.0).error(of(2e-3, 4.0), 10.0, before);
    assert!(near(error.forces, 3.0 * 5e-3), "{error:?}");
    assert!(near(error.driver_torque, 3.0 * 5.0), "{error:?}");
    // Runs that are equal by accident do not hide the previous distance: 1 over 100^(2/3) - 10^(2/3), times three.
    let equal = refinement(1.0).error(of(0.0, 0.0), 10.0, before);
    let loose = 3.0 / (100_f64.powf(2.0 / 3.0) - 10_f64.powf(2.0 / 3.0));
    assert!(near(equal.driver_torque, loose), "{equal:?}");
    // Torques that agree by accident are no more accurate than the forces.
    let close = refinement(1.0).error(of(1e-3, 1e-7), 10.0, None);
    assert_eq!(close.driver_torque, close.forces);
    // Never below a third of the distance.
    let steep = refinement(1.0).error(of(3e-3, 3e-3), 100.0, None);
    assert!(near(steep.forces, 1e-3));
}

/// The next refinement aims at a third of the target.
#[test]
fn refinements_aim_below_the_target() {
    let next = |error: f64| refinement(0.5).next(of(0.0, error), 1e-3);
    assert!(near(next(2e-3), 36.0));
    assert_eq!((next(1e-3), next(1.0)), (10.0, 100.0), "bounds");
    assert_eq!(next(f64::NAN), 100.0);
}

/// Friction lowers the gain from a tolerance for explicit methods only.
#[test]
fn refinements_know_friction() {
    let mut scene = Scene::paper();
    scene.contact.friction_coefficient = 0.1;
    let plans = auto::chain(&scene, auto::TARGET);
    let orders = |scene: &Scene| -> Vec<f64> {
        let of = |plan| Refinement::of(plan, scene).unwrap().order;
        plans.iter().map(of).collect()
    };
    // rodas5p, imex2-adaptive, dopri5, rk4, imex2.
    assert_eq!(orders(&scene), [0.9, 1.0, 0.45, 1.0, 1.0]);
    assert_eq!(orders(&Scene::paper()), [0.9, 1.0, 0.9, 1.0, 1.0]);
}

fn gearbox(changes: impl FnOnce(&mut Scene)) -> Gearbox {
    let mut scene = Scene::paper();
    (scene.solver.duration_s, scene.solver.sample_s) = (2e-3, 1e-4);
    changes(&mut scene);
    Gearbox::new(&scene.check().unwrap()).unwrap()
}

fn search(gearbox: &Gearbox, target: f64, left: u64) -> Search<'_> {
    Search {
        gearbox,
        target,
        left,
        levels: Vec::new(),
        best: None,
        stopped: None,
        diverged: None,
    }
}

/// Refines `name`; returns whether the search ended, and the search with its reason.
fn refine<'a>(gearbox: &'a Gearbox, target: f64, left: u64, name: &str) -> (bool, Search<'a>) {
    let plans = auto::chain(&gearbox.scene, target);
    let plan = plans.iter().find(|plan| plan.integrator == name).unwrap();
    let mut search = search(gearbox, target, left);
    let end = search.refine(plan, &mut |_| false).unwrap();
    (end, search)
}

/// More load than the teeth carry: three refinements diverge, then the next method is tried.
#[test]
fn a_method_that_fails_gives_way() {
    let overload = gearbox(|scene| {
        scene.drive.output_torque_n_m = 1e6;
        scene.drive.load_ramp_s = 0.0;
    });
    let (end, refined) = refine(&overload, 1e-3, u64::MAX, "rk4");
    assert!(!end && refined.best.is_none() && refined.diverged.is_some());
    let stopped = refined.stopped.unwrap();
    assert!(stopped.contains("rk4 fails on it"), "{stopped}");
    let settings: Vec<&str> = refined.levels.iter().map(|r| r.setting.as_str()).collect();
    assert_eq!(settings.len(), 3, "{settings:?}");
    assert!(settings[0] != settings[1] && settings[1] != settings[2]);
    // A budget exhausted within the first run ends the search.
    let long = gearbox(|scene| scene.solver.duration_s = 0.05);
    let (end, refined) = refine(&long, 1e-3, 10, "rk4");
    assert!(end && refined.left == 0);
    let stopped = refined.stopped.unwrap();
    assert!(stopped.contains("took all evaluations"), "{stopped}");
}

/// A second run beyond the budget is not started; the first one had half of the samples.
#[test]
fn what_does_not_fit_the_budget_is_not_begun() {
    let light = gearbox(|_| {});
    let all = refine(&light, 1e-3, u64::MAX, "etd-adams").1;
    let one = all.levels[0].evaluations;
    assert!(all.levels[1].evaluations > one, "{:?}", all.levels);
    let (end, refined) = refine(&light, 1e-3, 2 * one, "etd-adams");
    let stopped = refined.stopped.unwrap();
    assert!(end && stopped.contains("would take more"), "{stopped}");
    assert_eq!((refined.levels.len(), refined.left), (1, one));
    let samples = light.scene.solver.sample_times_s().len();
    let best = refined.best.unwrap();
    assert_eq!(best.run.time_series.len(), samples / 2 + 1);
    let best = all.best.unwrap();
    assert!(best.holds && best.level == all.levels.len() - 1);
    assert_eq!(best.run.time_series.len(), samples);
}

/// Refinement ends at the tightest tolerance, and the reason does not blame the method.
#[test]
fn the_finest_tolerance_ends_a_refinement() {
    let light = gearbox(|scene| (scene.solver.duration_s, scene.solver.sample_s) = (1e-4, 1e-5));
    let (end, refined) = refine(&light, 1e-17, u64::MAX, "dopri5");
    let stopped = refined.stopped.unwrap();
    assert!(end && stopped.contains("amplifies roundings"), "{stopped}");
    assert!(!refined.best.unwrap().holds);
}

/// The run with the smallest error is kept, not the last one.
#[test]
fn the_best_run_is_kept() {
    let light = gearbox(|scene| scene.solver.duration_s = 1e-4);
    let run = Rc::new(
        native::run(&light, &mut |_| false)
            .unwrap()
            .finished()
            .unwrap(),
    );
    let mut search = search(&light, 1e-3, 0);
    for (level, error) in [
        None,
        Some(of(2e-3, 0.0)),
        Some(of(1e-3, 0.0)),
        Some(of(3e-3, 0.0)),
    ]
    .into_iter()
    .enumerate()
    {
        search.keep(Best {
            run: Rc::clone(&run),
            sparse: None,
            level,
            error,
            ladder: None,
            holds: false,
        });
    }
    assert_eq!(search.best.unwrap().level, 2);
}
