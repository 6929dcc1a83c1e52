//! The figures that a data sheet gives, each with how far it may be off.
//!
//! Statics balances contacts to rounding; what is left is that poses are sampled. Every figure is read off all poses and off
//! each part of them, which meet the mesh at other places: the largest change is its numerical uncertainty. A figure of a
//! run is as uncertain as the run says. What other contact laws would give is apart ([`Band`](crate::band::Bands)).

use pinwheel_scene::bearings::BearingLaw;
use pinwheel_scene::{Scene, Sleeve};
use serde::Serialize;

use super::mesh::{Bearing, Pair, Pose, Pressure, Sharing, Stage};
use super::spread::{ARCMIN, Spread};

/// Shares of the rated torque between which lost motion is counted.
pub(crate) const LOST: f64 = 0.03;
/// Error of a figure due to balances: their angles are accurate to 2e-15 rad, forces to 1e-10.
const ROUNDING: f64 = 1e-9;

/// Definition of a figure, once for the table, the page, files and the comparison of two designs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Definition {
    key: &'static str,
    what: &'static str,
    unit: &'static str,
    how: &'static str,
}

/// Definitions: key, what it is, unit, how it is counted.
macro_rules! definitions {
    ($($name:ident = $key:literal, $what:literal, $unit:literal, $how:literal;)*) => {
        $(pub(crate) const $name: Definition =
            Definition { key: $key, what: $what, unit: $unit, how: $how };)*
    };
}

definitions! {
    LOST_MOTION = "lost_motion_arcmin", "lost motion", "arcmin",
        "largest over the mesh, between +3 and -3 % of the rated torque";
    STIFFNESS = "torsional_stiffness_n_m_per_arcmin", "torsional stiffness", "N m/arcmin",
        "between 50 and 100 % of the rated torque, mean";
    ERROR_RATED = "transmission_error_rated_arcmin", "transmission error, rated load", "arcmin",
        "peak to peak";
    ERROR_NO_LOAD = "transmission_error_no_load_arcmin", "transmission error, no load", "arcmin",
        "peak to peak, at a ten-thousandth of the load";
    EXTERNAL_FORCE = "external_force_n", "largest pin force, external", "N",
        "largest of a pose";
    INTERNAL_FORCE = "internal_force_n", "largest pin force, internal", "N",
        "largest of a pose";
    CRANK_FORCE = "crank_bearing_force_n", "crank bearing, largest force", "N",
        "largest of a pose, of all discs and cranks";
    EXTERNAL_TOUCHING = "external_touching", "ring pins that carry", "",
        "touch a disc, on average";
    INTERNAL_TOUCHING = "internal_touching", "output pins that carry", "",
        "touch a disc, on average";
    EXTERNAL_PRESSURE = "external_pressure_mpa", "largest pressure, external", "MPa",
        "line contact over the face width, edges left out";
    INTERNAL_PRESSURE = "internal_pressure_mpa", "largest pressure, internal", "MPa",
        "likewise";
    PRESSURE_SLIDING = "pressure_sliding_mpa_m_s", "largest pressure times sliding", "MPa m/s",
        "on pins that do not turn";
    BEARING_FORCE = "eccentric_bearing_force_n", "eccentric bearing, largest force", "N",
        "largest of a pose, of all discs";

    BEARING_LIFE = "eccentric_bearing_life_h", "eccentric bearing, basic rating life", "h",
        "L10h after ISO 281 of the most loaded disc, rated speed and load throughout";

    BEARING_LOSS = "eccentric_bearing_loss_percent", "eccentric bearings, friction loss", "%",
        "mu F d/2 against their turning, of the rated output power";

    SLEEVE_LOSS = "sleeve_loss_percent", "sleeves on their pins, friction loss", "%",
        "mu F d/2 against their turning as they roll, of the rated output power";
    SEAL_LOSS = "seal_loss_percent", "seals, friction loss", "%",
        "their torques at rated speed, of the rated output power";

    LOST_MOTION_RUN = "lost_motion_run_arcmin", "lost motion by a run", "arcmin",
        "of a slow loop of the load, the mean of both branches";
    LOOP_WIDTH = "hysteresis_width_arcmin", "width of the loop at no load", "arcmin",
        "what friction holds back, and what swings";
    EFFICIENCY = "efficiency_rated_percent", "efficiency, rated", "%",
        "by what a run loses";

    JOINT_BACKLASH = "joint_backlash_arcmin", "free play", "arcmin",
        "between both directions at a ten-thousandth of the rated torque, mean; without play what the first contacts give way";
    JOINT_STIFFNESS = "joint_stiffness_n_m_per_rad", "torsional stiffness", "N m/rad",
        "of the mean twist, between 50 and 100 % of the rated torque";
    JOINT_DEAD_BAND = "joint_dead_band_arcmin", "dead band of that stiffness alone", "arcmin",
        "for a model of one spring; above the free play, as the first pins give way more";
    JOINT_DAMPING = "joint_damping_n_m_s_per_rad", "damping beside the stiffness", "N m s/rad",
        "of the contacts about the rated load";
    JOINT_FRICTION = "joint_friction_n_m", "friction, constant", "N m",
        "at the output, fitted to what runs lose";
    JOINT_FRICTION_OF_LOAD = "joint_friction_of_load_n_m", "friction, of the rated load", "N m",
        "likewise; in proportion to the load";
    JOINT_VISCOUS = "joint_viscous_n_m_s_per_rad", "friction, viscous", "N m s/rad",
        "likewise; in proportion to the output's speed";
    JOINT_INPUT_INERTIA = "joint_input_inertia_kg_m2", "inertia at the input", "kg m^2",
        "input shaft, and the discs' masses on its eccentrics";
    JOINT_OUTPUT_INERTIA = "joint_output_inertia_kg_m2", "inertia at the output", "kg m^2",
        "output with its pins, and the discs, which turn with it";
    JOINT_REFLECTED_INERTIA = "joint_reflected_inertia_kg_m2", "both, seen from the output", "kg m^2",
        "the input's times the ratio squared, and the output's";
}

