//! Table of all keys of a scene: meaning, permitted values and default of each.
//!
//! Reading, checking, `explain`, the JSON schema ([`crate::schema`]) and messages all follow this table. A new key is a
//! field of the model ([`crate::Scene`]), a row here, and its use. Omitted keys are filled in row by row, so a formula may
//! use any row above its own.

use toml::{Table, Value};

use crate::formulas::{self, Inputs};
use crate::names;
use crate::table::lookup;

/// Kind of a key's value.
#[derive(Clone, Copy)]
pub enum Kind {
    /// Number within a range.
    Number(Range),
    /// Integer between two limits, both included.
    Count(usize, usize),
    /// Name from a fixed list.
    Choice(&'static str, fn() -> Vec<&'static str>),
    /// True or false.
    Flag,
    /// Text.
    Text,
    /// List of texts.
    Texts,
    /// List of names from a fixed list.
    Choices(&'static str, fn() -> Vec<&'static str>),
    /// List of numbers, each within a range.
    Numbers(Range),
    /// List of tables with these rows as keys.
    Tables(&'static [Key]),
}

/// Permitted interval of a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Range {
    /// low <= x <= high
    From(f64, f64),
    /// low < x < high
    Between(f64, f64),
}

/// Default of an omitted key.
#[derive(Clone, Copy)]
pub enum DefaultValue {
    /// None: the omission is an error.
    Required,
    /// None: the omission is an error if another key of the table is given.
    Needed,
    /// None needed: the key enables an option.
    Nothing,
    /// Usual value, as TOML, and its reason.
    Constant(&'static str, &'static str),
    /// Value computed from others, and its formula; `None` if these are missing.
    Formula(fn(&Inputs<'_>) -> Option<f64>, &'static str),
}

/// Key of a scene.
#[derive(Clone, Copy)]
pub struct Key {
    /// Full name, `gear.eccentricity_m`; the unit ends it.
    pub name: &'static str,
    /// Kind of the key's value.
    pub kind: Kind,
    /// Default of the key.
    pub otherwise: DefaultValue,
    /// Meaning of the key.
    pub about: &'static str,
    /// Hint after a wrong value.
    pub hint: &'static str,
}

/// Returns every row with the value in a scene's table.
pub(crate) fn values(table: &Table) -> impl Iterator<Item = (&'static Key, Option<&Value>)> {
    // Rows of one table are adjacent, so each table is looked up once.
    let mut last = ("", Some(table));
    KEYS.iter().map(move |row| {
        let (place, name) = row.name.rsplit_once('.').unwrap_or(("", row.name));
        if place != last.0 {
            last = (place, lookup(table, place).and_then(Value::as_table));
        }
        (row, last.1.and_then(|inner| inner.get(name)))
    })
}

impl Range {
    // Negated comparisons would let NaN pass; these do not.
    pub(crate) fn holds(self, x: f64) -> bool {
        match self {
            Self::From(low, high) => x >= low && x <= high,
            Self::Between(low, high) => x > low && x < high,
        }
    }

    pub(crate) fn words(self) -> String {
        use crate::number::short;
        match self {
            Self::From(low, high) => format!("from {} to {}", short(low), short(high)),
            Self::Between(low, high) => format!("above {} and below {}", short(low), short(high)),
        }
    }
}

/// Endings of names with their units.
const UNITS: [(&str, &str); 19] = [
    ("stiffness_n_m", "N/m"),
    ("spring_n_m", "N/m"),
    ("_n_m_rad", "N m/rad"),
    ("_n_m15", "N/m^1.5"),
    ("_n_s_m", "N s/m"),
    ("_kg_m2", "kg m^2"),
    ("_kg_m3", "kg/m^3"),
    ("_rad_s", "rad/s"),
    ("_n_m", "N m"),
    ("_m_s", "m/s"),
    ("_kg", "kg"),
    ("_w_m2", "W/m^2"),
    ("_h", "h"),
    ("_pa", "Pa"),
    ("_m", "m"),
    ("_s", "s"),
    ("_rad", "rad"),
    ("_n", "N"),
    ("_k", "K"),
];

impl Key {
    fn ending(&self) -> Option<&'static (&'static str, &'static str)> {
        UNITS.iter().find(|(end, _)| self.name.ends_with(end))
    }

