//! Explanation of a scene: modelled parts, omitted parts, and the reasons.

use pinwheel_contact::laws::hysteresis_factor;
use serde::Serialize;

use pinwheel_scene::free_play;

use crate::Gearbox;
use crate::scene::{Detection, Formulation, Gear, Scene, Stabilisation};

/// One statement with its reason.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Statement {
    /// Part that is modelled or left out.
    pub what: String,
    /// Reason for it.
    pub why: String,
}

/// List of statements under construction.
#[derive(Default)]
struct Statements(Vec<Statement>);

impl Statements {
    fn add(&mut self, what: impl Into<String>, why: impl Into<String>) {
        let (what, why) = (what.into(), why.into());
        self.0.push(Statement { what, why });
    }
}

/// Model of a scene in words and counts.
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
    /// Disc-pin pairs tested at every evaluation.
    pub contact_pairs: usize,
    /// Parts of the model.
    pub modelled: Vec<Statement>,
    /// Parts that the model leaves out.
    pub left_out: Vec<Statement>,
    /// Columns that the scene records besides the contract's.
    pub channels: Vec<String>,
    /// All available channels, with `*` for numbers, and their contents.
    pub channels_available: Vec<Statement>,
}

/// Describes the elastic parts that carry the discs.
fn bearings(gearbox: &Gearbox, modelled: &mut Statements, left_out: &mut Statements) {
    let scene: &Scene = &gearbox.scene;
    if let Some(law) = gearbox.carrier.law() {
        let (stiffness, exponent) = (law.stiffness, law.exponent);
        let clearance_um = 1e6 * law.clearance_m;
        modelled.add(
            "discs that float on elastic bearings",
            format!(
                "F = K d^p beyond {clearance_um:.3} um of clearance, K = {stiffness:.3e} N/m^p, p = {exponent:.3}"
            ),
        );
    }
    let Some(cranks) = &scene.cranks else {
        return;
    };
    let (count, ratio) = (cranks.count, scene.ratio());
    modelled.add(
        format!("an RV gear of ratio {ratio}, {count} cranks in the output"),
        "ratio 1 + zk planet/sun; the output turns with the input",
    );
    let stage = match cranks.mesh_stiffness_n_m {
        Some(stiffness) => {
            format!(
                "a first stage whose mesh has {stiffness:.3e} N/m, folded into input and output"
            )
        }
        None => "a rigid first stage, folded into input and output".to_owned(),
    };
    modelled.add(
        stage,
        "cranks turn by (1 + rho) output - rho input, rho = sun/planet, and by the deflection of the mesh, a spring without \
         mass; their inertia acts as (1 + rho)^2 of it on the output",
    );
    match cranks.support_stiffness_n_m {
        Some(stiffness) => modelled.add(
            format!("elastic supports of the cranks, {stiffness:.3e} N/m"),
            "springs without mass, in series with the bearings; dampers bridge both",
        ),
        None => left_out.add(
            "supports of the cranks",
            "rigid: cranks.support_stiffness_n_m is not given",
        ),
    }
    left_out.add(
        "play and losses of the first stage's mesh, and the cranks' bending",
        "the radial part of the mesh's forces is left out, too; without cranks.mesh_stiffness_n_m the mesh is rigid, which \
         changes the gear's stiffness by less than a per cent",
    );
    left_out.add(
        "the cranks' reaction on the driver",
        "from the cranks' acceleration with the output; its mean is 0",
    );
}

/// Describes the behaviour of pins and sleeves under friction.
fn pins(scene: &Scene, modelled: &mut Statements) {
    let (gear, contact) = (&scene.gear, &scene.contact);
    let turn = [gear.external_sleeves_turn, gear.internal_sleeves_turn];
    let kinds = match scene.ring_turns() {
        true => [("ring", "the ring"), ("output", "the held carrier")],
        false => [("ring", "the housing"), ("output", "the output shaft")],
    };
    for ((pins, holder), turns) in kinds.into_iter().zip(turn) {
        if !turns {
            modelled.add(
                format!("{pins} pins that do not turn: {holder} holds them"),
                "discs slide on them; their rates are not unknowns",
            );
        }
    }
    if scene.rolling() != [false; 2] {
        let also = match contact.friction_coefficient > 0.0 {
            true => {
                "; where that exceeds the contact's own friction, the disc slides on the sleeve: the smaller moment holds"
            }
            false => "",
        };
        modelled.add(
            "sleeves that roll on the discs and rub on their pins",
            format!("mu F d/(2 r) against the sliding at a contact{also}"),
        );
    }
    if scene.slides() {
        let (coefficient, ramp) = (contact.friction_coefficient, contact.friction_ramp_m_s);
        let turned = match turn.contains(&true) && scene.rolling() == [false; 2] {
            true => "; it turns the pins",
            false => "",
        };
        modelled.add(
            format!("Coulomb friction, coefficient {coefficient}"),
            format!("regularised below {ramp} m/s of sliding{turned}"),
        );
    }
}

