//! Statics: the angles at which a gearbox at rest carries its load, for a given input angle.
//!
//! Unknowns are the discs' angles and the output's; exact geometry and the scene's own law at rate 0, so
//! without damping and friction. Each disc must be free of moment about its eccentric, the output
//! free of moment together with the load:
//!
//! ```text
//! M_i(theta_i, psi) = 0 for every disc i,    sum over discs of M_out,i(theta_i, psi) + M_load = 0
//! ```
//! Newton's method finds them in some ten evaluations (`newton`). Where it does not, or the
//! contacts have no derivatives (discrete points), brackets do: contacts restore, so M_i falls with theta_i, and with the discs in
//! balance M_out falls with psi: two nested roots of falling functions, each bracketed. That needs no good start and copes with
//! backlash, where everything is 0 over the free play. Discs that float have unknown places too (`floating`).

mod floating;
mod newton;

use pinwheel_mbs::{BodyState, Coordinates, Evaluation, Jacobian, Structure, Wrench};

use crate::Layout;
use crate::contacts::{ContactField, EccentricBearings, PairContact};
use crate::{Gearbox, GearboxError};

/// Elastic twist allowed beyond the free play, in pitches (2 pi/zs): the guard of dynamic runs is 0.25.
const PITCHES: f64 = 0.2;
/// Tolerance of angles, rad: 1e-14 rad on a radius of 64 mm is 1e-11 of a penetration.
const ANGLE: f64 = 2e-15;
/// Steps at most; a gear takes 5 to 10.
const MOST_STEPS: usize = 40;
/// And from a balance near by, which takes 3 to 5; what takes longer is left to the safe beginning.
const NEAR_STEPS: usize = 10;
/// Unknowns of a disc, from its body.
const OF_A_WHEEL: usize = 3;

/// Angles in balance.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// The input angle, rad.
    pub input: f64,
    /// Disc angles, rad.
    pub wheels: Vec<f64>,
    /// Output angle, rad.
    pub output: f64,
    /// Poses of all bodies, at rest.
    pub bodies: Vec<BodyState>,
    /// Largest residual of the moments, N m, over those of each disc and of the output.
    pub residual: f64,
}

/// The quasi-static solver of a gearbox.
///
/// ```
/// use pinwheel_gearbox::Gearbox;
/// use pinwheel_gearbox::statics::Statics;
/// use pinwheel_scene::Scene;
///
/// let gearbox = Gearbox::new(&Scene::load("paper", &[])?)?;
/// let mut statics = Statics::new(&gearbox)?;
/// let (light, full) = (statics.solve(0.0, 11.0)?, statics.solve(0.0, 22.0)?);
/// assert!(full.output.abs() > light.output.abs(), "the load twists the gear: {} rad", full.output);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Statics<'a> {
    gearbox: &'a Gearbox,
    #[doc(hidden)]
    pub field: ContactField,
    bodies: Vec<BodyState>,
    loads: Vec<Wrench>,
    /// The motion about which moments are taken; see [`Statics::moving`].
    motion: Motion,
    #[doc(hidden)]
    pub derivatives: Jacobian,
    /// Derivatives of the moments with respect to angles and to the places of discs that float.
    floating_slopes: Jacobian,
    /// Numbers of the unknowns in these two.
    coordinates: [Coordinates; 2],
    /// Bearings on which discs float. They have no friction, because a balance at rest has none.
    bearings: Option<EccentricBearings>,
    /// Last balances of discs that float, and their loads.
    floated: Vec<(Equilibrium, f64)>,
    /// Room for moments that contacts tell without loads, by body.
    moments_by_body: Vec<f64>,
    /// Bearings do not give way.
    is_rigid: bool,
    /// Evaluations of all contacts so far.
    evaluations: u64,
}

