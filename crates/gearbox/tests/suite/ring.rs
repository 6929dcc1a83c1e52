//! Ring as output and fixed carrier: against the carrier as output in a rotated frame, and statics against runs.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::PairContact;
use pinwheel_gearbox::cosimulation::{CoSimulation, Setup};
use pinwheel_gearbox::native::{self, NativeRun};
use pinwheel_gearbox::statics::{Equilibrium, Statics};
use pinwheel_scene::{Override, Scene, Sleeve};
use pinwheel_timeseries::TimeSeries;

const RING: &str = "drive.output=ring";
const KINDS: [&str; 2] = ["external_sleeve_force_n", "internal_sleeve_force_n"];
/// Gears with rigid eccentrics, on elastic bearings, with a plate, and on cranks.
const GEARS: [(&str, &[&str]); 4] = [
    ("paper", &[]),
    ("paper-bearings", &[]),
    (
        "forty-pins",
        &[
            "structure.plate_thickness_m=0.01",
            "structure.plate_radius_m=0.05",
        ],
    ),
    ("rv-40e-like", &[]),
];

fn gearbox(preset: &str, sets: &[&str]) -> Gearbox {
    let sets: Vec<Override> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Gearbox::new(&Scene::load(preset, &sets).unwrap()).unwrap()
}

fn run(gearbox: &Gearbox) -> NativeRun {
    let run = native::run(gearbox, &mut |_| false).unwrap();
    run.finished().unwrap()
}

/// Returns the moments of the forces on ring pins, and on output pins or cranks, about the gear's axis, N m.
fn moments(pairs: &[PairContact]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for pair in pairs {
        let ([x, y], [fx, fy]) = (pair.centre, pair.force_on_sleeve());
        sums[usize::from(matches!(pair.sleeve, Sleeve::Internal(_)))] += x * fy - y * fx;
    }
    sums
}

/// Forces on the ring pins balance the load. With the carrier as output, the moment of its output pins as load and the input angle
/// relative to the ring, the gear has an equal equilibrium.
#[test]
fn crossval_statics_of_a_ring_is_that_of_the_carrier() {
    for (preset, sets) in GEARS.into_iter().take(3) {
        let ring = gearbox(preset, &[sets, &[RING]].concat());
        let own = gearbox(preset, sets);
        let torque = ring.scene.drive.output_torque_n_m;
        let load = ring.along_carrier_n_m(torque);
        let (mut statics, mut other) = (Statics::new(&ring).unwrap(), Statics::new(&own).unwrap());
        for phi in [0.0, 0.3, 1.7] {
            let at = statics.solve(phi, load).unwrap();
            let [on_ring, on_carrier] = moments(&statics.touching(&at));
            assert!(
                (on_ring / -torque - 1.0).abs() < 1e-8,
                "{preset}: {on_ring} {torque}"
            );
            let held = other.solve(phi + at.output, -on_carrier).unwrap();
            let off = (held.output - at.output).abs() / ring.error_scales().angle;
            assert!(off < 1e-7, "{preset}: {off:e}");
        }
        let less = ring.scene.carrier_moment_per_output();
        let [a, b] = [&ring, &own].map(|gearbox| gearbox.flange_twist_rad(1.0));
        assert!((a - b * less * less).abs() <= 1e-15 * b, "{a} {b}");
    }
}

