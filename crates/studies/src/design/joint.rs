//! Single gear joint that represents the gear in a robot's model.
//!
//! With the twist u = psi + phi/zs of the output angle psi against the input angle phi, signs included, the joint is
//!
//! ```text
//! J_out psi'' = T - k(u) - c u' - friction(psi'),    J_in phi'' = T_in - (k(u) + c u')/zs
//! k(u) = sum of k_i max(0, |u| - b_i) sign(u)
//! ```
//! * **k**: springs in parallel, each with its dead band. They pass through the equilibria at [`LEVELS`] of the rated torque,
//!   averaged over the mesh and both directions: the largest curve of rising slope that is nowhere above these points. Free play
//!   is the first dead band.
//! * **c**: damping of the contacts at the equilibrium under the rated load, with the discs following
//!   ([`Statics::compliance`]).
//! * **friction**: losses of runs, as a torque on the output, fitted by a constant, a part proportional to the load and one
//!   proportional to the speed, none below 0. Without runs it is unknown and omitted.
//! * **J_in**: input shaft and the discs' masses on its eccentrics. **J_out**: output with its pins, and the discs' rotation.
//!
//! The joint omits the transmission error, and the variation of stiffness and play over the mesh (their spread is given).

use std::fmt::Write as _;
use std::path::Path;

use nalgebra::{DMatrix, DVector};
use pinwheel_gearbox::statics::{Equilibrium, Statics};
use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_timeseries::figure::{Figure, FigureDef, definitions as defs};
use serde::Serialize;

use super::Operating;
use crate::StudyError;
use crate::balances::figures::{ROUNDING, parted};
use crate::balances::poses::Poses;
use crate::balances::solve::both_ways;
use crate::balances::spread::{ARCMIN, Spread};
use crate::control::of_scene;
use crate::output::{OutputError, file_name, write_text};

/// Shares of the rated torque at which the springs are fitted to the gear.
pub const LEVELS: [f64; 6] = [1e-4, 0.03, 0.1, 0.25, 0.5, 1.0];
/// Poses over one period of the mesh.
const POSES: usize = 12;
/// Number of simulation steps in one period of the joint's vibration.
const STEPS: f64 = 60.0;

/// Spring of the joint with its dead band.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spring {
    /// Twist in either direction at which it engages, rad.
    pub dead_band_rad: f64,
    /// Stiffness beyond the dead band, N m/rad.
    pub stiffness_n_m_per_rad: f64,
}

/// Friction as a torque on the output.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Friction {
    /// Constant part, N m.
    pub constant_n_m: f64,
    /// Load-dependent part under the rated load, N m.
    pub of_rated_load_n_m: f64,
    /// Part proportional to the output's speed, N m s/rad.
    pub viscous_n_m_s_per_rad: f64,
}

/// Joint of a gear.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Joint {
    /// Turns of the input per turn of the output; below 0, as they rotate in opposite directions.
    pub ratio: f64,
    /// Springs in parallel between input and output, by growing dead band.
    pub springs: Vec<Spring>,
    /// Damping parallel to the springs, N m s/rad; `None` if the contacts have no derivatives.
    pub damping_n_m_s_per_rad: Option<f64>,
    /// Friction; `None` without runs.
    pub friction: Option<Friction>,
    /// Moment of inertia about the input's axis, kg m^2.
    pub input_inertia_kg_m2: f64,
    /// Moment of inertia about the output's axis, kg m^2.
    pub output_inertia_kg_m2: f64,
    /// Figures of the joint with uncertainties and spread over the mesh.
    pub figures: Vec<Figure>,
    /// Torque of the curve that the springs follow, N m.
    pub torque_n_m: Vec<f64>,
    /// Twist at these torques, mean over the mesh and both directions, rad.
    pub twist_rad: Vec<f64>,
    #[serde(skip)]
    masses_kg: [f64; 2],
    #[serde(skip)]
    rated_n_m: f64,
    #[serde(skip)]
    name: String,
}

/// Equilibria of one pose.
struct Pose {
    /// Half the twist between both directions, by [`LEVELS`], rad.
    twist: [f64; LEVELS.len()],
    /// Damping, mean of both directions.
    damping: Option<f64>,
}

