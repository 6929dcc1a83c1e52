//! Native solver for co-simulation: the importer selects the times and prescribes speeds or torques of the shafts.
//!
//! ```text
//! input shaft:   speed omega(t) prescribed, or torque M(t) applied to the shaft's own inertia
//! output shaft:  torque T(t) applied, or speed prescribed
//! u(t) = value + slope (t - from),  from one communication point to the next
//! ```
//! A prescribed value applies from a communication point on, where it may jump; the method then restarts. While the signals do
//! not change, the method continues with its own steps and history, so that its error is that of a run.
//!
//! The usual drive (speed in, torque out) uses the forces of a run. If the input is free or the output's speed is prescribed,
//! moments are summed over all bodies and derivatives are differences. This takes more evaluations for the same motion.

use pinwheel_mbs::integrators::{Segments, StepCounts, Stepper, method};
use pinwheel_mbs::{BodyState, Detail, Driver, Formulation, Motion, OdeSystem as _, Reduced};
use serde::{Deserialize, Serialize};

use crate::auto::{self, AUTO};
use crate::channels::{EngineState, LawPairs};
use crate::contacts::ContactField;
use crate::forces::GearForces;
use crate::linear_signal::LinearSignal;
use crate::load_profile;
use crate::native::{reduced, segments};
use crate::scene::{self, Drive};
use crate::{Gearbox, GearboxError, Layout, Recorder, guard};

/// Number of steps after which a motion is checked, besides the checks at communication points.
const LOOK: u32 = 4096;

/// Kind of prescribed value of a shaft.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prescribed {
    /// Speed, rad/s.
    BySpeed,
    /// Torque, N m.
    ByTorque,
}

impl Prescribed {
    /// Returns `by_speed` for a prescribed speed, `by_torque` for a prescribed torque.
    fn choose<T>(self, by_speed: T, by_torque: T) -> T {
        match self {
            Self::BySpeed => by_speed,
            Self::ByTorque => by_torque,
        }
    }
}

/// Prescribed values of both shafts, counter-clockwise positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Prescribed value of the input shaft.
    pub input: Prescribed,
    /// Prescribed value of the output shaft.
    pub output: Prescribed,
    /// Speeds of the shafts at t = 0, rad/s; that of the output applies if prescribed.
    pub speeds_rad_s: [f64; 2],
    /// Torque on the output at t = 0 in addition to the scene's load, N m.
    pub torque_n_m: f64,
    /// True if the scene's load, with its ramp and changes, also acts on the output.
    pub scene_load: bool,
    /// Relative error per step, instead of the scene's or that of [`auto`].
    pub tolerance: Option<f64>,
}

impl Setup {
    /// Returns the setup of a scene's drive.
    pub fn of(drive: &Drive) -> Self {
        Self {
            input: Prescribed::BySpeed,
            output: Prescribed::ByTorque,
            speeds_rad_s: [drive.input_speed_rad_s, 0.0],
            torque_n_m: 0.0,
            scene_load: true,
            tolerance: None,
        }
    }
}

/// State of the shafts at a communication point.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shafts {
    /// Angle and speed of the input shaft, rad, rad/s.
    pub input: [f64; 2],
    /// Speed of the output shaft, rad/s.
    pub output_speed_rad_s: f64,
    /// External torque on the output shaft, N m.
    pub load_torque_n_m: f64,
    /// Largest force on a pin, N.
    pub largest_force_n: f64,
}

/// Simulation of a gear from one communication point to the next.
pub struct CoSimulation {
    gearbox: Gearbox,
    setup: Setup,
    longest_step_s: f64,
    breaks: Vec<f64>,
    system: Reduced<GearForces>,
    stepper: Segments,
    field: ContactField,
    recorder: Recorder,
    /// Prescribed signals of the input and the output.
    prescribed: [LinearSignal; 2],
    /// Prescribed motions, in the order of the mechanism's drivers: input, output.
    motions: Vec<Motion>,
    time: f64,
    y: Vec<f64>,
}

