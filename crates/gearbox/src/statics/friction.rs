//! Balances with friction: every sliding contact slides in the direction of a slow motion.
//!
//! There are two such motions. In the first the input turns under a constant load, and parts slide as in the ideal mesh. In the
//! second the input is locked, the load rises or falls, and parts slide as the balance moves: du/dT = -J^-1 e. J is the
//! Jacobian of the residual with friction, and e the output's moment. Sliding and balance are solved alternately. Damping and
//! inertia are left out. Pins that turn without a stated friction of their own roll freely.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use pinwheel_mbs::Wrench;

use super::newton::update;
use super::problem::{Free, LEFT, OF_A_DISC, Problem, TRACKED};
use super::{Equilibrium, Motion, Statics};
use crate::contacts::{self, Seals};
use crate::scene::Scene;
use crate::{Gearbox, GearboxError, Layout, speed_profile};

/// Bore of sleeves that roll freely, m; any is right.
const BORE_M: f64 = 1e-3;
/// Speed at which everything slides, rad/s: of the input of a gear at rest, and of the output under a changing load.
const SLIDES_RAD_S: f64 = 1e4;
/// Most rounds of sliding and balance, and the change of a balance that ends them, relative to the contacts' depths and twists.
const ROUNDS: usize = 24;
const KNOWN: f64 = 1e-6;
/// Speed of the output at which friction almost vanishes, rad/s: it fades below a sliding of some 1 rad/s. If the rounds fail
/// because parts stick, they begin here and go on to a higher speed, then to full sliding.
const CREEPS_RAD_S: f64 = 1e-4;
/// Growth factor of that speed, replaced by its square root where it fails, and the least factor.
const GROWTH: f64 = 4.0;
const LEAST_GROWTH: f64 = 1.05;

/// Balance, rates of its unknowns, and inverse derivatives of the rates that they miss.
type Sliding = (Equilibrium, DVector<f64>, DMatrix<f64>);

/// Returns the scene reduced to the properties that act in slow motion.
pub fn slow(mut scene: Scene) -> Scene {
    let (contact, bearings) = (&mut scene.contact, &mut scene.bearings);
    (contact.damping_n_s_m, contact.restitution) = (0.0, 1.0);
    if contact.friction_coefficient > 0.0 {
        bearings.sleeve_friction_coefficient.get_or_insert(0.0);
        bearings.sleeve_bore_m.get_or_insert(BORE_M);
    }
    scene
}

impl<'a> Statics<'a> {
    /// Creates the solver of a gear in slow motion; `None` without friction.
    ///
    /// # Errors
    /// See [`Gearbox::contact_field`].
    pub fn rubbing(gearbox: &'a Gearbox) -> Result<Option<Self>, GearboxError> {
        let scene = slow(gearbox.scene.clone().into_scene());
        if !scene.rubs() {
            return Ok(None);
        }
        let mut statics = Self::new(gearbox)?;
        statics.field = contacts::contacts(&scene, &gearbox.geometry, gearbox.kernel)?;
        statics.field.seals = Seals::of(&scene);
        statics.carrier = Arc::new(gearbox.carrier.clone().undamped());
        (statics.rubs, statics.goal) = (true, TRACKED);
        Ok(Some(statics))
    }

    /// Solves the balance under `load` (N m) while the input turns, from the balance without friction at its angle. `way` is 1
    /// in the scene's direction, -1 in the opposite one.
    ///
    /// # Errors
    /// [`GearboxError::Sticks`]
    pub fn turning(
        &mut self,
        way: f64,
        near: &Equilibrium,
        load: f64,
    ) -> Result<Equilibrium, GearboxError> {
        let geometry = &self.gearbox.geometry;
        let speed = match speed_profile::fastest_rad_s(&self.gearbox.scene.drive) {
            0.0 => way * SLIDES_RAD_S,
            speed => way * speed,
        };
        let slow = geometry.ideal_output_angle(speed);
        let eccentric = [near.input, speed].map(|x| geometry.ideal_eccentric_angle(x));
        let discs = 0..self.gearbox.layout.wheels;
        let centre = |i| {
            let disc = geometry.wheel_state(i, eccentric, [0.0, slow]);
            [[disc.vx, disc.vy], [0.0; 2]]
        };
        self.motion = Motion {
            speed,
            wheels: vec![[slow, 0.0]; discs.len()],
            output: [slow, 0.0],
            centres: discs.map(centre).collect(),
        };
        self.slide(near, load)
    }

