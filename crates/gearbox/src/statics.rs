//! Statics: the angles at which a gearbox at rest carries its load, for a given input angle.
//!
//! Exact geometry and the scene's own law at rate 0, so without damping and friction. Unknowns are the output's angle and what the
//! carrier leaves free of the discs: their angles on eccentrics that hold them, their places too on elastic bearings, nothing on
//! rigid cranks. Each disc must be free of force and moment as far as it is free, the output
//! free of moment together with the load:
//!
//! ```text
//! F_i = 0, M_i = 0 for every disc i,    sum over discs of M_out,i + M_load = 0
//! ```
//! One quasi-Newton method finds them (`newton`), in some ten evaluations without a known balance and half of that with one at the
//! pose before. Discs that float begin at the balance on rigid bearings and continue from there (`continuation`). Where Newton's
//! method finds none on rigid bearings, or the
//! contacts have no derivatives (discrete points), brackets do (`brackets`).

mod brackets;
mod continuation;
mod newton;
mod problem;

use std::collections::HashMap;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use pinwheel_mbs::{BodyState, Coordinates, ErrorScales, Evaluation, Jacobian, Structure, Wrench};

use crate::Layout;
use crate::carrier::Carrier;
use crate::contacts::{ContactField, PairContact};
use crate::{Gearbox, GearboxError, load_profile};
use problem::{Balanced, Free, LEFT, OF_A_DISC, Problem, Size};

/// Elastic twist allowed beyond the free play, in pitches (2 pi/zs): the guard of dynamic runs is 0.25.
const PITCHES: f64 = 0.2;
/// Difference steps, in the depths and twists of contacts under the load.
const DIFFERENCE: f64 = 2e-5;
/// Twist to begin with beyond the free play, in those of the load by the estimate for adaptive steps: pressed in deeper than the
/// load will press. Forces that stiffen with the depth then lead back without passing the balance, and all that will carry touches
/// from the start.
const TWIST: f64 = 2.0;
/// Least share of the largest load that sizes follow, of discs that float and of others.
const LEAST_SIZES: [f64; 2] = [1e-2, 1e-3];
/// How much more of bearings' offsets a balance turns the output by at most than they would if all were across the eccentric.
const GIVEN_WAY: f64 = 4.0;
/// Roundings of a disc's place that may be left as a force of its bearing.
const ROUNDINGS: f64 = 4.0;

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
    /// Inverse of the Jacobian, by which the next balance begins.
    inverse: Option<DMatrix<f64>>,
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
    /// Derivatives of the moments with respect to angles, and of the forces on discs to their places.
    derivatives: Jacobian,
    /// Numbers of the unknowns in these.
    coordinates: Coordinates,
    /// What carries the discs, without friction, because a balance at rest has none; and rigid bearings.
    carrier: Arc<Carrier>,
    rigid: Arc<Carrier>,
    /// Last balances of discs that float, and their loads.
    floated: Vec<(Equilibrium, f64)>,
    /// Room for moments that contacts tell without loads, by body.
    moments_by_body: Vec<f64>,
    /// The last contacts asked for moments alone had them.
    tells_moments: bool,
    scales: ErrorScales,
    largest_n_m: f64,
    least_force_n: f64,
    /// Evaluations of all contacts so far.
    evaluations: u64,
    /// Balances so far.
    balances: u64,
    /// Balances that were known when they were asked for again.
    repeats: u64,
    /// Unknowns of the balances so far and what is left there, by input angle and load.
    known: HashMap<[u64; 2], (Vec<f64>, DVector<f64>)>,
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

