//! Frequency of rapier's contact spring that reproduces the scene's contact law.
//!
//! rapier's spring is linear, with a stiffness given by a frequency and the pair's effective mass, k = m w^2, with one
//! frequency for all pairs. The frequency is determined at t = 0 under the static load (the last one of a changing load), with
//! the secant stiffness k = F/delta of the scene's law: for each stage the mean of k and of 1/m over its touching pairs,
//! weighted by their forces. w^2 = k/m of the internal stage.
//!
//! Without friction the pins' masses have no effect on the motion: ring pins turn about fixed points, and the output, whose
//! moment of inertia can include them, carries the output pins. So output pins are made light enough that m hardly depends on
//! the lever of a pair, and ring pins get the mass with which m w^2 is the external stage's k. With friction, w^2 is the mean
//! of k/m over all pairs.

use pinwheel_contact::bisect;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::{ContactField, PairContact};
use pinwheel_mbs::BodyState;
use pinwheel_scene::Scene;
use pinwheel_scene::{Layout, Sleeve, load_profile};

/// Spring that represents the law.
#[derive(Debug, Clone, Copy)]
pub struct ContactSpring {
    /// Frequency f = w/(2 pi), Hz.
    pub frequency_hz: f64,
    /// Masses of ring and output pins that give both stages the right stiffness, kg; `None` for the scene's.
    pub masses_kg: Option<[f64; 2]>,
    /// Stiffness k of external and internal contacts, N/m.
    pub stiffness_n_m: [f64; 2],
}

/// Ratio of the inverse mass of a light pin to that of a disc.
const LIGHT: f64 = 30.0;

/// Means over a stage, weighted by forces.
#[derive(Debug, Clone, Copy, Default)]
struct Stage {
    weight: f64,
    stiffness: f64,
    /// Inverse mass without the pin's own.
    inverse_mass: f64,
    square: f64,
}

/// Returns the spring of a gear.
///
/// # Errors
/// Message, if the law cannot carry the load within a quarter of a pitch.
pub fn contact_spring(
    gearbox: &Gearbox,
    field: &mut ContactField,
) -> Result<ContactSpring, String> {
    let (layout, scene) = (gearbox.layout, &gearbox.scene);
    let on_carrier = scene.carrier_moment_per_output();
    let load = on_carrier * gearbox.along_carrier_n_m(spring_load(scene));
    // Without a load nothing touches; any small load then gives the stiffness.
    let torque = if load == 0.0 { 1.0 } else { load };
    let mut states: Vec<BodyState> = gearbox.kinematic_states();
    for state in &mut states {
        (state.vx, state.vy, state.rate) = (0.0, 0.0, 0.0);
    }
    let start = states.clone();
    let limit = 0.25 * std::f64::consts::TAU / gearbox.geometry.lobes();

    // The load rotates the output, the output rotates the discs, and the discs press on the ring pins.
    let wheels_at = |twist: f64, states: &mut [BodyState]| {
        for wheel in layout.wheel_bodies() {
            states[wheel].angle = start[wheel].angle + twist;
        }
    };
    let gear = &gearbox.scene.gear;
    let twist = balance(torque, limit, |twist| {
        wheels_at(twist, &mut states);
        moment(field, &states, |pair| match pair.sleeve {
            Sleeve::External(_) => Some(start[layout.wheel_bodies().start + pair.wheel]),
            Sleeve::Internal(_) => None,
        })
    })
    .map_err(|fault| fault.message("external", "gear.backlash_m", gear.backlash_m))?;
    wheels_at(twist, &mut states);
    let output_at = |turn: f64, states: &mut [BodyState]| {
        let (sin, cos) = turn.sin_cos();
        for sleeve in layout.internal_bodies() {
            let at = &start[sleeve];
            (states[sleeve].x, states[sleeve].y) =
                (cos * at.x - sin * at.y, sin * at.x + cos * at.y);
        }
    };
    let further = balance(torque, limit, |further| {
        output_at(twist + further, &mut states);
        // The moment on the discs is opposite to that on the output.
        -moment(field, &states, |pair| match pair.sleeve {
            Sleeve::External(_) => None,
            Sleeve::Internal(_) => Some(start[Layout::OUTPUT]),
        })
    })
    .map_err(|fault| fault.message("internal", "gear.hole_radius_m", gear.hole_radius_m))?;
    output_at(twist + further, &mut states);

    let mass = &gearbox.scene.mass;
    let sleeves = [mass.external_sleeve.mass_kg, mass.internal_sleeve.mass_kg];
    let mut stages = [Stage::default(); 2];
    let mut most = 0.0_f64;
    field.touching(&states, &mut |pair| {
        let wheel = &states[layout.wheel_bodies().start + pair.wheel];
        let number = usize::from(matches!(pair.sleeve, Sleeve::Internal(_)));
        // The normal passes through the pin's centre, so only its mass counts.
        let lever = cross(
            pair.point[0] - wheel.x,
            pair.point[1] - wheel.y,
            pair.normal,
        );
        let of_wheel = 1.0 / mass.wheel.mass_kg + lever * lever / mass.wheel.moment_kg_m2;
        let (force, secant) = (
            pair.normal_force_n,
            pair.normal_force_n / pair.penetration_m,
        );
        most = most.max(of_wheel);
        let stage = &mut stages[number];
        stage.weight += force;
        stage.stiffness += force * secant;
        stage.inverse_mass += force * of_wheel;
        stage.square += force * secant * (of_wheel + 1.0 / sleeves[number]);
    });
    let weight: f64 = stages.iter().map(|stage| stage.weight).sum();
    let together = stages.iter().map(|stage| stage.square).sum::<f64>() / weight;
    let of_wheel = stages.map(|stage| stage.inverse_mass / stage.weight);
    let [external, internal] = stages.map(|stage| stage.stiffness / stage.weight);
    let light = (LIGHT * most).recip().min(sleeves[1]);
    let own = internal * (of_wheel[1] + 1.0 / light);
    // Inverse mass of the ring pin that gives its stage the frequency.
    let brought = own / external - of_wheel[0];
    let moves_nothing = !gearbox.scene.slides();
    let (square, masses_kg) = if moves_nothing && brought.is_finite() && brought > 0.0 {
        (own, Some([brought.recip(), light]))
    } else {
        (together, None)
    };
    if !(square.is_finite() && square > 0.0) {
        return Err("no contact carries the load in the mesh at t = 0".to_owned());
    }
    let sleeves = masses_kg.unwrap_or(sleeves);
    let stiffness = |stage: usize| square / (of_wheel[stage] + 1.0 / sleeves[stage]);
    Ok(ContactSpring {
        frequency_hz: square.sqrt() / std::f64::consts::TAU,
        masses_kg,
        stiffness_n_m: [stiffness(0), stiffness(1)],
    })
}

