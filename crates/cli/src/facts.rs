//! What a scene models and what it leaves out, in sentences with figures counted from the model.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::scene::{Detection, Formulation, Scene};
use serde::Serialize;

/// A statement and its reason.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct Statement {
    /// What.
    pub(crate) what: String,
    /// Details or the reason.
    pub(crate) why: String,
}

fn statement(what: impl Into<String>, why: impl Into<String>) -> Statement {
    Statement {
        what: what.into(),
        why: why.into(),
    }
}

/// What is in the model.
pub(crate) fn modelled(gearbox: &Gearbox) -> Vec<Statement> {
    let scene = &gearbox.scene;
    let gear = &scene.gear;
    let mechanism = gearbox.mechanism();
    let (bodies, revolutes, drivers) = (
        mechanism.bodies.len(),
        mechanism.revolutes.len(),
        mechanism.drivers.len(),
    );
    let freedom = 3 * bodies - 2 * revolutes - drivers;
    let pairs = gear.wheels * (gear.external_sleeves + gear.internal_sleeves);
    let contact = &scene.contact;
    let detection = match contact.detection {
        Detection::Exact => "closest point of the exact profile".to_owned(),
        Detection::Points => format!(
            "nearest of {} points on a wheel and {} on a hole, as published",
            contact.wheel_points, contact.hole_points
        ),
    };
    let friction = if gearbox.has_friction() {
        format!(
            "Coulomb friction, coefficient {}, regularised below {} m/s",
            contact.friction_coefficient, contact.friction_ramp_m_s
        )
    } else {
        "no friction".to_owned()
    };
    vec![
        statement(
            format!("{bodies} planar bodies"),
            format!(
                "input shaft, output shaft, {}, {} external and {} internal sleeves",
                count(gear.wheels, "wheel"),
                gear.external_sleeves,
                gear.internal_sleeves
            ),
        ),
        statement(
            format!(
                "{}, {}",
                count(revolutes, "revolute"),
                count(drivers, "driver")
            ),
            format!(
                "{} coordinates less {} constraints leave {freedom} degrees of freedom; the driver turns the input at {} rad/s",
                3 * bodies,
                2 * revolutes + drivers,
                scene.drive.input_speed_rad_s
            ),
        ),
        statement(
            format!("{pairs} pairs of wheel and sleeve"),
            format!("{detection}; law `{}`; {friction}", contact.law),
        ),
        statement(
            format!(
                "load of {} N m on the output shaft",
                scene.drive.output_torque_n_m
            ),
            if scene.drive.load_ramp_s > 0.0 {
                format!("rising over {} s", scene.drive.load_ramp_s)
            } else {
                "at once".to_owned()
            },
        ),
    ]
}

/// What is not, and why.
pub(crate) fn left_out(gearbox: &Gearbox) -> Vec<Statement> {
    let scene = &gearbox.scene;
    let mut list = Vec::new();
    if !gearbox.has_friction() {
        let sleeves = scene.gear.external_sleeves + scene.gear.internal_sleeves;
        list.push(statement(
            format!("the spin of {sleeves} sleeves"),
            "without friction nothing turns them and no force depends on it; the reduced form does not integrate it",
        ));
    }
    if scene.solver.formulation == Formulation::Reduced {
        list.push(statement(
            "translations of bodies pinned at their centre of mass",
            "they follow from the carriers' angles; the carried masses are lumped into the carriers, which is exact",
        ));
    }
    list.push(statement("gravity", "the paper's model has none"));
    list.push(statement(
        "bearing friction and play, bending of shafts and pins, heat",
        "every joint is ideal and every body rigid; only the contacts yield",
    ));
    list
}

/// `3 wheels`, `1 wheel`.
fn count(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// The scene's one-line title.
pub(crate) fn title(scene: &Scene) -> String {
    if scene.description.is_empty() {
        scene.name.clone()
    } else {
        format!("{}: {}", scene.name, scene.description)
    }
}
