//! Suggestions for a gear that can be assembled: clearances by fits, bearings, pins that bend and friction, each with its reason.
//!
//! ```text
//!  clearance across the diameter: least  = g of ISO 286-1, 2.5 D^0.34 um (D in mm)
//!                                 largest = least + IT(n) of the hole + IT(n - 1) of the pin
//! ```
//!
//! | process | hole and pin | source of the grade |
//! |---|---|---|
//! | `ground`, `edm`, `milled` | H6/g5, H7/g6, H8/g7 | grades of the processes: IT6 ground, IT7 finely eroded, IT8 milled |
//! | `printed` | H12/g11 | +-0.1 to 0.2 mm of fused filament is IT12 of 10 to 30 mm |
//!
//! A disc's edge follows its ring pins as a hole follows a pin: an equidistant cut by that fit. Bearings have the radial clearance of
//! ISO 5753-1 for cylindrical roller bearings, group 2 if ground and Normal otherwise. All clearances here are radial: half of these.

use std::f64::consts::PI;

use crate::bearings::of_rollers;
use crate::body::bore_radius_m;
use crate::model::Gear;
use crate::number::{nearest, rounded_down, written};
pub(crate) use crate::uncertain::UNCERTAIN;

/// Process by which discs are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Process {
    /// Name on the command line.
    pub name: &'static str,
    /// IT grade of a hole; its pin is one grade finer.
    grade: usize,
    /// Limits of a bearing's diametral internal clearance, um, for each of the bores of [`BORES_MM`].
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

const fn process_of(name: &'static str, grade: usize, clearance_um: [[f64; 2]; 7]) -> Process {
    Process {
        name,
        grade,
        clearance_um,
    }
}

/// Processes that a catalogue can name.
pub const PROCESSES: &[Process] = &[
    process_of("ground", 6, GROUP_2),
    process_of("edm", 7, GROUP_NORMAL),
    process_of("milled", 8, GROUP_NORMAL),
    process_of("printed", 12, GROUP_NORMAL),
];

/// Returns the process with a name.
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

/// Returns the standard tolerance of a grade from 5 to 12 for a size, m (ISO 286-1). Above 500 mm it stays that of 500 mm.
pub fn tolerance_m(size_m: f64, grade: usize) -> f64 {
    1e-6 * row(&STEPS_MM, size_m, &IT7_UM) * UNITS[grade - 5] / UNITS[2]
}

/// Returns the entry of the first row with a size of at least `size_m`; of larger ones the last.
fn row<T: Copy>(sizes_mm: &[f64], size_m: f64, entries: &[T]) -> T {
    let place = sizes_mm.partition_point(|size| *size < 1e3 * size_m * (1.0 - 1e-9));
    entries[place.min(entries.len() - 1)]
}

/// Radial clearance: nominal value and half-width of its interval, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Clearance {
    pub(crate) usual_m: f64,
    half_m: f64,
}

impl Clearance {
    /// Returns the radial clearance between two diametral limits, m, rounded to 0.1 um.
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
    /// Returns the radial clearance of a pin of this diameter in its hole.
    pub(crate) fn fit(&self, diameter_m: f64) -> Clearance {
        let least = 2.5e-6 * (1e3 * diameter_m).powf(0.34);
        let both = [self.grade, self.grade - 1].map(|grade| tolerance_m(diameter_m, grade));
        Clearance::between([least, least + both[0] + both[1]])
    }

    /// True if ring pins are printed in or pressed into plastic, and do not turn.
    fn holds_pins(&self) -> bool {
        self.name == "printed"
    }

    fn bearing(&self, bore_m: f64) -> Clearance {
        let limits_um = row(&BORES_MM, bore_m, &self.clearance_um);
        Clearance::between(limits_um.map(|um| 1e-6 * um))
    }
}

/// Radius of a needle over that of its outer raceway; share of the circumference that needles fill; their length over the
/// disc's thickness.
pub(crate) const NEEDLE: f64 = 0.12;
const NEEDLES: [f64; 2] = [0.85, 0.9];
/// Diameter of an output pin over that of its sleeve.
const CORE: f64 = 0.7;
/// Distance of neighbouring discs over their thickness.
const PITCH: f64 = 1.1;

