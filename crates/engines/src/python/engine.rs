//! The Python engines behind the one trait.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::ContactField;
use pinwheel_gearbox::scene::Scene;
use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict};

use super::law::Published;
use super::mujoco::{ATTACHED, Addresses, Attached, Place, detach};
use super::watch::{Watch, watched};
use super::{PythonError, border, convert, host};
use crate::engine::{Control, Engine, EngineError, Run, Track};

/// One engine of the package.
#[derive(Debug, Clone, Copy)]
pub(super) struct PythonEngine {
    pub(super) name: &'static str,
    /// Package whose version counts.
    pub(super) package: &'static str,
    pub(super) track: Track,
    pub(super) summary: &'static str,
    pub(super) differences: &'static str,
}

/// All of them, in the order of reports.
pub(super) const ALL: &[PythonEngine] = &[
    PythonEngine {
        name: "mujoco-shared-law",
        package: "mujoco-core",
        track: Track::SharedLaw,
        summary: "MuJoCo: hinges as a tree, Runge-Kutta 4; contact forces from Pinwheel's law",
        differences: "Joints are not constraints but coordinates: every body turns on a hinge relative to its carrier, \
            and MuJoCo's articulated-body equations give the mass matrix. Time integration is its own Runge-Kutta 4 at \
            the scene's step, with our contact law in every stage through a compiled callback; friction is therefore \
            explicit. The input speed is held by a rotor inertia of 1e12 kg m\u{b2} instead of a constraint (one part \
            in 1e14), and the driver torque is that inertia times its deceleration. Contact points and contact law are \
            the native solver's own: this comparison cannot find an error in them.",
    },
    PythonEngine {
        name: "exudyn-shared-law-explicit",
        package: "exudyn",
        track: Track::SharedLaw,
        summary: "exudyn: one kinematic tree, Runge-Kutta 4; contact forces from Pinwheel's law",
        differences: "Joints are coordinates, as in MuJoCo, but in exudyn's kinematic tree with exudyn's Runge-Kutta 4 \
            at the scene's step, and our contact law in every stage; friction is therefore explicit. The input speed is \
            held by a rotor inertia of 1e12 kg m\u{b2} instead of a constraint (one part in 1e14). Contact points and \
            contact law are the native solver's own: this comparison cannot find an error in them.",
    },
    PythonEngine {
        name: "exudyn-shared-law-constrained",
        package: "exudyn",
        track: Track::SharedLaw,
        summary: "exudyn: free bodies, joints and driver as constraints, implicit trapezoidal rule; Pinwheel's law",
        differences: "The closest relative of the published formulation: three coordinates a body, revolutes and \
            driver as constraints with Lagrange multipliers. Time integration is an implicit second-order method (index \
            2: constraints hold at velocity level, and positions drift by a part of a step squared) with Newton \
            iterations, our contact law in each of them; friction is implicit. Its error at the scene's step is that of \
            the trapezoidal rule, far above the Runge-Kutta methods', and falls four times when the step is halved. \
            Contact points and contact law are the native solver's own: this comparison cannot find an error in them.",
    },
    PythonEngine {
        name: "mujoco-own-contact",
        package: "mujoco-core",
        track: Track::OwnContact,
        summary: "MuJoCo alone: wheel edges as beds of 4000 small spheres, holes as limited tendons",
        differences: "MuJoCo finds the contacts and computes the forces; nothing of ours runs in its step. Each wheel's \
            edge is a bed of 4000 spheres with linear springs, which together give K \u{3b4}^1.5 for a locally circular \
            edge and conserve energy where the paper's law does not: that is most of the difference in the driver \
            torque. Holes are tendons of limited length with a chord approximation of K \u{3b4}^1.5. There is no ramp S \
            and no friction, and steps are semi-implicit and of 1e-4 s: steady courses are comparable, the start-up \
            transient is not.",
    },
    PythonEngine {
        name: "exudyn-own-contact",
        package: "exudyn",
        track: Track::OwnContact,
        summary: "exudyn alone: circles on a polygon of 8000 spring segments, spheres in hollow spheres",
        differences: "exudyn finds the contacts and computes the forces; nothing of ours runs in its step. Each wheel's \
            edge is a polygon of 8000 spring segments, which conserve energy where the paper's law does not; holes are \
            hollow spheres with exponent 1.5, the law itself but for the ramp S. Damping of the external contacts acts \
            as a rotational damper on the wheels, because exudyn's own ignores how a body turns. There is no friction: \
            steady courses are comparable, the start-up transient is not.",
    },
];

impl PythonEngine {
    fn failed(&self, reason: impl ToString) -> EngineError {
        EngineError::Failed {
            engine: self.name.to_owned(),
            reason: reason.to_string(),
        }
    }

    fn not_ready(&self, error: &PythonError) -> EngineError {
        match error {
            PythonError::Stopped => EngineError::Cancelled,
            other => self.failed(other),
        }
    }

    fn compile(&self, scene: &Scene) -> Result<(Gearbox, Box<dyn ContactField>), EngineError> {
        let unsupported = |reason: String| EngineError::Unsupported {
            engine: self.name.to_owned(),
            reason,
        };
        let gearbox = Gearbox::new(scene).map_err(|error| unsupported(error.to_string()))?;
        let field = gearbox
            .contact_field()
            .map_err(|error| unsupported(error.to_string()))?;
        Ok((gearbox, field))
    }

