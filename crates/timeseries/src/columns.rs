//! Names of the columns that every engine records. A name ends in its unit and, for several of a kind, in a number; further
//! columns are channels that a scene requests.
//!
//! ```
//! use pinwheel_timeseries::columns;
//!
//! let names: Vec<String> = columns::of_gearbox(2, 1).collect();
//! assert_eq!(names[..2], ["input_torque_n_m", "output_torque_n_m"]);
//! assert_eq!(names[3..], ["external_sleeve_force_n_0", "external_sleeve_force_n_1", "internal_sleeve_force_n_0"]);
//! ```

/// Time, s.
pub const TIME: &str = "time_s";
/// Torque of the driver on the input shaft, N m, counter-clockwise positive.
pub const INPUT_TORQUE: &str = "input_torque_n_m";
/// Torque on the output shaft without its load, N m, counter-clockwise positive: forces of the output pins, with friction
/// couples of sleeves and seals if modelled.
pub const OUTPUT_TORQUE: &str = "output_torque_n_m";
/// Angle of the output shaft, rad, 0 at the start, counter-clockwise positive.
pub const OUTPUT_ANGLE: &str = "output_angle_rad";
/// Group: magnitude of the resultant force of all discs on a ring pin, N.
pub const EXTERNAL_FORCE: &str = "external_sleeve_force_n";
/// Group: magnitude of the resultant force of all discs on an output pin, N.
pub const INTERNAL_FORCE: &str = "internal_sleeve_force_n";

/// Columns before those of the pins.
pub const HEAD: [&str; 3] = [INPUT_TORQUE, OUTPUT_TORQUE, OUTPUT_ANGLE];

/// Returns the name of column `number` of a group.
pub fn numbered(group: &str, number: usize) -> String {
    format!("{group}_{number}")
}

/// Returns the columns of a gearbox after the time, in order.
pub fn of_gearbox(
    external_sleeves: usize,
    internal_sleeves: usize,
) -> impl Iterator<Item = String> {
    let head = HEAD.iter().map(|&name| name.to_owned());
    let externals = (0..external_sleeves).map(|j| numbered(EXTERNAL_FORCE, j));
    let internals = (0..internal_sleeves).map(|k| numbered(INTERNAL_FORCE, k));
    head.chain(externals).chain(internals)
}