impl<'a> Statics<'a> {
    /// A solver for `gearbox`.
    ///
    /// # Errors
    /// See [`Gearbox::contact_field`].
    pub fn new(gearbox: &'a Gearbox) -> Result<Self, GearboxError> {
        let free = 1 + OF_A_DISC * gearbox.layout.wheels;
        let is_leaf = vec![false; free];
        let wheels: Vec<usize> = gearbox.layout.wheel_bodies().collect();
        let turning = [&[Layout::OUTPUT], &wheels[..]].concat();
        Ok(Self {
            field: gearbox.bare_field()?,
            bodies: gearbox.kinematic_states(),
            loads: vec![Wrench::default(); gearbox.layout.bodies()],
            motion: Motion::none(gearbox.layout.wheels),
            derivatives: Jacobian::new(&Structure::SecondOrder { is_leaf }, 2 * free),
            coordinates: Coordinates::new(gearbox.layout.bodies(), &turning, &wheels),
            carrier: Arc::new(gearbox.carrier.clone().frictionless()),
            rigid: Arc::new(Carrier::Rigid),
            floated: Vec::new(),
            moments_by_body: vec![0.0; gearbox.layout.bodies()],
            tells_moments: false,
            scales: gearbox.error_scales(),
            largest_n_m: load_profile::largest(&gearbox.scene.drive),
            least_force_n: gearbox.least_force_n(),
            evaluations: 0,
            balances: 0,
            repeats: 0,
            known: HashMap::new(),
            gearbox,
        })
    }

    /// Solver that takes all bearings as rigid.
    #[must_use]
    pub fn on_rigid_bearings(mut self) -> Self {
        self.carrier = self.rigid.clone();
        self
    }

    /// The balance that is looked for at the input angle `phi` under a load on this carrier.
    fn problem(&self, phi: f64, load: f64, carrier: &Arc<Carrier>) -> Problem {
        let (scales, gear) = (&self.scales, &self.gearbox.scene.gear);
        let moment = load.abs().max(self.least_force_n * gear.lever_m());
        let largest = self.largest_n_m.max(moment);
        // Places are known to their rounding, and so are forces, however light the load.
        let least = LEAST_SIZES[usize::from(!carrier.floats())];
        let share = (moment / largest).max(least);
        let moment = share * largest;
        let force = moment / gear.lever_m();
        // Where bearings sit: of cranks on their circle, about which forces have moments as well.
        let circle = carrier.cranks().map(|cranks| cranks.circle_radius_m);
        let place = circle.unwrap_or(gear.eccentricity_m);
        let rounding = ROUNDINGS * f64::EPSILON * place * carrier.slope_under(force);
        let own = load.abs() / (gear.lever_m() * gear.wheels as f64);
        let given_way = carrier.offset_under(own) / gear.lever_m();
        Problem {
            phi,
            load,
            free: match (carrier.floats(), self.gearbox.carrier.cranks()) {
                (true, _) => Free::Places,
                (false, Some(_)) => Free::Output,
                (false, None) => Free::Angles,
            },
            carrier: carrier.clone(),
            size: Size {
                length: share * scales.length,
                angle: share * scales.angle,
                force: force.max(rounding / LEFT),
                moment: moment.max(circle.unwrap_or_default() * rounding / LEFT),
            },
            ideal: self.gearbox.geometry.ideal_output_angle(phi),
            reach: self.brackets().1 + GIVEN_WAY * given_way,
        }
    }

    /// Half widths of the brackets: of a disc about its ideal mesh, of the output about its own.
    fn brackets(&self) -> (f64, f64) {
        let geometry = &self.gearbox.geometry;
        let twist = PITCHES * std::f64::consts::TAU / geometry.lobes();
        let wheel = geometry.wheel_play_rad + twist;
        (wheel, wheel + twist + geometry.hole_play_rad)
    }

    /// Turns input, output and discs to their angles.
    fn turn(&mut self, problem: &Problem, u: &[f64]) {
        let motion = &self.motion;
        let mut turn = |body: usize, angle: f64, rate: f64| {
            (self.bodies[body].angle, self.bodies[body].rate) = (angle, rate);
        };
        turn(Layout::INPUT, problem.phi, motion.speed);
        turn(Layout::OUTPUT, u[0], motion.output[0]);
        for (i, body) in self.gearbox.layout.wheel_bodies().enumerate() {
            let angle = match problem.free {
                Free::Output => self.gearbox.geometry.ideal_wheel_angle(i, 0.0) + u[0],
                Free::Angles => u[1 + i],
                Free::Places => u[OF_A_DISC * (i + 1)],
            };
            turn(body, angle, motion.wheels[i][0]);
        }
    }

