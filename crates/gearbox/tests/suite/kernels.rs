//! The contact loop in lanes against the scalar loop, and both against closest points by brute force.

#[path = "../../../contact/tests/suite/brute/mod.rs"]
mod brute;

use pinwheel_contact::Complex;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::{ContactEnergy, ContactField, Kernel, PairContact};
use pinwheel_mbs::{BodyState, Evaluation, Pose, Wrench};
use pinwheel_scene::{CheckedScene, Layout, Override, Scene, Sleeve};
use proptest::prelude::*;

/// All loops except the scalar one.
const LANES: [Kernel; 3] = [Kernel::Lanes, Kernel::Avx2, Kernel::Portable];

fn gearbox(preset: &str, sets: &[(&str, &str)]) -> Gearbox {
    let sets: Vec<_> = sets.iter().map(|&(k, v)| Override::new(k, v)).collect();
    Gearbox::new(&Scene::load(preset, &sets).unwrap()).unwrap()
}

/// Returns the loads by one loop.
fn loads(gearbox: &Gearbox, kernel: Kernel, bodies: &[BodyState]) -> Vec<Wrench> {
    let mut gearbox = gearbox.clone();
    gearbox.kernel = kernel;
    let mut loads = vec![Wrench::default(); bodies.len()];
    gearbox
        .contact_field()
        .unwrap()
        .add_loads(bodies, &mut loads);
    loads
}

/// Returns the touching pairs and energies by one loop.
fn pairs(
    gearbox: &Gearbox,
    kernel: Kernel,
    bodies: &[BodyState],
) -> (Vec<PairContact>, ContactEnergy) {
    let mut gearbox = gearbox.clone();
    gearbox.kernel = kernel;
    let mut field = gearbox.contact_field().unwrap();
    let mut list = Vec::new();
    field.touching(bodies, &mut |pair| list.push(*pair));
    (list, field.energy(bodies))
}

/// Returns loads and energies in lanes from one pass.
fn both(gearbox: &Gearbox, kernel: Kernel, bodies: &[BodyState]) -> (Vec<Wrench>, ContactEnergy) {
    let mut gearbox = gearbox.clone();
    gearbox.kernel = kernel;
    let mut loads = vec![Wrench::default(); bodies.len()];
    let mut field = gearbox.contact_field().unwrap();
    let mut request = Evaluation::of_loads(&mut loads).with_energy();
    field.evaluate(bodies, &mut request);
    let energy = request.energy.unwrap();
    (loads, energy)
}

/// Returns energy, with moments and loads, from angles and rates; `None` if the field does not provide it.
fn from_angles(
    field: &mut ContactField,
    bodies: &[BodyState],
    moments: &mut [f64],
    loads: &mut [Wrench],
) -> Option<ContactEnergy> {
    let mut request = Evaluation {
        loads: Some(loads),
        ..Evaluation::of_moments(moments).with_energy()
    };
    field.work_from_angles().then(|| {
        field.evaluate(bodies, &mut request);
        request.energy.unwrap()
    })
}

/// Returns moments about the pins, and loads with energies, from angles and rates.
fn held(
    gearbox: &Gearbox,
    kernel: Kernel,
    bodies: &[BodyState],
) -> Option<(Vec<f64>, Vec<Wrench>, ContactEnergy)> {
    let mut gearbox = gearbox.clone();
    gearbox.kernel = kernel;
    let mut field = gearbox.contact_field().unwrap();
    let mut loads = vec![Wrench::default(); bodies.len()];
    let mut moments = vec![0.0; bodies.len()];
    let known = field.work_from_angles();
    if known {
        field.evaluate(bodies, &mut Evaluation::of_moments(&mut moments));
    }
    let mut request = Evaluation {
        pose: Pose::Prescribed,
        ..Evaluation::of_loads(&mut loads).with_energy()
    };
    field.evaluate(bodies, &mut request);
    let energy = request.energy.unwrap();
    let (mut all, mut written) = (vec![0.0; bodies.len()], loads.clone());
    written.fill(Wrench::default());
    let held = from_angles(&mut field, bodies, &mut all, &mut written);
    assert_eq!(held, known.then_some(energy));
    if known {
        assert_eq!(written, loads, "one way to the loads");
        // Moments alone agree, except for the input's.
        let largest = all.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        moments[Layout::INPUT] = all[Layout::INPUT];
        for (a, b) in moments.iter().zip(&all) {
            assert!((a - b).abs() <= 1e-12 * largest, "{a} {b}");
        }
    }
    known.then_some((moments, loads, energy))
}

