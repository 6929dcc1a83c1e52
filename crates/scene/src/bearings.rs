//! Bearing between an eccentric and its disc.
//!
//! ```text
//! d = r_wheel - C,  C = e u(phi + phi_i)      F = [K max(0, |d| - g)^p + c |d|'] d/|d|  on the eccentric, at the disc's centre
//! ```
//! Rollers after Palmgren (Palmgren, *Ball and Roller Bearing Engineering*, 3rd ed., 1959): an approach of
//! delta = 7.68e-5 Q^0.9/l^0.8 (mm, N) under the most loaded roller's Q = 4.08 F/Z.

use pinwheel_contact::{Real, Scalar};

use crate::error::Fault;
use crate::model::{EccentricBearing, Scene};
use crate::number::short;
use crate::springs::wheel_torque_n_m;

/// Speed below which the friction of a bearing, or of a roller on its pin, fades to zero, rad/s.
pub const SLOW_RAD_S: f64 = 1.0;
/// Length of the damping ramp over the elastic offset under the largest load.
const RAMP_SHARE: f64 = 0.1;
/// Exponent of Palmgren's law for rollers.
const ROLLERS: f64 = 10.0 / 9.0;

/// Force law of a bearing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BearingLaw {
    /// K, N/m^p.
    pub stiffness: f64,
    /// Exponent p.
    pub exponent: f64,
    /// g, m.
    pub clearance_m: f64,
    /// c, N s/m.
    pub damping_n_s_m: f64,
    /// Offset beyond the clearance at which damping is fully active, m.
    pub ramp_m: f64,
    /// Lever of the friction, mu d/2, m (SKF, *Rolling Bearings*, 2018: a constant coefficient on the bore).
    pub drag_m: f64,
}

/// Returns the stiffness K, N/m^p, and the exponent p of a bearing with this number and length (m) of rollers, after
/// Palmgren.
pub(crate) fn of_rollers(rollers: f64, length_m: f64) -> (f64, f64) {
    // F(delta), delta in m.
    let per_metre = 1e3 * (1e3 * length_m).powf(0.8) / 7.68e-5;
    (rollers / 4.08 * per_metre.powf(ROLLERS), ROLLERS)
}

impl Scene {
    /// Returns the friction of the sleeves of ring and of output pins as a share of the force on them: mu d/(2 r), or the
    /// contact's coefficient if that is stated and smaller; 0 for pins that do not turn. `None`: sleeves without friction.
    /// A roller thinner than the bore d turns in a groove and rubs on its own diameter, so the share is at most mu.
    pub fn sleeve_drag(&self) -> Option<[f64; 2]> {
        let (bearings, contact) = (&self.bearings, self.contact.friction_coefficient);
        let friction = bearings.sleeve_friction_coefficient?;
        let bore = bearings.sleeve_bore_m?;
        let gear = &self.gear;
        let radii = [gear.external_sleeve_radius_m, gear.internal_sleeve_radius_m];
        let most = if contact > 0.0 { contact } else { 1.0 };
        let rolls = self.rolling();
        rolls.contains(&true).then(|| {
            let drag = |side: usize| (friction * (0.5 * bore / radii[side]).min(1.0)).min(most);
            [0, 1].map(|side| if rolls[side] { drag(side) } else { 0.0 })
        })
    }

    /// True if there is any friction, so that losses exceed those of the contacts' damping.
    ///
    /// ```
    /// let mut scene = pinwheel_scene::Scene::paper();
    /// assert!(!scene.rubs());
    /// scene.bearings.output_seal_n_m = Some(0.5);
    /// assert!(scene.rubs());
    /// ```
    pub fn rubs(&self) -> bool {
        self.rubbing().contains(&true)
    }

    /// Returns flags of ring and of output pins that are sleeves with a stated friction on their pins. The smaller of both
    /// frictions acts at their contacts.
    pub fn rolling(&self) -> [bool; 2] {
        let rolls = self.bearings.sleeve_friction_coefficient.is_some();
        let gear = &self.gear;
        [gear.external_sleeves_turn, gear.internal_sleeves_turn].map(|turns| turns && rolls)
    }

    /// Returns the coefficients of friction at the contacts of ring and of output pins with discs; 0 if sleeves are
    /// [rolling](Self::rolling), and without pins.
    ///
    /// ```
    /// let mut scene = pinwheel_scene::Scene::paper();
    /// scene.contact.friction_coefficient = 0.1;
    /// assert_eq!(scene.sliding(), [0.1, 0.1]);
    /// scene.bearings.sleeve_friction_coefficient = Some(0.05);
    /// scene.gear.external_sleeves_turn = false;
    /// assert_eq!(scene.sliding(), [0.1, 0.0]);
    /// ```
    pub fn sliding(&self) -> [f64; 2] {
        let coefficient = self.contact.friction_coefficient;
        let has_pins = [true, self.cranks.is_none()];
        let slides = |kind: usize| has_pins[kind] && !self.rolling()[kind];
        [0, 1].map(|kind| if slides(kind) { coefficient } else { 0.0 })
    }

