//! The contact loop in lanes against the scalar one, its oracle, and both against closest points by brute force.

#[path = "../../contact/tests/brute/mod.rs"]
mod brute;

use pinwheel_contact::Complex;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::{ContactEnergy, Kernel, PairContact};
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::{CheckedScene, Layout, Scene, Sleeve};
use proptest::prelude::*;

/// All loops but the scalar one.
const LANES: [Kernel; 3] = [Kernel::Lanes, Kernel::Avx2, Kernel::Portable];

/// Loads of both loops on the same states.
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

/// Touching pairs and energies of one loop.
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

/// Loads and energies of the loop in lanes from one walk.
fn both(gearbox: &Gearbox, kernel: Kernel, bodies: &[BodyState]) -> (Vec<Wrench>, ContactEnergy) {
    let mut gearbox = gearbox.clone();
    gearbox.kernel = kernel;
    let mut loads = vec![Wrench::default(); bodies.len()];
    let mut field = gearbox.contact_field().unwrap();
    let energy = field.add_loads_with_energy(bodies, &mut loads);
    (loads, energy)
}

/// Initial states turned on by the input angle, every wheel and the output twisted by up to `twist`.
fn states(gearbox: &Gearbox, input: f64, twist: f64, rates: &[f64]) -> Vec<BodyState> {
    let mut bodies = gearbox.initial_states();
    let (layout, geometry) = (gearbox.layout, &gearbox.geometry);
    let e = gearbox.scene.gear.eccentricity_m;
    let noise = |k: usize| rates[k % rates.len()];
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

/// Depth of every external sleeve in every wheel by brute force, 0 where they do not touch, against the pairs of a loop.
fn check_depths(gearbox: &Gearbox, bodies: &[BodyState], pairs: &[PairContact]) {
    let (layout, curve) = (gearbox.layout, &gearbox.geometry.curve);
    for (wheel, body) in layout.wheel_bodies().enumerate() {
        let frame = &bodies[body];
        for (j, body) in layout.external_bodies().enumerate() {
            let offset = Complex::new(bodies[body].x - frame.x, bodies[body].y - frame.y);
            let depth = brute::depth(curve, offset * Complex::unit(-frame.angle)).max(0.0);
            let pair = pairs
                .iter()
                .find(|pair| pair.wheel == wheel && pair.sleeve == Sleeve::External(j));
            let found = pair.map_or(0.0, |pair| pair.penetration_m);
            // Angles are known to some 4e-16 rad.
            let rounding = 4e-15 * curve.pitch_radius();
            assert!(
                (found - depth).abs() <= rounding,
                "wheel {wheel}, sleeve {j}: {found} {depth}"
            );
        }
    }
}

/// Poses where the lanes' Newton steps run out on a sleeve that touches nothing; it was once taken for a contact, up to
/// 14 mm deep. Gears of (zk, m, backlash), wheels at the input angle and behind the ideal mesh by the lag, rad.
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
    #![proptest_config(ProptestConfig { cases: 800, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any gear (zk and zi no multiple of the lanes), friction or not, backlash or not, with a force along the profile or
    /// without, by any instructions.
    #[test]
    fn lanes_equal_the_scalar_loop(
        zk in 5_usize..121, m in 0.3..0.9_f64, zi in 3_usize..20, wheels in 1_usize..4, friction: bool,
        along: bool, kernel in prop::sample::select(&LANES), backlash in prop_oneof![Just(0.0), 0.0..1.4e-3], input in 0.0..40.0_f64, twist in 0.0..2e-3_f64,
        rates in prop::array::uniform16(-1.0..1.0_f64),
    ) {
        let mut scene = Scene::paper();
        scene.gear.external_sleeves = zk;
        scene.gear.shortening = m;
        scene.gear.internal_sleeves = zi;
        scene.gear.wheels = wheels;
        scene.gear.backlash_m = backlash;
        scene.gear.external_sleeve_radius_m = 0.004;
        scene.contact.friction_coefficient = if friction { 0.1 } else { 0.0 };
        if along {
            scene.contact.law = "paper-conservative".to_owned();
        }
        // Holes may leave the wheel: the kernels do not mind.
        let gearbox = Gearbox::new(&CheckedScene::unchecked(scene.clone())).unwrap();
        let bodies = states(&gearbox, input, twist, &rates);
        let (fast, slow) = (loads(&gearbox, kernel, &bodies), loads(&gearbox, Kernel::Scalar, &bodies));
        // 1e-13 of the largest force, and what rounding of positions does to both alike: a radius of R is
        // known to about 2 ulp, which the slope 1.5 F/delta turns into force. With friction, velocities are
        // known to 1e-16 of 1 m/s and the slope is mu F/v_s.
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
        let (listed, oracle) = (pairs(&gearbox, kernel, &bodies), pairs(&gearbox, Kernel::Scalar, &bodies));
        check_depths(&gearbox, &bodies, &oracle.0);
        prop_assert_eq!(listed.0.len(), oracle.0.len());
        for (a, b) in listed.0.iter().zip(&oracle.0) {
            prop_assert_eq!((a.wheel, a.sleeve), (b.wheel, b.sleeve));
            prop_assert!((a.penetration_m - b.penetration_m).abs() <= 4.0 * ulps);
            // Friction's slope mu F/v_s turns rounding of velocities (1e-16 of 1 m/s) into force.
            prop_assert!((a.normal_force_n - b.normal_force_n).abs() <= force, "{a:?} {b:?} {force}");
            prop_assert!((a.friction_force_n - b.friction_force_n).abs() <= force, "{a:?} {b:?} {force}");
            prop_assert!((a.along_force_n - b.along_force_n).abs() <= force, "{a:?} {b:?} {force}");
            prop_assert!(along || b.along_force_n == 0.0);
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
            prop_assert!((a.friction_w - b.friction_w).abs() <= 1e-9 * b.friction_w + force, "{a:?} {b:?}");
        }
        for (a, b) in fast.iter().zip(&slow) {
            prop_assert!((a.fx - b.fx).abs() <= force, "{a:?} {b:?} {force}");
            prop_assert!((a.fy - b.fy).abs() <= force, "{a:?} {b:?} {force}");
            prop_assert!((a.moment - b.moment).abs() <= moment, "{a:?} {b:?} {moment}");
        }
    }
}
