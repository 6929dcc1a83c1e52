//! Figures of a data sheet, each with its uncertainty.
//!
//! Statics balances contacts to rounding, so the sampling of poses is the remaining error. Each figure is evaluated over
//! all poses and over each of their parts, which sample the mesh at other places: the largest difference is its numerical
//! uncertainty. A figure of a run has the run's uncertainty. The effect of other contact laws is separate
//! ([`Band`](crate::band::Bands)).

use pinwheel_scene::bearings::BearingLaw;
use pinwheel_scene::{Scene, speed_profile};
use pinwheel_timeseries::figure::{Figure, FigureDef, definitions as defs};

use super::mesh::{Bearing, Largest, Pair, Pose, Stage};
use super::spread::{ARCMIN, Spread};
use crate::fourier::{resampled, resolves};

/// Share of the rated torque, to either side of 0, for lost motion.
pub(crate) const LOST: f64 = 0.03;
/// Number of orders of both meshes that the poses resolve, for a transmission error from the polynomial through them.
const ORDERS: i64 = 3;
/// Error of a figure due to balances: their angles are accurate to 2e-15 rad, forces to 1e-10.
pub(crate) const ROUNDING: f64 = 1e-9;

/// Results of statics at all poses.
pub(crate) struct Balances {
    /// Number of parts of the poses.
    pub(crate) parts: usize,
    /// Passages of ring and output pins in the period, if all pins of a kind are alike.
    pub(crate) meshes: Option<[usize; 2]>,
    /// True if cranks carry the discs, as in an RV gear.
    pub(crate) on_cranks: bool,
    /// True if loads are computed for a slow motion with friction.
    pub(crate) rubs: bool,
    /// Lost motion, arcmin.
    pub(crate) lost: Vec<f64>,
    /// Stiffness in either direction, N m/arcmin.
    pub(crate) stiffness: Vec<[f64; 2]>,
    /// Poses of one period under the rated load.
    pub(crate) loaded: Vec<Pose>,
    /// Poses of one period under nearly no load.
    pub(crate) unloaded: Vec<Pose>,
}

/// Returns the relative speed of the rings of an eccentric bearing, rad/s.
fn bearing_rate_rad_s(scene: &Scene) -> f64 {
    scene.eccentric_speed_rad_s().abs() * (1.0 + 1.0 / scene.gear.lobes() as f64)
}

/// Returns the power of the output at the rated speed and load, W.
fn rated_w(scene: &Scene) -> f64 {
    let turns = speed_profile::fastest_rad_s(&scene.drive) * scene.output_per_input();
    (scene.drive.output_torque_n_m * turns).abs()
}

/// Returns the basic rating life of the most loaded eccentric bearing if the scene has its dynamic rating; `carried`:
/// forces of each, N.
///
/// ISO 281: L10 = (C/P)^p million relative turns of the bearing's rings, P the mean of the force's p-th power; p is 10/3
/// for rollers and 3 for balls, which the exponent 3/2 of the bearing's law identifies.
fn life(carried: &[Vec<f64>], scene: &Scene) -> Option<Figure> {
    let bearing = scene.bearings.eccentric?;
    let by_rollers = || scene.roller_ratings_n().map(|[_, dynamic]| dynamic);
    let rating_n = bearing.dynamic_rating_n.or_else(by_rollers)?;
    let power = if bearing.exponent == Some(1.5) {
        3.0
    } else {
        10.0 / 3.0
    };
    let turns = bearing_rate_rad_s(scene);
    let hours = |forces: &Vec<f64>| {
        let mean = Spread::of(forces.iter().map(|force| force.powf(power))).mean;
        let millions = rating_n.powf(power) / mean;
        1e6 * millions * std::f64::consts::TAU / turns / 3600.0
    };
    let least = carried.iter().map(hours).fold(f64::INFINITY, f64::min);
    Some(balanced(&defs::BEARING_LIFE, least))
}

/// Returns the friction loss of all eccentric bearings at the rated speed and load.
fn bearing_loss(carried: &[Vec<f64>], scene: &Scene) -> Option<Figure> {
    let law = BearingLaw::of(scene).filter(|law| law.drag_m > 0.0)?;
    let rate = bearing_rate_rad_s(scene);
    let alike = scene.cranks.map_or(1, |cranks| cranks.count) as f64;
    let force = |forces: &Vec<f64>| alike * Spread::of(forces.iter().copied()).mean;
    let lost: f64 = (carried.iter().map(force))
        .map(|force| law.drag(force, rate).abs() * rate)
        .sum();
    Some(balanced(&defs::BEARING_LOSS, 100.0 * lost / rated_w(scene)))
}

