//! All pairs of discs and pins: the scalar, readable contact loop.
//!
//! Everything happens in the disc's frame, where curve and holes stand still: one rotation per
//! disc brings the pins in, one brings the sum of forces back. Forces of a pair act at W on
//! both bodies, so action and reaction balance in force and in moment.

use pinwheel_contact::{AdamsFriction, Complex, Friction, NormalLaw, PinLaw, RegularisedCoulomb};
use pinwheel_faults::{Fault, factor};
use pinwheel_mbs::{BodyState, ContactEnergy, Evaluation, Jacobian, Pose, Wrench};

use super::detection::{Derivatives, Detection, Touch};
use super::flanks::{Flanks, Seat};
use super::pair::{PairContact, PairField};
use super::pin_friction::PinFriction;
use crate::geometry::Geometry;
use crate::scene::{self, FrictionLaw, Scene};
use crate::{Layout, Sleeve};

/// The contact field of one detection.
pub(super) struct Pairs<D> {
    layout: Layout,
    law: PinLaw,
    detection: D,
    friction: Friction,
    pins: Option<PinFriction>,
    external_directions: Vec<Complex>,
    external_sleeves: u32,
    flanks: Option<Flanks>,
}

/// A disc's frame and motion.
#[derive(Clone, Copy)]
pub(super) struct WheelFrame {
    pub(super) centre: Complex,
    /// e^{i theta}, disc frame to ground.
    pub(super) turn: Complex,
    /// Velocity of the centre in the disc's directions.
    pub(super) velocity: Complex,
    pub(super) rate: f64,
}

impl WheelFrame {
    fn of(body: &BodyState) -> Self {
        let turn = Complex::unit(body.angle);
        Self {
            centre: Complex::new(body.x, body.y),
            turn,
            velocity: Complex::new(body.vx, body.vy) * turn.conj(),
            rate: body.rate,
        }
    }

    #[inline]
    fn point(&self, body: &BodyState) -> Complex {
        (Complex::new(body.x, body.y) - self.centre) * self.turn.conj()
    }
}

/// Rates and forces of a touch, still in the disc's frame.
#[derive(Clone, Copy)]
pub(super) struct Loaded {
    pub(super) touch: Touch,
    /// W - P.
    pub(super) arm: Complex,
    pub(super) normal_rate: f64,
    pub(super) tangential_rate: f64,
    pub(super) normal_force: f64,
    pub(super) friction_force: f64,
    pub(super) along_force: f64,
}

impl Loaded {
    /// Force on the pin at its centre, along the profile.
    #[inline]
    fn at_centre(&self) -> Complex {
        self.touch.normal.turned().scale(self.along_force)
    }

    /// Force on the pin at W.
    #[inline]
    fn on_sleeve(&self) -> Complex {
        self.touch.normal.turned().scale(self.friction_force)
            - self.touch.normal.scale(self.normal_force)
    }

    /// The pair in the ground frame.
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
        }
    }
}

/// The friction of a scene.
fn friction(contact: &scene::Contact) -> Friction {
    match contact.friction_law {
        FrictionLaw::Regularised => Friction::Regularised(RegularisedCoulomb {
            coefficient: contact.friction_coefficient,
            ramp: contact.friction_ramp_m_s * factor(Fault::FrictionSign, -1.0),
        }),
        FrictionLaw::Adams => Friction::Adams(AdamsFriction {
            static_coefficient: contact.friction_coefficient,
            dynamic_coefficient: contact.friction_dynamic_coefficient,
            static_speed: contact.friction_ramp_m_s,
            dynamic_speed: contact.friction_dynamic_speed_m_s,
        }),
    }
}

impl<D: Detection> Pairs<D> {
    pub(super) fn new(scene: &Scene, geometry: &Geometry, law: PinLaw, detection: D) -> Self {
        Self {
            layout: Layout::of(&scene.gear),
            law,
            detection,
            friction: friction(&scene.contact),
            pins: PinFriction::of(scene),
            external_directions: geometry.external_directions.clone(),
            external_sleeves: scene.gear.external_sleeves as u32,
            flanks: Flanks::of(geometry),
        }
    }