/// One figure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DesignFigure {
    /// Its name for programs, with the unit.
    pub key: &'static str,
    /// Meaning of the figure.
    #[serde(skip)]
    pub what: &'static str,
    /// Its unit; empty for counts.
    pub unit: &'static str,
    /// `None` where it does not exist: no work passes, or the run diverged.
    pub value: Option<f64>,
    /// How far it may be off numerically; `None` where that is not known.
    #[serde(rename = "numerical_uncertainty")]
    pub uncertainty: Option<f64>,
    /// Least and largest over the mesh, of what is one figure a pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over_the_mesh: Option<[f64; 2]>,
    /// Numerical uncertainty of the least and of the largest value.
    #[serde(
        rename = "over_the_mesh_numerical_uncertainty",
        skip_serializing_if = "Option::is_none"
    )]
    pub mesh_uncertainty: Option<[f64; 2]>,
    /// Its mean over the mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_over_the_mesh: Option<f64>,
    /// Least and largest by the contact laws that may be right for these materials; `None` where none was compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_contact_law: Option<[f64; 2]>,
    /// How it is counted.
    pub how: &'static str,
}

/// Results of statics at all poses, before they are summed up.
pub(crate) struct Balances {
    /// Parts that the poses are made of.
    pub(crate) parts: usize,
    /// Cranks carry the discs, as in an RV gear.
    pub(crate) on_cranks: bool,
    /// Lost motion, arcmin.
    pub(crate) lost: Vec<f64>,
    /// Stiffness in either direction, N m/arcmin.
    pub(crate) stiffness: Vec<[f64; 2]>,
    /// Poses of one period under the rated load.
    pub(crate) loaded: Vec<Pose>,
    /// And under next to none.
    pub(crate) unloaded: Vec<Pose>,
}

