//! What a gear has that can be assembled: clearances by fits, bearings, pins that bend, friction. Suggested, each with its reason.
//!
//! ```text
//!  clearance across the diameter: least  = g of ISO 286-1, 2.5 D^0.34 um (D in mm)
//!                                 largest = least + IT(n) of the hole + IT(n - 1) of the pin
//! ```
//!
//! | process | hole and pin | source of the grade |
//! |---|---|---|
//! | `ground`, `edm`, `milled` | H6/g5, H7/g6, H8/g7 | grades that processes hold: IT6 ground, IT7 finely eroded, IT8 milled |
//! | `printed` | H12/g11 | +-0.1 to 0.2 mm of fused filament is IT12 of 10 to 30 mm |
//!
//! A disc's edge follows its ring pins as a hole follows a pin: an equidistant cut by that fit. Bearings have the radial clearance of
//! ISO 5753-1 for cylindrical roller bearings, group 2 if ground and Normal otherwise. All clearances here are radial: half of these.

use std::f64::consts::PI;

use crate::bearings::of_rollers;
use crate::body::bore_radius_m;
use crate::catalogue::{Catalogue, Material, rounded_down};
use crate::model::Gear;
use crate::number::{nearest, short, written};
pub(crate) use crate::uncertain::UNCERTAIN;

/// A process by which discs are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Process {
    /// Name as typed.
    pub name: &'static str,
    /// IT grade of a hole; its pin is one grade finer.
    grade: usize,
    /// Limits of the radial internal clearance of a bearing, um across, to each of the bores of [`BORES_MM`].
    clearance_um: [[f64; 2]; 7],
}

/// Largest bores of the rows of ISO 5753-1, mm.
const BORES_MM: [f64; 7] = [30.0, 40.0, 50.0, 65.0, 80.0, 100.0, 120.0];
#[rustfmt::skip]
const GROUP_2: [[f64; 2]; 7] =
    [[0.0, 25.0], [5.0, 30.0], [5.0, 35.0], [10.0, 40.0], [10.0, 45.0], [15.0, 50.0], [15.0, 55.0]];
#[rustfmt::skip]
const GROUP_NORMAL: [[f64; 2]; 7] =
    [[20.0, 45.0], [25.0, 50.0], [30.0, 60.0], [40.0, 70.0], [40.0, 75.0], [50.0, 85.0], [50.0, 90.0]];

macro_rules! processes {
    ($($name:literal $grade:literal $clearance_um:ident;)*) => {
        &[$(Process { name: $name, grade: $grade, clearance_um: $clearance_um }),*]
    };
}

/// Processes that a catalogue can name.
pub const PROCESSES: &[Process] = processes! {
    "ground" 6 GROUP_2;
    "edm" 7 GROUP_NORMAL;
    "milled" 8 GROUP_NORMAL;
    "printed" 12 GROUP_NORMAL;
};

/// The process of a name.
#[must_use]
pub fn process(name: &str) -> Option<&'static Process> {
    PROCESSES.iter().find(|process| process.name == name)
}

/// Largest sizes of the steps of ISO 286-1, mm, and IT7 of each, um; the other grades are in proportion to the tolerance unit.
const STEPS_MM: [f64; 13] = [
    3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0, 180.0, 250.0, 315.0, 400.0, 500.0,
];
const IT7_UM: [f64; 13] = [
    10.0, 12.0, 15.0, 18.0, 21.0, 25.0, 30.0, 35.0, 40.0, 46.0, 52.0, 57.0, 63.0,
];
/// Tolerance units of IT5 to IT12.
const UNITS: [f64; 8] = [7.0, 10.0, 16.0, 25.0, 40.0, 64.0, 100.0, 160.0];

/// Standard tolerance of a grade from 5 to 12 for a size, m (ISO 286-1). Sizes above 500 mm have that of 500 mm.
#[must_use]
pub fn tolerance_m(size_m: f64, grade: usize) -> f64 {
    1e-6 * row(&STEPS_MM, size_m, &IT7_UM) * UNITS[grade - 5] / UNITS[2]
}

/// Entry of the first row whose size is not below `size_m`; the last of larger ones.
fn row<T: Copy>(sizes_mm: &[f64], size_m: f64, entries: &[T]) -> T {
    let place = sizes_mm.partition_point(|size| *size < 1e3 * size_m * (1.0 - 1e-9));
    entries[place.min(entries.len() - 1)]
}

/// A radial clearance: the usual one, and by how much it may be less or more, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clearance {
    pub(crate) usual_m: f64,
    half_m: f64,
}

