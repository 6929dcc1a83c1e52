//! Design figures of a gear: lost motion, stiffness, transmission error, load sharing, pressure, bearings, efficiency.
//!
//! ```text
//!                 ┌─ balances at poses over one period of the mesh ─> stiffness, lost motion, transmission error,
//!  checked scene ─┤                                                   load sharing, pressure, bearings
//!                 └─ runs: a slow loop of the load, speeds and torques ─> hysteresis, efficiency
//! ```
//!
//! Statics gives all figures that do not need dynamics: the balance of the contacts at rest, with exact geometry and the
//! scene's law. Lost motion is computed by statics and by a run, and their difference is stated. Conventions:
//!
//! * **Lost motion**: angle of the output between +3 % and -3 % of the rated torque with a locked input, arcmin.
//! * **Torsional stiffness**: secant between 50 and 100 % of the rated torque with a locked input, N m/arcmin.
//! * **Transmission error**: output angle less that of the ideal mesh, arcmin; its harmonics in cycles per turn of the
//!   input.
//! * **Pressure**: of a line contact after Hertz over the face width, p0 = sqrt(F E*/(pi L R)) with E* = E/(2 (1 - nu^2))
//!   (K. L. Johnson, Contact Mechanics, 1985, section 4.2). Edges are left out.
//! * **Sliding**: of the disc on pins that do not turn. Sleeves that turn slide on their own pins instead.
//!
//! The rated torque is the largest load of the scene, the rated speed its input speed.

mod budget;
mod cycle;
pub(crate) mod drawing;
pub(crate) mod joint;
pub(crate) mod limits;

use std::path::Path;

use pinwheel_engines::Native;
use pinwheel_gearbox::auto::AUTO;
use pinwheel_gearbox::statics::Statics;
use pinwheel_gearbox::{Efficiency, Gearbox, GearboxError};
use pinwheel_scene::{CheckedScene, Derived, Scene, derived, speed_profile};
use pinwheel_timeseries::figure::Figure;
use pinwheel_timeseries::figure::definitions::{EFFICIENCY, LOOP_WIDTH, LOST_MOTION_RUN};
use pinwheel_timeseries::table::{Column, Table};
use serde::Serialize;

use crate::band::{self, Bands};
use crate::control::{compile, of_scene};
use crate::motion::Motion;
use crate::output::{OutputError, write_with};
use crate::provenance::{Provenance, Summary};
use crate::{Control, Progress, StudyError, single};

pub use crate::balances::mesh::{Bearing, Pair, Pressure, Sharing, Stage};
pub use crate::balances::orders::{ForceHarmonic, Harmonic};
pub use crate::balances::solve::few_figures;
pub use crate::balances::spread::Spread;
pub use budget::{Rest, Share};
pub use cycle::{Cycle, cycle};
pub use drawing::{CHORD_M, Drawing};
pub use joint::{Friction, Joint, Spring};
pub use limits::{Answer, Limit, Limits};

use crate::balances::branches::hysteresis;
use crate::balances::figures::{LOST, withhold_lost_motion};
use crate::balances::orders;
use crate::balances::poses::Poses;
use crate::balances::solve::{NO_LOAD, POSES, balances, is_mirrored, twist, working_load};
use crate::balances::spread::ARCMIN;

/// Number of points of the torsion curve, on either side of 0.
const CURVE: usize = 20;
/// Relative difference within which the largest forces of two bearings count as equal. They are sampled at other poses of
/// the same mesh: for four gears without errors they differ by 2.4e-4 at most.
const ALIKE: f64 = 1e-2;
/// Reason for a loop of a run without a width.
const FADES: &str = "friction of sleeves, bearings or seals, or play, needs a slower run than this; statics gives the hysteresis";
/// Shares of the rated speed and torque of the efficiency's map.
const SPEEDS: [f64; 2] = [0.5, 1.0];
const TORQUES: [f64; 3] = [0.25, 0.5, 1.0];

