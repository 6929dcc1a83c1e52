//! Friction in figures of balances: forces and driver torque while the input turns, and the loop of a load with the input
//! locked.

use pinwheel_gearbox::GearboxError;
use pinwheel_gearbox::statics::{Equilibrium, Statics, slow_efficiency};
use pinwheel_scene::speed_profile;
use pinwheel_timeseries::figure::{Figure, FigureDef, definitions as defs};

use super::figures::{Balances, LOST, over, parted};
use super::mesh::{Pose, Wanted};
use super::poses::Poses;
use super::solve::{NO_LOAD, both_ways};
use super::spread::{ARCMIN, Spread};
use crate::StudyError;
use crate::control::of_scene;

/// Figures that depend on forces under friction; without a balance with friction they have no value.
static OF_FORCES: [&FigureDef; 14] = [
    &defs::EXTERNAL_FORCE,
    &defs::INTERNAL_FORCE,
    &defs::CRANK_FORCE,
    &defs::BEARING_FORCE,
    &defs::EXTERNAL_PRESSURE,
    &defs::INTERNAL_PRESSURE,
    &defs::PRESSURE_SLIDING,
    &defs::PROJECTED_SLIDING,
    &defs::BEARING_LIFE,
    &defs::BEARING_LOSS,
    &defs::SLEEVE_LOSS,
    &defs::STATIC_SAFETY,
    &defs::PIN_BENDING,
    &defs::WALL_SHEAR,
];
/// Reason for a missing efficiency of slow motion.
const ALL_ROLL: &str = "all pins roll on the discs and none rubs on its own pin, so slow motion loses nothing; state \
                        bearings.sleeve_friction_coefficient, or pins that do not turn";
/// Reason for a missing width of the loop. Under a falling load friction may hold a disc that one crank carries nearly alone
/// anywhere in the clearance of its other bearings: its instant centre, through which all forces on the ring pass, is near that
/// crank.
const HISTORY: &str = "no balance of a rising and falling load was found at some input angle: parts stick there, such as a disc in its \
                       bearings' clearance, and where depends on earlier loads; a gear without clearance has a width";
/// Loads of the loop, as shares of the rated torque.
const WIDTHS: [(f64, &FigureDef); 2] = [
    (LOST, &defs::HYSTERESIS),
    (NO_LOAD, &defs::HYSTERESIS_NO_LOAD),
];

/// Least width below 0 that is no rounding, arcmin.
const SWUNG_ARCMIN: f64 = 1e-6;

impl Pose {
    /// Takes the loads with friction from the balance `at` without friction: the larger of both directions of the input, and
    /// pairs and bearings in the scene's direction.
    pub(super) fn rub(
        &mut self,
        statics: &mut Statics<'_>,
        wanted: Wanted<'_>,
        at: &Equilibrium,
        load: f64,
    ) {
        let mut turning = |way| {
            let balance = statics.turning(way, at, load).ok()?;
            let driver_n_m = statics.driver_torque(&balance, load);
            Some((Self::loaded(statics, wanted, &balance, load), driver_n_m))
        };
        let Some(((ahead, driver_n_m), (back, _))) = turning(1.0).zip(turning(-1.0)) else {
            return;
        };
        self.driver_n_m = Some(driver_n_m);
        for (own, other) in self
            .largest
            .iter_mut()
            .zip(ahead.largest.iter().zip(&back.largest))
        {
            *own = other.0.or_larger(other.1, own.touching);
        }
        self.bearing_n = ahead.bearing_n.max(back.bearing_n);
        (self.pairs, self.bearings) = (ahead.pairs, ahead.bearings);
    }
}

impl Balances {
    /// Returns the reason for missing forces: no balance with friction.
    pub(crate) fn locked(&self) -> Option<String> {
        let locks = |pose: &Pose| self.rubs && pose.driver_n_m.is_none();
        self.loaded
            .iter()
            .any(locks)
            .then(|| GearboxError::Sticks.to_string())
    }

