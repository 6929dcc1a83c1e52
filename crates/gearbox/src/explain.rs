//! What a scene needs, what is left out of its model, and why.

use pinwheel_contact::laws::hysteresis_factor;
use serde::Serialize;

use pinwheel_scene::free_play;

use crate::scene::{Detection, Formulation, Gear, Scene, Stabilisation};
use crate::{Gearbox, GearboxError};

/// One statement with its reason.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Statement {
    /// What is modelled or left out.
    pub what: String,
    /// Why.
    pub why: String,
}

/// The model of a scene in words and counts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// Bodies of the gearbox.
    pub bodies: usize,
    /// Joints of the gearbox, the driver included.
    pub joints: usize,
    /// Coordinates of the Lagrange form.
    pub lagrange_coordinates: usize,
    /// Scalar constraints of the Lagrange form.
    pub constraints: usize,
    /// Velocities that the chosen formulation integrates.
    pub degrees_of_freedom: usize,
    /// Wheel-sleeve pairs tested at every evaluation.
    pub contact_pairs: usize,
    /// What is in the model.
    pub modelled: Vec<Statement>,
    /// What is not.
    pub left_out: Vec<Statement>,
    /// Columns beside the contract's that the scene asks for.
    pub channels: Vec<String>,
    /// Every channel there is, `*` standing for numbers, with what it holds.
    pub channels_available: Vec<Statement>,
}

/// Explains the model of a compiled scene.
///
/// # Errors
/// The friction's contacts cannot be set up.
pub fn explain(gearbox: &Gearbox) -> Result<Explanation, GearboxError> {
    let scene: &Scene = &gearbox.scene;
    let mechanism = gearbox.mechanism();
    let (layout, contact, solver) = (gearbox.layout, &scene.contact, &scene.solver);
    let sleeves = layout.external_sleeves + layout.internal_sleeves;
    let free_angles = layout.wheels + 1 + if gearbox.has_friction() { sleeves } else { 0 };
    let lagrange = solver.formulation == Formulation::Lagrange;
    let coordinates = 3 * mechanism.bodies.len();

    let mut modelled = Vec::new();
    let mut left_out = Vec::new();
    let say = |list: &mut Vec<Statement>, what: String, why: &str| {
        list.push(Statement {
            what,
            why: why.to_owned(),
        });
    };

    say(
        &mut modelled,
        format!(
            "{} planar bodies on {} revolutes and a driver",
            mechanism.bodies.len(),
            mechanism.revolutes.len()
        ),
        &format!(
            "{coordinates} coordinates less {} constraints leave {} degrees of freedom; the driver turns the input at {} rad/s",
            mechanism.constraints(),
            coordinates - mechanism.constraints(),
            scene.drive.input_speed_rad_s
        ),
    );
    if lagrange {
        say(
            &mut modelled,
            format!(
                "all {} bodies with 3 coordinates each, {} joints by multipliers",
                mechanism.bodies.len(),
                joints(gearbox)
            ),
            "solver.formulation = \"lagrange\": the paper's Eq. 2",
        );
        say(
            &mut modelled,
            format!(
                "joint stabilisation: {}",
                match solver.stabilisation {
                    Stabilisation::None => "none",
                    Stabilisation::Baumgarte => "Baumgarte",
                    Stabilisation::Projection => "projection at every stage",
                }
            ),
            match solver.stabilisation {
                Stabilisation::None => "as published; positions drift with the integrator's error",
                Stabilisation::Baumgarte => {
                    "position and velocity errors are fed back into the accelerations"
                }
                Stabilisation::Projection => "keeps every joint closed to rounding, in every stage",
            },
        );
    } else {
        let spins = if gearbox.has_friction() {
            format!(", {sleeves} sleeve spins")
        } else {
            String::new()
        };
        say(
            &mut modelled,
            format!("{} wheel angles, the output angle{spins}", layout.wheels),
            "the only angles that forces can change",
        );
        say(
            &mut left_out,
            format!(
                "{} translations and their joint multipliers",
                2 * mechanism.bodies.len()
            ),
            "every revolute holds its body at the centre of mass: positions follow from angles exactly, masses are lumped into the carriers",
        );
        say(
            &mut left_out,
            "the input shaft's equation".to_owned(),
            "its angle is prescribed; the driver torque follows from the forces on the eccentrics",
        );
    }
    if !gearbox.has_friction() {
        if !lagrange {
            say(
                &mut left_out,
                format!("{sleeves} sleeve spins"),
                "friction_coefficient = 0: contact forces pass through the sleeve centres and turn no sleeve",
            );
        }
        say(
            &mut left_out,
            "tangential contact velocities inside the integration".to_owned(),
            "without friction no force depends on them",
        );
    }
    say(
        &mut modelled,
        format!(
            "{} wheel-sleeve pairs with the law `{}`",
            layout.wheels * sleeves,
            contact.law
        ),
        "every wheel can touch every external sleeve and its own holes",
    );
    match contact.detection {
        Detection::Exact => {
            say(
                &mut modelled,
                "closest point on the exact curves".to_owned(),
                "contact.detection = \"exact\"",
            );
            say(
                &mut left_out,
                "discrete contact points".to_owned(),
                "wheel_points and hole_points only matter with detection = \"points\"",
            );
        }
        Detection::Points => say(
            &mut modelled,
            format!(
                "{} points a wheel, {} a hole",
                contact.wheel_points, contact.hole_points
            ),
            "contact.detection = \"points\": the nearest point within the sleeve, as published",
        ),
    }
    if gearbox.has_friction() {
        say(
            &mut modelled,
            format!(
                "Coulomb friction, coefficient {}",
                contact.friction_coefficient
            ),
            &format!(
                "regularised below {} m/s of sliding; it turns the sleeves",
                contact.friction_ramp_m_s
            ),
        );
    }
    say(
        &mut modelled,
        format!(
            "load of {} N m on the output shaft",
            scene.drive.output_torque_n_m
        ),
        &if scene.drive.load_ramp_s > 0.0 {
            format!("rising over {} s", scene.drive.load_ramp_s)
        } else {
            "from the start".to_owned()
        },
    );
    for change in &scene.drive.load_changes {
        let how = if change.ramp_s > 0.0 {
            format!("reached linearly over {} s", change.ramp_s)
        } else {
            "at once".to_owned()
        };
        let reached = if change.time_s < solver.duration_s {
            "no step passes over the change: integration starts anew there".to_owned()
        } else {
            format!("never reached: the run ends at {} s", solver.duration_s)
        };
        say(
            &mut modelled,
            format!(
                "load of {} N m from {} s on, {how}",
                change.output_torque_n_m, change.time_s
            ),
            &reached,
        );
    }
    for (family, count) in gearbox.channels.families() {
        say(
            &mut modelled,
            format!("channel {} ({count})", family.pattern),
            &format!("output.channels: {}", family.about),
        );
    }
    let choice = crate::auto::integrator(scene);
    say(
        &mut modelled,
        format!("integrator {}", choice.integrator),
        &choice.reason,
    );
    if scene.gear.backlash_m > 0.0 {
        say(
            &mut modelled,
            format!(
                "backlash: external sleeves at R + {} mm",
                scene.gear.backlash_m * 1e3
            ),
            "gear.backlash_m",
        );
    }
    deviations(&scene.gear, &mut |what, why| say(&mut modelled, what, why));
    if hysteresis_factor(&scene.contact.law, scene.contact.restitution).is_some() {
        say(
            &mut left_out,
            "the impact speed of each pair".to_owned(),
            &format!(
                "the law takes contact.impact_speed_m_s = {} m/s for all: forces stay a function of the state alone",
                scene.contact.impact_speed_m_s
            ),
        );
    }
    for (what, why) in [
        (
            "bending, bearings and housing",
            "rigid bodies on ideal revolutes, as in the paper",
        ),
        (
            "gravity",
            "the plane of motion is horizontal in the paper's model; no force depends on it",
        ),
        (
            "contacts between sleeves and shafts",
            "sleeves turn on ideal bearings",
        ),
    ] {
        say(&mut left_out, what.to_owned(), why);
    }
    Ok(Explanation {
        bodies: mechanism.bodies.len(),
        joints: joints(gearbox),
        lagrange_coordinates: coordinates,
        constraints: mechanism.constraints(),
        degrees_of_freedom: if lagrange { coordinates } else { free_angles },
        contact_pairs: layout.wheels * sleeves,
        modelled,
        left_out,
        channels: gearbox.channels.names().map(str::to_owned).collect(),
        channels_available: pinwheel_scene::channels::FAMILIES
            .iter()
            .map(|family| Statement {
                what: family.pattern.to_owned(),
                why: family.about.to_owned(),
            })
            .collect(),
    })
}

