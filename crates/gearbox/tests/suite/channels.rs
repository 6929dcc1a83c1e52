//! Channels beyond the contract's columns: values, agreement of both formulations, cost.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::native::{self, NativeRun};
use pinwheel_scene::Layout;
use pinwheel_scene::{Override, Scales, Scene};
use pinwheel_timeseries::TimeSeries;

/// Runs a preset with channels; the last keys are overrides.
fn run(preset: &str, duration_s: f64, channels: &[&str], sets: &[(&str, &str)]) -> NativeRun {
    let mut overrides: Vec<Override> = sets
        .iter()
        .map(|(key, value)| Override::new(*key, *value))
        .collect();
    overrides.push(Override::new("solver.duration_s", duration_s.to_string()));
    let mut scene = Scene::load(preset, &overrides).unwrap().into_scene();
    scene.output.channels = channels.iter().map(|&c| c.to_owned()).collect();
    native::run(
        &Gearbox::new(&scene.clone().check().unwrap()).unwrap(),
        &mut |_| false,
    )
    .unwrap()
    .finished()
    .unwrap()
}

fn column<'a>(time_series: &'a TimeSeries, name: &str) -> &'a [f64] {
    time_series
        .channel(name)
        .unwrap_or_else(|| panic!("no column {name}"))
}

/// Returns the RMS of the difference over the larger RMS.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    let difference = square(&mut a.iter().zip(b).map(|(a, b)| a - b));
    let larger = square(&mut a.iter().copied()).max(square(&mut b.iter().copied()));
    // Two discs in phase leave only rounding on the shafts' bearings.
    if larger < 1e-18 * a.len() as f64 {
        return 0.0;
    }
    if difference == 0.0 {
        0.0
    } else {
        (difference / larger).sqrt()
    }
}

/// Reactions from multipliers (28 bodies) and by Newton's law (reduced), and all other channels, agree, including three discs
/// of another gear and friction.
#[test]
fn both_formulations_give_the_same_channels() {
    for (preset, sets) in [
        ("paper", &[][..]),
        ("eleven-pins", &[("drive.load_ramp_s", "0.01")]),
        ("one-wheel", &[]),
        (
            "paper-friction",
            &[("solver.step_s", "1e-7"), ("solver.integrator", "rk2")],
        ),
        ("paper-rough", &[("solver.integrator", "imex2")]),
        ("backlash-0.6", &[("contact.detection", "points")]),
    ] {
        let duration = if preset == "paper-friction" {
            0.002
        } else {
            0.02
        };
        let reduced = run(preset, duration, &["*"], sets);
        let mut sets = sets.to_vec();
        sets.push(("solver.formulation", "lagrange"));
        let lagrange = run(preset, duration, &["*"], &sets);
        assert_eq!(
            reduced.time_series.channels().len(),
            lagrange.time_series.channels().len()
        );
        let mut worst: (f64, &str) = (0.0, "");
        for channel in reduced.time_series.channels() {
            let off = apart(
                &channel.values,
                column(&lagrange.time_series, &channel.name),
            );
            if !(off <= worst.0) {
                worst = (off, &channel.name);
            }
        }
        println!("{preset}: {worst:?}");
        // Differences are rounding: measured 2e-13 to 7e-11 (an efficiency near a zero of the driver torque).
        assert!(worst.0 < 1e-9, "{preset}: {worst:?}");
    }
}

/// Relative tolerance of pressures that follow from K and the force.
const HERTZ: f64 = 1e-9;

