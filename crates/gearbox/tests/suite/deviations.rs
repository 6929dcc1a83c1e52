//! Modified profiles and errors of single parts, against closed-form gaps, brute force and the gear without them.

use std::f64::consts::{PI, TAU};

use pinwheel_contact::Complex;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::Kernel;
use pinwheel_gearbox::statics::Statics;
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::{CheckedScene, Layout, Scene, Sleeve, free_play};
use proptest::prelude::*;

fn gearbox(change: impl FnOnce(&mut Scene)) -> Gearbox {
    let mut scene = Scene::paper();
    change(&mut scene);
    Gearbox::new(&scene.check().unwrap()).unwrap()
}

/// Returns all bodies at the ideal mesh of the input angle.
fn ideal(gearbox: &Gearbox, input: f64, twist: f64) -> Vec<BodyState> {
    let (layout, geometry) = (gearbox.layout, &gearbox.geometry);
    let mut bodies = gearbox.kinematic_states();
    for (i, body) in layout.wheel_bodies().enumerate() {
        let centre =
            Complex::unit(input + geometry.wheel_phases[i]).scale(geometry.eccentricities_m[i]);
        (bodies[body].x, bodies[body].y) = (centre.re, centre.im);
        bodies[body].angle = geometry.ideal_wheel_angle(i, input) + twist;
    }
    let psi = geometry.ideal_output_angle(input);
    for (k, body) in layout.internal_bodies().enumerate() {
        let [x, y] = geometry.internal_points[k];
        let at = Complex::new(x, y) * Complex::unit(psi);
        (bodies[body].x, bodies[body].y) = (at.re, at.im);
    }
    bodies
}

/// Returns the gaps of a disc's ring pins with their angles from the eccentric, at the ideal mesh.
fn gaps(gearbox: &Gearbox, input: f64, wheel: usize) -> Vec<(f64, f64)> {
    let bodies = ideal(gearbox, input, 0.0);
    let mut field = gearbox.contact_field().unwrap();
    let sleeves = gearbox.layout.external_sleeves;
    (0..sleeves)
        .map(|j| {
            let pair = field.nearest(&bodies, wheel, Sleeve::External(j));
            let phi =
                TAU * j as f64 / sleeves as f64 - input - gearbox.geometry.wheel_phases[wheel];
            (phi, -pair.penetration_m)
        })
        .collect()
}

/// Modifications and combinations, in shares of a size: equidistant, radial, rotational (of a length at e zs), backlash.
const MODIFICATIONS: [[f64; 4]; 8] = [
    [1.0, 0.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0, 0.0],
    [0.0, -1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0, 0.0],
    [-1.0, -1.0, 0.5, 0.0],
    [0.5, -0.7, 0.3, 0.4],
];

fn modified(shares: [f64; 4], size_m: f64) -> Gearbox {
    gearbox(|scene| {
        let gear = &mut scene.gear;
        gear.modification.equidistant_m = shares[0] * size_m;
        gear.modification.radial_m = shares[1] * size_m;
        gear.modification.rotational_rad = shares[2] * size_m / gear.lever_m();
        gear.backlash_m = shares[3] * size_m;
    })
}

/// First-order formulas: the error falls with the square of the size.
#[test]
fn published_initial_gaps_of_modifications() {
    for shares in MODIFICATIONS {
        let mut left = [0.0_f64; 2];
        for (left, size) in left.iter_mut().zip([2e-5, 1e-5]) {
            let gearbox = modified(shares, size);
            for input in [0.0, 0.1, 1.7] {
                for (phi, gap) in gaps(&gearbox, input, 1) {
                    let (wanted, _) = gearbox.scene.gear.initial_gap_m(phi);
                    *left = left.max((gap - wanted).abs() / size);
                }
            }
        }
        // Curvature of the pits: 0.56 mm, so that 20 um rotate the normals by a few percent there; measured 0.033.
        assert!(left[0] < 0.05, "{shares:?}: {left:?}");
        assert!(
            left[1] < 0.55 * left[0] + 1e-9,
            "{shares:?}: not of second order: {left:?}"
        );
    }
}