    /// Puts all bodies in place, with the velocities of the motion about which forces are taken.
    fn place(&mut self, problem: &Problem, u: &[f64]) {
        self.turn(problem, u);
        let (layout, geometry) = (self.gearbox.layout, &self.gearbox.geometry);
        let [input, output] = [Layout::INPUT, Layout::OUTPUT].map(|body| {
            let BodyState { angle, rate, .. } = self.bodies[body];
            [angle, rate]
        });
        let eccentric = [0, 1].map(|k| geometry.eccentric_angle(input[k], output[k]));
        for (i, body) in layout.wheel_bodies().enumerate() {
            let body = &mut self.bodies[body];
            let own = [body.angle, body.rate];
            *body = match problem.free {
                Free::Places => {
                    let at = &u[1 + OF_A_DISC * i..];
                    let [vx, vy] = self.motion.centres[i][0];
                    BodyState::new([at[0], at[1], own[0]], [vx, vy, own[1]])
                }
                _ => geometry.wheel_state(i, eccentric, own),
            };
        }
        for (k, body) in layout.internal_bodies().enumerate() {
            self.bodies[body] = geometry.internal_state(k, output);
        }
    }

    /// Forces and moments that are not in balance at `u`, in the order of the unknowns.
    fn residual(&mut self, problem: &Problem, u: &[f64]) -> DVector<f64> {
        if problem.free == Free::Angles {
            self.turn(problem, u);
            let moments = self.moments(problem.load);
            self.tells_moments = moments.is_some();
            if let Some(moments) = moments {
                return moments;
            }
        }
        self.place(problem, u);
        let all = self.forces(problem);
        let discs = 0..self.gearbox.layout.wheels;
        match problem.free {
            Free::Places => all,
            Free::Angles => {
                let moments = discs.map(|i| all[OF_A_DISC * (i + 1)]);
                DVector::from_iterator(u.len(), std::iter::once(all[0]).chain(moments))
            }
            // By virtual work: the output takes discs along, and their eccentrics turn with the cranks.
            Free::Output => {
                let cranks = 1.0 + self.gearbox.geometry.teeth_ratio;
                let bodies = &self.bodies[self.gearbox.layout.wheel_bodies()];
                let of = |(disc, load): (&BodyState, &[f64])| {
                    load[2] + cranks * (disc.x * load[1] - disc.y * load[0])
                };
                let loads = all.as_slice()[1..].chunks(OF_A_DISC);
                DVector::from_element(1, all[0] + bodies.iter().zip(loads).map(of).sum::<f64>())
            }
        }
    }

    /// Moments that are not in balance on output and discs at their angles, by contacts that need neither loads nor places for them;
    /// else `None`.
    fn moments(&mut self, load: f64) -> Option<DVector<f64>> {
        // Forces move discs that float.
        if self.gearbox.carrier.floats() || !self.field.work_from_angles() {
            return None;
        }
        self.moments_by_body.fill(0.0);
        let mut request = Evaluation::of_moments(&mut self.moments_by_body);
        self.field.evaluate(&self.bodies, &mut request);
        self.evaluations += 1;
        let (scene, motion) = (&self.gearbox.scene, &self.motion);
        let discs = self.gearbox.layout.wheel_bodies().zip(&motion.wheels);
        let moment = scene.mass.wheel.moment_kg_m2;
        let discs = discs.map(|(body, [_, bend])| self.moments_by_body[body] - moment * bend);
        let output = self.moments_by_body[Layout::OUTPUT] + load
            - scene.output_inertia_kg_m2() * motion.output[1];
        let count = 1 + motion.wheels.len();
        Some(DVector::from_iterator(
            count,
            std::iter::once(output).chain(discs),
        ))
    }

