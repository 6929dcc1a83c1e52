//! Combinations of valid values that are not supported.

use pinwheel_contact::NormalLaw as _;
use pinwheel_mbs::integrators::{Family, method};

use crate::FrictionLaw;
use pinwheel_files::quoted;

use crate::error::Fault;
use crate::model::{Detection, Scene};
use crate::number::short;
use crate::scales::law;

/// True if a scene's law has a force along the profile.
fn acts_along(scene: &Scene) -> bool {
    law(scene).is_some_and(|law| law.along(1.0, 1.0).is_some())
}

/// Checks that detection, friction and integrator support the law.
pub(super) fn check(scene: &Scene) -> Result<(), Fault> {
    let (gear, contact) = (&scene.gear, &scene.contact);
    // Eight points a lobe barely resolve lobe and pit; fewer describe another profile.
    let (lobes, points) = (gear.lobes(), contact.wheel_points);
    let least = 8 * lobes;
    if contact.detection == Detection::Points && points < least {
        return Err(Fault::new(
            &["contact.wheel_points", "gear.external_sleeves"],
            format!("is {points}, too few to show {lobes} lobes"),
            format!("give at least {least} (eight a lobe), or detection = \"exact\""),
        ));
    }
    if contact.detection == Detection::Points && acts_along(scene) {
        return Err(Fault::new(
            &["contact.detection", "contact.law"],
            format!(
                "is \"points\", on which the stiffness of the law {} has no slope",
                quoted(&contact.law)
            ),
            "use detection = \"exact\" or law = \"paper\"",
        ));
    }
    ring(scene)?;
    if contact.friction_law != FrictionLaw::Adams {
        return Ok(());
    }
    let coefficients = [
        contact.friction_dynamic_coefficient,
        contact.friction_coefficient,
    ];
    if coefficients[0] > coefficients[1] {
        let [dynamic, still] = coefficients.map(short);
        return Err(Fault::new(
            &[
                "contact.friction_dynamic_coefficient",
                "contact.friction_coefficient",
            ],
            format!("is {dynamic}, more than the static {still}"),
            format!("give at most {still}"),
        ));
    }
    let speeds = [
        contact.friction_dynamic_speed_m_s,
        contact.friction_ramp_m_s,
    ];
    if speeds[0] <= speeds[1] {
        let [dynamic, still] = speeds.map(short);
        return Err(Fault::new(
            &[
                "contact.friction_dynamic_speed_m_s",
                "contact.friction_ramp_m_s",
            ],
            format!("is {dynamic} m/s, not above the speed of the static coefficient, {still} m/s"),
            format!(
                "give more than {still} m/s, such as {}",
                short(2.0 * speeds[1])
            ),
        ));
    }
    let split = method(&scene.solver.integrator)
        .is_some_and(|method| method.family == Family::SplitImplicit);
    if split && contact.friction_coefficient > 0.0 {
        let name = quoted(&scene.solver.integrator);
        return Err(Fault::new(
            &["solver.integrator", "contact.friction_law"],
            format!(
                "is {name}, which solves friction as a convex problem; a coefficient that falls with speed is not convex"
            ),
            "use friction_law = \"regularised\" or another integrator",
        ));
    }
    Ok(())
}

/// Refuses parts of the model that a ring as output does not support.
fn ring(scene: &Scene) -> Result<(), Fault> {
    if !scene.ring_turns() {
        return Ok(());
    }
    let (bearings, solver) = (&scene.bearings, &scene.solver);
    let split = method(&solver.integrator).is_some_and(|m| m.family == Family::SplitImplicit);
    let parts = [
        ("bearings.input_seal_n_m", bearings.input_seal_n_m.is_some()),
        (
            "bearings.output_seal_n_m",
            bearings.output_seal_n_m.is_some(),
        ),
        ("solver.integrator", split),
    ];
    let Some((key, _)) = parts.into_iter().find(|(_, asked)| *asked) else {
        return Ok(());
    };
    let factor = short(scene.carrier_moment_per_output());
    Err(Fault::new(
        &["drive.output", key],
        format!("is \"ring\", which {key} does not go with as the scene has it"),
        format!(
            "leave one of both out, or describe the gear by its carrier: speed and load times {factor} give equal forces"
        ),
    ))
}
