//! Hysteresis loop: with the input locked, the load slowly rises to the rated torque, falls to its opposite, and returns.
//!
//! Regularised friction vanishes at low speeds, and a real load moves the output far more slowly than that. Therefore a gear
//! with friction has reduced masses on its loop, which may then be fast. With times multiplied by s, masses by s^2 and damping
//! by s, all motions equal those of the gear itself, except that friction acts in full. Two effects widen the loop in
//! proportion to the rate: damping, and mass near no load, where contacts are soft. Oscillations are damped, the load is slow
//! near 0, and the figures of loops at two rates are extrapolated to rest.
//!
//! Sleeves with friction on their pins stick and slip in steps too small for this method, and backlash is crossed late. The
//! loop is then the slow one, without full friction, and its width is computed by statics.

use std::f64::consts::TAU;

use pinwheel_engines::Native;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::statics;
use pinwheel_scene::bearings::BearingLaw;
use pinwheel_scene::{Bearings, LoadChange, Scales, Scene, Start, largest_hole_play, largest_play};
use pinwheel_timeseries::columns;
use serde::Serialize;

use crate::balances::figures::LOST;
use crate::balances::spread::ARCMIN;
use crate::control::compile;
use crate::{Control, StudyError, single};

/// Duration of a ramp from no load to the rated one, in periods of the slowest mode: slow enough for quasi-static motion.
const SLOW: f64 = 300.0;
/// Duration of a ramp of the faster loop of a gear with friction, in the same unit. The slower loop takes twice as long.
const SLOW_WITH_FRICTION: f64 = 84.0;
/// Share of the rated torque within which that load is slower, and the factor: the effect of mass falls.
const NEAR: f64 = 0.05;
const SLOWER: f64 = 8.0;
/// Factor on the damping of that gear. Below twice the damping, oscillations from the ramps' kinks persist.
const DAMPED: f64 = 4.0;
/// Factor on the change by extrapolation in its uncertainty: two loops do not show their order.
const SAFETY: f64 = 3.0;
/// Samples from no load to the rated one.
const SAMPLES: f64 = 200.0;
/// Rest between two ramps, as a share of a ramp.
const REST: f64 = 0.25;

/// Speed of the output on the loop of a gear with friction, rad/s: friction fades below 1 rad/s.
const SLIDES_RAD_S: f64 = 30.0;
/// Largest ramp of the contacts' friction, relative to the speed of the output at the eccentricity.
const RAMP: f64 = 1e-2;
/// Least mass (kg) and moment of inertia (kg m^2) of a scene, and its largest speed of impacts, m/s.
const LEAST: [f64; 2] = [1e-9, 1e-18];
const FASTEST_M_S: f64 = 1e3;

/// Hysteresis loop of a slow run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cycle {
    /// Mean of both branches at +3 % of the rated torque less that at -3 %, arcmin; `None` if the run diverged.
    pub lost_motion_arcmin: Option<f64>,
    /// Width of the loop at no load, arcmin; without friction 0, apart from oscillations and damping. `None` for sleeves with
    /// friction on their pins, and for a gear with friction and backlash.
    pub width_arcmin: Option<f64>,
    /// Uncertainty of the lost motion, arcmin: the run's verified error of forces, the sampling, three times the change by
    /// extrapolation, and half of the branches' distances at both torques.
    pub lost_motion_uncertainty_arcmin: Option<f64>,
    /// Uncertainty of the width, arcmin: the first three contributions to that of the lost motion; without
    /// friction also the width.
    pub width_uncertainty_arcmin: Option<f64>,
    /// Ending of the run.
    pub status: &'static str,
    /// Sample times, s.
    #[serde(skip)]
    pub time_s: Vec<f64>,
    /// Load, N m, positive in the direction of the output's motion.
    #[serde(skip)]
    pub torque_n_m: Vec<f64>,
    /// Output angle, arcmin; extrapolated to rest where friction acts.
    #[serde(skip)]
    pub angle_arcmin: Vec<f64>,
    /// First sample of the closed loop; before it the load rises for the first time.
    #[serde(skip)]
    pub closed_from: usize,
}

