//! All pairs of wheels and sleeves, several at a time: the fast form of [`pairs`](super::pairs).
//!
//! Exact detection only. Sleeve states stand in structure-of-arrays columns, padded to whole groups
//! of lanes whose surplus is masked. Formulas, signs and frames are those of the scalar loop, which
//! stays as the oracle (tests: equal to 1e-13 relative). The vector instructions are chosen when the
//! program runs, by what the processor has.

use pinwheel_contact::{
    Complex, ComplexLanes, Epitrochoid, HertzStiffness, Lanes, LanesLaw, Mask, RegularisedCoulomb,
};
use pinwheel_mbs::{BodyState, Wrench};
use pulp::Simd;

use super::detection::Exact;
use super::field::{ContactEnergy, ContactField, PairContact};
use super::pairs::Pairs;
use crate::geometry::Geometry;
use crate::layout::{Layout, Sleeve};
use crate::scene::Scene;

/// Columns are padded to a multiple of the widest group (two AVX-512 registers).
const PADDING: usize = 16;

/// A column of planar vectors.
#[derive(Debug, Clone, Default)]
struct Column {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Column {
    fn padded(values: impl Iterator<Item = Complex>) -> Self {
        let (mut x, mut y): (Vec<f64>, Vec<f64>) = values.map(|z| (z.re, z.im)).unzip();
        let length = x.len().next_multiple_of(PADDING);
        x.resize(length, 0.0);
        y.resize(length, 0.0);
        Self { x, y }
    }

    #[inline(always)]
    fn load<S: Simd>(&self, simd: S, from: usize) -> ComplexLanes<S> {
        let to = from + Lanes::<S>::COUNT;
        ComplexLanes::new(
            Lanes::load(simd, &self.x[from..to]),
            Lanes::load(simd, &self.y[from..to]),
        )
    }

    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, from: usize, value: ComplexLanes<S>) {
        let sum = self.load(simd, from) + value;
        sum.re.store(&mut self.x[from..]);
        sum.im.store(&mut self.y[from..]);
    }
}

/// Sleeves of one kind: states in, loads out.
#[derive(Debug, Clone)]
struct Sleeves {
    first: usize,
    count: usize,
    position: Column,
    velocity: Column,
    rate: Vec<f64>,
    force: Column,
    moment: Vec<f64>,
}

impl Sleeves {
    fn new(bodies: std::ops::Range<usize>) -> Self {
        let column = Column::padded(bodies.clone().map(|_| Complex::default()));
        let scalars = vec![0.0; column.x.len()];
        Self {
            first: bodies.start,
            count: bodies.len(),
            position: column.clone(),
            velocity: column.clone(),
            rate: scalars.clone(),
            force: column,
            moment: scalars,
        }
    }

    #[inline(always)]
    fn gather(&mut self, bodies: &[BodyState]) {
        for (k, b) in bodies[self.first..self.first + self.count]
            .iter()
            .enumerate()
        {
            (self.position.x[k], self.position.y[k]) = (b.x, b.y);
            (self.velocity.x[k], self.velocity.y[k]) = (b.vx, b.vy);
            self.rate[k] = b.rate;
        }
        self.force.x.fill(0.0);
        self.force.y.fill(0.0);
        self.moment.fill(0.0);
    }

    #[inline(always)]
    fn scatter(&self, loads: &mut [Wrench]) {
        for (k, load) in loads[self.first..self.first + self.count]
            .iter_mut()
            .enumerate()
        {
            load.fx += self.force.x[k];
            load.fy += self.force.y[k];
            load.moment += self.moment[k];
        }
    }

    /// Starts of the groups, with the mask of lanes that are sleeves.
    #[inline(always)]
    fn groups<S: Simd>(&self, simd: S) -> impl Iterator<Item = (usize, Mask<S>)> + use<S> {
        let count = self.count;
        (0..count)
            .step_by(Lanes::<S>::COUNT)
            .map(move |from| (from, Mask::first(simd, count - from)))
    }
}

/// Touching lanes of a group in the wheel's frame.
struct Touching<S: Simd> {
    mask: Mask<S>,
    point: ComplexLanes<S>,
    normal: ComplexLanes<S>,
    penetration: Lanes<S>,
    stiffness: Lanes<S>,
}

/// A wheel's frame, and what its contacts add up to (in that frame).
struct Wheel<S: Simd> {
    centre: ComplexLanes<S>,
    turn: ComplexLanes<S>,
    back: ComplexLanes<S>,
    velocity: ComplexLanes<S>,
    rate: Lanes<S>,
    force: ComplexLanes<S>,
    moment: Lanes<S>,
}

