//! Balances at poses over one period of the mesh: the twist under shares of the load, the rated load, nearly no load.

use std::sync::atomic::AtomicBool;

use pinwheel_gearbox::pressure::LinePressure;
use pinwheel_gearbox::statics::{Equilibrium, Statics};
use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_scene::{Scales, load_profile, speed_profile};
use pinwheel_timeseries::figure::Figure;

use super::figures::{Balances, LOST};
use super::mesh::{Pose, Wanted};
use super::poses::Poses;
use super::spread::ARCMIN;
use crate::control::of_scene;
use crate::{Control, StudyError};

/// Shares of the rated torque between which stiffness is a secant.
const STIFF: [f64; 2] = [0.5, 1.0];
/// Share of the rated torque for no load: contacts still determine the output angle.
pub(crate) const NO_LOAD: f64 = 1e-4;
/// Number of poses for stiffness, lost motion and hysteresis.
pub(crate) const POSES: usize = 24;
/// Poses at which contact laws are compared.
pub(crate) const FEW: usize = 24;

/// Returns the largest load of a scene in the gear's working direction, as a moment on the carrier's turn against the ring, N m.
///
/// # Errors
/// A scene without a load.
pub(crate) fn working_load(gearbox: &Gearbox) -> Result<f64, StudyError> {
    let scene = &gearbox.scene;
    let rated = load_profile::largest(&scene.drive);
    if rated <= 0.0 {
        return Err(StudyError::Input(format!(
            "{}: `drive.output_torque_n_m` is 0, and a design is judged under its rated torque; give it",
            scene.name
        )));
    }
    let rounding = Scales::of(scene).rounding_n_m();
    if rated <= rounding {
        return Err(StudyError::Input(format!(
            "{}: `drive.output_torque_n_m` is {rated:.1e}, and up to {rounding:.0e} N m there is only rounding in this gear; \
             give its rated torque",
            scene.name
        )));
    }
    let working = match gearbox.load_torque(scene.solver.duration_s) {
        torque if torque != 0.0 => rated.copysign(torque),
        _ => -rated.copysign(speed_profile::fastest_rad_s(&scene.drive)),
    };
    Ok(gearbox.along_carrier_n_m(working))
}

/// Solves all balances behind the figures: the twist at a few of the poses, then the rated load and almost none at all poses.
/// `rubs` adds friction, which takes two more balances under the rated load. `step` receives the index of the balance, its
/// pose, and the number of poses.
pub(crate) fn balances(
    statics: &mut Statics<'_>,
    gearbox: &Gearbox,
    poses: &Poses,
    (working, rubs): (f64, bool),
    step: &mut dyn FnMut(usize, usize, usize) -> Result<(), StudyError>,
) -> Result<Balances, StudyError> {
    let of_scene = |source| of_scene(&gearbox.scene, source);
    let mut rubbing = match rubs {
        true => Statics::rubbing(gearbox).map_err(of_scene)?,
        false => None,
    };
    let few = poses.few(POSES.min(poses.angles.len()));
    let (lost, stiffness) = twisted(statics, &few, gearbox, working, &mut |pose| {
        step(0, pose, few.angles.len())
    })?;
    let pressure = LinePressure::new(&gearbox.scene.contact);
    let mut at = |stage: usize, load: f64| -> Result<Vec<Pose>, StudyError> {
        let mut near = None;
        along(poses, |done, phi| {
            step(stage, done, poses.angles.len())?;
            // Without a load only the largest force is needed; for equal pins one part of the poses has it.
            let wanted = match stage {
                1 => Wanted::Pairs(&pressure),
                _ if is_mirrored(gearbox) && done % poses.parts > 0 => Wanted::Nothing,
                _ => Wanted::Forces,
            };
            let pose = Pose::find(statics, wanted, phi, load, &mut near);
            let mut pose = pose.map_err(of_scene)?;
            if let (1, Some(statics), Some(at)) = (stage, &mut rubbing, &near) {
                pose.rub(statics, wanted, at, load);
            }
            Ok(pose)
        })
    };
    Ok(Balances {
        parts: poses.parts,
        meshes: is_mirrored(gearbox).then_some(poses.meshes),
        on_cranks: gearbox.carrier.cranks().is_some(),
        lost,
        stiffness,
        loaded: at(1, working)?,
        unloaded: at(2, NO_LOAD * working)?,
        rubs: rubbing.is_some(),
    })
}

/// Returns the figures of a gear's balances at few poses, for comparison of laws and interactive use.
///
/// # Errors
/// A gear without load, or one that cannot be balanced; `cancel` was set.
pub fn few_figures(gearbox: &Gearbox, cancel: &AtomicBool) -> Result<Vec<Figure>, StudyError> {
    let mut statics = Statics::new(gearbox).map_err(|source| of_scene(&gearbox.scene, source))?;
    few_figures_by(&mut statics, true, cancel)
}