/// Sums of the figures of all poses.
pub(crate) struct Summed {
    on_cranks: bool,
    pub(crate) lost: Spread,
    pub(crate) stiffness: Spread,
    pub(crate) sharing: [Sharing; 2],
    pub(crate) pressure: [Pressure; 2],
    pub(crate) bearings: Vec<Bearing>,
    /// Force of a pose on the bearing that carries most in it, N.
    bearing_force: Spread,
    /// Peak to peak of the transmission error, rated and unloaded, arcmin.
    pub(crate) error: [f64; 2],
    /// Change of the mean number of touching pins by one pin at one disc in one pose.
    quantum: f64,
}

/// How fast the rings of an eccentric bearing turn against each other, rad/s.
fn bearing_rate_rad_s(scene: &Scene) -> f64 {
    scene.eccentric_speed_rad_s().abs() * (1.0 + 1.0 / scene.gear.lobes() as f64)
}

/// Power of the output at the rated speed and load, W.
fn rated_w(scene: &Scene) -> f64 {
    let turns = scene.drive.input_speed_rad_s * scene.output_per_input();
    (scene.drive.output_torque_n_m * turns).abs()
}

/// Loss of the seals at the rated speed; `None` without seals.
pub(crate) fn seal_loss(scene: &Scene) -> Option<DesignFigure> {
    let (bearings, ratio) = (&scene.bearings, scene.ratio());
    let torques = [bearings.input_seal_n_m, bearings.output_seal_n_m];
    torques.iter().any(Option::is_some).then(|| {
        let [input, output] = torques.map(Option::unwrap_or_default);
        let lost = (input + output / ratio) * scene.drive.input_speed_rad_s.abs();
        SEAL_LOSS.is(100.0 * lost / rated_w(scene), 0.0)
    })
}

impl Balances {
    /// Evaluation over the poses whose number leaves `of` when divided by `every`.
    pub(crate) fn summed(&self, every: usize, of: usize) -> Summed {
        fn some<T>(list: &[T], every: usize, of: usize) -> Vec<&T> {
            list.iter().skip(of).step_by(every).collect()
        }
        let lost = some(&self.lost, every, of).into_iter();
        let stiffness = some(&self.stiffness, every, of).into_iter();
        let loaded = some(&self.loaded, every, of);
        let error = [&self.loaded, &self.unloaded].map(|poses| {
            let errors = some(poses, every, of);
            let spread = Spread::of(errors.iter().map(|pose| ARCMIN * pose.error_rad));
            spread.max - spread.min
        });
        Summed {
            on_cranks: self.on_cranks,
            lost: Spread::of(lost.copied()),
            stiffness: Spread::of(stiffness.flatten().copied()),
            sharing: Stage::BOTH.map(|stage| Sharing::of(&loaded, stage)),
            pressure: Stage::BOTH.map(|stage| Pressure::of(&loaded, stage)),
            quantum: loaded.first().map_or(1.0, |pose| {
                1.0 / (loaded.len() * pose.bearings.len()) as f64
            }),
            bearing_force: Spread::of(loaded.iter().map(|pose| pose.largest_bearing_n())),
            bearings: Bearing::all(&loaded),
            error,
        }
    }

    /// Forces of each disc's bearing over some of the poses, N. On cranks those of all: in the next period each crank
    /// stands where its neighbour does in this one.
    fn carried(&self, scene: &Scene, every: usize, of: usize) -> Vec<Vec<f64>> {
        let Some(cranks) = scene.cranks else {
            let bearings = self.summed(every, of).bearings;
            return bearings
                .iter()
                .map(|bearing| bearing.forces_n().collect())
                .collect();
        };
        let poses = self.loaded.iter().skip(of).step_by(every);
        let mut all = vec![Vec::new(); scene.gear.wheels];
        for (number, pose) in poses.enumerate() {
            for pair in pose.of(Stage::Internal) {
                all[pair.wheel].push(pair.force_n);
            }
            // Bearings that carry nothing count too.
            let whole = (number + 1) * cranks.count;
            all.iter_mut().for_each(|forces| forces.resize(whole, 0.0));
        }
        all
    }

