//! Hertz' stiffness as a function of the curvature.

use approx::assert_relative_eq;
use pinwheel_contact::{HertzStiffness, Material};

#[test]
fn profile_form_is_equation_23() {
    let steel = Material {
        young: 2.0e11,
        poisson: 0.3,
    };
    let steel = HertzStiffness::new(steel, steel, 0.01);
    let (q, kappa): (f64, f64) = (0.006, 65.96);
    let rc: f64 = 1.0 / kappa - q;
    let h: f64 = 0.91 / (std::f64::consts::PI * 2.0e11);
    let k = 4.0 * 0.01 / (3.0 * std::f64::consts::PI * 2.0 * h) * (rc * q / (rc + q)).sqrt();
    assert_relative_eq!(steel.of_edge(q, q, kappa), k, max_relative = 1e-14);
    // Pin of another radius than the profile's offset.
    let rp = 0.0061;
    let k = k * (rc * rp / (rc + rp) / (rc * q / (rc + q))).sqrt();
    assert_relative_eq!(steel.of_edge(rp, q, kappa), k, max_relative = 1e-14);
    assert_relative_eq!(
        steel.of_hole(0.006, 0.0088),
        steel.of(0.006, 0.018_857_142_857_142_857),
        max_relative = 1e-14
    );
}
