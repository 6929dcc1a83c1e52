//! Numbers with units as people type them.

use pinwheel_scene::quantity::read;

#[test]
fn numbers_as_people_type_them() {
    for (typed, wanted, value) in [
        ("104mm", "mm", 104.0),
        ("10.4 cm", "mm", 104.0),
        ("0.104 m", "mm", 104.0),
        ("0,052", "m", 0.052),
        ("52mm", "m", 0.052),
        ("1e-3", "m", 1e-3),
        ("1e3 mm", "m", 1.0),
        ("200 Nm", "n_m", 200.0),
        ("0.2 kN m", "n_m", 200.0),
        ("210 GPa", "pa", 2.1e11),
        ("-200", "n_m", -200.0),
        ("5e", "m", f64::NAN),
        ("104 rpm", "m", f64::NAN),
        ("mm", "m", f64::NAN),
        ("1.000,5", "m", f64::NAN),
    ] {
        let read = read(typed, wanted).unwrap_or(f64::NAN);
        assert!(
            read == value || (read.is_nan() && value.is_nan()),
            "{typed}: {read}"
        );
    }
}