    /// Moment on the output, and forces and moment on every disc, that are not in balance where the bodies are.
    fn forces(&mut self, problem: &Problem) -> DVector<f64> {
        self.evaluations += 1;
        self.loads.fill(Wrench::default());
        let mut output = problem.load + self.add_contacts();
        problem
            .carrier
            .add_loads(&self.bodies, &mut self.loads, None);
        let (layout, scene) = (self.gearbox.layout, &self.gearbox.scene);
        for body in layout.internal_bodies() {
            let (b, l) = (&self.bodies[body], &self.loads[body]);
            output += b.x * l.fy - b.y * l.fx;
        }
        let mut all = DVector::zeros(1 + OF_A_DISC * layout.wheels);
        all[0] = output - scene.output_inertia_kg_m2() * self.motion.output[1];
        let disc = scene.mass.wheel;
        for (i, body) in layout.wheel_bodies().enumerate() {
            let (at, Wrench { fx, fy, moment }) = (1 + OF_A_DISC * i, self.loads[body]);
            let ([ax, ay], bend) = (self.motion.centres[i][1], self.motion.wheels[i][1]);
            all[at] = fx - disc.mass_kg * ax;
            all[at + 1] = fy - disc.mass_kg * ay;
            all[at + 2] = moment - disc.moment_kg_m2 * bend;
        }
        all
    }

    /// Adds the contacts' loads on the discs; those on the output's pins too, unless their moment is known, which is returned.
    fn add_contacts(&mut self) -> f64 {
        if !self.field.work_from_angles() {
            self.field.add_loads(&self.bodies, &mut self.loads);
            return 0.0;
        }
        self.moments_by_body.fill(0.0);
        let mut request = Evaluation {
            floating_alone: true,
            loads: Some(&mut self.loads),
            ..Evaluation::of_moments(&mut self.moments_by_body)
        };
        self.field.evaluate(&self.bodies, &mut request);
        self.moments_by_body[Layout::OUTPUT]
    }

    /// Jacobian of the residual, which is `here` at `u`: by differences where they are cheaper, or the only way. `None`: discs on
    /// eccentrics whose contacts have no derivatives.
    fn jacobian(
        &mut self,
        problem: &Problem,
        u: &[f64],
        here: &DVector<f64>,
    ) -> Option<DMatrix<f64>> {
        let by_differences = match problem.free {
            Free::Output => true,
            Free::Angles => self.tells_moments,
            Free::Places => false,
        };
        if !by_differences {
            let found = self.derivatives(problem, u);
            if found.is_some() || problem.free == Free::Angles {
                return found.map(|[position, _]| position);
            }
        }
        Some(self.differences(problem, u, here))
    }

    /// Derivatives of the residual with respect to the unknowns and to their rates, as the contacts have them.
    fn derivatives(&mut self, problem: &Problem, u: &[f64]) -> Option<[DMatrix<f64>; 2]> {
        self.evaluations += 1;
        self.place(problem, u);
        self.derivatives.clear();
        if !self.field.have_derivatives() {
            return None;
        }
        let mut request = Evaluation::of_derivatives(&mut self.derivatives, &self.coordinates);
        self.field.evaluate(&self.bodies, &mut request);
        if let Some(derivatives) = &mut request.derivatives {
            problem.carrier.add_jacobian(&self.bodies, derivatives);
        }
        let discs = self.gearbox.layout.wheels;
        // Angles first, then places.
        let free = |unknown: usize| {
            let (disc, part) = (unknown.wrapping_sub(1) / OF_A_DISC, unknown % OF_A_DISC);
            match problem.free {
                Free::Places if unknown > 0 && part == 0 => 1 + disc,
                Free::Places if unknown > 0 => 1 + discs + 2 * disc + part - 1,
                _ => unknown,
            }
        };
        let position = self.derivatives.position.as_ref()?;
        Some([position, &self.derivatives.rate].map(|matrix| {
            DMatrix::from_fn(u.len(), u.len(), |i, j| matrix.entry(free(i), free(j)))
        }))
    }

