//! All pairs of wheels and sleeves: the scalar, readable contact loop.
//!
//! Everything happens in the wheel's frame, where curve and holes stand still: one rotation per
//! wheel brings the sleeves in, one brings the sum of forces back. Forces of a pair act at W on
//! both bodies, so action and reaction balance in force and in moment.

use pinwheel_contact::{AdamsFriction, Complex, Friction, NormalLaw, RegularisedCoulomb};
use pinwheel_faults::{Fault, factor};
use pinwheel_mbs::{BodyState, Wrench};

use super::detection::{Detection, Touch};
use super::field::{ContactEnergy, ContactField, PairContact};
use crate::geometry::Geometry;
use crate::scene::{self, FrictionLaw, Scene};
use crate::{Layout, Sleeve};

/// The contact field of one law and one detection.
pub(super) struct Pairs<L, D> {
    layout: Layout,
    law: L,
    detection: D,
    friction: Friction,
    external_directions: Vec<Complex>,
    external_sleeves: u32,
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
        law: &impl NormalLaw,
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

    /// Adds what the pair stores and dissipates.
    #[inline]
    pub(super) fn add_energy(&self, law: &impl NormalLaw, sum: &mut ContactEnergy) {
        let (stiffness, depth) = (self.touch.stiffness, self.touch.penetration);
        let elastic = law.force(stiffness, depth, 0.0);
        sum.stored_j += law.stored(stiffness, depth);
        sum.damping_w += (self.normal_force - elastic) * self.normal_rate;
        sum.friction_w -= self.friction_force * self.tangential_rate;
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

impl<L: NormalLaw, D: Detection> Pairs<L, D> {
    pub(super) fn new(scene: &Scene, geometry: &Geometry, law: L, detection: D) -> Self {
        Self {
            layout: Layout::of(&scene.gear),
            law,
            detection,
            friction: friction(&scene.contact),
            external_directions: geometry.external_directions.clone(),
            external_sleeves: scene.gear.external_sleeves as u32,
        }
    }

    /// v_rel = (sleeve's material velocity at W, spin included) - (wheel's at W), then Eq. 20 and 21.
    #[inline]
    fn load(&self, touch: Touch, wheel: &WheelFrame, sleeve: &BodyState, p: Complex) -> Loaded {
        let (arm, normal_rate, tangential_rate) = self.rates(&touch, wheel, sleeve, p);
        let normal_force = self
            .law
            .force(touch.stiffness, touch.penetration, normal_rate);
        let friction_force = self.friction.force(normal_force, tangential_rate);
        let along = self.law.along(touch.penetration);
        let along_force = along.map_or(0.0, |along| -touch.stiffness_slope * along);
        Loaded {
            touch,
            arm,
            normal_rate,
            tangential_rate,
            normal_force,
            friction_force,
            along_force,
        }
    }

    /// The arm W - P, and v_n and v_t there.
    #[inline]
    fn rates(
        &self,
        touch: &Touch,
        wheel: &WheelFrame,
        sleeve: &BodyState,
        p: Complex,
    ) -> (Complex, f64, f64) {
        let arm = touch.point - p;
        let sleeve_velocity = Complex::new(sleeve.vx, sleeve.vy) * wheel.turn.conj()
            + arm.turned().scale(sleeve.rate);
        let wheel_velocity = wheel.velocity + touch.point.turned().scale(wheel.rate);
        let relative = sleeve_velocity - wheel_velocity;
        let normal_rate = relative.dot(touch.normal);
        (arm, normal_rate, relative.dot(touch.normal.turned()))
    }

    /// Visits every touching pair of one wheel.
    #[inline]
    fn wheel_pairs(
        &self,
        wheel: usize,
        bodies: &[BodyState],
        frame: &WheelFrame,
        mut visit: impl FnMut(Sleeve, usize, &Loaded),
    ) {
        // The ideal mesh has the foot of sleeve j at a0 = beta_j - theta, and zk beta_j is a whole turn.
        let back = frame.turn.conj();
        let multiple = back.powu(self.external_sleeves);
        let first = self.layout.external_bodies().start;
        for (j, &direction) in self.external_directions.iter().enumerate() {
            let sleeve = &bodies[first + j];
            let p = frame.point(sleeve);
            if let Some(touch) = self.detection.profile(p, direction * back, multiple) {
                visit(
                    Sleeve::External(j),
                    first + j,
                    &self.load(touch, frame, sleeve, p),
                );
            }
        }
        let first = self.layout.internal_bodies().start;
        for k in 0..self.layout.internal_sleeves {
            let sleeve = &bodies[first + k];
            let p = frame.point(sleeve);
            if let Some(touch) = self.detection.hole(wheel, k, p) {
                visit(
                    Sleeve::Internal(k),
                    first + k,
                    &self.load(touch, frame, sleeve, p),
                );
            }
        }
    }
}

impl<L: NormalLaw, D: Detection> ContactField for Pairs<L, D> {
    fn add_loads(&mut self, bodies: &[BodyState], loads: &mut [Wrench]) {
        for (wheel, body) in self.layout.wheel_bodies().enumerate() {
            let frame = WheelFrame::of(&bodies[body]);
            let (mut force, mut moment) = (Complex::default(), 0.0);
            self.wheel_pairs(wheel, bodies, &frame, |_, sleeve, pair| {
                let on_sleeve = pair.on_sleeve();
                let mut total = on_sleeve;
                moment -= pair.touch.point.cross(on_sleeve);
                if self.law.along(pair.touch.penetration).is_some() {
                    let centre = pair.touch.point - pair.arm;
                    total = total + pair.at_centre();
                    moment -= centre.cross(pair.at_centre());
                }
                force = force - total;
                let ground = total * frame.turn;
                let load = &mut loads[sleeve];
                load.fx += ground.re;
                load.fy += ground.im;
                load.moment += pair.arm.cross(on_sleeve);
            });
            let ground = force * frame.turn;
            let load = &mut loads[body];
            load.fx += ground.re;
            load.fy += ground.im;
            load.moment += moment;
        }
    }

    fn energy(&mut self, bodies: &[BodyState]) -> ContactEnergy {
        let mut sum = ContactEnergy::default();
        for (wheel, body) in self.layout.wheel_bodies().enumerate() {
            let frame = WheelFrame::of(&bodies[body]);
            self.wheel_pairs(wheel, bodies, &frame, |_, _, pair| {
                pair.add_energy(&self.law, &mut sum);
            });
        }
        sum
    }

    fn normal_force(&self, pair: &PairContact, rate: f64) -> f64 {
        self.law.force(pair.stiffness, pair.penetration_m, rate)
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        for (wheel, body) in self.layout.wheel_bodies().enumerate() {
            let frame = WheelFrame::of(&bodies[body]);
            self.wheel_pairs(wheel, bodies, &frame, |sleeve, _, pair| {
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
                let unit = self.external_directions[j] * back;
                self.detection.profile(p, unit, multiple)
            }
            Sleeve::Internal(k) => self.detection.hole(wheel, k, p),
        };
        let pair = match touch {
            Some(touch) => self.load(touch, &frame, body, p),
            None => {
                let touch = match sleeve {
                    Sleeve::External(_) => self.detection.profile_gap(p),
                    Sleeve::Internal(k) => self.detection.hole_gap(wheel, k, p),
                };
                let (arm, normal_rate, tangential_rate) = self.rates(&touch, &frame, body, p);
                Loaded {
                    touch,
                    arm,
                    normal_rate,
                    tangential_rate,
                    normal_force: 0.0,
                    friction_force: 0.0,
                    along_force: 0.0,
                }
            }
        };
        pair.contact(&self.law, wheel, sleeve, &frame)
    }
}