impl Clearance {
    /// Clearance between two limits across the diameter, m, to a tenth of a micrometre.
    fn between([least, largest]: [f64; 2]) -> Self {
        let tenths = |length: f64| (1e7 * length).round() / 1e7;
        let half_m = tenths(0.25 * (largest - least));
        Self {
            usual_m: half_m + tenths(0.5 * least),
            half_m,
        }
    }
}

impl Process {
    /// Radial clearance of a pin of this diameter in its hole.
    pub(crate) fn fit(&self, diameter_m: f64) -> Clearance {
        let least = 2.5e-6 * (1e3 * diameter_m).powf(0.34);
        let both = [self.grade, self.grade - 1].map(|grade| tolerance_m(diameter_m, grade));
        Clearance::between([least, least + both[0] + both[1]])
    }

    fn bearing(&self, bore_m: f64) -> Clearance {
        let limits_um = row(&BORES_MM, bore_m, &self.clearance_um);
        Clearance::between(limits_um.map(|um| 1e-6 * um))
    }

    fn words(&self) -> String {
        format!("H{}/g{} of ISO 286", self.grade, self.grade - 1)
    }
}

/// A suggested line of a scene.
pub(crate) struct Suggestion {
    pub(crate) key: &'static str,
    value: String,
    why: String,
}

/// Radius of a needle as a share of its bearing's outer raceway, how much of the way around needles take, and how much of the
/// disc's thickness.
const NEEDLE: f64 = 0.12;
const NEEDLES: [f64; 2] = [0.85, 0.9];
/// Diameter of an output pin as a share of its sleeve's.
const CORE: f64 = 0.7;
/// Thickness of a disc with the gap beside it, as a share of the disc's.
const PITCH: f64 = 1.1;
/// Young's modulus below which a disc is of plastic, Pa.
const PLASTIC_PA: f64 = 2e10;

/// Needles of a bearing, which are as many in every bearing of these proportions, and their length on a disc of this thickness, m.
pub(crate) fn needles(face_width_m: f64) -> (f64, f64) {
    let [around, along] = NEEDLES;
    let count = (around * PI * (1.0 - NEEDLE) / NEEDLE).floor();
    (count, rounded_down(along * face_width_m))
}

