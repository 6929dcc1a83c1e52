//! Settings of a native run that stand in for a scene's contact law in engines that resolve contacts themselves.
//!
//! The native solver with the springs of such an engine is called its twin. A difference between the engine and its twin is
//! a fault of the engine or of the twin; a difference between the twin and the scene's law is one of contact models.

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::scales::{self, Spring};
use pinwheel_scene::{Scene, load_profile};

use crate::spring::stage_stiffness;

/// The contacts of an engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OwnContact {
    /// The scene's law.
    SceneLaw,
    /// Linear springs, one stiffness for each stage.
    Springs,
    /// Balls: beds of springs whose force grows with sqrt(R) delta^1.5.
    Balls,
}

/// Laws of balls that beds of springs follow as they are.
const BALLS: [&str; 2] = ["paper", "paper-conservative"];
/// Factor by which the ramp of the force is shortened, because springs have no ramp.
const RAMP: f64 = 1e-3;
/// Shortest ramp that a scene may have, m.
const LEAST_RAMP_M: f64 = 1e-15;

impl OwnContact {
    /// Returns the tolerance of the largest forces against the twin's, as a share.
    #[must_use]
    pub fn tolerance(self) -> f64 {
        match self {
            Self::SceneLaw => 0.0,
            Self::Springs | Self::Balls => 0.02,
        }
    }

    /// Returns the scene with the contacts that the engine really has; `None` if they are the scene's.
    ///
    /// # Errors
    /// In words, why they are not known.
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

    /// The scene as an engine of this kind gets it: one of balls knows no other laws, so it gets balls as stiff as the scene's
    /// contacts are under its largest load.
    #[must_use]
    pub fn given(self, scene: Scene) -> Scene {
        match self {
            Self::Balls => balls(scene),
            Self::SceneLaw | Self::Springs => scene,
        }
    }
}

/// A scene of balls: itself, or with the multipliers that make balls as stiff as its law, by secants F/delta at the largest
/// static force of each stage.
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
    // Balls have no ramp of the force beyond what a bed of springs can do without.
    contact.ramp_m = ramp_m;
    scene
}

/// A ramp that shapes no force.
fn short_ramp(scene: &Scene) -> f64 {
    (RAMP * scene.contact.ramp_m).max(LEAST_RAMP_M)
}
