//! Which stage differs, and why: solvers with one fault each, and right ones.

#![allow(clippy::print_stdout, reason = "measured figures")]

use pinwheel_engines::{
    Control, Engine, EngineInfo, Halt, Prepared, Refinement, Run, RunStats, SharedModel, by_name,
};
use pinwheel_faults::{Armed, Fault};
use pinwheel_gearbox::channels::{LawPairs, Seen};
use pinwheel_gearbox::internals::GearForces;
use pinwheel_gearbox::{Frequencies, Gearbox, Recorder, native};
use pinwheel_mbs::Detail;
use pinwheel_mbs::integrators::{Segments, StepSettings, Stepper as _};
use pinwheel_mbs::{Formulation as _, Mechanism, OdeSystem as _, Reduced};
use pinwheel_scene::{CheckedScene, Scene, load_profile};
use pinwheel_studies::stages::{Located, Stage, of_engine};
use pinwheel_timeseries::TimeSeries;

use crate::gears::gear;

/// A solver of the reduced form by Runge-Kutta 4, with faults.
struct Solver {
    /// Method and the order that it states.
    method: (&'static str, f64),
    /// Fault of native parts.
    fault: Option<Fault>,
    /// Keys of its scene that are not those it was given.
    scene: fn(&mut Scene),
    /// Bodies that are not the gear's.
    mass: fn(&mut Mechanism),
    /// Factor on each column, by its number after the time.
    column: fn(usize) -> f64,
    /// Heun's method whose second stage is the first again.
    stale: bool,
    /// Its step for the one asked for.
    longer: f64,
}

const RIGHT: Solver = Solver {
    method: ("rk4", 4.0),
    fault: None,
    scene: |_| {},
    mass: |_| {},
    column: |_| 1.0,
    stale: false,
    longer: 1.0,
};

impl Engine for Solver {
    fn info(&self) -> EngineInfo<'_> {
        EngineInfo {
            refinement: Some(Refinement::step(self.method.1)),
            ..EngineInfo::own("mine", SharedModel::SharedLaw)
        }
    }

    fn version(&self) -> String {
        "1".into()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        let gearbox = gearbox.clone();
        Ok(Box::new(
            move |_: &Control<'_>| Ok(self.integrate(&gearbox)),
        ))
    }
}

impl Solver {
    fn integrate(&self, gearbox: &Gearbox) -> Run {
        let _armed = self.fault.map(Armed::with);
        let own = Gearbox::new(&gearbox.scene.changed(self.scene).unwrap()).unwrap();
        let mut mechanism = own.mechanism();
        // Whatever it takes the gear for, it starts as the scene says.
        for (body, right) in mechanism.bodies.iter_mut().zip(gearbox.initial_states()) {
            body.start = right;
        }
        (self.mass)(&mut mechanism);
        let mut system = native::reduced(&own, mechanism, GearForces::new(&own).unwrap()).unwrap();
        let mut field = own.contact_field().unwrap();
        let mut recorder = Recorder::new(gearbox);
        let mut y = system.initial();
        let step = self.longer * gearbox.scene.solver.step_s;
        let settings = StepSettings {
            step,
            tolerance: 1e-9,
        };
        let breaks = load_profile::breaks(&own.scene.drive);
        let mut stepper = Segments::start(self.method.0, settings, 0.0, &y, &breaks).unwrap();
        let mut before = 0.0;
        for t in gearbox.scene.solver.sample_times_s() {
            if self.stale {
                let steps = ((t - before) / step * (1.0 - 1e-9)).ceil().max(1.0);
                let h = (t - before) / steps;
                for k in 0..steps as usize {
                    stale_heun(&mut system, before + k as f64 * h, h, &mut y);
                }
            } else {
                while stepper.time() < t - 1e-9 * step {
                    stepper.step(&mut system).unwrap();
                    stepper.enter(&mut system);
                }
                stepper.interpolate(&mut system, t, &mut y);
            }
            before = t;
            let seen = system.observe(t, &y, Detail::Everything);
            recorder.record_observed(&seen, [seen.driver_torques[0], own.load_torque(t)]);
            recorder.record_channels(&mut Seen {
                bodies: seen.bodies,
                driver_torque_n_m: seen.driver_torques[0],
                reactions: None,
                contacts: &mut LawPairs(&mut field),
            });
        }
        Run::new(
            self.written(&recorder.finish().unwrap()),
            RunStats::default(),
        )
    }