    /// Returns the unit at the end of the name, as text; empty for counts, names and plain numbers.
    pub fn unit(&self) -> &'static str {
        self.ending().map_or("", |(_, unit)| unit)
    }

    /// Returns the last part of the name in words, without its unit: `output pin radius`.
    pub fn words(&self) -> String {
        let name = self.name.rsplit('.').next().unwrap_or_default();
        let unit = self.ending().map_or("", |(end, _)| end);
        let unit = unit
            .strip_prefix("stiffness")
            .or(unit.strip_prefix("spring"))
            .unwrap_or(unit);
        let words = name
            .trim_end_matches(unit)
            .trim_end_matches('_')
            .replace('_', " ");
        let words = words
            .replace("external sleeve", "ring pin")
            .replace("internal sleeve", "output pin");
        words
            .replace("internal circle", "output pins' circle")
            .replace("wheel", "disc")
    }

    /// Returns the range that a number violates, as text: `from 0 to 1e5`. `None` for a permitted number.
    pub fn refuses(&self, number: f64) -> Option<String> {
        match self.kind {
            Kind::Number(range) if !range.holds(number) => Some(range.words()),
            _ => None,
        }
    }

    /// Returns the table of the key and its name there.
    pub(crate) fn path(&self) -> Vec<&'static str> {
        self.name.split('.').collect()
    }
}

/// Returns the rows of keys in tables, a name before those that begin it, for texts with names.
pub fn longest_first() -> impl Iterator<Item = &'static Key> {
    let mut rows: Vec<&Key> = KEYS.iter().filter(|row| row.name.contains('.')).collect();
    rows.sort_by_key(|row| std::cmp::Reverse(row.name.len()));
    rows.into_iter()
}

/// Returns the row of a key.
pub fn key(name: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.name == name)
}

use DefaultValue::{Constant, Formula, Needed, Nothing, Required};
use Kind::{Choice, Choices, Count, Flag, Number, Numbers, Tables, Text, Texts};
use Range::{Between, From};

const METRES: &str = "lengths are in metres: 6 mm is 0.006";
const KILOGRAMS: &str = "masses are in kilograms: 48 g is 0.048";
const MOMENTS: &str = "moments of inertia are in kg m^2: 100 kg mm^2 is 1e-4";
const RADIANS: &str = "angles are in radians: 1 arcminute is 2.9e-4";
const TURNS: &str = "write true or false, without quotes";
const LIST: &str = "write one number for each, like [0.0, 5e-6, -2e-6], in metres or radians";
const PROFILE: &str = "write numbers in metres, like [0.0, 5e-6, 2e-6]";
const SECONDS: &str = "times are in seconds: 10 microseconds is 1e-5";
const LOAD: &str = "give the load on the output shaft in newton metres";

/// Range of lengths from 0.1 micrometre to 10 m: a watch to a wind turbine. It detects millimetres typed for metres, and
/// keeps every later computation finite.
const LENGTH: Kind = Number(From(1e-7, 10.0));
const RPM: &str = "500 rpm is 52.36 rad/s";
const SPEED: Kind = Number(From(-1e6, 1e6));
const TORQUE: Kind = Number(From(-1e9, 1e9));
const MASS: Kind = Number(From(1e-9, 1e6));
const MOMENT: Kind = Number(From(1e-18, 1e8));
/// Range of deviations, to either side.
const DEVIATION: Range = From(-1.0, 1.0);
const ANGLE: Range = From(-1.0, 1.0);
const KELVIN: Kind = Number(From(-300.0, 1000.0));
const WARM: &str =
    "temperatures are differences in kelvin: 60 degrees C of a part measured at 20 are 40";
const STIFF: &str = "needle bearings have 1e8 to 1e9 N/m";
/// End of any simulation, s.
pub const LONGEST_S: f64 = 1e5;
const TIME: Kind = Number(From(0.0, LONGEST_S));

macro_rules! keys {
    ($($name:literal $kind:expr, $otherwise:expr, $about:literal, $hint:expr;)*) => {
        &[$(Key { name: $name, kind: $kind, otherwise: $otherwise, about: $about, hint: $hint }),*]
    };
}

