//! Values of channels ([`pinwheel_scene::channels`]) at one sample.

use pinwheel_mbs::BodyState;

use pinwheel_scene::Scales;
use pinwheel_scene::channels::{
    Channels, Chosen, Component, Joint, PairQuantity, Part, What, Whole,
};

use crate::Gearbox;
use crate::carrier::Carrier;
use crate::contacts::{ContactEnergy, ContactField, PairContact};
use crate::geometry::Geometry;
use crate::pressure::LinePressure;
use crate::ring_frame::with_carrier;
use crate::{Layout, Sleeve};

/// Minutes of arc per radian.
const ARCMIN: f64 = 180.0 * 60.0 / std::f64::consts::PI;

/// Callback with a disc and a pin that touches it.
pub type Visit<'a> = &'a mut dyn FnMut(usize, Sleeve);

/// Source of contact data of an engine at a sample.
pub trait PairSource {
    /// Returns a pair at its closest points, touching or not; `None` if not available.
    fn pair(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> Option<PairContact>;

    /// Visits every touching pair, which costs less than evaluating all pairs; `false` if the engine has no list of them.
    fn touching(&mut self, _: &[BodyState], _visit: &mut dyn FnMut(&PairContact)) -> bool {
        false
    }

    /// Visits every pair that carries a normal force above `least_n`, N.
    fn loaded(&mut self, bodies: &[BodyState], least_n: f64, visit: Visit<'_>);

    /// Returns the power losses of the contacts; `None` if not available.
    fn losses(&mut self, bodies: &[BodyState]) -> Option<ContactEnergy>;
}

/// Contacts of an engine whose contact forces follow the native law at its states; for an RV gear with the bearings of its
/// cranks.
pub struct LawPairs<'a>(pub &'a mut ContactField);

impl PairSource for LawPairs<'_> {
    fn pair(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> Option<PairContact> {
        Some(self.0.nearest(bodies, wheel, sleeve))
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) -> bool {
        self.0.touching(bodies, visit);
        self.0.on_cranks(bodies).iter().for_each(visit);
        true
    }

    fn loaded(&mut self, bodies: &[BodyState], least_n: f64, visit: Visit<'_>) {
        self.touching(bodies, &mut |pair| {
            if pair.normal_force_n > least_n {
                visit(pair.wheel, pair.sleeve);
            }
        });
    }

    fn losses(&mut self, bodies: &[BodyState]) -> Option<ContactEnergy> {
        Some(self.0.energy(bodies))
    }
}

/// State of an engine at a sample.
pub struct EngineState<'a> {
    /// States of all bodies.
    pub bodies: &'a [BodyState],
    /// Torque on the input shaft, N m.
    pub driver_torque_n_m: f64,
    /// Force of every revolute on the body it carries, N, ground frame, in the order of [`Gearbox::mechanism`]; `None` if not
    /// available.
    pub reactions: Option<&'a [[f64; 2]]>,
    /// Source of the contacts' data.
    pub contacts: &'a mut dyn PairSource,
}

/// Channel columns under construction.
#[derive(Debug, Clone)]
pub(crate) struct Values {
    list: Vec<Chosen>,
    /// Values of each channel; `None` once a value was not available.
    columns: Vec<Option<Vec<f64>>>,
    /// Requested pairs without repetition, and the index of each channel's pair.
    pairs: Vec<(usize, Sleeve)>,
    places: Vec<usize>,
    /// Index of each pair of the gear among the requested ones, by its [`number`].
    known: Vec<Option<usize>>,
    current: Vec<Option<PairContact>>,
    /// True if a channel needs data of pairs without contact.
    needs_gaps: bool,
    /// Numbers of external and internal pins that press on each disc.
    contacts: Vec<[usize; 2]>,
    needs_contacts: bool,
    needs_losses: bool,
    /// Force above which a pair counts as pressing, N.
    pressing_n: f64,
    pressure: LinePressure,
    carrier: Carrier,
    layout: Layout,
    geometry: Geometry,
}

