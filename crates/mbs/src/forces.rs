//! Forces on the bodies of a mechanism.

use crate::sliding::Contact;
use crate::{BodyState, ContactEnergy, Jacobian, Wrench};

/// How far the bodies of an evaluation can be relied upon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pose {
    /// Anywhere: the joints may be off by the integrator's error.
    Any,
    /// Every body stands and moves as its joints prescribe, which forces may make use of.
    Prescribed,
    /// As [`Prescribed`](Self::Prescribed), but only angles and rates are set: bodies that others carry were not put
    /// in place. Bodies that no joint holds are.
    AnglesOnly,
}

/// Outputs that an evaluation of the forces adds to; those that are `None` are not requested.
#[derive(Debug, Default)]
pub struct Evaluation<'a> {
    /// Loads on all bodies, in their order: ground frame, N and N m about the centre of mass. With a prescribed pose they
    /// hold 0 on entry.
    pub loads: Option<&'a mut [Wrench]>,
    /// True if only loads on bodies that no joint holds are needed, because `moments` give the rest.
    pub floating_alone: bool,
    /// Moments about the pins by body, N m, loads of carried bodies included: of the free bodies of
    /// [`Reduced`](crate::Reduced), and where `loads` are asked for too also of the driven ones.
    pub moments: Option<&'a mut [f64]>,
    /// How these moments change with the free angles (N m/rad), the free rates (N m s/rad) and the time (N m/s), in the order
    /// of [`Reduced::free_bodies`](crate::Reduced::free_bodies); then the forces on bodies that no joint holds, x and y of one
    /// after the other, all by their places and velocities too.
    pub derivatives: Option<&'a mut Jacobian>,
    /// True if the energy of the contacts is requested.
    pub wants_energy: bool,
    /// That energy: written where it is asked for and known.
    pub energy: Option<ContactEnergy>,
}

impl<'a> Evaluation<'a> {
    /// Loads alone.
    pub fn of_loads(loads: &'a mut [Wrench]) -> Self {
        Self {
            loads: Some(loads),
            ..Self::default()
        }
    }

    /// Moments alone.
    pub fn of_moments(moments: &'a mut [f64]) -> Self {
        Self {
            moments: Some(moments),
            ..Self::default()
        }
    }

    /// Slopes alone.
    pub fn of_slopes(derivatives: &'a mut Jacobian) -> Self {
        Self {
            derivatives: Some(derivatives),
            ..Self::default()
        }
    }

    /// Requests the energy of the contacts too.
    #[must_use]
    pub fn with_energy(mut self) -> Self {
        self.wants_energy = true;
        self
    }
}

/// Applied loads as a function of time and of all bodies' states.
pub trait Forces {
    /// Adds every applied load to `loads` (body order of the mechanism).
    fn apply(&mut self, time: f64, bodies: &[BodyState], loads: &mut [Wrench]);

    /// Adds to what `sums` holds. False: these forces cannot tell it from such a pose, and nothing was added; the caller asks
    /// for loads of bodies that are in place, which all forces know.
    ///
    /// By default forces know their loads, and those alone.
    fn evaluate(
        &mut self,
        t: f64,
        bodies: &[BodyState],
        pose: Pose,
        sums: &mut Evaluation<'_>,
    ) -> bool {
        match sums {
            Evaluation {
                loads: Some(loads),
                moments: None,
                derivatives: None,
                ..
            } if pose != Pose::AnglesOnly => {
                self.apply(t, bodies, loads);
                true
            }
            _ => false,
        }
    }

    /// Adds every applied load but the friction of contacts, and lists these contacts.
    ///
    /// By default there is no friction to tell apart.
    fn apply_without_friction(
        &mut self,
        time: f64,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        contacts: &mut Vec<Contact>,
    ) {
        contacts.clear();
        self.apply(time, bodies, loads);
    }

    /// From now on the loads are those of the segment which begins at `from` (s), at its end too, until the next call;
    /// see [`OdeSystem::restart_at`](crate::OdeSystem::restart_at). By default there are no segments.
    fn restart_at(&mut self, _from: f64) {}

    /// Normal force (N) of contact `index` of the last list if it closed at `rate` (m/s, along its
    /// normal, first body against second) at the same positions. `listed`: the force in the list.
    fn normal_force(&self, _index: usize, listed: f64, _rate: f64) -> f64 {
        listed
    }
}