/// Returns the friction loss of all sleeves on their pins at the rated speed and load, if they roll on the discs.
fn sleeve_loss<'a>(poses: impl Iterator<Item = &'a Pose>, scene: &Scene) -> Option<Figure> {
    let drag = scene.sleeve_drag()?;
    let lost = |pair: &Pair| drag[pair.sleeve.side()] * pair.force_n * pair.sliding_m_s;
    let mean = Spread::of(poses.map(|pose| pose.pairs.iter().map(lost).sum())).mean;
    Some(balanced(&defs::SLEEVE_LOSS, 100.0 * mean / rated_w(scene)))
}

/// Returns the loss of the seals at the rated speed; `None` without seals.
fn seal_loss(scene: &Scene) -> Option<Figure> {
    let (bearings, ratio) = (&scene.bearings, scene.ratio());
    let torques = [bearings.input_seal_n_m, bearings.output_seal_n_m];
    torques.iter().any(Option::is_some).then(|| {
        let [input, output] = torques.map(Option::unwrap_or_default);
        let lost = (input + output / ratio) * speed_profile::fastest_rad_s(&scene.drive).abs();
        defs::SEAL_LOSS.of(100.0 * lost / rated_w(scene), 0.0)
    })
}

/// Removes the values of lost motion if parts overlap, with the reason `preloaded`.
pub(crate) fn withhold_lost_motion(figures: &mut [Figure], preloaded: Option<&String>) {
    let lost =
        |figure: &&mut Figure| figure.is(&defs::LOST_MOTION) || figure.is(&defs::LOST_MOTION_RUN);
    if let Some(why) = preloaded {
        for figure in figures.iter_mut().filter(lost) {
            *figure = figure.clone().withheld(why.clone());
        }
    }
}

impl Balances {
    /// Returns the figures of the poses whose number has the remainder `of` after division by `every`.
    fn of_part(&self, every: usize, of: usize) -> Vec<Figure> {
        fn some<T>(list: &[T], every: usize, of: usize) -> impl Iterator<Item = &T> + Clone {
            list.iter().skip(of).step_by(every)
        }
        let lost = Spread::of(some(&self.lost, every, of).copied());
        let stiffness = Spread::of(some(&self.stiffness, every, of).flatten().copied());
        let loaded = some(&self.loaded, every, of);
        let poses = |of: &dyn Fn(&Pose) -> f64| Spread::of(loaded.clone().map(of));
        let each = |stage: Stage, of: fn(&Largest) -> f64| {
            poses(&|pose| of(&pose.largest[stage as usize]))
        };
        // Change of the mean number of touching pins by one pin at one disc in one pose.
        let quantum = loaded.clone().next().map_or(1.0, |pose| {
            1.0 / (loaded.clone().count() * pose.bearings.len()) as f64
        });
        let touching = |def: &FigureDef, stage| def.of(poses(&|p| p.touching(stage)).mean, quantum);
        let pressure = |def: &FigureDef, stage| {
            balanced(def, 1e-6 * each(stage, |largest| largest.pressure_pa).max)
        };
        let sliding = Stage::BOTH.map(|stage| each(stage, |of| of.pressure_sliding_w_m2).max);
        let [rated, unloaded] = [&self.loaded, &self.unloaded].map(|all| {
            let errors = some(all, every, of).map(|pose| ARCMIN * pose.error_rad);
            let mut errors: Vec<f64> = errors.collect();
            if let Some(meshes) = self
                .meshes
                .filter(|meshes| resolves(errors.len(), *meshes, ORDERS))
            {
                errors = resampled(errors, meshes);
            }
            let spread = Spread::of(errors);
            spread.max - spread.min
        });
        let largest = |def: &FigureDef, spread: Spread| over(def, spread.max, &spread);
        let [external, internal] = Stage::BOTH.map(|stage| each(stage, |of| of.force_n));
        let internal_force = match self.on_cranks {
            true => &defs::CRANK_FORCE,
            false => &defs::INTERNAL_FORCE,
        };
        let mut figures = vec![
            largest(&defs::LOST_MOTION, lost),
            over(&defs::STIFFNESS, stiffness.mean, &stiffness),
            balanced(&defs::ERROR_RATED, rated),
            balanced(&defs::ERROR_NO_LOAD, unloaded),
            largest(&defs::EXTERNAL_FORCE, external),
            largest(internal_force, internal),
            touching(&defs::EXTERNAL_TOUCHING, Stage::External),
            touching(&defs::INTERNAL_TOUCHING, Stage::Internal),
            pressure(&defs::EXTERNAL_PRESSURE, Stage::External),
            pressure(&defs::INTERNAL_PRESSURE, Stage::Internal),
            balanced(&defs::PRESSURE_SLIDING, 1e-6 * sliding[0].max(sliding[1])),
            largest(&defs::BEARING_FORCE, poses(&|pose| pose.bearing_n)),
        ];
        // A bearing on a crank has no pins.
        if self.on_cranks {
            let of_pins = [
                &defs::INTERNAL_TOUCHING,
                &defs::INTERNAL_PRESSURE,
                &defs::BEARING_FORCE,
            ];
            figures.retain(|figure| !of_pins.iter().any(|def| figure.is(def)));
        }
        figures
    }