/// Equilibria of an RV gear with a rotating case, by the virtual work of load and input.
#[test]
fn crossval_statics_of_a_case_that_turns() {
    let (ring, own) = (gearbox("rv-40e-like", &[RING]), gearbox("rv-40e-like", &[]));
    let torque = ring.scene.drive.output_torque_n_m;
    assert_eq!(ring.scene.ratio(), 120.0);
    let less = ring.scene.carrier_moment_per_output();
    assert!((less - 121.0 / 120.0).abs() < 1e-14);
    let (mut statics, mut other) = (Statics::new(&ring).unwrap(), Statics::new(&own).unwrap());
    let at = statics.solve(0.4, ring.along_carrier_n_m(torque)).unwrap();
    let [on_ring, _] = moments(&statics.touching(&at));
    assert!((on_ring / -torque - 1.0).abs() < 1e-8, "{on_ring} {torque}");
    // Tooth forces of the first stage are not listed, so the carrier's moment is that of the ideal mesh, to the transmission error.
    let held = other.solve(0.4 + at.output, -less * torque).unwrap();
    let twist = |gearbox: &Gearbox, at: &Equilibrium, phi: f64| {
        at.output - gearbox.geometry.ideal_output_angle(phi)
    };
    let (a, b) = (twist(&ring, &at, 0.4), twist(&own, &held, 0.4 + at.output));
    println!("{a:e} {b:e} {:e}", a / b * less - 1.0);
    assert!((a / b / less - 1.0).abs() < 1e-3, "{a:e} {b:e}");
}

/// A run that starts in equilibrium stays in slow motion, and the torque on the ring equals its load.
#[test]
fn crossval_a_ring_starts_in_balance() {
    for (preset, sets) in GEARS {
        let more = ["solver.duration_s=0.002", "solver.integrator=auto", RING];
        let unsteady = |start: &str| {
            let start = format!("drive.start={start}");
            let gearbox = gearbox(preset, &[sets, &more, &[start.as_str()]].concat());
            let load = gearbox.scene.drive.output_torque_n_m;
            let series = run(&gearbox).time_series;
            let torque = series.channel("output_torque_n_m").unwrap();
            torque
                .iter()
                .map(|t| (t / -load - 1.0).abs())
                .fold(0.0, f64::max)
        };
        let [knock, still] = ["kinematic", "equilibrium"].map(unsteady);
        println!("{preset}: {knock:e} {still:e}");
        assert!(knock > 0.5 && still < 0.05, "{preset}: {knock} {still}");
    }
}

/// A ring as output against the carrier as output, in the ring's frame. With a large output inertia the frame rotates
/// uniformly, and speed and load times zs/zk give equal contact forces. With the scene's inertia the driver's mean torque is
/// load/zk, and the account closes.
#[test]
fn crossval_a_ring_as_output_is_a_turned_frame() {
    let run = |sets: &[&str]| {
        let always = [
            "solver.integrator=dopri5",
            "solver.tolerance=1e-9",
            "contact.law=paper-conservative",
        ];
        run(&gearbox("paper", &[&always, sets].concat()))
    };
    let heavy = [
        "mass.output_shaft.moment_kg_m2=1e5",
        "gear.modification.equidistant_m=-1e-5",
        "gear.errors.internal_sleeve_tangential_m=[1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5]",
        "solver.duration_s=0.004",
    ];
    let ring = ["drive.output=ring", "drive.input_speed_rad_s=-52.34"];
    let carrier = [
        "drive.input_speed_rad_s=-49.06875",
        "drive.output_torque_n_m=-20.625",
    ];
    let friction = ["contact.friction_coefficient=0.05"];
    for more in [&[][..], &friction] {
        let [ring, carrier] =
            [ring, carrier].map(|sets| run(&[&heavy[..], &sets, more].concat()).time_series);
        for kind in KINDS {
            let (a, b) = (ring.group(kind), carrier.group(kind));
            let size = b
                .iter()
                .flat_map(|c| c.iter())
                .fold(0.0, |most: f64, x| most.max(*x));
            assert!(size > 1.0, "{kind}: {size}");
            for (a, b) in a
                .iter()
                .flat_map(|c| c.iter())
                .zip(b.iter().flat_map(|c| c.iter()))
            {
                assert!((a - b).abs() < 1e-5 * size, "{kind}: {a} {b}");
            }
        }
    }
    let free = run(&[
        "drive.output=ring",
        "drive.input_speed_rad_s=-52.34",
        "solver.duration_s=0.3",
    ]);
    let audit = free.energy.total().unwrap();
    assert!(audit.remainder_share.unwrap().abs() < 1e-6, "{audit:?}");
    let torque = free.time_series.window(0.25, 0.3);
    let torque = &free.time_series.channel("output_torque_n_m").unwrap()[torque];
    let mean = torque.iter().sum::<f64>() / torque.len() as f64;
    assert!((mean / -22.0 - 1.0).abs() < 5e-3, "{mean}");
    let angle = free.time_series.channel("output_angle_rad").unwrap();
    assert!((angle.last().unwrap() / (-52.34 * 0.3 / 16.0) - 1.0).abs() < 1e-2);
    let late = free.energy.audit(0.2, 0.3).unwrap();
    let ideal = -22.0 * 52.34 * 0.1 / 16.0;
    // Measured 3.5e-3 and 1.3e-3: the start still oscillates.
    assert!(
        (late.load_j / ideal - 1.0).abs() < 5e-3 && (late.driver_j / -ideal - 1.0).abs() < 5e-3
    );
}

