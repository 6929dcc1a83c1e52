//! Formulas for omitted keys. The text of each formula stands beside its key ([`crate::keys`]).

use toml::Table;

use crate::body::{Shape, bore_radius_m};
use crate::model::{Gear, Scene};
use crate::scales::{Scales, hertz};
use crate::speed_profile::fastest_rad_s;
use crate::table::number;

/// Values so far: given, or filled in from earlier rows of the key table.
pub struct Inputs<'a> {
    pub(crate) table: &'a Table,
    /// Scene so far, with placeholders for missing rows.
    pub(crate) scene: &'a Scene,
    /// True if all rows of `gear` and `drive` are present and consistent.
    pub(crate) gear_is_sound: bool,
}

/// Density of steel, kg/m^3, for omitted masses without a density.
const STEEL: f64 = 7850.0;
/// Face width over R for omitted masses without a face width; usual are 0.1 to 0.2.
const FACE: f64 = 0.15;
/// Damping of the fastest mode as a share of critical damping.
const DAMPING: f64 = 0.05;

impl Inputs<'_> {
    fn number(&self, name: &str) -> Option<f64> {
        number(self.table, name)
    }

    fn gear(&self) -> Option<&Gear> {
        self.gear_is_sound.then_some(&self.scene.gear)
    }

    fn scales(&self) -> Option<Scales> {
        self.gear()?;
        Some(Scales::of(self.scene))
    }

    /// Returns the largest speed of the input, rad/s.
    fn speed(&self) -> Option<f64> {
        self.number("drive.input_speed_rad_s")?;
        Some(fastest_rad_s(&self.scene.drive).abs())
    }

    fn density(&self) -> f64 {
        self.number("mass.density_kg_m3").unwrap_or(STEEL)
    }

    /// Returns the mass of a flat shape with a thickness in face widths, kg.
    fn mass(
        &self,
        shape: impl FnOnce(&Gear) -> Shape,
        widths: impl FnOnce(&Gear) -> f64,
    ) -> Option<f64> {
        let gear = self.gear()?;
        Some(self.density() * face_width(self)? * widths(gear) * shape(gear).area_m2)
    }

    /// Returns the moment of inertia of a body of that shape with the mass at key `name`, kg m^2.
    fn moment(&self, name: &str, shape: impl FnOnce(&Gear) -> Shape) -> Option<f64> {
        Some(self.number(name)? * shape(self.gear()?).gyration_m2())
    }
}

pub(crate) fn shortening(inputs: &Inputs<'_>) -> Option<f64> {
    let radius = inputs.number("gear.pin_circle_radius_m")?;
    Some(inputs.number("gear.eccentricity_m")? * inputs.number("gear.external_sleeves")? / radius)
}

pub(crate) fn cranks(inputs: &Inputs<'_>) -> Option<f64> {
    inputs.number("cranks.count")
}

pub(crate) fn crank_circle(inputs: &Inputs<'_>) -> Option<f64> {
    inputs.number("cranks.circle_radius_m")
}

pub(crate) fn crank_shaft(inputs: &Inputs<'_>) -> Option<f64> {
    let eccentricity = inputs.number("gear.eccentricity_m")?;
    let shaft = inputs.number("cranks.bore_radius_m")? - eccentricity;
    // The check of cranks reports a bore that leaves no shaft.
    Some(if shaft > 0.0 { shaft } else { eccentricity })
}

pub(crate) fn hole_radius(inputs: &Inputs<'_>) -> Option<f64> {
    Some(inputs.number("gear.internal_sleeve_radius_m")? + inputs.number("gear.eccentricity_m")?)
}

pub(crate) fn face_width(inputs: &Inputs<'_>) -> Option<f64> {
    let gear = inputs.gear()?;
    let stated = inputs.number("gear.face_width_m");
    Some(stated.unwrap_or_else(|| FACE * gear.pitch_radius_m()))
}

macro_rules! bodies {
    ($($mass:ident $moment:ident $name:literal, $shape:expr, $widths:expr;)*) => {
        $(
            pub(crate) fn $mass(inputs: &Inputs<'_>) -> Option<f64> {
                inputs.mass($shape, $widths)
            }

            pub(crate) fn $moment(inputs: &Inputs<'_>) -> Option<f64> {
                inputs.moment($name, $shape)
            }
        )*
    };
}

