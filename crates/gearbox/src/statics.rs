//! Statics: the angles at which a gearbox at rest carries its load, for a given input angle.
//!
//! The geometry is exact, and the scene's own law acts at rate 0, without damping; friction acts where it is asked for
//! (`friction`). Unknowns are the output's angle and the free coordinates of the discs. On eccentrics these are the discs' angles,
//! on elastic bearings their places too; rigid cranks leave none. The residual of each disc is its force and moment in its free
//! coordinates. The residual of the output is its moment together with the load:
//!
//! ```text
//! F_i = 0, M_i = 0 for every disc i,    sum over discs of M_out,i + M_load = 0
//! ```
//! One quasi-Newton method solves these equations (`newton`), in some ten evaluations without a known balance and half as many
//! from the balance at the pose before. Discs that float begin at the balance on rigid bearings and continue from there
//! (`continuation`). Brackets replace Newton's method on rigid bearings where it fails or where the contacts have no
//! derivatives (discrete points; `brackets`).

mod brackets;
mod continuation;
mod friction;
mod newton;
mod problem;

use std::collections::HashMap;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use pinwheel_contact::Complex;
use pinwheel_mbs::{BodyState, Coordinates, ErrorScales, Evaluation, Jacobian, Structure, Wrench};

use crate::Layout;
use crate::carrier::Carrier;
use crate::contacts::{ContactField, PairContact};
use crate::{Gearbox, GearboxError, load_profile};
pub use friction::{slow, slow_efficiency};
use problem::{Balanced, Free, GOAL, LEFT, OF_A_DISC, Problem, Size, TRACKED};

/// Elastic twist allowed beyond the free play, in pitches (2 pi/zs): the guard of dynamic runs is 0.25.
const PITCHES: f64 = 0.2;
/// Difference steps, relative to the depths and twists of contacts under the load.
const DIFFERENCE: f64 = 2e-5;
/// Initial twist beyond the free play, relative to the twist of the load by the estimate for adaptive steps. It presses
/// contacts deeper than the load will. Forces that stiffen with the depth then lead back without passing the balance, and all
/// pairs that will carry touch from the start.
const TWIST: f64 = 2.0;
/// Least ratio of the load to the largest load from which the sizes of a problem are scaled: of discs that float, and of
/// others.
const LEAST_SIZES: [f64; 2] = [1e-2, 1e-3];
/// Largest ratio of the output's turn at a balance by bearing offsets to its turn if all offsets lay across the eccentric.
const GIVEN_WAY: f64 = 4.0;
/// Rounding errors of a disc's place that may remain as a force of its bearing.
const ROUNDINGS: f64 = 4.0;
/// Weights of the last values, latest first, in the polynomial through them that predicts the next, by its degree.
const AHEAD: [&[f64]; 4] = [
    &[1.0],
    &[2.0, -1.0],
    &[3.0, -3.0, 1.0],
    &[4.0, -6.0, 4.0, -1.0],
];

/// Angles and poses of a gearbox in static balance.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    /// Input angle, rad.
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
    /// Unknowns of the balances up to this one in the frame of the eccentric, less those of the ideal mesh; latest first.
    path: Vec<Vec<f64>>,
    /// Number of differences along the path from which the next balance is predicted.
    order: usize,
}

/// Quasi-static solver of a gearbox.
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
    /// Motion about which moments are taken; see [`Statics::moving`].
    motion: Motion,
    /// Derivatives of the moments with respect to angles, and of the forces on discs to their places.
    derivatives: Jacobian,
    /// Numbers of the unknowns in `derivatives`.
    coordinates: Coordinates,
    /// Carrier of the discs, without friction, because a balance at rest has none; `rigid` takes all bearings as rigid.
    carrier: Arc<Carrier>,
    rigid: Arc<Carrier>,
    /// Last balances of discs that float, each with its load, N m.
    floated: Vec<(Equilibrium, f64)>,
    /// Buffer of the moments that contacts return without loads, by body, N m.
    moments_by_body: Vec<f64>,
    /// True if the contacts could return moments alone at the last evaluation.
    tells_moments: bool,
    scales: ErrorScales,
    largest_n_m: f64,
    least_force_n: f64,
    /// Evaluations of all contacts so far.
    evaluations: u64,
    /// Balances solved so far.
    balances: u64,
    /// Requests for known balances.
    repeats: u64,
    /// Residual at which Newton's method ends, relative to the load's size.
    goal: f64,
    /// True if parts slide with friction in `motion`.
    rubs: bool,
    /// Unknowns and residuals of the balances so far, by the bits of input angle and load.
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

