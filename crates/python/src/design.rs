//! From a catalogue to a scene, from a scene to a designer's figures, and to a co-simulation unit.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use pinwheel::engines::external::fmu_library;
use pinwheel::fmu::{Imprint, Package, PackageError};
use pinwheel::scene::catalogue::{ARGUMENTS, Catalogue, MATERIALS};
use pinwheel::scene::did_you_mean;
use pinwheel::studies::StudyError;
use pinwheel::studies::design::{self as designs, Drawing};
use pinwheel::{Gearbox, pages};
use pyo3::prelude::*;

use crate::errors::{Raises, input, of_key, plain};
use crate::scene::Core;
use crate::studies::made;
use crate::supervise::{Desk, supervised};

/// A catalogue's data by name, in SI; what is left out is suggested.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Given {
    ratio: usize,
    cranks: Option<usize>,
    pin_circle_diameter_m: f64,
    torque_n_m: f64,
    speed_rad_s: f64,
    material: String,
    pin_diameter_m: Option<f64>,
    eccentricity_m: Option<f64>,
    wheels: Option<usize>,
    output_pins: Option<usize>,
    output_pin_diameter_m: Option<f64>,
    output_circle_diameter_m: Option<f64>,
    face_width_m: Option<f64>,
    backlash_m: Option<f64>,
    friction: Option<f64>,
}

/// The scene of a catalogue's data, as a scene file.
#[pyfunction]
pub(crate) fn gear(name: String, given: Given) -> Raises<String> {
    let mut materials = MATERIALS.iter();
    let Some(material) = materials.find(|material| material.name == given.material) else {
        let known: Vec<&str> = MATERIALS.iter().map(|material| material.name).collect();
        let remedy = did_you_mean(&given.material, &known);
        return Err(input(format!(
            "there is no material `{}`; {remedy}",
            given.material
        )));
    };
    let catalogue = Catalogue {
        name,
        ratio: given.ratio,
        cranks: given.cranks,
        pin_circle_diameter_m: given.pin_circle_diameter_m,
        torque_n_m: given.torque_n_m,
        speed_rad_s: given.speed_rad_s,
        material: *material,
        pin_diameter_m: given.pin_diameter_m,
        eccentricity_m: given.eccentricity_m,
        wheels: given.wheels,
        output_pins: given.output_pins,
        output_pin_diameter_m: given.output_pin_diameter_m,
        output_circle_diameter_m: given.output_circle_diameter_m,
        face_width_m: given.face_width_m,
        backlash_m: given.backlash_m,
        friction_coefficient: given.friction,
    };
    let draft = catalogue.draft().map_err(|fault| {
        let typed = |text: &str| {
            let each = ARGUMENTS.iter();
            each.fold(text.to_owned(), |text, (key, name)| text.replace(key, name))
        };
        let key = fault.keys.first().map(|key| typed(key));
        of_key(
            &typed(&fault.to_string()),
            key.as_deref(),
            &typed(&fault.remedy),
        )
    })?;
    Ok(draft.text)
}

/// Figures that a designer asks of a gear.
#[pyclass(frozen, module = "pinwheel._core")]
pub(crate) struct Designed {
    found: designs::DesignResult,
    gearbox: Gearbox,
}

#[pymethods]
impl Designed {
    /// Everything found, JSON.
    fn json(&self) -> Raises<String> {
        Ok(serde_json::to_string(&self.found)?)
    }

    /// Every figure in words: its name for programs, what it is, its value, what bounds that.
    fn words(&self) -> Vec<(&'static str, &'static str, String, String)> {
        let figures = self.found.figures.iter();
        let told = figures.map(|figure| {
            let (value, bounds) = pages::design::headline(figure);
            (figure.key, figure.what, value, bounds)
        });
        told.collect()
    }

    /// The page that opens offline.
    fn page(&self, py: Python<'_>) -> Raises<String> {
        let never = AtomicBool::new(false);
        let page = py.detach(|| pages::design::page(&self.found, &self.gearbox, &made(), &never));
        Ok(page.map_err(StudyError::from)?)
    }

    /// Text for a terminal.
    fn text(&self) -> String {
        pages::design::text(&self.found, true)
    }

    /// Every disc as a drawing in DXF.
    fn dxf(&self) -> Vec<String> {
        self.found.discs.iter().map(Drawing::dxf).collect()
    }
}

/// Figures of the scene's gear; `runs`: also those that take dynamic runs.
#[pyfunction]
pub(crate) fn design(
    py: Python<'_>,
    scene: &Core,
    runs: bool,
    progress: Option<Py<PyAny>>,
) -> Raises<Designed> {
    let gearbox = pinwheel::compile(&scene.checked)?;
    let found = supervised(py, &Desk::new(), progress.as_ref(), |control| {
        designs::run(&gearbox, runs, control)
    })?;
    let found = found?;
    Ok(Designed { found, gearbox })
}

/// The scene as a co-simulation unit: the file's bytes. `library`: of such units; by itself as the program finds it.
#[pyfunction]
pub(crate) fn fmu(
    py: Python<'_>,
    scene: &Core,
    library: Option<&str>,
    author: Option<&str>,
) -> Raises<Vec<u8>> {
    let gearbox = pinwheel::compile(&scene.checked)?;
    let library = match library {
        Some(library) => Path::new(library).to_owned(),
        None => fmu_library().map_err(input)?,
    };
    py.detach(|| Package::new(&gearbox, &library, Imprint::here(author)?)?.bytes())
        .map_err(|error| match error {
            PackageError::Given(why) => input(why),
            PackageError::Unit(_) => plain(error),
        })
}