    /// Basic rating life of the most loaded eccentric bearing of the dynamic rating `rating_n`.
    ///
    /// ISO 281: L10 = (C/P)^p million turns of the bearing's rings against each other, P the mean of the force's p-th power; p is
    /// 10/3 of rollers and 3 of balls, which an exponent of 3/2 tells.
    pub(crate) fn life(&self, rating_n: f64, scene: &Scene) -> DesignFigure {
        let exponent = scene
            .bearings
            .eccentric
            .and_then(|bearing| bearing.exponent);
        let power = if exponent == Some(1.5) {
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
        let of = |every, of| {
            let bearings = self.carried(scene, every, of);
            let least = bearings.iter().map(hours).fold(f64::INFINITY, f64::min);
            vec![BEARING_LIFE.balanced(least)]
        };
        parted(self.parts, of).swap_remove(0)
    }

    /// Loss by the friction of all eccentric bearings at the rated speed and load.
    pub(crate) fn bearing_loss(&self, law: &BearingLaw, scene: &Scene) -> DesignFigure {
        let rate = bearing_rate_rad_s(scene);
        let alike = scene.cranks.map_or(1, |cranks| cranks.count) as f64;
        let percent = |bearings: &[Vec<f64>]| {
            let force = |forces: &Vec<f64>| alike * Spread::of(forces.iter().copied()).mean;
            let lost: f64 = (bearings.iter().map(force))
                .map(|force| law.drag(force, rate).abs() * rate)
                .sum();
            100.0 * lost / rated_w(scene)
        };
        let of = |every, of| vec![BEARING_LOSS.balanced(percent(&self.carried(scene, every, of)))];
        parted(self.parts, of).swap_remove(0)
    }

    /// Loss by the friction of all sleeves on their pins at the rated speed and load, if they roll on the discs.
    pub(crate) fn sleeve_loss(&self, scene: &Scene) -> Option<DesignFigure> {
        let (bearings, gear) = (&scene.bearings, &scene.gear);
        let external = bearings.sleeve_drag(gear.external_sleeve_radius_m)?;
        let internal = bearings.sleeve_drag(gear.internal_sleeve_radius_m)?;
        let lost = |pair: &Pair| {
            let drag = match pair.sleeve {
                Sleeve::External(_) => external,
                Sleeve::Internal(_) => internal,
            };
            drag * pair.force_n * pair.sliding_m_s
        };
        let of = |every: usize, of: usize| {
            let poses = self.loaded.iter().skip(of).step_by(every);
            let mean = Spread::of(poses.map(|pose| pose.pairs.iter().map(lost).sum())).mean;
            vec![SLEEVE_LOSS.balanced(100.0 * mean / rated_w(scene))]
        };
        Some(parted(self.parts, of).swap_remove(0))
    }

    /// The figures of statics.
    pub(crate) fn figures(&self) -> Vec<DesignFigure> {
        parted(self.parts, |every, of| self.summed(every, of).figures())
    }

    /// That parts press on each other without a load by more than the torque under which lost motion is found makes of it:
    /// then nothing is lost, and the twist between +3 and -3 % says how stiff the gear is.
    pub(crate) fn preloaded(&self) -> Option<String> {
        let largest = |poses: &[Pose], of: fn(&Pair) -> f64| {
            let pairs = poses.iter().flat_map(|pose| &pose.pairs);
            pairs.map(of).fold(0.0, f64::max)
        };
        let [without, rated] =
            [&self.unloaded, &self.loaded].map(|p| largest(p, |pair| pair.force_n));
        let overlap_um = 1e6 * largest(&self.unloaded, |pair| pair.penetration_m);
        (without > LOST * rated)
            .then(|| format!("preloaded: parts overlap by {overlap_um:.2} um without load"))
    }
}

impl Definition {
    /// The figure of a value that may be off by `uncertainty`.
    pub(crate) fn is(
        self,
        value: impl Into<Option<f64>>,
        uncertainty: impl Into<Option<f64>>,
    ) -> DesignFigure {
        let value = value.into().filter(|value| value.is_finite());
        DesignFigure {
            key: self.key,
            what: self.what,
            unit: self.unit,
            value,
            uncertainty: value.and(uncertainty.into()),
            over_the_mesh: None,
            mesh_uncertainty: None,
            mean_over_the_mesh: None,
            by_contact_law: None,
            how: self.how,
        }
    }

