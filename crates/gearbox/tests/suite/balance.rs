//! Energy that a run may gain or lose.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::energy::EnergyAudit;
use pinwheel_gearbox::internals::{Balance, elastic_j};
use pinwheel_scene::Scene;

fn audit(driver_j: f64, remainder_j: f64) -> EnergyAudit {
    EnergyAudit {
        from_s: 0.0,
        to_s: 1.0,
        driver_j,
        load_j: -driver_j,
        remainder_j,
        remainder_share: Some(remainder_j / driver_j),
        ..EnergyAudit::default()
    }
}

/// The initial turnover is the elastic energy: by hand for the paper's gear, whose load twists it, and for a gear without load,
/// with the least force instead.
#[test]
fn what_is_held_counts_as_turned_over() {
    let held = |load: f64| {
        let mut scene = Scene::paper();
        scene.drive.output_torque_n_m = load;
        let gearbox = Gearbox::new(&scene.check().unwrap()).unwrap();
        let scales = gearbox.error_scales();
        let least = gearbox.least_force_n() * scales.length;
        (elastic_j(&gearbox), scales.angle, least)
    };
    let (loaded, angle, _) = held(-22.0);
    assert!((loaded / (22.0 * angle) - 1.0).abs() < 1e-12, "{loaded}");
    let (idle, _, least) = held(0.0);
    assert!((idle / least - 1.0).abs() < 1e-12, "{idle}");
}

#[test]
fn remainders_add_up() {
    let mut balance = Balance {
        remainder_j: 0.0,
        turnover_j: 0.0,
    };
    assert!(balance.add(&audit(1.0, 3.0)).is_ok(), "3 of 2 J");
    assert!(balance.add(&audit(1.0, -3.0)).is_ok(), "they cancel");
    let mut loses = balance.clone();
    assert!(
        loses.add(&audit(0.1, -9.0)).is_err(),
        "lost is as bad as gained"
    );
    let reason = balance.add(&audit(0.1, 9.0)).unwrap_err();
    assert!(reason.starts_with("9.000e0 J of energy"), "{reason}");
}
