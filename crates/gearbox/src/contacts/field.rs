//! All forces between the bodies of a gear as a function of their states: contacts, bearings, friction of pins, seals.

use std::mem::take;
use std::ops::Range;

use pinwheel_contact::PinLaw;
use pinwheel_mbs::{BodyState, ContactEnergy, Evaluation, Wrench};

use super::pair::{PairContact, PairField};
use super::pin_friction::PinFriction;
use super::seals::Seals;
use crate::carrier::Carrier;
use crate::ring_frame::{RingFrame, from_ring, pair_to_ground, with_carrier};
use crate::scene::Scene;
use crate::{Layout, Sleeve};

/// Pins that do not turn, in gears with friction.
///
/// Their rate at a contact is that of their holder, the output or the housing, on which their moment acts. Engines whose pins
/// have revolutes do not need them.
pub(crate) struct HeldPins {
    layout: Layout,
    /// True for fixed ring pins and for fixed output pins.
    held: [bool; 2],
    /// States with the pins' rates.
    bodies: Vec<BodyState>,
}

impl HeldPins {
    /// Returns the fixed pins of a scene; `None` if all turn, or none has friction.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let (gear, sliding) = (&scene.gear, scene.sliding());
        let turn = [gear.external_sleeves_turn, gear.internal_sleeves_turn];
        let held = [0, 1].map(|side| sliding[side] > 0.0 && !turn[side]);
        (held != [false; 2]).then(|| Self {
            layout: Layout::of(gear),
            held,
            bodies: Vec::new(),
        })
    }

    /// Returns the bodies of the fixed ring and output pins, with the holder of the latter.
    fn pins(&self) -> [(Range<usize>, Option<usize>); 2] {
        let ring = self.layout.external_bodies();
        let output = self.layout.internal_bodies();
        let [on_ring, on_output] = self.held;
        [
            (if on_ring { ring } else { 0..0 }, None),
            (if on_output { output } else { 0..0 }, Some(Layout::OUTPUT)),
        ]
    }

    /// Returns the states with the rates of the fixed pins.
    fn with_rates<'a>(held: &'a mut Option<Self>, bodies: &'a [BodyState]) -> &'a [BodyState] {
        let Some(held) = held else {
            return bodies;
        };
        held.bodies.clear();
        held.bodies.extend_from_slice(bodies);
        for (pins, holder) in held.pins() {
            let rate = holder.map_or(0.0, |holder| bodies[holder].rate);
            for pin in &mut held.bodies[pins] {
                pin.rate = rate;
            }
        }
        &held.bodies
    }

    /// Transfers the moments on the fixed pins to their holder.
    fn pass_on(&self, loads: &mut [Wrench]) {
        for (pins, holder) in self.pins() {
            let moments = loads[pins].iter_mut().map(|pin| take(&mut pin.moment));
            let moment: f64 = moments.sum();
            if let Some(holder) = holder {
                loads[holder].moment += moment;
            }
        }
    }
}

/// Contacts of a gear with the bearings of its floating discs, and the seals of its shafts. `bodies` and loads are in
/// [`Layout`](crate::Layout) order.
///
/// The field keeps no history: equal states give equal bits.
pub struct ContactField {
    /// Contacts between discs and pins.
    pub contacts: Box<dyn PairField>,
    pub(crate) law: PinLaw,
    /// Friction of sleeves on ring and on output pins; the loops over the pairs add its forces.
    pub(crate) pins: [Option<PinFriction>; 2],
    pub(crate) held: Option<HeldPins>,
    pub(crate) carrier: Carrier,
    pub(crate) seals: Option<Seals>,
    /// Frame of a ring that is the output; `None`: states and loads are relative to the ring.
    pub(crate) ring: Option<Box<RingFrame>>,
}

impl ContactField {
    /// True without friction of the contacts; see [`Forces::work_from_angles`](pinwheel_mbs::Forces::work_from_angles).
    pub fn work_from_angles(&self) -> bool {
        self.ring.is_none() && self.contacts.work_from_angles()
    }

    /// True with exact detection; see [`Forces::have_derivatives`](pinwheel_mbs::Forces::have_derivatives).
    pub fn have_derivatives(&self) -> bool {
        self.ring.is_none() && self.contacts.have_derivatives()
    }