/// Twist of the output against the locked input.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Torsion {
    /// Lost motion between +3 % and -3 % of the rated torque, arcmin; `None` if parts overlap.
    pub lost_motion_arcmin: Option<Spread>,
    /// Lost motion at the input angle 0, as in the hysteresis loop, arcmin.
    pub lost_motion_at_0_arcmin: Option<f64>,
    /// Stiffness between 50 and 100 % of the rated torque, both directions, N m/arcmin.
    pub stiffness_n_m_per_arcmin: Spread,
    /// Torques of the curve at the input angle 0, N m.
    pub torque_n_m: Vec<f64>,
    /// Twist at these torques, arcmin.
    pub twist_arcmin: Vec<f64>,
}

/// Transmission error over one period of the mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Transmission {
    /// Torque on the output, N m.
    pub torque_n_m: f64,
    /// Peak-to-peak value, arcmin.
    pub peak_to_peak_arcmin: f64,
    /// Mean value, arcmin: free play and elastic twist.
    pub mean_arcmin: f64,
    /// Largest harmonics, largest first.
    pub harmonics: Vec<Harmonic>,
    /// Values at the period's input angles, arcmin.
    pub error_arcmin: Vec<f64>,
}

/// Efficiency of one run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Operating {
    /// Input speed, rad/s.
    pub input_speed_rad_s: f64,
    /// Load, N m.
    pub output_torque_n_m: f64,
    /// Efficiency; `None` without power, or after a divergence.
    pub efficiency: Option<Efficiency>,
    /// Uncertainty by the run's verified error of the driver's torque.
    #[serde(rename = "numerical_uncertainty")]
    pub uncertainty: Option<f64>,
    /// Ending of the run.
    pub status: &'static str,
}

/// Results of a design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignResult {
    /// Scene of the design.
    #[serde(skip)]
    pub scene: CheckedScene,
    /// Largest load of the scene, N m.
    pub rated_torque_n_m: f64,
    /// Reason for missing lost motion: parts overlap.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preloaded: Option<String>,
    /// Data-sheet figures, each with its numerical uncertainty and its band by contact law.
    pub figures: Vec<Figure>,
    /// Other contact laws and fits; `None` without any to compare.
    pub bands: Option<Bands>,
    /// Loads of the parts against their limits.
    pub limits: Limits,
    /// Quantities that follow from the dimensions.
    pub dimensions: Derived,
    /// Lost motion and stiffness.
    pub torsion: Torsion,
    /// Input angles of one period of the mesh, rad.
    pub input_angle_rad: Vec<f64>,
    /// Transmission error under the rated load and under nearly none.
    pub transmission: [Transmission; 2],
    /// Parts that deflect under the rated load; empty if only contacts do.
    pub budget: Vec<Share>,
    /// Remaining compliance, as a fit to a stated stiffness ([`DesignResult::fit_rest`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest: Option<Rest>,
    /// Sharing of the rated load.
    pub sharing: [Sharing; 2],
    /// Pressure and sliding under the rated load.
    pub pressure: [Pressure; 2],
    /// Force on the eccentric's bearing of every disc.
    pub bearings: Vec<Bearing>,
    /// Hysteresis loop of a slow run; `None` without runs.
    pub cycle: Option<Cycle>,
    /// Efficiency over speed and torque; empty without runs.
    pub efficiency: Vec<Operating>,
    /// Model of the gear as one joint of a robot; `None` if not requested.
    pub joint: Option<Joint>,
    /// Drawings of the discs.
    pub discs: Vec<Drawing>,
    /// Number of balances of the unchanged gear solved before the bands, and of stored ones.
    pub balances: [u64; 2],
    /// Evaluations of all contacts for these balances.
    pub evaluations: u64,
    /// Motion of the gearbox, for a page.
    #[serde(skip)]
    pub motion: Option<Motion>,
}