/// Returns the moments of these loads about the pins of input, output and discs.
fn moments(gearbox: &Gearbox, bodies: &[BodyState], loads: &[Wrench]) -> Vec<f64> {
    let mut moments: Vec<f64> = loads.iter().map(|load| load.moment).collect();
    for body in gearbox.layout.internal_bodies() {
        let (at, load) = (bodies[body], loads[body]);
        moments[Layout::OUTPUT] += at.x * load.fy - at.y * load.fx;
    }
    for body in gearbox.layout.wheel_bodies() {
        let (at, load) = (bodies[body], loads[body]);
        moments[Layout::INPUT] += at.x * load.fy - at.y * load.fx;
    }
    moments.truncate(gearbox.layout.wheel_bodies().end);
    moments
}

/// Returns initial states advanced by the input angle, with every disc and the output twisted by up to `twist`.
fn states(gearbox: &Gearbox, input: f64, twist: f64, rates: &[f64]) -> Vec<BodyState> {
    let mut bodies = gearbox.initial_states();
    let (layout, geometry) = (gearbox.layout, &gearbox.geometry);
    let e = gearbox.scene.gear.eccentricity_m;
    let noise = |k: usize| rates[k % rates.len()];
    (bodies[Layout::INPUT].angle, bodies[Layout::INPUT].rate) = (input, 52.34);
    bodies[Layout::OUTPUT].rate = -3.4;
    for (i, body) in layout.wheel_bodies().enumerate() {
        let (s, c) = (input + geometry.wheel_phases[i]).sin_cos();
        bodies[body] = BodyState {
            x: e * c,
            y: e * s,
            angle: geometry.ideal_wheel_angle(i, input) + twist * noise(i),
            vx: -52.34 * e * s,
            vy: 52.34 * e * c,
            rate: -3.5 + noise(i + 3),
        };
    }
    let psi = geometry.ideal_output_angle(input) + twist * noise(7);
    bodies[Layout::OUTPUT].angle = psi;
    for (k, body) in layout.internal_bodies().enumerate() {
        let [x, y] = geometry.internal_points[k];
        let (s, c) = psi.sin_cos();
        let (x, y) = (c * x - s * y, s * x + c * y);
        bodies[body] = BodyState {
            x,
            y,
            angle: 0.0,
            vx: 3.4 * y,
            vy: -3.4 * x,
            rate: 5.0 * noise(k),
        };
    }
    for (k, body) in layout.external_bodies().enumerate() {
        bodies[body].rate = 3.0 * noise(k + 2);
    }
    bodies
}