/// State on which the next steps depend.
#[derive(Serialize, Deserialize)]
struct State {
    time: f64,
    y: Vec<f64>,
    prescribed: [LinearSignal; 2],
    motions: Vec<Motion>,
    segment_s: f64,
    stepper: Vec<u8>,
}

impl CoSimulation {
    /// Creates a simulation at t = 0. The scene's formulation is ignored: the reduced form is exact and costs least.
    ///
    /// # Errors
    /// A speed, load or tolerance that the scene's checks refuse.
    pub fn new(gearbox: &Gearbox, setup: Setup) -> Result<Self, GearboxError> {
        if setup.input == Prescribed::BySpeed && !gearbox.scene.drive.speed_changes.is_empty() {
            return Err(GearboxError::SpeedChanges);
        }
        let mut gearbox = gearbox.with_solver(|solver| {
            solver.formulation = scene::Formulation::Reduced;
        })?;
        let mut longest_step_s = f64::INFINITY;
        if gearbox.scene.solver.integrator == AUTO {
            let plan = auto::plan(&gearbox.scene, auto::TARGET);
            let plan = match setup.tolerance {
                Some(tolerance) => plan.finer(plan.tolerance / tolerance),
                None => plan,
            };
            longest_step_s = plan.limits().longest_step_s;
            gearbox = plan.applied(&gearbox)?;
        } else if let Some(tolerance) = setup.tolerance {
            gearbox = gearbox.with_solver(|solver| solver.tolerance = tolerance)?;
        }
        gearbox.start = Some(start(&gearbox, &setup)?);
        let mut loaded = gearbox.clone();
        if !setup.scene_load {
            loaded.scene = loaded.scene.changed(|scene| unload(&mut scene.drive))?;
        }
        let mut mechanism = gearbox.mechanism();
        let held = mechanism.drivers.split_off(1);
        mechanism.drivers.clear();
        for (by, child) in [(setup.input, Layout::INPUT), (setup.output, Layout::OUTPUT)] {
            let BodyState { angle, rate, .. } = mechanism.bodies[child].start;
            if by == Prescribed::BySpeed {
                mechanism.drivers.push(Driver {
                    parent: None,
                    child,
                    motion: Motion {
                        angle,
                        rate,
                        ..Motion::default()
                    },
                    ..Driver::default()
                });
            }
        }
        let motions = mechanism.drivers.iter().map(|driver| driver.motion);
        let motions = motions.collect();
        mechanism.drivers.extend(held);
        let mut forces = GearForces::new(&loaded)?;
        forces.speed_in_torque_out =
            (setup.input, setup.output) == (Prescribed::BySpeed, Prescribed::ByTorque);
        let system = reduced(&gearbox, mechanism, forces)?;
        let breaks = load_profile::breaks(&loaded.scene.drive);
        let y = system.initial();
        let stepper = segments(&gearbox, 0.0, &y, &breaks, longest_step_s)?;
        let held = |side: Prescribed, speed: f64| LinearSignal {
            value: side.choose(speed, 0.0),
            ..LinearSignal::default()
        };
        let [input, output] = setup.speeds_rad_s;
        let prescribed = [held(setup.input, input), held(setup.output, output)];
        Ok(Self {
            field: gearbox.contact_field()?,
            recorder: Recorder::with_room(&gearbox, 1),
            gearbox,
            setup,
            longest_step_s,
            breaks,
            system,
            stepper,
            prescribed,
            motions,
            time: 0.0,
            y,
        })
    }

    /// Returns the time reached, s.
    pub fn time_s(&self) -> f64 {
        self.time
    }

    /// Returns the method and its relative error per step.
    pub fn method(&self) -> (&str, f64) {
        let solver = &self.gearbox.scene.solver;
        (&solver.integrator, solver.tolerance)
    }

    /// Returns the step of a fixed-step method, s.
    pub fn step_s(&self) -> f64 {
        self.gearbox.scene.solver.step_s
    }

    /// True if a tolerance determines the method's steps.
    pub fn adaptive(&self) -> bool {
        method(self.method().0).is_some_and(|method| method.adaptive)
    }

