//! All pairs of wheels and sleeves: the scalar, readable contact loop.
//!
//! Everything happens in the wheel's frame, where curve and holes stand still: one rotation per
//! wheel brings the sleeves in, one brings the sum of forces back. Forces of a pair act at W on
//! both bodies, so action and reaction balance in force and in moment.

use pinwheel_contact::{AdamsFriction, Complex, Friction, Law, NormalLaw, RegularisedCoulomb};
use pinwheel_faults::{Fault, factor};
use pinwheel_mbs::{BodyState, Jacobian, Pose, Sums, Wrench};

use super::detection::{Detection, Slopes, Touch};
use super::field::{ContactEnergy, ContactField, PairContact};
use super::flanks::{Flanks, Seat};
use crate::geometry::Geometry;
use crate::scene::{self, FrictionLaw, Scene};
use crate::{Layout, Sleeve};

/// The contact field of one detection.
pub(super) struct Pairs<D> {
    layout: Layout,
    law: Law,
    detection: D,
    friction: Friction,
    external_directions: Vec<Complex>,
    external_sleeves: u32,
    flanks: Option<Flanks>,
}

/// A wheel's frame and motion.
#[derive(Clone, Copy)]
pub(super) struct WheelFrame {
    pub(super) centre: Complex,
    /// e^{i theta}, wheel frame to ground.
    pub(super) turn: Complex,
    /// Velocity of the centre in the wheel's directions.
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

/// Rates and forces of a touch, still in the wheel's frame.
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
    /// Force on the sleeve at its centre, along the profile.
    #[inline]
    fn at_centre(&self) -> Complex {
        self.touch.normal.turned().scale(self.along_force)
    }

    /// Force on the sleeve at W.
    #[inline]
    fn on_sleeve(&self) -> Complex {
        self.touch.normal.turned().scale(self.friction_force)
            - self.touch.normal.scale(self.normal_force)
    }

