//! The characteristic sizes of a gear under its largest static load: forces, penetrations, frequencies.
//!
//! They set error scales, steps, samples and windows, so that a gear of millimetres and one of metres are treated
//! alike. Linear springs without clearance: with T the load on one wheel, the largest force of an external sleeve is
//! about 4 T/(e zs zk), of an internal one 4 T/(zi R_w); its penetration is (F/K)^(2/3) with K after Hertz, its
//! tangent stiffness 1.5 F/delta. Summed over the loaded half with the levers e zs and R_w, the tangent stiffnesses make
//! the torsional ones, 1.5 T/(delta/lever), of a wheel against the housing and against the output.

use pinwheel_contact::HertzStiffness;
use serde::Serialize;

use crate::load_course;
use crate::model::Scene;

/// See the module. SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Scales {
    /// Load torque on one wheel, N m: the largest of the run, at least what makes a penetration of a millionth
    /// of R.
    pub wheel_torque_n_m: f64,
    /// Largest static force of an external sleeve on a wheel, N.
    pub external_force_n: f64,
    /// Largest static force of an internal sleeve on a wheel, N.
    pub internal_force_n: f64,
    /// Penetration under the external force, m.
    pub penetration_m: f64,
    /// Twist of a wheel under its load, rad: the penetration over the lever e zs.
    pub twist_rad: f64,
    /// Tangent stiffness of an external contact under its largest force, N/m.
    pub contact_stiffness_n_m: f64,
    /// Angular frequency of a wheel against the housing alone, rad/s.
    pub wheel_rad_s: f64,
    /// Slowest and fastest mode of the wheels and the output together, rad/s.
    pub modes_rad_s: [f64; 2],
}

/// Share of R that is the least penetration: that of a gear without load.
const UNLOADED: f64 = 1e-6;

/// 4 T/(e zs zk): the largest force of an external sleeve on a wheel under the torque T, N.
#[must_use]
pub fn external_force(gear: &crate::Gear, wheel_torque_n_m: f64) -> f64 {
    4.0 * wheel_torque_n_m / (gear.lever_m() * gear.external_sleeves as f64)
}

/// 4 T/(zi R_w): the largest force of an internal sleeve on a wheel under the torque T, N.
#[must_use]
pub fn internal_force(gear: &crate::Gear, wheel_torque_n_m: f64) -> f64 {
    4.0 * wheel_torque_n_m / (gear.internal_sleeves as f64 * gear.internal_circle_radius_m)
}

/// How far a wheel turns freely to one side because of the backlash, rad: d sqrt(1 - m^2)/(e zs).
#[must_use]
pub fn free_play(gear: &crate::Gear) -> f64 {
    let m = gear.shortening;
    gear.backlash_m * (1.0 - m * m).sqrt() / gear.lever_m()
}

impl Scales {
    /// The scales of a scene whose values are in range.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let (gear, contact, mass) = (&scene.gear, &scene.contact, &scene.mass);
        let hertz = HertzStiffness::new(
            contact.young_pa,
            contact.poisson,
            contact.stiffness_multiplier,
        );
        let stiffness = hertz.of_radius(gear.external_sleeve_radius_m);
        let lever = gear.lever_m();
        let load = load_course::largest(&scene.drive) / gear.wheels as f64;
        let least = stiffness * (UNLOADED * gear.pitch_radius_m()).powf(1.5);
        let torque = load.max(least * lever * gear.external_sleeves as f64 / 4.0);
        let force = external_force(gear, torque);
        let penetration = (force / stiffness).powf(2.0 / 3.0);
        let twist = penetration / lever;
        // Torsional stiffness of the loaded half of the sleeves.
        let torsion = 1.5 * torque / twist;
        let inner_force = internal_force(gear, torque);
        // A hole that fits tightly is far stiffer; nothing moves faster than in one with the usual clearance of e.
        let clearance =
            (gear.hole_radius_m - gear.internal_sleeve_radius_m).max(gear.eccentricity_m);
        let hole = gear.internal_sleeve_radius_m + clearance;
        let inner = hertz.of_hole(gear.internal_sleeve_radius_m, hole);
        let inner_penetration = (inner_force / inner).powf(2.0 / 3.0);
        let coupling = 1.5 * torque / (inner_penetration / gear.internal_circle_radius_m);
        let wheel = mass.wheel.moment_kg_m2;
        Self {
            wheel_torque_n_m: torque,
            external_force_n: force,
            internal_force_n: inner_force,
            penetration_m: penetration,
            twist_rad: twist,
            contact_stiffness_n_m: 1.5 * force / penetration,
            wheel_rad_s: (torsion / wheel).sqrt(),
            modes_rad_s: modes(scene, torsion, coupling),
        }
    }

    /// Time after which free vibrations of the slowest mode are a thousandth, s: damping proportional to stiffness
    /// makes a mode decay at the rate omega^2 C/(2 k). `None` without damping.
    #[must_use]
    pub fn settling_s(&self, damping_n_s_m: f64) -> Option<f64> {
        let [slow, _] = self.modes_rad_s;
        let rate = 0.5 * slow * slow * damping_n_s_m / self.contact_stiffness_n_m;
        (rate > 0.0).then(|| 1000_f64.ln() / rate)
    }
}

