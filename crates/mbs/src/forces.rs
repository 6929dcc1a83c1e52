//! What acts on the bodies of a mechanism.

use crate::sliding::{Contact, RateStage};
use crate::{BodyState, ContactEnergy, Jacobian};

/// Applied loads as a function of time and of all bodies' states.
pub trait Forces {
    /// Adds every applied load to `loads` (body order of the mechanism).
    fn apply(&mut self, time: f64, bodies: &[BodyState], loads: &mut [crate::Wrench]);

    /// [`apply`](Self::apply) for a state that is looked at, with the contacts' energy if that is cheaper to tell
    /// now than later. The loads are the same.
    fn apply_observed(
        &mut self,
        time: f64,
        bodies: &[BodyState],
        loads: &mut [crate::Wrench],
    ) -> Option<ContactEnergy> {
        self.apply(time, bodies, loads);
        None
    }

    /// [`apply`](Self::apply), or where the state is `observed` [`apply_observed`](Self::apply_observed), with every body
    /// standing and moving as its joints hold it, which forces may make use of.
    fn apply_held(
        &mut self,
        time: f64,
        bodies: &[BodyState],
        loads: &mut [crate::Wrench],
        observed: bool,
    ) -> Option<ContactEnergy> {
        if observed {
            return self.apply_observed(time, bodies, loads);
        }
        self.apply(time, bodies, loads);
        None
    }

    /// Adds the moments about the pins (N m, by body) of the free bodies of [`Reduced`](crate::Reduced), loads of carried
    /// bodies included, from the angles and rates of `bodies` alone: carried bodies were not put in place.
    ///
    /// False, the default, and nothing was added: bodies will be put in place and their loads asked for.
    fn moments(&mut self, _time: f64, _bodies: &[BodyState], _moments: &mut [f64]) -> bool {
        false
    }

    /// Writes every applied load to `loads` and adds the moments about the pins (N m, by body) of all bodies of
    /// [`Reduced`](crate::Reduced) that turn, driven ones included, for a state that is looked at; from the angles and rates of
    /// `bodies` alone, as [`moments`](Self::moments). The answer is the contacts' energy.
    ///
    /// `None`, the default, and nothing was touched: [`apply_held`](Self::apply_held) will be asked for.
    fn observed_moments(
        &mut self,
        _time: f64,
        _bodies: &[BodyState],
        _moments: &mut [f64],
        _loads: &mut [crate::Wrench],
    ) -> Option<ContactEnergy> {
        None
    }

    /// Adds every applied load but the friction of contacts, and lists these contacts.
    ///
    /// By default there is no friction to tell apart.
    fn apply_without_friction(
        &mut self,
        time: f64,
        bodies: &[BodyState],
        loads: &mut [crate::Wrench],
        contacts: &mut Vec<Contact>,
    ) {
        contacts.clear();
        self.apply(time, bodies, loads);
    }

    /// Adds every applied load but the friction of contacts, and solves the friction of a stage.
    ///
    /// `Some(solved)` from forces that do so by a faster way than listing their contacts; the result must
    /// be that of [`SlidingStage`](crate::sliding::SlidingStage). `None`, the default, and nothing is
    /// touched: the contacts will be asked for by [`apply_without_friction`](Self::apply_without_friction).
    fn solve_friction(
        &mut self,
        _time: f64,
        _bodies: &[BodyState],
        _loads: &mut [crate::Wrench],
        _stage: &mut RateStage<'_>,
    ) -> Option<bool> {
        None
    }

    /// Adds to `slopes` how the moments about the pins change with the free angles (N m/rad), the free rates (N m s/rad) and
    /// the time (N m/s), rows and columns in the order of [`Reduced::free_bodies`](crate::Reduced::free_bodies).
    ///
    /// A moment about a pin is that of [`Reduced`](crate::Reduced): loads of carried bodies included. False, the default, and
    /// nothing was added: they are not known.
    fn moment_slopes(&mut self, _time: f64, _bodies: &[BodyState], _slopes: &mut Jacobian) -> bool {
        false
    }

    /// From now on the loads are those of the leg which begins at `from` (s), at its end too, until the next call;
    /// see [`OdeSystem::enter_leg`](crate::OdeSystem::enter_leg). By default there are no legs.
    fn enter_leg(&mut self, _from: f64) {}

    /// Normal force (N) of contact `index` of the last list if it closed at `rate` (m/s, along its
    /// normal, first body against second) at the same positions. `listed`: the force in the list.
    fn normal_force(&self, _index: usize, listed: f64, _rate: f64) -> f64 {
        listed
    }
}
