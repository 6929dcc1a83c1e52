//! Engines by name, and solvers in Python.

use std::sync::Arc;

use pinwheel::engines::python::UserEngine;
use pinwheel::engines::{Engine, SharedModel};
use pinwheel::scene::Scene;
use pinwheel::studies::choice;
use pyo3::prelude::*;

use crate::errors::{Raises, input};
use crate::supervise::Desk;

/// Engine as requested.
pub(crate) enum Asked {
    Name(String),
    Own(UserEngine),
}

impl Asked {
    /// Converts a name or a `pinwheel.Engine`; `desk` lets its caller's thread run the latter.
    pub(crate) fn of(engine: &Bound<'_, PyAny>, desk: Option<&Desk>) -> Raises<Self> {
        if let Ok(name) = engine.extract::<String>() {
            return Ok(Self::Name(name));
        }
        let Ok(drive) = engine.getattr("_drive") else {
            let kind = engine.get_type().name()?;
            return Err(input(format!(
                "an engine is a name or a function with @pinwheel.engine, not {kind}"
            )));
        };
        let drive = match desk {
            Some(desk) => desk.at_caller(engine.py(), drive.unbind())?,
            None => drive.unbind(),
        };
        let text = |name: &str| -> PyResult<String> { engine.getattr(name)?.extract() };
        let track = match text("track")?.as_str() {
            "own-contact" => SharedModel::OwnContact,
            _ => SharedModel::SharedLaw,
        };
        Ok(Self::Own(UserEngine {
            name: text("name")?,
            track,
            version: text("version")?,
            summary: text("summary")?,
            differences: text("differences")?,
            order: engine.getattr("order")?.extract()?,
            drive,
            raised: Arc::default(),
        }))
    }

    pub(crate) fn each(engines: &[Bound<'_, PyAny>], desk: Option<&Desk>) -> Raises<Vec<Self>> {
        let engines = engines.iter();
        engines.map(|engine| Self::of(engine, desk)).collect()
    }
}

/// Returns the requested engines; without a request all available ones for the scene.
pub(crate) fn engines(asked: Vec<Asked>, scene: &Scene) -> Raises<Vec<Box<dyn Engine>>> {
    if asked.is_empty() {
        let none: [&str; 0] = [];
        return Ok(choice::engines(&none, scene)?);
    }
    let chosen = asked.into_iter().map(|engine| match engine {
        Asked::Name(name) => choice::find_or_recorded(name.trim(), scene),
        Asked::Own(guest) => Ok(Box::new(guest) as Box<dyn Engine>),
    });
    Ok(choice::distinct(chosen)?)
}

/// Returns the names of all requested engines, and those in Python.
pub(crate) fn split(asked: Vec<Asked>) -> (Vec<String>, Vec<Arc<dyn Engine>>) {
    let (mut names, mut guests) = (Vec::new(), Vec::<Arc<dyn Engine>>::new());
    for engine in asked {
        match engine {
            Asked::Name(name) => names.push(name),
            Asked::Own(guest) => {
                names.push(guest.name.clone());
                guests.push(Arc::new(guest));
            }
        }
    }
    (names, guests)
}
