//! Friction at rest beside closed forms.

use pinwheel_gearbox::statics::{Statics, slow_efficiency};
use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_scene::{Override, Scene, Sleeve};

/// One disc on fixed ring pins, which are springs; output pins roll freely.
const ONE_DISC: &str = r#"
[gear]
pin_circle_radius_m = 0.0415
external_sleeve_radius_m = 0.0045
eccentricity_m = 0.002025
external_sleeves = 12
external_sleeves_turn = false
wheels = 1
face_width_m = 0.008
internal_sleeves = 6
internal_sleeve_radius_m = 0.0045
internal_circle_radius_m = 0.02605
[drive]
input_speed_rad_s = 100.0
output_torque_n_m = 10.0
[contact]
law = "linear"
young_pa = 2.1e11
poisson = 0.3
external_spring_n_m = 1e9
internal_spring_n_m = 1e9
friction_coefficient = 0.12
[bearings]
sleeve_friction_coefficient = 0.0
sleeve_bore_m = 0.006
[mass]
density_kg_m3 = 7850.0
"#;

/// Gear of needles and sleeves that `init` suggests.
const SUGGESTED: &str = r#"
[gear]
pin_circle_radius_m = 0.052
external_sleeves = 40
external_sleeve_radius_m = 0.00265
eccentricity_m = 0.00084
wheels = 2
face_width_m = 0.0078
internal_sleeves = 8
internal_sleeve_radius_m = 0.009
internal_circle_radius_m = 0.03
hole_radius_m = 0.009849
eccentric_bore_radius_m = 0.012
[bearings.eccentric]
clearance_m = 6.2e-6
friction_coefficient = 0.0025
bore_m = 0.01838
rollers = 19
roller_length_m = 0.007
roller_diameter_m = 0.0029
[gear.modification]
equidistant_m = 5.4e-6
[bearings]
sleeve_friction_coefficient = 0.02
sleeve_bore_m = 0.012
internal_sleeve_stiffness_n_m = 5.8e8
[drive]
input_speed_rad_s = 157.079632679
output_torque_n_m = 200.0
[contact]
law = "line-hertz"
young_pa = 2.1e11
poisson = 0.3
[mass]
density_kg_m3 = 7850.0
"#;

fn gearbox(sets: &[&str]) -> Gearbox {
    let sets: Vec<Override> = sets.iter().map(|set| set.parse().unwrap()).collect();
    Gearbox::new(&Scene::from_toml(ONE_DISC, "one disc", &sets).unwrap()).unwrap()
}

/// Sums over the loaded ring pins at an input angle, with the largest lever.
struct Sums {
    s: f64,
    a: f64,
    w: f64,
    lever_m: f64,
}

/// Returns S = sum l^2, A = sum l a and W = sum l w. P is the pin at the angle b from the eccentric, C the disc's centre, I the
/// pitch point at e zk, and d = |I - P|. The contact normal PI has the lever l = e zs sin(b) R/d about C, friction has the lever
/// a = (C - P).(I - P)/d - r, and the distance from the contact to I, the centre of rotation, is w = d - r.
fn sums(gearbox: &Gearbox, phi: f64, load: f64) -> Sums {
    let gear = &gearbox.scene.gear;
    let (e, r) = (gear.eccentricity_m, gear.external_sleeve_radius_m);
    let zk = gear.external_sleeves as f64;
    let [mut s, mut a, mut w, mut lever_m] = [0.0; 4];
    for [x, y] in &gearbox.geometry.external_points {
        let radius = x.hypot(*y);
        let (sin, cos) = (y.atan2(*x) - phi).sin_cos();
        let d = (radius * radius + e * e * zk * zk - 2.0 * radius * e * zk * cos).sqrt();
        let lever = e * (zk - 1.0) * sin * load.signum() * radius / d;
        let arm = (radius * radius + e * e * zk - e * radius * (zk + 1.0) * cos) / d - r;
        if lever > 0.0 {
            (s, a, w) = (s + lever * lever, a + lever * arm, w + lever * (d - r));
            lever_m = f64::max(lever_m, lever);
        }
    }
    Sums { s, a, w, lever_m }
}