/// Returns the linear stiffness of the colliders' external and internal contacts, N/m.
///
/// # Errors
/// Message, if the law cannot carry the load.
pub fn stage_stiffness(gearbox: &Gearbox) -> Result<[f64; 2], String> {
    let mut field = gearbox.contact_field().map_err(|error| error.to_string())?;
    contact_spring(gearbox, &mut field).map(|spring| spring.stiffness_n_m)
}

/// Returns the reference load of the spring, N m: the final load of the scene, as only settled means are compared, or if that
/// is 0 the largest.
pub fn spring_load(scene: &Scene) -> f64 {
    let last = load_profile::final_load(scene);
    if last == 0.0 {
        load_profile::largest(&scene.drive)
    } else {
        last
    }
}

/// Reason why no rotation within a quarter of a pitch carries the load.
enum Fault {
    /// Free play takes more than half of it.
    Play,
    /// The spring is too soft.
    Soft,
}

impl Fault {
    /// Returns the message; `play` and `value` are the key and the value, m, that cause the play of these pins.
    fn message(&self, sleeves: &str, play: &str, value: f64) -> String {
        match self {
            Self::Play => format!(
                "its {sleeves} pins have so much play that a quarter of a pitch brings none to bear on the load; make \
                 {play} smaller than {value} m{}",
                if sleeves == "internal" {
                    ": a hole without play has the radius of its pin and the eccentricity together"
                } else {
                    ""
                }
            ),
            Self::Soft => format!(
                "the contacts of its {sleeves} pins are too soft to carry drive.output_torque_n_m within a quarter of a \
                 pitch; raise contact.stiffness_multiplier or lower the load"
            ),
        }
    }
}

/// Returns the angle between 0 and `limit`, in the direction of `torque`, at which `resisting` equals it.
fn balance(torque: f64, limit: f64, mut resisting: impl FnMut(f64) -> f64) -> Result<f64, Fault> {
    let sign = torque.signum();
    if sign * resisting(sign * limit) < torque.abs() {
        let free = sign * resisting(sign * 0.5 * limit) <= 0.0;
        return Err(if free { Fault::Play } else { Fault::Soft });
    }
    let is_less = |turn: f64| sign * resisting(sign * turn) < torque.abs();
    Ok(sign * bisect([0.0, limit], is_less)[1])
}

/// Returns the moment of the contact forces on the pins, N m, about the centre given by `about` for each pair (`None`: not
/// counted).
fn moment(
    field: &mut ContactField,
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