impl Equilibrium {
    /// Appends the path of the balance before, and chooses the prediction that would have met this balance best.
    fn follow(&mut self, before: &Self, problem: &Problem) {
        let own = &self.path[0];
        let missed = |order| {
            let predicted = ahead(&before.path, order);
            problem.moved(predicted.zip(own).map(|(there, here)| there - here))
        };
        let mut least = f64::INFINITY;
        for order in 0..before.path.len() {
            let missed = missed(order);
            if missed < least {
                (self.order, least) = (order, missed);
            }
        }
        let kept = before.path.iter().take(AHEAD.len() - 1).cloned();
        self.path.extend(kept);
    }
}

/// Returns the next values after those of `path`, latest first, by the polynomial of degree `order`.
fn ahead(path: &[Vec<f64>], order: usize) -> impl Iterator<Item = f64> {
    let weighed = move |k: usize| {
        AHEAD[order]
            .iter()
            .zip(path)
            .map(move |(weight, own)| weight * own[k])
    };
    (0..path[0].len()).map(move |k| weighed(k).sum())
}

/// Turns the places of discs among the unknowns by e^{ia}.
fn turn_places(free: Free, values: &mut [f64], by: impl FnOnce() -> Complex) {
    if free == Free::Places {
        let by = by();
        for disc in values[1..].chunks_mut(OF_A_DISC) {
            [disc[0], disc[1]] = (Complex::new(disc[0], disc[1]) * by).to_array();
        }
    }
}

/// Returns the inverse of a Jacobian after all forces and places have turned by e^{ia}.
fn turned_inverse(free: Free, mut inverse: DMatrix<f64>, by: Complex) -> DMatrix<f64> {
    for _ in 0..2 {
        for column in 0..inverse.ncols() {
            turn_places(free, inverse.column_mut(column).as_mut_slice(), || by);
        }
        inverse.transpose_mut();
    }
    inverse
}