/// Rates and angular accelerations of a slow motion along the equilibria.
#[derive(Debug, Clone)]
struct Motion {
    /// Speed of the input, rad/s.
    speed: f64,
    /// Rate and acceleration of each disc.
    wheels: Vec<[f64; 2]>,
    /// Speed and acceleration of the output.
    output: [f64; 2],
    /// Velocity (m/s) and acceleration (m/s^2) of each floating disc's centre.
    centres: Vec<[[f64; 2]; 2]>,
}

impl Motion {
    /// None, of so many discs.
    fn none(wheels: usize) -> Self {
        Self {
            speed: 0.0,
            wheels: vec![[0.0; 2]; wheels],
            output: [0.0; 2],
            centres: vec![[[0.0; 2]; 2]; wheels],
        }
    }
}

/// Jacobian of discs and output, as they are free without friction.
fn derivatives(free: usize) -> Jacobian {
    let is_leaf = vec![false; free];
    Jacobian::new(&Structure::SecondOrder { is_leaf }, 2 * free)
}

/// Numbers of the angles of output and discs, and with the discs' places beyond.
fn coordinates(layout: Layout) -> [Coordinates; 2] {
    let wheels: Vec<usize> = layout.wheel_bodies().collect();
    let turning = [&[Layout::OUTPUT], &wheels[..]].concat();
    [&[], &wheels[..]].map(|floating| Coordinates::new(layout.bodies(), &turning, floating))
}

/// The next estimate of the root of a falling function that is `here`, not 0, with that slope at `at`, whose bracket shrinks:
/// Newton's where it stays inside and moves by less than half of the `last` step, else the middle.
fn next_root(at: f64, here: f64, slope: f64, (low, high): (&mut f64, &mut f64), last: f64) -> f64 {
    *(if here > 0.0 { &mut *low } else { &mut *high }) = at;
    let newton = at - here / slope;
    let inside = newton > *low && newton < *high;
    if slope < 0.0 && inside && (newton - at).abs() < 0.5 * last {
        newton
    } else {
        0.5 * (*low + *high)
    }
}

impl<'a> Statics<'a> {
    /// A solver for `gearbox`.
    ///
    /// # Errors
    /// See [`Gearbox::contact_field`].
    pub fn new(gearbox: &'a Gearbox) -> Result<Self, GearboxError> {
        Ok(Self {
            field: gearbox.bare_field()?,
            bodies: gearbox.kinematic_states(),
            loads: vec![Wrench::default(); gearbox.layout.bodies()],
            gearbox,
            motion: Motion::none(gearbox.layout.wheels),
            derivatives: derivatives(1 + gearbox.layout.wheels),
            floating_slopes: derivatives(1 + OF_A_WHEEL * gearbox.layout.wheels),
            coordinates: coordinates(gearbox.layout),
            bearings: EccentricBearings::of(&gearbox.scene, &gearbox.geometry)
                .map(EccentricBearings::frictionless),
            floated: Vec::new(),
            moments_by_body: vec![0.0; gearbox.layout.bodies()],
            is_rigid: false,
            evaluations: 0,
        })
    }

    /// Solver that takes all bearings as rigid.
    #[must_use]
    pub fn on_rigid_bearings(self) -> Self {
        Self {
            is_rigid: true,
            ..self
        }
    }

    /// An evaluation of the bodies' loads begins.
    fn begin(&mut self) {
        self.evaluations += 1;
        self.loads.fill(Wrench::default());
    }

    /// Puts all bodies at the input angle `phi` and the given angles, for an evaluation of their loads.
    fn place(&mut self, phi: f64, wheels: &[f64], psi: f64) {
        self.begin();
        self.put(phi, wheels, psi);
    }

    /// Turns input, output and discs there.
    fn turn(&mut self, phi: f64, wheels: &[f64], psi: f64) {
        let motion = &self.motion;
        let mut turn = |body: usize, angle: f64, rate: f64| {
            (self.bodies[body].angle, self.bodies[body].rate) = (angle, rate);
        };
        turn(Layout::INPUT, phi, motion.speed);
        turn(Layout::OUTPUT, psi, motion.output[0]);
        let wheels = wheels.iter().zip(&motion.wheels);
        for (body, (&angle, &[rate, _])) in self.gearbox.layout.wheel_bodies().zip(wheels) {
            turn(body, angle, rate);
        }
    }

