//! Contact laws on arrays.

use pinwheel::contact::laws::{LAWS, Law as Normal, NormalLaw as _};
use pinwheel::scene::{Scene, did_you_mean, scales};
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::{Raises, input};
use crate::scene::Core;

/// Normal contact law with its parameters.
#[pyclass(frozen, module = "pinwheel._core")]
pub(crate) struct Law(Normal);

#[pymethods]
impl Law {
    /// Creates the law `name` with the parameters of a scene.
    #[new]
    fn new(name: &str, scene: &Core) -> Raises<Self> {
        let mut scene = Scene::clone(&scene.checked);
        name.clone_into(&mut scene.contact.law);
        let known: Vec<&str> = LAWS.iter().map(|law| law.name).collect();
        scales::law(&scene).map(Self).ok_or_else(|| {
            let remedy = did_you_mean(name, &known);
            input(format!("there is no contact law `{name}`; {remedy}"))
        })
    }

    /// Writes forces to `out`; all arrays are doubles of equal length. K in N/m^1.5, penetration in m, its rate in m/s.
    fn forces(
        &self,
        py: Python<'_>,
        stiffness: PyBuffer<f64>,
        depth: PyBuffer<f64>,
        rate: PyBuffer<f64>,
        out: PyBuffer<f64>,
    ) -> PyResult<()> {
        let [stiffness, depth, rate] = [stiffness, depth, rate].map(|array| array.to_vec(py));
        let (stiffness, depth, rate) = (stiffness?, depth?, rate?);
        if [depth.len(), rate.len(), out.item_count()] != [stiffness.len(); 3] {
            return Err(PyValueError::new_err("all arrays must have one length"));
        }
        let law = self.0;
        let forces: Vec<f64> = py.detach(|| {
            let pairs = stiffness.iter().zip(&depth).zip(&rate);
            // Without contact the force is 0, even if the formula of the law differs.
            let force = |((&k, &d), &v): ((&f64, &f64), &f64)| {
                if k.is_nan() || d.is_nan() || v.is_nan() {
                    f64::NAN
                } else if d > 0.0 {
                    law.force(k, d, v)
                } else {
                    0.0
                }
            };
            pairs.map(force).collect()
        });
        out.copy_from_slice(py, &forces)
    }
}

/// Returns all laws, like the program's `laws --json`.
#[pyfunction]
pub(crate) fn laws() -> Raises<String> {
    Ok(serde_json::to_string(&pinwheel::pages::laws::json())?)
}
