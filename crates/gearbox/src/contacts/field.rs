//! All forces between the bodies of a gear as a function of their states: contacts, bearings, friction of pins, seals.

use pinwheel_contact::PinLaw;
use pinwheel_mbs::{BodyState, ContactEnergy, Evaluation, Wrench};

use super::pair::{PairContact, PairField};
use super::pin_friction::PinFriction;
use super::seals::Seals;
use crate::Sleeve;
use crate::carrier::Carrier;

/// Contacts of a gear with the bearings that its discs float on, and the seals of its shafts. `bodies` and loads are in
/// [`Layout`](crate::Layout) order.
///
/// The field keeps no history: equal states give equal bits.
pub struct ContactField {
    /// Contacts between discs and pins.
    pub contacts: Box<dyn PairField>,
    pub(crate) law: PinLaw,
    /// Friction of sleeves on their pins; the loops over the pairs add its forces.
    pub(crate) pins: Option<PinFriction>,
    pub(crate) carrier: Carrier,
    pub(crate) seals: Option<Seals>,
}

impl ContactField {
    /// See [`Forces::work_from_angles`](pinwheel_mbs::Forces::work_from_angles): without friction of the contacts.
    #[must_use]
    pub fn work_from_angles(&self) -> bool {
        self.contacts.work_from_angles()
    }

    /// See [`Forces::have_derivatives`](pinwheel_mbs::Forces::have_derivatives): with exact detection.
    #[must_use]
    pub fn have_derivatives(&self) -> bool {
        self.contacts.have_derivatives()
    }

    /// Adds to the outputs of `request`: loads (force, and moment about the centre of mass), moments about the pins,
    /// derivatives, and the energy that contacts store and dissipate. See [`Forces::evaluate`](pinwheel_mbs::Forces::evaluate).
    ///
    /// Derivatives assume that the input turns at a constant rate. Discs without free places move with it.
    pub fn evaluate(&mut self, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        self.contacts.evaluate(bodies, request);
        self.carrier.add(bodies, request);
        if let Some(seals) = &self.seals {
            seals.add(bodies, request);
        }
    }

    /// Visits every touching pair (penetration > 0), disc by disc, external before internal.
    pub fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        self.contacts.touching(bodies, visit);
    }

    /// Returns one pair, touching or not; without contact its forces are 0 and its penetration is minus the gap. With cranks, a
    /// crank's bearing replaces the pin in its hole.
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
        self.evaluate(bodies, &mut Evaluation::of_loads(loads));
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