    /// Returns the work of the method since the prescribed signals last changed.
    pub fn counts(&self) -> StepCounts {
        self.stepper.counts()
    }

    /// Prescribes values of input and output (rad/s or N m, by the setup) from the present time on, with their rates of change
    /// per second.
    pub fn prescribe(&mut self, prescribed: [(f64, f64); 2]) {
        let t = self.time;
        let goes_on = |now: &LinearSignal, (value, slope): (f64, f64)| {
            now.slope == slope && now.at(t) == value
        };
        let mut sides = self.prescribed.iter().zip(prescribed);
        if sides.all(|(now, next)| goes_on(now, next)) {
            return;
        }
        self.prescribed = prescribed.map(|(value, slope)| LinearSignal {
            value,
            slope,
            from_s: t,
        });
        let sides = [self.setup.input, self.setup.output].into_iter();
        let driven = sides.zip(self.prescribed);
        let driven = driven.filter(|(side, _)| *side == Prescribed::BySpeed);
        for (motion, (_, prescribed)) in self.motions.iter_mut().zip(driven) {
            *motion = Motion {
                from_s: t,
                angle: motion.at(t).0,
                rate: prescribed.value,
                acceleration: prescribed.slope,
            };
        }
        self.apply_prescribed();
        self.restart();
    }

    /// Sets the prescribed motions and torques in the system.
    fn apply_prescribed(&mut self) {
        for (driver, motion) in self.motions.iter().enumerate() {
            self.system.set_motion(driver, *motion);
        }
        let [input, output] = self.prescribed;
        let none = LinearSignal::default();
        self.system.forces_mut().held = [
            self.setup.input.choose(none, input),
            self.setup.output.choose(none, output),
        ];
    }

    /// Restarts the method at the present state.
    fn restart(&mut self) {
        let speed = self.gearbox.scene.drive.input_speed_rad_s;
        let now = self.setup.input.choose(self.prescribed[0].value, speed);
        // Rates of contacts scale with the speed of the input.
        let share = (speed / now).abs().min(1.0);
        let share = if share > 0.0 { share } else { 1.0 };
        let longest = self.longest_step_s * share;
        // The method's name was checked at the first start.
        if let Ok(begun) = segments(&self.gearbox, self.time, &self.y, &self.breaks, longest) {
            self.stepper = begun;
        }
        self.system.restart_at(self.time);
    }

    /// Advances to time `to`, s; `cancelled` is called at every step.
    ///
    /// # Errors
    /// A message with time and cause: no further step is possible, a quantity diverged, or the run was cancelled. Afterwards
    /// only an earlier state can be continued.
    pub fn advance(&mut self, to: f64, cancelled: &dyn Fn() -> bool) -> Result<(), String> {
        self.stepper.set_stop_time(to);
        let mut steps = 0_u32;
        while self.stepper.time() < to - 1e-9 * self.gearbox.scene.solver.step_s {
            if cancelled() {
                return Err(format!("cancelled at t = {:.6} s", self.stepper.time()));
            }
            let step = self.stepper.step(&mut self.system);
            step.map_err(|error| error.to_string())?;
            steps += 1;
            // Diverging motions take ever smaller steps.
            if steps.is_multiple_of(LOOK) {
                self.look(self.stepper.time())?;
            }
        }
        self.look(to)?;
        self.time = to;
        Ok(())
    }

    /// Sets the state at time `t` and checks it.
    fn look(&mut self, t: f64) -> Result<(), String> {
        self.stepper.interpolate(&mut self.system, t, &mut self.y);
        let observed = self.system.observe(t, &self.y, Detail::Forces);
        guard::check(&self.gearbox, observed.bodies)
            .map_err(|quantity| format!("diverged at t = {t:.6} s: {quantity}"))
    }

