//! Scene: all inputs of a run, named as in the TOML file.
//!
//! Names of keys end with their units. Omitted keys come from the base or are filled in ([`crate::keys`]).

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

/// Complete scene. SI units; angles counter-clockwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Name shown in reports.
    pub name: String,
    /// Purpose of the scene, one sentence (optional).
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub description: String,
    /// Geometry.
    pub gear: Gear,
    /// Masses and moments of inertia.
    pub mass: Masses,
    /// Motion of the input and load of the output.
    pub drive: Drive,
    /// Contact law and detection.
    pub contact: Contact,
    /// Compliance beside that of the contacts; without it only contacts deflect.
    #[serde(default, skip_serializing_if = "is_default")]
    pub bearings: Bearings,
    /// Elastic parts behind the contacts.
    #[serde(default, skip_serializing_if = "is_default")]
    pub structure: Structure,
    /// Parts warmer than when their sizes were measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<Temperature>,
    /// The cranks of an RV reducer; without it one eccentric carries the discs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cranks: Option<Cranks>,
    /// Formulation, integrator and sampling.
    pub solver: Solver,
    /// Channels recorded beyond the contract's columns.
    #[serde(default, skip_serializing_if = "is_default")]
    pub output: Output,
    /// Limits of the parts; without them those of the materials, if known.
    #[serde(default, skip_serializing_if = "is_default")]
    pub limits: Limits,
    /// Half-widths of uncertain values, by key: for tolerance intervals and comparisons with measured data.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub uncertain: BTreeMap<String, PlusMinus>,
}

/// Geometry (Tab. 1 and Fig. 3 of the paper).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gear {
    /// Eccentricity e, m.
    pub eccentricity_m: f64,
    /// Number of ring pins zk; a disc has zs = zk - 1 lobes.
    pub external_sleeves: usize,
    /// Short-width coefficient m, 0 < m < 1.
    pub shortening: f64,
    /// Radius of a ring pin q, m.
    pub external_sleeve_radius_m: f64,
    /// Number of output pins zi.
    pub internal_sleeves: usize,
    /// Radius of an output pin, m; an assumption, because Fig. 3 is not available.
    pub internal_sleeve_radius_m: f64,
    /// Radius of the output pins' circle, m; an assumption.
    pub internal_circle_radius_m: f64,
    /// Radius of a disc's hole, m (pin radius + e without clearance); an assumption.
    pub hole_radius_m: f64,
    /// Number of discs, evenly phased on the eccentric.
    pub wheels: usize,
    /// Backlash d, m: ring pins are at R + d.
    pub backlash_m: f64,
    /// True if ring pins are sleeves that turn; false if they are fixed.
    #[serde(default = "turns", skip_serializing_if = "Clone::clone")]
    pub external_sleeves_turn: bool,
    /// True if output pins are sleeves that turn; false if they are fixed to the output shaft.
    #[serde(default = "turns", skip_serializing_if = "Clone::clone")]
    pub internal_sleeves_turn: bool,
    /// Thickness of a disc, m; used only for omitted masses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub face_width_m: Option<f64>,
    /// Bore radius of a disc for the bearing on its eccentric, m; `None`: 0.6 of the radius inside the holes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub eccentric_bore_radius_m: Option<f64>,
    /// Modification of the discs' profile against the one that fits the ring.
    #[serde(default, skip_serializing_if = "is_default")]
    pub modification: Modification,
    /// Deviations of single pins, holes and discs.
    #[serde(default, skip_serializing_if = "is_default")]
    pub errors: Errors,
}

/// True for a value that files omit.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Returns the default of a pin's turning.
fn turns() -> bool {
    true
}

/// Mass and moment of inertia of a rigid body about its centre of mass.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyMass {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Moment of inertia, kg m^2.
    pub moment_kg_m2: f64,
}

/// Masses and moments of inertia (Tab. 2 of the paper).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Masses {
    /// Density of all bodies, kg/m^3; used only for omitted masses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density_kg_m3: Option<f64>,
    /// Input shaft with its eccentrics.
    pub input_shaft: BodyMass,
    /// Output shaft without its pins.
    pub output_shaft: BodyMass,
    /// One cycloidal disc.
    pub wheel: BodyMass,
    /// One pin on the output shaft.
    pub internal_sleeve: BodyMass,
    /// One pin on the housing.
    pub external_sleeve: BodyMass,
}