/// Computes the design of the scene of `gearbox`; `runs`: also the figures of dynamic runs.
///
/// # Errors
/// Cancelled; no load, or more than the teeth carry; a scene that cannot be modelled.
pub fn run(
    gearbox: &Gearbox,
    runs: bool,
    control: &Control<'_>,
) -> Result<DesignResult, StudyError> {
    let mut design = answers(gearbox, runs, control)?;
    // The cheapest method that resolves the forces suffices for a picture.
    let cheap = gearbox.with_solver(|solver| AUTO.clone_into(&mut solver.integrator));
    let cheap = cheap.map_err(|source| of_scene(&gearbox.scene, source.into()))?;
    design.motion = Motion::of(&cheap, control)?;
    Ok(design)
}

/// Computes the design like [`run`], without the motion.
///
/// # Errors
/// Errors of [`run`].
pub(crate) fn answers(
    gearbox: &Gearbox,
    runs: bool,
    control: &Control<'_>,
) -> Result<DesignResult, StudyError> {
    let mut statics = Statics::new(gearbox).map_err(|source| of_scene(&gearbox.scene, source))?;
    let mut design = figures_by(&mut statics, runs, control)?;
    let poses = Poses::of(&gearbox.scene);
    let rated = (design.rated_torque_n_m, &poses);
    design.budget = budget::of(&mut statics, working_load(gearbox)?, control)?;
    design.discs = drawing::discs(&gearbox.scene)?;
    let total = stages(runs);
    let step = &mut |pose: usize, all: usize| {
        let what = format!("joint, pose {} of {all}", pose + 1);
        (control.progress)(Progress::new(total - 2, total, &what));
        Ok(control.check()?)
    };
    let joint = Joint::identify(&mut statics, gearbox, rated, &design.efficiency, step)?;
    design.joint = Some(joint);
    (design.balances, design.evaluations) = (statics.balances(), statics.evaluations());
    (control.progress)(Progress::new(total - 1, total, "other contact laws"));
    design.bands = band::of_known(statics, control)?;
    if let Some(bands) = &design.bands {
        bands.bound_all(&mut design.figures);
    }
    design.limits = Limits::of(&gearbox.scene, &design.figures);
    Ok(design)
}