    /// Puts all bodies there.
    fn put(&mut self, phi: f64, wheels: &[f64], psi: f64) {
        self.turn(phi, wheels, psi);
        let (layout, geometry) = (self.gearbox.layout, &self.gearbox.geometry);
        let [input, output] = [Layout::INPUT, Layout::OUTPUT].map(|body| {
            let BodyState { angle, rate, .. } = self.bodies[body];
            [angle, rate]
        });
        let eccentric = [0, 1].map(|k| geometry.eccentric_angle(input[k], output[k]));
        for (i, body) in layout.wheel_bodies().enumerate() {
            let BodyState { angle, rate, .. } = self.bodies[body];
            self.bodies[body] = geometry.wheel_state(i, eccentric, [angle, rate]);
        }
        for (k, body) in layout.internal_bodies().enumerate() {
            self.bodies[body] = geometry.internal_state(k, output);
        }
    }

    /// Moments on the discs into `out`, and the moment of the contacts on the output.
    fn moments(&mut self, phi: f64, wheels: &[f64], psi: f64, out: &mut [f64]) -> f64 {
        if let Some(on_output) = self.frictionless_moments(phi, wheels, psi, out) {
            return on_output;
        }
        self.place(phi, wheels, psi);
        self.field.add_loads(&self.bodies, &mut self.loads);
        self.summed(out)
    }

    /// Moments on the discs into `out`, and that of the contacts on the output, by contacts that need neither loads
    /// nor places for them; else `None`.
    #[doc(hidden)]
    pub fn frictionless_moments(
        &mut self,
        phi: f64,
        wheels: &[f64],
        psi: f64,
        out: &mut [f64],
    ) -> Option<f64> {
        self.turn(phi, wheels, psi);
        // Forces move discs that float.
        if self.gearbox.floats() || !self.field.work_from_angles() {
            return None;
        }
        self.moments_by_body.fill(0.0);
        let mut request = Evaluation::of_moments(&mut self.moments_by_body);
        self.field.evaluate(&self.bodies, &mut request);
        self.evaluations += 1;
        out.copy_from_slice(&self.moments_by_body[self.gearbox.layout.wheel_bodies()]);
        Some(self.less_inertia(out, self.moments_by_body[Layout::OUTPUT]))
    }

    /// Moments on the discs into `out`, and that of the contacts on the output, with their derivatives in `derivatives`.
    /// `None` if the contacts have none.
    #[doc(hidden)]
    pub fn moments_with_slopes(
        &mut self,
        phi: f64,
        wheels: &[f64],
        psi: f64,
        out: &mut [f64],
    ) -> Option<f64> {
        self.place(phi, wheels, psi);
        self.derivatives.clear();
        if !self.field.have_derivatives() {
            return None;
        }
        let mut request = Evaluation {
            loads: Some(&mut self.loads),
            ..Evaluation::of_derivatives(&mut self.derivatives, &self.coordinates[0])
        };
        self.field.evaluate(&self.bodies, &mut request);
        Some(self.summed(out))
    }

    /// Sums the loads: moments on the discs into `out`, and the moment on the output.
    fn summed(&self, out: &mut [f64]) -> f64 {
        let layout = self.gearbox.layout;
        for (out, body) in out.iter_mut().zip(layout.wheel_bodies()) {
            *out = self.loads[body].moment;
        }
        let sleeves = layout.internal_bodies().map(|body| {
            let (b, l) = (&self.bodies[body], &self.loads[body]);
            b.x * l.fy - b.y * l.fx
        });
        self.less_inertia(out, sleeves.sum())
    }

    /// Takes what discs and output need for the motion off the moments on them; returns the output's.
    fn less_inertia(&self, out: &mut [f64], on_output: f64) -> f64 {
        let scene = &self.gearbox.scene;
        for (out, [_, bend]) in out.iter_mut().zip(&self.motion.wheels) {
            *out -= scene.mass.wheel.moment_kg_m2 * bend;
        }
        on_output - scene.output_inertia_kg_m2() * self.motion.output[1]
    }