    fn written(&self, right: &TimeSeries) -> TimeSeries {
        let mut written = TimeSeries::new(right.time_s().to_vec()).unwrap();
        for (k, channel) in right.channels().iter().enumerate() {
            let values = channel.values.iter().map(|value| value * (self.column)(k));
            written
                .push(channel.name.clone(), values.collect())
                .unwrap();
        }
        written
    }
}

fn stale_heun(system: &mut Reduced<GearForces>, t: f64, h: f64, y: &mut [f64]) {
    let mut slope = vec![0.0; y.len()];
    system.derivative(t, y, &mut slope);
    y.iter_mut()
        .zip(&slope)
        .for_each(|(y, slope)| *y += h * slope);
}

fn scene(preset: &str, sets: &[&str]) -> CheckedScene {
    let sets: Vec<_> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Scene::load(preset, &sets).unwrap()
}

fn located(engine: &dyn Engine, scene: &CheckedScene, until_s: f64) -> Option<Located> {
    let gearbox = Gearbox::new(scene).unwrap();
    let begun = std::time::Instant::now();
    let found = of_engine(engine, &gearbox, until_s, &Control::quiet()).unwrap()?;
    let took = begun.elapsed().as_secs_f64();
    println!(
        "{} {}: {} ({took:.2} s)",
        scene.name,
        engine.name(),
        found.sentence()
    );
    for judged in &found.stages {
        println!(
            "    {:15} {:?} bound {:.1e} {}",
            judged.stage.name(),
            judged.residual,
            judged.bound,
            judged.note
        );
    }
    Some(found)
}

/// A fault: what it does, the stage and the cause that are to be named, and the cause's size within a tolerance.
type Row = (&'static str, Solver, Stage, &'static str, f64, f64);

fn holds(rows: Vec<Row>, scene: &CheckedScene, until_s: f64) {
    for (name, solver, stage, word, size, within) in rows {
        println!("{name}:");
        let found = located(&solver, scene, until_s).unwrap();
        assert_eq!(found.first(), Some(stage), "{name}: {}", found.sentence());
        let cause = found.cause.as_ref();
        assert_eq!(cause.map_or("", |cause| cause.word), word, "{name}");
        if let Some(cause) = cause {
            assert!(
                (cause.size - size).abs() <= within,
                "{name}: {}",
                cause.size
            );
        }
    }
}

/// Sizes are those of the faults; tolerances ten times what was measured.
#[test]
fn names_faults() {
    use Stage::{Assembly, Driver, Equations, Integration, Law, Start};
    let output_pins = |m: &mut Mechanism| {
        m.bodies
            .iter_mut()
            .rev()
            .take(8)
            .for_each(|pin| pin.mass = 1e-9)
    };
    let rows: Vec<Row> = vec![
        (
            "output pins without mass",
            Solver {
                mass: output_pins,
                ..RIGHT
            },
            Equations,
            "inertia",
            -1.0,
            1e-4,
        ),
        (
            "load twice",
            Solver {
                scene: |s| s.drive.output_torque_n_m *= 2.0,
                ..RIGHT
            },
            Equations,
            "load",
            1.0,
            1e-5,
        ),
        (
            "load of the other sign",
            Solver {
                scene: |s| s.drive.output_torque_n_m *= -1.0,
                ..RIGHT
            },
            Equations,
            "load",
            -2.0,
            1e-5,
        ),
        (
            "stiffness 0.1 %",
            Solver {
                scene: |s| s.contact.stiffness_multiplier *= 1.001,
                ..RIGHT
            },
            Law,
            "stiffness",
            1e-3,
            1e-7,
        ),
        (
            "stiffness 1 %",
            Solver {
                fault: Some(Fault::Stiffness),
                ..RIGHT
            },
            Law,
            "stiffness",
            1e-2,
            1e-6,
        ),
        (
            "damping 1 %",
            Solver {
                scene: |s| s.contact.damping_n_s_m *= 1.01,
                ..RIGHT
            },
            Law,
            "damping",
            1e-2,
            1e-4,
        ),
        (
            "a longer ramp",
            Solver {
                scene: |s| s.contact.ramp_m *= 1.2,
                ..RIGHT
            },
            Law,
            "damping",
            0.2,
            1e-5,
        ),
        (
            "a disc's inertia",
            Solver {
                mass: |m| m.bodies[2].moment *= 1.05,
                ..RIGHT
            },
            Equations,
            "inertia",
            0.05,
            1e-6,
        ),
        (
            "a disc's phase",
            Solver {
                fault: Some(Fault::WheelPhase),
                ..RIGHT
            },
            Start,
            "phase",
            1e-4,
            1e-9,
        ),
        (
            "eccentricity",
            Solver {
                scene: |s| s.gear.eccentricity_m *= 0.9999,
                ..RIGHT
            },
            Start,
            "eccentricity",
            -1e-4,
            1e-8,
        ),
        (
            "holes' angle",
            Solver {
                scene: |s| {
                    s.gear.errors.hole_tangential_m = [vec![0.0; 8], vec![3.8e-6; 8]].concat()
                },
                ..RIGHT
            },
            Start,
            "holes",
            1e-4,
            1e-8,
        ),
        (
            "driver's sign",
            Solver {
                column: |k| if k == 0 { -1.0 } else { 1.0 },
                ..RIGHT
            },
            Driver,
            "torque",
            -2.0,
            1e-9,
        ),
        (
            "output's torque as written",
            Solver {
                column: |k| if k == 1 { 1.02 } else { 1.0 },
                ..RIGHT
            },
            Assembly,
            "torque",
            0.02,
            1e-9,
        ),
        (
            "forces as written",
            Solver {
                column: |k| if (3..27).contains(&k) { 1.2 } else { 1.0 },
                ..RIGHT
            },
            Law,
            "force",
            0.2,
            1e-9,
        ),
        (
            "Heun with a stale stage",
            Solver {
                stale: true,
                method: ("rk2", 2.0),
                ..RIGHT
            },
            Integration,
            "",
            0.0,
            0.0,
        ),
        (
            "stale foot",
            Solver {
                fault: Some(Fault::StaleFoot),
                ..RIGHT
            },
            Law,
            "",
            0.0,
            0.0,
        ),
    ];
    holds(rows, &scene("paper", &[]), 0.0);
}

