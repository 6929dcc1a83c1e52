//! The range of every single value.
//!
//! The outer bounds are wide (a watch to a wind turbine); their purpose is to catch millimetres
//! typed for metres and MPa for Pa, and to keep every later computation finite.

use super::super::error::{Fault, one_line, quoted};
use super::super::model::{BodyMass, Detection, Scene};
use super::super::names;
use super::super::suggest::did_you_mean;
use super::number::short;
use crate::FrictionLaw;

/// The allowed interval of one number.
#[derive(Clone, Copy)]
pub(super) enum Range {
    /// low < x <= high
    Above(f64, f64),
    /// low <= x <= high
    From(f64, f64),
    /// low < x < high
    Between(f64, f64),
}

impl Range {
    // Negated comparisons would let NaN pass; these do not.
    pub(super) fn holds(self, x: f64) -> bool {
        match self {
            Self::Above(low, high) => x > low && x <= high,
            Self::From(low, high) => x >= low && x <= high,
            Self::Between(low, high) => x > low && x < high,
        }
    }

    pub(super) fn words(self) -> String {
        match self {
            Self::Above(low, high) => format!("above {} and at most {}", short(low), short(high)),
            Self::From(low, high) => format!("from {} to {}", short(low), short(high)),
            Self::Between(low, high) => format!("between {} and {}", short(low), short(high)),
        }
    }
}

const METRES: &str = "lengths are in metres: 6 mm is 0.006";
const KILOGRAMS: &str = "masses are in kilograms: 48 g is 0.048";
const MOMENTS: &str = "moments of inertia are in kg m^2: 100 kg mm^2 is 1e-4";
pub(super) const SECONDS: &str = "times are in seconds: 10 microseconds is 1e-5";

/// Torques on the output shaft: range, unit, remedy.
pub(super) const TORQUE: (Range, &str, &str) = (
    Range::From(-1e9, 1e9),
    "N m",
    "give the load on the output shaft in newton metres",
);

/// Radii and distances: 0.1 micrometre to 10 m.
const LENGTH: Range = Range::From(1e-7, 10.0);

pub(super) fn check(scene: &Scene) -> Result<(), Fault> {
    name(scene)?;
    numbers(scene)?;
    counts(scene)?;
    masses(scene)?;
    combinations(scene)?;
    known(
        &scene.contact.law,
        "contact.law",
        "contact law",
        &names::laws(),
    )?;
    known(
        &scene.solver.integrator,
        "solver.integrator",
        "integrator",
        &names::integrators(),
    )
}

fn name(scene: &Scene) -> Result<(), Fault> {
    let name = &scene.name;
    if name.trim().is_empty() || name.chars().count() > 100 || name.chars().any(char::is_control) {
        return Err(Fault::new(
            &["name"],
            format!("is {}, which names no report", quoted(&one_line(name))),
            "give a name of 1 to 100 printable characters",
        ));
    }
    Ok(())
}

