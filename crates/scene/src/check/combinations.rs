//! Values that are each right and do not go together.

use crate::FrictionLaw;
use crate::error::{Fault, quoted};
use crate::model::{Detection, Scene};
use crate::number::short;

/// Laws that do not go with every detection, friction or integrator.
pub(super) fn check(scene: &Scene) -> Result<(), Fault> {
    let (gear, contact) = (&scene.gear, &scene.contact);
    // Eight points a lobe hardly tell a lobe from a pit; below that the profile is another one.
    let least = 8 * gear.lobes();
    if contact.detection == Detection::Points && contact.wheel_points < least {
        return Err(Fault::new(
            &["contact.wheel_points", "gear.external_sleeves"],
            format!(
                "is {}, too few to show {} lobes",
                contact.wheel_points,
                gear.lobes()
            ),
            format!("give at least {least} (eight a lobe), or detection = \"exact\""),
        ));
    }

    if contact.law == "paper-conservative" && contact.detection == Detection::Points {
        return Err(Fault::new(
            &["contact.detection", "contact.law"],
            "is \"points\", on which the stiffness of the law \"paper-conservative\" has no slope",
            "use detection = \"exact\" or law = \"paper\"",
        ));
    }
    if contact.friction_law == FrictionLaw::Adams {
        if contact.friction_dynamic_coefficient > contact.friction_coefficient {
            return Err(Fault::new(
                &[
                    "contact.friction_dynamic_coefficient",
                    "contact.friction_coefficient",
                ],
                format!(
                    "is {}, more than the static {}",
                    short(contact.friction_dynamic_coefficient),
                    short(contact.friction_coefficient)
                ),
                "the static coefficient is the larger one",
            ));
        }
        if contact.friction_dynamic_speed_m_s <= contact.friction_ramp_m_s {
            return Err(Fault::new(
                &[
                    "contact.friction_dynamic_speed_m_s",
                    "contact.friction_ramp_m_s",
                ],
                format!(
                    "is {} m/s, not above the speed of the static coefficient, {} m/s",
                    short(contact.friction_dynamic_speed_m_s),
                    short(contact.friction_ramp_m_s)
                ),
                "give a larger speed",
            ));
        }
        if scene.solver.integrator.starts_with("imex") && contact.friction_coefficient > 0.0 {
            return Err(Fault::new(
                &["solver.integrator", "contact.friction_law"],
                format!(
                    "is {}, which solves friction as a convex problem; a coefficient that falls with speed is none",
                    quoted(&scene.solver.integrator)
                ),
                "use friction_law = \"regularised\" or another integrator",
            ));
        }
    }
    Ok(())
}
