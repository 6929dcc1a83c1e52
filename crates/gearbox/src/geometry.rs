//! The gear's geometry: where everything sits at the ideal mesh.
//!
//! Wheel i of n has its centre at `e e^{i f}`, `f = phi + 2 pi i/n` with the input angle phi. It
//! meshes exactly at the angle `(pi - f)/zs`. External sleeve j sits at `(R + d) e^{2 pi i j/zk}`,
//! internal sleeve k at `R_w e^{i (psi + 2 pi k/zi)}` with the output angle psi; hole k of every wheel
//! stands around internal sleeve k at t = 0, its centre at `R_w` from the wheel's.

use std::cell::RefCell;
use std::f64::consts::{PI, TAU};

use pinwheel_contact::{Complex, Epitrochoid};
use pinwheel_faults::{Fault, armed};

use crate::GearboxError;
use crate::scene::Gear;

/// Derived geometry; wheel-frame points are relative to the wheel's centre.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// C, on which sleeve centres stand.
    pub curve: Epitrochoid,
    /// Sleeve directions e^{2 pi i j/zk}.
    pub external_directions: Vec<Complex>,
    /// Sleeve positions on the output shaft, shaft frame, m.
    pub internal_points: Vec<[f64; 2]>,
    /// 2 pi i/n.
    pub wheel_phases: Vec<f64>,
    /// Hole centres of every wheel, wheel frame, m.
    pub hole_centres: Vec<Vec<Complex>>,
    /// One external sleeve whose radius is smaller than the scene's, by so much (m): a fault to be found.
    pub small_sleeve: Option<(usize, f64)>,
    lobes: f64,
}

thread_local! {
    /// The last curve and what it was made of.
    static LAST: RefCell<Option<((f64, u32, f64), Epitrochoid)>> = const { RefCell::new(None) };
}

/// The curve. Its bounds are searched for, which takes as long as a thousand steps; the runs of a sweep mostly share it.
fn curve(eccentricity: f64, sleeves: u32, shortening: f64) -> Result<Epitrochoid, GearboxError> {
    let of = (eccentricity, sleeves, shortening);
    LAST.with_borrow_mut(|last| match last {
        Some((known, curve)) if *known == of => Ok(curve.clone()),
        _ => {
            let made = Epitrochoid::new(eccentricity, sleeves, shortening).map_err(|_| {
                GearboxError::Geometry(
                    "no epitrochoid has this eccentricity, shortening and number of sleeves".into(),
                )
            })?;
            *last = Some((of, made.clone()));
            Ok(made)
        }
    })
}

impl Geometry {
    /// Geometry of a checked gear.
    ///
    /// # Errors
    /// Parameters for which there is no curve.
    pub fn new(gear: &Gear) -> Result<Self, GearboxError> {
        let sleeves = u32::try_from(gear.external_sleeves).unwrap_or(u32::MAX);
        let curve = curve(gear.eccentricity_m, sleeves, gear.shortening)?;
        let spread = |n: usize| (0..n).map(move |k| TAU * k as f64 / n as f64);
        let mut wheel_phases: Vec<f64> = spread(gear.wheels).collect();
        let lobes = gear.external_sleeves as f64 - 1.0;
        let rw = gear.internal_circle_radius_m;
        let hole_centres = wheel_phases
            .iter()
            .map(|phase| {
                let start = (PI - phase) / lobes;
                spread(gear.internal_sleeves)
                    .map(|a| Complex::unit(a - start).scale(rw))
                    .collect()
            })
            .collect();
        if let (true, Some(last)) = (armed(Fault::WheelPhase), wheel_phases.last_mut()) {
            *last += 1e-4;
        }
        Ok(Self {
            curve,
            external_directions: spread(gear.external_sleeves).map(Complex::unit).collect(),
            internal_points: spread(gear.internal_sleeves)
                .map(|a| Complex::unit(a).scale(rw).to_array())
                .collect(),
            wheel_phases,
            hole_centres,
            small_sleeve: None,
            lobes,
        })
    }

    /// Angle of wheel `i` at the ideal mesh, for the input angle `phi`, rad.
    #[must_use]
    pub fn ideal_wheel_angle(&self, i: usize, phi: f64) -> f64 {
        (PI - phi - self.wheel_phases[i]) / self.lobes
    }

    /// Angle of the output at the ideal mesh, for the input angle `phi`, rad.
    #[must_use]
    pub fn ideal_output_angle(&self, phi: f64) -> f64 {
        -phi / self.lobes
    }

    /// Gear ratio zs: the output turns at -input/zs.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.lobes
    }
}
