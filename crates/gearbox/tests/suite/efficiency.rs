//! Efficiency with and without energy created by the contact law.

use pinwheel_gearbox::Efficiency;
use pinwheel_gearbox::energy::EnergyAudit;

fn audit(driver_j: f64, load_j: f64, lost_j: f64) -> EnergyAudit {
    let remainder_j = lost_j - driver_j - load_j;
    EnergyAudit {
        from_s: 0.0,
        to_s: 1.0,
        driver_j,
        load_j,
        damping_j: 0.25 * lost_j,
        friction_j: 0.75 * lost_j,
        remainder_j,
        remainder_share: EnergyAudit::share(remainder_j, driver_j, load_j, 0.0),
        ..EnergyAudit::default()
    }
}

#[test]
fn what_the_law_creates_is_taken_out() {
    let computed = Efficiency::of(&audit(99.0, -100.0, 2.0)).unwrap();
    assert!((computed.measured - 100.0 / 99.0).abs() < 1e-15);
    assert!((computed.of_losses - 100.0 / 102.0).abs() < 1e-15);
    assert!((computed.created_share - 3.0 / 99.0).abs() < 1e-15);
    assert_eq!(computed.interval(), [computed.of_losses, computed.measured]);
    let why = computed.defined().unwrap_err();
    assert!(
        why.contains("creates 3.03 %") && why.contains("lose 1.96 %"),
        "{why}"
    );
}

#[test]
fn the_load_may_drive() {
    let computed = Efficiency::of(&audit(-90.0, 100.0, 10.0)).unwrap();
    assert!((computed.measured - 0.9).abs() < 1e-15 && (computed.of_losses - 0.9).abs() < 1e-15);
    assert_eq!(computed.created_share, 0.0);
    assert_eq!(computed.defined(), Ok(computed.of_losses));
    let mut smooth = computed;
    smooth.rubs = false;
    assert!(smooth.defined().unwrap_err().contains("no friction"));
    assert!(Efficiency::of(&audit(10.0, 10.0, 20.0)).is_none());
    assert!(Efficiency::of(&audit(0.0, 0.0, 0.0)).is_none());
}
