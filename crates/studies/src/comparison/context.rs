//! Facts of a scene for the judgement of a comparison.

use pinwheel_compare::{Context, Scales};
use pinwheel_scene::{Scene, Start, load_profile, speed_profile};

/// Returns name, load, scales and settling time of a scene.
pub fn context(scene: &Scene) -> Context {
    let scales = pinwheel_scene::Scales::of(scene);
    let settles = scales
        .settling_s(scene.contact.damping_n_s_m)
        .map(|time| format!("{time:.1e}").parse().unwrap_or(time));
    Context {
        scene: scene.name.clone(),
        description: scene.description.clone(),
        duration_s: scene.solver.duration_s,
        load_n_m: Some(load_profile::final_load(scene)),
        load_from_s: load_profile::final_from_s(scene),
        output_inertia_kg_m2: Some(scene.output_inertia_kg_m2()),
        load_changes_s: load_profile::breaks(&scene.drive),
        input_speed_rad_s: Some(speed_profile::final_rad_s(scene)),
        friction_coefficient: scene.contact.friction_coefficient,
        has_losses: scene.rubs(),
        settling_s: match scene.drive.start {
            Start::Equilibrium => Some(0.0),
            _ => settles,
        },
        scales: Scales {
            force_n: Some(scales.external_force_n),
            torque_n_m: Some(scales.wheel_torque_n_m),
        },
        ..Context::default()
    }
}
