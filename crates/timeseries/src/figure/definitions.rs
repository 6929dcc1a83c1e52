//! Definitions of a gear's figures for tables, pages, files, sweeps and the comparison of two designs.

use super::FigureDef;

/// Significant digits of a design's figure, as in a data sheet.
pub const DIGITS: u8 = 4;

/// Defines figures, each with key, description, unit and rule of counting, and the list of all.
macro_rules! definitions {
    ($list:ident, $digits:expr; $($name:ident = $key:literal, $label:literal, $unit:literal, $how:literal;)*) => {
        $(#[doc = $label] pub static $name: FigureDef =
            FigureDef::new($key, $label, $unit, $how, $digits);)*
        static $list: &[&FigureDef] = &[$(&$name),*];
    };
}

definitions! { OF_DESIGNS, DIGITS;
    LOST_MOTION = "lost_motion_arcmin", "lost motion", "arcmin",
        "largest over the mesh, between +3 and -3 % of the rated torque";
    STIFFNESS = "torsional_stiffness_n_m_per_arcmin", "torsional stiffness", "N m/arcmin",
        "between 50 and 100 % of the rated torque, mean";
    ERROR_RATED = "transmission_error_rated_arcmin", "transmission error, rated load", "arcmin",
        "peak to peak";
    ERROR_NO_LOAD = "transmission_error_no_load_arcmin", "transmission error, no load", "arcmin",
        "peak to peak, at a ten-thousandth of the load";
    EXTERNAL_FORCE = "external_force_n", "largest pin force, external", "N",
        "largest of a pose";
    INTERNAL_FORCE = "internal_force_n", "largest pin force, internal", "N",
        "largest of a pose";
    CRANK_FORCE = "crank_bearing_force_n", "crank bearing, largest force", "N",
        "largest of a pose, of all discs and cranks";
    EXTERNAL_TOUCHING = "external_touching", "ring pins that carry", "",
        "touch a disc, on average";
    INTERNAL_TOUCHING = "internal_touching", "output pins that carry", "",
        "touch a disc, on average";
    EXTERNAL_PRESSURE = "external_pressure_mpa", "largest pressure, external", "MPa",
        "line contact over the face width, edges left out";
    INTERNAL_PRESSURE = "internal_pressure_mpa", "largest pressure, internal", "MPa",
        "line contact over the face width, edges left out";
    PRESSURE_SLIDING = "pressure_sliding_mpa_m_s", "largest pressure times sliding", "MPa m/s",
        "on pins that do not turn";
    BEARING_FORCE = "eccentric_bearing_force_n", "eccentric bearing, largest force", "N",
        "largest of a pose, of all discs";

    BEARING_LIFE = "eccentric_bearing_life_h", "eccentric bearing, basic rating life", "h",
        "L10h after ISO 281 of the most loaded disc, rated speed and load throughout";

    STATIC_SAFETY = "eccentric_bearing_static_safety", "eccentric bearing, static safety", "",
        "C0/F of the largest force, C0 by its rollers after ISO 76";
    PIN_BENDING = "output_pin_bending_mpa", "bending of output pins", "MPa",
        "32 M/(pi d^3) of a round pin, its discs' forces in one plane, in the worse order";
    PROJECTED_SLIDING = "sleeve_pressure_sliding_mpa_m_s", "pressure times sliding of a sleeve", "MPa m/s",
        "F v/(d L) of the sleeve on its pin, or of the disc on a pin that does not turn: both are the same";
    WALL = "wall_mm", "thinnest wall of a disc", "mm", "between holes, or from one to edge or bore";
    WALL_SHEAR = "wall_shear_mpa", "shear of the thinnest wall", "MPa",
        "F/(2 t b): a pin that presses on a wall of t tears it out along two planes";

    BEARING_LOSS = "eccentric_bearing_loss_percent", "eccentric bearings, friction loss", "%",
        "mu F d/2 against their turning, of the rated output power";

    SLEEVE_LOSS = "sleeve_loss_percent", "sleeves on their pins, friction loss", "%",
        "mu F d/2 against their turning as they roll, of the rated output power";
    SEAL_LOSS = "seal_loss_percent", "seals, friction loss", "%",
        "their torques at rated speed, of the rated output power";

    LOST_MOTION_RUN = "lost_motion_run_arcmin", "lost motion by a run", "arcmin",
        "of a slow loop of the load, the mean of both branches";
    LOOP_WIDTH = "hysteresis_width_arcmin", "width of the loop at no load", "arcmin",
        "what friction holds back, and what swings";
    HYSTERESIS = "hysteresis_arcmin", "hysteresis", "arcmin",
        "largest over the mesh: width of the loop that friction makes at 3 % of the rated torque, by statics, input locked";
    HYSTERESIS_NO_LOAD = "hysteresis_no_load_arcmin", "hysteresis, no load", "arcmin",
        "likewise at a ten-thousandth of the load; with seals it contains the play";
    EFFICIENCY = "efficiency_rated_percent", "efficiency, rated", "%",
        "from the losses of a run";
    EFFICIENCY_SLOW = "efficiency_slow_percent", "efficiency, slow motion", "%",
        "by statics at the rated load: all parts with friction slide as in the ideal mesh; 0 if it locks";

    JOINT_BACKLASH = "joint_backlash_arcmin", "free play", "arcmin",
        "between both directions at a ten-thousandth of the rated torque, mean; without play the deflection of the first contacts";
    JOINT_STIFFNESS = "joint_stiffness_n_m_per_rad", "torsional stiffness", "N m/rad",
        "of the mean twist, between 50 and 100 % of the rated torque";
    JOINT_DEAD_BAND = "joint_dead_band_arcmin", "dead band of that stiffness alone", "arcmin",
        "for a model of one spring; above the free play, as the first pins give way more";
    JOINT_DAMPING = "joint_damping_n_m_s_per_rad", "damping beside the stiffness", "N m s/rad",
        "of the contacts about the rated load";
    JOINT_FRICTION = "joint_friction_n_m", "friction, constant", "N m",
        "at the output, fitted to the losses of runs";
    JOINT_FRICTION_OF_LOAD = "joint_friction_of_load_n_m", "friction, of the rated load", "N m",
        "at the output, fitted to the losses of runs; in proportion to the load";
    JOINT_VISCOUS = "joint_viscous_n_m_s_per_rad", "friction, viscous", "N m s/rad",
        "at the output, fitted to the losses of runs; in proportion to the output's speed";
    JOINT_INPUT_INERTIA = "joint_input_inertia_kg_m2", "inertia at the input", "kg m^2",
        "input shaft, and the discs' masses on its eccentrics";
    JOINT_OUTPUT_INERTIA = "joint_output_inertia_kg_m2", "inertia at the output", "kg m^2",
        "output with its pins, and the discs, which turn with it";
    JOINT_REFLECTED_INERTIA = "joint_reflected_inertia_kg_m2", "inertia, reflected to the output", "kg m^2",
        "the input's times the ratio squared, and the output's";
}

definitions! { OF_RUNS, 5;
    SHARE_DELIVERED = "efficiency", "efficiency", "", "by what is lost";
    SHARE_LOST = "lost_share", "lost", "", "of delivered and lost work";
    SHARE_CREATED = "created_share", "created by the contact law", "", "of the work taken";
    SHARE_CONTACTS = "contact_friction_share", "contacts", "", "lost by friction";
    SHARE_BEARINGS = "bearing_friction_share", "bearings", "", "lost by friction";
    SHARE_SLEEVES = "sleeve_friction_share", "sleeves on pins", "", "lost by friction";
    SHARE_SEALS = "seal_friction_share", "seals", "", "lost by friction";
}

/// Returns all definitions.
pub fn all() -> impl Iterator<Item = &'static FigureDef> {
    OF_DESIGNS.iter().chain(OF_RUNS).copied()
}

/// Shares of the loss by friction, by sliding part.
pub static FRICTION: [&FigureDef; 4] = [
    &SHARE_CONTACTS,
    &SHARE_BEARINGS,
    &SHARE_SLEEVES,
    &SHARE_SEALS,
];