/// Computes a design without budget, joint, bands and drawings, by a solver that stores the balances.
///
/// # Errors
/// See [`run`].
fn figures_by(
    statics: &mut Statics<'_>,
    runs: bool,
    control: &Control<'_>,
) -> Result<DesignResult, StudyError> {
    let gearbox = statics.gearbox();
    let scene = &gearbox.scene;
    let working = working_load(gearbox)?;
    let rated = working.abs();
    let of_scene = |source| of_scene(scene, source);
    let total = stages(runs);
    let step = |done: usize, what: &str| -> Result<(), StudyError> {
        (control.progress)(Progress::new(done, total, what));
        Ok(control.check()?)
    };
    let poses = Poses::of(scene);
    step(0, "torsion")?;
    let curve = curve(statics, working).map_err(of_scene)?;
    let balances = balances(
        statics,
        gearbox,
        &poses,
        (working, true),
        &mut |stage, pose, all| {
            let what = ["torsion", "rated load", "no load"][stage];
            step(stage, &format!("{what}, pose {} of {all}", pose + 1))
        },
    )?;
    let time_series = [
        (&balances.loaded, rated),
        (&balances.unloaded, NO_LOAD * rated),
    ];
    let transmission = time_series.map(|(list, torque)| {
        let error: Vec<f64> = list.iter().map(|pose| ARCMIN * pose.error_rad).collect();
        let spread = Spread::of(error.iter().copied());
        Transmission {
            torque_n_m: torque,
            peak_to_peak_arcmin: spread.max - spread.min,
            mean_arcmin: spread.mean,
            harmonics: orders::of_angle(&error, &poses),
            error_arcmin: error,
        }
    });
    let mut done = 3;
    let (mut cycle, mut efficiency) = (None, Vec::new());
    if runs {
        step(done, "hysteresis loop")?;
        cycle = Some(cycle::cycle(gearbox, rated, control)?);
        for speed in SPEEDS {
            for torque in TORQUES {
                done += 1;
                step(done, "efficiency")?;
                efficiency.push(operating(gearbox, speed, torque * rated, control)?);
            }
        }
    }
    let mut figures = balances.figures();
    figures.extend(of_runs(cycle.as_ref(), &efficiency));
    figures.extend(balances.slow_efficiency(statics, working));
    figures.extend(hysteresis(statics, &poses.few(POSES), working)?);
    let preloaded = balances.preloaded();
    let is_loose = preloaded.is_none();
    withhold_lost_motion(&mut figures, preloaded.as_ref());
    figures.extend(balances.of_bearings(scene));
    figures.extend(limits::figures(&balances, scene));
    balances.withhold_forces(&mut figures);

    let mut bearings = Bearing::all(&balances.loaded.iter().collect::<Vec<_>>());
    for bearing in &mut bearings {
        bearing.radial_harmonics = orders::of_force(&bearing.radial_n, &poses);
    }
    Ok(DesignResult {
        scene: scene.clone(),
        rated_torque_n_m: rated,
        preloaded,
        figures,
        bands: None,
        limits: Limits::default(),
        dimensions: derived(scene),
        torsion: Torsion {
            lost_motion_arcmin: is_loose.then(|| Spread::of(balances.lost.iter().copied())),
            lost_motion_at_0_arcmin: is_loose.then(|| balances.lost[0]),
            stiffness_n_m_per_arcmin: Spread::of(balances.stiffness.iter().flatten().copied()),
            torque_n_m: curve.0,
            twist_arcmin: curve.1,
        },
        budget: Vec::new(),
        rest: None,
        sharing: Stage::BOTH.map(|stage| Sharing::of(&balances.loaded, stage)),
        pressure: Stage::BOTH.map(|stage| Pressure::of(&balances.loaded, stage)),
        bearings,
        input_angle_rad: poses.angles,
        transmission,
        cycle,
        efficiency,
        joint: None,
        discs: Vec::new(),
        balances: [0; 2],
        evaluations: 0,
        motion: None,
    })
}

/// Returns the figures of runs.
fn of_runs(cycle: Option<&Cycle>, efficiency: &[Operating]) -> Vec<Figure> {
    let ended = |status: &str| match status {
        "finished" => None,
        status => Some(format!("the run {status}")),
    };
    let mut figures = Vec::new();
    if let Some(cycle) = cycle {
        figures.extend([
            LOST_MOTION_RUN.of(
                cycle.lost_motion_arcmin,
                cycle.lost_motion_uncertainty_arcmin,
            ),
            LOOP_WIDTH.of(cycle.width_arcmin, cycle.width_uncertainty_arcmin),
        ]);
        for figure in &mut figures {
            let why = ended(cycle.status).unwrap_or_else(|| FADES.to_owned());
            figure.withheld = Some(why).filter(|_| figure.value.is_none());
        }
    }
    if let Some(rated) = efficiency.last() {
        let percent = |share: f64| 100.0 * share;
        let defined = rated.efficiency.map(|efficiency| efficiency.defined());
        figures.push(match defined {
            Some(Ok(share)) => EFFICIENCY.of(percent(share), rated.uncertainty.map(percent)),
            Some(Err(why)) => EFFICIENCY.of(None, None).withheld(why),
            None => EFFICIENCY.of(None, None).withheld(ended(rated.status)),
        });
    }
    figures
}

/// Returns the number of stages of [`run`]: three of balances, the runs if any, joint and other contact laws.
fn stages(runs: bool) -> usize {
    5 + usize::from(runs) * (1 + SPEEDS.len() * TORQUES.len())
}