/// The ramp of friction is wide enough for an explicit method.
#[test]
fn names_faults_of_friction() {
    let sets = [
        "contact.friction_ramp_m_s=5e-3",
        "contact.friction_coefficient=0.1",
    ];
    let pins = |m: &mut Mechanism| {
        m.bodies
            .iter_mut()
            .rev()
            .take(24)
            .for_each(|pin| pin.moment *= 2.0)
    };
    let rows: Vec<Row> = vec![
        (
            "sign of friction",
            Solver {
                fault: Some(Fault::FrictionSign),
                ..RIGHT
            },
            Stage::Law,
            "friction",
            -2.0,
            1e-6,
        ),
        (
            "no friction",
            Solver {
                scene: |s| s.contact.friction_coefficient = 1e-12,
                ..RIGHT
            },
            Stage::Law,
            "friction",
            -1.0,
            1e-6,
        ),
        (
            "stiffness",
            Solver {
                fault: Some(Fault::Stiffness),
                ..RIGHT
            },
            Stage::Law,
            "stiffness",
            1e-2,
            1e-6,
        ),
        (
            "pins' inertia",
            Solver {
                mass: pins,
                ..RIGHT
            },
            Stage::Equations,
            "inertia",
            1.0,
            0.02,
        ),
    ];
    holds(rows, &scene("paper", &sets), 0.0);
}

/// A step that passes over a jump of the load shows where the load jumps, and there alone.
#[test]
fn names_a_step_over_a_jump() {
    let scene = scene("hard-load-doubled", &["solver.step_s=2.3e-5"]);
    let solver = Solver {
        fault: Some(Fault::PassedBreak),
        ..RIGHT
    };
    let found = located(&solver, &scene, 0.01).unwrap();
    assert_eq!(
        found.first(),
        Some(Stage::Integration),
        "{}",
        found.sentence()
    );
    assert!(
        found.sentence().contains("alone from t ="),
        "{}",
        found.sentence()
    );
    assert!(located(&RIGHT, &scene, 0.01).unwrap().first().is_none());
}