    /// The pair in the ground frame.
    #[inline]
    pub(super) fn contact(
        &self,
        law: &Law,
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
            stiffness: law.stiffness(self.touch.stiffness),
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
    pub(super) fn new(scene: &Scene, geometry: &Geometry, law: Law, detection: D) -> Self {
        Self {
            layout: Layout::of(&scene.gear),
            law,
            detection,
            friction: friction(&scene.contact),
            external_directions: geometry.external_directions.clone(),
            external_sleeves: scene.gear.external_sleeves as u32,
            flanks: Flanks::of(geometry),
        }
    }

    /// External sleeve `j` against the wheel.
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

    /// v_rel = (sleeve's material velocity at W, spin included) - (wheel's at W), then Eq. 20 and 21.
    #[inline]
    fn load(&self, touch: Touch, wheel: &WheelFrame, sleeve: &BodyState, p: Complex) -> Loaded {
        let arm = touch.point - p;
        let sleeve_velocity = Complex::new(sleeve.vx, sleeve.vy) * wheel.turn.conj()
            + arm.turned().scale(sleeve.rate);
        let wheel_velocity = wheel.velocity + touch.point.turned().scale(wheel.rate);
        let relative = sleeve_velocity - wheel_velocity;
        let normal_rate = relative.dot(touch.normal);
        let tangential_rate = relative.dot(touch.normal.turned());
        let (stiffness, depth) = (touch.stiffness, touch.penetration);
        let normal_force = self.law.force(stiffness, depth, normal_rate);
        let along = self.law.along(stiffness, depth);
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

    /// Visits every touching pair of one wheel: sleeve, its body, the pair, and where it touches.
    #[inline]
    fn wheel_pairs(
        &self,
        wheel: usize,
        bodies: &[BodyState],
        frame: &WheelFrame,
        mut visit: impl FnMut(Sleeve, usize, &Loaded, Seat),
    ) {
        // The ideal mesh has the foot of sleeve j at a0 = beta_j - theta, and zk beta_j is a whole turn.
        let back = frame.turn.conj();
        let multiple = back.powu(self.external_sleeves);
        let first = self.layout.external_bodies().start;
        for (j, &direction) in self.external_directions.iter().enumerate() {
            let sleeve = &bodies[first + j];
            let p = frame.point(sleeve);
            if let Some((touch, seat)) = self.profile(j, p, [direction * back, multiple]) {
                let pair = self.load(touch, frame, sleeve, p);
                visit(Sleeve::External(j), first + j, &pair, seat);
            }
        }
        let first = self.layout.internal_bodies().start;
        for k in 0..self.layout.internal_sleeves {
            let sleeve = &bodies[first + k];
            let p = frame.point(sleeve);
            if let Some(touch) = self.detection.hole(wheel, k, p) {
                let pair = self.load(touch, frame, sleeve, p);
                visit(Sleeve::Internal(k), first + k, &pair, Seat::Corner);
            }
        }
    }
}

/// Of the free bodies, which are all but the first.
pub(super) const OUTPUT: usize = Layout::OUTPUT - 1;
/// Shares of stiffness and penetration, and the closing speed (m/s), by which the law's differences go to either side.
pub(super) const STIFFNESS_SHARE: f64 = 1e-4;
pub(super) const PENETRATION_SHARE: f64 = 1e-5;
pub(super) const CLOSING: f64 = 1e-6;

/// Slopes of the moments of a pair on its wheel, on the output and on the sleeve.
type Moments = [f64; 3];

/// What the sleeves leave on a wheel, in its frame.
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
    /// How the moments of a pair change with the angles of wheel, output and input, and with their rates; then with the
    /// sleeve's own rate, which friction alone feels. In the notation of [`slopes`](super::lanes), whose formulas these are
    /// for one pair.
    fn columns(
        &self,
        bodies: &[BodyState],
        frame: &WheelFrame,
        (sleeve, body): (Sleeve, &BodyState),
        pair: &Loaded,
        slopes: &Slopes,
        friction: Option<RegularisedCoulomb>,
    ) -> ([(Moments, Moments); 3], Moments) {
        let (law, touch) = (&self.law, &pair.touch);
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

        let force = |stiffness: f64, depth: f64, closing: f64| law.force(stiffness, depth, closing);
        let either = |h: f64, of: &dyn Fn(f64) -> f64| (of(h) - of(-h)) / (2.0 * h);
        let by_stiffness = either(STIFFNESS_SHARE * stiffness, &|h| {
            force(stiffness + h, depth, closing)
        });
        let by_depth = either(PENETRATION_SHARE * depth, &|h| {
            force(stiffness, depth + h, closing)
        });
        let by_closing = either(CLOSING, &|h| force(stiffness, depth, closing + h));
        let pressed = force(stiffness, depth, closing);
        let Slopes {
            turning,
            stiffening,
            bend,
        } = *slopes;
        // A = -K' Y, and its slopes by the way along t and by the depth; K' itself grows with the depth by -turning.
        let along = law.along(stiffness, depth).filter(|_| !is_internal);
        let at_centre = along.map(|along| {
            let rise = either(PENETRATION_SHARE * depth, &|h| {
                law.along(stiffness, depth + h).unwrap_or_default()
            });
            let by_stiffness = either(STIFFNESS_SHARE * stiffness, &|h| {
                law.along(stiffness + h, depth).unwrap_or_default()
            });
            (
                -stiffening * along,
                -(bend * along + stiffening * stiffening * by_stiffness),
                stiffening * (turning * along - rise),
            )
        });

        // T = -mu F g, and its slopes by F and by v_t.
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

        let normal_levers = [-p.cross(n), carried * z.cross(n), -c.cross(n)];
        let levers = [-p.dot(n), carried * z.dot(n), -c.dot(n)];
        let turns = [-1.0, 0.0, 1.0];
        let [on_wheel, on_output] = [normal_levers[0], normal_levers[1]];
        // What the sliding speed depends on the rates with; on the wheel's with W instead of P.
        let drags = [levers[0] - rho, levers[1], rho];
        let by = [0, 1, 2].map(|k| {
            let (lever, path) = (normal_levers[k], levers[k]);
            let tilt = turning * path;
            let (by_centre, beside) = (c.dot(n) * turns[k], c.cross(n) * turns[k]);
            let slower = tilt * passing - over_wheel * path - by_centre * over_input;
            let faster = over_wheel * lever + beside * over_input - tilt * closing - lever * spin;
            let push = by_stiffness * stiffening * path + by_depth * lever + by_closing * slower;
            let pull = drag_by_force * push + drag_by_slip * faster;
            let mut wheel = pull * drags[0]
                - push * on_wheel
                - pressed * (path - tilt * p.dot(n))
                - drag * tilt * p.dot(t);
            if let Some((force, by_path, by_depth)) = at_centre {
                wheel += (by_path * path + by_depth * lever) * levers[0]
                    - force * (lever + tilt * p.dot(t));
            }
            let output = pull * drags[1] - push * on_output
                + carried * drag * (lever + beside + tilt * z.dot(t))
                - carried * pressed * (tilt * z.dot(n) - path - by_centre);
            let position = [wheel, output, pull * rho - drag * lever];
            let push = by_closing * lever;
            let pull = drag_by_force * push + drag_by_slip * if k == 0 { drags[0] } else { path };
            let rate = [
                pull * drags[0] - push * on_wheel,
                pull * drags[1] - push * on_output,
                pull * rho,
            ];
            (position, rate)
        });
        (by, drags.map(|lever| drag_by_slip * rho * lever))
    }
}

impl<D: Detection> Pairs<D> {
    /// Adds what a pair does to its sleeve, and what that leaves on the wheel.
    #[inline]
    fn add_load(&self, pair: &Loaded, frame: &WheelFrame, load: &mut Wrench, left: &mut Reaction) {
        let on_sleeve = pair.on_sleeve();
        let mut total = on_sleeve;
        left.moment -= pair.touch.point.cross(on_sleeve);
        if self.law.along(1.0, 1.0).is_some() {
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

    /// The friction that slopes must know, if any; `None`: this field has none of the slopes asked for.
    fn sloped_friction(&self, slopes: &Jacobian) -> Option<Option<RegularisedCoulomb>> {
        let free = slopes.rate.dimension();
        let friction = match self.friction {
            Friction::Regularised(friction) if free + 1 == self.layout.bodies() => Some(friction),
            _ if free == 1 + self.layout.wheels => None,
            _ => return None,
        };
        (D::HAS_SLOPES && slopes.position.is_some()).then_some(friction)
    }

    /// Adds how the moments of one pair change; `at`: its wheel, sleeve, the sleeve's body and where it touches.
    #[inline]
    fn add_slopes_of(
        &self,
        (wheel, sleeve, body, seat): (usize, Sleeve, usize, Seat),
        bodies: &[BodyState],
        frame: &WheelFrame,
        pair: &Loaded,
        friction: Option<RegularisedCoulomb>,
        slopes: &mut Jacobian,
    ) {
        let Some(position) = &mut slopes.position else {
            return;
        };
        let input_rate = bodies[Layout::INPUT].rate;
        // Sleeves are free where something rubs.
        let moved = if friction.is_some() { 3 } else { 2 };
        let touch = match (sleeve, seat) {
            (Sleeve::External(j), Seat::Foot(unit)) => {
                self.detection.profile_slopes(j, &pair.touch, unit)
            }
            (Sleeve::External(_), Seat::Corner) => Slopes {
                turning: -1.0 / pair.arm.norm(),
                ..Slopes::default()
            },
            (Sleeve::Internal(k), _) => self.detection.hole_slopes(wheel, k, &pair.touch),
        };
        let own = (sleeve, &bodies[body]);
        let (by, by_spin) = self.columns(bodies, frame, own, pair, &touch, friction);
        let [by_wheel, by_output, (by_input, _)] = by;
        let rows = [1 + wheel, OUTPUT, body - 1];
        for (k, &row) in rows.iter().enumerate().take(moved) {
            for (of, (by_angle, by_rate)) in rows.iter().zip([&by_wheel, &by_output]) {
                position.add(row, *of, by_angle[k]);
                slopes.rate.add(row, *of, by_rate[k]);
            }
            slopes.time[row] += by_input[k] * input_rate;
            if friction.is_some() {
                slopes.rate.add(row, body - 1, by_spin[k]);
            }
        }
    }
}

impl<D: Detection> ContactField for Pairs<D> {
    fn evaluate(&mut self, bodies: &[BodyState], pose: Pose, sums: &mut Sums<'_>) -> bool {
        let friction = match &sums.slopes {
            None => Some(None),
            Some(slopes) => self.sloped_friction(slopes),
        };
        let is_told = sums.moments.is_none() && pose != Pose::AnglesOnly;
        let Some(friction) = friction.filter(|_| is_told) else {
            return false;
        };
        let mut energy = ContactEnergy::default();
        for (wheel, hub) in self.layout.wheel_bodies().enumerate() {
            let frame = WheelFrame::of(&bodies[hub]);
            let mut reaction = Reaction::default();
            self.wheel_pairs(wheel, bodies, &frame, |sleeve, body, pair, seat| {
                if let Some(loads) = &mut sums.loads {
                    self.add_load(pair, &frame, &mut loads[body], &mut reaction);
                }
                if let Some(slopes) = &mut sums.slopes {
                    let at = (wheel, sleeve, body, seat);
                    self.add_slopes_of(at, bodies, &frame, pair, friction, slopes);
                }
                if sums.wants_energy {
                    let pair = pair.contact(&self.law, wheel, sleeve, &frame);
                    pair.add_energy(&self.law, &mut energy);
                }
            });
            if let Some(loads) = &mut sums.loads {
                reaction.add_to(&mut loads[hub], &frame);
            }
        }
        sums.energy = sums.wants_energy.then_some(energy);
        true
    }

    fn law(&self) -> &Law {
        &self.law
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
        let mut pair = self.load(touch.unwrap_or_else(gap), &frame, body, p);
        if touch.is_none() {
            (pair.normal_force, pair.friction_force, pair.along_force) = (0.0, 0.0, 0.0);
        }
        pair.contact(&self.law, wheel, sleeve, &frame)
    }
}