    /// Ring pin `j` against the disc.
    #[inline]
    fn profile(&self, j: usize, p: Complex, start: [Complex; 2]) -> Option<(Touch, Seat)> {
        let Some(flanks) = &self.flanks else {
            let (touch, unit) = self.detection.profile(j, p, start)?;
            return Some((touch, Seat::Foot(unit)));
        };
        let [unit, multiple] = start;
        let [one, other] = flanks.turns().map(|turn| {
            let back = turn.conj();
            let start = [unit * back, multiple * back.powu(self.external_sleeves)];
            let found = self.detection.profile(j, p * back, start);
            found.map(|(touch, unit)| (touch.turned(turn), Seat::Foot(unit)))
        });
        let found = self.on_flanks(flanks, j, p, [one?, other?]);
        (found.0.penetration > 0.0).then_some(found)
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

    /// v_rel = (pin's material velocity at W, spin included) - (disc's at W), then Eq. 20 and 21.
    #[inline]
    fn load(
        &self,
        kind: Sleeve,
        touch: Touch,
        wheel: &WheelFrame,
        sleeve: &BodyState,
        p: Complex,
    ) -> Loaded {
        let arm = touch.point - p;
        let sleeve_velocity = Complex::new(sleeve.vx, sleeve.vy) * wheel.turn.conj()
            + arm.turned().scale(sleeve.rate);
        let wheel_velocity = wheel.velocity + touch.point.turned().scale(wheel.rate);
        let relative = sleeve_velocity - wheel_velocity;
        let normal_rate = relative.dot(touch.normal);
        let tangential_rate = relative.dot(touch.normal.turned());
        let (stiffness, depth) = (touch.stiffness, touch.penetration);
        let normal_force = self.force(kind, stiffness, depth, normal_rate);
        let along = self.law.law.along(stiffness, depth);
        Loaded {
            touch,
            arm,
            normal_rate,
            tangential_rate,
            normal_force,
            friction_force: self.friction.force(normal_force, tangential_rate),
            along_force: along.map_or(0.0, |along| -touch.stiffness_slope * along),
        }
    }

    /// F of a pin of that kind.
    #[inline]
    fn force(&self, kind: Sleeve, stiffness: f64, depth: f64, rate: f64) -> f64 {
        match kind {
            Sleeve::External(_) => self.law.law.force(stiffness, depth, rate),
            Sleeve::Internal(_) => self.law.force(stiffness, depth, rate),
        }
    }

    /// Visits every touching pair of one disc: pin, its body, the pair, and where it touches.
    #[inline]
    fn wheel_pairs(
        &self,
        wheel: usize,
        bodies: &[BodyState],
        frame: &WheelFrame,
        mut visit: impl FnMut(Sleeve, usize, &Loaded, Seat),
    ) {
        // The ideal mesh has the foot of pin j at a0 = beta_j - theta, and zk beta_j is a whole turn.
        let back = frame.turn.conj();
        let multiple = back.powu(self.external_sleeves);
        let first = self.layout.external_bodies().start;
        for (j, &direction) in self.external_directions.iter().enumerate() {
            let sleeve = &bodies[first + j];
            let p = frame.point(sleeve);
            if let Some((touch, seat)) = self.profile(j, p, [direction * back, multiple]) {
                let pair = self.load(Sleeve::External(j), touch, frame, sleeve, p);
                visit(Sleeve::External(j), first + j, &pair, seat);
            }
        }
        let first = self.layout.internal_bodies().start;
        for k in 0..self.layout.internal_sleeves {
            let sleeve = &bodies[first + k];
            let p = frame.point(sleeve);
            if let Some(touch) = self.detection.hole(wheel, k, p) {
                let pair = self.load(Sleeve::Internal(k), touch, frame, sleeve, p);
                visit(Sleeve::Internal(k), first + k, &pair, Seat::Corner);
            }
        }
    }
}

/// Number of the output among the free bodies, which are all but the first.
pub(super) const OUTPUT: usize = Layout::OUTPUT - 1;

/// Number of the first place of discs that float, among all that is free.
pub(super) fn places(layout: Layout, derivatives: &Jacobian) -> usize {
    derivatives
        .rate
        .dimension()
        .saturating_sub(2 * layout.wheels)
}
/// Shares of stiffness and penetration, and the closing speed (m/s), by which the law's differences go to either side.
pub(super) const STIFFNESS_SHARE: f64 = 1e-4;
pub(super) const PENETRATION_SHARE: f64 = 1e-5;
pub(super) const CLOSING: f64 = 1e-6;

/// Derivatives of what a pair does: moments on its disc, on the output and on the pin, and the force on the disc, ground frame.
type Rows = [f64; 5];

/// Motion by which derivatives are taken: it moves the pin's centre P against the disc.
#[derive(Clone, Copy)]
struct Move {
    /// d(delta), d(tau): the way of P along n and along t.
    way: [f64; 2],
    /// How the velocity of P changes along n and along t, that n turns left aside.
    drift: [f64; 2],
    /// How z changes: its moment on n, and along n.
    arm: [f64; 2],
    /// By how much the disc turns.
    turn: f64,
    /// Derivative of the sliding speed with respect to the motion's rate.
    slip: f64,
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
    /// How what a pair does changes with the angles of disc and output, then with the input's, or with the place of a disc that
    /// floats, and with their rates; then with the pin's own rate, which friction alone feels. In the notation of
    /// [`derivatives`](super::lanes), whose formulas these are for one pair.
    fn columns(
        &self,
        bodies: &[BodyState],
        frame: &WheelFrame,
        (sleeve, body): (Sleeve, &BodyState),
        pair: &Loaded,
        derivatives: &Derivatives,
        (friction, floats): (Option<RegularisedCoulomb>, bool),
    ) -> ([(Rows, Rows); 4], Rows) {
        let (law, touch) = (&self.law.law, &pair.touch);
        let (stiffness, depth) = (touch.stiffness, touch.penetration);
        let (n, t) = (touch.normal, touch.normal.turned());
        let back = frame.turn.conj();
        let (p, c) = (touch.point - pair.arm, frame.centre * back);
        let z = p + c;
        let is_internal = matches!(sleeve, Sleeve::Internal(_));
        let carried = f64::from(u8::from(is_internal));
        let carrier = carried * bodies[Layout::OUTPUT].rate;
        let (over_wheel, over_input) = (carrier - frame.rate, carrier - bodies[Layout::INPUT].rate);
        let velocity =
            Complex::new(body.vx, body.vy) * back - frame.velocity - p.turned().scale(frame.rate);
        let (closing, passing) = (velocity.dot(n), velocity.dot(t));

        let force = |stiffness: f64, depth: f64, closing: f64| {
            self.force(sleeve, stiffness, depth, closing)
        };
        let either = |h: f64, of: &dyn Fn(f64) -> f64| (of(h) - of(-h)) / (2.0 * h);
        let by_stiffness = either(STIFFNESS_SHARE * stiffness, &|h| {
            force(stiffness + h, depth, closing)
        });
        let by_depth = either(PENETRATION_SHARE * depth, &|h| {
            force(stiffness, depth + h, closing)
        });
        let by_closing = either(CLOSING, &|h| force(stiffness, depth, closing + h));
        let pressed = force(stiffness, depth, closing);
        let Derivatives {
            turning,
            stiffening,
            bend,
        } = *derivatives;
        // A = -K' Y, and its derivatives by the way along t and by the depth; K' itself grows with the depth by -turning.
        let along = law.along(stiffness, depth).filter(|_| !is_internal);
        let [at_centre, along_by_path, along_by_depth] = along.map_or([0.0; 3], |along| {
            let rise = either(PENETRATION_SHARE * depth, &|h| {
                law.along(stiffness, depth + h).unwrap_or_default()
            });
            let by_stiffness = either(STIFFNESS_SHARE * stiffness, &|h| {
                law.along(stiffness + h, depth).unwrap_or_default()
            });
            [
                -stiffening * along,
                -(bend * along + stiffening * stiffening * by_stiffness),
                stiffening * (turning * along - rise),
            ]
        });

        // T = -mu F g, and its derivatives by F and by v_t.
        let (rho, spin) = (pair.arm.dot(n), body.rate - frame.rate);
        let [mut drag_by_force, mut drag_by_slip] = [0.0; 2];
        if let Some(RegularisedCoulomb { coefficient, ramp }) = friction {
            let share = (rho * spin + passing) / ramp;
            drag_by_force = -coefficient * share.clamp(-1.0, 1.0);
            if share.abs() < 1.0 {
                drag_by_slip = -coefficient / ramp * pressed;
            }
        }
        let drag = drag_by_force * pressed;

        let (across, along) = (p.cross(n), p.dot(n));
        // A disc that is carried swings with the input, one that floats goes its own way.
        let turned = |way: [f64; 2], turn: f64| {
            let (by_centre, beside) = (c.dot(n) * turn, c.cross(n) * turn);
            Move {
                way,
                drift: [
                    -over_wheel * way[1] - by_centre * over_input,
                    over_wheel * way[0] + beside * over_input,
                ],
                arm: [-way[1] - by_centre, way[0] + beside],
                turn: if turn < 0.0 { 1.0 } else { 0.0 },
                slip: way[1],
            }
        };
        let mut of_wheel = turned([-across, -along], -1.0);
        // With W instead of P.
        of_wheel.slip -= rho;
        let of_output = turned([carried * z.cross(n), carried * z.dot(n)], 0.0);
        let of_input = turned([-c.cross(n), -c.dot(n)], 1.0);
        let axes = [back, back.turned()];
        let [x, y] = axes.map(|axis| {
            let way = [-axis.dot(n), -axis.dot(t)];
            Move {
                way,
                drift: [frame.rate * way[1], -frame.rate * way[0]],
                arm: [0.0; 2],
                turn: 0.0,
                slip: way[1],
            }
        });
        if floats {
            of_wheel.drift = [passing, -closing];
        }
        let moves = match floats {
            true => [of_wheel, of_output, x, y],
            false => [of_wheel, of_output, of_input, of_input],
        };
        let ground = |normal: f64, tangential: f64| {
            axes.map(|axis| axis.dot(n.scale(normal) + t.scale(tangential)))
        };
        let by = moves.map(|of| {
            let ([lever, path], [aside, against]) = (of.way, of.arm);
            let tilt = turning * path;
            let slower = tilt * passing + of.drift[0];
            let faster = of.drift[1] - tilt * closing - lever * spin;
            let push = by_stiffness * stiffening * path + by_depth * lever + by_closing * slower;
            let pull = drag_by_force * push + drag_by_slip * faster;
            let beside = along_by_path * path + along_by_depth * lever;
            let wheel = pull * of_wheel.slip + push * across
                - pressed * (path - tilt * along)
                - drag * tilt * p.dot(t)
                - beside * along
                - at_centre * (lever + tilt * p.dot(t));
            let output = pull * of_output.slip - push * of_output.way[0]
                + carried * drag * (against + tilt * z.dot(t))
                - carried * pressed * (tilt * z.dot(n) + aside);
            let tilt = tilt + of.turn;
            let [fx, fy] = ground(
                push + (drag + at_centre) * tilt,
                pressed * tilt - pull - beside,
            );
            let position = [wheel, output, pull * rho - drag * lever, fx, fy];
            let push = by_closing * lever;
            let pull = drag_by_force * push + drag_by_slip * of.slip;
            let [fx, fy] = ground(push, -pull);
            let rate = [
                pull * of_wheel.slip + push * across,
                pull * of_output.slip - push * of_output.way[0],
                pull * rho,
                fx,
                fy,
            ];
            (position, rate)
        });
        let pull = drag_by_slip * rho;
        let [fx, fy] = ground(0.0, -pull);
        let by_spin = [
            pull * of_wheel.slip,
            pull * of_output.slip,
            pull * rho,
            fx,
            fy,
        ];
        (by, by_spin)
    }
}

impl<D: Detection> Pairs<D> {
    /// Adds what a pair does to its pin, and what that leaves on the disc.
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

