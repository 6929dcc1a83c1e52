//! Drawings of discs.

use pinwheel_contact::{Complex, Epitrochoid};
use pinwheel_scene::Scene;
use pinwheel_studies::design::CHORD_M;
use pinwheel_studies::internals::discs;

/// Pairs of code and value.
fn read(dxf: &str) -> Vec<(u32, &str)> {
    let lines: Vec<&str> = dxf.lines().collect();
    let pairs = lines.as_chunks::<2>().0.iter();
    pairs
        .map(|[code, value]| (code.trim().parse().unwrap(), *value))
        .collect()
}

/// Read back from the file: the middle of every chord lies within the stated error of the edge, which the contacts'
/// closest points know; corners lie on it.
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
        let drawing = &discs(&scene).unwrap()[1];
        assert!(drawing.chord_error_m <= CHORD_M, "{drawing:?}");
        let gear = &scene.gear;
        let curve = Epitrochoid::new(
            gear.eccentricity_m,
            gear.external_sleeves as u32,
            gear.generating_shortening(),
        )
        .unwrap();
        // Outside of what two turned discs have in common: outside of one of them.
        let outside = |p: Complex| {
            let of =
                |turn: f64| curve.closest(p * Complex::unit(turn)).distance + gear.edge_offset_m();
            of(rotational_rad).max(of(-rotational_rad))
        };
        let dxf = drawing.dxf();
        let pairs = read(&dxf);
        let numbers = |wanted: u32, layer: &str| {
            let mut inside = false;
            let mut found = Vec::new();
            for &(code, value) in &pairs {
                match code {
                    0 => inside = value == if layer == "edge" { "VERTEX" } else { "CIRCLE" },
                    _ if inside && code == wanted => {
                        found.push(1e-3 * value.parse::<f64>().unwrap());
                    }
                    _ => (),
                }
            }
            found
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
        let radii = numbers(40, "holes");
        assert_eq!(radii.len(), gear.internal_sleeves);
        assert!((radii[0] - gear.hole_radius_m).abs() < 1e-12);
    }
}
