//! Characteristic sizes of a gear under its largest static load: forces, penetrations, frequencies.
//!
//! The sizes set error scales, steps, samples and windows, so that gears of millimetres and of metres are treated alike. Linear
//! springs without clearance: the most loaded pin of a stage carries about F = 4 T/(l z) (T: load on one disc, l: lever, e
//! zs or R_w, z: pins). The scene's law gives its penetration and tangent stiffness k under that force. A quarter of all
//! pins, weighted by their levers, make the torsional stiffness k l^2 z/4. All discs in phase and the output are then two
//! masses on two springs:
//!
//! ```text
//! I_w theta'' = -A theta - B (theta - psi),    I_o psi'' = -w B (psi - theta)
//! ```
//! with two modes in closed form. Impacts press deeper than the load and are a little stiffer (by the cube root of the
//! depth's square root for a point contact); the verification of a run covers that.

use std::f64::consts::PI;

use crate::bearings::{BearingLaw, typical_force};
use crate::model::{Gear, Scene};
pub use crate::springs::{
    Spring, external_force, hertz, internal_force, law, law_parameters, least_depth, pin_law,
    state_depth,
};
use crate::springs::{outer, wheel_torque_of};

/// Characteristic sizes of a gear, SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Load torque on one disc, N m: the largest of the run; of an unloaded gear the torque of the [`least_depth`].
    pub wheel_torque_n_m: f64,
    /// Largest static force of a ring pin on a disc, N.
    pub external_force_n: f64,
    /// Penetration under the external force, m.
    pub penetration_m: f64,
    /// Tangent stiffness of an external contact under its largest force, N/m.
    pub contact_stiffness_n_m: f64,
    /// Slowest and fastest mode of the discs and the output together, rad/s.
    pub modes_rad_s: [f64; 2],
}

/// Returns the free rotation of a disc to one side by backlash and modification, rad, for pins without errors at all
/// angles: d sqrt(1 - m^2)/(e zs) for a backlash alone, 0 for an overlap.
pub fn free_play(gear: &Gear) -> f64 {
    let m = gear.shortening;
    if gear.modification.is_none() {
        return gear.backlash_m * (1.0 - m * m).sqrt() / gear.lever_m();
    }
    // If every contribution to the play is positive, the pin with the longest lever (cos phi = m) closes it.
    let share = |cos: f64| {
        let (gap, lever) = gear.initial_gap_m(cos.acos());
        gap / lever
    };
    let tried = (1..400).map(|k| share((PI * f64::from(k) / 400.0).cos()));
    tried.fold(share(m), f64::min).max(0.0)
}

/// Returns an upper bound of the free rotation of a disc, rad: [`free_play`] and the largest effect of individual errors.
pub fn largest_play(gear: &Gear) -> f64 {
    free_play(gear) + gear.errors.largest_of_mesh_m(gear) / gear.lever_m()
}

/// Returns the largest free rotation of the output in its holes, rad.
pub fn largest_hole_play(gear: &Gear) -> f64 {
    let clearance = gear.hole_radius_m - gear.internal_sleeve_radius_m - gear.eccentricity_m;
    (clearance.max(0.0) + gear.errors.largest_of_holes_m(gear)) / gear.internal_circle_radius_m
}

/// Rounding error of forces as a share of a scene's largest static force: 16 digits, times some ten thousand for the sums
/// of bodies and solver. 1.0e-9 N for the paper's gear.
const ROUNDING: f64 = 1e-11;

impl Scales {
    /// Returns the force above which a contact counts as pressing, N. Smaller forces are rounding errors of pins that just
    /// touch, as all do in the ideal mesh of a gear without backlash.
    pub fn pressing_n(&self) -> f64 {
        ROUNDING * self.external_force_n
    }

    /// Returns the torque below which there is only rounding, N m.
    pub fn rounding_n_m(&self) -> f64 {
        ROUNDING * self.wheel_torque_n_m
    }

    /// Returns the scales of a scene with values in range.
    pub fn of(scene: &Scene) -> Self {
        let gear = &scene.gear;
        let hertz = hertz(scene);
        let outer = outer(scene, &hertz);
        // A tight hole is far stiffer; nothing moves faster than in a hole with the usual clearance of e.
        let sleeve = gear.internal_sleeve_radius_m;
        let hole = gear.hole_radius_m.max(sleeve + gear.eccentricity_m);
        let inner = Spring::of(scene, hertz.of_hole(sleeve, hole));
        let lever = gear.lever_m();
        let least = least_depth(scene);
        let load = scene.largest_disc_load_n_m();
        let torque = wheel_torque_of(scene, &outer);
        let torsion = |spring: Spring, pin: Option<f64>, lever: f64, sleeves: usize| {
            let sleeves = sleeves as f64;
            let depth = spring.depth(4.0 * load / (lever * sleeves), least);
            let contact = spring.tangent(depth);
            let tangent = pin.map_or(contact, |pin| contact * pin / (contact + pin));
            0.25 * sleeves * tangent * lever * lever
        };
        let force = external_force(gear, torque);
        let penetration = outer.depth(force, least);
        let housing = torsion(outer, scene.ring_seat_n_m(), lever, gear.external_sleeves);
        let (circle, sleeves) = (gear.internal_circle_radius_m, gear.internal_sleeves);
        let on_cranks = scene.cranks.and_then(|_| BearingLaw::of(scene));
        let output = match on_cranks {
            Some(bearing) => {
                let stiffness = bearing.slope_under(typical_force(scene));
                sleeves as f64 * stiffness * circle * circle
            }
            None => {
                let pin = scene.output_pin_n_m();
                torsion(inner, pin, circle, sleeves)
            }
        };
        Self {
            wheel_torque_n_m: torque,
            external_force_n: force,
            penetration_m: penetration,
            contact_stiffness_n_m: outer.tangent(penetration),
            modes_rad_s: modes(scene, housing, output),
        }
    }

    /// Returns the time after which free vibrations of the slowest mode have fallen to a thousandth, s: with damping
    /// proportional to stiffness a mode decays at the rate omega^2 C/(2 k). `None` without damping.
    pub fn settling_s(&self, damping_n_s_m: f64) -> Option<f64> {
        let [slow, _] = self.modes_rad_s;
        let rate = 0.5 * slow * slow * damping_n_s_m / self.contact_stiffness_n_m;
        (rate > 0.0).then(|| 1000_f64.ln() / rate)
    }
}

/// Returns the frequencies of [[n I, 0], [0, J]] with [[n (k + c), -n c], [-n c, n c]]: the discs with the output and
/// against it.
fn modes(scene: &Scene, housing: f64, coupling: f64) -> [f64; 2] {
    let (gear, mass) = (&scene.gear, &scene.mass);
    let radius = gear.internal_circle_radius_m;
    let wheels = gear.wheels as f64;
    let carried = mass.internal_sleeve.mass_kg * radius * radius * gear.internal_sleeves as f64;
    let output = scene.output_shaft().moment_kg_m2 + carried;
    let wheel = mass.wheel.moment_kg_m2;
    let (a, b, c) = (
        (housing + coupling) / wheel,
        wheels * coupling / output,
        coupling / wheel,
    );
    // Roots of (a - x)(b - x) = c b; their product is a b - c b = b k/I.
    let fast = 0.5 * (a + b + ((a - b) * (a - b) + 4.0 * c * b).sqrt());
    let slow = b * (housing / wheel) / fast;
    [slow.sqrt(), fast.sqrt()]
}