    /// Half widths of the brackets: of a disc about its ideal mesh, of the output about its own.
    fn brackets(&self) -> (f64, f64) {
        let geometry = &self.gearbox.geometry;
        let twist = PITCHES * std::f64::consts::TAU / geometry.lobes();
        let wheel = geometry.wheel_play_rad + twist;
        (wheel, wheel + twist + geometry.hole_play_rad)
    }

    /// Balances the discs for the output at `psi`; returns the moment of the contacts on the output.
    fn balance_wheels(&mut self, phi: f64, psi: f64, wheels: &mut [f64]) -> f64 {
        let n = wheels.len();
        let half = self.brackets().0;
        let (mut low, mut high) = (vec![0.0; n], vec![0.0; n]);
        for i in 0..n {
            let ideal = self.gearbox.geometry.ideal_wheel_angle(i, phi);
            (low[i], high[i]) = (ideal - half, ideal + half);
            wheels[i] = wheels[i].clamp(low[i], high[i]);
        }
        let (mut here, mut beside) = (vec![0.0; n], vec![0.0; n]);
        let mut shifted = wheels.to_vec();
        let h = 1e-9;
        let mut last = vec![f64::INFINITY; n];
        for _ in 0..200 {
            self.moments(phi, wheels, psi, &mut here);
            for (s, w) in shifted.iter_mut().zip(wheels.iter()) {
                *s = w + h;
            }
            self.moments(phi, &shifted, psi, &mut beside);
            let mut moved: f64 = 0.0;
            for i in 0..n {
                if here[i] == 0.0 {
                    continue;
                }
                let slope = (beside[i] - here[i]) / h;
                let bracket = (&mut low[i], &mut high[i]);
                let next = next_root(wheels[i], here[i], slope, bracket, last[i]);
                last[i] = (next - wheels[i]).abs();
                moved = moved.max(last[i]);
                wheels[i] = next;
            }
            if moved < ANGLE {
                break;
            }
        }
        self.moments(phi, wheels, psi, &mut here)
    }

    /// True if the ideal mesh is in balance without a load, but for rounding. Nothing decides at which other place in
    /// its play the gear would come to rest: forces of next to no depth have no derivative to follow.
    fn rests(&mut self, phi: f64, wheels: &[f64]) -> bool {
        let psi = self.gearbox.geometry.ideal_output_angle(phi);
        let mut moments = vec![0.0; wheels.len()];
        let mut largest = |turn: f64| {
            let turned: Vec<f64> = wheels.iter().map(|angle| angle + turn).collect();
            let output = self.moments(phi, &turned, psi + turn, &mut moments);
            let all = moments.iter().map(|moment| moment.abs());
            all.fold(output.abs(), f64::max)
        };
        largest(0.0) <= 1e-3 * largest(1e-9)
    }

    /// The equilibrium at the input angle `phi` (rad) under the load torque `load` (N m on the output).
    ///
    /// # Errors
    /// [`GearboxError::NoEquilibrium`]: the load is more than the teeth carry before they jump.
    pub fn solve(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        if self.gearbox.floats() && !self.is_rigid {
            return self.solve_floating(phi, load);
        }
        self.solve_rigid(phi, load)
    }

    /// The equilibrium with rigid eccentrics at the input angle `phi` (rad) under the load torque `load` (N m on the
    /// output).
    fn solve_rigid(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        if self.gearbox.scene.cranks.is_some() {
            return self.solve_on_cranks(phi, load);
        }
        let ideal = self.gearbox.geometry.ideal_output_angle(phi);
        let mut wheels = self.ideal_wheels(phi);
        if load == 0.0 && self.rests(phi, &wheels) {
            return Ok(self.equilibrium(phi, wheels, ideal, load));
        }
        if let Some(psi) = self.newton(phi, load, &mut wheels) {
            return Ok(self.equilibrium(phi, wheels, psi, load));
        }
        self.solve_by_brackets(phi, load)
    }