/// Geometry of the contacts.
#[derive(Debug, Clone)]
struct Shapes {
    curve: Epitrochoid,
    zk: u32,
    external_radius: f64,
    /// K where C is straight: K = this * sqrt(1 - q kappa).
    profile_stiffness: f64,
    hole_stiffness: f64,
    hole_radius: f64,
    clearance: f64,
    directions: Column,
    /// Hole centres in the wheel's frame, by wheel.
    holes: Vec<Column>,
}

/// The contact field of one law with exact detection, in lanes.
pub(super) struct LaneField<L> {
    arch: pulp::Arch,
    layout: Layout,
    law: L,
    friction: RegularisedCoulomb,
    shapes: Shapes,
    external: Sleeves,
    internal: Sleeves,
    /// Used where pairs are wanted one by one.
    scalar: Pairs<L, Exact>,
}

impl<L: LanesLaw> LaneField<L> {
    pub(super) fn new(scene: &Scene, geometry: &Geometry, law: L) -> Self {
        let (gear, contact) = (&scene.gear, &scene.contact);
        let layout = Layout::of(gear);
        let hertz = HertzStiffness::new(
            contact.young_pa,
            contact.poisson,
            contact.stiffness_multiplier,
        );
        let q = gear.external_sleeve_radius_m;
        let holes = geometry.hole_centres.iter();
        Self {
            arch: pulp::Arch::new(),
            layout,
            law,
            friction: RegularisedCoulomb {
                coefficient: contact.friction_coefficient,
                ramp: contact.friction_ramp_m_s,
            },
            shapes: Shapes {
                curve: geometry.curve.clone(),
                zk: gear.external_sleeves as u32,
                external_radius: q,
                profile_stiffness: hertz.of_radius(q),
                hole_stiffness: hertz.of_hole(gear.internal_sleeve_radius_m, gear.hole_radius_m),
                hole_radius: gear.hole_radius_m,
                clearance: gear.hole_radius_m - gear.internal_sleeve_radius_m,
                directions: Column::padded(geometry.external_directions.iter().copied()),
                holes: holes.map(|w| Column::padded(w.iter().copied())).collect(),
            },
            external: Sleeves::new(layout.external_bodies()),
            internal: Sleeves::new(layout.internal_bodies()),
            scalar: Pairs::new(scene, geometry, law, Exact::new(scene, geometry)),
        }
    }

    #[inline(always)]
    fn kernel<S: Simd, const FRICTION: bool>(
        &mut self,
        simd: S,
        bodies: &[BodyState],
        loads: &mut [Wrench],
    ) {
        self.external.gather(bodies);
        self.internal.gather(bodies);
        for (i, body) in self.layout.wheel_bodies().enumerate() {
            let b = &bodies[body];
            let turn = Complex::unit(b.angle);
            let back = turn.conj();
            let splat = |z| ComplexLanes::splat(simd, z);
            let mut wheel = Wheel {
                centre: splat(Complex::new(b.x, b.y)),
                turn: splat(turn),
                back: splat(back),
                velocity: splat(Complex::new(b.vx, b.vy) * back),
                rate: Lanes::splat(simd, b.rate),
                force: splat(Complex::default()),
                moment: Lanes::splat(simd, 0.0),
            };
            // The ideal mesh has the foot of sleeve j at a0 = beta_j - theta, and zk beta_j is a whole turn.
            let multiple = splat(back.powu(self.shapes.zk));
            for (from, present) in self.external.groups(simd) {
                let p = (self.external.position.load(simd, from) - wheel.centre) * wheel.back;
                let unit = self.shapes.directions.load(simd, from) * wheel.back;
                let touching = self.shapes.profile(p, unit, multiple, present);
                if touching.mask.any() {
                    self.external.press::<S, L, FRICTION>(
                        simd,
                        from,
                        p,
                        &touching,
                        self.law,
                        self.friction,
                        &mut wheel,
                    );
                }
            }
            for (from, present) in self.internal.groups(simd) {
                let p = (self.internal.position.load(simd, from) - wheel.centre) * wheel.back;
                let centres = self.shapes.holes[i].load(simd, from);
                let touching = self.shapes.hole(p, centres, present);
                if touching.mask.any() {
                    self.internal.press::<S, L, FRICTION>(
                        simd,
                        from,
                        p,
                        &touching,
                        self.law,
                        self.friction,
                        &mut wheel,
                    );
                }
            }
            let ground = Complex::new(wheel.force.re.sum(), wheel.force.im.sum()) * turn;
            let load = &mut loads[body];
            load.fx += ground.re;
            load.fy += ground.im;
            load.moment += wheel.moment.sum();
        }
        self.external.scatter(loads);
        self.internal.scatter(loads);
    }
}