/// Returns torque, N m, and twist, arcmin, at the input angle 0.
fn curve(statics: &mut Statics<'_>, working: f64) -> Result<(Vec<f64>, Vec<f64>), GearboxError> {
    // No point at 0: backlash leaves the output undetermined there. From the largest load down, each from the previous
    // balance.
    let up = std::iter::once(LOST).chain((1..=CURVE).map(|k| k as f64 / CURVE as f64));
    let shares: Vec<f64> = up.collect();
    let is_mirrored = is_mirrored(statics.gearbox());
    let mut way = |sign: f64| -> Result<Vec<f64>, GearboxError> {
        let mut last = None;
        let down = shares.iter().rev();
        let twists = down.map(|share| twist(statics, &mut last, 0.0, sign * share * working));
        twists.collect()
    };
    let ahead = way(1.0)?;
    let back = match is_mirrored {
        true => ahead.clone(),
        false => way(-1.0)?,
    };
    let down = shares.iter().rev().map(|share| -share);
    let torques = down
        .chain(shares.iter().copied())
        .map(|share| share * working.abs());
    let twists = back
        .iter()
        .map(|twist| -twist)
        .chain(ahead.iter().rev().copied());
    Ok((torques.collect(), twists.collect()))
}

/// Runs a share of the rated speed under the load `torque`, for as many turns as the scene.
fn operating(
    gearbox: &Gearbox,
    speed: f64,
    torque: f64,
    control: &Control<'_>,
) -> Result<Operating, StudyError> {
    let rated = &gearbox.scene;
    let mut scene = Scene::clone(rated);
    scene.drive.input_speed_rad_s = speed * speed_profile::fastest_rad_s(&rated.drive);
    scene.drive.speed_changes.clear();
    scene.drive.output_torque_n_m = torque.copysign(rated.drive.output_torque_n_m);
    scene.drive.load_changes.clear();
    scene.solver.duration_s /= speed;
    scene.solver.sample_s /= speed;
    scene.solver.integrator = "auto".to_owned();
    let gearbox = compile(&scene)?;
    let study = single::run(&gearbox, &Native::REDUCED, false, control)?;
    let account = study.run.stats.energy.last();
    let account = account.filter(|_| study.run.ending.is_finished());
    let efficiency = account.and_then(Efficiency::of);
    let error = study.run.uncertainty.as_ref().and_then(|u| u.error);
    let known = efficiency.zip(error);
    Ok(Operating {
        input_speed_rad_s: gearbox.scene.drive.input_speed_rad_s,
        output_torque_n_m: torque,
        uncertainty: known.map(|(e, error)| e.of_losses * error.driver_torque),
        efficiency,
        status: study.run.ending.word(),
    })
}

impl DesignResult {
    /// Fits the remaining compliance to a stated stiffness, N m/arcmin.
    ///
    /// # Errors
    /// A stiffness that leaves nothing to fit.
    pub fn fit_rest(&mut self, stated_n_m_per_arcmin: f64) -> Result<(), StudyError> {
        self.rest = Some(Rest::of(self, stated_n_m_per_arcmin)?);
        Ok(())
    }

    /// Repeats the design for another gear, with the compliance fitted to this one; `None` if any bit of the results
    /// differs.
    pub(crate) fn repeated(
        &self,
        gearbox: &Gearbox,
        control: &Control<'_>,
    ) -> Result<Option<Self>, StudyError> {
        let own = self.clone();
        let rest = self.rest;
        let of_scene = |source| of_scene(&gearbox.scene, source);
        // Most settings change the statics, which take a fraction of the time of runs.
        let statics = Self {
            scene: own.scene,
            figures: own.figures,
            bands: own.bands,
            limits: own.limits,
            cycle: own.cycle,
            efficiency: own.efficiency,
            joint: own.joint,
            budget: own.budget,
            discs: own.discs,
            balances: own.balances,
            evaluations: own.evaluations,
            motion: own.motion,
            rest,
            ..figures_by(
                &mut Statics::new(gearbox).map_err(of_scene)?,
                false,
                control,
            )?
        };
        if statics != *self {
            return Ok(None);
        }
        let mut result = run(gearbox, self.cycle.is_some(), control)?;
        // The motion names the scene and is excluded from the comparison.
        let motion = std::mem::replace(&mut result.motion, statics.motion);
        let again = Self {
            scene: statics.scene,
            rest,
            ..result
        };
        Ok((again == *self).then_some(Self { motion, ..again }))
    }