bodies! {
    input_shaft_mass input_shaft_moment "mass.input_shaft.mass_kg", |gear| Shape::disc(bore_radius_m(gear)), all_wheels;
    output_shaft_mass output_shaft_moment "mass.output_shaft.mass_kg", |gear| Shape::disc(gear.internal_circle_radius_m + gear.internal_sleeve_radius_m), |_| 1.0;
    wheel_mass wheel_moment "mass.wheel.mass_kg", Shape::wheel, |_| 1.0;
    internal_sleeve_mass internal_sleeve_moment "mass.internal_sleeve.mass_kg", |gear| Shape::disc(gear.internal_sleeve_radius_m), all_wheels;
    external_sleeve_mass external_sleeve_moment "mass.external_sleeve.mass_kg", |gear| Shape::disc(gear.external_sleeve_radius_m), all_wheels;
}

fn all_wheels(gear: &Gear) -> f64 {
    gear.wheels as f64
}

pub(crate) fn damping(inputs: &Inputs<'_>) -> Option<f64> {
    let scales = inputs.scales()?;
    Some(short(
        2.0 * DAMPING * scales.contact_stiffness_n_m / scales.modes_rad_s[1],
    ))
}

pub(crate) fn ramp(inputs: &Inputs<'_>) -> Option<f64> {
    Some(short(0.1 * inputs.scales()?.penetration_m))
}

pub(crate) fn friction_ramp(inputs: &Inputs<'_>) -> Option<f64> {
    let speed = inputs.speed()?;
    let speed = if speed > 0.0 { speed } else { 1.0 };
    let ramp = 1e-3 * speed * inputs.number("gear.eccentricity_m")?;
    // Least value that the key may have.
    Some(short(ramp.max(1e-18)))
}

pub(crate) fn friction_dynamic_speed(inputs: &Inputs<'_>) -> Option<f64> {
    Some(20.0 * inputs.number("contact.friction_ramp_m_s")?)
}

pub(crate) fn constant_stiffness(inputs: &Inputs<'_>) -> Option<f64> {
    let radius = inputs.gear()?.external_sleeve_radius_m;
    Some(short(hertz(inputs.scene).on_flat(radius)))
}

pub(crate) fn wheel_points(inputs: &Inputs<'_>) -> Option<f64> {
    Some((100.0 * inputs.gear()?.lobes() as f64).max(4000.0))
}

/// Returns the period of an input turn, s; of a gear at rest ten periods of its slowest mode.
fn turn(inputs: &Inputs<'_>, scales: &Scales) -> Option<f64> {
    let speed = inputs.speed()?;
    let tau = std::f64::consts::TAU;
    Some(if speed > 0.0 {
        tau / speed
    } else {
        10.0 * tau / scales.modes_rad_s[0]
    })
}

pub(crate) fn duration(inputs: &Inputs<'_>) -> Option<f64> {
    let scales = inputs.scales()?;
    let turn = turn(inputs, &scales)?;
    let last = crate::load_profile::last_change_s(inputs.scene).unwrap_or(0.0);
    let settled = scales.settling_s(inputs.scene.contact.damping_n_s_m);
    let quiet = settled.map_or(10.0 * turn, |settled| settled + 2.0 * turn);
    Some(short(last + quiet.clamp(3.0 * turn, 10.0 * turn)))
}

pub(crate) fn sample(inputs: &Inputs<'_>) -> Option<f64> {
    let scales = inputs.scales()?;
    let turn = turn(inputs, &scales)? / inputs.scene.eccentric_per_input().abs();
    let mesh = turn / inputs.gear()?.external_sleeves as f64;
    let fast = std::f64::consts::TAU / scales.modes_rad_s[1];
    let duration = inputs.number("solver.duration_s")?;
    let wanted = (mesh / 40.0).min(fast / 4.0).max(duration / 20_000.0);
    // An integer number of samples makes all intervals equal.
    Some(duration / (duration / wanted).ceil())
}

pub(crate) fn step(inputs: &Inputs<'_>) -> Option<f64> {
    let fast = std::f64::consts::TAU / inputs.scales()?.modes_rad_s[1];
    let sample = inputs.number("solver.sample_s")?;
    // Engines with fixed steps need samples on steps.
    Some(sample / (sample / (fast / 50.0)).ceil())
}

/// Rounds to three significant digits: a formula's estimate is not exact.
fn short(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