/// Runs the loop of a gear with that rated torque, N m.
///
/// # Errors
/// Cancelled; a gear that cannot be compiled.
pub fn cycle(gearbox: &Gearbox, rated: f64, control: &Control<'_>) -> Result<Cycle, StudyError> {
    let slow = statics::slow(gearbox.scene.clone().into_scene());
    let fades = slow.sleeve_drag().is_some_and(|drag| drag != [0.0; 2]);
    let gear = &slow.gear;
    let clearance = (slow.bearings.eccentric.as_ref()).and_then(|bearing| bearing.clearance_m);
    let play = largest_play(gear) + largest_hole_play(gear) + clearance.unwrap_or(0.0);
    // Backlash below this is rounding.
    if !slow.rubs() || fades || play >= 1e-12 {
        let mut own = looped(gearbox, rated, SLOW, None, control)?;
        // Where nothing rubs, the run's rate alone opens the loop.
        let off = own.width_uncertainty_arcmin.zip(own.width_arcmin);
        own.width_uncertainty_arcmin = off.map(|(off, width)| off + width);
        if slow.rubs() {
            (own.width_arcmin, own.width_uncertainty_arcmin) = (None, None);
        }
        return Ok(own);
    }
    let rub = Some(&slow.bearings);
    let at = |periods: f64| looped(gearbox, rated, periods, rub, control);
    let faster = at(SLOW_WITH_FRICTION)?;
    let mut own = at(2.0 * SLOW_WITH_FRICTION)?;
    let angles = own.angle_arcmin.iter_mut().zip(&faster.angle_arcmin);
    angles.for_each(|(own, faster)| *own += *own - faster);
    let lost = &mut own.lost_motion_uncertainty_arcmin;
    let width = &mut own.width_uncertainty_arcmin;
    for (value, off, faster) in [
        (&mut own.lost_motion_arcmin, lost, faster.lost_motion_arcmin),
        (&mut own.width_arcmin, width, faster.width_arcmin),
    ] {
        let change = value.zip(faster).map(|(own, faster)| own - faster);
        *value = value
            .zip(change)
            .map(|(own, change)| (own + change).max(0.0));
        *off = off
            .zip(change)
            .map(|(off, change)| off + SAFETY * change.abs());
    }
    Ok(own)
}

