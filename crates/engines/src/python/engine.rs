//! Python engines as [`Engine`].

use std::sync::Arc;

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;
use pyo3::prelude::*;
use pyo3::types::PyCFunction;

use super::mujoco::{Addresses, Attached, Place, attach, detach};
use super::package::package;
use super::published::Published;
use super::watch::hosted;
use super::{convert, ffi, host, pins};
use crate::control::Control;
use crate::engine::{Ending, Engine, Halt, Prepared, Run, SharedModel, prepared};
use crate::info::EngineInfo;
use crate::refusals::pins_are_rigid;

/// Engine of the package.
#[derive(Debug, Clone, Copy)]
pub(super) struct PythonEngine(pub(super) &'static EngineInfo<'static>);

impl PythonEngine {
    fn run(&self, gearbox: &Gearbox, control: &Control<'_>) -> Result<Run, Halt> {
        host::ready(control.cancel)?;
        let law = (self.0.track == SharedModel::SharedLaw).then(|| Published::new(gearbox));
        let scene_toml = gearbox.scene.at_work().to_toml();
        let (ran, _) = hosted(gearbox, control, law.transpose()?, |options, law| {
            let package = package(options.py())?;
            if let Some(law) = law {
                options.set_item("law", pointer(&package, law)?)?;
            }
            package.call_method("run", (scene_toml, self.0.name), Some(options))
        });
        ran
    }
}

/// Returns the package's `LawPointer` to a law.
pub(super) fn pointer<'py>(
    package: &Bound<'py, PyModule>,
    published: &Published,
) -> PyResult<Bound<'py, PyAny>> {
    let py = package.py();
    let (run, law) = (published.number, Arc::clone(&published.law));
    let enter = PyCFunction::new_closure(py, None, None, move |args, _| -> PyResult<usize> {
        let (addresses, places) = layout(&args.get_item(0)?, law.bodies)?;
        attach(Attached::new(run, addresses, places, Arc::clone(&law)));
        Ok(ffi::passive_address())
    })?;
    let leave = PyCFunction::new_closure(py, None, None, move |_, _| detach(run))?;
    package
        .getattr("LawPointer")?
        .call1((ffi::law_address(), run, enter, leave))
}

/// Converts the package's layout to addresses and joints.
fn layout(layout: &Bound<'_, PyAny>, bodies: usize) -> PyResult<(Addresses, Vec<Place>)> {
    let address = |name: &str| layout.get_item(name)?.extract::<usize>();
    let addresses = Addresses {
        data: address("data")?,
        qpos: address("qpos")?,
        qvel: address("qvel")?,
        qfrc_passive: address("qfrc_passive")?,
        counters: address("counters")?,
        coordinates: address("coordinates")?,
    };
    let coordinates: Vec<usize> = layout.get_item("coordinate")?.extract()?;
    let carriers: Vec<i64> = layout.get_item("carrier")?.extract()?;
    let x: Vec<f64> = layout.get_item("offset_x_m")?.extract()?;
    let y: Vec<f64> = layout.get_item("offset_y_m")?.extract()?;
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
    let sound = addresses.are_sound()
        && places.len() == bodies
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
    fn info(&self) -> EngineInfo<'_> {
        EngineInfo {
            in_python: true,
            ..*self.0
        }
    }

    fn version(&self) -> String {
        pins::pinned(pins::LIST, self.0.package)
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        if !gearbox.scene.drive.speed_changes.is_empty() {
            let reason = "it drives the input at one speed, and drive.speed_changes changes it";
            return Err(Ending::unsupported(reason).into());
        }
        let mut gearbox = gearbox.clone();
        // The law is the native solver's, so it supports the same scenes.
        if self.0.track != SharedModel::SharedLaw {
            pins_are_rigid(&gearbox.scene)?;
            let scene = self.0.own_contact.adapted(Scene::clone(&gearbox.scene));
            if scene != *gearbox.scene {
                let scene = scene.check().map_err(Ending::unsupported)?;
                gearbox = Gearbox::new(&scene).map_err(Ending::unsupported)?;
            }
            self.check(&gearbox.scene)?;
        }
        Ok(prepared(gearbox, |gearbox, control| {
            self.run(gearbox, control)
        }))
    }
}

impl PythonEngine {
    /// Checks that the package's engine supports the scene.
    fn check(&self, scene: &Scene) -> Result<(), Halt> {
        host::ready(crate::stopping::flag())?;
        let scene_toml = scene.to_toml();
        Python::attach(|py| {
            let checked = package(py)
                .and_then(|package| package.call_method1("check", (scene_toml, self.0.name)));
            checked
                .map(|_| ())
                .map_err(|error| convert::halt(py, &error))
        })
    }
}