/// Keys of a change of the load.
pub(crate) const CHANGE: &[Key] = keys! {
    "time_s" Number(From(crate::load_profile::APART_S, LONGEST_S)), Required, "when it begins", SECONDS;
    "output_torque_n_m" TORQUE, Required, "the load from then on", LOAD;
    "ramp_s" TIME, Constant("0.0", "at once"), "it is reached linearly over this time; 0: at once", SECONDS;
};

/// Keys of a change of the input's speed.
pub(crate) const SPEED_CHANGE: &[Key] = keys! {
    "time_s" Number(From(crate::load_profile::APART_S, LONGEST_S)), Required, "when it begins", SECONDS;
    "input_speed_rad_s" SPEED, Required, "the speed from the end of the ramp on", RPM;
    "ramp_s" Number(From(crate::load_profile::APART_S, LONGEST_S)), Required, "it is reached linearly over this time", "a jump of the speed takes an infinite torque: give the time in which the motor reaches it, like 0.01";
};

/// All keys.
pub const KEYS: &[Key] = keys! {
    "name" Text, Nothing, "name shown in reports; the file's if left out", "give a name of 1 to 100 printable characters";
    "description" Text, Nothing, "why this scene exists, one sentence", "";

    "gear.eccentricity_m" Number(From(1e-7, 1.0)), Required, "e", METRES;
    "gear.external_sleeves" Count(3, 1000), Required, "zk: pins on the housing; a disc has one lobe less", "a disc has one lobe less and needs at least two; above 1000 no real gear exists and memory would grow without use";
    "gear.pin_circle_radius_m" LENGTH, Nothing, "R: circle of the ring pins without backlash; instead of gear.shortening", METRES;
    "gear.shortening" Number(Between(1e-3, 1.0)), Formula(formulas::shortening, "e zk/R with R = gear.pin_circle_radius_m"), "m: shortening coefficient e zk/R", "it is e zk/R, usually 0.5 to 0.9; at 1 and above the disc's profile crosses itself";
    "gear.external_sleeve_radius_m" LENGTH, Required, "q: radius of a ring pin", METRES;
    "gear.internal_sleeves" Count(2, 1000), Formula(formulas::cranks, "cranks.count: cranks stand in the place of output pins"), "zi: pins on the output shaft", "three hold an output shaft, two as cranks alone; more than 1000 no real gear has";
    "gear.internal_sleeve_radius_m" LENGTH, Formula(formulas::crank_shaft, "cranks.bore_radius_m - gear.eccentricity_m: a crank's shaft just passes its bore"), "radius of an output pin", METRES;
    "gear.internal_circle_radius_m" LENGTH, Formula(formulas::crank_circle, "cranks.circle_radius_m"), "circle the output pins sit on", METRES;
    "gear.hole_radius_m" LENGTH, Formula(formulas::hole_radius, "gear.internal_sleeve_radius_m + gear.eccentricity_m: a hole without clearance"), "radius of a disc's hole", METRES;
    "gear.wheels" Count(1, 64), Required, "discs, evenly phased on the eccentric", "most gears have one to three discs; every disc meets every pin, so memory and time grow with it";
    "gear.backlash_m" Number(From(0.0, 1.0)), Constant("0.0", "no backlash"), "d: ring pins sit at R + d", METRES;
    "gear.external_sleeves_turn" Flag, Nothing, "ring pins are sleeves that turn; false: the disc slides on pins that stand still; absent: true", TURNS;
    "gear.internal_sleeves_turn" Flag, Nothing, "output pins are sleeves that turn; false: they turn with the output alone; absent: true", TURNS;
    "gear.face_width_m" LENGTH, Nothing, "thickness of a disc; for masses that are left out", METRES;

    "gear.eccentric_bore_radius_m" LENGTH, Nothing, "a disc's bore for the bearing on its eccentric; absent: 0.6 (internal circle - hole radius)", METRES;

    "gear.modification.equidistant_m" Number(DEVIATION), Nothing, "the generating pin's radius is larger than q by this: above 0 the disc's whole edge lies that much further in", METRES;
    "gear.modification.radial_m" Number(DEVIATION), Nothing, "the generating circle is larger than R by this: below 0 the disc is smaller", METRES;
    "gear.modification.rotational_rad" Number(From(0.0, 1.0)), Nothing, "both flanks of a lobe are turned towards its middle by this", RADIANS;
    "gear.modification.normal_m.points_m" Numbers(DEVIATION), Nothing, "own profile: offset of the generating curve along its inward normal at equal steps over a lobe from its tip on, all lobes alike; a periodic cubic spline", PROFILE;
    "gear.modification.normal_m.cos_m" Numbers(DEVIATION), Nothing, "own profile as a Fourier series of a lobe's phase, 0 at its tip: amplitudes of cosines from order 0 on", PROFILE;
    "gear.modification.normal_m.sin_m" Numbers(DEVIATION), Nothing, "the series' amplitudes of sines from order 1 on", PROFILE;
    "gear.errors.external_sleeve_radial_m" Numbers(DEVIATION), Nothing, "of each ring pin, how far it sits outwards of its place", LIST;
    "gear.errors.external_sleeve_tangential_m" Numbers(DEVIATION), Nothing, "of each ring pin, how far it sits counter-clockwise of its place", LIST;
    "gear.errors.external_sleeve_radius_m" Numbers(DEVIATION), Nothing, "of each ring pin, by how much its radius is larger", LIST;
    "gear.errors.internal_sleeve_radial_m" Numbers(DEVIATION), Nothing, "of each output pin, how far it sits outwards of its place", LIST;
    "gear.errors.internal_sleeve_tangential_m" Numbers(DEVIATION), Nothing, "of each output pin, how far it sits counter-clockwise of its place", LIST;
    "gear.errors.internal_sleeve_radius_m" Numbers(DEVIATION), Nothing, "of each output pin, by how much its radius is larger", LIST;
    "gear.errors.hole_radial_m" Numbers(DEVIATION), Nothing, "of each hole, disc by disc, how far it sits outwards of its place", LIST;
    "gear.errors.hole_tangential_m" Numbers(DEVIATION), Nothing, "of each hole, disc by disc, how far it sits counter-clockwise of its place", LIST;
    "gear.errors.hole_radius_m" Numbers(DEVIATION), Nothing, "of each hole, disc by disc, by how much its radius is larger", LIST;
    "gear.errors.crank_phase_rad" Numbers(ANGLE), Nothing, "of each crank of an RV gear, how far it stands counter-clockwise of its place", LIST;
    "gear.errors.eccentricity_m" Numbers(DEVIATION), Nothing, "of each disc, by how much its eccentricity is larger", LIST;
    "gear.errors.phase_rad" Numbers(ANGLE), Nothing, "of each disc, how far its eccentric stands counter-clockwise of its place", LIST;

    "drive.input_speed_rad_s" SPEED, Required, "omega", RPM;
    "drive.output_torque_n_m" TORQUE, Required, "load on the output shaft, counter-clockwise; positive opposes the motion of a positive input speed, of an RV gear that of a negative one, and of a ring the other way round", LOAD;
    "drive.start" Choice("start", || vec!["kinematic", "equilibrium"]), Constant("\"kinematic\"", "rates of the ideal mesh, load at once"), "state at t = 0", "\"kinematic\": rates of the ideal mesh; \"equilibrium\": statically loaded";
    "drive.output" Choice("output", || vec!["carrier", "ring"]), Nothing, "what turns the output: the carrier of the output pins, or the ring while the carrier is held (ratio zk, same sense; of an RV gear the case, R - 1, against the input); mass.output_shaft and the load are then the ring's", "\"carrier\" or \"ring\"";
    "drive.load_ramp_s" TIME, Constant("0.0", "the load acts at once"), "the load rises linearly over this time; 0: at once", SECONDS;
    "drive.load_changes" Tables(CHANGE), Nothing, "what the load becomes during the run", "write it like [{ time_s = 0.3, output_torque_n_m = -22.0 }]";
    "drive.speed_changes" Tables(SPEED_CHANGE), Nothing, "what the speed of the input becomes during the run", "write it like [{ time_s = 0.3, input_speed_rad_s = 80.0, ramp_s = 0.02 }]";

    "contact.law" Choice("contact law", names::laws), Constant("\"line-hertz\"", "rollers on a line, both bodies elastic; creates no energy"), "normal law", "see `pinwheel laws`";
    "contact.band_laws" Choices("contact law", names::laws), Nothing, "laws that may be right for these rollers, whose spread is the band of a figure; absent: those for the materials; []: no band", "see `pinwheel laws`";
    "contact.material" Choice("material", names::materials), Nothing, "material of the discs, for their limits and expansion; steel: hardened as rolling bearings are; absent: not known", "say limits of another in [limits]";
    "contact.pin_material" Choice("material", names::materials), Nothing, "material of the pins; absent: that of the discs", "say limits of another in [limits]";
    "contact.young_pa" Number(From(1e6, 1e13)), Constant("2.1e11", "steel"), "E of the discs", "Young's modulus is in pascal: steel's 200 GPa is 2e11";
    "contact.poisson" Number(Between(-1.0, 0.5)), Constant("0.3", "steel"), "Poisson's ratio of the discs", "steel has 0.3; outside these bounds no isotropic material is stable";
    "contact.pin_young_pa" Number(From(1e6, 1e13)), Nothing, "E of the pins; absent: that of the discs", "Young's modulus is in pascal: steel's 200 GPa is 2e11";
    "contact.pin_poisson" Number(Between(-1.0, 0.5)), Nothing, "Poisson's ratio of the pins; absent: that of the discs", "steel has 0.3; outside these bounds no isotropic material is stable";
    "contact.stiffness_multiplier" Number(From(1e-9, 1e6)), Constant("1.0", "the full stiffness after Hertz"), "H: factor on the stiffness after Hertz", "1 is the Hertzian stiffness, the paper uses 0.01";
    "contact.internal_stiffness_multiplier" Number(From(1e-9, 1e6)), Nothing, "H of internal contacts, of laws of balls; absent: that of all", "1 is the Hertzian stiffness";
    "contact.external_spring_n_m" Number(From(1.0, 1e15)), Nothing, "k of external contacts under the law linear; absent: the secant of line-hertz under the largest load", "steel rollers have 1e8 to 1e9 N/m";
    "contact.internal_spring_n_m" Number(From(1.0, 1e15)), Nothing, "k of internal contacts, likewise", "steel rollers have 1e8 to 1e9 N/m";

    "mass.density_kg_m3" Number(From(1.0, 1e5)), Nothing, "density of all bodies; for masses that are left out", "densities are in kg/m^3: steel has 7850";
    "mass.input_shaft.mass_kg" MASS, Formula(formulas::input_shaft_mass, "a cylinder through the bores, as long as all discs, bores of 0.6 (internal circle - hole radius)"), "mass of the driven shaft with its eccentrics", KILOGRAMS;
    "mass.input_shaft.moment_kg_m2" MOMENT, Formula(formulas::input_shaft_moment, "mass times radius^2/2 of that cylinder"), "moment of inertia of the driven shaft", MOMENTS;
    "mass.output_shaft.mass_kg" MASS, Formula(formulas::output_shaft_mass, "a disc out to the output pins' edge, as thick as a disc"), "mass of the loaded shaft without its pins", KILOGRAMS;
    "mass.output_shaft.moment_kg_m2" MOMENT, Formula(formulas::output_shaft_moment, "mass times radius^2/2 of that disc"), "moment of inertia of the loaded shaft", MOMENTS;
    "mass.wheel.mass_kg" MASS, Formula(formulas::wheel_mass, "density times face width times the area inside the profile less holes and bore"), "mass of one disc", KILOGRAMS;
    "mass.wheel.moment_kg_m2" MOMENT, Formula(formulas::wheel_moment, "mass times the radius of gyration^2 of that area"), "moment of inertia of one disc about its centre", MOMENTS;
    "mass.internal_sleeve.mass_kg" MASS, Formula(formulas::internal_sleeve_mass, "a solid cylinder, as long as all discs"), "mass of a pin on the output shaft; of an RV gear that of a crank with its planet", KILOGRAMS;
    "mass.internal_sleeve.moment_kg_m2" MOMENT, Formula(formulas::internal_sleeve_moment, "mass times radius^2/2"), "moment of inertia of a pin on the output shaft, or of a crank with its planet", MOMENTS;
    "mass.external_sleeve.mass_kg" MASS, Formula(formulas::external_sleeve_mass, "a solid cylinder, as long as all discs"), "mass of a pin on the housing", KILOGRAMS;
    "mass.external_sleeve.moment_kg_m2" MOMENT, Formula(formulas::external_sleeve_moment, "mass times radius^2/2"), "moment of inertia of a pin on the housing", MOMENTS;

    "contact.constant_stiffness_n_m15" Number(From(1e-6, 1e15)), Formula(formulas::constant_stiffness, "after Hertz, of a ring pin on a flat; used by laws of one stiffness only"), "K of laws with one stiffness for all contacts", "the paper's contacts have 5e7 to 2e8 N/m^1.5";
    "contact.line_length_m" Number(From(1e-6, 10.0)), Formula(formulas::face_width, "the face width, or 0.15 R; used by laws of rollers and for pressures"), "length of a line contact", METRES;
    "contact.disc_depth_m" Number(From(1e-6, 10.0)), Nothing, "how deep a disc is behind a contact, of the law line-hertz; absent: the wall between a hole and the profile, at least half of the ring pins' radius", METRES;
    "contact.damping_n_s_m" Number(From(0.0, 1e9)), Formula(formulas::damping, "5 % of critical damping of the fastest mode under the largest static load; gear meshes have 3 to 17 %"), "C: damping of a contact", "the paper uses 8; negative damping would feed energy in";
    "contact.ramp_m" Number(From(1e-15, 1e-2)), Formula(formulas::ramp, "a tenth of the penetration under the largest static load"), "penetration at which S reaches 1", "the paper uses 1e-5, the penetration at which the force is fully on";
    "contact.friction_coefficient" Number(From(0.0, 10.0)), Constant("0.0", "no friction"), "mu; 0: no friction", "0 switches friction off; dry steel has 0.1 to 0.2";
    "contact.friction_ramp_m_s" Number(From(1e-18, 1e3)), Formula(formulas::friction_ramp, "a thousandth of omega e"), "sliding speed at which friction reaches mu F_n", "the paper uses 5e-5, the sliding speed at which friction is fully on";
    "contact.friction_law" Choice("friction law", || vec!["regularised", "adams"]), Constant("\"regularised\"", "Coulomb with a linear ramp"), "form of the friction", "\"regularised\" or \"adams\"";
    "contact.friction_dynamic_coefficient" Number(From(0.0, 10.0)), Constant("0.0", "used by the friction law adams only"), "mu_d of the friction law adams", "the coefficient of fast sliding, at most contact.friction_coefficient";
    "contact.friction_dynamic_speed_m_s" Number(From(1e-18, 1e3)), Formula(formulas::friction_dynamic_speed, "20 times contact.friction_ramp_m_s; used by the friction law adams only"), "sliding speed from which mu_d holds", "the sliding speed from which the dynamic coefficient holds";
    "contact.restitution" Number(From(1e-3, 1.0)), Constant("0.9", "used by the hysteresis laws only"), "c of the hysteresis laws", "the share of the impact speed that is left after an impact, 1 without loss";
    "contact.impact_speed_m_s" Number(From(1e-9, 1e3)), Constant("0.01", "used by the hysteresis laws only"), "speed of an impact with that restitution", "the impact speed at which the restitution holds; 0.01 is usual in a gearbox";
    "bearings.eccentric.stiffness_n_m" Number(From(1e3, 1e15)), Nothing, "K of the bearing that carries a disc on its eccentric; or give rollers", STIFF;
    "bearings.eccentric.exponent" Number(From(1.0, 3.0)), Nothing, "p of its force K d^p; absent: 1, or 10/9 of rollers", "rollers have 10/9, balls 3/2";
    "bearings.eccentric.rollers" Count(3, 10_000), Nothing, "its rollers, where they give K after Palmgren", "count the rollers of one row";
    "bearings.eccentric.roller_length_m" LENGTH, Nothing, "length of these rollers", METRES;
    "bearings.eccentric.roller_diameter_m" LENGTH, Nothing, "diameter of these rollers, for its ratings after ISO 76 and ISO 281", METRES;
    "bearings.eccentric.clearance_m" Number(From(0.0, 1e-2)), Nothing, "its radial clearance; absent: 0", "half of the play across the diameter: 5 micrometres are 5e-6";
    "bearings.eccentric.damping_n_s_m" Number(From(0.0, 1e9)), Nothing, "its damping; absent: 5 % of critical of a disc on it", "rolling bearings have a few per cent of critical damping";
    "bearings.eccentric.friction_coefficient" Number(From(0.0, 1.0)), Nothing, "its friction mu, of the moment mu F d/2 against its turning; absent: 0", "needles have 0.002, cylindrical rollers 0.0011";
    "bearings.eccentric.bore_m" LENGTH, Nothing, "its bore d, for that moment", METRES;
    "bearings.eccentric.dynamic_rating_n" Number(From(1.0, 1e9)), Nothing, "its basic dynamic rating C, for its life after ISO 281", "bearing catalogues give it in kN: 20 kN is 20000";
    "bearings.internal_sleeve_stiffness_n_m" Number(From(1e3, 1e15)), Nothing, "stiffness of an output pin against bending, in series with its contacts; absent: rigid", "a pin held at one end has 3 E I/l^3 at the length l";
    "bearings.internal_sleeves_held" Choice("way to hold pins", || vec!["one-end", "both-ends"]), Nothing, "ends at which the output pins are held, for their bending; absent: not judged", "\"one-end\" or \"both-ends\"";
    "bearings.internal_sleeve_gap_m" Number(From(0.0, 1.0)), Nothing, "gap between discs, and from the outer ones to what holds the output pins; absent: 0", METRES;
    "bearings.output_torsion_n_m_rad" Number(From(1e-3, 1e15)), Nothing, "torsional stiffness of carrier and flange; absent: rigid; counts in `design` alone", "1 N m/arcmin is 3437.7 N m/rad";
    "bearings.sleeve_friction_coefficient" Number(From(0.0, 1.0)), Nothing, "friction mu of a sleeve on its pin, of the moment mu F d/2 as it rolls; where that is more than the contact's own friction, the disc slides on the sleeve; absent: sleeves turn freely", "needles have 0.002, oiled bronze 0.05 to 0.1";
    "bearings.sleeve_bore_m" LENGTH, Nothing, "bore d of the pins, for that moment; thinner rollers turn in grooves, on their own diameter", METRES;
    "bearings.input_seal_n_m" Number(From(0.0, 1e9)), Nothing, "torque of the input shaft's seal against its turning; absent: 0", "seal catalogues give it: some 0.1 N m on a shaft of 20 mm";
    "bearings.output_seal_n_m" Number(From(0.0, 1e9)), Nothing, "torque of the output shaft's seal against its turning; absent: 0", "seal catalogues give it: some 0.1 N m on a shaft of 20 mm";
    "structure.output_pin_diameter_m" LENGTH, Nothing, "diameter of the output pins as beams that all discs bend together, held as bearings.internal_sleeves_held says; disc 0 is nearest to the flange; absent: rigid", METRES;
    "structure.output_seat_length_m" LENGTH, Nothing, "length of an output pin's seat, a line contact in series with its bending; absent: rigid", METRES;
    "structure.ring_seat_length_m" LENGTH, Nothing, "length of a ring pin's seat in the housing, a line contact in series with its contacts; absent: rigid", METRES;
    "structure.ring_slot_clearance_m" Number(From(0.0, 1e-2)), Nothing, "radial clearance of ring pins in slots, taken up along the normal of the contact; absent: 0", "half of the play across the diameter: 5 micrometres are 5e-6";
    "structure.housing_material" Choice("material", names::materials), Nothing, "material of the housing, for seats and expansion; absent: that of the pins", "name one of these";
    "structure.plate_thickness_m" LENGTH, Nothing, "thickness of the plate between output pins and flange, in torsion; absent: rigid; counts in `design` alone", METRES;
    "structure.plate_radius_m" LENGTH, Nothing, "radius at which the flange takes the torque from that plate", METRES;
    "structure.input_torsion_n_m_rad" Number(From(1e-3, 1e15)), Nothing, "torsional stiffness of the input shaft, which counts at the output times the ratio squared; absent: rigid; counts in `design` alone", "a steel shaft has 8e10 pi d^4/(32 l)";
    "temperature.housing_k" KELVIN, Nothing, "housing with the ring, by how much warmer than when its sizes were measured; absent: 0", WARM;
    "temperature.disc_k" KELVIN, Nothing, "discs, eccentrics and carrier, likewise; absent: 0", WARM;
    "temperature.pins_k" KELVIN, Nothing, "ring pins and output pins, likewise; absent: 0", WARM;
    "cranks.count" Count(2, 12), Needed, "cranks of an RV reducer, which carry the discs in the place of one eccentric", "RV reducers have two or three";
    "cranks.circle_radius_m" LENGTH, Needed, "circle the cranks stand on", METRES;
    "cranks.bore_radius_m" LENGTH, Needed, "a disc's bore for a crank's eccentric and its bearing", METRES;
    "cranks.sun_teeth" Count(3, 10_000), Needed, "teeth of the sun on the input shaft", "with the planets' it makes the ratio 1 + zk planet/sun";
    "cranks.planet_teeth" Count(3, 10_000), Needed, "teeth of a planet, one on each crank", "with the sun's it makes the ratio 1 + zk planet/sun";
    "cranks.support_stiffness_n_m" Number(From(1e3, 1e15)), Nothing, "stiffness of what holds a crank in the output; absent: rigid", "a pair of tapered roller bearings has 4e8 to 1e9 N/m";
    "cranks.mesh_stiffness_n_m" Number(From(1e3, 1e15)), Nothing, "stiffness of the mesh of the sun with a planet along the line of action, without mass; absent: rigid", "about 1.4e10 N/m by metre of face width (ISO 6336)";
    "contact.detection" Choice("detection", || vec!["exact", "points"]), Constant("\"exact\"", "the closest point of the curve"), "how the contact point is found", "\"exact\" or \"points\"";
    "contact.wheel_points" Count(24, 1_000_000), Formula(formulas::wheel_points, "100 a lobe, at least 4000; used by detection points only"), "points on a disc's profile", "the paper uses 600 and 4000; more than a million costs memory and gains nothing over the exact closest point";
    "contact.hole_points" Count(8, 1_000_000), Constant("100", "used by detection points only"), "points on a hole", "the paper uses 20 to 100; more than a million costs memory and gains nothing over the exact closest point";

    "limits.pressure_pa" Number(From(1.0, 1e12)), Nothing, "largest pressure p0 of a contact; absent: that of the material", "pressures are in pascal: 1500 MPa is 1.5e9";
    "limits.bending_pa" Number(From(1.0, 1e12)), Nothing, "largest bending stress of an output pin; absent: the yield strength of its material", "stresses are in pascal: 300 MPa is 3e8";
    "limits.pressure_sliding_w_m2" Number(From(1.0, 1e12)), Nothing, "largest pressure on the projected area times sliding speed (pv) of a sleeve; absent: that of the material", "1 MPa m/s is 1e6";
    "limits.static_safety" Number(From(0.1, 100.0)), Nothing, "least static safety of the bearing that carries a disc; absent: 1", "1 to 2 for quiet running";
    "limits.life_h" Number(From(1.0, 1e9)), Nothing, "least basic rating life of that bearing; absent: not judged", "RV reducers are rated for 6000 h";
    "limits.wall_m" LENGTH, Nothing, "least wall of a disc between holes, edge and bore; absent: by the shear stress there", METRES;

    "solver.formulation" Choice("formulation", || vec!["reduced", "lagrange"]), Constant("\"reduced\"", "centre-pinned bodies eliminated exactly"), "which equations are integrated", "\"reduced\" or \"lagrange\"";
    "solver.integrator" Choice("integrator", names::integrators), Constant("\"auto\"", "the method that the scene's forces ask for"), "name of the integrator", "\"auto\" takes the method that the scene asks for";
    "solver.duration_s" Number(From(1e-9, LONGEST_S)), Formula(formulas::duration, "until the start-up has died away and two turns of the input more; 3 to 10 turns"), "end time", SECONDS;
    "solver.sample_s" Number(From(1e-12, LONGEST_S)), Formula(formulas::sample, "40 a mesh period and 4 a period of the fastest mode, at most 20000 in all"), "samples stand this far apart", SECONDS;
    "solver.step_s" Number(From(1e-12, 1.0)), Formula(formulas::step, "about 50 a period of the fastest mode under the largest static load"), "step of fixed-step methods", SECONDS;
    "solver.tolerance" Number(Between(1e-14, 1e-1)), Constant("1e-6", "relative error a step of adaptive methods"), "relative error a step of adaptive methods", "1e-6 is a good start; below 1e-14 there are no digits left";
    "solver.stabilisation" Choice("stabilisation", || vec!["projection", "baumgarte", "none"]), Constant("\"projection\"", "of the Lagrange form"), "how the Lagrange form keeps its constraints", "\"projection\", \"baumgarte\" or \"none\"";

    "output.channels" Texts, Nothing, "columns beyond those every run has; `*` stands for any characters", "write it like [\"efficiency\"]";
};