    /// Solves the balance under `load` (N m) with the input locked, from the one without friction at its angle, while the load
    /// rises (`way` 1, counter-clockwise) or falls (-1).
    ///
    /// # Errors
    /// [`GearboxError::Sticks`]
    pub fn loading(
        &mut self,
        way: f64,
        near: &Equilibrium,
        load: f64,
    ) -> Result<Equilibrium, GearboxError> {
        let problem = self.problem(near.input, load, &self.carrier);
        self.motion = Motion::none(self.gearbox.layout.wheels);
        let rates = self.rates(&problem, near, way)?;
        let inverse = -DMatrix::identity(rates.len(), rates.len());
        let mut here = (near.clone(), rates, inverse);
        let (mut speed, mut next, mut growth) = (CREEPS_RAD_S, SLIDES_RAD_S, GROWTH);
        while growth > LEAST_GROWTH {
            match self.settle(&problem, here.clone(), way, next) {
                Some((balance, ..)) if next >= SLIDES_RAD_S => return Ok(balance),
                Some(balance) => (here, speed, next) = (balance, next, SLIDES_RAD_S),
                None => {
                    if next < SLIDES_RAD_S {
                        growth = growth.sqrt();
                    }
                    next = speed * growth;
                }
            }
        }
        Err(GearboxError::Sticks)
    }

    /// Solves the balance whose friction belongs to its own rates, with the output at `speed` (rad/s), by Broyden's method from
    /// a near balance.
    fn settle(
        &mut self,
        problem: &Problem,
        (mut balance, mut rates, mut inverse): Sliding,
        way: f64,
        speed: f64,
    ) -> Option<Sliding> {
        let mut last: Option<[DVector<f64>; 2]> = None;
        for _ in 0..ROUNDS {
            self.motion = self.along(problem, &(&rates * speed));
            let before = balance;
            balance = self.slide(&before, problem.load).ok()?;
            let [u, next] =
                [&before, &balance].map(|at| problem.unknowns(&at.bodies, self.gearbox.layout));
            let moved = problem.moved(next.iter().zip(&u).map(|(next, u)| next - u));
            if last.is_some() && moved < KNOWN {
                return Some((balance, rates, inverse));
            }
            let missed = self.rates(problem, &balance, way).ok()? - &rates;
            if let Some([before, step]) = &last {
                update(&mut inverse, 1.0, step, &(&missed - before));
            }
            let step = -(&inverse * &missed);
            rates += &step;
            last = Some([missed, step]);
        }
        None
    }

    /// Returns the rates of the unknowns at a balance as the load rises or falls, relative to the output's.
    fn rates(
        &mut self,
        problem: &Problem,
        at: &Equilibrium,
        way: f64,
    ) -> Result<DVector<f64>, GearboxError> {
        let u = problem.unknowns(&at.bodies, self.gearbox.layout);
        let here = self.residual(problem, &u);
        let jacobian = problem.held(self.differences(problem, &u, &here), LEFT);
        let mut change = DVector::zeros(u.len());
        change[0] = -way;
        let moves = jacobian.lu().solve(&change).ok_or(GearboxError::Sticks)?;
        let output = moves[0].abs();
        Ok(moves / output)
    }

    /// Returns the motion in which the unknowns have these rates.
    fn along(&self, problem: &Problem, rates: &DVector<f64>) -> Motion {
        let mut motion = Motion::none(self.gearbox.layout.wheels);
        motion.output[0] = rates[0];
        let discs = motion.wheels.iter_mut().zip(&mut motion.centres);
        for (i, (turn, centre)) in discs.enumerate() {
            let at = OF_A_DISC * i + 1;
            turn[0] = match problem.free {
                Free::Output => rates[0],
                Free::Angles => rates[1 + i],
                Free::Places => rates[at + 2],
            };
            if problem.free == Free::Places {
                centre[0] = [rates[at], rates[at + 1]];
            }
        }
        motion
    }

    /// Solves the balance with the friction of the motion, from a near one at its angle.
    fn slide(&mut self, near: &Equilibrium, load: f64) -> Result<Equilibrium, GearboxError> {
        let near = Equilibrium {
            order: 0,
            ..near.clone()
        };
        let balance = self.continue_from(&near, near.input, load);
        balance.ok_or(GearboxError::Sticks)
    }

    /// Returns the driver's torque at a balance in which the input [turns](Self::turning), N m: by virtual work along the rates
    /// of the ideal mesh.
    pub fn driver_torque(&mut self, at: &Equilibrium, load: f64) -> f64 {
        self.loads.fill(Wrench::default());
        self.field.add_loads(&at.bodies, &mut self.loads);
        self.carrier.add_loads(&at.bodies, &mut self.loads, None);
        self.loads[Layout::OUTPUT].moment += load;
        let powers = at.bodies.iter().zip(&self.loads);
        let power: f64 = powers
            .map(|(body, load)| body.vx * load.fx + body.vy * load.fy + body.rate * load.moment)
            .sum();
        -power / self.motion.speed
    }
}

/// Returns the efficiency of a motion under `load` (N m) with this mean driver torque, N m; either shaft may drive. A gear that
/// locks itself has at most 0.
pub fn slow_efficiency(gearbox: &Gearbox, driver_n_m: f64, load: f64) -> f64 {
    let delivered = -load * gearbox.geometry.ideal_output_angle(1.0);
    match delivered * speed_profile::fastest_rad_s(&gearbox.scene.drive) > 0.0 {
        true => delivered / driver_n_m,
        false => driver_n_m / delivered,
    }
}
