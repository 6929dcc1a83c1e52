//! Parts behind the contacts that give way: output pins that discs share, seats of pins, the output's plate, the input shaft.
//!
//! ```text
//! output pin, per unit force of disc v at disc w, at the distances a <= b from where it is held, S = k G A of its section
//!   at one end    a_wv = a^2 (3 b - a)/(6 E I) + a/S
//!   at both, L    a_wv = a (L - b) (L^2 - a^2 - (L - b)^2)/(6 E I L) + a (L - b)/(S L)
//! seat            d = 3.81 ((h_1 + h_2)/pi)^0.9 F^0.9/l^0.8,  h = (1 - nu^2)/E       secant under the rated largest force
//! plate           4 pi G t/(1/r_i^2 - 1/r_o^2)
//! input shaft     its stiffness times i^2
//! ```
//! Shear: k = 6 (1 + nu)/(7 + 6 nu) of round bars (G. R. Cowper, J. Appl. Mech. 33, 1966, 335). Seats: line contact after Palmgren
//! (*Ball and Roller Bearing Engineering*, 1959), which is 3.84e-5 F^0.9/l^0.8 of steel, whatever the radii. A pin's seat gives way
//! along with the pin, without tilt. What holds output pins, and the plate, is of their material.

use std::f64::consts::PI;

use pinwheel_contact::Material;

use crate::error::Fault;
use crate::materials::material;
use crate::model::{Detection, Held, Scene};
use crate::number::short;
use crate::springs::{external_force, internal_force, law_parameters, wheel_torque_n_m};

/// Largest number of discs that share pins.
pub const MOST_DISCS: usize = 4;
const DIAMETER: &str = "structure.output_pin_diameter_m";
const HELD: &str = "bearings.internal_sleeves_held";

fn shear_modulus(of: Material) -> f64 {
    0.5 * of.young / (1.0 + of.poisson)
}

/// Stiffness of a seat of this length (m) between two bodies under a force (N), N/m.
fn seat_n_m(length_m: f64, bodies: [Material; 2], force_n: f64) -> f64 {
    let softness: f64 = bodies.iter().map(|body| 1e6 * body.compliance()).sum();
    let approach_m = 3.81e-3 * (softness * force_n).powf(0.9) / (1e3 * length_m).powf(0.8);
    force_n / approach_m
}

impl Scene {
    /// Distances of the discs' middles from the flange that holds the output pins, m, nearest first, and the length of the pins
    /// between flanges on either side, m.
    pub fn output_pins_m(&self) -> (Vec<f64>, f64) {
        let width = self.gear.face_width_m.unwrap_or(self.contact.line_length_m);
        let gap = self.bearings.internal_sleeve_gap_m.unwrap_or_default();
        let wheels = self.gear.wheels;
        let at = |wheel: usize| gap + 0.5 * width + wheel as f64 * (width + gap);
        let span = wheels as f64 * (width + gap) + gap;
        ((0..wheels).map(at).collect(), span)
    }

    /// Influence coefficients of an output pin, m/N: its displacement at a disc, row by row, under a unit force of each disc.
    /// `None`: output pins are no beams.
    pub fn pin_influence_m_n(&self) -> Option<Vec<Vec<f64>>> {
        let diameter = self.structure.output_pin_diameter_m?;
        let held = self.bearings.internal_sleeves_held?;
        let pin = law_parameters(self).pin;
        let (bending, area) = (
            6.0 * pin.young * PI / 64.0 * diameter.powi(4),
            0.25 * PI * diameter * diameter,
        );
        let share = 6.0 * (1.0 + pin.poisson) / (7.0 + 6.0 * pin.poisson);
        let shear = share * shear_modulus(pin) * area;
        let seat = self.structure.output_seat_length_m.map_or(0.0, |length| {
            let force = internal_force(&self.gear, wheel_torque_n_m(self));
            1.0 / seat_n_m(length, [pin; 2], force)
        });
        let (places, span) = self.output_pins_m();
        let given_way = |one: f64, other: f64| {
            let (a, b) = (one.min(other), one.max(other));
            let beyond = span - b;
            match held {
                Held::OneEnd => a * a * (3.0 * b - a) / bending + a / shear + seat,
                Held::BothEnds => {
                    let rest = span * span - a * a - beyond * beyond;
                    let seats = (span - a) * beyond + a * b;
                    a * beyond / span * (rest / bending + 1.0 / shear)
                        + seat * seats / (span * span)
                }
            }
        };
        let row = |&one: &f64| places.iter().map(|&other| given_way(one, other)).collect();
        Some(places.iter().map(row).collect())
    }

    /// Stiffness of an output pin at a disc against that disc's force, N/m, mean of the discs; `None`: rigid.
    pub(crate) fn output_pin_n_m(&self) -> Option<f64> {
        let own = self.bearings.internal_sleeve_stiffness_n_m;
        own.or_else(|| {
            let influence = self.pin_influence_m_n()?;
            let own = influence.iter().enumerate().map(|(disc, row)| row[disc]);
            Some(influence.len() as f64 / own.sum::<f64>())
        })
    }

    /// Stiffness of a ring pin's seat in series with its contacts, N/m; `None`: rigid.
    pub fn ring_seat_n_m(&self) -> Option<f64> {
        let pin = law_parameters(self).pin;
        let named = self.structure.housing_material.as_deref();
        let housing = named.and_then(material).map_or(pin, |of| Material {
            young: of.young_pa,
            poisson: of.poisson,
        });
        let force = external_force(&self.gear, wheel_torque_n_m(self));
        let length = self.structure.ring_seat_length_m?;
        Some(seat_n_m(length, [pin, housing], force))
    }