impl Joint {
    /// Identifies the joint of a gear under a rated load, from equilibria over the period of `poses`, and from runs; `step`
    /// receives the number of each pose and their total.
    pub(super) fn identify(
        statics: &mut Statics<'_>,
        gearbox: &Gearbox,
        (rated, poses): (f64, &Poses),
        runs: &[Operating],
        step: &mut dyn FnMut(usize, usize) -> Result<(), StudyError>,
    ) -> Result<Self, StudyError> {
        let of_scene = |source| of_scene(&gearbox.scene, source);
        let few = poses.few(POSES);
        let count = few.angles.len();
        let mut last: [[Option<Equilibrium>; LEVELS.len()]; 2] = Default::default();
        let both = both_ways(&few, gearbox, |pose, phi, way| {
            step(pose, count)?;
            let last = &mut last[usize::from(way < 0.0)];
            one_way(statics, last, phi, way * rated).map_err(of_scene)
        })?;
        let poses: Vec<Pose> = both.into_iter().map(Pose::of).collect();
        let all: Vec<&Pose> = poses.iter().collect();
        let springs = springs(&mean_twists(&all), rated);
        if springs.is_empty() {
            return Err(of_scene(GearboxError::NoEquilibrium { load_n_m: rated }));
        }
        let scene = &gearbox.scene;
        let ratio = scene.ratio();
        let (mass, gear) = (&scene.mass, &scene.gear);
        let wheels = gear.wheels as f64;
        let pins = gear.internal_sleeves as f64 * mass.internal_sleeve.mass_kg;
        let circling = gearbox.geometry.eccentricities_m.iter();
        let circling = circling.map(|e| mass.wheel.mass_kg * e * e).sum::<f64>();
        // Angles against the ground.
        let turning = match scene.ring_turns() {
            true => scene.eccentric_per_held_carrier(),
            false => scene.eccentric_per_input(),
        };
        let input_inertia_kg_m2 = scene.input_shaft().moment_kg_m2 + circling * turning * turning;
        let output_inertia_kg_m2 = scene.output_inertia_kg_m2() + wheels * mass.wheel.moment_kg_m2;
        let friction = friction(runs, rated, ratio);
        let figures = parted(few.parts, |every, of| {
            let some: Vec<&Pose> = all.iter().skip(of).step_by(every).copied().collect();
            of_balances(&some, rated)
        });
        let twist_rad = mean_twists(&all).to_vec();
        let mut joint = Self {
            ratio: scene.output_per_input().recip(),
            springs,
            damping_n_m_s_per_rad: all.iter().map(|pose| pose.damping).sum::<Option<f64>>(),
            friction: friction.map(|(friction, _)| friction),
            input_inertia_kg_m2,
            output_inertia_kg_m2,
            figures,
            torque_n_m: LEVELS.map(|share| share * rated).to_vec(),
            twist_rad,
            masses_kg: [
                mass.input_shaft.mass_kg + wheels * mass.wheel.mass_kg,
                mass.output_shaft.mass_kg + pins,
            ],
            rated_n_m: rated,
            name: file_name(&scene.name),
        };
        if let Some(damping) = &mut joint.damping_n_m_s_per_rad {
            *damping /= all.len() as f64;
        }
        joint.figures.extend(of_friction(friction));
        joint.figures.extend(joint.of_masses());
        Ok(joint)
    }

    fn of_masses(&self) -> [Figure; 3] {
        let (input, output) = (self.input_inertia_kg_m2, self.output_inertia_kg_m2);
        let both = output + self.ratio * self.ratio * input;
        [
            defs::JOINT_INPUT_INERTIA.of(input, 0.0),
            defs::JOINT_OUTPUT_INERTIA.of(output, 0.0),
            defs::JOINT_REFLECTED_INERTIA.of(both, 0.0),
        ]
    }

    /// Returns the friction in motion under the rated load, N m.
    fn coulomb(&self) -> f64 {
        self.friction
            .map_or(0.0, |f| f.constant_n_m + f.of_rated_load_n_m)
    }

    fn viscous(&self) -> f64 {
        self.friction.map_or(0.0, |f| f.viscous_n_m_s_per_rad)
    }