    /// The equilibrium from that `near` by, under the same load at an input angle not far off. It takes fewer steps
    /// than [`Statics::solve`] and gives the same to rounding; where Newton's method fails from there, it begins
    /// afresh.
    ///
    /// # Errors
    /// As [`Statics::solve`].
    pub fn solve_near(
        &mut self,
        near: &Equilibrium,
        phi: f64,
        load: f64,
    ) -> Result<Equilibrium, GearboxError> {
        let floats = self.gearbox.floats() && !self.is_rigid;
        // Where it may rest there is no slope to follow; on rigid cranks discs have no angles of their own.
        if load == 0.0 || (!floats && self.gearbox.scene.cranks.is_some()) {
            return self.solve(phi, load);
        }
        if floats {
            return match self.continue_from(near, phi, load) {
                Some(found) => Ok(found),
                None => self.solve(phi, load),
            };
        }
        let geometry = &self.gearbox.geometry;
        let turned = geometry.ideal_output_angle(phi) - geometry.ideal_output_angle(near.input);
        let mut wheels: Vec<f64> = (near.wheels.iter().enumerate())
            .map(|(i, angle)| {
                let ideal = |phi: f64| geometry.ideal_wheel_angle(i, phi);
                angle + (ideal(phi) - ideal(near.input))
            })
            .collect();
        match self.newton_from(phi, load, &mut wheels, near.output + turned, NEAR_STEPS) {
            Some(psi) => Ok(self.equilibrium(phi, wheels, psi, load)),
            None => self.solve(phi, load),
        }
    }