/// The modified profile and the errors of single parts.
fn deviations(gear: &Gear, say: &mut dyn FnMut(String, &str)) {
    let micrometres = |length_m: f64| format!("{:+.3} um", 1e6 * length_m);
    let change = &gear.modification;
    if !change.is_none() {
        say(
            format!(
                "modified profile: generating sleeve q' = q {}, on the circle R' = R {}, flanks turned by {} arcmin each",
                micrometres(change.equidistant_m),
                micrometres(change.radial_m),
                change.rotational_rad.to_degrees() * 60.0
            ),
            &format!(
                "gear.modification: the edge is the offset by q' of the epitrochoid with R', the ring keeps R and q; to first \
                 order a sleeve at phi from the eccentric stands off by g = (q' - q) + (d - (R' - R)) (1 - m cos phi)/S + \
                 delta e zs |sin phi|/S with S = sqrt(1 + m^2 - 2 m cos phi), and a wheel turns freely by {:.4} arcmin to \
                 either side (the least g/l at any angle, l = e zs sin(phi)/S)",
                free_play(gear).to_degrees() * 60.0
            ),
        );
    }
    for list in gear.errors.lists(gear) {
        let (low, high) = list
            .values
            .iter()
            .fold((0.0_f64, 0.0_f64), |(low, high), &x| {
                (low.min(x), high.max(x))
            });
        if low < high {
            let unit = |x: f64| match list.key.ends_with("_rad") {
                true => format!("{:+.3} urad", 1e6 * x),
                false => micrometres(x),
            };
            say(
                format!(
                    "errors of {} {} from {} to {}",
                    list.count,
                    list.parts,
                    unit(low),
                    unit(high)
                ),
                list.key,
            );
        }
    }
}

fn joints(gearbox: &Gearbox) -> usize {
    gearbox.layout.bodies() + 1
}