    /// The friction that derivatives must know, if any, and whether discs float; `None`: this field has none of the derivatives asked for.
    fn sloped_friction(
        &self,
        derivatives: &Jacobian,
    ) -> Option<(Option<RegularisedCoulomb>, bool)> {
        let free = derivatives.rate.dimension();
        let places = 2 * self.layout.wheels;
        let [rubbing, smooth] = [self.layout.bodies() - 1, 1 + self.layout.wheels];
        let (friction, floats) = match self.friction {
            Friction::Regularised(friction) if free == rubbing || free == rubbing + places => {
                (Some(friction), free > rubbing)
            }
            _ if free == smooth || free == smooth + places => (None, free > smooth),
            _ => return None,
        };
        (D::HAS_SLOPES && derivatives.position.is_some()).then_some((friction, floats))
    }

    /// Adds how what one pair does changes; `at`: its disc, pin, the pin's body and where it touches.
    #[inline]
    fn add_slopes_of(
        &self,
        (wheel, sleeve, body, seat): (usize, Sleeve, usize, Seat),
        bodies: &[BodyState],
        frame: &WheelFrame,
        pair: &Loaded,
        (friction, floats): (Option<RegularisedCoulomb>, bool),
        derivatives: &mut Jacobian,
    ) {
        let first_place = places(self.layout, derivatives);
        let Some(position) = &mut derivatives.position else {
            return;
        };
        let touch = match (sleeve, seat) {
            (Sleeve::External(j), Seat::Foot(unit)) => {
                self.detection.profile_slopes(j, &pair.touch, unit)
            }
            (Sleeve::External(_), Seat::Corner) => Derivatives {
                turning: -1.0 / pair.arm.norm(),
                ..Derivatives::default()
            },
            (Sleeve::Internal(k), _) => self.detection.hole_slopes(wheel, k, &pair.touch),
        };
        let own = (sleeve, &bodies[body]);
        let (by, by_spin) = self.columns(bodies, frame, own, pair, &touch, (friction, floats));
        let place = first_place + 2 * wheel;
        let rows = [1 + wheel, OUTPUT, body - 1, place, place + 1];
        for (k, &row) in rows.iter().enumerate() {
            // Pins are free where something rubs.
            if k == 2 && friction.is_none() || k > 2 && !floats {
                continue;
            }
            let free = [rows[0], rows[1], place, place + 1];
            for (of, (by_place, by_rate)) in free.iter().zip(&by).take(if floats { 4 } else { 2 }) {
                position.add(row, *of, by_place[k]);
                derivatives.rate.add(row, *of, by_rate[k]);
            }
            if !floats {
                derivatives.time[row] += by[2].0[k] * bodies[Layout::INPUT].rate;
            }
            if friction.is_some() {
                derivatives.rate.add(row, body - 1, by_spin[k]);
            }
        }
    }
}

impl<D: Detection> PairField for Pairs<D> {
    fn evaluate(&mut self, bodies: &[BodyState], pose: Pose, sums: &mut Evaluation<'_>) -> bool {
        let friction = match &sums.derivatives {
            None => Some((None, false)),
            Some(derivatives) => self.sloped_friction(derivatives),
        };
        let is_told = sums.moments.is_none() && pose != Pose::AnglesOnly;
        let Some(friction) = friction.filter(|_| is_told) else {
            return false;
        };
        let mut energy = ContactEnergy::default();
        let pins = self
            .pins
            .filter(|_| sums.loads.is_some() || sums.wants_energy);
        for (wheel, hub) in self.layout.wheel_bodies().enumerate() {
            let frame = WheelFrame::of(&bodies[hub]);
            let mut reaction = Reaction::default();
            self.wheel_pairs(wheel, bodies, &frame, |sleeve, body, pair, seat| {
                if let Some(loads) = &mut sums.loads {
                    self.add_load(pair, &frame, &mut loads[body], &mut reaction);
                }
                if let Some(derivatives) = &mut sums.derivatives {
                    let at = (wheel, sleeve, body, seat);
                    self.add_slopes_of(at, bodies, &frame, pair, friction, derivatives);
                }
                if !sums.wants_energy && pins.is_none() {
                    return;
                }
                let pair = pair.contact(&self.law, wheel, sleeve, &frame);
                if sums.wants_energy {
                    pair.add_energy(&self.law, &mut energy);
                }
                if let Some(pins) = pins {
                    let drag = pins.drag(bodies, &pair);
                    energy.sleeve_friction_w += drag.lost_w;
                    if let Some(loads) = &mut sums.loads {
                        pins.add(bodies, &pair, &drag, loads);
                    }
                }
            });
            if let Some(loads) = &mut sums.loads {
                reaction.add_to(&mut loads[hub], &frame);
            }
        }
        sums.energy = sums.wants_energy.then_some(energy);
        true
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        for (wheel, body) in self.layout.wheel_bodies().enumerate() {
            let frame = WheelFrame::of(&bodies[body]);
            self.wheel_pairs(wheel, bodies, &frame, |sleeve, _, pair, _| {
                visit(&pair.contact(&self.law, wheel, sleeve, &frame));
            });
        }
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        let frame = WheelFrame::of(&bodies[self.layout.wheel_bodies().start + wheel]);
        let body = &bodies[self.layout.sleeve_body(sleeve)];
        let p = frame.point(body);
        let touch = match sleeve {
            Sleeve::External(j) => {
                let back = frame.turn.conj();
                let multiple = back.powu(self.external_sleeves);
                let start = [self.external_directions[j] * back, multiple];
                self.profile(j, p, start).map(|found| found.0)
            }
            Sleeve::Internal(k) => self.detection.hole(wheel, k, p),
        };
        let gap = || match sleeve {
            Sleeve::External(j) => self.profile_gap(j, p),
            Sleeve::Internal(k) => self.detection.hole_gap(wheel, k, p),
        };
        let mut pair = self.load(sleeve, touch.unwrap_or_else(gap), &frame, body, p);
        if touch.is_none() {
            (pair.normal_force, pair.friction_force, pair.along_force) = (0.0, 0.0, 0.0);
        }
        pair.contact(&self.law, wheel, sleeve, &frame)
    }
}