/// Channels are consistent with each other and with the contract's columns at every sample.
#[test]
fn channels_fit_together() {
    let run = run(
        "eleven-pins",
        0.02,
        &["*"],
        &[("contact.friction_coefficient", "0.05")],
    );
    let scene = Scene::load("eleven-pins", &[]).unwrap();
    let gearbox = Gearbox::new(&scene).unwrap();
    let pressing_n = Scales::of(&scene).pressing_n();
    // p0 K/sqrt(F) = k sqrt(E*/(pi L)), with k from a hole's K, and p0's formula written out.
    let (gear, contact) = (&scene.gear, &scene.contact);
    let modulus = contact.young_pa / (2.0 * (1.0 - contact.poisson.powi(2)));
    let (hole, pin) = (gear.hole_radius_m, gear.internal_sleeve_radius_m);
    let of_hole = column(&run.time_series, "wheel_0_internal_stiffness_n_m15_0")[0];
    let hertz = of_hole / (hole * pin / (hole - pin)).sqrt()
        * (modulus / (std::f64::consts::PI * contact.line_length_m)).sqrt();
    let Layout {
        wheels,
        external_sleeves,
        internal_sleeves,
    } = gearbox.layout;
    let c = &run.time_series;
    let near = |a: f64, b: f64, scale: f64, what: &str| {
        assert!((a - b).abs() <= 1e-12 * scale, "{what}: {a} {b}");
    };
    let (mut twist, mut of_wheels) = (0.0, vec![0.0; wheels]);
    for k in 0..c.len() {
        let at = |name: &str| column(c, name)[k];
        // The driver's torque balances the eccentrics' reactions.
        let torque: f64 = (0..wheels)
            .map(|w| at(&format!("eccentric_bearing_tangential_force_n_{w}")))
            .sum();
        near(
            scene.gear.eccentricity_m * torque,
            at("input_torque_n_m"),
            1.0,
            "driver",
        );
        let input = ["input_bearing_force_x_n", "input_bearing_force_y_n"];
        let eccentric = ["eccentric_bearing_force_x_n", "eccentric_bearing_force_y_n"];
        for (shaft, wheel) in input.iter().zip(eccentric) {
            let sum: f64 = (0..wheels).map(|w| at(&format!("{wheel}_{w}"))).sum();
            near(at(shaft), sum, 1e3, shaft);
        }
        for (w, phase) in gearbox.geometry.wheel_phases.iter().enumerate() {
            let of = |part: &str| at(&format!("eccentric_bearing_{part}_{w}"));
            let (sin, cos) = (scene.drive.input_speed_rad_s * c.time_s()[k] + phase).sin_cos();
            let radial = cos * of("force_x_n") + sin * of("force_y_n");
            near(of("radial_force_n"), radial, 1e3, "radial");
        }
        // The reaction of a ring pin balances its contacts.
        for j in 0..external_sleeves {
            let pin = at(&format!("external_pin_force_n_{j}"));
            near(pin, at(&format!("external_sleeve_force_n_{j}")), 1e3, "pin");
        }
        let mut pressing = vec![[0.0; 2]; wheels];
        for (kind, count) in [
            ("external", external_sleeves),
            ("internal", internal_sleeves),
        ] {
            for j in 0..count {
                for (w, pressing) in pressing.iter_mut().enumerate() {
                    let of = |q: &str| at(&format!("wheel_{w}_{kind}_{q}_{j}"));
                    let (depth, force) = (of("penetration_m"), of("normal_force_n"));
                    assert!(depth > 0.0 || (force == 0.0 && of("friction_force_n") == 0.0));
                    assert!(force >= 0.0 && of("stiffness_n_m15") > 1e6);
                    assert!(of("friction_force_n").abs() <= 0.05 * force * (1.0 + 1e-12));
                    assert!(of("friction_force_n") * of("tangential_velocity_m_s") <= 0.0);
                    pressing[usize::from(kind == "internal")] += f64::from(force > pressing_n);
                    let (pressure, sliding) = (of("pressure_pa"), of("tangential_velocity_m_s"));
                    let product = of("pressure_sliding_w_m2");
                    near(product, pressure * sliding.abs(), 1e9, "p v");
                    // By Hertz' law K grows with the root of the radius and the pressure falls with it; the radius of holes is
                    // known.
                    if kind == "external" && force > 1.0 {
                        let actual = pressure * of("stiffness_n_m15") / force.sqrt();
                        assert!((actual / hertz - 1.0).abs() < HERTZ, "{actual} {hertz}");
                    }
                }
            }
        }
        for (w, [external, internal]) in pressing.iter().enumerate() {
            assert_eq!(at(&format!("external_contact_ratio_{w}")), *external);
            assert_eq!(at(&format!("internal_contact_ratio_{w}")), *internal);
        }
        let (power_in, power_out) = (at("input_power_w"), at("output_power_w"));
        near(
            power_in,
            at("input_torque_n_m") * scene.drive.input_speed_rad_s,
            1e2,
            "power",
        );
        if power_in > 0.0 {
            near(
                at("efficiency"),
                power_out / power_in,
                at("efficiency").abs().max(1.0),
                "efficiency",
            );
        }
        let ratio = external_sleeves as f64 - 1.0;
        let ideal = -scene.drive.input_speed_rad_s * c.time_s()[k] / ratio;
        let error = (at("output_angle_rad") - ideal).to_degrees() * 60.0;
        near(
            at("transmission_error_arcmin"),
            error,
            1.0,
            "transmission error",
        );
        assert!(at("damping_loss_w") >= 0.0 && at("friction_loss_w") >= 0.0);
        if k > 0 && k + 1 < c.len() {
            let around = |name: &str| [k - 1, k + 1].map(|k| column(c, name)[k]);
            let [before, after] = around("output_angle_rad");
            let rate = (after - before) / (c.time_s()[k + 1] - c.time_s()[k - 1]);
            let expected = at("output_torque_n_m") * rate;
            let slack = 0.05 * expected.abs() + 1.0;
            assert!(
                (power_out - expected).abs() < slack,
                "{power_out} {expected}"
            );
            twist += error;
            for (w, own) in of_wheels.iter_mut().enumerate() {
                *own += at(&format!("wheel_transmission_error_arcmin_{w}"));
            }
        }
    }
    // The load rotates the discs in their mesh, and the output by as much again in the holes.
    for own in of_wheels {
        let share = own / twist;
        assert!((0.3..0.6).contains(&share), "{share}");
    }
}