/// Returns the number of needles of a bearing of these proportions and their length on a disc of this thickness, m.
pub(crate) fn needles(face_width_m: f64) -> (f64, f64) {
    let [around, along] = NEEDLES;
    let count = (around * PI * (1.0 - NEEDLE) / NEEDLE).floor();
    (count, rounded_down(along * face_width_m))
}

/// Catalogue data that determine a gear as built.
pub(crate) struct Basis {
    pub(crate) process: &'static Process,
    /// Young's modulus of the pins, Pa.
    pub(crate) pin_young_pa: f64,
    /// True if discs are of plastic and run dry.
    pub(crate) is_plastic: bool,
    pub(crate) friction_coefficient: Option<f64>,
    /// True if the backlash of the ring pins is given.
    pub(crate) has_backlash: bool,
    pub(crate) cranks: Option<usize>,
    pub(crate) torque_n_m: f64,
}

impl Basis {
    /// Returns the lines of a gear as built, `key = value # reason`, and the half-widths of its clearances.
    pub(crate) fn lines(&self, gear: &Gear) -> String {
        let m = written;
        let face = gear.face_width_m.unwrap_or_default();
        let (rollers, length) = needles(face);
        let outer = self
            .cranks
            .map_or_else(|| bore_radius_m(gear), |_| gear.hole_radius_m);
        let raceway = nearest(2.0 * outer * (1.0 - 2.0 * NEEDLE), 4);
        let radii = [gear.external_sleeve_radius_m, gear.hole_radius_m];
        let [ring, hole] = radii.map(|radius| self.process.fit(2.0 * radius));
        let bearing = self.process.bearing(raceway);
        let Process { name, grade, .. } = self.process;
        let fit = format!("H{grade}/g{} of ISO 286-1, {name}", grade - 1);
        let (usual, state) = match self.is_plastic {
            true => (0.2, "0.1 to 0.2 dry"),
            false => (0.02, "0.01 to 0.02 in oil"),
        };
        let is_held = self.process.holds_pins();
        let who = if is_held { "output pins" } else { "pins" };
        let mu = self.friction_coefficient.unwrap_or(usual);
        let note = self.friction_coefficient.map_or("", |_| "as given; ");
        let inertia = |diameter: f64| PI / 64.0 * diameter.powi(4);
        let mut text = format!(
            "bearings.eccentric.clearance_m = {} # radial: half of ISO 5753-1, cylindrical rollers\n\
             bearings.eccentric.friction_coefficient = 0.0025 # needles with a cage have 0.002 to 0.003 (JTEKT)\n\
             bearings.eccentric.bore_m = {} # inner raceway\n\
             bearings.sleeve_friction_coefficient = {mu} # {who} turn, and roll on the discs; {note}plain bearings have {state} (JTEKT)\n",
            m(bearing.usual_m),
            m(raceway),
        );
        if is_held {
            text += "gear.external_sleeves_turn = false # pins printed in or pressed in: discs slide on them\n";
            if self.friction_coefficient.is_none() {
                text += &format!(
                    "contact.friction_coefficient = {mu} # of discs on pins that do not turn: {state}\n"
                );
            }
        }
        let mut fits = vec![("bearings.eccentric.clearance_m", bearing)];
        if !self.has_backlash {
            fits.push(("gear.modification.equidistant_m", ring));
            let cut = m(ring.usual_m);
            text += &format!(
                "gear.modification.equidistant_m = {cut} # the discs' edge lies further in: {fit}, on the ring pins\n"
            );
        }
        if let Some(cranks) = self.cranks {
            // Two such bearings support a crank beside the discs; the rated force between them bends it.
            let force_n = self.torque_n_m.abs() / (cranks as f64 * gear.internal_circle_radius_m);
            let (stiffness, exponent) = of_rollers(2.0 * rollers, length);
            let approach = (force_n / stiffness).powf(1.0 / exponent);
            let span = (gear.wheels as f64 * PITCH + 1.0) * face;
            let shaft = raceway - 2.0 * gear.eccentricity_m;
            let bending = span.powi(3) / (48.0 * self.pin_young_pa * inertia(shaft));
            let supports = 1.0 / (approach / force_n + bending);
            return text
                + &format!(
                    "bearings.sleeve_bore_m = {} # ring pins turn in grooves\n\
                 cranks.support_stiffness_n_m = {supports:.1e} # two needle bearings a crank (Palmgren, rated load), 48 E I/l^3 between them\n\
                 cranks.mesh_stiffness_n_m = {:.1e} # 1.4e10 N/m a metre of face width (ISO 6336)\n{}",
                    m(radii[0] * 2.0),
                    1.4e10 * face,
                    toleranced(&fits)
                );
        }
        fits.push(("gear.hole_radius_m", hole));
        let pin = rounded_down(2.0 * CORE * gear.internal_sleeve_radius_m);
        let cube = |disc: usize| ((disc as f64 + 0.5) * PITCH * face).powi(3);
        let cubes: f64 = (0..gear.wheels).map(cube).sum();
        let bending = 3.0 * self.pin_young_pa * inertia(pin) * gear.wheels as f64 / cubes;
        text + &format!(
            "gear.hole_radius_m = {} # pin + e + {:.1} um: {fit}\n\
             bearings.eccentric.rollers = {rollers} # needles in a disc's bore\n\
             bearings.eccentric.roller_length_m = {} # 0.9 of a disc\n\
             bearings.eccentric.roller_diameter_m = {} # for its ratings\n\
             gear.eccentric_bore_radius_m = {} # of a disc\n\
             bearings.internal_sleeves_held = \"one-end\" # output pins, for their bending\n\
             bearings.internal_sleeve_gap_m = {} # beside each disc\n\
             bearings.sleeve_bore_m = {} # output pins, 0.7 of their sleeves; thinner ring pins turn in grooves\n\
             bearings.internal_sleeve_stiffness_n_m = {bending:.1e} # output pins held at one end: 3 E I/l^3, mean of the discs\n{}",
            m(gear.hole_radius_m),
            1e6 * hole.usual_m,
            m(length),
            m(rounded_down(2.0 * NEEDLE * outer)),
            m(rounded_down(outer)),
            m(rounded_down((PITCH - 1.0) * face)),
            m(pin),
            toleranced(&fits)
        )
    }
}

