//! Scene opened for a foreign solver.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_scene::{Layout, Scene, SceneError, preset};
use serde_json::Value;

use crate::evaluator::{Evaluator, LOAD, STATE, numbers};

/// File of the scene in a job folder.
pub const JOB_FILE: &str = "scene.json";
/// File in a job folder to which every closed law adds a line: its number of calls.
pub const CALLS_FILE: &str = "law_calls.txt";

/// Reason for a missing law, or for missing forces.
#[derive(Debug, thiserror::Error)]
pub enum LawError {
    /// Fault of the scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Scene that cannot be modelled.
    #[error("{0}")]
    Gearbox(#[from] GearboxError),
    /// Array of a wrong length.
    #[error("{what} must have {wanted} numbers, not {actual}")]
    Length {
        /// Name of the array.
        what: &'static str,
        /// Required number of values.
        wanted: usize,
        /// Actual number of values.
        actual: usize,
    },
    /// State that is not finite.
    #[error("the state of body {body} is not finite, so there are no forces")]
    NotFinite {
        /// Index of the body.
        body: usize,
    },
    /// Forces that are not finite.
    #[error("the load on body {body} is not finite: no gearbox can be in such a state")]
    Overflow {
        /// Index of the body.
        body: usize,
    },
}

/// Support that carries a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carrier {
    /// Another body, by its index, on which the body turns.
    Body(usize),
    /// Housing, on which the body turns.
    Housing,
    /// No support: the body moves freely in the plane under the law's forces only.
    Free,
}

impl Carrier {
    /// Returns the number of the support in the C interface and in job files.
    pub fn number(self) -> i32 {
        match self {
            Self::Body(index) => i32::try_from(index).unwrap_or(i32::MAX),
            Self::Housing => -1,
            Self::Free => -2,
        }
    }
}

/// Body with its pinned support.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name in messages, such as `wheel 0`.
    pub name: String,
    /// Support on which the body turns.
    pub carrier: Carrier,
    /// Centre of the body in the carrier's frame, from the carrier's centre, m. Constant; 0 for a free body.
    pub seat_m: [f64; 2],
    /// Mass, kg.
    pub mass_kg: f64,
    /// Moment of inertia about the body's centre, kg m^2.
    pub moment_kg_m2: f64,
}

/// Contact law, bodies, start and load of a scene.
pub struct Law {
    pub(crate) gearbox: Gearbox,
    evaluator: Evaluator,
    bodies: Vec<Body>,
    start: Vec<f64>,
    /// Sample times of the time series, s.
    pub(crate) samples: Vec<f64>,
    calls: u64,
    job: Option<PathBuf>,
}

impl Law {
    /// Opens a preset, a scene file (TOML or JSON), a job folder, or the text of a scene.
    ///
    /// # Errors
    /// Fault of the scene, with the remedy.
    pub fn open(spec: &str) -> Result<Self, LawError> {
        let path = Path::new(spec);
        let job = (preset(spec).is_none() && path.is_dir()).then(|| path.to_owned());
        let scene = match &job {
            Some(folder) => Scene::load(&folder.join(JOB_FILE).display().to_string(), &[])?,
            None if is_text(spec) && !path.exists() => Scene::from_toml(spec, "scene", &[])?,
            None => Scene::load(spec, &[])?,
        };
        let mut law = Self::of(&Gearbox::new(&scene)?)?;
        // A job may begin elsewhere than its scene does.
        if let Some(start) = job.as_deref().and_then(start_of_job)
            && start.len() == law.start.len()
        {
            law.start = start;
        }
        law.job = job;
        Ok(law)
    }

    /// Builds the law of a compiled scene.
    ///
    /// # Errors
    /// A scene whose contacts cannot be built.
    pub fn of(gearbox: &Gearbox) -> Result<Self, LawError> {
        let bodies = bodies(gearbox);
        Ok(Self {
            evaluator: Evaluator::new(gearbox.contact_field()?, bodies.len()),
            start: gearbox.initial_states().iter().flat_map(numbers).collect(),
            samples: gearbox.scene.solver.sample_times_s(),
            gearbox: gearbox.clone(),
            bodies,
            calls: 0,
            job: None,
        })
    }

