//! Scalar, readable contact loop over all pairs of discs and pins.
//!
//! Contacts are computed in the disc's frame, where curve and holes are at rest. One rotation per disc transforms the pins into
//! this frame, and one transforms the sum of forces back. Forces of a pair act at W on both bodies, so that action and reaction
//! balance in force and in moment.

use pinwheel_contact::{Complex, Dual, Friction, NormalLaw, OnPin, PinLaw, Scalar};
use pinwheel_mbs::{BodyState, Derivatives, Evaluation, Wrench};

use super::detection::{Detection, Exact, Touch};
use super::flanks::{Flanks, Seat};
use super::motion::{self, Motion, WheelFrame};
use super::pair::{PairContact, PairField};
use super::pin_friction::{PinFriction, friction};
use super::shared_pins::{OnShared, SharedPins};
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::{Layout, Sleeve};

/// Contact field of one detection.
pub(super) struct Pairs<D> {
    layout: Layout,
    law: PinLaw,
    detection: D,
    /// Friction of the contacts, and of sleeves, of ring and of output pins.
    friction: [Friction; 2],
    pins: [Option<PinFriction>; 2],
    external_directions: Vec<Complex>,
    external_sleeves: u32,
    flanks: Option<Flanks>,
    shared: Option<SharedPins>,
}

/// Rates and forces of a touch, in the disc's frame.
#[derive(Clone, Copy)]
pub(super) struct Loaded<S = f64> {
    pub(super) touch: Touch<S>,
    /// Arm W - P, m.
    pub(super) arm: Complex<S>,
    pub(super) normal_rate: S,
    pub(super) tangential_rate: S,
    pub(super) normal_force: S,
    pub(super) friction_force: S,
    pub(super) along_force: S,
    /// Stiffness of the pin or of its seat, N/m, and its part of the energy of a shared pin, J.
    pub(super) pin_n_m: Option<f64>,
    pub(super) shared_j: f64,
}

impl<S: Scalar> Loaded<S> {
    /// Force on the pin at its centre, along the profile.
    #[inline]
    fn at_centre(&self) -> Complex<S> {
        self.touch.normal.turned().scale(self.along_force)
    }

    /// Force on the pin at W.
    #[inline]
    fn on_sleeve(&self) -> Complex<S> {
        self.touch.normal.turned().scale(self.friction_force)
            - self.touch.normal.scale(self.normal_force)
    }
}

impl Loaded {
    /// Returns the pair in the ground frame.
    #[inline]
    pub(super) fn contact(
        &self,
        law: &PinLaw,
        wheel: usize,
        sleeve: Sleeve,
        frame: &WheelFrame,
    ) -> PairContact {
        let ground = |z: Complex| (frame.centre + z * frame.turn).to_array();
        PairContact {
            wheel,
            sleeve,
            point: ground(self.touch.point),
            normal: (self.touch.normal * frame.turn).to_array(),
            penetration_m: self.touch.penetration,
            normal_rate_m_s: self.normal_rate,
            tangential_rate_m_s: self.tangential_rate,
            stiffness: law.law.stiffness(self.touch.stiffness),
            normal_force_n: self.normal_force,
            friction_force_n: self.friction_force,
            along_force_n: self.along_force,
            centre: ground(self.touch.point - self.arm),
            pin_n_m: self.pin_n_m,
            shared_j: self.shared_j,
        }
    }
}

impl<D: Detection> Pairs<D> {
    pub(super) fn new(scene: &Scene, geometry: &Geometry, law: PinLaw, detection: D) -> Self {
        Self {
            layout: Layout::of(&scene.gear),
            law,
            detection,
            friction: scene.sliding().map(|mu| friction(&scene.contact, mu)),
            pins: PinFriction::of(scene),
            external_directions: geometry.external_directions.clone(),
            external_sleeves: scene.gear.external_sleeves as u32,
            flanks: Flanks::of(geometry),
            shared: SharedPins::of(scene),
        }
    }

    /// Returns the touch of ring pin `j` with the disc.
    #[inline]
    fn profile(&self, j: usize, p: Complex, start: [Complex; 2]) -> Option<(Touch, Seat)> {
        let Some(flanks) = &self.flanks else {
            let (touch, unit) = self.detection.profile(j, p, start)?;
            let turn = Complex::ONE;
            return Some((touch, Seat::Foot { unit, turn }));
        };
        let [unit, multiple] = start;
        let [one, other] = flanks.turns().map(|turn| {
            let back = turn.conj();
            let start = [unit * back, multiple * back.powu(self.external_sleeves)];
            let foot = self.detection.profile(j, p * back, start);
            foot.map(|(touch, unit)| (touch.turned(turn), Seat::Foot { unit, turn }))
        });
        let nearest = self.on_flanks(flanks, j, p, [one?, other?]);
        (nearest.0.penetration > 0.0).then_some(nearest)
    }