impl Values {
    /// Creates the columns; `None` if the scene requests no channel.
    pub(crate) fn new(gearbox: &Gearbox, samples: usize) -> Option<Self> {
        let Channels { list } = &gearbox.channels;
        if list.is_empty() {
            return None;
        }
        let layout = gearbox.layout;
        let mut pairs: Vec<(usize, Sleeve)> = Vec::new();
        let mut known = vec![None; layout.wheels * layout.bodies()];
        let places = list
            .iter()
            .map(|chosen| {
                let Some(pair) = chosen.pair else { return 0 };
                *known[number(layout, pair)].get_or_insert_with(|| {
                    pairs.push(pair);
                    pairs.len() - 1
                })
            })
            .collect();
        let asks = |wanted: &[Whole]| {
            let is = |chosen: &Chosen| matches!(chosen.what, What::Whole(w) if wanted.contains(&w));
            list.iter().any(is)
        };
        let of_gaps = |chosen: &Chosen| {
            use PairQuantity as P;
            let forces = [
                P::NormalForce,
                P::FrictionForce,
                P::ForceX,
                P::ForceY,
                P::Pressure,
                P::PressureSliding,
            ];
            matches!(chosen.what, What::Pair(quantity) if !forces.contains(&quantity))
        };
        Some(Self {
            needs_gaps: list.iter().any(of_gaps),
            columns: vec![Some(Vec::with_capacity(samples)); list.len()],
            current: vec![None; pairs.len()],
            contacts: vec![[0; 2]; gearbox.layout.wheels],
            needs_contacts: asks(&[Whole::ExternalContacts, Whole::InternalContacts]),
            needs_losses: asks(&[Whole::DampingLoss, Whole::FrictionLoss]),
            pressing_n: Scales::of(&gearbox.scene).pressing_n(),
            pressure: LinePressure::new(&gearbox.scene.contact),
            carrier: gearbox.carrier.clone(),
            layout: gearbox.layout,
            geometry: gearbox.geometry.clone(),
            list: list.clone(),
            pairs,
            places,
            known,
        })
    }

    /// Adds a sample. `output_torque`: total torque on the output shaft without its load, N m.
    pub(crate) fn record(&mut self, state: &mut EngineState<'_>, output_torque: f64) {
        let bodies = state.bodies;
        let apart = self.find(state);
        self.contacts.fill([0; 2]);
        let counts = &mut self.contacts;
        let mut count = |wheel: usize, sleeve: Sleeve| {
            let kind = usize::from(matches!(sleeve, Sleeve::Internal(_)));
            counts[wheel][kind] += 1;
        };
        if self.needs_contacts {
            state.contacts.loaded(bodies, self.pressing_n, &mut count);
        }
        let losses = self.needs_losses.then(|| state.contacts.losses(bodies));
        let losses = losses.flatten();
        let output = bodies[Layout::OUTPUT];
        let input = bodies[Layout::INPUT];
        let ring_turns = self.geometry.ring_turns();
        let held = ring_turns.then(|| with_carrier(bodies));
        let carried_by = held.as_deref().unwrap_or(bodies);
        let powers = [
            state.driver_torque_n_m * input.rate,
            output_torque * output.rate,
        ];
        for (k, chosen) in self.list.iter().enumerate() {
            let Some(column) = &mut self.columns[k] else {
                continue;
            };
            let value = match chosen.what {
                What::Pair(kind) => {
                    let value = self.current[self.places[k]].map(|pair| {
                        let wheel = &bodies[self.layout.wheel_bodies().start + pair.wheel];
                        let centre = [wheel.x, wheel.y];
                        of_pair(&pair, kind, || {
                            self.pressure.of(&self.geometry, &pair, centre, wheel.angle)
                        })
                    });
                    value.or(apart)
                }
                What::Joint(joint, part) => {
                    let body = carried(self.layout, joint, chosen.number);
                    let force = match joint {
                        Joint::Eccentric if self.carrier.floats() => {
                            let load = self.carrier.load(carried_by, chosen.number);
                            load.map(|load| load.on_wheel)
                        }
                        // Floating discs have no revolute.
                        _ if self.carrier.floats() && body > Layout::OUTPUT => state
                            .reactions
                            .and_then(|all| all.get(body - self.layout.wheels).copied()),
                        _ => state.reactions.and_then(|all| all.get(body).copied()),
                    };
                    force.map(|force| of_joint(bodies, force, body, part))
                }
                What::State(joint, component) => {
                    let body = &bodies[carried(self.layout, joint, chosen.number)];
                    Some(match component {
                        Component::Angle => body.angle,
                        Component::Rate => body.rate,
                        Component::X => body.x,
                        Component::Y => body.y,
                        Component::VelocityX => body.vx,
                        Component::VelocityY => body.vy,
                    })
                }
                What::Whole(kind) => match kind {
                    Whole::Efficiency => Some(efficiency(powers)),
                    Whole::InputPower => Some(powers[0]),
                    Whole::OutputPower => Some(powers[1]),
                    Whole::DampingLoss => losses.map(|l| l.damping_w),
                    Whole::FrictionLoss => losses.map(|l| l.friction_w()),
                    Whole::TransmissionError => {
                        let ideal = self.geometry.ideal_turn_of_output(input.angle);
                        Some((output.angle - ideal) * ARCMIN)
                    }
                    Whole::WheelTransmissionError => {
                        let wheel = self.layout.wheel_bodies().start + chosen.number;
                        let mut ideal = self.geometry.ideal_wheel_angle(chosen.number, input.angle);
                        if ring_turns {
                            ideal += self.geometry.ideal_turn_of_output(input.angle);
                        }
                        Some((bodies[wheel].angle - ideal) * ARCMIN)
                    }
                    Whole::BearingOffsetX | Whole::BearingOffsetY => {
                        let load = self.carrier.load(carried_by, chosen.number);
                        let [x, y] = load.map_or([0.0; 2], |load| load.offset_m);
                        Some(if kind == Whole::BearingOffsetX { x } else { y })
                    }
                    Whole::ExternalContacts => Some(self.contacts[chosen.number][0] as f64),
                    Whole::InternalContacts => Some(self.contacts[chosen.number][1] as f64),
                },
            };
            match value {
                Some(value) => column.push(value),
                None => self.columns[k] = None,
            }
        }
    }