fn numbers(scene: &Scene) -> Result<(), Fault> {
    let (gear, drive, contact, solver) = (&scene.gear, &scene.drive, &scene.contact, &scene.solver);
    let rows: [(&'static str, f64, Range, &str, &str); 28] = [
        (
            "gear.eccentricity_m",
            gear.eccentricity_m,
            Range::From(1e-7, 1.0),
            "m",
            METRES,
        ),
        (
            "gear.shortening",
            gear.shortening,
            Range::Between(0.0, 1.0),
            "",
            "it is e zk/R, usually 0.5 to 0.9; at 1 and above the wheel's profile crosses itself",
        ),
        (
            "gear.external_sleeve_radius_m",
            gear.external_sleeve_radius_m,
            LENGTH,
            "m",
            METRES,
        ),
        (
            "gear.internal_sleeve_radius_m",
            gear.internal_sleeve_radius_m,
            LENGTH,
            "m",
            METRES,
        ),
        (
            "gear.internal_circle_radius_m",
            gear.internal_circle_radius_m,
            LENGTH,
            "m",
            METRES,
        ),
        (
            "gear.hole_radius_m",
            gear.hole_radius_m,
            LENGTH,
            "m",
            METRES,
        ),
        (
            "gear.backlash_m",
            gear.backlash_m,
            Range::From(0.0, 1.0),
            "m",
            METRES,
        ),
        (
            "drive.input_speed_rad_s",
            drive.input_speed_rad_s,
            Range::From(-1e6, 1e6),
            "rad/s",
            "500 rpm is 52.36 rad/s",
        ),
        (
            "drive.output_torque_n_m",
            drive.output_torque_n_m,
            TORQUE.0,
            TORQUE.1,
            TORQUE.2,
        ),
        (
            "drive.load_ramp_s",
            drive.load_ramp_s,
            Range::From(0.0, 1e5),
            "s",
            SECONDS,
        ),
        (
            "contact.young_pa",
            contact.young_pa,
            Range::From(1e5, 1e13),
            "Pa",
            "Young's modulus is in pascal: steel's 200 GPa is 2e11",
        ),
        (
            "contact.poisson",
            contact.poisson,
            Range::Between(-1.0, 0.5),
            "",
            "steel has 0.3; outside these bounds no isotropic material is stable",
        ),
        (
            "contact.stiffness_multiplier",
            contact.stiffness_multiplier,
            Range::Above(0.0, 1e6),
            "",
            "1 is the Hertzian stiffness, the paper uses 0.01",
        ),
        (
            "contact.damping_n_s_m",
            contact.damping_n_s_m,
            Range::From(0.0, 1e9),
            "N s/m",
            "the paper uses 8; negative damping would feed energy in",
        ),
        (
            "contact.ramp_m",
            contact.ramp_m,
            Range::Above(0.0, 1e-2),
            "m",
            "the paper uses 1e-5, the penetration at which the force is fully on",
        ),
        (
            "contact.friction_coefficient",
            contact.friction_coefficient,
            Range::From(0.0, 10.0),
            "",
            "0 switches friction off; dry steel has 0.1 to 0.2",
        ),
        (
            "contact.friction_ramp_m_s",
            contact.friction_ramp_m_s,
            Range::Above(0.0, 1e3),
            "m/s",
            "the paper uses 5e-5, the sliding speed at which friction is fully on",
        ),
        (
            "contact.friction_dynamic_coefficient",
            contact.friction_dynamic_coefficient,
            Range::From(0.0, 10.0),
            "",
            "the coefficient of fast sliding, at most contact.friction_coefficient",
        ),
        (
            "contact.friction_dynamic_speed_m_s",
            contact.friction_dynamic_speed_m_s,
            Range::Above(0.0, 1e3),
            "m/s",
            "the sliding speed from which the dynamic coefficient holds",
        ),
        (
            "contact.constant_stiffness_n_m15",
            contact.constant_stiffness_n_m15,
            Range::Above(0.0, 1e15),
            "N/m^1.5",
            "the paper's contacts have 5e7 to 2e8 N/m^1.5",
        ),
        (
            "contact.restitution",
            contact.restitution,
            Range::Above(0.0, 1.0),
            "",
            "the share of the impact speed that is left after an impact, 1 without loss",
        ),
        (
            "contact.impact_speed_m_s",
            contact.impact_speed_m_s,
            Range::From(1e-9, 1e3),
            "m/s",
            "the impact speed at which the restitution holds; 0.01 is usual in a gearbox",
        ),
        (
            "contact.line_length_m",
            contact.line_length_m,
            Range::From(1e-6, 10.0),
            "m",
            METRES,
        ),
        (
            "solver.step_s",
            solver.step_s,
            Range::From(1e-12, 1.0),
            "s",
            SECONDS,
        ),
        (
            "solver.tolerance",
            solver.tolerance,
            Range::Between(1e-14, 1e-1),
            "",
            "1e-6 is a good start; below 1e-14 there are no digits left",
        ),
        (
            "solver.duration_s",
            solver.duration_s,
            Range::From(1e-9, 1e5),
            "s",
            SECONDS,
        ),
        (
            "solver.sample_s",
            solver.sample_s,
            Range::From(1e-12, 1e5),
            "s",
            SECONDS,
        ),
        // Listed last: an odd profile is easier to judge once the sizes are right.
        (
            "gear.external_sleeves",
            gear.external_sleeves as f64,
            Range::From(3.0, 1000.0),
            "",
            "a wheel has one lobe less and needs at least two; above 1000 no real gear exists and memory would grow without use",
        ),
    ];
    for (key, value, range, unit, remedy) in rows {
        if range.holds(value) {
            continue;
        }
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!(" {unit}")
        };
        let what = format!(
            "is {}{unit}, but must be {}{unit}",
            short(value),
            range.words()
        );
        return Err(Fault::new(&[key], what, remedy));
    }
    Ok(())
}