    /// Runs a scene with the given contact forces. `every`: see [`Attached::every`].
    pub(super) fn run_with(
        &self,
        scene: &Scene,
        control: &Control<'_>,
        disguise: impl FnOnce(Box<dyn ContactField>) -> Box<dyn ContactField>,
        every: u64,
    ) -> Result<Run, EngineError> {
        let (gearbox, field) = self.compile(scene)?;
        host::ready(control.cancel).map_err(|error| self.not_ready(&error))?;
        let law =
            (self.track == Track::SharedLaw).then(|| Published::new(&gearbox, disguise(field)));
        let scene_toml = scene.to_toml();
        let run = watched(control, |watch| {
            Python::attach(|py| {
                self.drive(py, &scene_toml, law.as_ref(), every, watch)
                    .map_err(|error| convert::error(py, self.name, &error))
            })
        });
        // Whatever Python did or left undone: no callback may reach this run any more.
        if let Some(law) = &law {
            detach(law.number);
        }
        run.map_err(|error| self.failed(error))??
            .map_err(|reason| self.failed(reason))
    }

    fn drive(
        &self,
        py: Python<'_>,
        scene_toml: &str,
        law: Option<&Published>,
        every: u64,
        watch: Watch,
    ) -> PyResult<Result<Run, String>> {
        let package = host::package(py)?;
        let options = PyDict::new(py);
        options.set_item("on_progress", watch.into_python(py)?)?;
        if let Some(law) = law {
            options.set_item("law", pointer(&package, law, every)?)?;
        }
        let result = package.call_method("run", (scene_toml, self.name), Some(&options))?;
        convert::run(&result)
    }
}

/// The package's `LawPointer` to a law.
pub(super) fn pointer<'py>(
    package: &Bound<'py, PyModule>,
    law: &Published,
    every: u64,
) -> PyResult<Bound<'py, PyAny>> {
    let py = package.py();
    let (run, bodies, shared) = (law.number, law.bodies, law.law.clone());
    let attach = PyCFunction::new_closure(py, None, None, move |args, _| -> PyResult<usize> {
        let (addresses, places) = layout(args.get_item(0)?.cast::<PyDict>()?, bodies)?;
        detach(run);
        super::law::locked(&ATTACHED).push(Attached::new(
            run,
            addresses,
            places,
            shared.clone(),
            every,
        ));
        Ok(border::passive_address())
    })?;
    let leave = PyCFunction::new_closure(py, None, None, move |_, _| detach(run))?;
    package
        .getattr("LawPointer")?
        .call1((border::law_address(), run, attach, leave))
}

/// Addresses and joints from the layout that the package hands over.
fn layout(layout: &Bound<'_, PyDict>, bodies: usize) -> PyResult<(Addresses, Vec<Place>)> {
    let item = |name: &str| {
        layout
            .get_item(name)?
            .ok_or_else(|| pyo3::exceptions::PyKeyError::new_err(name.to_owned()))
    };
    let number = |name: &str| -> PyResult<usize> { item(name)?.extract() };
    let addresses = Addresses {
        data: number("data")?,
        qpos: number("qpos")?,
        qvel: number("qvel")?,
        qfrc_passive: number("qfrc_passive")?,
        counters: number("counters")?,
        coordinates: number("coordinates")?,
    };
    let coordinates: Vec<usize> = item("coordinate")?.extract()?;
    let carriers: Vec<i64> = item("carrier")?.extract()?;
    let x: Vec<f64> = item("offset_x_m")?.extract()?;
    let y: Vec<f64> = item("offset_y_m")?.extract()?;
    let places: Vec<Place> = coordinates
        .into_iter()
        .zip(carriers)
        .zip(x.into_iter().zip(y))
        .map(|((coordinate, carrier), (x, y))| Place {
            coordinate,
            carrier: usize::try_from(carrier).ok(),
            offset: [x, y],
        })
        .collect();
    let sound = places.len() == bodies
        && places.iter().all(|place| {
            place.coordinate < addresses.coordinates
                && place.carrier.is_none_or(|carrier| carrier < bodies)
        });
    if sound {
        Ok((addresses, places))
    } else {
        Err(pyo3::exceptions::PyValueError::new_err(format!(
            "the layout does not fit a scene of {bodies} bodies"
        )))
    }
}

impl Engine for PythonEngine {
    fn name(&self) -> &'static str {
        self.name
    }

    fn track(&self) -> Track {
        self.track
    }

    fn version(&self) -> String {
        host::pins()
            .find(|pin| pin.package == self.package)
            .map_or_else(String::new, |pin| {
                let name = pin.package.trim_end_matches("-core");
                format!("{name} {}", pin.version)
            })
    }

    fn summary(&self) -> &'static str {
        self.summary
    }

    fn differences(&self) -> &'static str {
        self.differences
    }

    fn supports(&self, scene: &Scene) -> Result<(), EngineError> {
        self.compile(scene)?;
        if self.track == Track::SharedLaw {
            // The law is ours: what the native solver can do, it can do.
            return Ok(());
        }
        static NEVER: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);
        host::ready(&NEVER).map_err(|error| self.not_ready(&error))?;
        let scene_toml = scene.to_toml();
        Python::attach(|py| {
            host::package(py)
                .and_then(|package| package.call_method1("check", (scene_toml, self.name)))
                .map(|_| ())
                .map_err(|error| convert::error(py, self.name, &error))
        })
    }

    fn run(&self, scene: &Scene, control: &Control<'_>) -> Result<Run, EngineError> {
        self.run_with(scene, control, |field| field, 1)
    }
}