    /// The balance at the next of some input angles under one load: from the one before, `last`, if there is one; this one
    /// afterwards.
    ///
    /// # Errors
    /// As [`Statics::solve`].
    pub fn track<'e>(
        &mut self,
        last: &'e mut Option<Equilibrium>,
        phi: f64,
        load: f64,
    ) -> Result<&'e Equilibrium, GearboxError> {
        let found = match last.as_ref() {
            Some(near) => self.solve_near(near, phi, load)?,
            None => self.solve(phi, load)?,
        };
        Ok(last.insert(found))
    }

    fn ideal_wheels(&self, phi: f64) -> Vec<f64> {
        (0..self.gearbox.layout.wheels)
            .map(|i| self.gearbox.geometry.ideal_wheel_angle(i, phi))
            .collect()
    }

    /// The equilibrium by brackets alone, with hundreds of times the evaluations. It is the reference for Newton's
    /// method.
    ///
    /// # Errors
    /// As [`Statics::solve`].
    pub fn solve_by_brackets(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        let ideal = self.gearbox.geometry.ideal_output_angle(phi);
        let half = self.brackets().1;
        let (mut low, mut high) = (ideal - half, ideal + half);
        let mut wheels = self.ideal_wheels(phi);
        for (end, sign) in [(low, 1.0), (high, -1.0)] {
            let mut at = wheels.clone();
            if (self.balance_wheels(phi, end, &mut at) + load) * sign < 0.0 {
                return Err(GearboxError::NoEquilibrium { load_n_m: load });
            }
        }
        let mut psi = ideal;
        let mut last = f64::INFINITY;
        let h = 1e-8;
        for _ in 0..200 {
            let here = self.balance_wheels(phi, psi, &mut wheels) + load;
            if here == 0.0 {
                break;
            }
            let mut beside = wheels.clone();
            let slope = (self.balance_wheels(phi, psi + h, &mut beside) + load - here) / h;
            let next = next_root(psi, here, slope, (&mut low, &mut high), last);
            last = (next - psi).abs();
            psi = next;
            if last < ANGLE {
                break;
            }
        }
        self.balance_wheels(phi, psi, &mut wheels);
        Ok(self.equilibrium(phi, wheels, psi, load))
    }

    fn equilibrium(&mut self, input: f64, wheels: Vec<f64>, output: f64, load: f64) -> Equilibrium {
        let mut left = vec![0.0; wheels.len()];
        let moment = self.moments(input, &wheels, output, &mut left) + load;
        let residual = left.iter().map(|m| m.abs()).fold(moment.abs(), f64::max);
        self.put(input, &wheels, output);
        Equilibrium {
            input,
            wheels,
            output,
            bodies: self.bodies.clone(),
            residual,
        }
    }

    /// The gearbox that is balanced.
    #[must_use]
    pub fn gearbox(&self) -> &'a Gearbox {
        self.gearbox
    }

    /// Evaluations of all contacts so far: what poses cost.
    #[must_use]
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Touching pairs of an equilibrium.
    pub fn touching(&mut self, equilibrium: &Equilibrium) -> Vec<PairContact> {
        let mut pairs = Vec::new();
        self.field
            .touching(&equilibrium.bodies, &mut |pair| pairs.push(*pair));
        pairs
    }

    /// The bearings that cranks of an RV gear carry discs by, as pairs; of other gears none.
    #[must_use]
    pub fn on_cranks(&self, equilibrium: &Equilibrium) -> Vec<PairContact> {
        let bearings = self.bearings.as_ref();
        let found = bearings.map(|bearings| bearings.crank_pairs(&equilibrium.bodies));
        found.unwrap_or_default()
    }

    /// States at t = 0 of a run that starts loaded and already in its slow motion.
    ///
    /// Along the equilibria the angles are functions of the input angle, so rates are `omega d/dphi` and
    /// accelerations `omega^2 d^2/dphi^2`, by central differences. A second solution takes the damping at
    /// these rates and the moments these accelerations need into account; its own derivative gives the rates.
    /// Pins spin as at the kinematic start.
    ///
    /// # Errors
    /// See [`Statics::solve`].
    pub fn moving(&mut self) -> Result<Vec<BodyState>, GearboxError> {
        let (speed, load) = (
            self.gearbox.scene.drive.input_speed_rad_s,
            self.gearbox.load_torque(0.0),
        );
        // A hundredth of a mesh period: contacts pass through their ramps within a few of these.
        let mesh = std::f64::consts::TAU / (self.gearbox.geometry.lobes() + 1.0);
        let h = 0.01 * mesh / self.gearbox.scene.eccentric_per_input().abs();
        self.motion = Motion::none(self.gearbox.layout.wheels);
        let mut here = self.solve(0.0, load)?;
        for _ in 0..2 {
            let [before, after] = [
                self.solve_near(&here, -h, load)?,
                self.solve_near(&here, h, load)?,
            ];
            let derivatives = |a: f64, m: f64, b: f64| {
                let bend = speed * speed * (a - 2.0 * m + b) / (h * h);
                [speed * (b - a) / (2.0 * h), bend]
            };
            let wheels = before.wheels.iter().zip(&here.wheels).zip(&after.wheels);
            let centre = |body: usize| {
                let [b, m, a] = [&before, &here, &after].map(|at| at.bodies[body]);
                let ([vx, ax], [vy, ay]) = (derivatives(b.x, m.x, a.x), derivatives(b.y, m.y, a.y));
                [[vx, vy], [ax, ay]]
            };
            self.motion = Motion {
                centres: self.gearbox.layout.wheel_bodies().map(centre).collect(),
                speed,
                wheels: wheels.map(|((a, m), b)| derivatives(*a, *m, *b)).collect(),
                output: derivatives(before.output, here.output, after.output),
            };
            here = self.solve_near(&here, 0.0, load)?;
        }
        let mut states = here.bodies;
        let kinematic = self.gearbox.kinematic_states();
        for body in self.gearbox.layout.internal_bodies() {
            states[body].angle = kinematic[body].angle;
            states[body].rate = kinematic[body].rate;
        }
        self.motion = Motion::none(self.gearbox.layout.wheels);
        Ok(states)
    }
}