    /// Returns the eccentric bearing with the largest force; the first of equally loaded discs.
    pub fn most_loaded(&self) -> Option<&Bearing> {
        let more = |a: &Bearing, b: &Bearing| b.force_n.max > a.force_n.max * (1.0 + ALIKE);
        let mut bearings = self.bearings.iter();
        bearings.next().map(|first| {
            bearings.fold(
                first,
                |most, other| if more(most, other) { other } else { most },
            )
        })
    }

    /// Returns the parts that deflect with their shares of the total compliance, which includes a fitted rest. Empty if
    /// only contacts deflect.
    pub fn shares(&self) -> Vec<(&'static str, f64)> {
        let own = self.budget.iter().map(|part| (part.part, part.share));
        let Some(rest) = self.rest else {
            return own.collect();
        };
        let mut shares: Vec<_> = own.filter(|(part, _)| *part != budget::REST).collect();
        if shares.is_empty() {
            shares.push((budget::CONTACTS, 1.0));
        }
        let total: f64 = shares.iter().map(|(_, share)| share).sum();
        for (_, share) in &mut shares {
            *share *= (1.0 - rest.share) / total;
        }
        shares.push(("the rest, fitted", rest.share));
        shares
    }

    /// Writes `summary.json`, `torsion.csv`, `period.csv`, with runs `hysteresis.csv`, and the joint into the folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, dir: &Path, origin: &Provenance) -> Result<(), OutputError> {
        Summary::new(origin, self).write(dir)?;
        let torsion = [
            Column::numbers("torque_n_m", &self.torsion.torque_n_m),
            Column::numbers("twist_arcmin", &self.torsion.twist_arcmin),
        ];
        table(dir, "torsion.csv", torsion.into())?;
        let [rated, unloaded] = &self.transmission;
        let mut period = vec![
            Column::numbers("input_angle_rad", &self.input_angle_rad),
            Column::numbers("transmission_error_arcmin", &rated.error_arcmin),
            Column::numbers("transmission_error_unloaded_arcmin", &unloaded.error_arcmin),
        ];
        for (k, bearing) in self.bearings.iter().enumerate() {
            let [radial, tangential] = ["radial", "tangential"]
                .map(|part| format!("eccentric_bearing_{part}_force_n_{k}"));
            period.push(Column::numbers(radial, &bearing.radial_n));
            period.push(Column::numbers(tangential, &bearing.tangential_n));
        }
        table(dir, "period.csv", period)?;
        if let Some(cycle) = &self.cycle {
            let columns = [
                Column::numbers("time_s", &cycle.time_s),
                Column::numbers("torque_n_m", &cycle.torque_n_m),
                Column::numbers("output_angle_arcmin", &cycle.angle_arcmin),
            ];
            table(dir, "hysteresis.csv", columns.into())?;
        }
        if let Some(joint) = &self.joint {
            joint.write(dir)?;
        }
        for disc in &self.discs {
            disc.write(dir)?;
        }
        Ok(())
    }
}

fn table(dir: &Path, name: &str, columns: Vec<Column>) -> Result<(), OutputError> {
    let caption = String::new();
    let table = Table { caption, columns };
    write_with(dir, name, |sink| table.write_csv(sink))
}