fn counts(scene: &Scene) -> Result<(), Fault> {
    let gear = &scene.gear;
    let contact = &scene.contact;
    let rows: [(&'static str, usize, usize, usize, &str); 4] = [
        (
            "gear.internal_sleeves",
            gear.internal_sleeves,
            3,
            1000,
            "fewer than three cannot hold the output shaft, more than 1000 no real gear has",
        ),
        (
            "gear.wheels",
            gear.wheels,
            1,
            64,
            "most gears have one to three wheels; every wheel meets every sleeve, so memory and time grow with it",
        ),
        (
            "contact.wheel_points",
            contact.wheel_points,
            24,
            1_000_000,
            "the paper uses 600 and 4000; more than a million costs memory and gains nothing over detection = \"exact\"",
        ),
        (
            "contact.hole_points",
            contact.hole_points,
            8,
            1_000_000,
            "the paper uses 20 to 100; more than a million costs memory and gains nothing over detection = \"exact\"",
        ),
    ];
    for (key, value, low, high, remedy) in rows {
        if !(low..=high).contains(&value) {
            return Err(Fault::new(
                &[key],
                format!("is {value}, but must be from {low} to {high}"),
                remedy,
            ));
        }
    }
    // Eight points a lobe hardly tell a lobe from a pit; below that the profile is another one.
    let least = 8 * gear.lobes();
    if contact.detection == Detection::Points && contact.wheel_points < least {
        return Err(Fault::new(
            &["contact.wheel_points", "gear.external_sleeves"],
            format!(
                "is {}, too few to show {} lobes",
                contact.wheel_points,
                gear.lobes()
            ),
            format!("give at least {least} (eight a lobe), or detection = \"exact\""),
        ));
    }
    Ok(())
}

fn masses(scene: &Scene) -> Result<(), Fault> {
    let mass = &scene.mass;
    let rows: [(&BodyMass, &'static str, &'static str); 5] = [
        (
            &mass.input_shaft,
            "mass.input_shaft.mass_kg",
            "mass.input_shaft.moment_kg_m2",
        ),
        (
            &mass.output_shaft,
            "mass.output_shaft.mass_kg",
            "mass.output_shaft.moment_kg_m2",
        ),
        (&mass.wheel, "mass.wheel.mass_kg", "mass.wheel.moment_kg_m2"),
        (
            &mass.internal_sleeve,
            "mass.internal_sleeve.mass_kg",
            "mass.internal_sleeve.moment_kg_m2",
        ),
        (
            &mass.external_sleeve,
            "mass.external_sleeve.mass_kg",
            "mass.external_sleeve.moment_kg_m2",
        ),
    ];
    for (body, mass_key, moment_key) in rows {
        for (key, value, range, unit, remedy) in [
            (
                mass_key,
                body.mass_kg,
                Range::From(1e-9, 1e6),
                "kg",
                KILOGRAMS,
            ),
            (
                moment_key,
                body.moment_kg_m2,
                Range::From(1e-18, 1e8),
                "kg m^2",
                MOMENTS,
            ),
        ] {
            if !range.holds(value) {
                let what = format!(
                    "is {} {unit}, but must be {} {unit}",
                    short(value),
                    range.words()
                );
                return Err(Fault::new(&[key], what, remedy));
            }
        }
    }
    Ok(())
}

/// Laws that do not go with every detection, friction or integrator.
fn combinations(scene: &Scene) -> Result<(), Fault> {
    let contact = &scene.contact;
    if contact.law == "paper-conservative" && contact.detection == Detection::Points {
        return Err(Fault::new(
            &["contact.detection", "contact.law"],
            "is \"points\", on which the stiffness of the law \"paper-conservative\" has no slope",
            "use detection = \"exact\" or law = \"paper\"",
        ));
    }
    if contact.friction_law == FrictionLaw::Adams {
        if contact.friction_dynamic_coefficient > contact.friction_coefficient {
            return Err(Fault::new(
                &[
                    "contact.friction_dynamic_coefficient",
                    "contact.friction_coefficient",
                ],
                format!(
                    "is {}, more than the static {}",
                    short(contact.friction_dynamic_coefficient),
                    short(contact.friction_coefficient)
                ),
                "the static coefficient is the larger one",
            ));
        }
        if contact.friction_dynamic_speed_m_s <= contact.friction_ramp_m_s {
            return Err(Fault::new(
                &[
                    "contact.friction_dynamic_speed_m_s",
                    "contact.friction_ramp_m_s",
                ],
                format!(
                    "is {} m/s, not above the speed of the static coefficient, {} m/s",
                    short(contact.friction_dynamic_speed_m_s),
                    short(contact.friction_ramp_m_s)
                ),
                "give a larger speed",
            ));
        }
        if scene.solver.integrator.starts_with("imex") && contact.friction_coefficient > 0.0 {
            return Err(Fault::new(
                &["solver.integrator", "contact.friction_law"],
                format!(
                    "is {}, which solves friction as a convex problem; a coefficient that falls with speed is none",
                    quoted(&scene.solver.integrator)
                ),
                "use friction_law = \"regularised\" or another integrator",
            ));
        }
    }
    Ok(())
}

fn known(typed: &str, key: &'static str, kind: &str, names: &[&str]) -> Result<(), Fault> {
    if names.contains(&typed) {
        return Ok(());
    }
    Err(Fault::new(
        &[key],
        format!("is {}, which is no {kind}", quoted(typed)),
        did_you_mean(typed, names),
    ))
}
