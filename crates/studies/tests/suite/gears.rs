//! Random valid gears with fixed seeds: scenes without any tuning.
//!
//! Each gear is drawn from dimensionless ratios first, then scaled: lengths from a watch to a wind turbine, times and masses from
//! materials and speeds. Runs last for the free flight through the backlash and a few oscillations of the gear on its contacts.

use std::f64::consts::{PI, TAU};

use pinwheel_gearbox::{Frequencies, Gearbox};
use pinwheel_scene::bearings::typical_force;
use pinwheel_scene::{
    BodyMass, Cranks, Detection, EccentricBearing, Errors, FrictionLaw, Gear, LoadChange, Masses,
    Modification, Scene, Start,
};
use pinwheel_studies::rng::Rng;

/// Range of a run's duration in periods of the gear's fastest oscillation on its contacts.
const OSCILLATIONS: (f64, f64) = (6.0, 24.0);
/// Share of the duration in runs with friction, which need many steps.
const RUBBING: f64 = 0.3;
/// Number of samples of a run.
const SAMPLES: f64 = 60.0;

/// Returns the gear of a seed, or `None` if a thousand draws give no valid one.
pub(crate) fn gear(seed: u64) -> Option<Scene> {
    let mut rng = Rng::new(seed);
    // Separate numbers, so that gears without bearings do not depend on those with bearings.
    let mut bearings = Rng::new(!seed);
    let mut cranks = Rng::new(seed.rotate_left(32));
    let scene = (0..1000).find_map(|_| draw(&mut rng, &mut bearings, &mut cranks))?;
    Some(Scene {
        name: format!("random-{seed}"),
        ..scene
    })
}

/// Draws a gear; `None` if its parts do not fit together.
fn draw(rng: &mut Rng, apart: &mut Rng, of_cranks: &mut Rng) -> Option<Scene> {
    let mut scene = Scene::paper();
    scene.gear = geometry(rng);
    let wheel_density = if rng.chance(0.7) { 7850.0 } else { 1200.0 };
    scene.mass = masses(rng, &scene.gear, wheel_density);
    material(rng, &mut scene);
    drive(rng, &mut scene);
    contact(rng, &mut scene);
    bearings(apart, &mut scene);
    cranks(of_cranks, &mut scene);
    solver(rng, &mut scene);
    let checked = scene.clone().check().ok()?;
    // The load may exceed the capacity of the teeth at an equilibrium.
    Gearbox::new(&checked).ok()?;
    Some(scene)
}

fn geometry(rng: &mut Rng) -> Gear {
    let pitch_radius = rng.spread(2.5e-3, 0.5);
    let zk = rng.integer(6, 60);
    let shortening = rng.between(0.4, 0.9);
    let eccentricity = shortening * pitch_radius / zk as f64;
    let k = zk as f64;
    // Smallest convex radius of the pin centre's path, by the formula for an interior minimum.
    let bend = pitch_radius
        * (27.0 * (1.0 - shortening * shortening) * (k - 1.0) / (k + 1.0).powi(3)).sqrt();
    let pitch = pitch_radius * (PI / k).sin();
    let sleeve = rng.between(0.3, 0.9) * bend.min(pitch);
    let zi = rng.integer(4, 16);
    let room = pitch_radius - eccentricity - sleeve;
    let circle = rng.between(0.45, 0.75) * room;
    let most = (circle * (PI / zi as f64).sin()).min(room - circle);
    let clearance = if rng.chance(0.5) {
        0.0
    } else {
        eccentricity * rng.spread(1e-3, 0.2)
    };
    let internal = rng.between(0.5, 0.95) * (most - eccentricity - clearance);
    Gear {
        eccentric_bore_radius_m: None,
        eccentricity_m: eccentricity,
        external_sleeves: zk,
        shortening,
        external_sleeve_radius_m: sleeve,
        internal_sleeves: zi,
        internal_sleeve_radius_m: internal,
        internal_circle_radius_m: circle,
        hole_radius_m: internal + eccentricity + clearance,
        external_sleeves_turn: true,
        internal_sleeves_turn: true,
        face_width_m: None,
        modification: Modification::default(),
        errors: Errors::default(),
        wheels: rng.integer(1, 4),
        backlash_m: if rng.chance(0.5) {
            0.0
        } else {
            eccentricity.min(sleeve) * rng.spread(1e-3, 0.4)
        },
    }
}

fn masses(rng: &mut Rng, gear: &Gear, density: f64) -> Masses {
    let (radius, width) = (gear.pitch_radius_m(), gear.pitch_radius_m() * 0.15);
    let disc = |r: f64, factor: f64| {
        let mass_kg = density * PI * r * r * width;
        BodyMass {
            mass_kg,
            moment_kg_m2: 0.5 * factor * mass_kg * r * r,
        }
    };
    Masses {
        density_kg_m3: None,
        input_shaft: disc(0.3 * radius, 1.0),
        output_shaft: disc(radius, rng.spread(0.1, 3.0)),
        wheel: disc(radius, rng.spread(0.1, 1.0)),
        // Tables of real gears list moments of inertia up to several times a cylinder's.
        internal_sleeve: disc(gear.internal_sleeve_radius_m, rng.spread(0.5, 6.0)),
        external_sleeve: disc(gear.external_sleeve_radius_m, rng.spread(0.5, 6.0)),
    }
}

