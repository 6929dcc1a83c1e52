//! How fast things happen in a gear: what steps have to follow. The modes are those of the scene's
//! [`Scales`](pinwheel_scene::Scales).

use std::f64::consts::TAU;

use pinwheel_scene::bearings::{BearingLaw, typical_force};
use pinwheel_scene::scales::{Scales, Spring, external_force, hertz, internal_force, least_depth};

use crate::load_profile;
use crate::scene::{BodyMass, Scene};

/// Frequencies and rates of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frequencies {
    /// The fastest oscillation of discs and output on their contacts, and on bearings where discs float, rad/s.
    pub contact_rad_s: f64,
    /// Fastest oscillation of discs and output on their contacts alone, rad/s. Contacts come and go with it.
    pub touch_rad_s: f64,
    /// Pins passing a disc, the faster of both kinds, rad/s.
    pub mesh_rad_s: f64,
    /// How fast friction stops a pin's slip under the load, 1/s; 0 without friction.
    pub friction_1_s: f64,
}

impl Frequencies {
    /// Frequencies of a checked scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let gear = &scene.gear;
        let scales = Scales::of(scene);
        let [_, rigid] = scales.modes_rad_s;
        // A floating disc on the loaded quarter of its contacts, and on its bearing as well.
        let floating = BearingLaw::of(scene).map_or([0.0; 2], |bearing| {
            let sleeves = 0.25 * (gear.external_sleeves + gear.internal_sleeves) as f64;
            let bearings = scene.cranks.map_or(1, |cranks| cranks.count) as f64;
            let contacts = sleeves * scales.contact_stiffness_n_m;
            let all = contacts + bearings * bearing.slope_under(typical_force(scene));
            [contacts, all].map(|stiffness| (stiffness / scene.mass.wheel.mass_kg).sqrt())
        });
        let [touch_rad_s, contact_rad_s] = floating.map(|of| f64::max(rigid, of));
        let turns = scene.eccentric_speed_rad_s().abs();
        let (zk, zi) = (gear.external_sleeves as f64, gear.internal_sleeves as f64);
        Self {
            contact_rad_s,
            touch_rad_s,
            mesh_rad_s: turns * zk * (zi / gear.lobes() as f64).max(1.0),
            friction_1_s: friction_rate(scene),
        }
    }

    /// Depth of the most loaded ring pin under the scene's own law, as a share of what Hertz' stiffness gives,
    /// which adaptive methods weigh errors by ([`Gearbox::error_scales`](crate::Gearbox::error_scales)).
    #[must_use]
    pub fn depth_share(scene: &Scene) -> f64 {
        let gear = &scene.gear;
        let force = external_force(
            gear,
            load_profile::largest(&scene.drive) / gear.wheels as f64,
        );
        let stiffness = hertz(scene).on_flat(gear.external_sleeve_radius_m);
        let least = least_depth(scene);
        let plain = (force / stiffness).powf(2.0 / 3.0).max(least);
        Spring::of(scene, stiffness).depth(force, least) / plain
    }

    /// Longest step that cannot pass over a contact unnoticed, s: a third of a touch at the contacts' frequency, and an
    /// eighth of the time from pin to pin.
    #[must_use]
    pub fn longest_step_s(&self) -> f64 {
        let mesh = TAU / 8.0 / self.mesh_rad_s.max(f64::MIN_POSITIVE);
        (1.0 / self.touch_rad_s).min(mesh)
    }
}

/// Longest step that follows a relaxation explicitly, in its time under the static force: half of where methods of order two are
/// stable on the real axis (Hairer and Wanner, Solving Ordinary Differential Equations II, 1996, ch. IV.2), as the force may be
/// up to twice as large. At 2.8 one of a hundred gears had a driver's torque 14 % off with a u of 0.03 %.
const FOLLOWED: f64 = 1.0;

/// Factor by which explicit steps must be shorter to follow the friction of a scene; `None` if they do. Longer ones chatter from
/// side to side of its ramp: two steps may do that alike, and then agree on a wrong force.
#[must_use]
pub fn unfollowed(scene: &Scene, step_s: f64) -> Option<f64> {
    let shorter = step_s * friction_rate(scene) / FOLLOWED;
    (shorter > 1.0).then_some(shorter)
}