/// The normal velocity is the rate of the penetration, in contact and without, and single contacts follow the scene's contact
/// law (Eq. 20).
#[test]
fn velocity_is_the_rate_of_the_penetration() {
    for detection in ["exact", "points"] {
        let sets = [
            ("solver.sample_s", "1e-6"),
            ("solver.step_s", "1e-6"),
            ("contact.detection", detection),
        ];
        let pair = ["wheel_1_external_*_3", "wheel_0_internal_*_2"];
        let run = run("backlash-0.6", 0.004, &pair, &sets);
        let c = &run.time_series;
        for kind in ["wheel_1_external_{}_3", "wheel_0_internal_{}_2"] {
            let of = |q: &str| column(c, &kind.replace("{}", q));
            let (depth, rate) = (of("penetration_m"), of("normal_velocity_m_s"));
            let (force, stiffness) = (of("normal_force_n"), of("stiffness_n_m15"));
            for k in 1..c.len() - 1 {
                let contact = depth[k].max(0.0);
                let law =
                    (contact / 1e-5).min(1.0) * (stiffness[k] * contact.powf(1.5) + 8.0 * rate[k]);
                assert!((force[k] - law.max(0.0)).abs() <= 1e-9 * law.abs().max(1.0));
                if detection == "exact" {
                    let slope = (depth[k + 1] - depth[k - 1]) / 2e-6;
                    // Accelerations of some 100 m/s^2 at 1.2 kHz leave an error of 1e-7 m/s in a central difference.
                    assert!(
                        (slope - rate[k]).abs() < 1e-5 * (1.0 + rate[k].abs()),
                        "{kind} {k}: {slope} {}",
                        rate[k]
                    );
                }
            }
        }
    }
}

/// Moments about the eccentric: the tangential part of the eccentric bearing's force is T_wheel/(e zs) for a law with a
/// potential, and the mean of the contact ratio of the paper's gear is 8 to 9 of 16 pins.
#[test]
fn published_bearing_force_and_contact_ratio() {
    let channels = ["eccentric_bearing_*", "external_contact_ratio_*"];
    let sets = [
        ("contact.law", "paper-conservative"),
        ("drive.start", "equilibrium"),
    ];
    let run = run("paper", 0.24, &channels, &sets);
    let mean = |name: &str| {
        // Complete cycles of the external mesh, order 16 of the input's 8.33 Hz.
        let values = &column(&run.time_series, name)[1200..];
        values.iter().sum::<f64>() / values.len() as f64
    };
    for wheel in 0..2 {
        let tangential = mean(&format!("eccentric_bearing_tangential_force_n_{wheel}"));
        let exact = 11.0 / (0.0028 * 15.0);
        assert!(
            (tangential / exact - 1.0).abs() < 1e-3,
            "{tangential} {exact}"
        );
        let ratio = mean(&format!("external_contact_ratio_{wheel}"));
        assert!((7.5..=9.0).contains(&ratio), "{ratio}");
    }
}

/// A channel that is not requested costs nothing, and a requested one changes no step: the time series are equal bit for bit.
#[test]
fn asking_changes_no_step() {
    for sets in [
        &[][..],
        &[("solver.integrator", "dopri5")],
        &[("solver.formulation", "lagrange")],
        &[
            ("contact.friction_coefficient", "0.1"),
            ("solver.integrator", "imex2"),
        ],
    ] {
        let plain = run("paper", 0.01, &[], sets);
        let asked = run("paper", 0.01, &["*"], sets);
        assert_eq!(plain.counts, asked.counts);
        let contract = plain.time_series.channels();
        assert_eq!(contract, &asked.time_series.channels()[..contract.len()]);
        assert!(asked.time_series.channels().len() > 500);
    }
}
