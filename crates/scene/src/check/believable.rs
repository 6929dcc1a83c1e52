//! Doubtful but computable inputs, each with the probable unit.
//!
//! Every bound follows from the rest of the gear or from limits of matter: lengths lie between shares of R; densities
//! between those of foam and tungsten; speeds of a bearing below those of the fastest spindles; pressures below the
//! theoretical strength of a solid, about E/15 (A. Kelly, Strong Solids, 1966).

use std::f64::consts::PI;

use pinwheel_mbs::integrators::method;

use crate::assumptions::Assumption;
use crate::body::bore_radius_m;
use crate::checked::CheckedScene;
use crate::keys::{Key, key};
use crate::load_profile;
use crate::materials::material;
use crate::number::short;
use crate::springs::external_force;

/// Least and largest length over R.
const LENGTH: [f64; 2] = [0.005, 4.0];
/// Densities of foam and of tungsten, kg/m^3.
const DENSITY: [f64; 2] = [30.0, 19_300.0];
/// Largest speed of a bearing's rollers, m/s: n d of two million mm/min.
const SPEED_M_S: f64 = 100.0;
/// Pressure over E at which a perfect solid fails.
const STRENGTH: f64 = 1.0 / 15.0;
/// Limits of Young's modulus over that of the named material.
const LIKE_ITS_MATERIAL: [f64; 2] = [0.5, 2.0];

type Units = &'static [(f64, &'static str)];
const LENGTHS: Units = &[(1e-3, "mm"), (1e3, "km")];

/// Returns doubts about a scene, each with its key, its value and the probable intention.
pub fn doubts(scene: &CheckedScene) -> Vec<Assumption> {
    let mut list = Vec::new();
    let mut judge = |name: &str, value: Option<f64>, range: [f64; 2], why: &str, units: Units| {
        let is_in = |value: f64| value >= range[0] && value <= range[1];
        let Some(value) = value.filter(|value| !is_in(*value)) else {
            return;
        };
        let unit = key(name).map_or("", Key::unit);
        let meant = units.iter().find(|(factor, _)| is_in(factor * value));
        let meant = meant.map_or_else(
            || "check it".to_owned(),
            |(factor, typed)| format!("typed in {typed}? that is {} {unit}", short(factor * value)),
        );
        let than = if value > range[1] { "more" } else { "less" };
        list.push(Assumption {
            key: name.to_owned(),
            value: format!("{} {unit}", short(value)).trim_end().to_owned(),
            reason: format!("hard to believe: {than} than {why}; {meant}"),
        });
    };
    let (gear, bearings, contact) = (&scene.gear, &scene.bearings, &scene.contact);
    let structure = &scene.structure;
    let radius = gear.pitch_radius_m();
    let lengths = LENGTH.map(|share| share * radius);
    let of_gear = format!(
        "{} to {} times the pin circle's radius",
        LENGTH[0], LENGTH[1]
    );
    let line = Some(contact.line_length_m).filter(|_| gear.face_width_m.is_none());
    let eccentric = bearings.eccentric.unwrap_or_default();
    for (name, value) in [
        ("gear.face_width_m", gear.face_width_m),
        ("contact.line_length_m", line),
        ("contact.disc_depth_m", contact.disc_depth_m),
        (
            "bearings.eccentric.roller_length_m",
            eccentric.roller_length_m,
        ),
        ("bearings.eccentric.bore_m", eccentric.bore_m),
        ("bearings.sleeve_bore_m", bearings.sleeve_bore_m),
        (
            "structure.output_seat_length_m",
            structure.output_seat_length_m,
        ),
        ("structure.ring_seat_length_m", structure.ring_seat_length_m),
        ("structure.plate_thickness_m", structure.plate_thickness_m),
    ] {
        judge(name, value, lengths, &of_gear, LENGTHS);
    }
    let density = "foam to tungsten have";
    judge(
        "mass.density_kg_m3",
        scene.mass.density_kg_m3,
        DENSITY,
        density,
        &[(1e3, "g/cm^3")],
    );
    for (name, value, named) in [
        (
            "contact.young_pa",
            Some(contact.young_pa),
            &contact.material,
        ),
        (
            "contact.pin_young_pa",
            contact.pin_young_pa,
            &contact.pin_material,
        ),
    ] {
        if let Some(of) = named.as_deref().and_then(material) {
            let range = LIKE_ITS_MATERIAL.map(|share| share * of.young_pa);
            let why = format!("{} has, half to twice", of.name);
            judge(name, value, range, &why, &[]);
        }
    }
    let bore = scene
        .cranks
        .map_or_else(|| bore_radius_m(gear), |cranks| cranks.bore_radius_m);
    let most = SPEED_M_S / (bore * scene.eccentric_per_input().abs());
    let speed = Some(scene.drive.input_speed_rad_s.abs());
    let fastest = format!(
        "the fastest bearings with a bore of {} m reach {SPEED_M_S} m/s",
        short(bore)
    );
    judge(
        "drive.input_speed_rad_s",
        speed,
        [0.0, most],
        &fastest,
        &[(PI / 30.0, "rpm")],
    );
    let stress = STRENGTH * contact.young_pa;
    let modulus = contact.young_pa / (2.0 * (1.0 - contact.poisson * contact.poisson));
    let force =
        PI * contact.line_length_m * gear.external_sleeve_radius_m * stress * stress / modulus;
    let torque = gear.wheels as f64 * force / external_force(gear, 1.0);
    let load = Some(load_profile::largest(&scene.drive));
    let strongest = "pins of a perfect solid carry, whose strength is E/15";
    judge(
        "drive.output_torque_n_m",
        load,
        [0.0, torque],
        strongest,
        &[(1e-3, "N mm")],
    );
    list.extend(idle_step(scene));
    list
}

/// Returns a doubt about a stated step for a method that chooses its own.
fn idle_step(scene: &CheckedScene) -> Option<Assumption> {
    const KEY: &str = "solver.step_s";
    let solver = &scene.solver;
    let adapts = method(&solver.integrator).is_none_or(|method| method.adaptive);
    let origins = scene.origins();
    // A scene made in code states every key.
    let is_written = !origins.is_empty() && !origins.iter().any(|origin| origin.key == KEY);
    (adapts && is_written).then(|| Assumption {
        key: KEY.to_owned(),
        value: format!("{} s", short(solver.step_s)),
        reason: format!(
            "without effect on the native solver: integrator = \"{}\" chooses its steps by solver.tolerance; a fixed step has integrator = \"rk4\"",
            solver.integrator
        ),
    })
}