impl Motion {
    /// Returns the motion at rest of `wheels` discs.
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
    /// Creates a solver for `gearbox`.
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
            bodies: gearbox.states_from_ring(),
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
            goal: GOAL,
            rubs: false,
            known: HashMap::new(),
            gearbox,
        })
    }

    /// Returns the solver with all bearings taken as rigid.
    #[must_use]
    pub fn on_rigid_bearings(mut self) -> Self {
        self.carrier = self.rigid.clone();
        self
    }

    /// Returns the equations of the balance at the input angle `phi` (rad) under the torque `load` (N m) on this carrier.
    fn problem(&self, phi: f64, load: f64, carrier: &Arc<Carrier>) -> Problem {
        let (scales, gear) = (&self.scales, &self.gearbox.scene.gear);
        let moment = load.abs().max(self.least_force_n * gear.lever_m());
        let largest = self.largest_n_m.max(moment);
        // Rounding of places limits the accuracy of forces under any load.
        let least = LEAST_SIZES[usize::from(!carrier.floats())];
        let share = (moment / largest).max(least);
        let moment = share * largest;
        let force = moment / gear.lever_m();
        // Distance of the bearings from the gear's centre. Forces on cranks' circle have moments about the centre as well.
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
            goal: self.goal,
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

    /// Returns the half widths of the brackets, rad: of a disc about its ideal mesh, and of the output about its ideal angle.
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
        let carried = self.gearbox.geometry.input_per_carrier;
        let [angle, rate] = [carried * u[0], carried * motion.output[0]];
        turn(Layout::INPUT, problem.phi + angle, motion.speed + rate);
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

    /// Sets the poses of all bodies and their velocities in the motion about which forces are taken.
    fn place(&mut self, problem: &Problem, u: &[f64]) {
        self.turn(problem, u);
        let (layout, geometry) = (self.gearbox.layout, &self.gearbox.geometry);
        let BodyState { angle, rate, .. } = self.bodies[Layout::OUTPUT];
        let (input, output) = ([problem.phi, self.motion.speed], [angle, rate]);
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

    /// Returns the unbalanced forces and moments at `u`, in the order of the unknowns.
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
        // Virtual work: rigid eccentrics turn with the carrier, and rigid cranks turn the discs.
        let turns = self.gearbox.geometry.eccentric_per_carrier();
        let bodies = &self.bodies[self.gearbox.layout.wheel_bodies()];
        let turned = |own: f64| -> f64 {
            let of = |(disc, load): (&BodyState, &[f64])| {
                own * load[2] + turns * (disc.x * load[1] - disc.y * load[0])
            };
            let loads = all.as_slice()[1..].chunks(OF_A_DISC);
            bodies.iter().zip(loads).map(of).sum()
        };
        match problem.free {
            Free::Places => all,
            Free::Angles => {
                let moments = (0..bodies.len()).map(|i| all[OF_A_DISC * (i + 1)]);
                let output = std::iter::once(all[0] + turned(0.0));
                DVector::from_iterator(u.len(), output.chain(moments))
            }
            Free::Output => DVector::from_element(1, all[0] + turned(1.0)),
        }
    }

    /// Returns the unbalanced moments on output and discs at their angles, N m. `None`: the contacts need loads or places for
    /// them.
    fn moments(&mut self, load: f64) -> Option<DVector<f64>> {
        // Forces move discs that float.
        if self.gearbox.carrier.floats()
            || self.gearbox.scene.ring_turns()
            || !self.field.work_from_angles()
        {
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

    /// Returns the unbalanced moment on the output, and the unbalanced forces and moment on every disc, at the bodies' poses.
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
        output += self.gearbox.geometry.input_per_carrier * self.loads[Layout::INPUT].moment;
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

    /// Adds the contacts' loads on the discs and returns the known moment on the output, N m. If that moment is not known, the
    /// loads on the output's pins are added too, and the moment is that of friction and seals.
    fn add_contacts(&mut self) -> f64 {
        // Forces on discs have a moment on the eccentrics, which turn with a ring's frame.
        if self.gearbox.scene.ring_turns() || !self.field.work_from_angles() {
            self.field.add_loads(&self.bodies, &mut self.loads);
            return self.loads[Layout::OUTPUT].moment;
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

    /// Returns the Jacobian of the residual, which is `here` at `u`. It is taken by differences where these are cheaper or the
    /// contacts have no derivatives. `None`: discs on eccentrics whose contacts have no derivatives.
    fn jacobian(
        &mut self,
        problem: &Problem,
        u: &[f64],
        here: &DVector<f64>,
    ) -> Option<DMatrix<f64>> {
        let by_differences = match problem.free {
            _ if self.rubs || self.gearbox.scene.ring_turns() => true,
            Free::Output => true,
            Free::Angles => self.tells_moments,
            Free::Places => false,
        };
        if !by_differences {
            let exact = self.derivatives(problem, u);
            if exact.is_some() || problem.free == Free::Angles {
                return exact.map(|[position, _]| position);
            }
        }
        Some(self.differences(problem, u, here))
    }

    /// Returns the derivatives of the residual with respect to the unknowns and to their rates. `None`: the contacts have none.
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

    /// Returns the derivatives of the residual, which is `here` at `u`, by differences.
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

    /// Returns the Jacobian at a balance by differences, and from the contacts' own derivatives with respect to the unknowns
    /// and to their rates.
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

    /// Returns the stiffness, N m/rad, and damping, N m s/rad, of the output about a balance, with the input locked and the
    /// discs following. `None`: the contacts have no derivatives.
    ///
    /// With s the rate of change, the derivatives are K + s D. Elimination of the discs leaves the output 1/e.(K + s D)^-1 e,
    /// taken to first order in s.
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
        let damping = -stiffness * stiffness * left.dot(&(damping * shape));
        let states = self.gearbox.scene.carrier_moment_per_output().powi(2);
        Some([stiffness, damping].map(|of_carrier| of_carrier / states))
    }

    /// Returns true if the ideal mesh is in balance without a load, but for rounding. No other rest position within the play is
    /// determined: forces of very small depth have no derivative to follow.
    fn rests(&mut self, problem: &Problem, ideal: &[f64]) -> bool {
        let mut largest = |turn: f64| {
            let turned: Vec<f64> = ideal.iter().map(|angle| angle + turn).collect();
            self.residual(problem, &turned).amax()
        };
        largest(0.0) <= 1e-3 * largest(1e-9)
    }

    /// Solves the equilibrium at the input angle `phi` (rad) under the load torque `load` (N m on the output).
    ///
    /// # Errors
    /// [`GearboxError::NoEquilibrium`]: the load is more than the teeth carry before they jump. [`GearboxError::Lost`]: parts rest in their
    /// clearance.
    pub fn solve(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        match self.carrier.floats() {
            true => self.solve_floating(phi, load),
            false => self.solve_rigid(phi, load),
        }
    }

    /// Solves the equilibrium on rigid bearings.
    fn solve_rigid(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        let problem = self.problem(phi, load, &self.rigid);
        let ideal = self.ideal(problem.free, phi);
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

    /// Returns the unknowns at the ideal mesh, with 0 for the places of discs.
    fn ideal(&self, free: Free, phi: f64) -> Vec<f64> {
        let geometry = &self.gearbox.geometry;
        let discs = (0..self.gearbox.layout.wheels).map(|i| geometry.ideal_wheel_angle(i, phi));
        let output = std::iter::once(geometry.ideal_output_angle(phi));
        match free {
            Free::Output => output.collect(),
            Free::Angles => output.chain(discs).collect(),
            Free::Places => output
                .chain(discs.flat_map(|disc| [0.0, 0.0, disc]))
                .collect(),
        }
    }

    /// Solves the equilibrium at an input angle `phi` (rad) close to that of `near`, under the same load `load` (N m). It takes
    /// fewer steps than [`Statics::solve`] and gives the same result to rounding. Where Newton's method fails from `near`, it
    /// starts again without it.
    ///
    /// # Errors
    /// Errors of [`Statics::solve`].
    pub fn solve_near(
        &mut self,
        near: &Equilibrium,
        phi: f64,
        load: f64,
    ) -> Result<Equilibrium, GearboxError> {
        // Without a load the gear may rest anywhere in its play, and there is no slope to follow.
        let balance = (load != 0.0).then(|| self.continue_from(near, phi, load));
        match balance.flatten() {
            Some(balance) => Ok(balance),
            None => self.solve(phi, load),
        }
    }

    /// Solves the balance from the one at `near`; `None`: Newton's method did not converge from there.
    fn continue_from(&mut self, near: &Equilibrium, phi: f64, load: f64) -> Option<Equilibrium> {
        let problem = self.problem(phi, load, &self.carrier);
        let free = problem.free;
        let mut u = self.out_of_mesh(free, phi, ahead(&near.path, near.order));
        let turned = self.eccentric(phi) * self.eccentric(near.input).conj();
        let inverse = near.inverse.clone();
        let inverse = inverse.map(|inverse| turned_inverse(free, inverse, turned));
        let balanced = self.newton(&problem, &mut u, inverse)?;
        Some(self.equilibrium(&problem, &u, balanced))
    }

    /// Returns e^{ia} of the eccentric at the ideal mesh.
    fn eccentric(&self, phi: f64) -> Complex {
        Complex::unit(self.gearbox.geometry.ideal_eccentric_angle(phi))
    }

    /// Returns the unknowns at the input angle `phi` in the frame of the ideal mesh: angles less the ideal ones, and places from
    /// the eccentric.
    fn in_mesh(&self, free: Free, phi: f64, u: &[f64]) -> Vec<f64> {
        let ideal = self.ideal(free, phi);
        let mut own: Vec<f64> = u.iter().zip(ideal).map(|(u, ideal)| u - ideal).collect();
        turn_places(free, &mut own, || self.eccentric(phi).conj());
        own
    }

    /// Returns the unknowns from those in the frame of the ideal mesh, the inverse of [`in_mesh`](Self::in_mesh).
    fn out_of_mesh(&self, free: Free, phi: f64, own: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut u: Vec<f64> = own.collect();
        turn_places(free, &mut u, || self.eccentric(phi));
        let ideal = self.ideal(free, phi);
        u.iter_mut().zip(ideal).for_each(|(u, ideal)| *u += ideal);
        u
    }

    /// Solves the balance at the next of some input angles under one load, and stores it in `last`. It starts from the polynomial
    /// through the previous balances in `last` that predicted the one before best. A balance that is already known is not solved again.
    ///
    /// # Errors
    /// Errors of [`Statics::solve`].
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
        self.goal = TRACKED;
        let balance = match last.as_ref() {
            Some(near) => self.solve_near(near, phi, load),
            None => self.solve(phi, load),
        };
        self.goal = GOAL;
        let mut balance = balance?;
        if let Some(before) = last {
            balance.follow(before, &problem);
        }
        self.balances += 1;
        let u = problem.unknowns(&balance.bodies, self.gearbox.layout);
        let left = DVector::from_element(1, balance.residual);
        self.known.insert(key, (u, left));
        Ok(last.insert(balance))
    }

    /// Returns the balance at `u`, whose residual is `left`.
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
            path: vec![self.in_mesh(problem.free, problem.phi, u)],
            order: 0,
        }
    }

    /// Returns the gearbox that is balanced.
    pub fn gearbox(&self) -> &'a Gearbox {
        self.gearbox
    }

    /// Returns the number of evaluations of all contacts so far, the cost of the poses.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Returns the number of balances that [`track`](Self::track) solved, and of those that were already known.
    pub fn balances(&self) -> [u64; 2] {
        [self.balances, self.repeats]
    }

    /// Returns the touching pairs of an equilibrium, the friction of sleeves on their pins among that of their contacts.
    pub fn touching(&mut self, equilibrium: &Equilibrium) -> Vec<PairContact> {
        let mut pairs = Vec::new();
        let (bodies, pins) = (&equilibrium.bodies, self.field.pins);
        self.field.touching(bodies, &mut |pair| {
            let mut pair = *pair;
            if let Some(pins) = &pins[pair.sleeve.side()] {
                let ([nx, ny], [fx, fy]) = (pair.normal, pins.drag(bodies, &pair).force);
                pair.friction_force_n += nx * fy - ny * fx;
            }
            pairs.push(pair);
        });
        pairs
    }

    /// Returns the bearings by which cranks of an RV gear carry discs, as pairs; empty for other gears.
    pub fn on_cranks(&self, equilibrium: &Equilibrium) -> Vec<PairContact> {
        self.carrier.pairs(&equilibrium.bodies)
    }

    /// Solves the states at t = 0 of a run that starts loaded and already in its slow motion.
    ///
    /// Angles along the equilibria are functions of the input angle. Rates are therefore `omega d/dphi` and accelerations
    /// `omega^2 d^2/dphi^2`, by central differences. A second solution includes the damping at these rates and the moments of
    /// these accelerations; its derivatives give the rates. Pins spin as at the kinematic start, held ones with the output.
    ///
    /// # Errors
    /// See [`Statics::solve`].
    pub fn moving(&mut self) -> Result<Vec<BodyState>, GearboxError> {
        let (speed, load) = (
            self.gearbox.scene.drive.input_speed_rad_s,
            (self.gearbox).along_carrier_n_m(self.gearbox.load_torque(0.0)),
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
            // Rates are relative to the ring, accelerations to the ground.
            let states = [&before, &here, &after].map(|at| at.bodies.clone());
            let ground = states.clone().map(|bodies| self.gearbox.to_ground(bodies));
            let course = |body: usize, of: fn(&BodyState) -> f64| {
                let [[rate, _], [_, bend]] = [&states, &ground].map(|at| {
                    let [b, m, a] = [0, 1, 2].map(|k| of(&at[k][body]));
                    derivatives(b, m, a)
                });
                [rate, bend]
            };
            let centre = |body: usize| {
                let [[vx, ax], [vy, ay]] = [course(body, |b| b.x), course(body, |b| b.y)];
                [[vx, vy], [ax, ay]]
            };
            let wheels = self.gearbox.layout.wheel_bodies();
            self.motion = Motion {
                centres: wheels.clone().map(centre).collect(),
                speed,
                wheels: wheels.map(|body| course(body, |b| b.angle)).collect(),
                output: derivatives(before.output, here.output, after.output),
            };
            here = self.solve_near(&here, 0.0, load)?;
        }
        let mut states = self.gearbox.to_ground(here.bodies);
        if self.gearbox.scene.gear.internal_sleeves_turn {
            let kinematic = self.gearbox.kinematic_states();
            for body in self.gearbox.layout.internal_bodies() {
                states[body].angle = kinematic[body].angle;
                states[body].rate = kinematic[body].rate;
            }
        }
        self.motion = Motion::none(self.gearbox.layout.wheels);
        Ok(states)
    }
}
