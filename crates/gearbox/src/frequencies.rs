//! Frequencies and rates of a gear, which limit time steps. The modes are those of the scene's
//! [`Scales`](pinwheel_scene::Scales).

use std::f64::consts::TAU;

use pinwheel_scene::bearings::{BearingLaw, typical_force};
use pinwheel_scene::scales::{Scales, Spring, external_force, hertz, internal_force, least_depth};

use crate::scene::{BodyMass, Scene};

/// Frequencies and rates of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frequencies {
    /// Fastest oscillation of discs and output on their contacts, and on bearings of floating discs, rad/s.
    pub contact_rad_s: f64,
    /// Fastest oscillation of discs and output on their contacts alone, rad/s. Contacts open and close at this rate.
    pub touch_rad_s: f64,
    /// Frequency at which pins pass a disc, the faster of both kinds, rad/s.
    pub mesh_rad_s: f64,
    /// Rate at which friction stops a pin's slip under the load, 1/s; 0 without friction.
    pub friction_1_s: f64,
}

impl Frequencies {
    /// Computes the frequencies of a checked scene.
    pub fn of(scene: &Scene) -> Self {
        let gear = &scene.gear;
        let scales = Scales::of(scene);
        let [_, rigid] = scales.modes_rad_s;
        // Modes of a floating disc on the loaded quarter of its contacts, and on its bearing, too.
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

    /// Returns the depth of the most loaded ring pin under the scene's own law, relative to that by Hertz' stiffness, the scale
    /// of errors of adaptive methods ([`Gearbox::error_scales`](crate::Gearbox::error_scales)).
    pub fn depth_share(scene: &Scene) -> f64 {
        let gear = &scene.gear;
        let force = external_force(gear, scene.largest_disc_load_n_m());
        let stiffness = hertz(scene).on_flat(gear.external_sleeve_radius_m);
        let least = least_depth(scene);
        let plain = (force / stiffness).powf(2.0 / 3.0).max(least);
        Spring::of(scene, stiffness).depth(force, least) / plain
    }

    /// Returns the longest step that cannot miss a contact, s: a third of a touch at the contacts' frequency, and an eighth of
    /// the time from pin to pin.
    pub fn longest_step_s(&self) -> f64 {
        let mesh = TAU / 8.0 / self.mesh_rad_s.max(f64::MIN_POSITIVE);
        (1.0 / self.touch_rad_s).min(mesh)
    }
}

/// Longest explicit step that resolves a relaxation, in relaxation times under the static force. It is half of the stability
/// limit of methods of order two on the real axis (Hairer and Wanner, Solving Ordinary Differential Equations II, 1996, ch.
/// IV.2), because the force may double. At 2.8, one of a hundred gears had an error of 14 % in the driver's torque with a
/// stated uncertainty of 0.03 %.
const FOLLOWED: f64 = 1.0;

/// Returns the factor by which explicit steps must be shorter to resolve the friction of a scene; `None` if they do. Longer
/// steps chatter across its ramp: two such runs may agree on a wrong force.
pub fn unfollowed(scene: &Scene, step_s: f64) -> Option<f64> {
    let shorter = step_s * friction_rate(scene) / FOLLOWED;
    (shorter > 1.0).then_some(shorter)
}

/// Returns the rate mu F q^2/(v_s J), 1/s, at which friction relaxes a pin's spin, or, with q the pins' circle radius, a disc's
/// on fixed pins. It is that of the faster kind of pin under the largest static force (4 T/(e zs zk) a disc, and 4 T/(zi R_w)).
pub fn friction_rate(scene: &Scene) -> f64 {
    let (gear, contact, mass) = (&scene.gear, &scene.contact, &scene.mass);
    let torque = scene.largest_disc_load_n_m();
    let external = external_force(gear, torque);
    let internal = internal_force(gear, torque);
    let [on_ring, on_output] = scene.sliding();
    let rate = |coefficient: f64, force: f64, (radius, body): (f64, BodyMass)| {
        coefficient * force * radius * radius / (contact.friction_ramp_m_s * body.moment_kg_m2)
    };
    let ring = match gear.external_sleeves_turn {
        true => (gear.external_sleeve_radius_m, mass.external_sleeve),
        false => (gear.pitch_radius_m(), mass.wheel),
    };
    let output = match gear.internal_sleeves_turn {
        true => (gear.internal_sleeve_radius_m, mass.internal_sleeve),
        false => (gear.internal_circle_radius_m, mass.wheel),
    };
    rate(on_ring, external, ring).max(rate(on_output, internal, output))
}