/// Initial gaps after rotating the disc until its pin with the longest lever (cos phi = m) would touch, in the textbook form:
/// dr (1 - sin phi/S) - dR (1 - m cos phi - sqrt(1 - m^2) sin phi)/S.
#[test]
fn published_gaps_of_a_wheel_in_touch() {
    let gear = gearbox(|scene| {
        scene.gear.modification.equidistant_m = 3e-6;
        scene.gear.modification.radial_m = -2e-6;
    });
    let (gear, m) = (&gear.scene.gear, gear.scene.gear.shortening);
    let turn = free_play(gear);
    let root = (1.0 - m * m).sqrt();
    assert!((turn - (3e-6 + 2e-6 * root) / gear.lever_m()).abs() < 1e-15);
    for k in 1..50 {
        let phi = PI * f64::from(k) / 50.0;
        let (sin, cos) = phi.sin_cos();
        let s = (1.0 + m * m - 2.0 * m * cos).sqrt();
        let printed = 3e-6 * (1.0 - sin / s) + 2e-6 * (1.0 - m * cos - root * sin) / s;
        let (gap, lever) = gear.initial_gap_m(phi);
        assert!((gap - lever * turn - printed).abs() < 1e-18, "{phi}");
        assert!(printed > -1e-18);
    }
}

/// An error of one part changes its gap by the normal component of its displacement. The normals of the mesh pass through the
/// pitch point, e zk from the gear's centre towards the eccentric; those of the holes are parallel to the eccentric.
#[test]
fn published_gaps_of_errors() {
    let (size, input) = (1e-6, 0.37);
    let plain = gearbox(|_| {});
    let gear = &plain.scene.gear;
    let (zk, zi) = (gear.external_sleeves, gear.internal_sleeves);
    let one = |count: usize, at: usize| {
        let mut list = vec![0.0; count];
        list[at] = size;
        list
    };
    for (key, wheel) in [
        ("radial", 0),
        ("tangential", 1),
        ("radius", 0),
        ("eccentricity", 1),
    ] {
        for j in 0..zk {
            let off = gearbox(|scene| {
                let errors = &mut scene.gear.errors;
                match key {
                    "radial" => errors.external_sleeve_radial_m = one(zk, j),
                    "tangential" => errors.external_sleeve_tangential_m = one(zk, j),
                    "radius" => errors.external_sleeve_radius_m = one(zk, j),
                    _ => errors.eccentricity_m = one(2, wheel),
                }
            });
            let out = Complex::unit(TAU * j as f64 / zk as f64);
            let eccentric = Complex::unit(input + off.geometry.wheel_phases[wheel]);
            let pitch = eccentric.scale(gear.eccentricity_m * zk as f64);
            let from = out.scale(gear.pitch_radius_m()) - pitch;
            let normal = from.scale(1.0 / from.norm());
            let wanted = match key {
                "radial" => normal.dot(out),
                "tangential" => normal.dot(out.turned()),
                "radius" => -1.0,
                _ => -normal.dot(eccentric),
            };
            let actual = gaps(&off, input, wheel)[j].1 / size;
            assert!(
                (actual - wanted).abs() < 5e-3,
                "{key} of {j}: {actual} {wanted}"
            );
        }
    }
    for (key, wheel) in [
        ("hole radial", 0),
        ("hole tangential", 1),
        ("hole radius", 1),
        ("pin tangential", 0),
        ("pin radius", 1),
        ("phase", 1),
    ] {
        for k in 0..zi {
            let number = wheel * zi + k;
            let off = gearbox(|scene| {
                let errors = &mut scene.gear.errors;
                match key {
                    "hole radial" => errors.hole_radial_m = one(2 * zi, number),
                    "hole tangential" => errors.hole_tangential_m = one(2 * zi, number),
                    "hole radius" => errors.hole_radius_m = one(2 * zi, number),
                    "pin tangential" => errors.internal_sleeve_tangential_m = one(zi, k),
                    "pin radius" => errors.internal_sleeve_radius_m = one(zi, k),
                    _ => errors.phase_rad = [0.0, size / gear.eccentricity_m].into(),
                }
            });
            let psi = off.geometry.ideal_output_angle(input);
            let out = Complex::unit(psi + TAU * k as f64 / zi as f64);
            // From the hole's centre to its pin's.
            let inwards = -Complex::unit(input + plain.geometry.wheel_phases[wheel]);
            let wanted = match key {
                "hole radial" => inwards.dot(out),
                "hole tangential" => inwards.dot(out.turned()),
                "hole radius" => 1.0,
                "pin tangential" => -inwards.dot(out.turned()),
                "pin radius" => -1.0,
                // The disc rotates by -1/(e zs) of its centre's displacement across, and its hole with it.
                _ => {
                    let turned = out
                        .turned()
                        .scale(gear.internal_circle_radius_m / gear.lever_m());
                    inwards.dot(-inwards.turned()) - inwards.dot(turned)
                }
            };
            let bodies = ideal(&off, input, 0.0);
            let mut field = off.contact_field().unwrap();
            let pair = field.nearest(&bodies, wheel, Sleeve::Internal(k));
            let actual = -pair.penetration_m / size;
            assert!(
                (actual - wanted).abs() < 5e-3,
                "{key} of {k}: {actual} {wanted}"
            );
        }
    }
}