    /// True if discs slide on pins with friction, so that the contact forces depend steeply on sliding speeds.
    pub fn slides(&self) -> bool {
        self.sliding() != [0.0; 2]
    }

    /// Returns flags of friction, in this order, at contacts, bearings, sleeves on their pins and seals.
    pub fn rubbing(&self) -> [bool; 4] {
        let bearings = &self.bearings;
        let [external, internal] = self.sliding();
        let eccentric = bearings
            .eccentric
            .and_then(|bearing| bearing.friction_coefficient);
        let sleeves = bearings.sleeve_friction_coefficient;
        let sleeves = sleeves.filter(|_| self.rolling() != [false; 2]);
        [
            [Some(external), Some(internal)],
            [eccentric, None],
            [sleeves, None],
            [bearings.input_seal_n_m, bearings.output_seal_n_m],
        ]
        .map(|sizes| sizes.into_iter().flatten().any(|size| size > 0.0))
    }
}

impl Scene {
    /// Returns the basic static and dynamic ratings of the bearing that carries a disc, N, from its rollers and their bore;
    /// `None` if these are not stated.
    ///
    /// ISO 76: C0 = 44 (1 - g) Z L D with g = D/(pitch diameter), N and mm, which is 4000 MPa under a roller's 5 F/Z. ISO 281:
    /// C = f L^(7/9) Z^(3/4) D^(29/27), f by the formula of its table 7 (ISO/TR 1281-1), raceways as those of drawn cups.
    pub fn roller_ratings_n(&self) -> Option<[f64; 2]> {
        let bearing = self.bearings.eccentric?;
        let of_crank = self.cranks.map(|cranks| cranks.bore_radius_m);
        let bore_mm = 2e3 * of_crank.or(self.gear.eccentric_bore_radius_m)?;
        let (length, roller) = (
            1e3 * bearing.roller_length_m?,
            1e3 * bearing.roller_diameter_m?,
        );
        let rollers = bearing.rollers? as f64;
        let g = roller / (bore_mm - roller);
        let rings = 1.04 * ((1.0 - g) / (1.0 + g)).powf(143.0 / 108.0);
        let f = 207.9 * 0.83 * g.powf(2.0 / 9.0) * (1.0 - g).powf(29.0 / 27.0)
            / (1.0 + g).powf(0.25)
            / (1.0 + rings.powf(4.5)).powf(2.0 / 9.0);
        let dynamic = f * length.powf(7.0 / 9.0) * rollers.powf(0.75) * roller.powf(29.0 / 27.0);
        Some([44.0 * (1.0 - g) * rollers * length * roller, dynamic])
    }
}

impl EccentricBearing {
    /// Share of critical damping of a disc on its bearing under the largest load if no damping is given.
    pub const DAMPING_SHARE: f64 = 0.05;
}

impl BearingLaw {
    /// Returns the law of a scene with floating discs; `None` for rigid eccentrics.
    pub fn of(scene: &Scene) -> Option<Self> {
        let bearing = scene.bearings.eccentric?;
        let (stiffness, exponent) = match (bearing.rollers, bearing.roller_length_m) {
            (Some(rollers), Some(length)) => of_rollers(rollers as f64, length),
            _ => (
                bearing.stiffness_n_m.unwrap_or_default(),
                bearing.exponent.unwrap_or(1.0),
            ),
        };
        let mut law = Self {
            stiffness,
            exponent,
            clearance_m: bearing.clearance_m.unwrap_or_default(),
            damping_n_s_m: 0.0,
            ramp_m: 0.0,
            drag_m: 0.5
                * bearing.friction_coefficient.unwrap_or_default()
                * bearing.bore_m.unwrap_or_default(),
        };
        let force = typical_force(scene);
        law.damping_n_s_m = bearing.damping_n_s_m.unwrap_or_else(|| {
            let slope = law.slope_under(force);
            2.0 * EccentricBearing::DAMPING_SHARE * (slope * scene.mass.wheel.mass_kg).sqrt()
        });
        law.ramp_m = RAMP_SHARE * (law.offset_under(force) - law.clearance_m);
        Some(law)
    }

    /// Returns the law of a bearing with `share` times the deflection under a force and `of_clearance` times the clearance.
    pub fn share(&self, share: f64, of_clearance: f64) -> Self {
        Self {
            stiffness: self.stiffness / share.powf(self.exponent),
            clearance_m: self.clearance_m * of_clearance,
            ..*self
        }
    }

    /// Returns the force at rest at an offset beyond the clearance, N.
    #[inline]
    pub fn elastic<R: Real>(&self, beyond: R) -> R {
        let stiffness = beyond.like(self.stiffness);
        if self.exponent == 1.0 {
            stiffness * beyond
        } else {
            stiffness * beyond.powf(self.exponent)
        }
    }

    /// Returns the force, N, at an offset of the centres of `offset` m that grows by `rate` m/s; never below 0. Damping
    /// rises over the ramp, so that the force does not jump at first contact.
    #[inline]
    pub fn force<S: Scalar>(&self, offset: S, rate: S) -> S {
        let c = |x: f64| offset.like(x);
        let beyond = offset - c(self.clearance_m);
        if beyond.value() <= 0.0 {
            return c(0.0);
        }
        let damping = c(self.damping_n_s_m) * (beyond / c(self.ramp_m)).min(c(1.0));
        (self.elastic(beyond) + damping * rate).max(c(0.0))
    }