    /// Removes the values of forces and of dependent figures, for a gear without a balance with friction.
    pub(crate) fn withhold_forces(&self, figures: &mut [Figure]) {
        let Some(why) = self.locked() else { return };
        for figure in figures {
            if OF_FORCES.iter().any(|def| figure.is(def)) {
                *figure = figure.clone().withheld(why.clone());
            }
        }
    }

    /// Returns the efficiency of slow motion; empty for a gear at rest or without friction.
    pub(crate) fn slow_efficiency(&self, statics: &Statics<'_>, working: f64) -> Vec<Figure> {
        let gearbox = statics.gearbox();
        if !gearbox.scene.rubs() || speed_profile::fastest_rad_s(&gearbox.scene.drive) == 0.0 {
            return Vec::new();
        }
        let all_roll = || (!self.rubs).then(|| ALL_ROLL.to_owned());
        if let Some(why) = self.locked().or_else(all_roll) {
            return vec![defs::EFFICIENCY_SLOW.of(None, None).withheld(why)];
        }
        parted(self.parts, |every, of| {
            let torques = self.loaded.iter().skip(of).step_by(every);
            let mean = Spread::of(torques.filter_map(|pose| pose.driver_n_m)).mean;
            let percent = 100.0 * slow_efficiency(gearbox, mean, working).max(0.0);
            vec![defs::EFFICIENCY_SLOW.of(percent, 0.0)]
        })
    }
}

/// Computes the widths of the loop of a load that rises and falls with the input locked, at these poses; empty for a gear
/// without friction.
///
/// # Errors
/// Gears without a balance.
pub fn hysteresis(
    statics: &mut Statics<'_>,
    poses: &Poses,
    working: f64,
) -> Result<Vec<Figure>, StudyError> {
    let gearbox = statics.gearbox();
    let of_scene = |source| of_scene(&gearbox.scene, source);
    let Some(mut rubs) = Statics::rubbing(gearbox).map_err(of_scene)? else {
        return Ok(Vec::new());
    };
    let mut last: [[Option<Equilibrium>; 2]; 2] = Default::default();
    let widths = both_ways(poses, gearbox, |_, phi, way| {
        let mut widths = [None; 2];
        let last = &mut last[usize::from(way < 0.0)];
        for ((width, (share, _)), last) in widths.iter_mut().zip(WIDTHS).zip(last) {
            let load = way * share * working;
            let at = statics.track(last, phi, load).map_err(of_scene)?;
            // Where parts stick there may be several balances, so each branch is solved again from the other one.
            let mut both = |from: [&Equilibrium; 2]| {
                let falls = rubs.loading(-1.0, from[0], load).ok()?;
                Some([falls, rubs.loading(1.0, from[1], load).ok()?])
            };
            *width = both([at; 2]).and_then(|[falls, rises]| {
                let again = both([&rises, &falls])?;
                let of = |[falls, rises]: &[Equilibrium; 2]| ARCMIN * (falls.output - rises.output);
                let width = of(&[falls, rises]);
                Some((width, (of(&again) - width).abs()))
            });
        }
        Ok(widths)
    })?;
    let of_load = |(k, (_, def)): (usize, (f64, &'static FigureDef))| {
        // Under a falling load the output is ahead. Otherwise a disc has moved to the other side of its play.
        let ahead = |(width, apart): &(f64, f64)| *width >= -*apart - SWUNG_ARCMIN;
        let widths = widths.iter().flatten().map(|widths| widths[k]);
        let widths = widths.map(|widths| widths.filter(ahead));
        let Some(widths) = widths.collect::<Option<Vec<_>>>() else {
            return vec![def.of(None, None).withheld(HISTORY.to_owned())];
        };
        let mut figures = parted(poses.parts, |every, of| {
            let some = widths.chunks(2).skip(of).step_by(every).flatten();
            let spread = Spread::of(some.map(|(width, _)| *width));
            vec![over(def, spread.max, &spread)]
        });
        let several = widths.iter().map(|(_, apart)| *apart).fold(0.0, f64::max);
        for figure in &mut figures {
            figure.uncertainty = figure.uncertainty.map(|own| own + several);
        }
        figures
    };
    Ok(WIDTHS.into_iter().enumerate().flat_map(of_load).collect())
}