impl Shapes {
    /// External sleeves centred at `p` (wheel frame) against the profile.
    #[inline(always)]
    fn profile<S: Simd>(
        &self,
        p: ComplexLanes<S>,
        unit: ComplexLanes<S>,
        multiple: ComplexLanes<S>,
        present: Mask<S>,
    ) -> Touching<S> {
        let feet = self.curve.penetrating_feet(p, unit, multiple, present);
        let q = p.re.like(self.external_radius);
        let radicand = p.re.like(1.0) - q * feet.curvature;
        Touching {
            mask: feet.inside,
            point: feet.normal.scale_add(-q, feet.position),
            normal: feet.normal.scale(p.re.like(-1.0)),
            penetration: feet.depth,
            stiffness: p.re.like(self.profile_stiffness) * radicand.sqrt(),
        }
    }

    /// Internal sleeves centred at `p` (wheel frame) in their holes.
    #[inline(always)]
    fn hole<S: Simd>(
        &self,
        p: ComplexLanes<S>,
        centres: ComplexLanes<S>,
        present: Mask<S>,
    ) -> Touching<S> {
        let offset = p - centres;
        let distance = offset.dot(offset).sqrt();
        let penetration = distance - p.re.like(self.clearance);
        let normal = offset.scale(distance.recip());
        Touching {
            mask: p.re.like(0.0).less(penetration).and(present),
            point: normal.scale_add(p.re.like(self.hole_radius), centres),
            normal,
            penetration,
            stiffness: p.re.like(self.hole_stiffness),
        }
    }
}

impl Sleeves {
    /// Rates, forces (Eq. 20, 21) and their sums; see `Pairs::load`.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the operands of one formula; a struct would only rename them"
    )]
    fn press<S: Simd, L: LanesLaw, const FRICTION: bool>(
        &mut self,
        simd: S,
        from: usize,
        p: ComplexLanes<S>,
        touching: &Touching<S>,
        law: L,
        friction: RegularisedCoulomb,
        wheel: &mut Wheel<S>,
    ) {
        let (n, arm) = (touching.normal, touching.point - p);
        let mut relative = self.velocity.load(simd, from) * wheel.back
            - wheel.velocity
            - touching.point.turned().scale(wheel.rate);
        if FRICTION {
            let rate = Lanes::load(simd, &self.rate[from..]);
            relative = arm.turned().scale_add(rate, relative);
        }
        let pressure = law.force_lanes(touching.stiffness, touching.penetration, relative.dot(n));
        let mut on_sleeve = n.scale(-pressure);
        if FRICTION {
            let t = n.turned();
            let one = arm.re.like(1.0);
            let share = relative.dot(t) * arm.re.like(1.0 / friction.ramp);
            let drag = pressure * arm.re.like(-friction.coefficient) * share.max(-one).min(one);
            on_sleeve = t.scale_add(drag, on_sleeve);
        }
        // Masked lanes may hold anything, NaN included.
        let on_sleeve = on_sleeve.only(touching.mask);
        let point = touching.point.only(touching.mask);
        wheel.force = wheel.force - on_sleeve;
        wheel.moment = wheel.moment - point.cross(on_sleeve);
        self.force.add(simd, from, on_sleeve * wheel.turn);
        if FRICTION {
            let moment =
                Lanes::load(simd, &self.moment[from..]) + arm.only(touching.mask).cross(on_sleeve);
            moment.store(&mut self.moment[from..]);
        }
    }
}

/// One evaluation, as the dispatcher wants it: what is inlined here is compiled once per instruction set.
struct Evaluation<'a, L, const FRICTION: bool> {
    field: &'a mut LaneField<L>,
    bodies: &'a [BodyState],
    loads: &'a mut [Wrench],
}

impl<L: LanesLaw, const FRICTION: bool> pulp::WithSimd for Evaluation<'_, L, FRICTION> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.field
            .kernel::<S, FRICTION>(simd, self.bodies, self.loads);
    }
}

impl<L: LanesLaw> ContactField for LaneField<L> {
    fn add_loads(&mut self, bodies: &[BodyState], loads: &mut [Wrench]) {
        let (arch, field) = (self.arch, self);
        if field.friction.coefficient > 0.0 {
            arch.dispatch(Evaluation::<L, true> {
                field,
                bodies,
                loads,
            });
        } else {
            arch.dispatch(Evaluation::<L, false> {
                field,
                bodies,
                loads,
            });
        }
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        self.scalar.touching(bodies, visit);
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        self.scalar.nearest(bodies, wheel, sleeve)
    }

    fn energy(&mut self, bodies: &[BodyState]) -> ContactEnergy {
        self.scalar.energy(bodies)
    }

    fn normal_force(&self, pair: &PairContact, rate: f64) -> f64 {
        self.scalar.normal_force(pair, rate)
    }
}
