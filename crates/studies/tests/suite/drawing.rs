//! Drawings of discs.

use pinwheel_contact::{Complex, Epitrochoid};
use pinwheel_scene::{CheckedScene, Modification, Scene, bore_radius_m};
use pinwheel_studies::design::CHORD_M;
use pinwheel_studies::internals::discs;

/// Returns the pairs of group code and value.
fn read(dxf: &str) -> Vec<(u32, &str)> {
    let lines: Vec<&str> = dxf.lines().collect();
    let pairs = lines.as_chunks::<2>().0.iter();
    pairs
        .map(|[code, value]| (code.trim().parse().unwrap(), *value))
        .collect()
}

/// In the drawing read back from DXF, corners lie on the edge of the contact search, and the middle of every chord within the
/// stated error of it.
#[test]
fn drawings_lie_on_the_edge() {
    for (equidistant_m, radial_m, rotational_rad) in [
        (0.0, 0.0, 0.0),
        (2e-5, -3e-5, 0.0),
        (0.0, 0.0, 1e-3),
        (-1e-5, 0.0, 5e-4),
    ] {
        let mut scene = Scene::paper();
        let modification = &mut scene.gear.modification;
        modification.equidistant_m = equidistant_m;
        modification.radial_m = radial_m;
        modification.rotational_rad = rotational_rad;
        let scene = scene.check().unwrap();
        let drawing = &discs(&scene).unwrap()[0];
        assert!(drawing.chord_error_m <= CHORD_M, "{drawing:?}");
        let gear = &scene.gear;
        let curve = Epitrochoid::new(
            gear.eccentricity_m,
            gear.external_sleeves as u32,
            gear.generating_shortening(),
        )
        .unwrap();
        // Distance outside the intersection of two rotated discs: the larger of both distances.
        let outside = |p: Complex| {
            let of =
                |turn: f64| curve.closest(p * Complex::unit(turn)).distance + gear.edge_offset_m();
            of(rotational_rad).max(of(-rotational_rad))
        };
        let dxf = drawing.dxf();
        let pairs = read(&dxf);
        let numbers = |wanted: u32, layer: &str| {
            let (mut inside, mut at) = (false, "");
            let mut values = Vec::new();
            for &(code, value) in &pairs {
                match code {
                    0 => at = value,
                    8 => inside = value == layer && (layer != "edge" || at == "VERTEX"),
                    _ if inside && code == wanted => {
                        values.push(1e-3 * value.parse::<f64>().unwrap());
                    }
                    _ => (),
                }
            }
            values
        };
        let (x, y) = (numbers(10, "edge"), numbers(20, "edge"));
        assert_eq!(x.len(), drawing.corners);
        let corner = |k: usize| Complex::new(x[k % x.len()], y[k % x.len()]);
        let mut worst: f64 = 0.0;
        for k in 0..x.len() {
            let (one, next) = (corner(k), corner(k + 1));
            assert!(outside(one).abs() < 1e-11, "corner {k}: {}", outside(one));
            worst = worst.max(outside((one + next).scale(0.5)).abs());
        }
        assert!(
            worst <= 1.01 * drawing.chord_error_m && worst > 0.1 * drawing.chord_error_m,
            "{worst} of {}",
            drawing.chord_error_m
        );
        assert!(
            pairs
                .windows(2)
                .any(|two| two == [(9, "$INSUNITS"), (70, "4")])
        );
        let radius = |layer: &str| numbers(40, layer)[0];
        assert!((radius("bore") - bore_radius_m(gear)).abs() < 1e-12);
        assert_eq!(numbers(40, "output_pins").len(), gear.internal_sleeves);
        // At the input angle 0 every ring pin touches an unmodified disc.
        let (x, y) = (numbers(10, "ring_pins"), numbers(20, "ring_pins"));
        assert_eq!(x.len(), gear.external_sleeves);
        for at in x
            .into_iter()
            .zip(y)
            .filter(|_| gear.modification == Modification::default())
        {
            let apart = outside(Complex::new(at.0, at.1)) - radius("ring_pins");
            assert!(apart.abs() < 1e-11, "{at:?}: {apart}");
        }
        let radii = numbers(40, "holes");
        assert_eq!(radii.len(), gear.internal_sleeves);
        assert!((radii[0] - gear.hole_radius_m).abs() < 1e-12);
    }
}

/// Two discs are identical parts if zs is odd and zi even, otherwise by the rule of common divisors. A displaced hole makes them
/// different parts.
#[test]
fn discs_that_are_one_part_are_one_drawing() {
    let divisor = |mut a: usize, mut b: usize| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    for zk in [16, 17, 13, 11] {
        for (zi, wheels) in [(8, 2), (6, 2), (5, 2), (6, 3), (8, 4)] {
            let mut scene = Scene::paper();
            let gear = &mut scene.gear;
            gear.external_sleeves = zk;
            gear.eccentricity_m = 0.0028 * 16.0 / zk as f64;
            (gear.internal_sleeves, gear.wheels) = (zi, wheels);
            let (lobes, mut apart) = (zk - 1, scene.clone());
            let drawings = discs(&CheckedScene::unchecked(scene)).unwrap();
            let g = divisor(lobes, zi);
            let is_first =
                |i: &usize| (i * zi).is_multiple_of(wheels) && (i * zi / wheels).is_multiple_of(g);
            let alike: Vec<usize> = (0..wheels).filter(is_first).collect();
            assert_eq!(drawings[0].wheels, alike, "{lobes} lobes, {zi} pins");
            if lobes % 2 == 1 && zi % 2 == 0 && wheels == 2 {
                assert_eq!(drawings.len(), 1, "{lobes} lobes, {zi} pins");
            }
            apart.gear.errors.hole_radial_m = vec![0.0; zi * wheels];
            apart.gear.errors.hole_radial_m[zi] = 1e-6;
            let drawings = discs(&CheckedScene::unchecked(apart)).unwrap();
            assert!(!drawings[0].wheels.contains(&1), "{lobes} lobes, {zi} pins");
        }
    }
}