/// Runs the loop with ramps of so many periods of the slowest mode. `rub` has the bearings of a gear with friction.
fn looped(
    gearbox: &Gearbox,
    rated: f64,
    periods: f64,
    rub: Option<&Bearings>,
    control: &Control<'_>,
) -> Result<Cycle, StudyError> {
    let mut scene = Scene::clone(&gearbox.scene);
    let ramp_s = |scene: &Scene| periods * TAU / Scales::of(scene).modes_rad_s[0];
    if let Some(bearings) = rub {
        // Pins that roll freely have no friction, and with reduced masses they would require the smallest steps.
        scene.bearings = *bearings;
        let rate = gearbox.error_scales().angle / ramp_s(&scene);
        hasten(&mut scene, f64::min(rate / SLIDES_RAD_S, 1.0));
    }
    let ramp = ramp_s(&scene);
    scene.drive.input_speed_rad_s = 0.0;
    scene.drive.speed_changes.clear();
    scene.drive.output_torque_n_m = 0.0;
    scene.drive.load_ramp_s = 0.0;
    scene.drive.load_changes.clear();
    scene.drive.start = Start::Kinematic;
    // Units: ramps, and shares of the rated torque.
    let (mut now, mut load) = (0.0_f64, 0.0_f64);
    let [mut first, mut down, mut up] = [[0.0_f64; 2]; 3];
    for (end, span) in [(1.0_f64, &mut first), (-1.0, &mut down), (1.0, &mut up)] {
        now += REST;
        span[0] = now;
        let corners = [-NEAR * end, NEAR * end, end];
        for to in corners.into_iter().skip(if rub.is_some() { 0 } else { 2 }) {
            let ahead = end * (to - load);
            if ahead <= 0.0 {
                continue;
            }
            let is_near = rub.is_some() && (load + to).abs() < 2.0 * NEAR;
            let ramps = ahead * if is_near { SLOWER } else { 1.0 };
            scene.drive.load_changes.push(LoadChange {
                time_s: now * ramp,
                output_torque_n_m: to * rated,
                ramp_s: ramps * ramp,
            });
            (now, load) = (now + ramps, to);
        }
        span[1] = now;
    }
    scene.solver.duration_s = (now + REST) * ramp;
    scene.solver.sample_s = scene.solver.duration_s / (6.0 * SAMPLES);
    scene.solver.step_s = scene.solver.step_s.min(scene.solver.sample_s);
    scene.solver.integrator = "auto".to_owned();
    scene.output.channels.clear();
    let slow = compile(&scene)?;
    let study = single::run(&slow, &Native::REDUCED, false, control)?;
    let time_series = &study.run.time_series;
    let time_s = time_series.time_s().to_vec();
    let angle = time_series.channel(columns::OUTPUT_ANGLE);
    let angle = angle.unwrap_or_default();
    let torque_n_m: Vec<f64> = time_s.iter().map(|&t| slow.load_torque(t)).collect();
    let angle_arcmin: Vec<f64> = angle.iter().map(|angle| ARCMIN * angle).collect();
    let from = |t: f64| time_s.partition_point(|&at| at < t);
    // Branches of decreasing and of increasing load.
    let [down, up] = [down, up].map(|[start, end]| from(start * ramp)..from(end * ramp) + 1);
    let finished = study.run.ending.is_finished();
    // Angles of both branches at a torque, with every `every`-th sample.
    let both = |torque: f64, every: usize| {
        let at = |branch: &std::ops::Range<usize>| {
            let branch = branch.start.min(angle_arcmin.len())..branch.end.min(angle_arcmin.len());
            let thinned = |values: &[f64]| -> Vec<f64> {
                let values = values[branch.clone()].iter();
                values.step_by(every).copied().collect()
            };
            crossing(&thinned(&torque_n_m), &thinned(&angle_arcmin), torque)
        };
        Some((at(&down)?, at(&up)?)).filter(|_| finished)
    };
    let lost = |every: usize| {
        let mean = |torque: f64| both(torque, every).map(|(a, b)| 0.5 * (a + b));
        Some((mean(LOST * rated)? - mean(-LOST * rated)?).abs())
    };
    let apart = |torque: f64, every: usize| both(torque, every).map(|(a, b)| (a - b).abs());
    let width = |every: usize| apart(0.0, every);
    // Friction that yields slowly leaves the angle at rest anywhere between the branches.
    let open = || Some(0.5 * (apart(LOST * rated, 1)? + apart(-LOST * rated, 1)?));
    let error = study.run.uncertainty.as_ref().and_then(|u| u.error);
    let off = |of: &dyn Fn(usize) -> Option<f64>| {
        let value = of(1)?;
        Some((value - of(2)?).abs() + error?.forces * value)
    };
    Ok(Cycle {
        lost_motion_arcmin: lost(1),
        width_arcmin: width(1),
        lost_motion_uncertainty_arcmin: off(&lost).and_then(|off| Some(off + open()?)),
        width_uncertainty_arcmin: off(&width),
        status: study.run.ending.word(),
        closed_from: down.start,
        time_s,
        torque_n_m,
        angle_arcmin,
    })
}

/// Multiplies the times of a scene's motions by `s`, and increases its damping.
fn hasten(scene: &mut Scene, s: f64) {
    let (mass, contact) = (&mut scene.mass, &mut scene.contact);
    for body in [
        &mut mass.input_shaft,
        &mut mass.output_shaft,
        &mut mass.wheel,
        &mut mass.internal_sleeve,
        &mut mass.external_sleeve,
    ] {
        body.mass_kg = (s * s * body.mass_kg).max(LEAST[0]);
        body.moment_kg_m2 = (s * s * body.moment_kg_m2).max(LEAST[1]);
    }
    contact.damping_n_s_m *= DAMPED * s;
    contact.impact_speed_m_s = (contact.impact_speed_m_s / s).min(FASTEST_M_S);
    let ramp = RAMP * SLIDES_RAD_S * scene.gear.eccentricity_m;
    contact.friction_ramp_m_s = contact.friction_ramp_m_s.min(ramp);
    if let Some(bearing) = &mut scene.bearings.eccentric {
        bearing.damping_n_s_m = bearing.damping_n_s_m.map(|damping| s * damping);
    }
    let law = BearingLaw::of(scene);
    if let Some((bearing, law)) = scene.bearings.eccentric.as_mut().zip(law) {
        bearing.damping_n_s_m = Some(DAMPED * law.damping_n_s_m);
    }
}

/// Returns the angle at which a monotone course of the torque passes `torque`.
fn crossing(torques: &[f64], angles: &[f64], torque: f64) -> Option<f64> {
    let k = torques
        .windows(2)
        .position(|pair| (pair[0] - torque) * (pair[1] - torque) <= 0.0 && pair[0] != pair[1])?;
    let share = (torque - torques[k]) / (torques[k + 1] - torques[k]);
    Some(angles[k] + share * (angles[k + 1] - angles[k]))
}