/// Explains the model of a compiled scene.
pub fn explain(gearbox: &Gearbox) -> Explanation {
    let scene: &Scene = &gearbox.scene;
    let mechanism = gearbox.mechanism();
    let (layout, contact, solver) = (gearbox.layout, &scene.contact, &scene.solver);
    let sleeves = layout.external_sleeves + layout.internal_sleeves;
    let of_a_wheel = gearbox.carrier.freedoms_of_disc();
    let spins = gearbox.spinning().len();
    let free_angles = of_a_wheel * layout.wheels + 1 + spins;
    let lagrange = solver.formulation == Formulation::Lagrange;
    let coordinates = 3 * mechanism.bodies.len();

    let (bodies, joints) = (mechanism.bodies.len(), layout.bodies() + 1);
    let constraints = mechanism.constraints();
    let mut modelled = Statements::default();
    let mut left_out = Statements::default();
    // Equations come last: the gear is described before its computation.
    let mut equations = Statements::default();

    let revolutes = mechanism.revolutes.len();
    let (free, speed) = (coordinates - constraints, scene.drive.input_speed_rad_s);
    equations.add(
        format!("{bodies} planar bodies on {revolutes} revolutes and a driver"),
        format!(
            "{coordinates} coordinates less {constraints} constraints leave {free} degrees of freedom; the driver turns the input at {speed:.2} rad/s"
        ),
    );
    if lagrange {
        equations.add(
            format!("all {bodies} bodies with 3 coordinates each, {joints} joints by multipliers"),
            "solver.formulation = \"lagrange\": the paper's Eq. 2",
        );
        let (name, effect) = match solver.stabilisation {
            Stabilisation::None => (
                "none",
                "as published; positions drift with the integrator's error",
            ),
            Stabilisation::Baumgarte => (
                "Baumgarte",
                "position and velocity errors are fed back into the accelerations",
            ),
            Stabilisation::Projection => (
                "projection at every stage",
                "keeps every joint closed to rounding, in every stage",
            ),
        };
        equations.add(format!("joint stabilisation: {name}"), effect);
    } else {
        let spins = match spins {
            0 => String::new(),
            spins => format!(", {spins} pin spins"),
        };
        equations.add(
            match gearbox.floats() {
                true => format!(
                    "{} discs' places and angles, the output angle{spins}",
                    layout.wheels
                ),
                false => format!("{} disc angles, the output angle{spins}", layout.wheels),
            },
            "all coordinates that forces can change",
        );
        left_out.add(
            format!("{} translations and their joint multipliers", 2 * bodies),
            "every revolute holds its body at the centre of mass: positions follow from angles exactly, masses are lumped into the carriers",
        );
        left_out.add(
            "the input shaft's equation",
            "its angle is prescribed; the driver torque follows from the forces on the eccentrics",
        );
    }
    if !gearbox.has_friction() {
        if !lagrange {
            left_out.add(
                format!("{sleeves} pin spins"),
                match scene.contact.friction_coefficient > 0.0 {
                    true => "sleeves roll on the discs or stand on their pins, without inertia of their own",
                    false => "friction_coefficient = 0: contact forces pass through the pin centres and turn no pin",
                },
            );
        }
        left_out.add(
            "tangential contact velocities inside the integration",
            "without friction no force depends on them",
        );
    }
    let sleeves = match gearbox.carrier.cranks() {
        Some(_) => layout.external_sleeves,
        None => sleeves,
    };
    let (pairs, law) = (layout.wheels * sleeves, &contact.law);
    modelled.add(
        format!("{pairs} disc-pin pairs with the law `{law}`"),
        "every disc can touch every ring pin and its own holes",
    );
    let (wheel, hole) = (contact.wheel_points, contact.hole_points);
    match contact.detection {
        Detection::Exact => {
            modelled.add(
                "closest point on the exact curves",
                "contact.detection = \"exact\"",
            );
            left_out.add(
                "discrete contact points",
                "wheel_points and hole_points only matter with detection = \"points\"",
            );
        }
        Detection::Points => modelled.add(
            format!("{wheel} points a disc, {hole} a hole"),
            "contact.detection = \"points\": the nearest point within the pin, as published",
        ),
    }
    pins(scene, &mut modelled);
    let (load, ramp) = (scene.drive.output_torque_n_m, scene.drive.load_ramp_s);
    let rising = if ramp > 0.0 {
        format!("rising over {ramp} s")
    } else {
        "from the start".to_owned()
    };
    modelled.add(format!("load of {load} N m on the output shaft"), rising);
    if scene.ring_turns() {
        modelled.add(
            "the ring is the output, the carrier is held",
            "drive.output: contacts are those seen from the ring; inertia is in the frame of the ground, where the ring turns with its pins",
        );
    }
    let loads = scene.drive.load_changes.iter();
    let loads = loads.map(|c| {
        (
            format!("load of {} N m", c.output_torque_n_m),
            c.time_s,
            c.ramp_s,
        )
    });
    let speeds = scene.drive.speed_changes.iter();
    let speeds = speeds.map(|c| {
        (
            format!("speed of {} rad/s", c.input_speed_rad_s),
            c.time_s,
            c.ramp_s,
        )
    });
    for (value, time, ramp) in loads.chain(speeds) {
        let how = if ramp > 0.0 {
            format!("reached linearly over {ramp} s")
        } else {
            "at once".to_owned()
        };
        let reached = if time < solver.duration_s {
            "no step passes over the change: integration restarts there".to_owned()
        } else {
            format!("never reached: the run ends at {} s", solver.duration_s)
        };
        modelled.add(format!("{value} from {time} s on, {how}"), reached);
    }
    for (family, count) in gearbox.channels.families() {
        modelled.add(
            format!("channel {} ({count})", family.pattern),
            format!("output.channels: {}", family.about),
        );
    }
    let (integrator, reason) = crate::auto::integrator(scene);
    modelled.add(format!("integrator {integrator}"), reason);
    if scene.gear.backlash_m > 0.0 {
        let backlash_mm = scene.gear.backlash_m * 1e3;
        modelled.add(
            format!("backlash: ring pins at R + {backlash_mm} mm"),
            "gear.backlash_m",
        );
    }
    deviations(&scene.gear, &mut modelled);
    let speed = contact.impact_speed_m_s;
    if hysteresis_factor(law, contact.restitution).is_some() {
        left_out.add(
            "the impact speed of each pair",
            format!(
                "the law takes contact.impact_speed_m_s = {speed} m/s for all: forces stay a function of the state alone"
            ),
        );
    }
    if gearbox.floats() {
        bearings(gearbox, &mut modelled, &mut left_out);
    }
    let structure = scene.structure_in_words();
    let bearings = &scene.bearings;
    let deflection = bearings.eccentric.is_some()
        || bearings.internal_sleeve_stiffness_n_m.is_some()
        || !structure.is_empty();
    for (what, how) in structure {
        modelled.add(what, how);
    }
    left_out.add(
        "bending, bearings and housing",
        match deflection {
            true => "rigid bodies on ideal revolutes but for what [bearings] and [structure] give",
            false => "rigid bodies on ideal revolutes, as in the paper",
        },
    );
    left_out.add(
        "gravity",
        "the plane of motion is horizontal in the paper's model; no force depends on it",
    );
    left_out.add(
        "contacts between pins and shafts",
        "pins are held, or turn on bearings without play",
    );
    let mut channels_available = Statements::default();
    for family in pinwheel_scene::channels::FAMILIES {
        channels_available.add(family.pattern, family.about);
    }
    modelled.0.extend(equations.0);
    Explanation {
        bodies,
        joints,
        lagrange_coordinates: coordinates,
        constraints,
        degrees_of_freedom: if lagrange { coordinates } else { free_angles },
        contact_pairs: pairs,
        modelled: modelled.0,
        left_out: left_out.0,
        channels: gearbox.channels.names().map(str::to_owned).collect(),
        channels_available: channels_available.0,
    }
}