/// Draws law and stiffness; damping depends on the load.
fn material(rng: &mut Rng, scene: &mut Scene) {
    let laws = [
        "paper",
        "paper",
        "line-hertz",
        "paper-conservative",
        "constant",
        "adams-impact",
        "line-contact",
        "hunt-crossley",
        "lankarani-nikravesh",
        "flores",
        "paper-printed",
    ];
    let contact = &mut scene.contact;
    contact.law = laws[rng.integer(0, laws.len() - 1)].to_owned();
    contact.young_pa = rng.spread(2e9, 2e11);
    contact.stiffness_multiplier = [1.0, 1.0, 0.1, 0.01][rng.integer(0, 3)];
    contact.line_length_m = 0.15 * scene.gear.pitch_radius_m();
}

/// Returns Hertz' stiffness of a ring pin, N/m^1.5.
fn hertz(scene: &Scene) -> f64 {
    let contact = &scene.contact;
    2.0 / 3.0 * contact.stiffness_multiplier * contact.young_pa
        / (1.0 - contact.poisson * contact.poisson)
        * scene.gear.external_sleeve_radius_m.sqrt()
}

/// Draws the speed, the load (none, constant, ramp, changes) and the start.
fn drive(rng: &mut Rng, scene: &mut Scene) {
    let gear = &scene.gear;
    let sleeve = gear.external_sleeve_radius_m;
    // Penetration of the most loaded pin under the load.
    let depth = sleeve * rng.spread(1e-4, 1e-2);
    let force = hertz(scene) * depth.powf(1.5);
    let lever = gear.eccentricity_m * gear.lobes() as f64;
    let load = 0.25 * force * lever * gear.external_sleeves as f64 * gear.wheels as f64;
    let kind = rng.share();
    let drive = &mut scene.drive;
    // Speed of the disc's edge: 0.1 to 10 m/s.
    drive.input_speed_rad_s = rng.sign() * rng.spread(0.05, 5.0) / gear.pitch_radius_m();
    drive.output_torque_n_m = if kind < 0.04 { 0.0 } else { rng.sign() * load };
    drive.start = if rng.chance(0.3) {
        Start::Equilibrium
    } else {
        Start::Kinematic
    };
}

/// Draws parameters of the contact that scale with its penetration under load.
fn contact(rng: &mut Rng, scene: &mut Scene) {
    let ((depth, frequency), stiffness) = (twist(scene), hertz(scene));
    let speed = depth * frequency;
    let gear = scene.gear.clone();
    let zeta = if rng.chance(0.2) {
        0.0
    } else {
        rng.spread(1e-3, 0.3)
    };
    let lever = gear.eccentricity_m * gear.lobes() as f64;
    let moment = scene.mass.wheel.moment_kg_m2;
    let mass = moment / (lever * lever) / (0.25 * gear.external_sleeves as f64);
    let slide = scene.drive.input_speed_rad_s.abs() * gear.pitch_radius_m() / gear.lobes() as f64;
    let contact = &mut scene.contact;
    contact.damping_n_s_m = 2.0 * zeta * mass * frequency;
    contact.ramp_m = depth * rng.spread(1e-3, 0.5);
    contact.constant_stiffness_n_m15 = stiffness;
    contact.restitution = rng.between(0.5, 0.95);
    contact.impact_speed_m_s = speed * rng.spread(0.3, 3.0);
    if rng.chance(0.4) {
        contact.friction_coefficient = rng.spread(0.005, 0.3);
        contact.friction_ramp_m_s = slide * rng.spread(1e-3, 1e-1);
        if rng.chance(0.15) {
            // Explicit law: its ramps are as wide as in the published models that use it.
            contact.friction_law = FrictionLaw::Adams;
            contact.friction_ramp_m_s *= 20.0;
            contact.friction_dynamic_coefficient = 0.7 * contact.friction_coefficient;
            contact.friction_dynamic_speed_m_s = contact.friction_ramp_m_s * rng.spread(3.0, 30.0);
        }
    }
    if rng.chance(0.06) && !["paper-conservative", "line-hertz"].contains(&contact.law.as_str()) {
        contact.detection = Detection::Points;
        contact.wheel_points = gear.lobes() * rng.integer(200, 600);
        contact.hole_points = rng.integer(100, 400);
    }
}