    /// Evaluates the requested pairs. If only forces are requested, pairs that do not touch have zero force.
    fn find(&mut self, state: &mut EngineState<'_>) -> Option<f64> {
        self.current.fill(None);
        let (current, pairs, layout) = (&mut self.current, &self.pairs, self.layout);
        let places = &self.known;
        let known = !self.needs_gaps
            && !pairs.is_empty()
            && state.contacts.touching(state.bodies, &mut |pair| {
                if let Some(place) = places[number(layout, (pair.wheel, pair.sleeve))] {
                    current[place] = Some(*pair);
                }
            });
        if known {
            return Some(0.0);
        }
        for (current, &(wheel, sleeve)) in current.iter_mut().zip(pairs) {
            *current = state.contacts.pair(state.bodies, wheel, sleeve);
        }
        None
    }

    /// Removes the last sample and appends its values to `row`.
    pub(crate) fn take_last(&mut self, row: &mut Vec<f64>) {
        let last = |column: &mut Option<Vec<f64>>| column.as_mut().and_then(Vec::pop);
        row.extend(self.columns.iter_mut().map(|c| last(c).unwrap_or(f64::NAN)));
    }

    /// Returns the names and values of the columns that have one value for each of `samples`.
    pub(crate) fn finish(self, samples: usize) -> impl Iterator<Item = (String, Vec<f64>)> {
        let named = self.list.into_iter().zip(self.columns);
        named
            .filter_map(|(chosen, column)| column.map(|column| (chosen.name, column)))
            .filter(move |(_, column)| column.len() == samples)
    }
}

/// Returns the number of a pair among those of all discs and bodies.
fn number(layout: Layout, (wheel, sleeve): (usize, Sleeve)) -> usize {
    wheel * layout.bodies() + layout.sleeve_body(sleeve)
}

fn of_pair(pair: &PairContact, quantity: PairQuantity, pressure: impl Fn() -> f64) -> f64 {
    match quantity {
        PairQuantity::Penetration => pair.penetration_m,
        PairQuantity::NormalVelocity => pair.normal_rate_m_s,
        PairQuantity::TangentialVelocity => pair.tangential_rate_m_s,
        PairQuantity::Stiffness => pair.stiffness,
        PairQuantity::PointX => pair.point[0],
        PairQuantity::PointY => pair.point[1],
        PairQuantity::NormalForce => pair.normal_force_n,
        PairQuantity::FrictionForce => pair.friction_force_n,
        PairQuantity::ForceX => -pair.force_on_sleeve()[0],
        PairQuantity::ForceY => -pair.force_on_sleeve()[1],
        PairQuantity::Pressure => pressure(),
        PairQuantity::PressureSliding => pressure() * pair.tangential_rate_m_s.abs(),
    }
}

/// Returns the body that a joint carries. Revolutes are in the order of these bodies, see [`Gearbox::mechanism`].
fn carried(layout: Layout, joint: Joint, number: usize) -> usize {
    match joint {
        Joint::Input => Layout::INPUT,
        Joint::Output => Layout::OUTPUT,
        Joint::Eccentric => layout.wheel_bodies().start + number,
        Joint::ExternalPin => layout.sleeve_body(Sleeve::External(number)),
        Joint::InternalPin => layout.sleeve_body(Sleeve::Internal(number)),
    }
}

fn of_joint(bodies: &[BodyState], [fx, fy]: [f64; 2], body: usize, part: Part) -> f64 {
    let (dx, dy) = (
        bodies[body].x - bodies[Layout::INPUT].x,
        bodies[body].y - bodies[Layout::INPUT].y,
    );
    match part {
        Part::Magnitude => fx.hypot(fy),
        Part::X => fx,
        Part::Y => fy,
        Part::Radial => (fx * dx + fy * dy) / dx.hypot(dy),
        Part::Tangential => (dx * fy - dy * fx) / dx.hypot(dy),
    }
}

fn efficiency([input, output]: [f64; 2]) -> f64 {
    let ratio = output / input;
    if input > 0.0 && ratio.is_finite() {
        ratio
    } else {
        0.0
    }
}