/// Computes [`few_figures`] by a solver that may have stored balances, with friction or without.
pub(crate) fn few_figures_by(
    statics: &mut Statics<'_>,
    rubs: bool,
    cancel: &AtomicBool,
) -> Result<Vec<Figure>, StudyError> {
    let poses = Poses::of(&statics.gearbox().scene).few(FEW);
    Ok(at_poses(statics, (&poses, rubs), cancel)?.figures())
}

/// Solves all balances behind the figures, at some poses, with friction or without.
pub(crate) fn at_poses(
    statics: &mut Statics<'_>,
    (poses, rubs): (&Poses, bool),
    cancel: &AtomicBool,
) -> Result<Balances, StudyError> {
    let gearbox = statics.gearbox();
    let working = working_load(gearbox)?;
    let control = Control::silent(cancel);
    let load = (working, rubs);
    balances(statics, gearbox, poses, load, &mut |_, _, _| {
        Ok(control.check()?)
    })
}

/// Returns the twist of the output from the ideal mesh under a load, in the direction of that load, arcmin. `last` is the
/// previous balance under the same load, for [`Statics::track`].
pub(crate) fn twist(
    statics: &mut Statics<'_>,
    last: &mut Option<Equilibrium>,
    phi: f64,
    load: f64,
) -> Result<f64, GearboxError> {
    let gearbox = statics.gearbox();
    let balance = statics.track(last, phi, load)?;
    let ideal = gearbox.geometry.ideal_output_angle(phi);
    let output = balance.output + gearbox.flange_twist_rad(load);
    Ok(ARCMIN * (output - ideal) * load.signum())
}

/// True if a gear at the input angle -phi under the load -T is its mirror image at phi under T.
pub(crate) fn is_mirrored(gearbox: &Gearbox) -> bool {
    gearbox.scene.gear.errors.is_none()
}

/// Returns the results of `find` at every pose in both directions of the load, 1 and -1. In a mirrored gear the backward
/// results are the forward ones at the opposite pose.
pub(crate) fn both_ways<T: Clone>(
    poses: &Poses,
    gearbox: &Gearbox,
    mut find: impl FnMut(usize, f64, f64) -> Result<T, StudyError>,
) -> Result<Vec<[T; 2]>, StudyError> {
    if !is_mirrored(gearbox) {
        return along(poses, |done, phi| {
            Ok([find(done, phi, 1.0)?, find(done, phi, -1.0)?])
        });
    }
    let ahead = along(poses, |done, phi| find(done, phi, 1.0))?;
    let back = std::iter::once(&ahead[0]).chain(ahead[1..].iter().rev());
    let pairs = ahead.iter().zip(back);
    Ok(pairs.map(|(a, b)| [a.clone(), b.clone()]).collect())
}

/// Returns the results of `find` at every pose, from its position in the order of solution and its input angle.
pub(crate) fn along<T>(
    poses: &Poses,
    mut find: impl FnMut(usize, f64) -> Result<T, StudyError>,
) -> Result<Vec<T>, StudyError> {
    let mut results: Vec<(usize, T)> = Vec::with_capacity(poses.angles.len());
    for (done, pose) in poses.walk().enumerate() {
        results.push((pose, find(done, poses.angles[pose])?));
    }
    results.sort_unstable_by_key(|(pose, _)| *pose);
    Ok(results.into_iter().map(|(_, one)| one).collect())
}

/// Returns lost motion, arcmin, and stiffness in either direction, N m/arcmin, at these poses.
pub(crate) fn twisted(
    statics: &mut Statics<'_>,
    poses: &Poses,
    gearbox: &Gearbox,
    working: f64,
    step: &mut dyn FnMut(usize) -> Result<(), StudyError>,
) -> Result<(Vec<f64>, Vec<[f64; 2]>), StudyError> {
    let [low, high] = STIFF;
    let mut last: [[Option<Equilibrium>; 3]; 2] = Default::default();
    let twists = both_ways(poses, gearbox, |done, phi, way| {
        step(done)?;
        let mut twists = [0.0; 3];
        let last = &mut last[usize::from(way < 0.0)];
        for ((twisted, share), last) in twists.iter_mut().zip([LOST, low, high]).zip(last) {
            *twisted = twist(statics, last, phi, way * share * working)
                .map_err(|source| of_scene(&gearbox.scene, source))?;
        }
        Ok(twists)
    })?;
    let stiff =
        |[_, low_at, high_at]: [f64; 3]| (high - low) * working.abs() / (high_at - low_at).abs();
    let of_pose = |[ahead, back]: [[f64; 3]; 2]| (ahead[0] + back[0], [stiff(ahead), stiff(back)]);
    Ok(twists.into_iter().map(of_pose).unzip())
}
