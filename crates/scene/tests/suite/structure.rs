//! Elastic parts behind the contacts, by published closed forms, and warm parts.

use pinwheel_scene::{Fault, Held, Scene, Structure, Temperature};

fn close(actual: f64, wanted: f64, tolerance: f64) {
    assert!(
        (actual / wanted - 1.0).abs() < tolerance,
        "{actual} for {wanted}"
    );
}

/// Pins of 6 mm under two discs of 8 mm with gaps of 1 mm; steel.
fn pins(held: Held) -> Scene {
    let mut scene = Scene::paper();
    scene.gear.face_width_m = Some(0.008);
    (scene.contact.young_pa, scene.contact.poisson) = (2.1e11, 0.3);
    scene.bearings.internal_sleeves_held = Some(held);
    scene.bearings.internal_sleeve_gap_m = Some(0.001);
    scene.structure.output_pin_diameter_m = Some(0.006);
    scene
}

/// cycloidgen 8.0.0: `cantilever_stiffness(210e3, 0.3, 6, 5 or 14)`, `simply_supported_stiffness(.., 19, 5 or 14)` (N/mm),
/// `annulus_torsion_stiffness` of its bearing steel, 6 mm from 36 to 42 mm (N mm/rad).
#[test]
fn published_beams_and_plate_of_cycloidgen() {
    let own = |held| {
        let influence = pins(held).pin_influence_m_n().unwrap();
        [0, 1].map(|disc: usize| 1e-3 / influence[disc][disc])
    };
    let [near, far] = own(Held::OneEnd);
    close(near, 178923.51909898117, 1e-12);
    close(far, 13265.877226986559, 1e-12);
    for stiffness in own(Held::BothEnds) {
        close(stiffness, 121141.98175075786, 1e-12);
    }
    let mut scene = pins(Held::OneEnd);
    scene.gear.internal_circle_radius_m = 0.036;
    let structure = &mut scene.structure;
    (structure.plate_thickness_m, structure.plate_radius_m) = (Some(0.006), Some(0.042));
    close(1e3 / scene.flange_twist_rad(1.0), 29748480691.206333, 1e-12);
    // A shaft on the input side counts by the ratio squared.
    scene.structure = Structure {
        input_torsion_n_m_rad: Some(500.0),
        ..Structure::default()
    };
    close(scene.flange_twist_rad(2.0), 2.0 / (500.0 * 225.0), 1e-12);
}

/// By the work of a unit force at either disc (Castigliano), integrated along the pin: M M'/(E I) + V V'/(k G A).
#[test]
fn published_beams_between_two_discs() {
    let (section, inertia) = (
        9e-6 * std::f64::consts::PI,
        81e-12 / 4.0 * std::f64::consts::PI,
    );
    let shear = 6.0 * 1.3 / (7.0 + 1.8) * 2.1e11 / 2.6 * section;
    let (places, span) = ([0.005, 0.014], 0.019);
    for held in [Held::OneEnd, Held::BothEnds] {
        let loads = |x: f64, at: f64| match held {
            Held::OneEnd => [(at - x).max(0.0), f64::from(u8::from(x < at))],
            Held::BothEnds if x < at => [x * (span - at) / span, (span - at) / span],
            Held::BothEnds => [(span - x) * at / span, -at / span],
        };
        let steps = 20_000;
        let work = (0..steps).map(|k| {
            let x = (f64::from(k) + 0.5) / f64::from(steps) * span;
            let [one, other] = places.map(|at| loads(x, at));
            one[0] * other[0] / (2.1e11 * inertia) + one[1] * other[1] / shear
        });
        let wanted = work.sum::<f64>() * span / f64::from(steps);
        let influence = pins(held).pin_influence_m_n().unwrap();
        close(influence[0][1], wanted, 2e-4);
        assert_eq!(influence[0][1], influence[1][0]);
    }
}

/// Palmgren's steel rollers by his constant for steel, 3.84e-5 F^0.9/l^0.8 (mm, N), under 4 T/(e zs zk).
#[test]
fn published_seat_is_palmgrens_line_contact() {
    let mut scene = pins(Held::OneEnd);
    scene.contact.young_pa = 2.06e11;
    scene.structure.ring_seat_length_m = Some(0.016);
    let force: f64 = 4.0 * 11.0 / (0.0028 * 15.0 * 16.0);
    let approach_mm = 3.84e-5 * force.powf(0.9) / 16_f64.powf(0.8);
    close(
        scene.ring_seat_n_m().unwrap(),
        1e3 * force / approach_mm,
        0.005,
    );
    // A seat displaces its pin: entirely if held at one end, by the lever if held at both ends.
    let bent = |seat: Option<f64>, held| {
        let mut scene = pins(held);
        scene.structure.output_seat_length_m = seat;
        scene.pin_influence_m_n().unwrap()
    };
    let grown = |held| {
        let [without, with] = [None, Some(0.01)].map(|seat| bent(seat, held));
        [0, 1].map(|other: usize| with[0][other] - without[0][other])
    };
    let [own, other] = grown(Held::OneEnd);
    close(own, other, 1e-9);
    let [a, b] = [5.0 / 19.0, 14.0 / 19.0];
    let [at_both, beside] = grown(Held::BothEnds);
    close(at_both / own, (1.0 - a) * (1.0 - a) + a * a, 1e-9);
    close(beside / own, (1.0 - a) * (1.0 - b) + a * b, 1e-9);
}