    fn profile_gap(&self, j: usize, p: Complex) -> Touch {
        let Some(flanks) = &self.flanks else {
            return self.detection.profile_gap(j, p);
        };
        let feet = flanks.turns().map(|turn| {
            let touch = self.detection.profile_gap(j, p * turn.conj());
            (touch.turned(turn), Seat::Corner)
        });
        self.on_flanks(flanks, j, p, feet).0
    }

    fn on_flanks(
        &self,
        flanks: &Flanks,
        j: usize,
        p: Complex,
        feet: [(Touch, Seat); 2],
    ) -> (Touch, Seat) {
        let (radius, _) = self.detection.sleeve(j, 0.0);
        flanks.touch(p, radius, feet, |kappa| self.detection.sleeve(j, kappa).1)
    }

    /// Bends pins that discs share.
    fn bend(&mut self, bodies: &[BodyState]) {
        if let Some(shared) = &mut self.shared {
            let touch = |wheel, pin, p| self.detection.hole_gap(wheel, pin, p);
            shared.bend(&self.law, bodies, touch);
        }
    }

    /// Returns the centre of a pin in a disc's frame, its stiffness (N/m), and its part of the energy of a shared pin, J.
    #[inline]
    fn placed(
        &self,
        wheel: usize,
        sleeve: Sleeve,
        body: &BodyState,
        frame: &WheelFrame,
    ) -> (Complex, Option<f64>, f64) {
        let place = Complex::new(body.x, body.y);
        match (sleeve, &self.shared) {
            (Sleeve::External(_), _) => (frame.point(place), self.law.ring_n_m, 0.0),
            (Sleeve::Internal(_), None) => (frame.point(place), self.law.pin_n_m, 0.0),
            (Sleeve::Internal(pin), Some(shared)) => {
                let bent = shared.bent(wheel, pin);
                let pin_n_m = Some(shared.stiffness_n_m(wheel));
                (frame.point(place + bent.moved), pin_n_m, bent.shared_j)
            }
        }
    }

    /// Computes v_rel = (pin's material velocity at W, spin included) - (disc's at W), then Eq. 20 and 21.
    #[inline]
    fn load<S: Scalar + OnPin>(
        &self,
        kind: Sleeve,
        touch: Touch<S>,
        wheel: &WheelFrame<S>,
        (velocity, rate): (Complex<S>, S),
        (p, pin_n_m, shared_j): (Complex<S>, Option<f64>, f64),
    ) -> Loaded<S> {
        let arm = touch.point - p;
        let sleeve_velocity = velocity * wheel.turn.conj() + arm.turned().scale(rate);
        let wheel_velocity = wheel.velocity + touch.point.turned().scale(wheel.rate);
        let relative = sleeve_velocity - wheel_velocity;
        let normal_rate = relative.dot(touch.normal);
        let tangential_rate = relative.dot(touch.normal.turned());
        let (stiffness, depth) = (touch.stiffness, touch.penetration);
        let law = self.law.on(pin_n_m);
        let normal_force = law.force(stiffness, depth, normal_rate);
        let along = law.along(stiffness, depth);
        Loaded {
            touch,
            arm,
            normal_rate,
            tangential_rate,
            normal_force,
            friction_force: self.friction[kind.side()].force(normal_force, tangential_rate),
            along_force: along.map_or(depth.like(0.0), |along| -touch.stiffness_slope * along),
            pin_n_m,
            shared_j,
        }
    }

    /// Visits every touching pair of one disc, with its pin, the pin's body and the contact point.
    #[inline]
    fn wheel_pairs(
        &self,
        wheel: usize,
        bodies: &[BodyState],
        frame: &WheelFrame,
        mut visit: impl FnMut(Sleeve, usize, &Loaded, Seat),
    ) {
        // At the ideal mesh the foot of pin j is at a0 = beta_j - theta, and zk beta_j is a multiple of 2 pi.
        let back = frame.turn.conj();
        let multiple = back.powu(self.external_sleeves);
        let first = self.layout.external_bodies().start;
        for (j, &direction) in self.external_directions.iter().enumerate() {
            let (body, sleeve) = (&bodies[first + j], Sleeve::External(j));
            let placed = self.placed(wheel, sleeve, body, frame);
            if let Some((touch, seat)) = self.profile(j, placed.0, [direction * back, multiple]) {
                let pair = self.load(sleeve, touch, frame, moves(body), placed);
                visit(sleeve, first + j, &pair, seat);
            }
        }
        let first = self.layout.internal_bodies().start;
        for k in 0..self.layout.internal_sleeves {
            let (body, sleeve) = (&bodies[first + k], Sleeve::Internal(k));
            let placed = self.placed(wheel, sleeve, body, frame);
            if let Some(touch) = self.detection.hole(wheel, k, placed.0) {
                let pair = self.load(sleeve, touch, frame, moves(body), placed);
                visit(sleeve, first + k, &pair, Seat::Corner);
            }
        }
    }
}