fn loads(gearbox: &Gearbox, bodies: &[BodyState]) -> Vec<Wrench> {
    let mut loads = vec![Wrench::default(); bodies.len()];
    gearbox
        .contact_field()
        .unwrap()
        .add_loads(bodies, &mut loads);
    loads
}

/// Deviations of zero change nothing, to the bit; tiny ones have a tiny effect, in either loop.
#[test]
fn without_deviations_all_is_as_ever() {
    let plain = gearbox(|_| {});
    let zeros = gearbox(|scene| {
        scene.gear.errors.external_sleeve_radius_m = vec![0.0; 16];
        scene.gear.errors.hole_tangential_m = vec![0.0; 16];
    });
    assert_eq!(plain.geometry, zeros.geometry);
    let text = Scene::paper().to_toml()
        + "[gear.modification]\nequidistant_m = 0\nradial_m = 0.0\n[gear.errors]\nphase_rad = []\n";
    assert_eq!(
        *Scene::from_toml(&text, "paper", &[]).unwrap(),
        Scene::paper()
    );
    let mut scalar = plain.clone();
    scalar.kernel = Kernel::Scalar;
    let bodies = ideal(&plain, 0.3, 3e-4);
    assert_eq!(loads(&scalar, &bodies), loads(&zeros, &bodies));
    let wanted = loads(&plain, &bodies);
    let largest = wanted
        .iter()
        .fold(0.0, |m: f64, l| m.max(l.fx.abs()).max(l.fy.abs()));
    assert!(largest > 10.0);
    for shares in MODIFICATIONS {
        let near = modified(shares, 1e-13);
        let states = ideal(&near, 0.3, 3e-4);
        for (actual, wanted) in loads(&near, &states).iter().zip(&wanted) {
            // K^(2/3) F^(1/3) of some 1e7 N/m times 1e-13 m.
            let off = (actual.fx - wanted.fx).hypot(actual.fy - wanted.fy);
            assert!(off < 1e-5, "{shares:?}: {off}");
        }
    }
}

