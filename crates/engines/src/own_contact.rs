//! Settings of a native run that reproduce the contacts of engines with their own contact resolution.
//!
//! The native solver with the springs of such an engine is its twin. A difference between engine and twin is a fault of one of
//! them; a difference between the twin and the scene's law is one of contact models.

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::scales::{self, Spring};
use pinwheel_scene::{Scene, load_profile};

use crate::spring::stage_stiffness;

/// Contacts of an engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OwnContact {
    /// Contact law of the scene.
    SceneLaw,
    /// Linear springs, one stiffness for each stage.
    Springs,
    /// Balls: beds of springs whose force grows with sqrt(R) delta^1.5.
    Balls,
}

/// Laws of balls that beds of springs reproduce directly.
const BALLS: [&str; 2] = ["paper", "paper-conservative"];
/// Factor on the ramp of the force, because springs have no ramp.
const RAMP: f64 = 1e-3;
/// Shortest permitted ramp of a scene, m.
const LEAST_RAMP_M: f64 = 1e-15;

impl OwnContact {
    /// Returns the relative tolerance of the largest forces against the twin's.
    pub fn tolerance(self) -> f64 {
        match self {
            Self::SceneLaw => 0.0,
            Self::Springs | Self::Balls => 0.02,
        }
    }

    /// Returns the scene with the engine's actual contacts; `None` if they are the scene's.
    ///
    /// # Errors
    /// Reason why they are unknown.
    pub fn twin(self, gearbox: &Gearbox) -> Result<Option<Scene>, String> {
        let mut scene = Scene::clone(&gearbox.scene);
        match self {
            Self::SceneLaw => return Ok(None),
            Self::Springs => {
                let [external, internal] = stage_stiffness(gearbox)?;
                "linear".clone_into(&mut scene.contact.law);
                scene.contact.external_spring_n_m = Some(external);
                scene.contact.internal_spring_n_m = Some(internal);
            }
            Self::Balls => {
                scene = balls(scene);
                "paper-conservative".clone_into(&mut scene.contact.law);
                scene.contact.ramp_m = short_ramp(&gearbox.scene);
            }
        }
        Ok(Some(scene))
    }

    /// Returns the scene for an engine of this kind: engines of balls support no other laws, so they get balls as stiff as the
    /// scene's contacts under its largest load.
    pub fn adapted(self, scene: Scene) -> Scene {
        match self {
            Self::Balls => balls(scene),
            Self::SceneLaw | Self::Springs => scene,
        }
    }
}

/// Returns a scene of balls: unchanged, or with the multipliers that give balls the stiffness of its law, by secants F/delta at
/// the largest static force of each stage.
fn balls(mut scene: Scene) -> Scene {
    if BALLS.contains(&scene.contact.law.as_str()) {
        return scene;
    }
    let gear = &scene.gear;
    let own = scales::hertz(&scene);
    let mut plain = scene.clone();
    "paper".clone_into(&mut plain.contact.law);
    (
        plain.contact.stiffness_multiplier,
        plain.contact.internal_stiffness_multiplier,
    ) = (1.0, None);
    let full = scales::hertz(&plain);
    let torque = load_profile::largest(&scene.drive) / gear.wheels as f64;
    let least = scales::least_depth(&scene);
    let multiplier = |own: f64, full: f64, force: f64| {
        let spring = Spring::of(&scene, own);
        let depth = spring.depth(force, least);
        spring.force(depth) / (full * depth.powf(1.5))
    };
    let pin = gear.internal_sleeve_radius_m;
    let hole = gear.hole_radius_m.max(pin + gear.eccentricity_m);
    let external = multiplier(
        own.on_flat(gear.external_sleeve_radius_m),
        full.on_flat(gear.external_sleeve_radius_m),
        scales::external_force(gear, torque),
    );
    let internal = multiplier(
        own.of_hole(pin, hole),
        full.of_hole(pin, hole),
        scales::internal_force(gear, torque),
    );
    let ramp_m = short_ramp(&scene);
    let contact = &mut scene.contact;
    "paper-conservative".clone_into(&mut contact.law);
    contact.stiffness_multiplier = external;
    contact.internal_stiffness_multiplier = Some(internal);
    // Balls have no ramp of the force, except as short as a bed of springs allows.
    contact.ramp_m = ramp_m;
    scene
}

/// Returns a ramp too short to affect the force.
fn short_ramp(scene: &Scene) -> f64 {
    (RAMP * scene.contact.ramp_m).max(LEAST_RAMP_M)
}