    /// Returns the bodies: input, output, discs, ring pins, output pins.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Returns the states at t = 0, [`STATE`] numbers a body.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// Evaluates the contact forces, [`LOAD`] numbers a body. Forces depend on `states` alone.
    ///
    /// # Errors
    /// Wrong lengths, or states that are not finite; the loads are then NaN.
    pub fn loads(&mut self, states: &[f64], loads: &mut [f64]) -> Result<(), LawError> {
        let count = self.bodies.len();
        for (what, actual, wanted) in [
            ("states", states.len(), STATE * count),
            ("loads", loads.len(), LOAD * count),
        ] {
            if actual != wanted {
                loads.fill(f64::NAN);
                return Err(LawError::Length {
                    what,
                    wanted,
                    actual,
                });
            }
        }
        self.calls += 1;
        if let Some(at) = states.iter().position(|x| !x.is_finite()) {
            loads.fill(f64::NAN);
            return Err(LawError::NotFinite { body: at / STATE });
        }
        self.evaluator.evaluate(states, loads);
        if let Some(at) = loads.iter().position(|x| !x.is_finite()) {
            loads.fill(f64::NAN);
            return Err(LawError::Overflow { body: at / LOAD });
        }
        Ok(())
    }

    /// Returns the number of calls of [`loads`](Self::loads).
    pub fn calls(&self) -> u64 {
        self.calls
    }
}

/// Adds the number of calls to the job folder, so that the caller of the solver can read it.
impl Drop for Law {
    fn drop(&mut self) {
        let Some(job) = &self.job else { return };
        let file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(job.join(CALLS_FILE));
        // A read-only folder is no reason to fail.
        let _ = file.and_then(|mut file| writeln!(file, "{}", self.calls));
    }
}

/// Returns the initial states of all bodies in the layout of a job's file.
fn start_of_job(folder: &Path) -> Option<Vec<f64>> {
    let text = std::fs::read(folder.join(JOB_FILE)).ok()?;
    let job: Value = serde_json::from_slice(&text).ok()?;
    let start = |body: &Value| serde_json::from_value::<[f64; STATE]>(body["start"].clone()).ok();
    let all: Option<Vec<_>> = job["bodies"].as_array()?.iter().map(start).collect();
    Some(all?.concat())
}

/// Returns true if the argument can only be the text of a scene.
fn is_text(spec: &str) -> bool {
    spec.contains(['\n', '=', '{'])
}

/// Returns every body, pinned at its centre: shafts on the housing, discs on the input shaft unless they float, output pins on the
/// output shaft and ring pins on the housing, or the other way round if the ring is the output.
fn bodies(gearbox: &Gearbox) -> Vec<Body> {
    let mechanism = gearbox.mechanism();
    let (gear, mass) = (&gearbox.scene.gear, &gearbox.scene.mass);
    let (turn, count, pin) = match gearbox.scene.ring_turns() {
        true => (
            gear.external_sleeves_turn,
            gear.external_sleeves,
            mass.external_sleeve,
        ),
        false => (
            gear.internal_sleeves_turn,
            gear.internal_sleeves,
            mass.internal_sleeve,
        ),
    };
    // Pins fixed to the output turn with it.
    let held = if turn {
        0.0
    } else {
        count as f64 * pin.moment_kg_m2
    };
    let bodies = mechanism.bodies.into_iter().enumerate();
    let bodies = bodies.map(|(index, body)| {
        let pin = mechanism.revolutes.iter().find(|pin| pin.child == index);
        Body {
            name: body.name,
            carrier: pin.map_or(Carrier::Free, |pin| {
                pin.parent.map_or(Carrier::Housing, Carrier::Body)
            }),
            seat_m: pin.map_or([0.0; 2], |pin| pin.parent_point),
            mass_kg: body.mass,
            moment_kg_m2: body.moment + if index == Layout::OUTPUT { held } else { 0.0 },
        }
    });
    bodies.collect()
}
