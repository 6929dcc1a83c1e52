//! Floating discs: on the bearing of one eccentric, and on the cranks of RV gears.

use std::time::Duration;

use pinwheel::studies::choice;
use pinwheel::studies::comparison::{self, Effort, Input};
use pinwheel_compare::{Status, Verdict};
use pinwheel_gearbox::Gearbox;

use super::*;

/// Presets with changes: on one eccentric and on cranks, also unrealistic gears.
const GEARS: &[(&str, &[(&str, &str)])] = &[
    // From balance, and the load jumps.
    (
        "paper-bearings",
        &[
            ("drive.start", "\"equilibrium\""),
            (
                "drive.load_changes",
                "[{ time_s = 5e-5, output_torque_n_m = 33.0 }]",
            ),
            ("solver.duration_s", "0.0002"),
        ],
    ),
    // A clearance, an exponent between a line's and a ball's, and pins that bend.
    (
        "eleven-pins",
        &[
            ("bearings.eccentric.stiffness_n_m", "5e9"),
            ("bearings.eccentric.exponent", "1.25"),
            ("bearings.eccentric.clearance_m", "3e-6"),
            ("bearings.internal_sleeve_stiffness_n_m", "8e7"),
            ("solver.duration_s", "0.0002"),
        ],
    ),
    // Three cranks and a clearance.
    (
        "rv-40e-like",
        &[
            ("gear.external_sleeves", "30"),
            ("gear.eccentricity_m", "0.0012"),
            ("cranks.count", "3"),
            ("cranks.sun_teeth", "15"),
            ("cranks.planet_teeth", "35"),
            ("bearings.eccentric.clearance_m", "3e-6"),
            ("drive.start", "\"equilibrium\""),
            (
                "drive.load_changes",
                "[{ time_s = 1e-5, output_torque_n_m = -600.0 }]",
            ),
            ("solver.sample_s", "5e-6"),
            ("solver.duration_s", "0.0001"),
        ],
    ),
    (
        "paper-bearings",
        &[("bearings.internal_sleeve_stiffness_n_m", "5e7")],
    ),
    // Shorter, as IDA steps through the ramps of friction one by one.
    ("needle-bearings", &[("solver.duration_s", "0.0002")]),
    ("rv-320", &[("solver.duration_s", "0.0002")]),
    ("rv-40e-like", &[("solver.duration_s", "0.0002")]),
    // One disc on four cranks, with errors of each part and an elastic first stage.
    (
        "rv-40e-like",
        &[
            ("gear.wheels", "1"),
            ("gear.backlash_m", "1e-5"),
            ("gear.errors.crank_phase_rad", "[1e-4, 0, -2e-4, 0]"),
            ("gear.errors.hole_radius_m", "[4e-6, 0, 0, 2e-6]"),
            ("cranks.count", "4"),
            ("cranks.mesh_stiffness_n_m", "5e7"),
            ("cranks.support_stiffness_n_m", "3e8"),
            ("drive.output_torque_n_m", "-150"),
            ("solver.duration_s", "0.0002"),
        ],
    ),
    // Three discs on three cranks, with friction of contacts and of bearings.
    (
        "rv-320",
        &[
            ("gear.external_sleeves", "44"),
            ("gear.wheels", "3"),
            ("bearings.eccentric.friction_coefficient", "0.002"),
            ("bearings.eccentric.bore_m", "0.026"),
            ("contact.friction_coefficient", "0.05"),
            ("contact.friction_ramp_m_s", "0.05"),
            ("drive.output_torque_n_m", "1500"),
            ("solver.duration_s", "0.0003"),
        ],
    ),
];
/// Number of gears in every test run, 2 to 3 s of CPU each. The weekly workflow takes the other gears, 4 to 30 s each.
const OFTEN: usize = 3;

/// Engines with the shared law, with the largest relative difference of forces and torques from the first, and the largest
/// U of that pair.
///
/// Measured, the largest of all gears: D 1.4e-4, 9.5e-4 (rapier, leapfrog), 4.9e-5, 4.9e-5, 1.7e-3 (implicit steps of second order),
/// 8.3e-6, 8.3e-6; U 3.5e-3, 4.7e-3, 1.5e-3, 1.5e-3, 4.5e-3, 2.3e-4, 2.3e-4. Times 3.
const ENGINES: &[(&str, f64, f64)] = &[
    ("native-reduced", 0.0, 0.0),
    ("native-lagrange", 4e-4, 1e-2),
    ("rapier-shared-law", 3e-3, 1.4e-2),
    (MUJOCO, 1.5e-4, 4.5e-3),
    (EXPLICIT, 1.5e-4, 4.5e-3),
    (CONSTRAINED, 5e-3, 1.4e-2),
    ("simbody-shared-law", 2.5e-5, 7e-4),
    ("ida-shared-law", 2.5e-5, 7e-4),
];