/// Sizes by hand: an aluminium ring, steel discs and pins.
#[test]
fn published_sizes_of_warm_parts() {
    let mut scene = Scene::paper();
    scene.contact.material = Some("steel".into());
    scene.structure.housing_material = Some("aluminium".into());
    scene.temperature = Some(Temperature {
        housing_k: 30.0,
        disc_k: 10.0,
        pins_k: 20.0,
    });
    let (gear, warm) = (&scene.gear, &scene.at_work().gear);
    let radius = gear.pitch_radius_m();
    assert_eq!(warm.backlash_m, 0.0);
    close(
        -warm.modification.radial_m,
        radius * (30.0 * 2.3e-5 - 10.0 * 1.15e-5),
        1e-9,
    );
    close(
        warm.generating_radius_m(),
        radius * (1.0 + 10.0 * 1.15e-5),
        1e-12,
    );
    close(
        warm.external_sleeve_radius_m,
        0.006 * (1.0 + 20.0 * 1.15e-5),
        1e-12,
    );
    close(warm.edge_offset_m(), 0.006 * (1.0 + 10.0 * 1.15e-5), 1e-12);
    close(warm.hole_radius_m, 0.0088 * (1.0 + 10.0 * 1.15e-5), 1e-12);
    close(
        warm.internal_sleeve_radius_m,
        0.006 * (1.0 + 20.0 * 1.15e-5),
        1e-12,
    );
    scene.temperature = None;
    scene.structure.ring_slot_clearance_m = Some(5e-6);
    close(scene.at_work().gear.modification.equidistant_m, 5e-6, 1e-9);
}

#[test]
fn bad_input_structure_and_temperature_name_key_and_remedy() {
    let refused = |change: fn(&mut Scene)| -> Fault {
        let mut scene = pins(Held::OneEnd);
        change(&mut scene);
        scene.check().unwrap_err()
    };
    let cases: [(fn(&mut Scene), &str, &str); 9] = [
        (
            |s| s.bearings.internal_sleeves_held = None,
            "bearings.internal_sleeves_held",
            "one-end",
        ),
        (
            |s| s.bearings.internal_sleeve_stiffness_n_m = Some(1e8),
            "bearings.internal_sleeve_stiffness_n_m",
            "leave one",
        ),
        (
            |s| s.structure.output_pin_diameter_m = Some(0.013),
            "structure.output_pin_diameter_m",
            "at most",
        ),
        (|s| s.gear.wheels = 5, "gear.wheels", "leave it out"),
        (
            |s| {
                s.structure.output_pin_diameter_m = None;
                s.structure.output_seat_length_m = Some(0.01);
            },
            "structure.output_pin_diameter_m",
            "give it too",
        ),
        (
            |s| s.structure.plate_thickness_m = Some(0.01),
            "structure.plate_radius_m",
            "both or none",
        ),
        (
            |s| s.structure.ring_slot_clearance_m = Some(0.005),
            "structure.ring_slot_clearance_m",
            "smaller",
        ),
        (
            |s| s.temperature = Some(Temperature::default()),
            "contact.material",
            "name",
        ),
        (
            |s| {
                s.contact.material = Some("pla".into());
                s.temperature = Some(Temperature {
                    housing_k: 900.0,
                    disc_k: -299.0,
                    pins_k: 0.0,
                });
            },
            "temperature.housing_k",
            "smaller",
        ),
    ];
    for (change, key, remedy) in cases {
        let fault = refused(change);
        assert!(fault.keys.iter().any(|one| one == key), "{fault:?}");
        assert!(fault.remedy.contains(remedy), "{fault:?}");
    }
    let sets = ["temperature.disc_k=2000".parse().unwrap()];
    let message = Scene::load("paper", &sets).unwrap_err().to_string();
    assert!(
        message.contains("temperature.disc_k") && message.contains("1000 K"),
        "{message}"
    );
    assert!(pins(Held::BothEnds).check().is_ok());
}