impl Catalogue {
    /// Process of the discs: the one given, or the usual one of the material; `None` of an ideal gear.
    pub(crate) fn process(&self) -> Option<&'static Process> {
        let usual = match self.material.name {
            "pla" | "nylon" => "printed",
            "pom" => "milled",
            _ => "ground",
        };
        let process = self.process.or_else(|| process(usual));
        process.filter(|_| !self.ideal)
    }

    /// Material of the pins: the one given, or steel; of an ideal gear that of the discs.
    pub(crate) fn pins(&self) -> Material {
        let usual = match self.ideal {
            true => self.material,
            false => crate::catalogue::MATERIALS[0],
        };
        self.pin_material.unwrap_or(usual)
    }

    /// Lines of a gear as built, and the halves of the intervals of its clearances.
    pub(crate) fn as_built(&self, gear: &Gear) -> Vec<Suggestion> {
        let Some(process) = self.process() else {
            return Vec::new();
        };
        let mut lines = Vec::new();
        let mut add = |key, value: f64, why: String| {
            let value = match key {
                "bearings.eccentric.rollers" => format!("{value}"),
                _ if value < 1e5 => written(value),
                _ => format!("{value:e}"),
            };
            lines.push(Suggestion { key, value, why });
        };
        let face = gear.face_width_m.unwrap_or_default();
        let (made, fit) = (process.name, process.words());
        let (count, length) = needles(face);
        let on_cranks = self.cranks.is_some();
        let outer = if on_cranks {
            gear.hole_radius_m
        } else {
            bore_radius_m(gear)
        };
        let raceway = nearest(2.0 * outer * (1.0 - 2.0 * NEEDLE), 4);
        let ring = process.fit(2.0 * gear.external_sleeve_radius_m);
        let hole = process.fit(2.0 * gear.hole_radius_m);
        let bearing = process.bearing(raceway);
        let pin = rounded_down(2.0 * CORE * gear.internal_sleeve_radius_m);
        if self.backlash_m.is_none() {
            let why = format!("the discs' edge lies further in: {fit} on the ring pins, {made}");
            add("gear.modification.equidistant_m", ring.usual_m, why);
        }
        if !on_cranks {
            let why = format!("pin + e + {} um: {fit}, {made}", short(1e6 * hole.usual_m));
            add("gear.hole_radius_m", gear.hole_radius_m, why);
            add(
                "bearings.eccentric.rollers",
                count,
                "needles in a disc's bore".to_owned(),
            );
            add(
                "bearings.eccentric.roller_length_m",
                length,
                "0.9 of a disc".to_owned(),
            );
        }
        let why = "radial: half of ISO 5753-1, cylindrical rollers";
        add(
            "bearings.eccentric.clearance_m",
            bearing.usual_m,
            why.to_owned(),
        );
        let why = "needles with a cage have 0.002 to 0.003 (JTEKT)";
        add(
            "bearings.eccentric.friction_coefficient",
            0.0025,
            why.to_owned(),
        );
        add(
            "bearings.eccentric.bore_m",
            raceway,
            "inner raceway".to_owned(),
        );
        let (bore, turns) = match on_cranks {
            true => (
                2.0 * gear.external_sleeve_radius_m,
                "ring pins turn in grooves",
            ),
            false => (
                pin,
                "of output pins, 0.7 of their sleeves; thinner ring pins turn in grooves",
            ),
        };
        let is_plastic = self.material.young_pa < PLASTIC_PA;
        let (mu, state) = if is_plastic {
            (0.2, "dry plastic")
        } else {
            (0.05, "oiled steel")
        };
        let (mu, state) = self
            .friction_coefficient
            .map_or((mu, state), |mu| (mu, "given"));
        let why = format!("{state}; discs roll on pins, which turn");
        add("bearings.sleeve_friction_coefficient", mu, why);
        add("bearings.sleeve_bore_m", bore, turns.to_owned());
        let young = self.pins().young_pa;
        let inertia = |diameter: f64| PI / 64.0 * diameter.powi(4);
        if let Some(cranks) = self.cranks {
            // Two such bearings hold a crank beside the discs; the rated force between them bends it.
            let force_n = self.torque_n_m.abs() / (cranks as f64 * gear.internal_circle_radius_m);
            let (stiffness, exponent) = of_rollers(2.0 * count, length);
            let approach = (force_n / stiffness).powf(1.0 / exponent);
            let span = (gear.wheels as f64 * PITCH + 1.0) * face;
            let shaft = raceway - 2.0 * gear.eccentricity_m;
            let bending = span.powi(3) / (48.0 * young * inertia(shaft));
            let stiffness = 1.0 / (approach / force_n + bending);
            let why =
                "two needle bearings a crank (Palmgren, rated load) and 48 E I/l^3 between them";
            add(
                "cranks.support_stiffness_n_m",
                two_digits(stiffness),
                why.to_owned(),
            );
            let why = "1.4e10 N/m a metre of face width (ISO 6336)".to_owned();
            add("cranks.mesh_stiffness_n_m", two_digits(1.4e10 * face), why);
        } else {
            let cube = |disc: usize| ((disc as f64 + 0.5) * PITCH * face).powi(3);
            let cubes: f64 = (0..gear.wheels).map(cube).sum();
            let stiffness = 3.0 * young * inertia(pin) * gear.wheels as f64 / cubes;
            let why = "pins held at one end bend: 3 E I/l^3, mean of the discs";
            add(
                "bearings.internal_sleeve_stiffness_n_m",
                two_digits(stiffness),
                why.to_owned(),
            );
        }
        let fits = [
            ("gear.hole_radius_m", hole, !on_cranks),
            (
                "gear.modification.equidistant_m",
                ring,
                self.backlash_m.is_none(),
            ),
            ("bearings.eccentric.clearance_m", bearing, true),
        ];
        for (key, clearance, _) in fits.into_iter().filter(|(.., has)| *has) {
            let um = |length: f64| short(1e6 * length);
            let Clearance { usual_m, half_m } = clearance;
            let [least, largest] = [usual_m - half_m, usual_m + half_m].map(um);
            lines.push(Suggestion {
                key: UNCERTAIN,
                value: format!("{key} = {{ plus_minus = {} }}", written(half_m)),
                why: format!("clearance of {least} to {largest} um"),
            });
        }
        lines
    }
}

fn two_digits(value: f64) -> f64 {
    let unit = 10_f64.powi(value.log10().floor() as i32 - 1);
    (value / unit).round() * unit
}

/// Lines of a section; with its head if `is_new` and there are any.
pub(crate) fn section(lines: &[Suggestion], name: &str, is_new: bool) -> String {
    let mut text = String::new();
    for Suggestion { key, value, why } in lines {
        let (place, last) = key.rsplit_once('.').unwrap_or((key, ""));
        if place != name {
            continue;
        }
        if is_new && text.is_empty() {
            text = format!("\n[{name}]\n");
        }
        let (assignment, mark) = match last {
            "" => (value.clone(), ""),
            _ => (format!("{last} = {value}"), "suggested: "),
        };
        text.push_str(&format!("{assignment:<44} # {mark}{why}\n"));
    }
    text
}
