//! Images of one gear: in other units, mirrored, rotated. The figures of an image follow from those of the gear.

use std::f64::consts::{PI, TAU};

use pinwheel_scene::bearings::BearingLaw;
use pinwheel_scene::{Errors, Gear, Scene};
use serde_json::Value;

/// Old units over new units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Units {
    pub(crate) length: f64,
    pub(crate) time: f64,
    pub(crate) force: f64,
}

/// Powers of length, time and force by the end of a key or column; the first match counts.
const ENDS: [(&str, [f64; 3]); 14] = [
    ("_kg_m2", [1.0, 2.0, 1.0]),
    ("_kg_m3", [-4.0, 2.0, 1.0]),
    ("_kg", [-1.0, 2.0, 1.0]),
    ("_n_m15", [-1.5, 0.0, 1.0]),
    ("_n_s_m", [-1.0, 1.0, 1.0]),
    ("_spring_n_m", [-1.0, 0.0, 1.0]),
    ("stiffness_n_m", [-1.0, 0.0, 1.0]),
    ("_n_m", [1.0, 0.0, 1.0]),
    ("_n", [0.0, 0.0, 1.0]),
    ("_pa", [-2.0, 0.0, 1.0]),
    ("_rad_s", [0.0, -1.0, 0.0]),
    ("_m_s", [1.0, -1.0, 0.0]),
    ("_s", [0.0, 1.0, 0.0]),
    ("_m", [1.0, 0.0, 0.0]),
];

impl Units {
    /// Returns the factor from old to new units for a value of that name.
    pub(crate) fn of(self, name: &str) -> f64 {
        let known = ENDS.iter().find(|(end, _)| name.ends_with(end));
        let [length, time, force] = known.map_or([0.0; 3], |(_, powers)| *powers);
        self.length.powf(length) * self.time.powf(time) * self.force.powf(force)
    }

    fn apply(self, name: &str, value: &mut Value) {
        match value {
            Value::Object(fields) => fields.iter_mut().for_each(|(key, v)| self.apply(key, v)),
            Value::Array(items) => items.iter_mut().for_each(|v| self.apply(name, v)),
            _ => {
                let factor = self.of(name);
                if let Some(x) = value.as_f64().filter(|_| factor != 1.0) {
                    *value = (factor * x).into();
                }
            }
        }
    }

    /// Returns the scene in the new units.
    pub(crate) fn scene(self, scene: &Scene) -> Scene {
        let mut plain = scene.clone();
        // Palmgren's formula holds for steel in millimetres, so its stiffness replaces the rollers, N/m^p.
        let bearing = BearingLaw::of(scene).zip(plain.bearings.eccentric.as_mut());
        let exponent = bearing.map_or(1.0, |(law, bearing)| {
            (bearing.rollers, bearing.roller_length_m) = (None, None);
            (bearing.stiffness_n_m, bearing.exponent) = (Some(law.stiffness), Some(law.exponent));
            law.exponent
        });
        let mut value = serde_json::to_value(plain).unwrap();
        self.apply("", &mut value);
        let mut scaled: Scene = serde_json::from_value(value).unwrap();
        let stiffness = scaled.bearings.eccentric.as_mut();
        if let Some(stiffness) = stiffness.and_then(|bearing| bearing.stiffness_n_m.as_mut()) {
            *stiffness *= self.length.powf(1.0 - exponent);
        }
        if scene.contact.law == "line-contact" {
            // F = H K L^(8/9) delta^(10/9) with Palmgren's K of steel, N/m^2, for any E of the scene; H takes the factor.
            scaled.contact.stiffness_multiplier *= self.force / self.length.powi(2);
        }
        scaled
    }
}

/// Permutes the entries of a list and multiplies them by a sign.
fn ordered(list: &mut Vec<f64>, sign: f64, from: impl Fn(usize) -> usize) {
    *list = (0..list.len()).map(|k| sign * list[from(k)]).collect();
}

