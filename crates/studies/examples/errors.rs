//! Error against step of one scene: `errors SCENE "key=value;..." REF_INTEGRATOR REF_STEP INTEGRATOR STEP...`
#![allow(clippy::print_stdout, reason = "a program that prints its table")]

use pinwheel_courses::norms::{Distance, Least};
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_scene::{Override, Scene};

fn run(args: &[String], integrator: &str, step: &str) -> Option<native::NativeRun> {
    let mut sets: Vec<Override> = args[1]
        .split(';')
        .filter(|s| !s.is_empty())
        .filter_map(|s| s.parse().ok())
        .collect();
    sets.push(Override::new(
        "solver.integrator",
        format!("\"{integrator}\""),
    ));
    let key = if integrator.contains("adaptive") || integrator.contains("dopri") {
        "solver.tolerance"
    } else {
        "solver.step_s"
    };
    sets.push(Override::new(key, step));
    let scene = Scene::load(&args[0], &sets)
        .inspect_err(|e| println!("{e}"))
        .ok()?;
    let gearbox = Gearbox::new(&scene).ok()?;
    match native::run(&gearbox, &mut |_| false) {
        Ok(run) => Some(run),
        Err(error) => {
            println!("{integrator} {step}: {error}");
            None
        }
    }
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let clock = std::time::Instant::now();
    let Some(reference) = run(&args, &args[2], &args[3]) else {
        return;
    };
    println!(
        "reference {} {} in {:.1} s",
        args[2],
        args[3],
        clock.elapsed().as_secs_f64()
    );
    let mut last: Option<(f64, f64, f64)> = None;
    for step in &args[5..] {
        let clock = std::time::Instant::now();
        let Some(found) = run(&args, &args[4], step) else {
            continue;
        };
        let wall = clock.elapsed().as_secs_f64();
        let d = Distance::between(&found.courses, &reference.courses, Least::default());
        let h: f64 = step.parse().unwrap_or(f64::NAN);
        let order = last.map(|(h0, f, t)| {
            (
                (f / d.forces).ln() / (h0 / h).ln(),
                (t / d.driver_torque).ln() / (h0 / h).ln(),
            )
        });
        println!(
            "{} {step}: forces {:.3e} torque {:.3e} order {order:.2?} evaluations {} steps {} rejected {} wall {wall:.3} s, {:.2} us/step",
            args[4],
            d.forces,
            d.driver_torque,
            found.counts.evaluations,
            found.counts.steps,
            found.counts.rejected,
            wall / found.counts.steps as f64 * 1e6
        );
        last = Some((h, d.forces, d.driver_torque));
    }
}
