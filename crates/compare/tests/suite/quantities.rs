//! Quantities of series.

use pinwheel_compare::Quantity;
use pinwheel_compare::quantities::derive;
use pinwheel_timeseries::TimeSeries;

#[test]
fn names_give_labels_and_units() {
    for (name, label, unit) in [
        ("input_torque_n_m", "Driver torque", "N m"),
        ("output_torque_n_m", "Output torque", "N m"),
        ("external_sleeve_force_n", "Ring pin force", "N"),
        ("output_angle_rad", "Output angle", "rad"),
        ("wheel_speed_rad_s", "Disc speed", "rad/s"),
        (
            "wheel_0_external_stiffness_n_m15",
            "Disc 0 external stiffness",
            "N/m^1.5",
        ),
        ("transmission_error_arcmin", "Transmission error", "arcmin"),
        ("external_contact_ratio", "External contact ratio", ""),
        ("odd", "Odd", ""),
        ("_n", " n", ""),
    ] {
        let quantity = Quantity::new(name);
        assert_eq!(
            (quantity.label.as_str(), quantity.unit.as_str()),
            (label, unit),
            "{name}"
        );
    }
}

#[test]
fn groups_are_joined_and_sorted() {
    let mut first = TimeSeries::new(vec![0.0]).unwrap();
    for name in ["torque_n_m", "force_n_10", "force_n_2"] {
        first.push(name, vec![0.0]).unwrap();
    }
    let mut second = TimeSeries::new(vec![0.0]).unwrap();
    for name in ["force_n_2", "force_n_0", "extra_w"] {
        second.push(name, vec![0.0]).unwrap();
    }
    let quantities = derive([&first, &second]);
    let names: Vec<_> = quantities.iter().map(|q| q.name.as_str()).collect();
    assert_eq!(names, ["torque_n_m", "force_n", "extra_w"]);
    assert_eq!(
        quantities[1].channels,
        ["force_n_0", "force_n_2", "force_n_10"]
    );
}