/// Initial state of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Start {
    /// Rates of the ideal mesh under the full load: ring pins at rest, output pins turn with the output.
    Kinematic,
    /// Static equilibrium under the load: no start-up transient.
    Equilibrium,
}

/// Part of a gear that is its output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OutputPart {
    /// Carrier with the output pins; the ring is fixed.
    #[default]
    Carrier,
    /// Ring with its pins; the carrier is fixed.
    Ring,
}

/// Motion and load (Tab. 3).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Speed omega, rad/s.
    pub input_speed_rad_s: f64,
    /// Load on the output shaft, N m; positive opposes the motion of a positive input speed.
    pub output_torque_n_m: f64,
    /// Output part; the other one is fixed.
    #[serde(default, skip_serializing_if = "is_default")]
    pub output: OutputPart,
    /// Initial state.
    pub start: Start,
    /// Duration of the linear rise of the load from 0, s; 0: at once.
    pub load_ramp_s: f64,
    /// Changes of the load during the run, in increasing time; empty: a constant load.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub load_changes: Vec<LoadChange>,
    /// Changes of the input's speed during the run, in increasing time; empty: a constant speed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub speed_changes: Vec<SpeedChange>,
}

/// Change of the input's speed during a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedChange {
    /// Time at which the change begins, s.
    pub time_s: f64,
    /// Speed at the end of the ramp, rad/s.
    pub input_speed_rad_s: f64,
    /// Duration of the linear ramp to the new speed, s, > 0.
    pub ramp_s: f64,
}

/// Change of the load during a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadChange {
    /// Time at which the change begins, s.
    pub time_s: f64,
    /// Load from that time on, N m; sign as [`Drive::output_torque_n_m`].
    pub output_torque_n_m: f64,
    /// Duration of the linear ramp to the new load, s; 0 for a jump.
    #[serde(default)]
    pub ramp_s: f64,
}

/// Method that computes the contact point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Detection {
    /// Closest point of the exact curve.
    Exact,
    /// Nearest of discrete points, as published.
    Points,
}

/// Form of the friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FrictionLaw {
    /// Eq. 21: linear up to the ramp speed, then constant.
    Regularised,
    /// Adams: a static peak at the ramp speed, falling to the dynamic coefficient.
    Adams,
}

/// Contact law (Eq. 20-24) and detection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Name of the normal law; `pinwheel laws` lists them.
    pub law: String,
    /// Laws whose spread is the band of a figure; `None`: those that may apply to the materials.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band_laws: Option<Vec<String>>,
    /// Name of the discs' material, of [`crate::catalogue::MATERIALS`], which gives their limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Name of the pins' material; `None`: that of the discs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pin_material: Option<String>,
    /// Young's modulus E of the discs, Pa.
    pub young_pa: f64,
    /// Poisson's ratio of the discs.
    pub poisson: f64,
    /// Young's modulus E of the pins, Pa; `None`: that of the discs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pin_young_pa: Option<f64>,
    /// Poisson's ratio of the pins; `None`: that of the discs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pin_poisson: Option<f64>,
    /// Factor H on the Hertzian stiffness.
    pub stiffness_multiplier: f64,
    /// Factor H of internal contacts; `None`: that of all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub internal_stiffness_multiplier: Option<f64>,
    /// Stiffness k of external contacts under the law of linear springs, N/m; `None`: the secant of steel rollers under the
    /// largest load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub external_spring_n_m: Option<f64>,
    /// Stiffness k of internal contacts, N/m; `None`: as for external ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub internal_spring_n_m: Option<f64>,
    /// Damping C, N s/m.
    pub damping_n_s_m: f64,
    /// Penetration at which S reaches 1, m.
    pub ramp_m: f64,
    /// Friction coefficient mu; 0: no friction.
    pub friction_coefficient: f64,
    /// Sliding speed at which friction reaches mu F_n, m/s.
    pub friction_ramp_m_s: f64,
    /// Form of the friction.
    pub friction_law: FrictionLaw,
    /// Dynamic coefficient mu_d (friction law `adams` only, with mu as the static coefficient).
    pub friction_dynamic_coefficient: f64,
    /// Sliding speed from which mu_d acts, m/s (friction law `adams` only).
    pub friction_dynamic_speed_m_s: f64,
    /// Stiffness K of laws with one stiffness for all contacts, N/m^1.5.
    pub constant_stiffness_n_m15: f64,
    /// Restitution c of the hysteresis laws, 0 < c <= 1.
    pub restitution: f64,
    /// Impact speed v0 of the hysteresis laws, m/s, at which the restitution is c.
    pub impact_speed_m_s: f64,
    /// Length of a line contact, m.
    pub line_length_m: f64,
    /// Depth of a disc behind a contact, m; `None`: the wall between a hole and the profile.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disc_depth_m: Option<f64>,
    /// Method that computes the contact point.
    pub detection: Detection,
    /// Points on a disc's profile (points detection only).
    pub wheel_points: usize,
    /// Points on a hole (points detection only).
    pub hole_points: usize,
}