/// Describes the modified profile and the errors of single parts.
fn deviations(gear: &Gear, modelled: &mut Statements) {
    let micrometres = |length_m: f64| format!("{:+.3} um", 1e6 * length_m);
    let change = &gear.modification;
    if !change.is_none() {
        let [equidistant, radial] = [change.equidistant_m, change.radial_m].map(micrometres);
        let turned = change.rotational_rad.to_degrees() * 60.0;
        let play = free_play(gear).to_degrees() * 60.0;
        modelled.add(
            format!(
                "modified profile: generating pin q' = q {equidistant}, on the circle R' = R {radial}, flanks turned by {turned} arcmin each"
            ),
            format!(
                "gear.modification: the edge is the offset by q' of the epitrochoid with R', the ring keeps R and q; to first \
                 order a pin at phi from the eccentric stands off by g = (q' - q) + (d - (R' - R)) (1 - m cos phi)/S + \
                 delta e zs |sin phi|/S with S = sqrt(1 + m^2 - 2 m cos phi), and a disc turns freely by {play:.4} arcmin to \
                 either side (the least g/l at any angle, l = e zs sin(phi)/S)"
            ),
        );
    }
    if let Some(offset) = change.normal_m.of_lobe() {
        let most = micrometres(offset.largest());
        modelled.add(
            format!("own profile: the generating curve is moved along its normal, by {most} at most"),
            "gear.modification.normal_m: the same on all lobes; curvature and reach are those of the moved curve",
        );
    }
    for list in gear.errors.lists(gear) {
        let low = list.values.iter().copied().fold(0.0, f64::min);
        let high = list.values.iter().copied().fold(0.0, f64::max);
        if low < high {
            let [low, high] = [low, high].map(|x| match list.key.ends_with("_rad") {
                true => format!("{:+.3} urad", 1e6 * x),
                false => micrometres(x),
            });
            let (count, parts) = (list.count, list.parts);
            let what = format!("errors of {count} {parts} from {low} to {high}");
            modelled.add(what, list.key);
        }
    }
}