    /// Returns a step that resolves the joint's vibration, s, with one digit.
    fn step_s(&self) -> f64 {
        let stiffness: f64 = self.springs.iter().map(|s| s.stiffness_n_m_per_rad).sum();
        let input = self.ratio * self.ratio * self.input_inertia_kg_m2;
        let square = stiffness * (1.0 / self.output_inertia_kg_m2 + 1.0 / input);
        let step = std::f64::consts::TAU / square.sqrt() / STEPS;
        let digit = 10.0_f64.powf(step.log10().floor());
        digit * (step / digit).floor()
    }

    /// Returns the comments common to all files, as lines.
    fn remarks(&self) -> String {
        let mut text = String::new();
        let mut line = |what: &str| {
            let _ = writeln!(text, "    {what}");
        };
        line("Equivalent joint of a cycloidal gear; SI units, angles in rad.");
        let ratio = self.ratio;
        line(&format!(
            "ratio: {ratio}; input and output turn {} each other",
            if ratio < 0.0 { "against" } else { "with" }
        ));
        for figure in &self.figures {
            let off = figure.uncertainty.filter(|u| *u > 0.0);
            let off = off.map_or_else(String::new, |u| format!(" (within {u:.1e})"));
            let value = figure
                .value
                .map(|value| format!("{value:.6e} {}", figure.def.unit));
            let value = value.unwrap_or_else(|| "not known".to_owned());
            line(&format!(
                "{}: {value}{off}; {}",
                figure.def.label, figure.def.how
            ));
        }
        if let Some(friction) = self.friction {
            // Motor and load both press on the gear, and the motor's torque includes the friction.
            let share = friction.of_rated_load_n_m / self.rated_n_m;
            let of_load = share / (2.0 + share);
            let [base, viscous] = [friction.constant_n_m, friction.viscous_n_m_s_per_rad]
                .map(|part| part * (1.0 - of_load));
            line(&format!(
                "Friction as BAM's load-dependent model m3 (arXiv:2410.08650): friction_base {base:.6e} N m, \
                 load_friction_base {of_load:.6e}, friction_viscous {viscous:.6e} N m s/rad"
            ));
        }
        line(match self.friction {
            Some(_) => {
                "Friction below is that under the rated load; at part of it less, see above."
            }
            None => "Friction is not known, because no runs were asked for, and left out.",
        });
        text
    }

    /// Returns MuJoCo's form: input and output as joints, with fixed tendons as springs with dead bands between them.
    ///
    /// Source: MuJoCo XML reference, `tendon/fixed`: two values of `springlength` are a dead band; `frictionloss` of joints.
    pub fn mjcf(&self) -> String {
        self.filled(include_str!("../../templates/joint_mujoco.xml"))
    }

    /// Returns a template with the joint's names and numbers inserted.
    fn filled(&self, template: &str) -> String {
        let (name, step) = (&self.name, self.step_s());
        let mut damping = self.damping_n_m_s_per_rad.unwrap_or(0.0);
        let coefficient = -1.0 / self.ratio;
        let tendon = |(k, spring): (usize, &Spring)| {
            let (band, stiffness) = (spring.dead_band_rad, spring.stiffness_n_m_per_rad);
            let damping = std::mem::take(&mut damping);
            format!(
                "    <fixed name=\"{name}-twist-{k}\" springlength=\"-{band} {band}\" stiffness=\"{stiffness}\" damping=\"{damping}\">\n      \
                 <joint joint=\"{name}-output\" coef=\"1\"/>\n      <joint joint=\"{name}-input\" coef=\"{coefficient}\"/>\n    </fixed>\n"
            )
        };
        let tendons = self.springs.iter().enumerate().map(tendon);
        let values = [
            ("{tendons}", tendons.collect()),
            ("{remarks}", self.remarks()),
            ("{name}", name.clone()),
            ("{step}", format!("{step:.0e}")),
            ("{friction_time}", format!("{:.1e}", 4.0 * step)),
            ("{input_mass}", self.masses_kg[0].to_string()),
            ("{output_mass}", self.masses_kg[1].to_string()),
            ("{input_inertia}", self.input_inertia_kg_m2.to_string()),
            ("{output_inertia}", self.output_inertia_kg_m2.to_string()),
            ("{coulomb}", self.coulomb().to_string()),
            ("{viscous}", self.viscous().to_string()),
            ("{rated}", self.rated_n_m.to_string()),
            ("{ratio}", self.ratio.to_string()),
        ];
        let put = |text: String, (key, value): &(&str, String)| text.replace(key, value);
        values.iter().fold(template.to_owned(), put)
    }

