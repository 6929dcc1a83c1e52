//! A scene's contact law with its parameters, and contacts at rest as springs under the largest static load.

use pinwheel_contact::laws::law_info;
use pinwheel_contact::{
    HertzStiffness, Law, LawParameters, Material, NormalLaw as _, PaperLaw, PinLaw, Ramp,
};

use crate::model::{Gear, Scene};
use crate::wall::hole_to_profile_m;

/// Depth of contact that replaces the load of an unloaded gear, over the ring pins' radius. For the paper's gear the force
/// at that depth is 1.4 mN.
const LEAST_DEPTH: f64 = 1e-5;

/// Returns the depth of contact that replaces the load of an unloaded gear, m.
pub fn least_depth(scene: &Scene) -> f64 {
    LEAST_DEPTH * scene.gear.external_sleeve_radius_m
}

const DEPTH: &str = "contact.disc_depth_m";
const SPRING: &str = "contact.external_spring_n_m";

/// Returns the springs of a scene's external and internal contacts, N/m: stated, or the secants of rollers under the
/// largest static forces.
fn springs(scene: &Scene) -> [f64; 2] {
    let (contact, gear) = (&scene.contact, &scene.gear);
    let mut rollers = scene.clone();
    "line-hertz".clone_into(&mut rollers.contact.law);
    let (hertz, torque) = (hertz(&rollers), scene.largest_disc_load_n_m());
    let secant = |stiffness: f64, force: f64| {
        let spring = Spring::of(&rollers, stiffness);
        let depth = spring.depth(force, least_depth(scene));
        spring.force(depth) / depth
    };
    let (pin, hole) = (gear.internal_sleeve_radius_m, gear.hole_radius_m);
    let hole = hole.max(pin + gear.eccentricity_m);
    [
        contact.external_spring_n_m.unwrap_or_else(|| {
            let flat = hertz.on_flat(gear.external_sleeve_radius_m);
            secant(flat, external_force(gear, torque))
        }),
        contact
            .internal_spring_n_m
            .unwrap_or_else(|| secant(hertz.of_hole(pin, hole), internal_force(gear, torque))),
    ]
}

/// True if a scene's law reads a key.
fn reads(scene: &Scene, key: &str) -> bool {
    law_info(&scene.contact.law).is_some_and(|law| law.keys.contains(&key))
}

/// Stores the disc depth, which the law would otherwise compute at each evaluation, in the scene.
pub fn state_depth(scene: &mut Scene) {
    if reads(scene, DEPTH) {
        let depth = law_parameters(scene).disc_depth;
        scene.contact.disc_depth_m = Some(depth);
    }
}

/// Returns the parameters of a scene's law.
pub fn law_parameters(scene: &Scene) -> LawParameters {
    let contact = &scene.contact;
    let pin = Material {
        young: contact.pin_young_pa.unwrap_or(contact.young_pa),
        poisson: contact.pin_poisson.unwrap_or(contact.poisson),
    };
    let springs = match reads(scene, SPRING) {
        true => springs(scene),
        false => [1.0; 2],
    };
    let least = 0.5 * scene.gear.external_sleeve_radius_m;
    let wall = || reads(scene, DEPTH).then(|| hole_to_profile_m(&scene.gear).max(least));
    LawParameters {
        damping: contact.damping_n_s_m,
        ramp: contact.ramp_m,
        constant_stiffness: contact.constant_stiffness_n_m15,
        stiffness_multiplier: contact.stiffness_multiplier,
        internal_multiplier: contact
            .internal_stiffness_multiplier
            .unwrap_or(contact.stiffness_multiplier),
        springs,
        line_length: contact.line_length_m,
        pin,
        disc: Material {
            young: contact.young_pa,
            poisson: contact.poisson,
        },
        disc_depth: contact.disc_depth_m.or_else(wall).unwrap_or_default(),
        sleeve_radius: scene.gear.external_sleeve_radius_m,
        restitution: contact.restitution,
        impact_speed: contact.impact_speed_m_s,
    }
}

/// Returns Hertz' stiffness for a scene's materials and law.
pub fn hertz(scene: &Scene) -> HertzStiffness {
    law_parameters(scene).hertz(&scene.contact.law)
}

/// Returns the law of a scene; `None` for an unknown name.
pub fn law(scene: &Scene) -> Option<Law> {
    Law::named(&scene.contact.law, &law_parameters(scene))
}

/// Law named by a scene, with the bending of its output pins and the seats of its ring pins.
pub fn pin_law(scene: &Scene) -> Option<PinLaw> {
    Some(PinLaw {
        law: law(scene)?,
        pin_n_m: scene.bearings.internal_sleeve_stiffness_n_m,
        ring_n_m: scene.ring_seat_n_m(),
    })
}

/// Contact at rest under a scene's law.
#[derive(Debug, Clone, Copy)]
pub struct Spring {
    law: Law,
    hertz: f64,
}

impl Spring {
    /// Returns the spring for Hertz' stiffness `hertz`, N/m^1.5; the paper's law if the scene names an unknown one.
    pub fn of(scene: &Scene, hertz: f64) -> Self {
        let plain = || PaperLaw {
            damping: 0.0,
            ramp: Ramp::new(scene.contact.ramp_m),
        };
        Self {
            law: law(scene).unwrap_or_else(|| plain().into()),
            hertz,
        }
    }

    /// Returns F at rest, N.
    pub fn force(&self, depth: f64) -> f64 {
        self.law.elastic(self.hertz, depth)
    }

    /// Returns delta under a force, m, at least `least`.
    pub fn depth(&self, force_n: f64, least: f64) -> f64 {
        if force_n > 0.0 {
            self.law.depth(self.hertz, force_n).max(least)
        } else {
            least
        }
    }

    /// Returns dF/d delta, N/m.
    pub fn tangent(&self, depth: f64) -> f64 {
        self.law.tangent(self.hertz, depth)
    }
}

/// Returns 4 T/(e zs zk): the largest force of a ring pin on a disc under the torque T, N.
pub fn external_force(gear: &Gear, wheel_torque_n_m: f64) -> f64 {
    4.0 * wheel_torque_n_m / (gear.lever_m() * gear.external_sleeves as f64)
}

/// Returns 4 T/(zi R_w): the largest force of an output pin on a disc under the torque T, N.
pub fn internal_force(gear: &Gear, wheel_torque_n_m: f64) -> f64 {
    4.0 * wheel_torque_n_m / (gear.internal_sleeves as f64 * gear.internal_circle_radius_m)
}

/// Returns the spring of a ring pin on a disc.
pub(crate) fn outer(scene: &Scene, hertz: &HertzStiffness) -> Spring {
    Spring::of(scene, hertz.on_flat(scene.gear.external_sleeve_radius_m))
}

/// Returns the load torque on one disc, N m: the largest of the run; of an unloaded gear the torque of the [`least_depth`].
pub(crate) fn wheel_torque_n_m(scene: &Scene) -> f64 {
    wheel_torque_of(scene, &outer(scene, &hertz(scene)))
}

/// Returns the load torque on one disc for known springs, N m: the largest of the run, but at least a quarter of that of
/// the unloaded contacts.
pub(crate) fn wheel_torque_of(scene: &Scene, outer: &Spring) -> f64 {
    let gear = &scene.gear;
    let unloaded = outer.force(least_depth(scene));
    scene
        .largest_disc_load_n_m()
        .max(0.25 * unloaded * gear.lever_m() * gear.external_sleeves as f64)
}
