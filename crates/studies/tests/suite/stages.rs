//! Which stage differs, and why: solvers with one fault each, and right ones.

use pinwheel_engines::{
    Cancelled, Control, Engine, EngineInfo, Halt, Prepared, Refinement, Run, RunStats, SharedModel,
};
use pinwheel_faults::{Armed, Fault};
use pinwheel_gearbox::channels::{LawPairs, Seen};
use pinwheel_gearbox::internals::GearForces;
use pinwheel_gearbox::{Gearbox, Recorder, native};
use pinwheel_mbs::{Formulation as _, Mechanism, OdeSystem as _};
use pinwheel_scene::{CheckedScene, Scene};
use pinwheel_studies::stages::{Located, Stage, of_engine};

/// A solver by Runge-Kutta 4 on the reduced form, with faults.
#[derive(Default)]
struct Wrong {
    /// Fault of the native parts.
    fault: Option<Fault>,
    /// Keys of its scene that are not the scene's.
    scene: Option<fn(&mut Scene)>,
    mass: Option<fn(&mut Mechanism)>,
    /// Factor on each column, by its number after the time.
    columns: Option<fn(usize) -> f64>,
    /// Heun's method whose second stage is the first.
    stale: bool,
    /// Step for the one asked for.
    step: Option<f64>,
}

