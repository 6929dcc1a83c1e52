//! Elastic structure and warm parts, in statics and in runs.

use pinwheel_gearbox::statics::{Equilibrium, Statics};
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_mbs::Wrench;
use pinwheel_scene::{Scene, Sleeve};

/// Pins of 5 mm held at one end, bent by discs of 8 mm.
const PINS: [&str; 4] = [
    "structure.output_pin_diameter_m=0.005",
    "bearings.internal_sleeves_held=\"one-end\"",
    "bearings.internal_sleeve_gap_m=5e-4",
    "gear.face_width_m=0.008",
];
/// Rollers on steel.
const STEEL: [&str; 3] = [
    "contact.law=\"line-hertz\"",
    "contact.stiffness_multiplier=1",
    "contact.line_length_m=0.008",
];

fn gearbox(sets: &[&str]) -> Gearbox {
    let sets: Vec<_> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Gearbox::new(&Scene::load("paper", &sets).unwrap()).unwrap()
}

fn balanced(gearbox: &Gearbox, phi: f64) -> Equilibrium {
    Statics::new(gearbox)
        .unwrap()
        .solve(phi, gearbox.load_torque(0.0))
        .unwrap()
}

/// Returns the sum of the forces of output pins on each disc.
fn carried(gearbox: &Gearbox, at: &Equilibrium) -> Vec<f64> {
    let mut sums = vec![0.0; gearbox.layout.wheels];
    for pair in Statics::new(gearbox).unwrap().touching(at) {
        if let Sleeve::Internal(_) = pair.sleeve {
            sums[pair.wheel] += pair.normal_force_n;
        }
    }
    sums
}

/// Returns the rotation of the output from its ideal mesh.
fn twist(gearbox: &Gearbox, phi: f64) -> f64 {
    balanced(gearbox, phi).output - gearbox.geometry.ideal_output_angle(phi)
}

fn close(actual: f64, wanted: f64, tolerance: f64) {
    assert!(
        (actual / wanted - 1.0).abs() < tolerance,
        "{actual} for {wanted}"
    );
}

/// A bending pin of one disc equals a spring in series, which has its own key and its own loop over the pairs.
#[test]
fn published_one_disc_bends_a_spring() {
    let one = [&STEEL[..], &["gear.wheels=1"]].concat();
    let shared = gearbox(&[&one[..], &PINS].concat());
    let own = 1.0 / shared.scene.pin_influence_m_n().unwrap()[0][0];
    let spring = format!("bearings.internal_sleeve_stiffness_n_m={own}");
    let spring = gearbox(&[&one[..], &[&spring]].concat());
    for phi in [0.0, 0.3, 2.0] {
        close(twist(&shared, phi), twist(&spring, phi), 1e-10);
    }
    // Rigid pins twist less.
    assert!(twist(&gearbox(&one), 0.3).abs() < 0.8 * twist(&shared, 0.3).abs());
}

/// Forces and moments of discs with shared pins are the derivatives of the stored energy, which their solver does not use.
#[test]
fn published_forces_of_shared_pins_are_the_slope_of_the_energy() {
    for held in ["one-end", "both-ends"] {
        let held = format!("bearings.internal_sleeves_held=\"{held}\"");
        let sets = [&STEEL[..], &PINS, &["gear.wheels=3", &held]].concat();
        let gearbox = gearbox(&sets);
        let mut field = gearbox.bare_field().unwrap();
        let mut bodies = balanced(&gearbox, 0.4).bodies;
        let mut loads = vec![Wrench::default(); bodies.len()];
        field.add_loads(&bodies, &mut loads);
        for disc in gearbox.layout.wheel_bodies() {
            let Wrench { fx, fy, moment } = loads[disc];
            // Displacement so small that no contact opens.
            let wanted = [(fx, 2e-11), (fy, 2e-11), (moment, 2e-10)];
            for (axis, (force, step)) in wanted.into_iter().enumerate() {
                let mut energy = |by: f64| {
                    let kept = bodies[disc];
                    let body = &mut bodies[disc];
                    *[&mut body.x, &mut body.y, &mut body.angle][axis] += by;
                    let stored = field.energy(&bodies).stored_j;
                    bodies[disc] = kept;
                    stored
                };
                let slope = (energy(-step) - energy(step)) / (2.0 * step);
                let size = if axis == 2 { 10.0 } else { 300.0 };
                assert!(
                    (slope - force).abs() < 2e-5 * size,
                    "{axis}: {slope} {force}"
                );
            }
        }
    }
}

/// A disc nearer to the flange carries more, because its pins are shorter. Two discs: 741 and 124 N.
#[test]
fn regress_the_near_disc_takes_more() {
    for wheels in [2, 3] {
        let count = format!("gear.wheels={wheels}");
        let gear = gearbox(&[&STEEL[..], &PINS, &[&count]].concat());
        let sums = carried(&gear, &balanced(&gear, 0.4));
        println!("{wheels}: {sums:?}");
        for pair in sums.windows(2) {
            assert!(
                pair[0] > 1.1 * pair[1] && pair[0] < 10.0 * pair[1],
                "{sums:?}"
            );
        }
    }
}