/// Permutes the errors of ring pins, output pins and discs by their old numbers. Tangential errors take `sign`.
fn permuted(
    gear: &mut Gear,
    sign: f64,
    sleeve: impl Fn(usize) -> usize,
    pin: impl Fn(usize) -> usize,
    wheel: impl Fn(usize) -> usize,
) {
    let (pins, errors) = (gear.internal_sleeves, &mut gear.errors);
    let hole = |k: usize| wheel(k / pins) * pins + pin(k % pins);
    ordered(&mut errors.external_sleeve_radial_m, 1.0, &sleeve);
    ordered(&mut errors.external_sleeve_tangential_m, sign, &sleeve);
    ordered(&mut errors.external_sleeve_radius_m, 1.0, &sleeve);
    ordered(&mut errors.internal_sleeve_radial_m, 1.0, &pin);
    ordered(&mut errors.internal_sleeve_tangential_m, sign, &pin);
    ordered(&mut errors.internal_sleeve_radius_m, 1.0, &pin);
    ordered(&mut errors.hole_radial_m, 1.0, hole);
    ordered(&mut errors.hole_tangential_m, sign, hole);
    ordered(&mut errors.hole_radius_m, 1.0, hole);
    ordered(&mut errors.eccentricity_m, 1.0, &wheel);
    ordered(&mut errors.phase_rad, sign, &wheel);
}

/// Sets errors of every kind, of the order of the penetration under load, so that they shift loads between parts.
pub(crate) fn deviate(gear: &mut Gear, size: f64) {
    let list = |count: usize, seed: f64| -> Vec<f64> {
        let noise = |k: usize| (seed + 2.4 * (k * k + 3 * k + 1) as f64).sin();
        (0..count).map(|k| size * noise(k)).collect()
    };
    let (sleeves, pins, wheels) = (gear.external_sleeves, gear.internal_sleeves, gear.wheels);
    let arcs = list(wheels, 11.0).into_iter();
    gear.errors = Errors {
        external_sleeve_radial_m: list(sleeves, 1.0),
        external_sleeve_tangential_m: list(sleeves, 2.0),
        external_sleeve_radius_m: list(sleeves, 3.0),
        internal_sleeve_radial_m: list(pins, 4.0),
        internal_sleeve_tangential_m: list(pins, 5.0),
        internal_sleeve_radius_m: list(pins, 6.0),
        hole_radial_m: list(pins * wheels, 7.0),
        hole_tangential_m: list(pins * wheels, 8.0),
        hole_radius_m: list(pins * wheels, 9.0),
        crank_phase_rad: Vec::new(),
        eccentricity_m: list(wheels, 10.0),
        phase_rad: arcs.map(|arc| arc / gear.eccentricity_m).collect(),
    };
}

/// Returns the gear mirrored at the x axis: angles become negative, so discs, ring pins, output pins and holes have the reverse
/// order.
pub(crate) fn mirrored(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.drive.input_speed_rad_s *= -1.0;
    scene.drive.output_torque_n_m *= -1.0;
    for change in &mut scene.drive.load_changes {
        change.output_torque_n_m *= -1.0;
    }
    let (sleeves, pins, wheels) = (
        scene.gear.external_sleeves,
        scene.gear.internal_sleeves,
        scene.gear.wheels,
    );
    permuted(
        &mut scene.gear,
        -1.0,
        |k| (sleeves - k) % sleeves,
        |k| (pins - k) % pins,
        |k| (wheels - k) % wheels,
    );
    scene
}

/// Returns the gear rotated by a common multiple of the ring and output pin pitches, with the discs counted from another one and the
/// remaining angle in all `phase_rad`; `None` if every such rotation leaves about a radian or more.
pub(crate) fn turned(scene: &Scene) -> Option<Scene> {
    let gear = &scene.gear;
    let (sleeves, pins, wheels) = (gear.external_sleeves, gear.internal_sleeves, gear.wheels);
    let common = (1..=pins)
        .rev()
        .find(|g| sleeves % g == 0 && pins % g == 0)?;
    let turns = (0..common).flat_map(|turn| (0..wheels).map(move |first| (turn, first)));
    let left = |&(turn, first): &(usize, usize)| {
        let left = TAU * (turn as f64 / common as f64 - first as f64 / wheels as f64);
        (left + PI).rem_euclid(TAU) - PI
    };
    let possible = turns.filter(|both| *both != (0, 0) && left(both).abs() < 0.95);
    let (turn, first) = possible.max_by(|a, b| left(a).abs().total_cmp(&left(b).abs()))?;
    let mut scene = scene.clone();
    let (by_sleeves, by_pins) = (turn * sleeves / common, turn * pins / common);
    let back = |by: usize, count: usize| move |k: usize| (k + count - by) % count;
    permuted(
        &mut scene.gear,
        1.0,
        back(by_sleeves, sleeves),
        back(by_pins, pins),
        back(first, wheels),
    );
    let phases = &mut scene.gear.errors.phase_rad;
    phases.resize(wheels, 0.0);
    let left = left(&(turn, first));
    phases.iter_mut().for_each(|phase| *phase += left);
    Some(scene)
}
