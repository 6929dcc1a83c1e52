//! What native-resolved aims at holds, whatever step, method and tolerance the scene itself names.

use pinwheel_engines::{Control, Engine, Native, Run};
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_scene::{Override, Scene};

fn gearbox(preset: &str, sets: &[&str]) -> Gearbox {
    let sets: Vec<Override> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Gearbox::new(&Scene::load(preset, &sets).unwrap()).unwrap()
}

fn resolved(gearbox: &Gearbox) -> Run {
    let run = Native::RESOLVED.prepare(gearbox).unwrap();
    run(&Control::quiet()).unwrap()
}

/// Its forces and driver torque are as exact as the engine's description says: 1e-7, with friction or points 1e-5. The
/// truth is the other adaptive method at a tolerance that neither takes. Measured: 1e-9 on `paper`, 3e-9 on `paper-friction`.
#[test]
fn hard_native_resolved_keeps_to_its_target_at_any_step_of_the_scene() {
    const SHORT: &str = "solver.duration_s=0.003";
    for (preset, target, truth) in [
        ("paper", 1e-7, "solver.integrator=dop853"),
        ("paper-friction", 1e-5, "solver.integrator=dopri5"),
    ] {
        let exact = gearbox(preset, &[SHORT, truth, "solver.tolerance=1e-12"]);
        let exact = native::run(&exact, &mut |_| false)
            .unwrap()
            .whole()
            .unwrap()
            .time_series;
        let mut runs = ["solver.step_s=1e-5", "solver.step_s=5e-5"].map(|step| {
            let gearbox = gearbox(preset, &[SHORT, step]);
            let run = resolved(&gearbox);
            let known = run.uncertainty.as_ref().unwrap();
            assert_eq!(known.target, target, "{preset}");
            assert!(known.is_resolved(), "{preset}: {}", known.sentence());
            let off = gearbox.distance(&run.time_series, &exact).worst();
            println!("{preset}, {step}: {off:.1e}, {}", known.sentence());
            assert!(off <= target, "{preset}, {step}: {off:e}");
            run
        });
        let [fine, coarse] = &mut runs;
        assert_eq!(
            fine.time_series, coarse.time_series,
            "{preset}: not of its step"
        );
    }
}