    /// Writes `joint_mujoco.xml`, and, as rigid gears with Drake's tags, `joint.urdf` and `joint.sdf`, which contain stiffness
    /// and play in a comment only.
    ///
    /// Sources: ROS wiki, urdf/XML/joint and urdf/XML/Transmission; SDFormat 1.8, `joint/axis`; Drake, multibody/parsing,
    /// `drake:gear_ratio`, `drake:rotor_inertia`, `//model/joint/drake:gear_ratio`.
    pub(super) fn write(&self, dir: &Path) -> Result<(), OutputError> {
        let urdf = self.filled(include_str!("../../templates/joint.urdf"));
        let sdf = self.filled(include_str!("../../templates/joint.sdf"));
        write_text(&dir.join("joint_mujoco.xml"), &self.mjcf())?;
        write_text(&dir.join("joint.urdf"), &urdf)?;
        write_text(&dir.join("joint.sdf"), &sdf)
    }
}

/// Twist under shares of the rated load in one direction, by [`LEVELS`], rad, and damping.
type OneWay = ([f64; LEVELS.len()], Option<f64>);

/// Solves the equilibria of one pose in one direction, starting from the previous ones `last`.
fn one_way(
    statics: &mut Statics<'_>,
    last: &mut [Option<Equilibrium>; LEVELS.len()],
    phi: f64,
    rated: f64,
) -> Result<OneWay, GearboxError> {
    let (mut twist, mut damping) = ([0.0; LEVELS.len()], None);
    for ((twist, share), last) in twist.iter_mut().zip(LEVELS).zip(last) {
        let gearbox = statics.gearbox();
        let load = share * rated;
        let balance = statics.track(last, phi, load)?.clone();
        let turned = balance.output - gearbox.geometry.ideal_output_angle(phi);
        *twist = (turned + gearbox.flange_twist_rad(load)) * load.signum();
        if share == 1.0 {
            damping = statics.compliance(&balance).map(|[_, damping]| damping);
        }
    }
    Ok((twist, damping))
}

impl Pose {
    /// Returns the mean of both directions.
    fn of([(ahead, a), (back, b)]: [OneWay; 2]) -> Self {
        Self {
            twist: std::array::from_fn(|level| 0.5 * (ahead[level] + back[level])),
            damping: a.zip(b).map(|(a, b)| 0.5 * (a + b)),
        }
    }
}

fn mean_twists(poses: &[&Pose]) -> [f64; LEVELS.len()] {
    std::array::from_fn(|level| {
        let twists = poses.iter().map(|pose| pose.twist[level]);
        twists.sum::<f64>() / poses.len() as f64
    })
}

/// Returns springs in parallel through the twists at [`LEVELS`]: the largest curve of rising slope that is nowhere above these
/// points, so that no spring has to pull.
pub fn springs(twists: &[f64], rated: f64) -> Vec<Spring> {
    // Twist and torque at the segments' ends so far; a segment steeper than the next is merged with it.
    let mut corners: Vec<[f64; 2]> = Vec::new();
    let slope = |a: [f64; 2], b: [f64; 2]| (b[1] - a[1]) / (b[0] - a[0]);
    for (&twist, share) in twists.iter().zip(LEVELS) {
        let next = [twist, share * rated];
        while let [.., before, last] = corners[..] {
            if last[0] < next[0] && slope(before, last) < slope(last, next) {
                break;
            }
            corners.pop();
        }
        if corners.last().is_none_or(|last| last[0] < next[0]) {
            corners.push(next);
        }
    }
    let mut springs: Vec<Spring> = Vec::new();
    let mut stiffness = 0.0;
    for pair in corners.windows(2) {
        let steeper = slope(pair[0], pair[1]);
        // The first spring engages at its line's zero.
        let before = pair[0][1] / steeper;
        let from = pair[0][0] - if springs.is_empty() { before } else { 0.0 };
        springs.push(Spring {
            dead_band_rad: from.max(0.0),
            stiffness_n_m_per_rad: steeper - stiffness,
        });
        stiffness = steeper;
    }
    springs
}