/// Compliance and friction other than in the contacts.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Bearings {
    /// Bearing that carries each disc on its eccentric; `None`: a rigid revolute.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eccentric: Option<EccentricBearing>,
    /// Stiffness of an output pin against bending at its pin, N/m; `None`: rigid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub internal_sleeve_stiffness_n_m: Option<f64>,
    /// Ends at which the output pins are held; `None`: unknown, so their bending is not judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub internal_sleeves_held: Option<Held>,
    /// Gap between discs, and between a disc and the pins' support beside it, m; `None`: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub internal_sleeve_gap_m: Option<f64>,
    /// Torsional stiffness of carrier and flange beyond the output pins, N m/rad; `None`: rigid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output_torsion_n_m_rad: Option<f64>,
    /// Coefficient of friction of a sleeve on its pin; `None`: it turns freely.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sleeve_friction_coefficient: Option<f64>,
    /// Bore of the pins, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sleeve_bore_m: Option<f64>,
    /// Torque of the seal on the input shaft, N m; `None`: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input_seal_n_m: Option<f64>,
    /// Torque of the seal on the output shaft, N m; `None`: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output_seal_n_m: Option<f64>,
}

/// Ends at which output pins are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Held {
    /// Held in one flange, rigidly.
    OneEnd,
    /// Held in a flange on either side of the discs, free to turn there.
    BothEnds,
}

/// Elastic parts behind the contacts, each with its closed form; `None` if rigid.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Structure {
    /// Diameter of the output pins as beams that all discs bend, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output_pin_diameter_m: Option<f64>,
    /// Length of an output pin's seat in its holder, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output_seat_length_m: Option<f64>,
    /// Length of a ring pin's seat in the housing, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ring_seat_length_m: Option<f64>,
    /// Radial clearance of ring pins in their slots, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ring_slot_clearance_m: Option<f64>,
    /// Name of the housing's material, of [`crate::catalogue::MATERIALS`]; `None`: the pins'.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub housing_material: Option<String>,
    /// Thickness of the plate between output pins and flange, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plate_thickness_m: Option<f64>,
    /// Radius at which the flange takes the torque from the plate, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plate_radius_m: Option<f64>,
    /// Torsional stiffness of the input shaft, N m/rad.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input_torsion_n_m_rad: Option<f64>,
}

/// Temperatures of parts above that at which their sizes hold, K.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Temperature {
    /// Housing with the ring.
    pub housing_k: f64,
    /// Discs, eccentrics and carrier.
    pub disc_k: f64,
    /// Ring pins and output pins.
    pub pins_k: f64,
}

/// Limits that a user states; one that is exceeded ends a design with status 1.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Limits {
    /// Largest pressure p0 of a contact, Pa.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_pa: Option<f64>,
    /// Largest bending stress of an output pin, Pa.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bending_pa: Option<f64>,
    /// Largest product of pressure on the projected area and sliding speed of a sleeve, W/m^2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure_sliding_w_m2: Option<f64>,
    /// Least static safety of a bearing that carries a disc.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub static_safety: Option<f64>,
    /// Least basic rating life of a bearing that carries a disc, h.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub life_h: Option<f64>,
    /// Least wall of a disc between its holes, or from a hole to edge or bore, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall_m: Option<f64>,
}