/// Returns points of the edge of a disc from the printed equation of the profile, limited to those common to both rotated
/// discs.
fn edge(scene: &CheckedScene, count: usize) -> Vec<Complex> {
    let gear = &scene.gear;
    let (e, zk) = (gear.eccentricity_m, gear.external_sleeves as f64);
    let zs = zk - 1.0;
    let change = &gear.modification;
    let (radius, q) = (
        e * zk / gear.shortening + change.radial_m,
        gear.external_sleeve_radius_m + change.equidistant_m,
    );
    let m = e * zk / radius;
    let point = |a: f64| {
        let gamma = (zs * a).sin().atan2(1.0 / m + (zs * a).cos());
        Complex::unit(a).scale(radius) + Complex::unit(zk * a).scale(e)
            - Complex::unit(a + gamma).scale(q)
    };
    let points: Vec<Complex> = (0..count)
        .map(|k| point(TAU * k as f64 / count as f64))
        .collect();
    let turn = change.rotational_rad;
    if turn == 0.0 {
        return points;
    }
    // Discs are star-shaped: the intersection extends, in every direction, to the nearer edge.
    let reach = |angle: f64| {
        let angle = angle.rem_euclid(TAU);
        let after = points.partition_point(|p| p.arg().rem_euclid(TAU) <= angle);
        let (p, q) = (points[(after + count - 1) % count], points[after % count]);
        let ray = Complex::unit(angle);
        p.cross(q) / (ray.cross(q) - ray.cross(p))
    };
    let directions = points.iter().map(|p| p.arg());
    directions
        .map(|angle| Complex::unit(angle).scale(reach(angle - turn).min(reach(angle + turn))))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    /// Penetrations against the nearest of very many points of the edge, for both detections.
    #[test]
    fn penetrations_are_those_of_brute_force(
        zk in 6_usize..24, m in 0.4..0.85_f64, input in 0.0..6.3_f64, twist in -4e-4..4e-4_f64,
        change in prop::array::uniform3(-6e-5..6e-5_f64), errors in prop::collection::vec(-4e-5..4e-5_f64, 24),
    ) {
        let mut scene = Scene::paper();
        let gear = &mut scene.gear;
        (gear.external_sleeves, gear.shortening, gear.external_sleeve_radius_m) = (zk, m, 0.003);
        (gear.internal_circle_radius_m, gear.internal_sleeves) = (0.5 * gear.pitch_radius_m(), 3);
        (gear.internal_sleeve_radius_m, gear.hole_radius_m) = (0.002, 0.0048);
        gear.modification.equidistant_m = change[0];
        gear.modification.radial_m = change[1];
        gear.modification.rotational_rad = (change[2] / gear.lever_m()).max(0.0);
        gear.errors.external_sleeve_radius_m = errors[..zk].to_vec();
        gear.errors.external_sleeve_radial_m = errors.iter().rev().take(zk).copied().collect();
        scene.solver.duration_s = 0.01;
        let checked = scene.check();
        prop_assume!(checked.is_ok());
        let gearbox = Gearbox::new(&checked.unwrap()).unwrap();
        let edge = edge(&gearbox.scene, 200_000);
        let bodies = ideal(&gearbox, input, twist);
        let mut field = gearbox.contact_field().unwrap();
        let mut touching = Vec::new();
        field.touching(&bodies, &mut |pair| touching.push(*pair));
        for (wheel, body) in gearbox.layout.wheel_bodies().enumerate() {
            let frame = bodies[body];
            for (j, body) in gearbox.layout.external_bodies().enumerate() {
                let offset = Complex::new(bodies[body].x - frame.x, bodies[body].y - frame.y) * Complex::unit(-frame.angle);
                let nearest = edge.iter().map(|w| (*w - offset).norm2()).fold(f64::INFINITY, f64::min).sqrt();
                let wanted = gearbox.geometry.external_radii_m[j] - nearest;
                let depth = field.nearest(&bodies, wheel, Sleeve::External(j)).penetration_m;
                // Points are 1 to 5 um apart: (5 um)^2/(2 * 0.5 mm) at the sharpest place. At the corners of rotated flanks
                // also half of 5 um times their slope, 0.02.
                let bound = if gearbox.scene.gear.modification.rotational_rad > 0.0 { 1e-7 } else { 3e-8 };
                prop_assert!((depth - wanted).abs() < bound, "disc {wheel}, pin {j}: {depth:e} {wanted:e}");
                let touches = touching.iter().any(|pair| pair.wheel == wheel && pair.sleeve == Sleeve::External(j));
                prop_assert!(touches == (depth > 0.0), "disc {wheel}, pin {j}: {depth:e}");
            }
        }
    }
}

