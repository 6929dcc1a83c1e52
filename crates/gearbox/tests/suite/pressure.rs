//! Hertz' pressure of line contacts.

use std::f64::consts::PI;

use pinwheel_contact::Complex;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::pressure::{LinePressure, curvature, curvature_at_foot};
use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::{Override, Scene, Sleeve};

/// Pressure of pins and holes with individual radii, by 1/R = 1/sleeve + curvature of the edge, and 1/R =
/// 1/sleeve - 1/hole; the edge's curvature from three of its points.
#[test]
fn published_pressure_of_line_contacts() {
    let zeros = |n: usize, at: usize, x: f64| {
        let list = (0..n).map(|k| if k == at { x } else { 0.0 });
        format!("{:?}", list.collect::<Vec<_>>())
    };
    let scene = Scene::load(
        "one-wheel",
        &[
            Override::new("gear.modification.equidistant_m", "2e-4"),
            Override::new("gear.errors.hole_radius_m", zeros(8, 2, 1e-5)),
        ],
    )
    .unwrap();
    let gearbox = Gearbox::new(&scene).unwrap();
    let at = Statics::new(&gearbox).unwrap().solve(0.3, 22.0).unwrap();
    let geometry = &gearbox.geometry;
    let contact = &scene.contact;
    let pressure = LinePressure::new(contact);
    let modulus = contact.young_pa / (2.0 * (1.0 - contact.poisson * contact.poisson));
    let wheel = at.bodies[gearbox.layout.wheel_bodies().start];
    let (mut external, mut internal) = (0, 0);
    gearbox
        .contact_field()
        .unwrap()
        .touching(&at.bodies, &mut |pair| {
            let sum = match pair.sleeve {
                Sleeve::External(j) => {
                    external += 1;
                    let p = Complex::new(pair.centre[0] - wheel.x, pair.centre[1] - wheel.y);
                    let foot = geometry
                        .curve
                        .closest(p * Complex::unit(wheel.angle).conj());
                    let edge = |d: f64| {
                        let at = geometry.curve.at(foot.parameter() + d);
                        at.position - at.normal.scale(geometry.edge_offset_m)
                    };
                    let [a, b, c] = [edge(-2e-4), edge(0.0), edge(2e-4)];
                    let area = (b - a).cross(c - a);
                    let sides = (b - a).norm2() * (c - b).norm2() * (c - a).norm2();
                    let curvature = 2.0 * area / sides.sqrt();
                    1.0 / geometry.external_radii_m[j] + curvature
                }
                Sleeve::Internal(k) => {
                    internal += 1;
                    1.0 / geometry.internal_radii_m[k] - 1.0 / geometry.hole_radii_m[0][k]
                }
            };
            let line = contact.line_length_m;
            let expected = (pair.normal_force_n * modulus * sum / (PI * line)).sqrt();
            let value = pressure.of(geometry, pair, [wheel.x, wheel.y], wheel.angle);
            assert!((value / expected - 1.0).abs() < 1e-4, "{value} {expected}");
        });
    assert!(external > 2 && internal > 2, "{external} {internal}");
}

/// On rotated flanks the curvature is that of the flank with the contact.
#[test]
fn turned_flanks_have_their_own_curvature() {
    let sets = [Override::new("gear.modification.rotational_rad", "2e-3")];
    let gearbox = Gearbox::new(&Scene::load("one-wheel", &sets).unwrap()).unwrap();
    let geometry = &gearbox.geometry;
    let turn = geometry.flanks.unwrap();
    let mut hits = 0;
    for load in [22.0, -22.0] {
        let at = Statics::new(&gearbox).unwrap().solve(0.3, load).unwrap();
        let wheel = at.bodies[gearbox.layout.wheel_bodies().start];
        let mut field = gearbox.contact_field().unwrap();
        field.touching(&at.bodies, &mut |pair| {
            let Sleeve::External(_) = pair.sleeve else {
                return;
            };
            let back = Complex::unit(wheel.angle).conj();
            let inside = |[x, y]: [f64; 2]| Complex::new(x - wheel.x, y - wheel.y) * back;
            let (p, touched) = (inside(pair.centre), inside(pair.point));
            let flank = |turn: Complex| {
                let foot = geometry.curve.closest(p * turn.conj()).at;
                let edge = foot.position - foot.normal.scale(geometry.edge_offset_m);
                ((edge * turn - touched).norm(), foot.curvature)
            };
            let [one, other] = [flank(turn), flank(turn.conj())];
            let [near, far] = if one.0 < other.0 {
                [one, other]
            } else {
                [other, one]
            };
            // In a pit both are equal.
            if far.0 > 10.0 * near.0 {
                hits += 1;
                let value = curvature(geometry, pair, [wheel.x, wheel.y], wheel.angle);
                // Two searches for one foot: 1.2e-13 apart.
                let of = near.1.abs() + geometry.curve.pitch_radius().recip();
                assert!((value - near.1).abs() < 1e-12 * of, "{value} {}", near.1);
            }
        });
    }
    assert!(hits > 4, "{hits}");
}

/// The closed form of the curvature at a contact agrees with the search for the foot, on floating discs, too.
#[test]
fn the_curvature_at_a_contact_is_that_of_its_foot() {
    for preset in ["paper", "needle-bearings", "toleranced", "rv-40e-like"] {
        let gearbox = Gearbox::new(&Scene::load(preset, &[]).unwrap()).unwrap();
        let load = gearbox.scene.drive.output_torque_n_m;
        let at = Statics::new(&gearbox).unwrap().solve(0.3, load).unwrap();
        let geometry = &gearbox.geometry;
        let mut contacts = 0;
        let mut field = gearbox.contact_field().unwrap();
        field.touching(&at.bodies, &mut |pair| {
            let disc = at.bodies[gearbox.layout.wheel_bodies().start + pair.wheel];
            let centre = [disc.x, disc.y];
            if let Sleeve::External(_) = pair.sleeve {
                contacts += 1;
                let searched = curvature(geometry, pair, centre, disc.angle);
                let value = curvature_at_foot(geometry, pair, centre);
                let of = searched.abs() + geometry.curve.pitch_radius().recip();
                // 1.1e-11 in the pits of `rv-40e-like`, whose radius is 0.26 mm.
                assert!(
                    (value - searched).abs() < 1e-10 * of,
                    "{preset}: {value} {searched}"
                );
            }
        });
        assert!(contacts > 4, "{preset}: {contacts}");
    }
}