/// Elastic bearing between an eccentric and its disc: F = K max(0, d - g)^p along the offset d of their centres, and
/// damping. Either K is given, or rollers after Palmgren.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EccentricBearing {
    /// Stiffness K, N/m^p.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stiffness_n_m: Option<f64>,
    /// Exponent p; `None`: 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exponent: Option<f64>,
    /// Number of rollers, if these determine K.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rollers: Option<usize>,
    /// Length of the rollers, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roller_length_m: Option<f64>,
    /// Diameter of the rollers, m; for the bearing's ratings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roller_diameter_m: Option<f64>,
    /// Radial clearance g, m; `None`: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearance_m: Option<f64>,
    /// Damping c along the offset while the bearing is loaded, N s/m; `None`: [`DAMPING_SHARE`](Self::DAMPING_SHARE) of
    /// critical.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damping_n_s_m: Option<f64>,
    /// Friction coefficient mu of the moment mu F d/2 against rotation; `None`: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction_coefficient: Option<f64>,
    /// Bore diameter d, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bore_m: Option<f64>,
    /// Basic dynamic rating C, N (ISO 281); for the bearing's life.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dynamic_rating_n: Option<f64>,
}

/// First stage and cranks of an RV reducer: a sun drives planets, each on a crank whose eccentrics carry the discs. Cranks
/// replace output pins, on a circle of the output.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cranks {
    /// Number of cranks, evenly spaced.
    pub count: usize,
    /// Radius of the cranks' circle, m.
    pub circle_radius_m: f64,
    /// Radius of a disc's bore for a crank's eccentric and its bearing, m.
    pub bore_radius_m: f64,
    /// Teeth of the sun on the input shaft.
    pub sun_teeth: usize,
    /// Teeth of a planet.
    pub planet_teeth: usize,
    /// Stiffness of a crank's support in the output, N/m; `None`: a rigid revolute.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub support_stiffness_n_m: Option<f64>,
    /// Stiffness of the mesh of the sun with a planet along the line of action, N/m; `None`: rigid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_stiffness_n_m: Option<f64>,
}

/// Form of the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Formulation {
    /// Centre-pinned bodies eliminated exactly: one angle per free body.
    #[default]
    Reduced,
    /// All bodies, three coordinates each, joints by multipliers (Eq. 2).
    Lagrange,
}

/// Stabilisation of the constraints in the Lagrange form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stabilisation {
    /// None, as published: only accelerations are constrained.
    None,
    /// Baumgarte's feedback of position and velocity errors.
    Baumgarte,
    /// Projection of positions and velocities onto the constraints at every stage.
    Projection,
}

/// Formulation, integrator, sampling.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Solver {
    /// Form of the equations of motion.
    pub formulation: Formulation,
    /// Name of the integrator (`rk2`, `rk4`, `etd-adams`, ...).
    pub integrator: String,
    /// Step of fixed-step methods, s.
    pub step_s: f64,
    /// Relative error per step of adaptive methods.
    pub tolerance: f64,
    /// End time, s.
    pub duration_s: f64,
    /// Sampling interval, s: samples at 0, sample_s, 2 sample_s, ..., duration_s.
    pub sample_s: f64,
    /// Constraint stabilisation of the Lagrange form.
    pub stabilisation: Stabilisation,
}

/// Channels recorded beyond the contract's columns.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Output {
    /// Names of channels ([`crate::channels::FAMILIES`]); `*` matches any characters.
    pub channels: Vec<String>,
}

/// Published gearbox, the preset `paper`.
static PAPER: LazyLock<Scene> = LazyLock::new(|| {
    let text = crate::preset("paper").unwrap_or_default();
    // The text is embedded, and tests read it.
    pinwheel_files::parse(text).expect("the embedded preset is a complete scene")
});

impl Scene {
    /// Returns the published gearbox, the preset `paper`.
    pub fn paper() -> Self {
        PAPER.clone()
    }

    /// Returns the moment of inertia of the output shaft with output pins, cranks or ring pins on its circle, kg m^2. Pins
    /// that do not turn by themselves turn with the output.
    pub fn output_inertia_kg_m2(&self) -> f64 {
        let (gear, mass) = (&self.gear, &self.mass);
        let (count, pin, radius, turns) = match self.drive.output {
            OutputPart::Carrier => (
                gear.internal_sleeves,
                mass.internal_sleeve,
                gear.internal_circle_radius_m,
                gear.internal_sleeves_turn,
            ),
            OutputPart::Ring => (
                gear.external_sleeves,
                mass.external_sleeve,
                gear.pitch_radius_m(),
                gear.external_sleeves_turn,
            ),
        };
        let own = if turns { 0.0 } else { pin.moment_kg_m2 };
        self.output_shaft().moment_kg_m2 + count as f64 * (pin.mass_kg * radius.powi(2) + own)
    }
}