impl Engine for Wrong {
    fn info(&self) -> EngineInfo<'_> {
        EngineInfo {
            refinement: Some(Refinement::step(4.0)),
            ..EngineInfo::own("wrong", SharedModel::SharedLaw)
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

impl Wrong {
    fn integrate(&self, gearbox: &Gearbox) -> Run {
        let _armed = self.fault.map(Armed::with);
        let changed = gearbox.scene.changed(|scene| {
            if let Some(set) = self.scene {
                set(scene);
            }
        });
        let own = Gearbox::new(&changed.unwrap()).unwrap();
        let mut mechanism = own.mechanism();
        // It starts where the scene says.
        for (body, right) in mechanism.bodies.iter_mut().zip(gearbox.initial_states()) {
            body.start = right;
        }
        if let Some(set) = self.mass {
            set(&mut mechanism);
        }
        let mut system = native::reduced(&own, mechanism, GearForces::new(&own).unwrap()).unwrap();
        let mut field = own.contact_field().unwrap();
        let mut recorder = Recorder::new(gearbox);
        let mut y = system.initial();
        let times = gearbox.scene.solver.sample_times_s();
        for (k, &t) in times.iter().enumerate() {
            let seen = system.observe(t, &y);
            recorder.record_observed(&seen, [seen.driver_torques[0], own.load_torque(t)]);
            recorder.record_channels(&mut Seen {
                bodies: seen.bodies,
                driver_torque_n_m: seen.driver_torques[0],
                reactions: None,
                contacts: &mut LawPairs(&mut field),
            });
            let Some(next) = times.get(k + 1) else { break };
            let step = self.step.unwrap_or(gearbox.scene.solver.step_s);
            let steps = ((next - t) / step * (1.0 - 1e-9)).ceil();
            let h = (next - t) / steps;
            for step in 0..steps as usize {
                self.step(&mut system, t + step as f64 * h, h, &mut y);
            }
        }
        let mut series = recorder.finish().unwrap();
        if let Some(factor) = self.columns {
            let names: Vec<String> = Recorder::contract(gearbox);
            let mut scaled =
                pinwheel_timeseries::TimeSeries::new(series.time_s().to_vec()).unwrap();
            for channel in series.channels() {
                let by = names.iter().position(|name| *name == channel.name);
                let by = by.map_or(1.0, factor);
                let values = channel.values.iter().map(|value| value * by).collect();
                scaled.push(channel.name.clone(), values).unwrap();
            }
            series = scaled;
        }
        Run::new(series, RunStats::default())
    }

    fn step(&self, system: &mut pinwheel_mbs::Reduced<GearForces>, t: f64, h: f64, y: &mut [f64]) {
        let n = y.len();
        let (nodes, weights): (&[f64], &[f64]) = match self.stale {
            true => (&[0.0, 0.0], &[0.5, 0.5]),
            false => (
                &[0.0, 0.5, 0.5, 1.0],
                &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
            ),
        };
        let (mut slope, mut sum) = (vec![0.0; n], vec![0.0; n]);
        for (node, weight) in nodes.iter().zip(weights) {
            let at: Vec<f64> = y
                .iter()
                .zip(&slope)
                .map(|(y, s)| y + node * h * s)
                .collect();
            system.derivative(t + node * h, &at, &mut slope);
            sum.iter_mut()
                .zip(&slope)
                .for_each(|(sum, s)| *sum += weight * s);
        }
        y.iter_mut().zip(&sum).for_each(|(y, s)| *y += h * s);
    }
}

fn scene(preset: &str, sets: &[&str]) -> CheckedScene {
    let sets: Vec<_> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Scene::load(preset, &sets).unwrap()
}

fn located(preset: &str, sets: &[&str], wrong: &Wrong) -> Result<Located, Cancelled> {
    let begun = std::time::Instant::now();
    let gearbox = Gearbox::new(&scene(preset, sets)).unwrap();
    let found = of_engine(wrong, &gearbox, 0.0, &Control::quiet())?.unwrap();
    println!(
        "{preset}: {} ({:.2} s)",
        found.sentence(),
        begun.elapsed().as_secs_f64()
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
    Ok(found)
}

#[test]
fn stages_of_faults() {
    let none = Wrong::default;
    let table: Vec<(&str, Wrong, Option<Stage>, &str)> = vec![
        ("none", none(), None, ""),
        (
            "2h",
            Wrong {
                step: Some(2e-5),
                ..none()
            },
            None,
            "",
        ),
        (
            "pins' mass",
            Wrong {
                mass: Some(|m| {
                    m.bodies
                        .iter_mut()
                        .rev()
                        .take(8)
                        .for_each(|b| b.mass = 1e-9)
                }),
                ..none()
            },
            Some(Stage::Equations),
            "inertia",
        ),
        (
            "load twice",
            Wrong {
                scene: Some(|s| s.drive.output_torque_n_m *= 2.0),
                ..none()
            },
            Some(Stage::Equations),
            "load",
        ),
        (
            "stiffness 0.1 %",
            Wrong {
                scene: Some(|s| s.contact.stiffness_multiplier *= 1.001),
                ..none()
            },
            Some(Stage::Law),
            "stiffness",
        ),
        (
            "stiffness 1 %",
            Wrong {
                fault: Some(Fault::Stiffness),
                ..none()
            },
            Some(Stage::Law),
            "stiffness",
        ),
        (
            "damping 1 %",
            Wrong {
                scene: Some(|s| s.contact.damping_n_s_m *= 1.01),
                ..none()
            },
            Some(Stage::Law),
            "damping",
        ),
        (
            "disc 0 inertia",
            Wrong {
                mass: Some(|m| m.bodies[2].moment *= 1.05),
                ..none()
            },
            Some(Stage::Equations),
            "inertia",
        ),
        (
            "phase",
            Wrong {
                fault: Some(Fault::WheelPhase),
                ..none()
            },
            Some(Stage::Start),
            "phase",
        ),
        (
            "driver",
            Wrong {
                columns: Some(|k| if k == 0 { -1.0 } else { 1.0 }),
                ..none()
            },
            Some(Stage::Driver),
            "torque",
        ),
        (
            "forces",
            Wrong {
                columns: Some(|k| if k > 2 { 1.2 } else { 1.0 }),
                ..none()
            },
            Some(Stage::Law),
            "force",
        ),
        (
            "stale stage",
            Wrong {
                stale: true,
                ..none()
            },
            Some(Stage::Integration),
            "",
        ),
        (
            "eccentricity",
            Wrong {
                scene: Some(|s| s.gear.eccentricity_m *= 1.0001),
                ..none()
            },
            Some(Stage::Start),
            "eccentricity",
        ),
    ];
    for (name, wrong, stage, word) in table {
        println!("{name}");
        let found = located("paper", &[], &wrong).unwrap();
        println!(
            "  => {:?} {:?}",
            found.first() == stage,
            found.cause.as_ref().map_or("", |cause| cause.word) == word
        );
    }
}