    /// Writes the values of a run's columns ([`Recorder::contract`], then the scene's channels) at the present time to `row`.
    pub fn observe(&mut self, row: &mut Vec<f64>) -> Shafts {
        let t = self.time;
        let load = self.system.forces_mut().load_n_m(t);
        let observed = self.system.observe(t, &self.y, Detail::Everything);
        let mut torques = observed.driver_torques.iter().copied();
        let mut driver = || torques.next().unwrap_or(f64::NAN);
        let input = match self.setup.input {
            Prescribed::BySpeed => driver(),
            Prescribed::ByTorque => self.prescribed[0].at(t),
        };
        // Torque on the output in addition to the prescribed one and the scene's load.
        let output = match self.setup.output {
            Prescribed::BySpeed => driver(),
            Prescribed::ByTorque => 0.0,
        };
        self.recorder.record_observed(&observed, [input, load]);
        if self.recorder.wants_channels() {
            self.recorder.record_channels(&mut EngineState {
                bodies: observed.bodies,
                driver_torque_n_m: input,
                reactions: observed.reactions,
                contacts: &mut LawPairs(&mut self.field),
            });
        }
        let sleeves = &observed.loads[self.gearbox.layout.external_bodies().start..];
        let shafts = Shafts {
            input: [
                observed.bodies[Layout::INPUT].angle,
                observed.bodies[Layout::INPUT].rate,
            ],
            output_speed_rad_s: observed.bodies[Layout::OUTPUT].rate,
            load_torque_n_m: output + load,
            largest_force_n: sleeves.iter().map(|f| f.fx.hypot(f.fy)).fold(0.0, f64::max),
        };
        self.recorder.take_last(row);
        shafts
    }

    /// Returns all data on which the next steps depend, to the bit; valid for the same program, scene and setup.
    pub fn save(&mut self) -> Vec<u8> {
        let state = State {
            time: self.time,
            y: self.y.clone(),
            prescribed: self.prescribed,
            motions: self.motions.clone(),
            segment_s: self.system.forces_mut().segment_s(),
            stepper: self.stepper.save(),
        };
        postcard::to_allocvec(&state).unwrap_or_default()
    }

    /// Restores a saved state. Returns false, without a change, if the bytes are no state of this gear.
    pub fn restore(&mut self, bytes: &[u8]) -> bool {
        let Ok(state) = postcard::from_bytes::<State>(bytes) else {
            return false;
        };
        let alike = state.y.len() == self.y.len() && state.motions.len() == self.motions.len();
        if !alike || !self.stepper.restore(&state.stepper) {
            return false;
        }
        (self.time, self.y) = (state.time, state.y);
        (self.prescribed, self.motions) = (state.prescribed, state.motions);
        self.apply_prescribed();
        self.system.restart_at(state.segment_s);
        true
    }
}

fn unload(drive: &mut Drive) {
    drive.output_torque_n_m = 0.0;
    drive.load_ramp_s = 0.0;
    drive.load_changes.clear();
}

/// Returns the states at t = 0: the scene's start with the prescribed speed and load.
#[doc(hidden)]
pub fn start(gearbox: &Gearbox, setup: &Setup) -> Result<Vec<BodyState>, GearboxError> {
    let drive = &gearbox.scene.drive;
    let before = gearbox.load_torque(0.0);
    let load = match (setup.output, setup.scene_load) {
        // A prescribed output speed starts under the scene's load.
        (Prescribed::BySpeed, _) => before,
        (Prescribed::ByTorque, true) => before + setup.torque_n_m,
        (Prescribed::ByTorque, false) => setup.torque_n_m,
    };
    let speed = setup.speeds_rad_s[0];
    let mut states = if load == before && speed == drive.input_speed_rad_s {
        gearbox.initial_states()
    } else {
        let other = gearbox.scene.changed(|scene| {
            unload(&mut scene.drive);
            scene.drive.output_torque_n_m = load;
            scene.drive.input_speed_rad_s = speed;
        })?;
        Gearbox::new(&other)?.initial_states()
    };
    if setup.output == Prescribed::BySpeed {
        states[Layout::OUTPUT].rate = setup.speeds_rad_s[1];
    }
    Ok(states)
}
