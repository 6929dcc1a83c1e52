//! All forces between the bodies of a gear as a function of their states: contacts, bearings, friction of pins, seals.

use pinwheel_contact::PinLaw;
use pinwheel_mbs::{BodyState, ContactEnergy, Evaluation, Pose, Wrench};

use super::pair::{PairContact, PairField};
use super::pin_friction::PinFriction;
use super::seals::Seals;
use crate::Sleeve;
use crate::carrier::Carrier;

/// Contacts of a gear with the bearings that its discs float on, and the seals of its shafts. `bodies` and loads are in
/// [`Layout`](crate::Layout) order.
///
/// It keeps no history: the same states give the same bits.
pub struct ContactField {
    /// Contacts between discs and pins.
    pub contacts: Box<dyn PairField>,
    pub(crate) law: PinLaw,
    /// Pins that rub where they turn; the loops over the pairs add their forces.
    pub(crate) pins: Option<PinFriction>,
    pub(crate) carrier: Carrier,
    pub(crate) seals: Option<Seals>,
}

impl ContactField {
    /// Adds to what `sums` holds: loads (force, and moment about the centre of mass), moments about the pins and their
    /// derivatives, and writes what the contacts store and dissipate. Returns `false` and leaves `sums` unchanged if the
    /// requested output is not available for this `pose`. Loads of bodies in their actual positions are always available;
    /// moments need a gear without friction. See [`Forces::evaluate`](pinwheel_mbs::Forces::evaluate).
    ///
    /// Derivatives are those where the input turns at a constant rate. Free are all bodies but the input, in their order, and
    /// without friction the output and the discs alone.
    pub fn evaluate(
        &mut self,
        bodies: &[BodyState],
        pose: Pose,
        sums: &mut Evaluation<'_>,
    ) -> bool {
        let Some(pose) = self.carrier.pose(pose, sums) else {
            return false;
        };
        if !self.contacts.evaluate(bodies, pose, sums) {
            return false;
        }
        self.carrier.add(bodies, sums);
        if let Some(seals) = &self.seals {
            seals.add(bodies, sums);
        }
        true
    }

    /// Visits every touching pair (penetration > 0), disc by disc, external before internal.
    pub fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        self.contacts.touching(bodies, visit);
    }

    /// Returns one pair, touching or not; without contact its forces are 0 and its penetration is minus the gap.
    /// A crank's bearing stands in the place of a pin in its hole.
    pub fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        match (&self.carrier, sleeve) {
            (Carrier::Cranks(cranks), Sleeve::Internal(crank)) => cranks.pair(bodies, wheel, crank),
            _ => self.contacts.nearest(bodies, wheel, sleeve),
        }
    }

    /// Returns the law of all pairs.
    #[must_use]
    pub fn law(&self) -> &PinLaw {
        &self.law
    }

    /// Adds every body's contact load to `loads`.
    pub fn add_loads(&mut self, bodies: &[BodyState], loads: &mut [Wrench]) {
        self.evaluate(bodies, Pose::Any, &mut Evaluation::of_loads(loads));
    }

    /// Returns the energy that the contacts store, and the powers that they dissipate, at these states.
    pub fn energy(&mut self, bodies: &[BodyState]) -> ContactEnergy {
        let (law, pins) = (&self.law, self.pins);
        let mut sum = ContactEnergy::default();
        self.contacts.touching(bodies, &mut |pair| {
            pair.add_energy(law, &mut sum);
            sum.sleeve_friction_w += pins.map_or(0.0, |pins| pins.drag(bodies, pair).lost_w);
        });
        self.carrier.add_energy(bodies, &mut sum);
        if let Some(seals) = &self.seals {
            sum.seal_friction_w += seals.lost_w(bodies);
        }
        sum
    }
}