/// Returns the velocity and the rate of a pin.
#[inline]
fn moves(sleeve: &BodyState) -> (Complex, f64) {
    (Complex::new(sleeve.vx, sleeve.vy), sleeve.rate)
}

/// Reaction of the pins on a disc, in its frame.
#[derive(Default)]
struct Reaction {
    force: Complex,
    moment: f64,
}

impl Reaction {
    #[inline]
    fn add_to(&self, load: &mut Wrench, frame: &WheelFrame) {
        let ground = self.force * frame.turn;
        load.fx += ground.re;
        load.fy += ground.im;
        load.moment += self.moment;
    }
}

impl<D: Detection> Pairs<D> {
    /// Adds the load of a pair to its pin, and its reaction to the disc.
    #[inline]
    fn add_load(&self, pair: &Loaded, frame: &WheelFrame, load: &mut Wrench, left: &mut Reaction) {
        let on_sleeve = pair.on_sleeve();
        let mut total = on_sleeve;
        left.moment -= pair.touch.point.cross(on_sleeve);
        if self.law.law.along(1.0, 1.0).is_some() {
            let centre = pair.touch.point - pair.arm;
            total = total + pair.at_centre();
            left.moment -= centre.cross(pair.at_centre());
        }
        left.force = left.force - total;
        let ground = total * frame.turn;
        load.fx += ground.re;
        load.fy += ground.im;
        load.moment += pair.arm.cross(on_sleeve);
    }

    /// Adds the derivatives of one pair's loads; `at`: its disc, pin, the pin's body and the contact point. Returns those of a pin
    /// that discs share.
    #[inline(never)]
    fn add_derivatives(
        &self,
        exact: &Exact,
        (wheel, sleeve, pin, seat): (usize, Sleeve, usize, Seat),
        bodies: &[BodyState],
        pair: &Loaded,
        derivatives: &mut Derivatives<'_>,
    ) -> Option<OnShared> {
        let hub = self.layout.wheel_bodies().start + wheel;
        let [input, output, disc, own] =
            [Layout::INPUT, Layout::OUTPUT, hub, pin].map(|body| &bodies[body]);
        let [angle, x, y, rate, vx, vy] = motion::values(disc);
        let [angle, x, y, rate, vx, vy, psi, psi_rate, spin] = Dual::variables([
            angle,
            x,
            y,
            rate,
            vx,
            vy,
            output.angle,
            output.rate,
            own.rate,
        ]);
        let frame = WheelFrame::of(&motion::of_values([angle, x, y, rate, vx, vy]));
        let is_internal = matches!(sleeve, Sleeve::Internal(_));
        let (place, velocity) = if is_internal {
            let Motion {
                place, velocity, ..
            } = Motion::carried(own, output, [psi, psi_rate]);
            (place, velocity)
        } else {
            let (place, (velocity, _)) = (Complex::new(own.x, own.y), moves(own));
            (place.like(spin), velocity.like(spin))
        };
        let bent = match (sleeve, &self.shared) {
            (Sleeve::Internal(pin), Some(shared)) => Some((pin, shared.bent(wheel, pin).moved)),
            _ => None,
        };
        let p = frame.point(bent.map_or(place, |(_, moved)| place + moved.like(spin)));
        let touch = match (sleeve, seat) {
            (Sleeve::External(j), Seat::Foot { unit, turn }) => {
                let touch = exact.beside(j, p * turn.conj().like(spin), unit);
                Some(touch.turned(turn))
            }
            (Sleeve::External(j), Seat::Corner) => {
                let (radius, _) = exact.sleeve(j, 0.0);
                Some(Touch::at_point(
                    p,
                    pair.touch.point,
                    radius,
                    pair.touch.stiffness,
                ))
            }
            (Sleeve::Internal(k), _) => exact.in_hole(wheel, k, p),
        };
        let touch = touch?;
        let placed = (p, pair.pin_n_m, 0.0);
        let pair = self.load(sleeve, touch, &frame, (velocity, spin), placed);
        let (on_sleeve, at_centre) = (pair.on_sleeve(), pair.at_centre());
        let ground = (on_sleeve + at_centre) * frame.turn;
        let coordinates = derivatives.coordinates;
        let (turn, carrier) = (coordinates.angle(pin), coordinates.angle(Layout::OUTPUT));
        let [angle, x, y, rate, vx, vy] = motion::variables(coordinates, hub, disc, input);
        let variables = [
            angle,
            x,
            y,
            rate,
            vx,
            vy,
            motion::position(carrier, output.rate),
            motion::rate(carrier, 0.0),
            motion::rate(turn, 0.0),
        ];
        let (place_row, on_disc) = (
            coordinates.place(hub),
            -touch.point.cross(on_sleeve) - p.cross(at_centre),
        );
        let rows = [
            (coordinates.angle(hub), on_disc),
            (place_row, -ground.re),
            (place_row.map(|x| x + 1), -ground.im),
            (turn, pair.arm.cross(on_sleeve)),
            (carrier.filter(|_| is_internal), place.cross(ground)),
        ];
        for (row, load) in &rows {
            derivatives.add(*row, &variables, &load.by);
        }
        let (pin, _) = bent?;
        let law = self.law.on(pair.pin_n_m);
        let pressed = law.force(touch.stiffness, touch.penetration, Dual::constant(0.0));
        Some(OnShared {
            wheel,
            pin,
            variables,
            rows,
            at_rest: (touch.normal * frame.turn).scale(-pressed).to_array(),
        })
    }
}