    /// Returns the moment of friction on the disc, N m, under a force (N) while the disc turns at `rate` rad/s relative to
    /// its eccentric.
    #[inline]
    pub fn drag<R: Real>(&self, force: R, rate: R) -> R {
        let c = |x: f64| force.like(x);
        let share = (rate / c(SLOW_RAD_S)).max(c(-1.0)).min(c(1.0));
        c(-self.drag_m) * force * share
    }

    /// Returns the stored energy at an offset, J.
    pub fn stored(&self, offset: f64) -> f64 {
        let beyond = (offset - self.clearance_m).max(0.0);
        self.elastic(beyond) * beyond / (self.exponent + 1.0)
    }

    /// Returns the offset under a force, m.
    pub fn offset_under(&self, force: f64) -> f64 {
        self.clearance_m + (force / self.stiffness).powf(1.0 / self.exponent)
    }

    /// Returns dF/d offset under a force, N/m.
    pub fn slope_under(&self, force: f64) -> f64 {
        self.exponent * force / (self.offset_under(force) - self.clearance_m)
    }
}

/// Returns the load of a bearing under the largest load, N: about the load on one disc over the lever of its lobes; for a
/// crank its share of it, and of the force that turns the output.
pub fn typical_force(scene: &Scene) -> f64 {
    let torque = wheel_torque_n_m(scene);
    let eccentric = torque / scene.gear.lever_m();
    scene.cranks.as_ref().map_or(eccentric, |cranks| {
        (eccentric + torque / cranks.circle_radius_m) / cranks.count as f64
    })
}

/// Checks keys that depend on each other.
pub(crate) fn check(scene: &Scene) -> Result<(), Fault> {
    let sleeve = &scene.bearings;
    if sleeve.sleeve_friction_coefficient.is_some() != sleeve.sleeve_bore_m.is_some() {
        return Err(Fault::new(
            &[match sleeve.sleeve_bore_m {
                Some(_) => "bearings.sleeve_friction_coefficient",
                None => "bearings.sleeve_bore_m",
            }],
            "is missing; a pin's friction has a coefficient and a bore".to_owned(),
            "give both or none",
        ));
    }
    let Some(bearing) = scene.bearings.eccentric else {
        return Ok(());
    };
    let of_crank = scene.cranks.map(|cranks| cranks.bore_radius_m);
    if let (Some(roller), Some(bore)) = (
        bearing.roller_diameter_m,
        of_crank.or(scene.gear.eccentric_bore_radius_m),
    ) {
        // Rollers beside each other on their pitch circle, whose chord is longer than a roller.
        let around = std::f64::consts::PI / bearing.rollers.unwrap_or(2) as f64;
        let most = 2.0 * bore * around.sin() / (1.0 + around.sin());
        if roller > most {
            return Err(Fault::new(
                &[
                    "bearings.eccentric.roller_diameter_m",
                    "bearings.eccentric.rollers",
                ],
                format!(
                    "is {} m, so that these rollers do not fit into a bore of {} m",
                    short(roller),
                    short(2.0 * bore)
                ),
                format!("give at most {} m", crate::number::below(most)),
            ));
        }
    }
    let key = "bearings.eccentric.stiffness_n_m";
    if bearing.friction_coefficient.is_some() != bearing.bore_m.is_some() {
        return Err(Fault::new(
            &[match bearing.bore_m {
                Some(_) => "bearings.eccentric.friction_coefficient",
                None => "bearings.eccentric.bore_m",
            }],
            "is missing; a bearing's friction has a coefficient and a bore".to_owned(),
            "give both or none",
        ));
    }
    let rollers = [bearing.rollers.is_some(), bearing.roller_length_m.is_some()];
    match (bearing.stiffness_n_m.is_some(), rollers) {
        (true, [false, false]) => Ok(()),
        (false, [true, true]) if bearing.exponent.is_none() => Ok(()),
        (false, [true, true]) => Err(Fault::new(
            &["bearings.eccentric.exponent", "bearings.eccentric.rollers"],
            "is that of rollers already, 10/9".to_owned(),
            "leave it out, or give stiffness_n_m in place of rollers",
        )),
        (true, _) => Err(Fault::new(
            &[key, "bearings.eccentric.rollers"],
            "is given twice, by itself and by rollers".to_owned(),
            "give stiffness_n_m, or rollers and roller_length_m",
        )),
        (false, [false, false]) => Err(Fault::new(
            &[key],
            "is missing, so the bearing has no stiffness".to_owned(),
            "give stiffness_n_m, or rollers and roller_length_m",
        )),
        (false, [has_count, _]) => Err(Fault::new(
            &[match has_count {
                true => "bearings.eccentric.roller_length_m",
                false => "bearings.eccentric.rollers",
            }],
            "is missing; rollers give a stiffness by their number and length".to_owned(),
            "give both, or stiffness_n_m",
        )),
    }
}