    /// Adds to the outputs of `request`: loads (force, and moment about the centre of mass), moments about the pins,
    /// derivatives, and the energy that contacts store and dissipate. See [`Forces::evaluate`](pinwheel_mbs::Forces::evaluate).
    ///
    /// Derivatives assume that the input turns at a constant rate. Discs whose positions are not free move with it.
    pub fn evaluate(&mut self, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        if self.ring.is_some() {
            return self.evaluate_in_ring(bodies, request);
        }
        let with_rates = HeldPins::with_rates(&mut self.held, bodies);
        self.contacts.evaluate(with_rates, request);
        if let (Some(held), Some(loads)) = (&self.held, &mut request.loads) {
            held.pass_on(loads);
        }
        self.carrier.add(bodies, request);
        if let Some(seals) = &self.seals {
            seals.add(bodies, request);
        }
    }

    #[cold]
    fn evaluate_in_ring(&mut self, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        let Some(mut frame) = self.ring.take() else {
            return;
        };
        from_ring(bodies, &mut frame.local);
        frame.own.clear();
        frame.own.resize(bodies.len(), Wrench::default());
        let mut asked = Evaluation::of_loads(&mut frame.own);
        asked.energy = request.energy.take();
        self.evaluate(&frame.local, &mut asked);
        request.energy = asked.energy;
        if let Some(loads) = &mut request.loads {
            frame.add_to_ground(&bodies[Layout::OUTPUT], loads);
        }
        self.ring = Some(frame);
    }

    /// Visits every touching pair (penetration > 0), disc by disc, external before internal.
    pub fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        if let Some(mut frame) = self.ring.take() {
            from_ring(bodies, &mut frame.local);
            let ring = &bodies[Layout::OUTPUT];
            self.touching(&frame.local, &mut |pair| visit(&pair_to_ground(pair, ring)));
            self.ring = Some(frame);
            return;
        }
        let with_rates = HeldPins::with_rates(&mut self.held, bodies);
        self.contacts.touching(with_rates, visit);
    }

    /// Returns one pair, touching or not; without contact its forces are 0 and its penetration is minus the gap. With cranks, a
    /// crank's bearing replaces the pin in its hole.
    pub fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        if let Some(mut frame) = self.ring.take() {
            from_ring(bodies, &mut frame.local);
            let pair = self.nearest(&frame.local, wheel, sleeve);
            self.ring = Some(frame);
            return pair_to_ground(&pair, &bodies[Layout::OUTPUT]);
        }
        match (&self.carrier, sleeve) {
            (Carrier::Cranks(cranks), Sleeve::Internal(crank)) => cranks.pair(bodies, wheel, crank),
            _ => {
                let with_rates = HeldPins::with_rates(&mut self.held, bodies);
                self.contacts.nearest(with_rates, wheel, sleeve)
            }
        }
    }

    /// Returns the bearings of cranks that carry a force, as pairs.
    pub(crate) fn on_cranks(&self, bodies: &[BodyState]) -> Vec<PairContact> {
        match self.ring {
            Some(_) => self.carrier.pairs(&with_carrier(bodies)),
            None => self.carrier.pairs(bodies),
        }
    }

    /// Returns the law of all pairs.
    pub fn law(&self) -> &PinLaw {
        &self.law
    }

    /// Adds every body's contact load to `loads`.
    pub fn add_loads(&mut self, bodies: &[BodyState], loads: &mut [Wrench]) {
        self.evaluate(bodies, &mut Evaluation::of_loads(loads));
    }

    /// Returns the energy that the contacts store, and the powers that they dissipate, at these states.
    pub fn energy(&mut self, bodies: &[BodyState]) -> ContactEnergy {
        if let Some(mut frame) = self.ring.take() {
            from_ring(bodies, &mut frame.local);
            let sum = self.energy(&frame.local);
            self.ring = Some(frame);
            return sum;
        }
        let (law, pins) = (&self.law, &self.pins);
        let mut sum = ContactEnergy::default();
        let with_rates = HeldPins::with_rates(&mut self.held, bodies);
        self.contacts.touching(with_rates, &mut |pair| {
            pair.add_energy(law, &mut sum);
            if let Some(pins) = &pins[pair.sleeve.side()] {
                sum.sleeve_friction_w += pins.drag(bodies, pair).lost_w;
            }
        });
        self.carrier.add_energy(bodies, &mut sum);
        if let Some(seals) = &self.seals {
            sum.seal_friction_w += seals.lost_w(bodies);
        }
        sum
    }
}