/// Returns the output angles under a load that rises to `load`, and that falls to it, rad.
fn branches(gearbox: &Gearbox, phi: f64, load: f64) -> Result<[f64; 2], GearboxError> {
    let at = Statics::new(gearbox)?.solve(phi, load)?;
    let mut statics = Statics::rubbing(gearbox)?.unwrap();
    let [rises, falls] = [1.0, -1.0].map(|way| statics.loading(way, &at, load));
    Ok([rises?.output, falls?.output])
}

/// Relative difference of exact geometry from the undeformed mesh.
const DEFORMED: f64 = 1e-3;

/// With the input locked a load rotates the disc about the eccentric by t: pins press with F = k l t, and friction mu F opposes the
/// rotation at the lever a. Then T = k t (S +- mu A), and the branches are T/k (1/(S - mu A) - 1/(S + mu A)) apart. The rotation of
/// the output relative to the disc is equal in both branches.
#[test]
fn published_hysteresis_of_held_pins_by_hand() {
    for (mu, phi, load) in [
        (0.01, 0.1, 10.0),
        (0.12, 0.1, 0.3),
        (0.12, 4.0, -10.0),
        (0.3, 1.3, 10.0),
    ] {
        let gearbox = gearbox(&[&format!("contact.friction_coefficient={mu}")]);
        let spring = gearbox.scene.contact.external_spring_n_m.unwrap();
        let [rises, falls] = branches(&gearbox, phi, load).unwrap();
        let Sums { s, a, .. } = sums(&gearbox, phi, load);
        let wanted = load.abs() / spring * (1.0 / (s - mu * a) - 1.0 / (s + mu * a));
        println!("{mu} {phi} {load}: {:e}, by hand {wanted:e}", falls - rises);
        assert!(((falls - rises) / wanted - 1.0).abs() < DEFORMED);
    }
}

/// With the input turning forward friction acts with the load: F = l T/(S - mu A); backward F = l T/(S + mu A). The disc rotates
/// about the pitch point at 1/zs of the input's rate, so the driver's torque is T/zs (1 + mu W/(S - mu A)). Over a period this gives
/// efficiencies of 69.50 % at mu 0.15 and 96.84 % at 0.015, as an independent program does for the printed 11:1 gear.
#[test]
fn published_forces_and_efficiency_of_held_pins_by_hand() {
    const POSES: usize = 25;
    for (mu, percent) in [(0.015, 96.84), (0.12, 75.41), (0.15, 69.50)] {
        let gearbox = gearbox(&[&format!("contact.friction_coefficient={mu}")]);
        let (zk, zs) = (
            gearbox.scene.gear.external_sleeves as f64,
            gearbox.geometry.lobes(),
        );
        let mut plain = Statics::new(&gearbox).unwrap();
        let mut rubs = Statics::rubbing(&gearbox).unwrap().unwrap();
        let (load, mut mean) = (1.0, 0.0);
        for k in 0..POSES {
            let phi = std::f64::consts::TAU * k as f64 / POSES as f64 / zk;
            let Sums { s, a, w, lever_m } = sums(&gearbox, phi, load);
            let at = plain.solve(phi, load).unwrap();
            for way in [1.0, -1.0] {
                let balance = rubs.turning(way, &at, load).unwrap();
                let on_ring = rubs.touching(&balance).into_iter();
                let on_ring = on_ring.filter(|pair| matches!(pair.sleeve, Sleeve::External(_)));
                let force = on_ring.map(|pair| pair.normal_force_n).fold(0.0, f64::max);
                let wanted = lever_m * load / (s - way * mu * a);
                assert!((force / wanted - 1.0).abs() < DEFORMED, "{mu} {phi} {way}");
                let driver = rubs.driver_torque(&balance, load);
                let wanted = load / zs * (1.0 + way * mu * w / (s - way * mu * a));
                assert!((driver / wanted - 1.0).abs() < DEFORMED, "{mu} {phi} {way}");
                if way > 0.0 {
                    mean += driver / POSES as f64;
                }
            }
        }
        let efficiency = 100.0 * slow_efficiency(&gearbox, mean, load);
        println!("mu {mu}: {efficiency:.3} %");
        assert!((efficiency - percent).abs() < 0.01, "{efficiency}");
    }
}