/// Returns the figures of the equilibria of these poses.
fn of_balances(poses: &[&Pose], rated: f64) -> Vec<Figure> {
    let twists = mean_twists(poses);
    let at = |share: f64| LEVELS.iter().position(|level| *level == share);
    let spread = |of: &dyn Fn(&Pose) -> f64| Spread::of(poses.iter().map(|pose| of(pose)));
    let (Some(half), Some(full)) = (at(0.5), at(1.0)) else {
        return Vec::new();
    };
    let play = spread(&|pose| 2.0 * ARCMIN * pose.twist[0]);
    let stiff = |twists: &[f64]| 0.5 * rated / (twists[full] - twists[half]);
    let stiffness = spread(&|pose| stiff(&pose.twist));
    let line = twists[full] - rated / stiff(&twists);
    let dampings: Option<Vec<f64>> = poses.iter().map(|pose| pose.damping).collect();
    let damping = dampings.map(Spread::of);
    let damped = match damping {
        Some(spread) => defs::JOINT_DAMPING
            .of(spread.mean, 0.0)
            .over(&spread, ROUNDING),
        None => defs::JOINT_DAMPING.of(None, None),
    };
    vec![
        defs::JOINT_BACKLASH
            .of(play.mean, 0.0)
            .over(&play, ROUNDING),
        defs::JOINT_STIFFNESS
            .of(stiff(&twists), 0.0)
            .over(&stiffness, ROUNDING),
        defs::JOINT_DEAD_BAND.of(2.0 * ARCMIN * line.max(0.0), 0.0),
        damped,
    ]
}

/// Fits the friction of runs by least squares; returns it with the uncertainty of each part.
fn friction(runs: &[Operating], rated: f64, ratio: f64) -> Option<(Friction, [f64; 3])> {
    let speed = runs.iter().map(|run| run.input_speed_rad_s.abs());
    let speed = speed.fold(0.0, f64::max) / ratio;
    // Shares of rated load and speed, with the lost torque.
    let mut rows: Vec<([f64; 3], f64)> = Vec::new();
    for run in runs {
        let lost = run.efficiency?.of_losses.recip() - 1.0;
        let load = run.output_torque_n_m.abs();
        let turn = run.input_speed_rad_s.abs() / ratio;
        rows.push(([1.0, load / rated, turn / speed], lost * load));
    }
    let torque = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.1));
    let mut kept = vec![0, 1, 2];
    // Negative parts are dropped, and the others fitted again.
    while !kept.is_empty() && rows.len() > kept.len() {
        let matrix = DMatrix::from_fn(rows.len(), kept.len(), |row, k| rows[row].0[kept[k]]);
        let inverse = (matrix.transpose() * &matrix).try_inverse()?;
        let parts = &inverse * matrix.transpose() * &torque;
        let least = parts.imin();
        if parts[least] < 0.0 {
            kept.remove(least);
            continue;
        }
        let left = (&matrix * &parts - &torque).norm_squared() / (rows.len() - kept.len()) as f64;
        let (mut value, mut off) = ([0.0; 3], [left.sqrt(); 3]);
        for (k, &part) in kept.iter().enumerate() {
            value[part] = parts[k];
            off[part] = (left * inverse[(k, k)]).sqrt();
        }
        let friction = Friction {
            constant_n_m: value[0],
            of_rated_load_n_m: value[1],
            viscous_n_m_s_per_rad: value[2] / speed,
        };
        return Some((friction, [off[0], off[1], off[2] / speed]));
    }
    None
}

fn of_friction(parts: Option<(Friction, [f64; 3])>) -> [Figure; 3] {
    let (friction, off) = parts.unzip();
    let part = |k: usize, def: &FigureDef, of: fn(Friction) -> f64| {
        def.of(friction.map(of), off.map(|off| off[k]))
    };
    [
        part(0, &defs::JOINT_FRICTION, |f| f.constant_n_m),
        part(1, &defs::JOINT_FRICTION_OF_LOAD, |f| f.of_rated_load_n_m),
        part(2, &defs::JOINT_VISCOUS, |f| f.viscous_n_m_s_per_rad),
    ]
}