/// Rate mu F q^2/(v_s J) of the faster kind of pin under the largest static force
/// (4 T/(e zs zk) a disc, and 4 T/(zi R_w)), 1/s: how fast friction relaxes a spin.
#[must_use]
pub fn friction_rate(scene: &Scene) -> f64 {
    let (gear, contact, mass) = (&scene.gear, &scene.contact, &scene.mass);
    let torque = load_profile::largest(&scene.drive) / gear.wheels as f64;
    let external = external_force(gear, torque);
    let internal = internal_force(gear, torque);
    let rate = |force: f64, radius: f64, body: BodyMass| {
        contact.friction_coefficient * force * radius * radius
            / (contact.friction_ramp_m_s * body.moment_kg_m2)
    };
    rate(
        external,
        gear.external_sleeve_radius_m,
        mass.external_sleeve,
    )
    .max(rate(
        internal,
        gear.internal_sleeve_radius_m,
        mass.internal_sleeve,
    ))
}

#[cfg(test)]
mod tests {
    use pinwheel_scene::scales;

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

    /// A third of a touch at the contacts' frequency, or an eighth of the time from pin to pin, of whichever kind passes more
    /// often.
    #[test]
    fn steps_see_every_sleeve() {
        let mut scene = Scene::paper();
        let found = Frequencies::of(&scene);
        assert_eq!(found.longest_step_s(), 1.0 / found.contact_rad_s);
        scene.drive.input_speed_rad_s *= -100.0;
        scene.gear.internal_sleeves = 30;
        let fast = Frequencies::of(&scene);
        assert!((fast.mesh_rad_s / (5234.0 * 16.0 * 2.0) - 1.0).abs() < 1e-12);
        assert!((fast.longest_step_s() * fast.mesh_rad_s * 8.0 / TAU - 1.0).abs() < 1e-12);
        scene.drive.input_speed_rad_s = 0.0;
        assert_eq!(
            Frequencies::of(&scene).longest_step_s(),
            1.0 / fast.contact_rad_s
        );
    }

    /// Each disc carries its part of the load, which decides where a law is not of Hertz' power.
    #[test]
    fn depths_are_those_of_one_wheel() {
        let share = |wheels: usize, load: f64| {
            let mut scene = Scene::paper();
            scene.contact.law = "line-contact".to_owned();
            (scene.gear.wheels, scene.drive.output_torque_n_m) = (wheels, load);
            Frequencies::depth_share(&scene)
        };
        assert_eq!(share(2, 44.0), share(1, 22.0));
        assert!((share(2, 22.0) / share(1, 22.0) - 1.0).abs() > 0.1);
        let hertz = Frequencies::depth_share(&Scene::paper());
        assert!((hertz - 1.0).abs() < 1e-12, "{hertz}");
    }

    /// By hand: 6.5e5 1/s for a pin of the paper at 100 N; the static 65 N give two thirds of it.
    #[test]
    fn friction_rate_of_the_paper() {
        let mut scene = Scene::paper();
        scene.contact.friction_coefficient = 0.1;
        let rate = friction_rate(&scene);
        assert!((rate / 6.5e5 - 1.0).abs() < 0.5, "{rate}");
        // Pins that weigh next to nothing set it, whichever they are.
        for kind in [true, false] {
            let mut scene = scene.clone();
            let (gear, mass) = (&scene.gear, &mut scene.mass);
            let (body, radius, force) = if kind {
                let force = scales::external_force(gear, 11.0);
                (
                    &mut mass.external_sleeve,
                    gear.external_sleeve_radius_m,
                    force,
                )
            } else {
                let force = scales::internal_force(gear, 11.0);
                (
                    &mut mass.internal_sleeve,
                    gear.internal_sleeve_radius_m,
                    force,
                )
            };
            body.moment_kg_m2 *= 1e-3;
            let wanted = 0.1 * force * radius * radius
                / (scene.contact.friction_ramp_m_s * body.moment_kg_m2);
            let rate = friction_rate(&scene);
            assert!((rate / wanted - 1.0).abs() < 1e-12, "{rate} {wanted}");
        }
    }
}