/// Forces of an RV gear with a rotating case equal those with the carrier as output, with speed and load times R/(R - 1). The output
/// is so heavy that it rotates uniformly, and centrifugal forces are negligible. Measured 3.4e-8 of the ring pins' force.
#[test]
fn crossval_a_case_that_turns_is_a_turned_frame() {
    let always = [
        "solver.integrator=dopri5",
        "solver.tolerance=1e-11",
        "mass.output_shaft.moment_kg_m2=1e6",
        "solver.duration_s=0.0005",
        "drive.input_speed_rad_s=1.9",
        "gear.modification.equidistant_m=-5e-6",
    ];
    let of = |more: &[&str]| run(&gearbox("rv-40e-like", &[&always, more].concat())).time_series;
    let ring = of(&[RING, "drive.output_torque_n_m=-412"]);
    let carrier = of(&[
        "drive.input_speed_rad_s=1.9158333333333333",
        "drive.output_torque_n_m=415.43333333333334",
    ]);
    let largest = |series: &TimeSeries| {
        let forces = series.group(KINDS[0]).concat();
        forces.into_iter().fold(0.0, f64::max)
    };
    let size = largest(&carrier);
    for kind in KINDS {
        let [a, b] = [&ring, &carrier].map(|series| series.group(kind).concat());
        let off = a.iter().zip(&b).map(|(a, b)| (a - b).abs() / size);
        let off = off.fold(0.0, f64::max);
        assert!(size > 1.0 && off < 1e-6, "{kind}: {off:e} of {size}");
    }
}

/// A unit of the gear moves like its run.
#[test]
fn crossval_a_unit_whose_ring_turns() {
    let gear = gearbox(
        "paper",
        &[RING, "solver.duration_s=0.005", "solver.integrator=dopri5"],
    );
    let series = run(&gear).time_series;
    let mut unit = CoSimulation::new(&gear, Setup::of(&gear.scene.drive)).unwrap();
    unit.advance(0.005, &|| false).unwrap();
    let mut row = Vec::new();
    unit.observe(&mut row);
    for (channel, actual) in series.channels().iter().zip(&row) {
        let wanted = channel.values.last().unwrap();
        assert!(
            (wanted - actual).abs() <= 1e-6 * wanted.abs().max(1.0),
            "{} {wanted} {actual}",
            channel.name
        );
    }
}

#[test]
fn bad_input_a_ring_with_what_it_does_not_go_with() {
    for (set, part) in [
        ("solver.integrator=imex2", "solver.integrator"),
        ("bearings.output_seal_n_m=0.1", "output_seal_n_m"),
    ] {
        let sets = [RING, set].map(|set| set.parse().unwrap());
        let line = Scene::load("paper", &sets)
            .map(|_| ())
            .unwrap_err()
            .to_string();
        assert!(
            line.contains(part) && line.contains("by its carrier"),
            "{line}"
        );
    }
}