/// All wheels alike against housing and output, with the output against them; and the wheels against each other, the
/// output at rest: frequencies of [[n I, 0], [0, J]] with [[n (k + c), -n c], [-n c, n c]], and of I with k + c.
fn modes(scene: &Scene, torsion: f64, coupling: f64) -> [f64; 2] {
    let (gear, mass) = (&scene.gear, &scene.mass);
    let wheels = gear.wheels as f64;
    let circle = gear.internal_circle_radius_m;
    let output = mass.output_shaft.moment_kg_m2
        + gear.internal_sleeves as f64 * mass.internal_sleeve.mass_kg * circle * circle;
    let wheel = mass.wheel.moment_kg_m2;
    let a = (torsion + coupling) / wheel;
    let d = wheels * coupling / output;
    let product = wheels * coupling * coupling / (wheel * output);
    let half = 0.5 * (a + d);
    let root = (0.25 * (a - d) * (a - d) + product).sqrt();
    let slow = (a * d - product) / (half + root);
    [slow.sqrt(), (half + root).max(a).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Modes of the paper's gear by an independent eigenvalue solution under its load: 530, 1660 and 1740 Hz.
    #[test]
    fn the_papers_modes() {
        let scales = Scales::of(&Scene::paper());
        let [slow, fast] = scales.modes_rad_s.map(|rate| rate / std::f64::consts::TAU);
        assert!((slow / 530.0 - 1.0).abs() < 0.3, "{slow}");
        assert!((fast / 1740.0 - 1.0).abs() < 0.3, "{fast}");
        let settled = scales.settling_s(8.0).unwrap();
        assert!((0.1..0.4).contains(&settled), "{settled}");
    }

    /// Lengths, masses, times and forces of a gear scaled together: every ratio stays.
    #[test]
    fn similar_gears_have_similar_scales() {
        for load in [22.0, 0.0] {
            let mut scene = Scene::paper();
            scene.drive.output_torque_n_m = load;
            let one = Scales::of(&scene);
            let (length, mass, time) = (0.1, 1e-4, 0.5);
            let gear = &mut scene.gear;
            gear.eccentricity_m *= length;
            gear.external_sleeve_radius_m *= length;
            gear.internal_sleeve_radius_m *= length;
            gear.internal_circle_radius_m *= length;
            gear.hole_radius_m *= length;
            let force = mass * length / (time * time);
            scene.mass.wheel.moment_kg_m2 *= mass * length * length;
            scene.mass.output_shaft.moment_kg_m2 *= mass * length * length;
            scene.mass.internal_sleeve.mass_kg *= mass;
            scene.drive.output_torque_n_m *= force * length;
            scene.contact.young_pa *= force / (length * length);
            let other = Scales::of(&scene);
            let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
            near(other.penetration_m, one.penetration_m * length);
            near(other.external_force_n, one.external_force_n * force);
            near(other.twist_rad, one.twist_rad);
            for k in 0..2 {
                near(other.modes_rad_s[k], one.modes_rad_s[k] / time);
            }
        }
    }
}
