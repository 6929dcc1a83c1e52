//! How fast things happen in a gear: what steps have to follow.
//!
//! Wheels and output swing on their contacts. The most loaded sleeve of a stage carries about F = 4 T/(l z) (linear
//! springs, no clearance; l: lever, z: sleeves, T: load of a wheel), is pressed in by delta(F) under the scene's own law, and
//! has the tangent stiffness k = n F/delta there, n being the law's exponent. A quarter of all sleeves, weighted by their
//! levers, make the torsional stiffness k l^2 z/4. All wheels in phase and the output are then two masses on two springs:
//!
//! ```text
//! I_w theta'' = -A theta - B (theta - psi),    I_o psi'' = -w B (psi - theta)
//! ```
//! whose faster mode is in closed form. Impacts press deeper than the load does and are a little stiffer (by the cube root
//! of the depth's square root for a point contact), which is what the verification of a run is for.

use std::f64::consts::TAU;

use pinwheel_contact::{HertzStiffness, LineContact, NormalLaw};

use crate::load_course;
use crate::scene::Scene;

/// Least depth of contact that anything is measured by, as a share of the external sleeves' radius: what stands in for the
/// load of a gear without any. The paper's unloaded gear is then measured by 1.4 mN.
const LEAST_DEPTH: f64 = 1e-5;

/// Frequencies and rates of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frequencies {
    /// The fastest oscillation of wheels and output on their contacts, rad/s.
    pub contact_rad_s: f64,
    /// Sleeves passing a wheel, the faster of both kinds, rad/s.
    pub mesh_rad_s: f64,
    /// How fast friction stops a sleeve's slip under the load, 1/s; 0 without friction.
    pub friction_1_s: f64,
}

impl Frequencies {
    /// Those of a checked scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let (gear, mass) = (&scene.gear, &scene.mass);
        let wheels = gear.wheels as f64;
        let torque = load_course::largest(&scene.drive) / wheels;
        let lever = gear.eccentricity_m * gear.lobes() as f64;
        let radius = gear.internal_circle_radius_m;
        let least = least_depth(scene);
        let stage = |lever: f64, sleeves: usize, stiffness: f64| {
            let sleeves = sleeves as f64;
            let (exponent, stiffness) = exponent_and_stiffness(scene, stiffness);
            let force = 4.0 * torque / (lever * sleeves);
            let depth = (force / stiffness).powf(exponent.recip()).max(least);
            let tangent = exponent * stiffness * depth.powf(exponent - 1.0);
            0.25 * sleeves * tangent * lever * lever
        };
        let hertz = hertz(scene);
        let outer = stage(
            lever,
            gear.external_sleeves,
            hertz.of_radius(gear.external_sleeve_radius_m),
        );
        let inner = stage(
            radius,
            gear.internal_sleeves,
            hertz.of_hole(gear.internal_sleeve_radius_m, gear.hole_radius_m),
        );
        let carried = mass.internal_sleeve.mass_kg * radius * radius * gear.internal_sleeves as f64;
        let output = mass.output_shaft.moment_kg_m2 + carried;
        let wheel = mass.wheel.moment_kg_m2;
        let (a, b, c) = (
            (outer + inner) / wheel,
            wheels * inner / output,
            inner / wheel,
        );
        // Larger root of (a - x)(b - x) = c b.
        let square = 0.5 * (a + b + ((a - b) * (a - b) + 4.0 * c * b).sqrt());
        let turns = scene.drive.input_speed_rad_s.abs();
        let (zk, zi) = (gear.external_sleeves as f64, gear.internal_sleeves as f64);
        Self {
            contact_rad_s: square.sqrt(),
            mesh_rad_s: turns * zk * (zi / gear.lobes() as f64).max(1.0),
            friction_1_s: crate::auto::friction_rate(scene),
        }
    }

    /// Depth of the most loaded external sleeve under the scene's own law, as a share of what Hertz' stiffness gives,
    /// which adaptive methods weigh errors by ([`Gearbox::error_scales`](crate::Gearbox::error_scales)).
    #[must_use]
    pub fn depth_share(scene: &Scene) -> f64 {
        let gear = &scene.gear;
        let force = external_force(scene);
        let hertz = hertz(scene).of_radius(gear.external_sleeve_radius_m);
        let (exponent, stiffness) = exponent_and_stiffness(scene, hertz);
        let least = least_depth(scene);
        let depth =
            |stiffness: f64, exponent: f64| (force / stiffness).powf(exponent.recip()).max(least);
        depth(stiffness, exponent) / depth(hertz, 1.5)
    }

    /// Longest step that cannot pass over a contact unseen, s: a third of a touch at the contacts' frequency, and an
    /// eighth of the time from sleeve to sleeve.
    #[must_use]
    pub fn longest_step_s(&self) -> f64 {
        let mesh = TAU / 8.0 / self.mesh_rad_s.max(f64::MIN_POSITIVE);
        (1.0 / self.contact_rad_s).min(mesh)
    }
}

/// Largest static force of an external sleeve, N.
fn external_force(scene: &Scene) -> f64 {
    let gear = &scene.gear;
    let torque = load_course::largest(&scene.drive) / gear.wheels as f64;
    pinwheel_scene::scales::external_force(gear, torque)
}

/// Hertz' stiffness of a scene's material.
pub(crate) fn hertz(scene: &Scene) -> HertzStiffness {
    let contact = &scene.contact;
    HertzStiffness::new(
        contact.young_pa,
        contact.poisson,
        contact.stiffness_multiplier,
    )
}

/// The depth that stands in for no load, m.
pub(crate) fn least_depth(scene: &Scene) -> f64 {
    LEAST_DEPTH * scene.gear.external_sleeve_radius_m
}

/// n and K of the scene's law, F = K delta^n, where Hertz' stiffness is `hertz`.
fn exponent_and_stiffness(scene: &Scene, hertz: f64) -> (f64, f64) {
    let contact = &scene.contact;
    match contact.law.as_str() {
        "constant" | "adams-impact" => (1.5, contact.constant_stiffness_n_m15),
        "line-contact" => {
            let law = LineContact::new(
                contact.line_length_m,
                contact.stiffness_multiplier,
                contact.damping_n_s_m,
                contact.ramp_m,
            );
            (10.0 / 9.0, law.stiffness(hertz))
        }
        _ => (1.5, hertz),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Modes of the paper's gear are 1740, 1660 and 530 Hz, from the eigenvalues of its Jacobian at the load.
    #[test]
    fn the_papers_fastest_mode() {
        let found = Frequencies::of(&Scene::paper());
        let hertz = found.contact_rad_s / TAU;
        assert!((hertz / 1740.0 - 1.0).abs() < 0.3, "{hertz}");
        assert!((found.mesh_rad_s / (52.34 * 16.0) - 1.0).abs() < 1e-12);
        assert_eq!(found.friction_1_s, 0.0);
    }

    /// A hundred times the Hertzian stiffness, and a law whose stiffness is not Hertz'.
    #[test]
    fn the_law_decides() {
        let mut scene = Scene::paper();
        let soft = Frequencies::of(&scene).contact_rad_s;
        scene.contact.stiffness_multiplier = 1.0;
        // k grows with K^(2/3) at a given force.
        let stiff = Frequencies::of(&scene).contact_rad_s;
        assert!((stiff / soft - 100.0_f64.powf(1.0 / 3.0)).abs() < 1e-9);
        scene.contact.law = "line-contact".to_owned();
        assert!(Frequencies::of(&scene).contact_rad_s > 1.5 * stiff);
    }
}
