//! Which frequency of rapier's contact spring stands for the scene's contact law.
//!
//! rapier's spring is linear, with a stiffness that is a frequency times the effective mass of
//! the pair, k = m w^2, one frequency for all pairs. It is taken from the mesh at t = 0 under the
//! static load: w^2 is the mean of k/m over the touching pairs, weighted by their forces, with
//! the secant stiffness k = F/delta of the scene's law.

use pinwheel_gearbox::contacts::{ContactField, PairContact};
use pinwheel_gearbox::{Gearbox, Layout, Sleeve};
use pinwheel_mbs::BodyState;

/// f = w/(2 pi), Hz.
///
/// # Errors
/// In words, if the law cannot carry the load within a quarter of a pitch.
pub(super) fn contact_frequency(gearbox: &Gearbox, field: &mut dyn ContactField) -> Result<f64, String> {
    let (layout, load) = (gearbox.layout, gearbox.scene.drive.output_torque_n_m);
    // Without a load nothing touches; then any small one tells the stiffness.
    let torque = if load == 0.0 { 1.0 } else { load };
    let mut states: Vec<BodyState> = gearbox.initial_states();
    for state in &mut states {
        (state.vx, state.vy, state.rate) = (0.0, 0.0, 0.0);
    }
    let start = states.clone();
    let limit = 0.25 * std::f64::consts::TAU / gearbox.geometry.ratio();

    // The load turns the output, that the wheels, and those lean on the external sleeves.
    let wheels_at = |twist: f64, states: &mut [BodyState]| {
        for wheel in layout.wheel_bodies() {
            states[wheel].angle = start[wheel].angle + twist;
        }
    };
    let twist = balance(torque, limit, |twist| {
        wheels_at(twist, &mut states);
        moment(field, &states, |pair| match pair.sleeve {
            Sleeve::External(_) => Some(start[layout.wheel_bodies().start + pair.wheel]),
            Sleeve::Internal(_) => None,
        })
    })?;
    wheels_at(twist, &mut states);
    let output_at = |turn: f64, states: &mut [BodyState]| {
        let (sin, cos) = turn.sin_cos();
        for sleeve in layout.internal_bodies() {
            let at = &start[sleeve];
            (states[sleeve].x, states[sleeve].y) = (cos * at.x - sin * at.y, sin * at.x + cos * at.y);
        }
    };
    let further = balance(torque, limit, |further| {
        output_at(twist + further, &mut states);
        // On the wheels it is the opposite of what it is on the output.
        -moment(field, &states, |pair| match pair.sleeve {
            Sleeve::External(_) => None,
            Sleeve::Internal(_) => Some(start[Layout::OUTPUT]),
        })
    })?;
    output_at(twist + further, &mut states);

    let mass = &gearbox.scene.mass;
    let (mut weighted, mut weight) = (0.0, 0.0);
    field.touching(&states, &mut |pair| {
        let wheel = &states[layout.wheel_bodies().start + pair.wheel];
        let sleeve = match pair.sleeve {
            Sleeve::External(_) => mass.external_sleeve,
            Sleeve::Internal(_) => mass.internal_sleeve,
        };
        // The normal passes through the sleeve's centre: only its mass counts.
        let lever = cross(pair.point[0] - wheel.x, pair.point[1] - wheel.y, pair.normal);
        let inverse_mass =
            1.0 / sleeve.mass_kg + 1.0 / mass.wheel.mass_kg + lever * lever / mass.wheel.moment_kg_m2;
        weighted += pair.normal_force_n.powi(2) / pair.penetration_m * inverse_mass;
        weight += pair.normal_force_n;
    });
    let square = weighted / weight;
    if square.is_finite() && square > 0.0 {
        Ok(square.sqrt() / std::f64::consts::TAU)
    } else {
        Err("no contact carries the load in the mesh at t = 0".to_owned())
    }
}

/// The angle between 0 and `limit`, in the direction of `torque`, at which `resisting` equals it.
fn balance(torque: f64, limit: f64, mut resisting: impl FnMut(f64) -> f64) -> Result<f64, String> {
    let sign = torque.signum();
    let (mut low, mut high) = (0.0, limit);
    if sign * resisting(sign * high) < torque.abs() {
        return Err(
            "its contacts are too soft to carry drive.output_torque_n_m within a quarter of a pitch; \
             raise contact.stiffness_multiplier"
                .to_owned(),
        );
    }
    // Each halving adds a bit; beyond 60 there are none left.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if sign * resisting(sign * middle) < torque.abs() { low = middle } else { high = middle }
    }
    Ok(sign * high)
}

/// Moment of the contact forces on the sleeves, about the centre that `about` gives for a pair
/// (`None`: not counted), N m.
fn moment(
    field: &mut dyn ContactField,
    states: &[BodyState],
    about: impl Fn(&PairContact) -> Option<BodyState>,
) -> f64 {
    let mut sum = 0.0;
    field.touching(states, &mut |pair| {
        if let Some(centre) = about(pair) {
            let normal = [-pair.normal[0], -pair.normal[1]];
            sum += pair.normal_force_n
                * cross(pair.point[0] - centre.x, pair.point[1] - centre.y, normal);
        }
    });
    sum
}

fn cross(x: f64, y: f64, v: [f64; 2]) -> f64 {
    x * v[1] - y * v[0]
}