    /// Derivatives of the residual, which is `here` at `u`, by differences.
    fn differences(&mut self, problem: &Problem, u: &[f64], here: &DVector<f64>) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(u.len(), u.len());
        let mut moved = u.to_vec();
        for k in 0..u.len() {
            moved[k] = u[k] + DIFFERENCE * problem.of_place(k);
            let over = (moved[k] - u[k]).recip();
            let there = self.residual(problem, &moved);
            matrix.set_column(k, &((there - here) * over));
            moved[k] = u[k];
        }
        matrix
    }

    /// Jacobian at a balance by differences, and by the contacts' own derivatives, with that to rates.
    #[doc(hidden)]
    pub fn jacobians(
        &mut self,
        at: &Equilibrium,
        load: f64,
    ) -> (DMatrix<f64>, Option<[DMatrix<f64>; 2]>) {
        let problem = self.problem(at.input, load, &self.carrier);
        let u = problem.unknowns(&at.bodies, self.gearbox.layout);
        let here = self.residual(&problem, &u);
        (
            self.differences(&problem, &u, &here),
            self.derivatives(&problem, &u),
        )
    }

    /// Stiffness, N m/rad, and damping, N m s/rad, of the output about a balance, the input locked and the discs following.
    /// `None`: the contacts have no derivatives.
    ///
    /// With s the rate of change all derivatives are K + s D. Discs that follow are eliminated: the output is left with
    /// 1/e.(K + s D)^-1 e, taken to first order in s.
    pub fn compliance(&mut self, at: &Equilibrium) -> Option<[f64; 2]> {
        let problem = self.problem(at.input, 0.0, &self.carrier);
        let u = problem.unknowns(&at.bodies, self.gearbox.layout);
        let [stiffness, damping] = self.derivatives(&problem, &u)?;
        let mut unit = DVector::zeros(u.len());
        unit[0] = 1.0;
        let solve = |matrix: &DMatrix<f64>| {
            let free = || problem.held(matrix.clone(), LEFT).lu().solve(&unit);
            matrix.clone().lu().solve(&unit).or_else(free)
        };
        let (shape, left) = (solve(&stiffness)?, solve(&stiffness.transpose())?);
        let stiffness = -1.0 / shape[0];
        Some([
            stiffness,
            -stiffness * stiffness * left.dot(&(damping * shape)),
        ])
    }

    /// True if the ideal mesh is in balance without a load, but for rounding. Nothing decides at which other place in
    /// its play the gear would come to rest: forces of next to no depth have no derivative to follow.
    fn rests(&mut self, problem: &Problem, ideal: &[f64]) -> bool {
        let mut largest = |turn: f64| {
            let turned: Vec<f64> = ideal.iter().map(|angle| angle + turn).collect();
            self.residual(problem, &turned).amax()
        };
        largest(0.0) <= 1e-3 * largest(1e-9)
    }

    /// The equilibrium at the input angle `phi` (rad) under the load torque `load` (N m on the output).
    ///
    /// # Errors
    /// [`GearboxError::NoEquilibrium`]: the load is more than the teeth carry before they jump.
    pub fn solve(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        match self.carrier.floats() {
            true => self.solve_floating(phi, load),
            false => self.solve_rigid(phi, load),
        }
    }

    /// The equilibrium on rigid bearings.
    fn solve_rigid(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        let problem = self.problem(phi, load, &self.rigid);
        let ideal = self.ideal(&problem);
        if load == 0.0 && self.rests(&problem, &ideal) {
            let residual = self.residual(&problem, &ideal);
            return Ok(self.equilibrium(&problem, &ideal, (residual, None)));
        }
        let geometry = &self.gearbox.geometry;
        let twist = TWIST * self.scales.angle;
        let disc = load.signum() * (geometry.wheel_play_rad + twist);
        let mut u: Vec<f64> = ideal.iter().map(|angle| angle + disc).collect();
        u[0] += load.signum() * (twist + geometry.hole_play_rad);
        match self.newton(&problem, &mut u, None) {
            Some(balanced) => Ok(self.equilibrium(&problem, &u, balanced)),
            None => self.solve_by_brackets(phi, load),
        }
    }

    /// Unknowns of rigid bearings at the ideal mesh.
    fn ideal(&self, problem: &Problem) -> Vec<f64> {
        let discs = match problem.free {
            Free::Angles => self.gearbox.layout.wheels,
            _ => 0,
        };
        let discs = (0..discs).map(|i| self.gearbox.geometry.ideal_wheel_angle(i, problem.phi));
        std::iter::once(problem.ideal).chain(discs).collect()
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
        // Where it may rest there is no slope to follow.
        let found = (load != 0.0).then(|| self.continue_from(near, phi, load));
        match found.flatten() {
            Some(found) => Ok(found),
            None => self.solve(phi, load),
        }
    }

    /// The balance near another one; `None`: it leads nowhere.
    fn continue_from(&mut self, near: &Equilibrium, phi: f64, load: f64) -> Option<Equilibrium> {
        let problem = self.problem(phi, load, &self.carrier);
        let mut u = problem.unknowns(&near.bodies, self.gearbox.layout);
        let geometry = &self.gearbox.geometry;
        u[0] += problem.ideal - geometry.ideal_output_angle(near.input);
        let turned = |i: usize| {
            geometry.ideal_wheel_angle(i, phi) - geometry.ideal_wheel_angle(i, near.input)
        };
        let (s, c) = geometry.ideal_eccentric_angle(phi - near.input).sin_cos();
        match problem.free {
            Free::Output => {}
            Free::Angles => (u[1..].iter_mut().enumerate()).for_each(|(i, u)| *u += turned(i)),
            Free::Places => {
                for (i, disc) in u[1..].chunks_mut(OF_A_DISC).enumerate() {
                    let [x, y] = [disc[0], disc[1]];
                    (disc[0], disc[1]) = (c * x - s * y, s * x + c * y);
                    disc[2] += turned(i);
                }
            }
        }
        let balanced = self.newton(&problem, &mut u, near.inverse.clone())?;
        Some(self.equilibrium(&problem, &u, balanced))
    }

    /// The balance at the next of some input angles under one load: from the one before, `last`, if there is one; this one
    /// afterwards. One that is known is not solved again.
    ///
    /// # Errors
    /// As [`Statics::solve`].
    pub fn track<'e>(
        &mut self,
        last: &'e mut Option<Equilibrium>,
        phi: f64,
        load: f64,
    ) -> Result<&'e Equilibrium, GearboxError> {
        let key = [phi, load].map(f64::to_bits);
        let problem = self.problem(phi, load, &self.carrier);
        if let Some((u, left)) = self.known.get(&key).cloned() {
            self.repeats += 1;
            return Ok(last.insert(self.equilibrium(&problem, &u, (left, None))));
        }
        let found = match last.as_ref() {
            Some(near) => self.solve_near(near, phi, load)?,
            None => self.solve(phi, load)?,
        };
        self.balances += 1;
        let u = problem.unknowns(&found.bodies, self.gearbox.layout);
        let left = DVector::from_element(1, found.residual);
        self.known.insert(key, (u, left));
        Ok(last.insert(found))
    }

    /// The balance at `u`, where so much is left.
    fn equilibrium(
        &mut self,
        problem: &Problem,
        u: &[f64],
        (left, inverse): Balanced,
    ) -> Equilibrium {
        self.place(problem, u);
        let moments = left.iter().enumerate();
        let moments = moments.filter(|(k, _)| !problem.is_length(*k));
        let discs = self.bodies[self.gearbox.layout.wheel_bodies()].iter();
        Equilibrium {
            input: problem.phi,
            wheels: discs.map(|disc| disc.angle).collect(),
            output: u[0],
            bodies: self.bodies.clone(),
            residual: moments.map(|(_, x)| x.abs()).fold(0.0, f64::max),
            inverse,
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

    /// Balances that [`track`](Self::track) solved, and those that it knew.
    #[must_use]
    pub fn balances(&self) -> [u64; 2] {
        [self.balances, self.repeats]
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
        self.carrier.pairs(&equilibrium.bodies)
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