    /// Returns the forces of each disc's bearing over some of the poses, N. With cranks all bearings count: in the next
    /// period each crank is at the place of its neighbour.
    pub(crate) fn carried(&self, scene: &Scene, every: usize, of: usize) -> Vec<Vec<f64>> {
        let poses = self.loaded.iter().skip(of).step_by(every);
        let Some(cranks) = scene.cranks else {
            let bearings = Bearing::all(&poses.collect::<Vec<_>>()).into_iter();
            return bearings.map(|one| one.forces_n().collect()).collect();
        };
        let mut all = vec![Vec::new(); scene.gear.wheels];
        for (number, pose) in poses.enumerate() {
            for pair in pose.of(Stage::Internal) {
                all[pair.wheel].push(pair.force_n);
            }
            // Bearings without a force count too.
            let length = (number + 1) * cranks.count;
            all.iter_mut().for_each(|forces| forces.resize(length, 0.0));
        }
        all
    }

    /// Returns life and losses of bearings, sleeves and seals under the rated load; empty for a gear at rest.
    pub(crate) fn of_bearings(&self, scene: &Scene) -> Vec<Figure> {
        if speed_profile::fastest_rad_s(&scene.drive) == 0.0 {
            return Vec::new();
        }
        let mut figures = parted(self.parts, |every, of| {
            let carried = self.carried(scene, every, of);
            let poses = self.loaded.iter().skip(of).step_by(every);
            let each = [
                life(&carried, scene),
                bearing_loss(&carried, scene),
                sleeve_loss(poses, scene),
            ];
            each.into_iter().flatten().collect()
        });
        figures.extend(seal_loss(scene));
        figures
    }

    /// Returns the figures of statics; without lost motion if parts overlap.
    pub(crate) fn figures(&self) -> Vec<Figure> {
        let mut figures = parted(self.parts, |every, of| self.of_part(every, of));
        withhold_lost_motion(&mut figures, self.preloaded().as_ref());
        self.withhold_forces(&mut figures);
        figures
    }

    /// Returns a message if parts overlap: the largest force without a load exceeds 3 % of the rated one. Nothing is lost
    /// then, and the twist between +3 and -3 % shows the stiffness.
    pub(crate) fn preloaded(&self) -> Option<String> {
        let largest = |poses: &[Pose], of: fn(&Largest) -> f64| {
            let both = poses.iter().flat_map(|pose| &pose.largest);
            both.map(of).fold(0.0, f64::max)
        };
        let [without, rated] =
            [&self.unloaded, &self.loaded].map(|p| largest(p, |largest| largest.force_n));
        let overlap_um = 1e6 * largest(&self.unloaded, |largest| largest.penetration_m);
        (without > LOST * rated)
            .then(|| format!("preloaded: parts overlap by {overlap_um:.2} um without load"))
    }
}

/// Returns the figure of a value from balances.
pub(crate) fn balanced(def: &FigureDef, value: f64) -> Figure {
    def.of(value, ROUNDING * value.abs())
}

/// Returns the mean or the largest value of a figure over the poses.
pub(super) fn over(def: &FigureDef, value: f64, spread: &Spread) -> Figure {
    balanced(def, value).over(spread, ROUNDING)
}

/// Returns the figures of all poses. Their uncertainty is the largest difference from any of the `parts`; for one part it is
/// unknown.
pub(crate) fn parted(parts: usize, of: impl Fn(usize, usize) -> Vec<Figure>) -> Vec<Figure> {
    let mut figures = of(1, 0);
    if parts == 1 {
        figures
            .iter_mut()
            .for_each(|figure| figure.uncertainty = None);
        return figures;
    }
    for part in 0..parts {
        for (figure, other) in figures.iter_mut().zip(of(parts, part)) {
            let moved = figure.value.zip(other.value).map(|(a, b)| (a - b).abs());
            figure.uncertainty = figure.uncertainty.zip(moved).map(|(u, moved)| u.max(moved));
            if let (Some(all), Some(some)) = (&mut figure.over_mesh, other.over_mesh) {
                let moved = |end: usize| (all.ends[end] - some.ends[end]).abs();
                all.uncertainty = [0, 1].map(|end| all.uncertainty[end].max(moved(end)));
            }
        }
    }
    figures
}