/// No stage is off where nothing is wrong, at twice the step too.
#[test]
fn accuses_nobody() {
    let friction = [
        "contact.friction_ramp_m_s=5e-3",
        "contact.friction_coefficient=0.1",
    ];
    for (preset, sets) in [
        ("paper", &[][..]),
        ("paper", &friction),
        ("one-wheel", &[]),
        ("eleven-pins", &[]),
        ("forty-pins", &[]),
        ("modified", &[]),
        ("toleranced", &[]),
        ("backlash-0.6", &[]),
        ("hard-load-reversal", &[]),
        ("needle-bearings", &["contact.friction_coefficient=0.0"]),
        ("rv-320", &["contact.friction_coefficient=0.0"]),
        ("steel", &[]),
    ] {
        let scene = scene(preset, sets);
        for longer in [1.0, 2.0] {
            for method in [("rk4", 4.0), ("rk2", 2.0)] {
                let found = located(
                    &Solver {
                        longer,
                        method,
                        ..RIGHT
                    },
                    &scene,
                    0.0,
                )
                .unwrap();
                assert_eq!(
                    found.first(),
                    None,
                    "{preset} by {longer}: {}",
                    found.sentence()
                );
            }
        }
    }
}

/// Gears that nobody chose: no stage of a right solver is off, and 1 % more stiffness is named with its factor on each.
#[test]
fn judges_random_gears() {
    let wrong = Solver {
        fault: Some(Fault::Stiffness),
        ..RIGHT
    };
    let (mut judged, mut named) = (0, 0);
    for number in 0..20 {
        let Some(mut scene) = gear(number) else {
            continue;
        };
        let rad_s = Frequencies::of(&scene).contact_rad_s;
        (scene.solver.step_s, scene.solver.integrator) = (0.05 / rad_s, "rk4".to_owned());
        (scene.solver.sample_s, scene.solver.duration_s) = (1.0 / rad_s, 100.0 / rad_s);
        scene.contact.friction_coefficient = 0.0;
        if scene.drive.output_torque_n_m == 0.0 {
            continue;
        }
        let Ok(scene) = scene.check() else { continue };
        let Some(found) = located(&RIGHT, &scene, 0.0) else {
            continue;
        };
        assert_eq!(found.first(), None, "{number}: {}", found.sentence());
        let found = located(&wrong, &scene, 0.0).unwrap();
        // Some laws have a stiffness of their own.
        judged += usize::from(found.first().is_some());
        named += usize::from(
            found
                .cause
                .as_ref()
                .is_some_and(|cause| cause.word == "stiffness"),
        );
        assert!(
            found.first() <= Some(Stage::Law),
            "{number}: {}",
            found.sentence()
        );
    }
    println!("{named} of {judged}");
    assert!(named >= 8 && named + 1 >= judged, "{named} of {judged}");
}

/// Engines of others are right, as their own tests say.
fn accuse_none(pairs: impl Fn(usize, usize) -> bool) {
    const PRESETS: [&str; 5] = [
        "paper",
        "paper-friction",
        "hard-load-reversal",
        "one-wheel",
        "paper-bearings",
    ];
    const ENGINES: [&str; 5] = [
        "rapier-shared-law",
        "exudyn-shared-law-constrained",
        "exudyn-shared-law-explicit",
        "mujoco-shared-law",
        "ida-shared-law",
    ];
    for (i, preset) in PRESETS.into_iter().enumerate() {
        let scene = scene(preset, &[]);
        for (k, name) in ENGINES.into_iter().enumerate() {
            let engine = by_name(name, &scene).filter(|_| pairs(i, k));
            let Some(engine) = engine else {
                continue;
            };
            if let Some(found) = located(engine.as_ref(), &scene, 0.0) {
                assert_eq!(
                    found.first(),
                    None,
                    "{name}, {preset}: {}",
                    found.sentence()
                );
            }
        }
    }
}

/// Every engine on one scene, and every scene by one engine.
#[test]
fn accuses_no_engine() {
    accuse_none(|preset, engine| preset == engine);
}

#[test]
#[ignore = "weekly: 30 s for the other pairs of scene and engine"]
fn accuses_no_engine_in_any_scene() {
    accuse_none(|preset, engine| preset != engine);
}

/// A solver that writes no states hears which columns would tell.
#[test]
fn asks_for_columns() {
    let gearbox = Gearbox::new(&scene("paper", &["solver.duration_s=0.002"])).unwrap();
    let run = RIGHT.integrate(&gearbox).time_series;
    let runs = pinwheel_studies::stages::Runs {
        name: "mine",
        run: &run,
        finer: None,
    };
    let said = pinwheel_studies::stages::locate(&gearbox, runs)
        .unwrap()
        .sentence();
    assert!(
        said.contains("wheel_angle_rad_*, output_rate_rad_s, wheel_rate_rad_s_*"),
        "{said}"
    );
}