impl<D: Detection> PairField for Pairs<D> {
    fn work_from_angles(&self) -> bool {
        false
    }

    fn have_derivatives(&self) -> bool {
        let smooth = |friction: &Friction| matches!(friction, Friction::Regularised(_));
        self.detection.exact().is_some() && self.friction.iter().all(smooth)
    }

    fn evaluate(&mut self, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        self.bend(bodies);
        let wants_pins = request.loads.is_some() || request.energy.is_some();
        let mut on_shared = Vec::new();
        for (wheel, hub) in self.layout.wheel_bodies().enumerate() {
            let frame = WheelFrame::of(&Motion::of(&bodies[hub]));
            let mut reaction = Reaction::default();
            self.wheel_pairs(wheel, bodies, &frame, |sleeve, body, pair, seat| {
                if let Some(loads) = &mut request.loads {
                    self.add_load(pair, &frame, &mut loads[body], &mut reaction);
                }
                if let (Some(derivatives), Some(exact)) =
                    (&mut request.derivatives, self.detection.exact())
                {
                    let at = (wheel, sleeve, body, seat);
                    let added = self.add_derivatives(exact, at, bodies, pair, derivatives);
                    on_shared.extend(added);
                }
                let pins = self.pins[sleeve.side()].filter(|_| wants_pins);
                if request.energy.is_none() && pins.is_none() {
                    return;
                }
                let pair = pair.contact(&self.law, wheel, sleeve, &frame);
                if let Some(energy) = &mut request.energy {
                    pair.add_energy(&self.law, energy);
                }
                if let Some(pins) = pins {
                    let drag = pins.drag(bodies, &pair);
                    if let Some(energy) = &mut request.energy {
                        energy.sleeve_friction_w += drag.lost_w;
                    }
                    if let Some(loads) = &mut request.loads {
                        pins.add(bodies, &pair, &drag, loads);
                    }
                }
            });
            if let Some(loads) = &mut request.loads {
                reaction.add_to(&mut loads[hub], &frame);
            }
        }
        if let (Some(shared), Some(derivatives)) = (&self.shared, &mut request.derivatives) {
            shared.add_bending(&on_shared, derivatives);
        }
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        self.bend(bodies);
        for (wheel, body) in self.layout.wheel_bodies().enumerate() {
            let frame = WheelFrame::of(&Motion::of(&bodies[body]));
            self.wheel_pairs(wheel, bodies, &frame, |sleeve, _, pair, _| {
                visit(&pair.contact(&self.law, wheel, sleeve, &frame));
            });
        }
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        self.bend(bodies);
        let hub = &bodies[self.layout.wheel_bodies().start + wheel];
        let frame = WheelFrame::of(&Motion::of(hub));
        let body = &bodies[self.layout.sleeve_body(sleeve)];
        let placed = self.placed(wheel, sleeve, body, &frame);
        let p = placed.0;
        let touch = match sleeve {
            Sleeve::External(j) => {
                let back = frame.turn.conj();
                let multiple = back.powu(self.external_sleeves);
                let start = [self.external_directions[j] * back, multiple];
                self.profile(j, p, start).map(|(touch, _)| touch)
            }
            Sleeve::Internal(k) => self.detection.hole(wheel, k, p),
        };
        let gap = || match sleeve {
            Sleeve::External(j) => self.profile_gap(j, p),
            Sleeve::Internal(k) => self.detection.hole_gap(wheel, k, p),
        };
        let mut pair = self.load(
            sleeve,
            touch.unwrap_or_else(gap),
            &frame,
            moves(body),
            placed,
        );
        if touch.is_none() {
            (pair.normal_force, pair.friction_force, pair.along_force) = (0.0, 0.0, 0.0);
        }
        pair.contact(&self.law, wheel, sleeve, &frame)
    }
}