/// Draws bearings: a fifth of the gears have floating discs, on linear or roller bearings, with clearance or without, half of these
/// with bending pins.
fn bearings(rng: &mut Rng, scene: &mut Scene) {
    if !rng.chance(0.2) {
        return;
    }
    let (depth, force) = (twist(scene).0, typical_force(scene));
    let clearance = depth * rng.spread(0.1, 3.0);
    let [has_rollers, is_loose, bends] = [0.4, 0.3, 0.5].map(|share| rng.chance(share));
    // Stiffness from half to ten times that of the contacts.
    let [stiffness, pin] = [force, 0.1 * force].map(|force| force / depth * rng.spread(0.5, 10.0));
    let rollers = rng.integer(8, 30);
    scene.bearings.eccentric = Some(EccentricBearing {
        stiffness_n_m: (!has_rollers).then_some(stiffness),
        rollers: has_rollers.then_some(rollers),
        roller_length_m: has_rollers.then_some(0.15 * scene.gear.pitch_radius_m()),
        clearance_m: is_loose.then_some(clearance),
        ..EccentricBearing::default()
    });
    scene.bearings.internal_sleeve_stiffness_n_m = bends.then_some(pin);
}

/// Draws cranks: a third of the gears with floating discs are RV gears, on rigid or elastic supports.
fn cranks(rng: &mut Rng, scene: &mut Scene) {
    if scene.bearings.eccentric.is_none() || !rng.chance(0.35) {
        return;
    }
    let gear = &mut scene.gear;
    let bore = gear.internal_sleeve_radius_m + gear.eccentricity_m;
    gear.internal_sleeves = rng.integer(2, 3);
    gear.internal_sleeve_radius_m = bore - gear.eccentricity_m;
    gear.hole_radius_m = gear.internal_sleeve_radius_m + gear.eccentricity_m;
    scene.cranks = Some(Cranks {
        count: gear.internal_sleeves,
        circle_radius_m: gear.internal_circle_radius_m,
        bore_radius_m: bore,
        sun_teeth: rng.integer(10, 20),
        planet_teeth: rng.integer(20, 60),
        support_stiffness_n_m: None,
        mesh_stiffness_n_m: None,
    });
    scene.bearings.internal_sleeve_stiffness_n_m = None;
    let (is_elastic, stiffer) = (rng.chance(0.6), rng.spread(0.5, 10.0));
    let support = typical_force(scene) / twist(scene).0 * stiffer;
    if let Some(cranks) = &mut scene.cranks {
        cranks.support_stiffness_n_m = is_elastic.then_some(support);
    }
    // The eccentrics keep their speed without the first stage.
    scene.drive.input_speed_rad_s /= scene.eccentric_per_input().abs();
}

/// Returns the penetration of the most loaded pin, m, and the frequency of a disc on its pins, rad/s, under the load, but at least
/// under a small reference load.
fn twist(scene: &Scene) -> (f64, f64) {
    let gear = &scene.gear;
    let lever = gear.eccentricity_m * gear.lobes() as f64;
    let pins = gear.external_sleeves as f64;
    let torque = scene.drive.output_torque_n_m.abs() / gear.wheels as f64;
    let force = (4.0 * torque / (lever * pins))
        .max(hertz(scene) * (1e-4 * gear.external_sleeve_radius_m).powf(1.5));
    let depth = (force / hertz(scene)).powf(2.0 / 3.0);
    let stiffness = 1.5 * force / depth * lever * lever * 0.25 * pins;
    (depth, (stiffness / scene.mass.wheel.moment_kg_m2).sqrt())
}

fn solver(rng: &mut Rng, scene: &mut Scene) {
    let frequency = Frequencies::of(scene).contact_rad_s;
    let gear = &scene.gear;
    let period = TAU / frequency;
    let lever = gear.eccentricity_m * gear.lobes() as f64;
    let play = gear.backlash_m / lever
        + (gear.hole_radius_m - gear.internal_sleeve_radius_m - gear.eccentricity_m).max(0.0)
            / gear.internal_circle_radius_m;
    let torque = scene.drive.output_torque_n_m.abs();
    let moment = scene.mass.output_shaft.moment_kg_m2;
    let falls = (2.0 * play * moment / torque).sqrt();
    let flight = if torque > 0.0 { falls } else { 0.0 };
    let has_friction = scene.contact.friction_coefficient > 0.0;
    let share = if has_friction { RUBBING } else { 1.0 };
    let duration = share * rng.between(OSCILLATIONS.0, OSCILLATIONS.1) * period
        + (2.0 * flight).min(30.0 * period);
    let (kind, when, what) = (rng.share(), rng.between(0.3, 0.7), rng.between(-1.0, 2.0));
    let drive = &mut scene.drive;
    if drive.start == Start::Kinematic && kind < 0.2 {
        drive.load_ramp_s = duration * rng.between(0.1, 0.4);
    } else if kind > 0.7 {
        drive.load_changes = vec![LoadChange {
            time_s: duration * when,
            output_torque_n_m: what * drive.output_torque_n_m,
            ramp_s: if rng.chance(0.5) { 0.0 } else { 0.1 * duration },
        }];
    }
    let solver = &mut scene.solver;
    solver.duration_s = duration;
    solver.sample_s = duration / SAMPLES;
    // Steps come from the frequencies, as nobody tuned the scene. Engines with equal steps need an integer number per sample.
    solver.step_s = solver.sample_s / (solver.sample_s / (0.02 * period)).ceil();
    solver.integrator = "auto".to_owned();
}