impl Gear {
    /// Returns the number of lobes zs of a disc.
    pub fn lobes(&self) -> usize {
        self.external_sleeves - 1
    }

    /// Returns e zs, m: the largest lever of a pin's force about a disc's centre.
    pub fn lever_m(&self) -> f64 {
        self.eccentricity_m * self.lobes() as f64
    }

    /// Returns R = e zk/m, m: radius of the ring pins' circle without backlash.
    pub fn pitch_radius_m(&self) -> f64 {
        self.eccentricity_m * self.external_sleeves as f64 / self.shortening
    }
}

impl Solver {
    /// Returns the sample times 0, sample_s, 2 sample_s, ... and the end.
    pub fn sample_times_s(&self) -> Vec<f64> {
        let n = (self.duration_s / self.sample_s * (1.0 + 1e-12)).floor() as usize;
        let mut times: Vec<f64> = (0..=n).map(|k| k as f64 * self.sample_s).collect();
        // The end is a sample even if it is no multiple of the interval.
        match times.last_mut() {
            Some(last) if self.duration_s - *last > 1e-9 * self.sample_s => {
                times.push(self.duration_s)
            }
            Some(last) => *last = self.duration_s,
            None => {}
        }
        times
    }
}

/// Symmetric interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlusMinus {
    /// Half-width of the interval, in the unit of the key.
    pub plus_minus: f64,
}

impl PlusMinus {
    /// Returns the standard uncertainty of a value distributed uniformly over the interval.
    pub fn standard(self) -> f64 {
        self.plus_minus / 3.0_f64.sqrt()
    }
}

/// Modification of the discs' profile against the one that fits the ring.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Modification {
    /// Excess of the generating pin's radius over the ring pin's, m; positive values move the edge inwards.
    pub equidistant_m: f64,
    /// Excess of the generating circle's radius over R, m; a negative value makes the disc smaller.
    pub radial_m: f64,
    /// delta, rad: the angle by which both flanks of a lobe are turned towards its middle.
    pub rotational_rad: f64,
    /// Offset of the generating curve along its inward normal: a user-defined profile.
    #[serde(skip_serializing_if = "NormalOffset::is_none")]
    pub normal_m: NormalOffset,
}

/// Offset of a generating curve along its inward normal over the phase of a lobe, equal for all lobes: points or a series.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NormalOffset {
    /// Values at equal steps from a lobe's tip on, counter-clockwise, m: a periodic cubic spline.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub points_m: Vec<f64>,
    /// Amplitudes of cosines of the phase from order 0 on, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cos_m: Vec<f64>,
    /// Amplitudes of sines of the phase from order 1 on, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sin_m: Vec<f64>,
}

/// Deviations of single parts in position and size; an empty list: none. Directions: outwards along the nominal part's
/// radius, and counter-clockwise across it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Errors {
    /// Ring pins, displacement outwards, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub external_sleeve_radial_m: Vec<f64>,
    /// Ring pins, displacement counter-clockwise, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub external_sleeve_tangential_m: Vec<f64>,
    /// Ring pins, error of the radius, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub external_sleeve_radius_m: Vec<f64>,
    /// Output pins, displacement outwards from the output's axis, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub internal_sleeve_radial_m: Vec<f64>,
    /// Output pins, displacement counter-clockwise, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub internal_sleeve_tangential_m: Vec<f64>,
    /// Output pins, error of the radius, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub internal_sleeve_radius_m: Vec<f64>,
    /// Holes, displacement outwards from their disc's centre, m; disc by disc.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hole_radial_m: Vec<f64>,
    /// Holes, displacement counter-clockwise, m; disc by disc.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hole_tangential_m: Vec<f64>,
    /// Holes, error of the radius, m; disc by disc.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub hole_radius_m: Vec<f64>,
    /// Error of the angle of each crank of an RV gear, rad.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub crank_phase_rad: Vec<f64>,
    /// Error of each disc's eccentric, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub eccentricity_m: Vec<f64>,
    /// Error of the angle of each disc's eccentric, rad.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub phase_rad: Vec<f64>,
}
