//! Sizes of parts at work: as warm as they are, and ring pins at the bottom of their slots.
//!
//! With the strain s = a dT of a part, by its material's coefficient of expansion a:
//!
//! ```text
//! whole gear, its discs' profile and holes        times 1 + s_d    (eccentrics and carrier are as warm as the discs, and expand alike)
//! pins                                            q (1 + s_p),  r (1 + s_p)
//! ring pins' circle                               (R + d)(1 + s_h):  the backlash grows by R (s_h - s_d)
//! ```

use std::borrow::Cow;

use crate::error::Fault;
use crate::materials::material;
use crate::model::{Gear, Scene, Temperature};

const KEYS: [&str; 3] = [
    "temperature.housing_k",
    "temperature.disc_k",
    "temperature.pins_k",
];

impl Scene {
    /// Strains of housing, discs and pins.
    fn strains(&self, warmth: Temperature) -> [f64; 3] {
        let contact = &self.contact;
        let disc = contact.material.as_deref();
        let pin = contact.pin_material.as_deref().or(disc);
        let housing = self.structure.housing_material.as_deref().or(pin);
        let strain = |name: Option<&str>, kelvin: f64| {
            let of = name.and_then(material);
            of.map_or(0.0, |of| of.expansion_per_k * kelvin)
        };
        [
            strain(housing, warmth.housing_k),
            strain(disc, warmth.disc_k),
            strain(pin, warmth.pins_k),
        ]
    }

    /// Returns the scene with the sizes that its parts have at work, which is one without temperatures and slots; itself where these
    /// are the measured ones. What the ring grows beyond the discs is a smaller circle that generates them.
    ///
    /// ```
    /// use pinwheel_scene::{Scene, Temperature};
    ///
    /// let mut scene = Scene::paper();
    /// scene.contact.material = Some("steel".into());
    /// scene.structure.housing_material = Some("aluminium".into());
    /// scene.temperature = Some(Temperature { housing_k: 40.0, disc_k: 40.0, pins_k: 40.0 });
    /// let warm = scene.at_work();
    /// let grown = -warm.gear.modification.radial_m / scene.gear.pitch_radius_m();
    /// assert!((grown - 40.0 * (23e-6 - 11.5e-6)).abs() < 1e-12);
    /// ```
    pub fn at_work(&self) -> Cow<'_, Self> {
        if self.temperature.is_none() && self.structure.ring_slot_clearance_m.is_none() {
            return Cow::Borrowed(self);
        }
        let mut scene = self.clone();
        let gear = &mut scene.gear;
        let slot = scene.structure.ring_slot_clearance_m.take();
        gear.modification.equidistant_m += slot.unwrap_or_default();
        if let Some(warmth) = scene.temperature.take() {
            let [housing, disc, pins] = self.strains(warmth).map(|strain| 1.0 + strain);
            let ring = housing * (gear.pitch_radius_m() + gear.backlash_m);
            let (edge, generating) = (
                disc * gear.edge_offset_m(),
                disc * gear.generating_radius_m(),
            );
            gear.eccentricity_m *= disc;
            gear.shortening =
                gear.eccentricity_m * gear.external_sleeves as f64 / (ring - gear.backlash_m);
            gear.modification.radial_m = generating - gear.pitch_radius_m();
            gear.external_sleeve_radius_m *= pins;
            gear.modification.equidistant_m = edge - gear.external_sleeve_radius_m;
            gear.internal_sleeve_radius_m *= pins;
            gear.internal_circle_radius_m *= disc;
            gear.hole_radius_m *= disc;
        }
        Cow::Owned(scene)
    }
}

/// Rejects temperatures of unknown materials, and temperatures without a valid gear; `outside` checks profile and ring.
pub(crate) fn check(scene: &Scene, outside: fn(&Gear) -> Result<(), Fault>) -> Result<(), Fault> {
    if scene.temperature.is_some() && scene.contact.material.is_none() {
        let what = "is missing, and warm discs expand by it".to_owned();
        let remedy = "name the discs' material; contact.pin_material and structure.housing_material are those of pins and \
                      housing where they differ";
        return Err(Fault::new(&["contact.material", KEYS[1]], what, remedy));
    }
    let Cow::Owned(warm) = scene.at_work() else {
        return Ok(());
    };
    outside(&warm.gear).map_err(|fault| {
        let slot = "structure.ring_slot_clearance_m";
        let keys = match scene.temperature {
            Some(_) => [&KEYS[..], &[slot]].concat(),
            None => vec![slot],
        };
        let what = format!(
            "makes sizes at work that do not fit: {} {}",
            fault.keys[0], fault.what
        );
        Fault::new(&keys, what, "make it smaller")
    })
}