/// Checks D and U of every engine from native against their limits as the load rises, over 0.5 ms or the gear's duration.
///
/// `conclusive`: no comparison may be inconclusive.
fn agree(gears: &[(&str, &[(&str, &str)])], conclusive: bool) {
    let wrong: Vec<String> = gears
        .iter()
        .flat_map(|(preset, sets)| faults(preset, sets, conclusive))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Three discs that bend output pins together, with seats, slots and a warm ring, on elastic bearings.
///
/// From balance: before the load closes slots and warm gap, 0.31 ms after a start without it, no ring pin carries anything, and the driver's
/// torque is too small to be compared.
const STRUCTURE: &[(&str, &[(&str, &str)])] = &[(
    "paper-bearings",
    &[
        ("gear.wheels", "3"),
        ("gear.face_width_m", "0.008"),
        ("bearings.internal_sleeves_held", "\"one-end\""),
        ("structure.output_pin_diameter_m", "0.006"),
        ("structure.output_seat_length_m", "0.01"),
        ("structure.ring_seat_length_m", "0.008"),
        ("structure.ring_slot_clearance_m", "2e-6"),
        ("structure.housing_material", "\"aluminium\""),
        ("contact.material", "\"steel\""),
        ("temperature.housing_k", "5"),
        ("drive.start", "\"equilibrium\""),
        ("solver.duration_s", "0.0001"),
    ],
)];

/// Ring pins that do not turn beside sleeves with both frictions, on discs that float; and output pins that do not turn. All from balance:
/// everything slides under the full load from the first step on.
const PINS: &[(&str, &[(&str, &str)])] = &[
    (
        "needle-bearings",
        &[
            ("gear.external_sleeves_turn", "false"),
            ("contact.friction_coefficient", "0.02"),
            ("contact.friction_ramp_m_s", "0.5"),
            ("drive.start", "\"equilibrium\""),
            ("solver.sample_s", "1e-6"),
            ("solver.step_s", "1e-7"),
            ("solver.duration_s", "0.00002"),
        ],
    ),
    (
        "paper-bearings",
        &[
            ("gear.internal_sleeves_turn", "false"),
            ("contact.friction_coefficient", "0.1"),
            ("contact.friction_ramp_m_s", "0.05"),
            ("drive.start", "\"equilibrium\""),
            ("solver.duration_s", "0.0001"),
        ],
    ),
];

/// The ring as output, on its bearings and on cranks, and with ring pins that it holds. Its inertia is of its size: rapier diverges where
/// the ring is light beside its pins.
const RINGS: &[(&str, &[(&str, &str)])] = &[
    (
        "paper-bearings",
        &[
            ("drive.output", "\"ring\""),
            ("drive.start", "\"equilibrium\""),
            ("mass.output_shaft.moment_kg_m2", "0.01"),
            ("gear.external_sleeves_turn", "false"),
            ("contact.friction_coefficient", "0.1"),
            ("contact.friction_ramp_m_s", "0.05"),
            ("solver.duration_s", "0.0001"),
        ],
    ),
    (
        "rv-40e-like",
        &[
            ("drive.output", "\"ring\""),
            ("drive.start", "\"equilibrium\""),
            ("solver.sample_s", "5e-6"),
            ("solver.duration_s", "0.00005"),
        ],
    ),
];

/// Contacts of their own on a ring that is the output. Measured, relative L2 of the ring pins' forces over 50 ms: 4.1e-4 and 4.9 %
/// (8.7 % of the gear on its carrier), times 3; the mean torque of colliders, 4.1 %, times 3.
#[test]
fn crossval_own_contacts_of_a_ring() {
    let sets = [
        ("drive.output", "\"ring\""),
        ("mass.output_shaft.moment_kg_m2", "0.01"),
        ("solver.duration_s", "0.05"),
    ];
    let scene = scene("paper", &sets);
    let native = run("native-reduced", &scene);
    for (engine, most) in [("rapier-own-contact-hook", 1.3e-3), (MUJOCO_OWN, 0.15)] {
        let own = run(engine, &scene);
        let off = relative(&own, &native, "external_sleeve_force_n", 0.0);
        println!("{engine}: {off:e}");
        assert!(off < most, "{engine}: {off:e}");
    }
    let mean = |series: &TimeSeries| {
        let torque = series.channel("input_torque_n_m").unwrap();
        torque.iter().sum::<f64>() / torque.len() as f64
    };
    let off = mean(&run("rapier-own-contact-colliders", &scene)) / mean(&native) - 1.0;
    println!("colliders: {off:e}");
    assert!(off.abs() < 0.12, "colliders: {off:e}");
}

#[test]
fn crossval_floating_discs() {
    agree(&[STRUCTURE, PINS, &GEARS[..2]].concat(), true);
}

#[test]
fn crossval_floating_cranks_and_rings() {
    agree(&[RINGS, &GEARS[2..OFTEN]].concat(), true);
}

#[test]
#[ignore = "weekly: 70 s for six gears more"]
fn crossval_floating_more_discs() {
    agree(&GEARS[OFTEN..], false);
}

/// Returns engines that differ from native in a gear, or exceed their limits, a line each.
fn faults(preset: &str, sets: &[(&str, &str)], conclusive: bool) -> Vec<String> {
    let gear = format!("{preset} {sets:?}");
    let base = [
        ("solver.duration_s", "0.0005"),
        ("solver.sample_s", "1e-5"),
        ("solver.step_s", "1e-6"),
        ("solver.tolerance", "1e-8"),
        ("solver.integrator", "dopri5"),
    ];
    let scene = scene(preset, &[&base, sets].concat()).check().unwrap();
    let names: Vec<&str> = ENGINES.iter().map(|(name, ..)| *name).collect();
    let input = Input {
        gearbox: &Gearbox::new(&scene).unwrap(),
        engines: &choice::engines(&names, &scene).unwrap(),
        data: &[],
    };
    let effort = Effort {
        longest: Duration::from_secs(20),
        obey: true,
        ..Effort::of(&scene)
    };
    let outcome = comparison::run_with(&input, effort, &Control::quiet()).unwrap();
    let mut wrong = Vec::new();
    for (one, (name, most_d, most_u)) in outcome.participants.iter().zip(ENGINES) {
        if let Status::Absent { reason } = &one.status {
            let required = std::env::var_os("PINWHEEL_REQUIRE_SIMBODY").is_some();
            assert!(!required, "{reason}");
            println!("skipped: {reason}");
            continue;
        }
        assert!(one.status.is_finished(), "{gear}, {name}: {:?}", one.status);
        let mut largest = [0.0_f64; 2];
        let pairs = outcome.comparison.pairs.iter();
        for pair in pairs.filter(|pair| pair.a == ENGINES[0].0 && pair.b == *name) {
            for entry in &pair.entries {
                let result = &entry.result;
                // Pins without load would test nothing.
                let idle = result.verdict == Verdict::NotCompared
                    && entry.quantity.ends_with("sleeve_force_n");
                let open = conclusive && result.verdict == Verdict::Inconclusive;
                if result.verdict == Verdict::Differ || idle || open {
                    wrong.push(format!("{gear}, {name}, {}: {result:?}", entry.quantity));
                }
                let size = |x: Option<f64>| x.map_or(0.0, f64::abs);
                largest[0] = largest[0].max(size(result.difference));
                largest[1] = largest[1].max(size(result.bound));
            }
        }
        let [d, u] = largest;
        println!("{gear}, {name}: D {d:.1e}, U {u:.1e}");
        // Without a bound nothing is resolved, and no fault would appear.
        if d > *most_d || u > *most_u || (*most_u > 0.0 && u == 0.0) {
            wrong.push(format!("{gear}, {name}: D {d:e}, U {u:e}"));
        }
    }
    // Every engine: output torque and load must match the acceleration of its output.
    for engine in &outcome.comparison.engines {
        let judged = engine.judged.iter();
        for entry in judged.filter(|entry| entry.result.verdict == Verdict::Differ) {
            let (name, quantity) = (&engine.name, &entry.quantity);
            wrong.push(format!("{gear}, {name}, {quantity}: {:?}", entry.result));
        }
    }
    wrong
}