/// Returns the lines of half-widths.
fn toleranced(fits: &[(&str, Clearance)]) -> String {
    let line = |(key, Clearance { usual_m, half_m }): &(&str, Clearance)| {
        let [least, largest] =
            [usual_m - half_m, usual_m + half_m].map(|end| (1e7 * end).round() / 10.0);
        let half = written(*half_m);
        format!(
            "{UNCERTAIN}.{key} = {{ plus_minus = {half} }} # clearance of {least} to {largest} um\n"
        )
    };
    fits.iter().map(line).collect()
}

/// Returns the keys of the suggested lines.
pub(crate) fn suggested(lines: &str) -> impl Iterator<Item = String> {
    let keys = lines.lines().filter_map(|line| line.split(" = ").next());
    keys.filter(|key| !key.starts_with(UNCERTAIN))
        .map(str::to_owned)
}

/// Returns the lines of a section; with its header if `is_new` and there are any.
pub(crate) fn section(lines: &str, name: &str, is_new: bool) -> String {
    let mark = if name == UNCERTAIN { "" } else { "suggested: " };
    let mut text = String::new();
    for line in lines
        .lines()
        .filter_map(|line| line.strip_prefix(name)?.strip_prefix('.'))
    {
        let (assignment, why) = line.split_once(" # ").unwrap_or((line, ""));
        let nested = assignment
            .split(" = ")
            .next()
            .is_some_and(|key| key.contains('.'));
        if nested && name != UNCERTAIN {
            continue;
        }
        if is_new && text.is_empty() {
            text = format!("\n[{name}]\n");
        }
        text += &format!("{assignment:<44} # {mark}{why}\n");
    }
    text
}