/// If mu A reaches S, no load pushes a disc back against its friction: the gear keeps its twist, and jams when its input turns.
#[test]
fn hard_friction_that_locks_leaves_no_balance() {
    let (phi, load) = (0.1, 1.0);
    let Sums { s, a, .. } = sums(&gearbox(&[]), phi, load);
    let tried = |share: f64| {
        let gearbox = gearbox(&[&format!("contact.friction_coefficient={}", share * s / a)]);
        let at = Statics::new(&gearbox).unwrap().solve(phi, load).unwrap();
        let mut rubs = Statics::rubbing(&gearbox).unwrap().unwrap();
        let turns = rubs.turning(1.0, &at, load).map(|_| ());
        (branches(&gearbox, phi, load).map(|_| ()), turns)
    };
    assert_eq!(tried(0.98), (Ok(()), Ok(())));
    let locks = || Err(GearboxError::Sticks);
    assert_eq!(tried(1.02), (locks(), locks()));
    assert_eq!(tried(3.0), (locks(), locks()));
}

/// Hysteresis of the gear that `init` suggests for 39:1 and 200 N m. Discs float on needles, and under light loads some parts stick,
/// which couples all directions of friction. By symmetry the loops of both directions are equal at the input angle 0.
#[test]
fn hard_parts_that_stick_leave_a_loop() {
    const POSES: usize = 24;
    /// Place in the period where the iteration converges only by way of lower friction.
    const HARD: f64 = 83.0 / 96.0;
    let scene = Scene::from_toml(SUGGESTED, "suggested", &[]).unwrap();
    let gearbox = Gearbox::new(&scene).unwrap();
    let mut plain = Statics::new(&gearbox).unwrap();
    let mut rubs = Statics::rubbing(&gearbox).unwrap().unwrap();
    let mut width = |phi, load| {
        let at = plain.solve(phi, load).unwrap();
        let [rises, falls] = [1.0, -1.0].map(|way| rubs.loading(way, &at, load).unwrap().output);
        falls - rises
    };
    for (share, least, most) in [(1e-4, -2e-7, 2e-7), (0.03, 0.0, 2e-6), (0.3, 0.0, 1e-5)] {
        let load = share * scene.drive.output_torque_n_m;
        let [ahead, back] = [load, -load].map(|load| width(0.0, load));
        assert!((ahead / back - 1.0).abs() < 1e-3, "{share}: {ahead} {back}");
        let places = (0..POSES).map(|k| k as f64 / POSES as f64);
        for place in places.chain([HARD]) {
            let phi = std::f64::consts::TAU * place / 40.0;
            for load in [load, -load] {
                let width = width(phi, load);
                assert!(width > least && width < most, "{share} {phi}: {width}");
            }
        }
    }
}

/// Under almost no load the suggested gear has several equilibria with sticking parts; under 3 % of its load it has one.
#[test]
fn hard_parts_that_stick_have_several_balances() {
    let scene = Scene::from_toml(SUGGESTED, "suggested", &[]).unwrap();
    let gearbox = Gearbox::new(&scene).unwrap();
    let mut plain = Statics::new(&gearbox).unwrap();
    let mut rubs = Statics::rubbing(&gearbox).unwrap().unwrap();
    for (share, several) in [(1e-4, true), (0.03, false)] {
        let load = share * scene.drive.output_torque_n_m;
        let (mut widest, mut apart) = (0.0_f64, 0.0_f64);
        for pose in 0..24 {
            let phi = std::f64::consts::TAU * f64::from(pose) / 24.0 / 40.0;
            let at = plain.solve(phi, load).unwrap();
            let [rises, falls] = [1.0, -1.0].map(|way| rubs.loading(way, &at, load).unwrap());
            let again = rubs.loading(1.0, &falls, load).unwrap();
            widest = widest.max((falls.output - rises.output).abs());
            apart = apart.max((again.output - rises.output).abs());
        }
        println!("{share}: widest {widest:e}, apart {apart:e}");
        assert_eq!(apart > 1e-6 * widest, several, "{share}");
    }
}

/// Without friction there is nothing to solve, and pins that turn freely lose nothing.
#[test]
fn a_gear_without_friction_has_no_branches() {
    for sets in [
        &["contact.friction_coefficient=0"][..],
        &["gear.external_sleeves_turn=true"],
    ] {
        assert!(Statics::rubbing(&gearbox(sets)).unwrap().is_none());
    }
}