    /// Twist of the output beyond its pins under a torque (N m), rad: of carrier and flange, plate and input shaft. A held carrier
    /// twists under its own moment, and a ring follows by the same ratio.
    pub fn flange_twist_rad(&self, torque_n_m: f64) -> f64 {
        let structure = &self.structure;
        let flange = self.bearings.output_torsion_n_m_rad;
        let plate = structure.plate_thickness_m.zip(structure.plate_radius_m);
        let plate = plate.map(|(thickness, radius)| {
            let circle = self.gear.internal_circle_radius_m;
            let radii = (circle.powi(-2) - radius.powi(-2)).abs();
            4.0 * PI * shear_modulus(law_parameters(self).pin) * thickness / radii
        });
        let input = structure
            .input_torsion_n_m_rad
            .map(|k| k * self.ratio().powi(2));
        let ratio = self.carrier_moment_per_output().powi(2);
        let held = [flange, plate].map(|spring| spring.map(|k| k / ratio));
        let springs = held.into_iter().chain([input]).flatten();
        springs.map(|stiffness| torque_n_m / stiffness).sum()
    }

    /// Returns elastic parts and temperatures in words, each with its model.
    pub fn structure_in_words(&self) -> Vec<(String, String)> {
        let structure = &self.structure;
        let mut rows = Vec::new();
        let mut add = |what: String, how: &str| rows.push((what, how.to_owned()));
        if let Some(influence) = self.pin_influence_m_n() {
            let own = influence.iter().enumerate();
            let own: Vec<String> = own
                .map(|(k, row)| format!("{:.1e}", 1.0 / row[k]))
                .collect();
            let how = "structure.output_pin_diameter_m: beams without mass that all discs bend; bending, shear and seat";
            add(
                format!("output pins of {} N/m at each disc", own.join(", ")),
                how,
            );
        }
        if let Some(seat) = self.ring_seat_n_m() {
            let how = "structure.ring_seat_length_m: line contact in series, linear through the rated largest force";
            add(format!("seats of ring pins of {seat:.1e} N/m"), how);
        }
        if let Some(clearance) = structure.ring_slot_clearance_m {
            let how = "structure.ring_slot_clearance_m: a pin is pressed to the bottom of its slot along the normal";
            add(
                format!("ring pins in slots with {} um", short(1e6 * clearance)),
                how,
            );
        }
        if structure
            .plate_thickness_m
            .or(structure.input_torsion_n_m_rad)
            .is_some()
        {
            let stiffness = self.flange_twist_rad(1.0).recip();
            let how = "[structure], in statics alone: under a stated load the angle of a flange or of the motor follows from it";
            add(
                format!("plate, flange and input shaft of {stiffness:.2e} N m/rad"),
                how,
            );
        }
        if let Some(warmth) = self.temperature {
            let [housing, disc, pins] = [warmth.housing_k, warmth.disc_k, warmth.pins_k].map(short);
            let how = "[temperature]: sizes of ring, discs with eccentrics and carrier, and pins, by the expansion of their materials";
            add(
                format!("housing {housing} K, discs {disc} K, pins {pins} K warmer than measured"),
                how,
            );
        }
        rows
    }
}

/// Checks keys that belong together.
pub(crate) fn check(scene: &Scene) -> Result<(), Fault> {
    let (structure, gear, bearings) = (&scene.structure, &scene.gear, &scene.bearings);
    let fault = |keys: &[&'static str], what: &str, remedy: &str| {
        Err(Fault::new(keys, what.to_owned(), remedy))
    };
    if structure.output_seat_length_m.is_some() && structure.output_pin_diameter_m.is_none() {
        let what = "is missing; a seat gives way along with its pin";
        return fault(&[DIAMETER], what, "give it too");
    }
    if let Some(diameter) = structure.output_pin_diameter_m {
        let pin_m = 2.0 * gear.internal_sleeve_radius_m;
        if scene.cranks.is_some() {
            let what = "is for output pins, and an RV gear has none";
            return fault(&[DIAMETER], what, "leave it out");
        }
        if bearings.internal_sleeves_held.is_none() {
            let what = "is missing, and it supports the output pins";
            return fault(&[HELD, DIAMETER], what, "give \"one-end\" or \"both-ends\"");
        }
        if bearings.internal_sleeve_stiffness_n_m.is_some() {
            let keys = [DIAMETER, "bearings.internal_sleeve_stiffness_n_m"];
            let what = "bends output pins that have a stiffness already";
            return fault(&keys, what, "leave one of both out");
        }
        if diameter > pin_m {
            let what = format!("is more than the {} m of an output pin", short(pin_m));
            let keys = [DIAMETER, "gear.internal_sleeve_radius_m"];
            return fault(
                &keys,
                &what,
                "give the diameter that bends, at most that of its sleeve",
            );
        }
        if gear.wheels > MOST_DISCS {
            let what = format!("bends pins that at most {MOST_DISCS} discs can share");
            return fault(&[DIAMETER, "gear.wheels"], &what, "leave it out");
        }
        if scene.contact.detection == Detection::Points {
            let what = "moves pins in holes by less than their points are apart";
            let keys = [DIAMETER, "contact.detection"];
            return fault(&keys, what, "use detection = \"exact\"");
        }
    }
    if structure.plate_thickness_m.is_some() != structure.plate_radius_m.is_some() {
        let keys = ["structure.plate_thickness_m", "structure.plate_radius_m"];
        let what = "is given alone; a plate has a thickness and the radius of its flange";
        return fault(&keys, what, "give both or none");
    }
    Ok(())
}