/// Compares the depth of every ring pin in every disc by brute force, 0 without contact, with the pairs of a loop.
fn check_depths(gearbox: &Gearbox, bodies: &[BodyState], pairs: &[PairContact]) {
    let (layout, curve) = (gearbox.layout, &gearbox.geometry.curve);
    let larger = gearbox.scene.gear.external_sleeve_radius_m - gearbox.geometry.edge_offset_m;
    for (wheel, body) in layout.wheel_bodies().enumerate() {
        let frame = &bodies[body];
        for (j, body) in layout.external_bodies().enumerate() {
            let offset = Complex::new(bodies[body].x - frame.x, bodies[body].y - frame.y);
            let depth = brute::depth(curve, offset * Complex::unit(-frame.angle));
            let depth = (depth + larger).max(0.0);
            let pair = pairs
                .iter()
                .find(|pair| pair.wheel == wheel && pair.sleeve == Sleeve::External(j));
            let actual = pair.map_or(0.0, |pair| pair.penetration_m);
            // Angles are accurate to some 4e-16 rad.
            let rounding = 4e-15 * curve.pitch_radius();
            assert!(
                (actual - depth).abs() <= rounding,
                "disc {wheel}, pin {j}: {actual} {depth}"
            );
        }
    }
}

/// Poses where the lanes' Newton steps run out on a pin without contact, once taken for a contact up to 14 mm deep. Gears of
/// (zk, m, backlash), with discs at the input angle, behind the ideal mesh by the lag, rad.
#[test]
fn regress_lanes_out_of_steps_touch_nothing() {
    for (zk, m, backlash, input, lag) in [
        (
            101,
            0.572_462_413_4,
            6.489_363_1e-5,
            2.666_611_738_6,
            9.350_619_9e-3,
        ),
        (
            84,
            0.588_851_446_5,
            1.616_270_6e-4,
            5.985_366_407_0,
            1.006_154_508e-2,
        ),
        (
            89,
            0.539_415_292_4,
            1.169_444_32e-3,
            6.951_314_750_4,
            -8.081_058_469e-3,
        ),
        (
            67,
            0.689_642_854_9,
            1.014_391_55e-3,
            1.205_634_488_9,
            -4.273_971_018e-3,
        ),
        (
            114,
            0.585_507_793_2,
            2.359_497_89e-4,
            5.750_384_002_1,
            -7.278_355_574e-3,
        ),
        (
            83,
            0.525_822_364_9,
            8.430_206_02e-4,
            6.468_040_751_6,
            -1.078_056_254e-2,
        ),
    ] {
        let mut scene = Scene::paper();
        scene.gear.external_sleeves = zk;
        scene.gear.shortening = m;
        scene.gear.backlash_m = backlash;
        scene.gear.wheels = 1;
        let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
        let bodies = states(&gearbox, input, lag, &[1.0]);
        for kernel in Kernel::ALL {
            check_depths(&gearbox, &bodies, &pairs(&gearbox, kernel, &bodies).0);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any gear (zk and zi no multiple of the lanes), with or without friction, backlash and a force along the profile, for all
    /// instruction sets.
    #[test]
    fn lanes_equal_the_scalar_loop(
        zk in 5_usize..121, m in 0.3..0.9_f64, zi in 3_usize..20, wheels in 1_usize..4, friction: bool,
        law in 0..4_usize, kernel in prop::sample::select(&LANES), backlash in prop_oneof![Just(0.0), 0.0..1.4e-3], input in 0.0..40.0_f64, twist in 0.0..2e-3_f64,
        rates in prop::array::uniform16(-1.0..1.0_f64), pin in prop::option::of(4.0..9.0_f64), rubs in prop::option::of(0.01..0.2_f64),
        cut in prop_oneof![Just(0.0), 1e-7..3e-4_f64], turn: [bool; 2],
    ) {
        let mut scene = Scene::paper();
        scene.gear.modification.equidistant_m = cut;
        [scene.gear.external_sleeves_turn, scene.gear.internal_sleeves_turn] = turn;
        (scene.bearings.sleeve_friction_coefficient, scene.bearings.sleeve_bore_m) = (rubs, Some(0.005));
        scene.bearings.internal_sleeve_stiffness_n_m = pin.map(|digits| 10f64.powf(digits));
        scene.gear.external_sleeves = zk;
        scene.gear.shortening = m;
        scene.gear.internal_sleeves = zi;
        scene.gear.wheels = wheels;
        scene.gear.backlash_m = backlash;
        scene.gear.external_sleeve_radius_m = 0.004;
        scene.contact.friction_coefficient = if friction { 0.1 } else { 0.0 };
        scene.contact.law = ["paper", "paper-conservative", "line-hertz", "linear"][law].to_owned();
        // Holes may extend beyond the disc, with no effect on the kernels.
        let gearbox = Gearbox::new(&CheckedScene::unchecked(scene.clone())).unwrap();
        let bodies = states(&gearbox, input, twist, &rates);
        let (fast, slow) = (loads(&gearbox, kernel, &bodies), loads(&gearbox, Kernel::Scalar, &bodies));
        // 1e-13 of the largest force, plus the effect of rounding of positions: a radius of R is accurate to about 2 ulp, which
        // the slope 1.5 F/delta converts to force. With friction, velocities are accurate to 1e-16 of 1 m/s and the slope is mu
        // F/v_s.
        let ulps = 4.0 * f64::EPSILON * (gearbox.geometry.curve.pitch_radius() + 0.0028);
        let mut noise = 1e-13;
        let mut largest = 0.0_f64;
        gearbox.contact_field().unwrap().touching(&bodies, &mut |pair| {
            largest = largest.max(pair.normal_force_n);
            noise += 1.5 * pair.normal_force_n / pair.penetration_m * ulps + 8.0 * ulps / scene.contact.ramp_m;
            if friction {
                noise += 0.1 * pair.normal_force_n / scene.contact.friction_ramp_m_s * 4e-16;
            }
        });
        let force = noise + 1e-13 * largest;
        let moment = force * gearbox.geometry.curve.pitch_radius();
        let (mut listed, mut oracle) = (pairs(&gearbox, kernel, &bodies), pairs(&gearbox, Kernel::Scalar, &bodies));
        check_depths(&gearbox, &bodies, &oracle.0);
        // Rounding decides whether barely touching pins count.
        for list in [&mut listed.0, &mut oracle.0] {
            list.retain(|pair| pair.penetration_m > 100.0 * ulps);
        }
        prop_assert_eq!(listed.0.len(), oracle.0.len());
        for (a, b) in listed.0.iter().zip(&oracle.0) {
            prop_assert_eq!((a.wheel, a.sleeve), (b.wheel, b.sleeve));
            prop_assert!((a.penetration_m - b.penetration_m).abs() <= 4.0 * ulps);
            // Friction's slope mu F/v_s converts rounding of velocities (1e-16 of 1 m/s) to force.
            prop_assert!((a.normal_force_n - b.normal_force_n).abs() <= force, "{a:?} {b:?} {force}");
            prop_assert!((a.friction_force_n - b.friction_force_n).abs() <= force, "{a:?} {b:?} {force}");
            prop_assert!((a.along_force_n - b.along_force_n).abs() <= force, "{a:?} {b:?} {force}");
            prop_assert!(law > 0 || b.along_force_n == 0.0);
            let near = |x: [f64; 2], y: [f64; 2], bound: f64| (x[0] - y[0]).abs().max((x[1] - y[1]).abs()) <= bound;
            prop_assert!(near(a.point, b.point, 1e-12) && near(a.centre, b.centre, 1e-15), "{a:?} {b:?}");
        }
        let both = both(&gearbox, kernel, &bodies);
        prop_assert_eq!(&both.0, &fast);
        let b = oracle.1;
        let stored = 1e-12 * b.stored_j + force * 1e-3;
        for a in [listed.1, both.1] {
            prop_assert!((a.stored_j - b.stored_j).abs() <= stored, "{a:?} {b:?}");
            prop_assert!((a.damping_w - b.damping_w).abs() <= 1e-9 * b.damping_w + force, "{a:?} {b:?}");
            for (x, y) in a.by_cause_w().iter().zip(b.by_cause_w()) {
                prop_assert!((x - y).abs() <= 1e-9 * y + force, "{a:?} {b:?}");
            }
        }
        let held = held(&gearbox, kernel, &bodies);
        prop_assert_eq!(held.is_some(), !scene.slides());
        if let Some((turning, loads, energy)) = held {
            for (a, b) in turning.iter().zip(moments(&gearbox, &bodies, &slow)) {
                prop_assert!((a - b).abs() <= moment, "{a} {b} {moment}");
            }
            for (a, b) in loads.iter().zip(&slow) {
                prop_assert!((a.fx - b.fx).abs() <= force, "{a:?} {b:?} {force}");
                prop_assert!((a.fy - b.fy).abs() <= force, "{a:?} {b:?} {force}");
            }
            prop_assert!((energy.stored_j - b.stored_j).abs() <= stored, "{energy:?} {b:?}");
            prop_assert!((energy.damping_w - b.damping_w).abs() <= 1e-9 * b.damping_w + force, "{energy:?} {b:?}");
            for (x, y) in energy.by_cause_w().iter().zip(b.by_cause_w()) {
                prop_assert!((x - y).abs() <= 1e-9 * y + force, "{energy:?} {b:?}");
            }
            let is_pressed = oracle.0.iter().any(|pair| pair.normal_force_n > 0.0);
            prop_assert!(b.friction_w() > 0.0 || rubs.is_none() || !is_pressed || turn != [true; 2], "{b:?}");
            prop_assert!(b.friction_w() == 0.0 || rubs.is_some(), "{b:?}");
        }
        for (a, b) in fast.iter().zip(&slow) {
            prop_assert!((a.fx - b.fx).abs() <= force, "{a:?} {b:?} {force}");
            prop_assert!((a.fy - b.fy).abs() <= force, "{a:?} {b:?} {force}");
            prop_assert!((a.moment - b.moment).abs() <= moment, "{a:?} {b:?} {moment}");
        }
    }
}

/// For every law the moments by levers are those of the scalar loop.
#[test]
fn levers_serve_every_law() {
    for info in pinwheel_contact::laws::LAWS {
        for preset in ["paper", "backlash-0.6", "forty-pins", "eleven-pins"] {
            let mut scene = Scene::load(preset, &[]).unwrap().into_scene();
            scene.contact.law = info.name.to_owned();
            let gearbox = Gearbox::new(&CheckedScene::unchecked(scene)).unwrap();
            let play = 17.003 * gearbox.scene.gear.backlash_m;
            for k in 0..20 {
                let bodies = states(&gearbox, 0.37 * f64::from(k), play + 4e-4, &[1.0, 0.8, 0.9]);
                let slow = loads(&gearbox, Kernel::Scalar, &bodies);
                let slow = moments(&gearbox, &bodies, &slow);
                let largest = slow.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                for kernel in LANES {
                    let (turning, ..) = held(&gearbox, kernel, &bodies).unwrap();
                    for (a, b) in turning.iter().zip(&slow) {
                        assert!(
                            (a - b).abs() <= 1e-9 * largest,
                            "{} {preset} {kernel:?}: {a} {b}",
                            info.name
                        );
                    }
                }
            }
        }
    }
}

/// For floating discs at any position the loads by levers are those of the scalar loop, with any bearing and pin.
#[test]
fn levers_know_wheels_that_float() {
    let bearings = [
        ("bearings.eccentric.stiffness_n_m", "3e8"),
        ("bearings.eccentric.bore_m", "0.02"),
        ("bearings.eccentric.friction_coefficient", "0.01"),
    ];
    let pin = ("bearings.internal_sleeve_stiffness_n_m", "1e7");
    let rubs = [
        bearings[0],
        ("bearings.sleeve_friction_coefficient", "0.05"),
        ("bearings.sleeve_bore_m", "0.004"),
    ];
    // Less friction on some pins than the sleeve's own, 0.05 times 2 over 3 to 6 mm.
    let slides = [&rubs[..], &[("contact.friction_coefficient", "0.02")]].concat();
    for (preset, law) in [
        ("paper", "paper"),
        ("backlash-0.6", "paper-conservative"),
        ("eleven-pins", "line-hertz"),
        ("one-wheel", "linear"),
    ] {
        for sets in [&bearings[..], &[bearings[0], pin], &rubs, &slides] {
            let sets = [sets, &[("contact.law", law)]].concat();
            let gearbox = gearbox(preset, &sets);
            let play = gearbox.scene.gear.backlash_m / gearbox.scene.gear.lever_m();
            for input in [0.0, 0.9, 12.4] {
                let rates = [1.0, 0.8, 0.9, -0.4];
                let mut bodies = states(&gearbox, input, 1e-3 + 1.5 * play, &rates);
                for (k, body) in gearbox.layout.wheel_bodies().enumerate() {
                    bodies[body].x += 2e-5 * rates[k % 4];
                    bodies[body].y -= 1e-5 * rates[(k + 1) % 4];
                    bodies[body].vx += 0.01 * rates[(k + 2) % 4];
                    bodies[body].vy += 0.01 * rates[(k + 3) % 4];
                }
                let slow = loads(&gearbox, Kernel::Scalar, &bodies);
                let (_, stored) = pairs(&gearbox, Kernel::Scalar, &bodies);
                let largest = slow
                    .iter()
                    .fold(0.0_f64, |most, load| most.max(load.fx.abs()));
                assert!(largest > 10.0, "{preset} {largest}");
                let near = |a: f64, b: f64| {
                    assert!((a - b).abs() <= 1e-8 * largest, "{preset} {law}: {a} {b}");
                };
                for kernel in LANES {
                    let mut gearbox = gearbox.clone();
                    gearbox.kernel = kernel;
                    let mut field = gearbox.contact_field().unwrap();
                    let mut fast = vec![Wrench::default(); bodies.len()];
                    let mut moments = vec![0.0; bodies.len()];
                    let energy = from_angles(&mut field, &bodies, &mut moments, &mut fast);
                    let energy = energy.unwrap();
                    near(energy.stored_j / stored.stored_j * largest, largest);
                    near(energy.damping_w, stored.damping_w);
                    for (x, y) in energy.by_cause_w().into_iter().zip(stored.by_cause_w()) {
                        near(x, y);
                    }
                    assert_eq!(energy.friction_w() > 0.0, sets.len() > 3);
                    for (body, (a, b)) in fast.iter().zip(&slow).enumerate() {
                        near(a.fx, b.fx);
                        near(a.fy, b.fy);
                        near(a.moment, b.moment);
                        if body != Layout::OUTPUT && body < gearbox.layout.wheel_bodies().end {
                            near(moments[body], b.moment);
                        }
                    }
                    let output: f64 = (gearbox.layout.internal_bodies())
                        .map(|k| bodies[k].x * slow[k].fy - bodies[k].y * slow[k].fx)
                        .sum();
                    near(
                        moments[Layout::OUTPUT],
                        output + slow[Layout::OUTPUT].moment,
                    );
                }
            }
        }
    }
}

/// A field reuses valid results; equal states give equal bits after any history.
#[test]
fn fields_know_no_history() {
    for preset in ["paper", "backlash-0.6", "forty-pins", "eleven-pins"] {
        let mut gearbox = Gearbox::new(&Scene::load(preset, &[]).unwrap()).unwrap();
        let play = 17.003 * gearbox.scene.gear.backlash_m;
        for kernel in LANES {
            gearbox.kernel = kernel;
            let mut field = gearbox.contact_field().unwrap();
            let mut differ = 0;
            let mut before = Vec::new();
            for k in 0..600 {
                // Back and forth, by the rotation of one sample at a time.
                let turn = 0.0157 * f64::from(if k < 400 { k } else { 800 - k });
                let twist = (play + 2e-4) * (0.02 * f64::from(k)).cos();
                let bodies = states(&gearbox, turn, twist, &[1.0, 0.8, 0.9]);
                let mut new = gearbox.contact_field().unwrap();
                let outputs = [&mut field, &mut new].map(|field| {
                    let mut loads = vec![Wrench::default(); bodies.len()];
                    let mut moments = vec![0.0; bodies.len()];
                    let energy = from_angles(field, &bodies, &mut moments, &mut loads).unwrap();
                    (moments, loads, energy)
                });
                assert_eq!(outputs[0], outputs[1], "{preset} {kernel:?} {k}");
                let touching = outputs[0].1.iter().map(|load| load.fx != 0.0);
                let touching: Vec<bool> = touching.collect();
                differ += usize::from(touching != before);
                before = touching;
            }
            assert!((20..580).contains(&differ), "{preset}: {differ} changes");
        }
    }
}

/// Touching pins are complete and exact: forces on every ring pin against the scalar loop, over random gears and poses.
/// `PINWHEEL_POSES=10000000` runs as many.
#[test]
fn hard_levers_find_what_touches() {
    const POSES: u64 = 100;
    let wanted = std::env::var("PINWHEEL_POSES").map_or(40_000, |n| n.parse().unwrap());
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = |low: f64, high: f64| {
        // xorshift64* [Vigna 2016].
        seed ^= seed >> 12;
        seed ^= seed << 25;
        seed ^= seed >> 27;
        let bits = seed.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        low + (high - low) * bits as f64 / (1_u64 << 53) as f64
    };
    let (mut touching, mut poses) = (0_u64, 0_u64);
    while poses < wanted {
        let mut scene = Scene::paper();
        scene.gear.external_sleeves = random(6.0, 120.999) as usize;
        scene.gear.shortening = random(0.3, 0.9);
        scene.gear.external_sleeve_radius_m = 0.001;
        scene.gear.wheels = random(1.0, 3.999) as usize;
        scene.gear.backlash_m = random(-4e-4, 1.4e-3).max(0.0);
        // A quarter of the discs are ground larger or smaller.
        scene.gear.modification.radial_m = if random(0.0, 1.0) < 0.25 {
            random(-4e-4, 1e-4)
        } else {
            0.0
        };
        let mut gearbox = Gearbox::new(&CheckedScene::unchecked(scene)).unwrap();
        let curve = &gearbox.geometry.curve;
        let (zs, radius) = (f64::from(curve.lobes()), curve.pitch_radius());
        // A quarter of a pitch to either side, mostly about the size of the play.
        let reach = if random(0.0, 1.0) < 0.8 {
            2.0 * (gearbox.scene.gear.backlash_m - gearbox.scene.gear.modification.radial_m)
                .max(0.0)
                / (0.0028 * zs)
                + 2e-5 / (0.0028 * zs)
        } else {
            0.25 * std::f64::consts::TAU / zs
        };
        let mut fields: Vec<_> = [Kernel::Scalar, LANES[(poses / POSES) as usize % 3]]
            .into_iter()
            .map(|kernel| {
                gearbox.kernel = kernel;
                gearbox.contact_field().unwrap()
            })
            .collect();
        for _ in 0..POSES {
            let twists = [0; 3].map(|_| random(-reach, reach));
            let mut bodies = states(&gearbox, random(0.0, 40.0), 1.0, &twists);
            bodies[Layout::OUTPUT].angle = 0.0;
            let mut loads = [0; 2].map(|_| vec![Wrench::default(); bodies.len()]);
            fields[0].add_loads(&bodies, &mut loads[0]);
            let mut request = Evaluation {
                pose: Pose::Prescribed,
                ..Evaluation::of_loads(&mut loads[1])
            };
            fields[1].evaluate(&bodies, &mut request);
            for body in gearbox.layout.external_bodies() {
                let [a, b] = [0, 1].map(|k| loads[k][body].fx.hypot(loads[k][body].fy));
                touching += u64::from(a > 0.0);
                // Rounding of the radius, as a penetration, at the largest slope of the force.
                let depth = 1e-14 * radius;
                let bound = 1e-9 * a.max(b) + 8.0 * depth / 1e-5 + 1e9 * depth * 0.1;
                assert!(
                    (a - b).abs() <= bound,
                    "{poses}: {a} {b}, {:?}",
                    gearbox.scene.gear
                );
            }
            poses += 1;
        }
    }
    println!("{poses} poses, {touching} contacts");
    assert!(touching > poses / 4);
}

/// Closest points of every pair, most of which do not touch: W is where the normal points from P, and the points of the paper's
/// detection are near those of the curves.
#[test]
fn gaps_have_places_and_directions() {
    let of = |detection: &str| {
        let sets = [format!("contact.detection={detection}").parse().unwrap()];
        let scene = Scene::load("backlash-0.6", &sets).unwrap();
        Gearbox::new(&scene).unwrap()
    };
    let (exact, points) = (of("exact"), of("points"));
    let bodies = states(&exact, 0.4, 1e-4, &[0.3, -0.8, 0.5]);
    let (mut exactly, mut by_points) = (
        exact.contact_field().unwrap(),
        points.contact_field().unwrap(),
    );
    let (layout, gear) = (exact.layout, &exact.scene.gear);
    let external = (0..layout.external_sleeves).map(Sleeve::External);
    let sleeves = external.chain((0..layout.internal_sleeves).map(Sleeve::Internal));
    let mut apart = 0;
    for (wheel, sleeve) in
        (0..layout.wheels).flat_map(|w| sleeves.clone().map(move |sleeve| (w, sleeve)))
    {
        let radius = match sleeve {
            Sleeve::External(_) => gear.external_sleeve_radius_m,
            Sleeve::Internal(_) => gear.internal_sleeve_radius_m,
        };
        let pairs = [&mut exactly, &mut by_points].map(|f| f.nearest(&bodies, wheel, sleeve));
        for pair in &pairs {
            let body = &bodies[layout.sleeve_body(sleeve)];
            let off = (pair.centre[0] - body.x).hypot(pair.centre[1] - body.y);
            assert!(off < 1e-15, "{pair:?}");
            let way = radius - pair.penetration_m;
            for k in 0..2 {
                let reached = pair.centre[k] + way * pair.normal[k];
                assert!((pair.point[k] - reached).abs() < 1e-12, "{pair:?}");
            }
        }
        let [a, b] = pairs;
        let along = a.normal[0] * b.normal[0] + a.normal[1] * b.normal[1];
        assert!(along > 0.99, "{a:?} {b:?}");
        assert!(
            (a.penetration_m - b.penetration_m).abs() < 2e-5,
            "{a:?} {b:?}"
        );
        apart += usize::from(a.penetration_m < 0.0);
    }
    assert!(apart > 20, "{apart}");
}

/// A gearbox that reuses parts of an earlier one is equal to a new one.
#[test]
fn a_gearbox_after_another_is_the_same() {
    let paper = Gearbox::new(&Scene::load("paper", &[]).unwrap()).unwrap();
    for change in [
        "drive.output_torque_n_m=11",
        "gear.backlash_m=1e-4",
        "gear.eccentricity_m=0.0027",
        "gear.external_sleeves=15",
        "gear.shortening=0.69",
        "gear.modification.radial_m=-1e-5",
    ] {
        let scene = Scene::load("paper", &[change.parse().unwrap()]).unwrap();
        let [after, new] = [Some(&paper), None].map(|last| Gearbox::after(last, &scene).unwrap());
        assert_eq!(after.geometry, new.geometry, "{change}");
        assert_eq!(after.scene, new.scene, "{change}");
    }
}