/// Discrete points converge to the exact profile.
#[test]
fn crossval_points_of_a_modified_profile() {
    let change = |points: Option<usize>| {
        gearbox(|scene| {
            scene.gear.modification.equidistant_m = 2e-5;
            scene.gear.modification.radial_m = -1e-5;
            scene.gear.modification.rotational_rad = 2e-4;
            scene.gear.errors.external_sleeve_radius_m =
                (0..16).map(|k| 1e-6 * f64::from(k % 5)).collect();
            if let Some(points) = points {
                scene.contact.detection = pinwheel_scene::Detection::Points;
                scene.contact.wheel_points = points;
                scene.contact.hole_points = points / 8;
            }
        })
    };
    let exact = change(None);
    let bodies = ideal(&exact, 0.7, 2e-3);
    let size = |loads: &[Wrench]| loads.iter().map(|l| l.fx.hypot(l.fy)).sum::<f64>();
    let wanted = loads(&exact, &bodies);
    assert!(size(&wanted) > 100.0);
    let mut off = Vec::new();
    for points in [4_000, 16_000, 64_000] {
        let sampled = loads(&change(Some(points)), &bodies);
        let apart: Vec<Wrench> = sampled
            .iter()
            .zip(&wanted)
            .map(|(a, b)| Wrench {
                fx: a.fx - b.fx,
                fy: a.fy - b.fy,
                moment: 0.0,
            })
            .collect();
        off.push(size(&apart) / size(&wanted));
    }
    assert!(off[0] < 0.05 && off[2] < 0.1 * off[0], "{off:?}");
}

/// Between small torques of both signs a stiff gear rotates by the play of its modification: the least gap over lever among the
/// pins, to either side, of the tightest disc.
#[test]
fn published_play_of_a_modified_gear() {
    for shares in [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, -1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.5, -0.7, 0.3, 0.4],
    ] {
        let gearbox = gearbox(|scene| {
            let change = modified(shares, 1e-5);
            scene.gear = change.scene.gear.clone();
            scene.contact.stiffness_multiplier = 1e4;
            scene.contact.ramp_m = 1e-12;
        });
        let gear = &gearbox.scene.gear;
        let mut statics = Statics::new(&gearbox).unwrap();
        for input in [0.0, 0.05, 0.21] {
            let free = |sign: f64| {
                let of_wheel = |wheel: usize| {
                    let phi = move |j: usize| TAU * j as f64 / 16.0 - input - PI * wheel as f64;
                    let play = |j: usize| {
                        let (gap, lever) = gear.initial_gap_m(phi(j));
                        (lever * sign > 1e-9).then_some(gap / (lever * sign))
                    };
                    (0..16).filter_map(play).fold(f64::INFINITY, f64::min)
                };
                of_wheel(0).min(of_wheel(1))
            };
            let [one, other] =
                [1.0, -1.0].map(|sign| statics.solve(input, sign * 1e-3).unwrap().output);
            let (actual, wanted) = ((one - other).abs(), free(1.0) + free(-1.0));
            assert!(
                (actual / wanted - 1.0).abs() < 0.01,
                "{shares:?} at {input}: {actual:e} {wanted:e}"
            );
            assert!(wanted >= 2.0 * free_play(gear) * (1.0 - 1e-9), "{wanted:e}");
        }
        assert!(gearbox.layout.bodies() > Layout::OUTPUT);
    }
}