/// Seat and contact as linear springs equal one spring of 1/k = 1/k1 + 1/k2, in a run, too.
#[test]
fn published_seat_in_series() {
    let linear = [
        "contact.law=\"linear\"",
        "contact.internal_spring_n_m=3e8",
        "drive.start=\"equilibrium\"",
        "solver.duration_s=2e-3",
        "solver.integrator=\"etd-adams\"",
        "solver.tolerance=1e-9",
    ];
    let seated = gearbox(
        &[
            &linear[..],
            &[
                "contact.external_spring_n_m=2e8",
                "structure.ring_seat_length_m=0.01",
            ],
        ]
        .concat(),
    );
    let seat = seated.scene.ring_seat_n_m().unwrap();
    let stiffness = format!(
        "contact.external_spring_n_m={}",
        1.0 / (1.0 / 2e8 + 1.0 / seat)
    );
    let in_series = gearbox(&[&linear[..], &[&stiffness]].concat());
    for phi in [0.0, 0.3] {
        close(twist(&seated, phi), twist(&in_series, phi), 1e-10);
    }
    let [one, other] = [&seated, &in_series].map(|gear| {
        let run = native::run(gear, &mut |_| false).unwrap();
        run.finished().unwrap().time_series
    });
    // The damper acts on the contact's share of the rate in one gear, and on all of it in the other.
    let off = seated.distance(&one, &other);
    println!("{off:?}");
    assert!(off.forces < 1e-2, "{off:?}");
}

/// A warm ring equals a larger ring, and a slot clearance a thinner disc.
#[test]
fn published_a_warm_ring_has_backlash() {
    let material = "contact.material=\"steel\"";
    let warm = gearbox(
        &[
            &STEEL[..],
            &[
                material,
                "structure.housing_material=\"aluminium\"",
                "temperature.housing_k=20",
            ],
        ]
        .concat(),
    );
    let backlash = format!("gear.backlash_m={}", 0.064 * 20.0 * 2.3e-5);
    let slot = gearbox(&[&STEEL[..], &["structure.ring_slot_clearance_m=1e-5"]].concat());
    let cut = gearbox(&[&STEEL[..], &["gear.modification.equidistant_m=1e-5"]].concat());
    let cold = gearbox(&STEEL);
    let large = gearbox(&[&STEEL[..], &[&backlash]].concat());
    close(twist(&warm, 0.3), twist(&large, 0.3), 1e-9);
    close(twist(&slot, 0.3), twist(&cut, 0.3), 1e-9);
    assert!(twist(&warm, 0.3).abs() > 5.0 * twist(&cold, 0.3).abs());
    // A disc warmer than its ring is clamped: all pins press, with larger forces.
    let hot = gearbox(&[&STEEL[..], &[material, "temperature.disc_k=10"]].concat());
    let touching = |gear: &Gearbox| {
        let pairs = Statics::new(gear).unwrap().touching(&balanced(gear, 0.3));
        let ring = pairs
            .iter()
            .filter(|pair| matches!(pair.sleeve, Sleeve::External(_)));
        let forces: Vec<f64> = ring.map(|pair| pair.normal_force_n).collect();
        (forces.len(), forces.iter().copied().fold(0.0, f64::max))
    };
    let [(cold, least), (hot, most)] = [&cold, &hot].map(touching);
    println!("{cold} pins {least} N cold, {hot} pins {most} N hot");
    assert!(hot == 32 && cold < 20 && most > 2.0 * least);
}

/// A slow run agrees with statics at every sample.
#[test]
fn crossval_a_run_stands_where_statics_does() {
    let sets = [
        &STEEL[..],
        &PINS,
        &[
            "gear.wheels=3",
            "structure.ring_seat_length_m=0.008",
            "structure.ring_slot_clearance_m=2e-6",
            "structure.output_seat_length_m=0.01",
            "contact.material=\"steel\"",
            "temperature.housing_k=5",
            "drive.input_speed_rad_s=5",
            "drive.start=\"equilibrium\"",
            "solver.integrator=\"auto\"",
            "solver.duration_s=4e-3",
            "solver.sample_s=1e-3",
        ],
    ]
    .concat();
    let gearbox = gearbox(&sets);
    let run = native::run(&gearbox, &mut |_| false).unwrap();
    let run = run.finished().unwrap().time_series;
    let mut statics = Statics::new(&gearbox).unwrap();
    let (angles, times) = (run.channel("output_angle_rad").unwrap(), run.time_s());
    for (angle, time) in angles.iter().zip(times) {
        let phi = 5.0 * time;
        let balanced = statics.solve(phi, gearbox.load_torque(0.0)).unwrap().output;
        let twist = balanced - gearbox.geometry.ideal_output_angle(phi);
        assert!(
            (angle - balanced).abs() < 2e-3 * twist.abs(),
            "{time}: {angle} {balanced} {twist}"
        );
    }
}
