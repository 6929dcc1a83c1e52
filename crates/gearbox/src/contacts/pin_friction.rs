//! Friction of sleeves between discs and pins.
//!
//! ```text
//! T = mu F_n min(d/(2 r), 1) clamp(v_t/(r slow), -1, 1)      against the sliding of a sleeve that does not turn on its pin, at the contact
//! ```
//! A sleeve transmits the smaller of two moments. Where T is less than the contact's own friction at v_t, it rolls on the disc
//! and slides on its pin; otherwise it stands on its pin and the disc slides on it. A contact without stated friction is
//! assumed not to slide. A sleeve that rolls at v_t/r on a pin of diameter d loses the power mu F_n d/2 times that rate, which
//! T takes from the disc. The couple T r on the pin acts on the pin's carrier. A roller thinner than d turns in a groove, on
//! its own diameter. slow = 1 rad/s. Derivatives omit T, which is some thousandths of F_n.

use pinwheel_contact::{AdamsFriction, Friction, Lanes, Real, RegularisedCoulomb};
use pinwheel_faults::{Fault, factor};
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::bearings::SLOW_RAD_S;
use pulp::Simd;

use super::pair::PairContact;
use crate::scene::{self, FrictionLaw, Scene};
use crate::{Layout, Sleeve};

/// Friction of sleeves on their pins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PinFriction {
    friction_coefficient: f64,
    /// Lever mu d/2 of the friction, m.
    lever_m: f64,
    /// Friction between disc and sleeve, if stated.
    contact: Option<Friction>,
    layout: Layout,
}

/// Force T of one pair, with its couple and power.
pub(crate) struct Drag {
    pub(crate) force: [f64; 2],
    /// Couple on the pin, N m.
    couple: f64,
    pub(super) lost_w: f64,
}

/// Evaluates [`PinFriction::along`] in lanes. The function is not inlined: most gears have no friction of pins, and it would take
/// registers from their loops.
struct Along<'a, S: Simd> {
    pins: &'a PinFriction,
    contact: [Lanes<S>; 3],
}

impl<S: Simd> pulp::WithSimd for Along<'_, S> {
    type Output = Lanes<S>;

    #[inline(always)]
    fn with_simd<T: Simd>(self, _simd: T) -> Self::Output {
        let [force, radius, passing] = self.contact;
        self.pins.along(force, radius, passing)
    }
}

/// Returns the friction of a scene with this coefficient.
pub(super) fn friction(contact: &scene::Contact, coefficient: f64) -> Friction {
    match contact.friction_law {
        FrictionLaw::Regularised => Friction::Regularised(RegularisedCoulomb {
            coefficient,
            ramp: contact.friction_ramp_m_s * factor(Fault::FrictionSign, -1.0),
        }),
        FrictionLaw::Adams => Friction::Adams(AdamsFriction {
            static_coefficient: coefficient,
            dynamic_coefficient: contact.friction_dynamic_coefficient.min(coefficient),
            static_speed: contact.friction_ramp_m_s,
            dynamic_speed: contact.friction_dynamic_speed_m_s,
        }),
    }
}

impl PinFriction {
    /// Returns the friction of ring and of output pins; `None` for pins that do not turn or have no friction.
    pub(super) fn of(scene: &Scene) -> [Option<Self>; 2] {
        let (bearings, contact) = (&scene.bearings, &scene.contact);
        scene.rolling().map(|rolls| {
            let friction_coefficient = bearings.sleeve_friction_coefficient?;
            let lever_m = 0.5 * friction_coefficient * bearings.sleeve_bore_m?;
            (rolls && lever_m > 0.0).then(|| Self {
                friction_coefficient,
                lever_m,
                contact: (contact.friction_coefficient > 0.0)
                    .then(|| friction(contact, contact.friction_coefficient)),
                layout: Layout::of(&scene.gear),
            })
        })
    }

    /// Returns T along t on a pin under the normal force `force`. `radius` is the distance from its centre to the contact, and
    /// `passing` the speed of the disc past a sleeve that does not turn on its pin.
    #[inline(always)]
    fn along<R: Real>(&self, force: R, radius: R, passing: R) -> R {
        let one = force.like(1.0);
        let rolling = passing * force.like(1.0 / SLOW_RAD_S) / radius;
        let share = (force.like(self.lever_m) / radius).min(force.like(self.friction_coefficient));
        let drag = -(force * share) * rolling.max(-one).min(one);
        match &self.contact {
            None => drag,
            Some(contact) => {
                let holds = contact.force(force, passing);
                let holds = holds.max(-holds);
                drag.max(-holds).min(holds)
            }
        }
    }

    /// Returns T along t of several pairs, from their normal forces, radii and passing speeds.
    #[inline(always)]
    pub(super) fn along_lanes<S: Simd>(&self, simd: S, contact: [Lanes<S>; 3]) -> Lanes<S> {
        simd.vectorize(Along {
            pins: self,
            contact,
        })
    }

    /// Returns T of a pair of these pins.
    pub(crate) fn drag(&self, bodies: &[BodyState], pair: &PairContact) -> Drag {
        let arm = [
            pair.point[0] - pair.centre[0],
            pair.point[1] - pair.centre[1],
        ];
        let radius = arm[0].hypot(arm[1]);
        let carrier = match pair.sleeve {
            Sleeve::External(_) => 0.0,
            Sleeve::Internal(_) => bodies[Layout::OUTPUT].rate,
        };
        let own = bodies[self.layout.sleeve_body(pair.sleeve)].rate;
        let passing = pair.tangential_rate_m_s + (carrier - own) * radius;
        let along = self.along(pair.normal_force_n, radius, passing);
        let [nx, ny] = pair.normal;
        let force = [-along * ny, along * nx];
        Drag {
            force,
            couple: arm[0] * force[1] - arm[1] * force[0],
            lost_w: -along * passing,
        }
    }

    /// Adds the friction of a pair to the bodies' loads.
    pub(crate) fn add(
        &self,
        bodies: &[BodyState],
        pair: &PairContact,
        drag: &Drag,
        loads: &mut [Wrench],
    ) {
        let ([fx, fy], couple) = (drag.force, drag.couple);
        let wheel = self.layout.wheel_bodies().start + pair.wheel;
        let sleeve = &mut loads[self.layout.sleeve_body(pair.sleeve)];
        (sleeve.fx, sleeve.fy) = (sleeve.fx + fx, sleeve.fy + fy);
        if matches!(pair.sleeve, Sleeve::Internal(_)) {
            loads[Layout::OUTPUT].moment += couple;
        }
        let (load, at) = (&mut loads[wheel], bodies[wheel]);
        (load.fx, load.fy) = (load.fx - fx, load.fy - fy);
        load.moment -= (pair.point[0] - at.x) * fy - (pair.point[1] - at.y) * fx;
    }
}
