//! Designs: a scene from catalogue data, design figures of a scene, and a co-simulation unit of a scene.

use std::path::Path;

use pinwheel::engines::external::fmu_library;
use pinwheel::fmu::{Imprint, Package, PackageError};
use pinwheel::pages;
use pinwheel::report::figure::shown;
use pinwheel::scene::as_built::PROCESSES;
use pinwheel::scene::catalogue::{ARGUMENTS, Catalogue, MATERIALS, pin_circle_of_m};
use pinwheel::scene::did_you_mean;
use pinwheel::studies::design as designs;
use pyo3::conversion::FromPyObjectOwned;
use pyo3::prelude::*;

use crate::errors::{Raises, input, of_key, plain};
use crate::scene::Core;
use crate::studies::origin;
use crate::supervise::{Desk, supervised};

/// Returns the value of a key of a dictionary.
fn value<'py, T: FromPyObjectOwned<'py>>(gear: &Bound<'py, PyAny>, key: &str) -> PyResult<T> {
    gear.get_item(key)?.extract().map_err(Into::into)
}

const ONE_DIAMETER: &str = "give either pin_circle_diameter_mm or outer_diameter_mm";

/// Drafts a scene file from catalogue data by name, in SI; `None` is replaced by a suggestion.
#[pyfunction]
pub(crate) fn gear(name: String, gear: &Bound<'_, PyAny>) -> Raises<String> {
    fn named<T>(
        what: &str,
        name: &str,
        all: &'static [T],
        of: fn(&T) -> &'static str,
    ) -> Raises<&'static T> {
        all.iter().find(|known| of(known) == name).ok_or_else(|| {
            let known: Vec<&str> = all.iter().map(of).collect();
            let remedy = did_you_mean(name, &known);
            input(format!("there is no {what} `{name}`; {remedy}"))
        })
    }
    let material = |name: String| named("material", &name, MATERIALS, |known| known.name).copied();
    let process = |name: String| named("process", &name, PROCESSES, |known| known.name);
    let (pins, method): (Option<String>, Option<String>) =
        (value(gear, "pin_material")?, value(gear, "process")?);
    let (outer, cranks): (Option<f64>, Option<usize>) =
        (value(gear, "outer_diameter_m")?, value(gear, "cranks")?);
    let catalogue = Catalogue {
        name,
        ratio: value(gear, "ratio")?,
        cranks,
        pin_circle_diameter_m: match (value(gear, "pin_circle_diameter_m")?, outer) {
            (Some(circle), None) => circle,
            (None, Some(outer)) => pin_circle_of_m(outer, cranks.is_some()),
            _ => return Err(input(ONE_DIAMETER)),
        },
        outer_diameter_m: outer,
        torque_n_m: value(gear, "torque_n_m")?,
        speed_rad_s: value(gear, "speed_rad_s")?,
        material: material(value(gear, "material")?)?,
        pin_material: pins.map(material).transpose()?,
        process: method.map(process).transpose()?,
        ideal: value(gear, "ideal")?,
        pin_diameter_m: value(gear, "pin_diameter_m")?,
        eccentricity_m: value(gear, "eccentricity_m")?,
        wheels: value(gear, "wheels")?,
        output_pins: value(gear, "output_pins")?,
        output_pin_diameter_m: value(gear, "output_pin_diameter_m")?,
        output_circle_diameter_m: value(gear, "output_circle_diameter_m")?,
        face_width_m: value(gear, "face_width_m")?,
        backlash_m: value(gear, "backlash_m")?,
        friction_coefficient: value(gear, "friction")?,
    };
    let draft = catalogue.draft().map_err(|fault| {
        let typed = |text: &str| {
            let each = ARGUMENTS.iter();
            each.fold(text.to_owned(), |text, (key, name)| {
                text.replace(&format!("`{key}`"), &format!("`{name}`"))
            })
        };
        let key = fault.keys.first().map(|key| typed(&format!("`{key}`")));
        let key = key.as_deref().map(|key| key.trim_matches('`'));
        of_key(&typed(&fault.to_string()), key, &typed(&fault.remedy))
    })?;
    Ok(draft.text)
}

/// Design figures of a gear.
#[pyclass(frozen, module = "pinwheel._core")]
pub(crate) struct Designed {
    design: designs::DesignResult,
}

#[pymethods]
impl Designed {
    /// Returns the figures as JSON.
    fn json(&self) -> Raises<String> {
        Ok(serde_json::to_string(&self.design)?)
    }

    /// Returns the figures as text: each value and its bounds.
    fn words(&self) -> Vec<(String, String)> {
        self.design.figures.iter().map(shown).collect()
    }

    /// Returns the page, which needs no network.
    fn page(&self) -> String {
        pages::design::page(&self.design, &origin())
    }

    /// Returns the text for a terminal.
    fn text(&self) -> String {
        pages::design::text(&self.design, true)
    }

    /// Returns number and drawing (DXF) of every distinct disc.
    fn dxf(&self) -> Vec<(usize, String)> {
        let discs = self.design.discs.iter();
        discs.map(|disc| (disc.number(), disc.dxf())).collect()
    }

    /// Returns the answer of the limits and its reason, as text.
    fn bears(&self) -> (String, String) {
        pages::design::answer(&self.design.limits)
    }
}

/// Computes the figures of the scene's gear; `runs`: also those that need dynamic runs.
#[pyfunction]
pub(crate) fn design(
    py: Python<'_>,
    scene: &Core,
    runs: bool,
    progress: Option<Py<PyAny>>,
) -> Raises<Designed> {
    let gearbox = pinwheel::compile(&scene.checked)?;
    let design = supervised(py, &Desk::new(), progress.as_ref(), |control| {
        designs::run(&gearbox, runs, control)
    })?;
    Ok(Designed { design })
}

/// Returns the bytes of the scene's co-simulation unit. `library`: path of the library of units; `None`: searched like the
/// program's.
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