    /// The figure of a value that balances give.
    fn balanced(self, value: f64) -> DesignFigure {
        self.is(value, ROUNDING * value.abs())
    }
}

impl DesignFigure {
    /// True if the figure is one of lost motion.
    #[must_use]
    pub fn is_lost_motion(&self) -> bool {
        [LOST_MOTION.key, LOST_MOTION_RUN.key].contains(&self.key)
    }

    /// Without a value.
    pub(crate) fn withheld(self) -> Self {
        Self {
            value: None,
            uncertainty: None,
            over_the_mesh: None,
            mesh_uncertainty: None,
            mean_over_the_mesh: None,
            ..self
        }
    }

    /// With what it is over the mesh.
    pub(crate) fn over(self, spread: &Spread) -> Self {
        Self {
            over_the_mesh: Some([spread.min, spread.max]),
            mesh_uncertainty: Some([spread.min, spread.max].map(|end| ROUNDING * end.abs())),
            mean_over_the_mesh: Some(spread.mean),
            ..self
        }
    }
}

/// Figures of every so many poses from one on: those of all, as uncertain as those of any of so many parts differ from them.
pub(crate) fn parted(
    parts: usize,
    of: impl Fn(usize, usize) -> Vec<DesignFigure>,
) -> Vec<DesignFigure> {
    let mut figures = of(1, 0);
    for part in 0..parts {
        for (figure, other) in figures.iter_mut().zip(of(parts, part)) {
            let moved = figure.value.zip(other.value).map(|(a, b)| (a - b).abs());
            figure.uncertainty = figure.uncertainty.zip(moved).map(|(u, moved)| u.max(moved));
            let ends = figure.over_the_mesh.zip(other.over_the_mesh);
            if let (Some(off), Some((all, some))) = (&mut figure.mesh_uncertainty, ends) {
                *off = [0, 1].map(|end| off[end].max((all[end] - some[end]).abs()));
            }
        }
    }
    figures
}

impl Summed {
    pub(crate) fn figures(&self) -> Vec<DesignFigure> {
        let [external, internal] = &self.sharing;
        let [loaded, unloaded] = self.error;
        let pressed = |k: usize| 1e-6 * self.pressure[k].largest_pa;
        let slid = |k: usize| 1e-6 * self.pressure[k].pressure_sliding_w_m2;
        let largest = |what: Definition, spread: &Spread| what.balanced(spread.max).over(spread);
        let inner = match self.on_cranks {
            true => CRANK_FORCE,
            false => INTERNAL_FORCE,
        };
        let mut figures = vec![
            largest(LOST_MOTION, &self.lost),
            STIFFNESS
                .balanced(self.stiffness.mean)
                .over(&self.stiffness),
            ERROR_RATED.balanced(loaded),
            ERROR_NO_LOAD.balanced(unloaded),
            largest(EXTERNAL_FORCE, &external.largest_force_n),
            largest(inner, &internal.largest_force_n),
            EXTERNAL_TOUCHING.is(external.touching.mean, self.quantum),
            INTERNAL_TOUCHING.is(internal.touching.mean, self.quantum),
            EXTERNAL_PRESSURE.balanced(pressed(0)),
            INTERNAL_PRESSURE.balanced(pressed(1)),
            PRESSURE_SLIDING.balanced(slid(0).max(slid(1))),
        ];
        if self.on_cranks {
            // A bearing has no pins, and its force is told above.
            let of_pins = [INTERNAL_TOUCHING.key, INTERNAL_PRESSURE.key];
            figures.retain(|figure| !of_pins.contains(&figure.key));
            return figures;
        }
        figures.push(largest(BEARING_FORCE, &self.bearing_force));
        figures
    }
}
