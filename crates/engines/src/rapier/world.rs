//! The mechanism in rapier: one rigid body each, impulse revolutes, and a prescribed input shaft.
//!
//! rapier is semi-implicit Euler, x_{n+1} = x_n + h v_{n+1}, which is leapfrog if its velocities are interpreted as v_{n+1/2}.
//! The world has positions at t_n and velocities half a step earlier; [`World::at_node`] extrapolates these to t_n.

use pinwheel_gearbox::Gearbox;
use pinwheel_mbs::{Body, BodyState, Wrench};
use pinwheel_scene::{Drive, Layout, speed_profile};
use rapier2d_f64::prelude::*;

/// Product h w of the springs of the revolutes. rapier's own, of 1 MHz, are too soft at short steps: their error against the
/// leapfrog is 1.7e-5 in the forces, that of these below 1e-6.
const JOINT_STEP_TIMES_FREQUENCY: f64 = 1e4;

/// World of rapier for one gearbox, with its state between steps.
pub struct World {
    /// World of rapier itself.
    pub physics: PhysicsWorld,
    /// rapier's handles in [`Layout`] order.
    handles: Vec<RigidBodyHandle>,
    joints: Vec<ImpulseJointHandle>,
    drive: Drive,
    step_s: f64,
    /// Positions at t_n, velocities at t_{n-1/2} (at t_0 for n = 0).
    states: Vec<BodyState>,
    /// Velocities at t_{n-3/2}: vx, vy, rate.
    earlier: Vec<[f64; 3]>,
    taken: u64,
}

impl World {
    /// Creates the bodies at the gearbox's initial state, without colliders. `sweeps` is the number of projected Gauss-Seidel
    /// sweeps over all constraints in a step.
    pub fn new(gearbox: &Gearbox, step_s: f64, sweeps: usize) -> Self {
        let mechanism = gearbox.mechanism();
        let mut physics = PhysicsWorld::new();
        physics.gravity = Vector::ZERO;
        physics.integration_parameters = parameters(step_s, sweeps);

        let states = gearbox.initial_states();
        let handles: Vec<RigidBodyHandle> = states
            .iter()
            .zip(&mechanism.bodies)
            .enumerate()
            .map(|(body, (state, of))| {
                physics.insert_body(rigid_body(state, of, body == Layout::INPUT))
            })
            .collect();
        // rapier would compute these at its first step, but the contact hook needs them before.
        for handle in &handles {
            physics.bodies[*handle].recompute_mass_properties_from_colliders(&physics.colliders);
        }
        let ground = physics.insert_body(RigidBodyBuilder::fixed());
        let stiff = SpringCoefficients {
            natural_frequency: JOINT_STEP_TIMES_FREQUENCY / (step_s * std::f64::consts::TAU),
            damping_ratio: 1.0,
        };
        let revolutes = mechanism.revolutes.iter();
        let joints = revolutes
            .filter(|pin| pin.child != Layout::INPUT)
            .map(|pin| {
                let (carrier, carried) = (pin.parent, pin.child);
                let at = &states[carried];
                let anchor = carrier.map_or(Vector::new(at.x, at.y), |carrier| {
                    in_frame_of(&states[carrier], at)
                });
                // Drivers fix pins that do not turn.
                let axes = match mechanism.drivers.iter().any(|held| held.child == carried) {
                    true => JointAxesMask::LOCKED_FIXED_AXES,
                    false => JointAxesMask::LOCKED_REVOLUTE_AXES,
                };
                let joint = GenericJointBuilder::new(axes)
                    .local_anchor1(anchor)
                    .local_anchor2(Vector::ZERO)
                    .softness(stiff)
                    .contacts_enabled(false);
                let carrier = carrier.map_or(ground, |carrier| handles[carrier]);
                physics.insert_impulse_joint(carrier, handles[carried], joint)
            })
            .collect();
        let earlier = vec![[0.0; 3]; states.len()];
        Self {
            physics,
            handles,
            joints,
            drive: gearbox.scene.drive.clone(),
            step_s,
            states,
            earlier,
            taken: 0,
        }
    }

    /// Returns rapier's body of an index in [`Layout`] order.
    pub fn body(&self, index: usize) -> &RigidBody {
        &self.physics.bodies[self.handles[index]]
    }

    /// Fixes a collider to a body.
    pub fn attach(&mut self, collider: ColliderBuilder, body: usize) -> ColliderHandle {
        self.physics
            .insert_collider(collider, Some(self.handles[body]))
    }

    /// Sets the frequency of the spring of all contacts, Hz, without damping.
    pub fn contact_spring(&mut self, natural_frequency: f64) {
        let spring = SpringCoefficients {
            natural_frequency,
            damping_ratio: 0.0,
        };
        let parameters = &mut self.physics.integration_parameters;
        parameters.contact_softness = spring;
        parameters.static_contact_softness = spring;
    }

    /// Writes the states at t_n with extrapolated velocities: v_n = 3/2 v_{n-1/2} - 1/2 v_{n-3/2}.
    pub fn at_node(&self, into: &mut Vec<BodyState>) {
        into.clear();
        into.extend(
            self.states
                .iter()
                .zip(&self.earlier)
                .map(|(state, earlier)| {
                    if self.taken == 0 {
                        return *state;
                    }
                    let ahead = |now: f64, before: f64| 1.5 * now - 0.5 * before;
                    BodyState {
                        vx: ahead(state.vx, earlier[0]),
                        vy: ahead(state.vy, earlier[1]),
                        rate: ahead(state.rate, earlier[2]),
                        ..*state
                    }
                }),
        );
    }

    /// Replaces the velocities of `before`, the states at the node before the last step, by the mean of the velocities half a
    /// step before and after that node. The known velocities at the start are kept.
    pub fn centre(&self, before: &mut [BodyState]) {
        if self.taken <= 1 {
            return;
        }
        for ((at, state), earlier) in before.iter_mut().zip(&self.states).zip(&self.earlier) {
            at.vx = 0.5 * (state.vx + earlier[0]);
            at.vy = 0.5 * (state.vy + earlier[1]);
            at.rate = 0.5 * (state.rate + earlier[2]);
        }
    }

    /// Returns the acceleration of a body's centre over the last step, m/s^2.
    pub fn acceleration(&self, body: usize) -> [f64; 2] {
        let (state, earlier) = (&self.states[body], &self.earlier[body]);
        [
            (state.vx - earlier[0]) / self.step_s,
            (state.vy - earlier[1]) / self.step_s,
        ]
    }

    /// Returns the share of a step over which the loads act: half for the first one, because the initial velocities belong to
    /// t_0 and not to t_{-1/2}.
    pub fn share(&self) -> f64 {
        if self.taken == 0 { 0.5 } else { 1.0 }
    }

    /// Replaces the loads on all bodies, multiplied by [`World::share`].
    pub fn load(&mut self, loads: &[Wrench]) {
        let share = self.share();
        for (handle, load) in self.handles.iter().zip(loads) {
            let body = &mut self.physics.bodies[*handle];
            body.reset_forces(false);
            body.reset_torques(false);
            body.add_force(Vector::new(share * load.fx, share * load.fy), false);
            body.add_torque(share * load.moment, false);
        }
    }

    /// Takes one step of rapier; afterwards [`World::states`] belongs to the next node.
    ///
    /// # Errors
    /// Body that rapier removed because its state is not finite.
    pub fn advance(&mut self, hooks: &dyn PhysicsHooks) -> Result<(), String> {
        let (drive, steps) = (&self.drive, (self.taken + 1) as f64);
        let next_angle = drive.input_speed_rad_s * self.step_s * steps
            + speed_profile::lead_rad(drive, self.step_s * steps);
        self.physics.bodies[self.handles[Layout::INPUT]]
            .set_next_kinematic_rotation(Rotation::new(next_angle));
        self.physics.step_with_events(hooks, &());
        let quarantine = self.physics.quarantine();
        if !quarantine.is_empty() {
            let body = quarantine.bodies().first();
            let body = body.and_then(|body| self.handles.iter().position(|handle| handle == body));
            return Err(match body {
                Some(body) => format!("body {body} is no longer finite; rapier removed it"),
                None => "a collider is no longer finite; rapier removed it".to_owned(),
            });
        }
        for ((handle, state), earlier) in self
            .handles
            .iter()
            .zip(&mut self.states)
            .zip(&mut self.earlier)
        {
            let body = &self.physics.bodies[*handle];
            let (at, velocity) = (body.translation(), body.linvel());
            let now = [velocity.x, velocity.y, body.angvel()];
            let before = [state.vx, state.vy, state.rate];
            *earlier = if self.taken == 0 {
                // v_{-1/2} for a start at v_0 with the acceleration of the first half step.
                [0, 1, 2].map(|i| 2.0 * before[i] - now[i])
            } else {
                before
            };
            *state = BodyState {
                x: at.x,
                y: at.y,
                angle: unwrapped(body.rotation().angle(), state.angle),
                vx: now[0],
                vy: now[1],
                rate: now[2],
            };
        }
        self.taken += 1;
        Ok(())
    }

    /// Returns the largest distance between the two anchors of any revolute, m.
    pub fn joint_drift(&self) -> f64 {
        self.joints
            .iter()
            .filter_map(|joint| self.physics.impulse_joints.get(*joint))
            .map(|joint| {
                let (one, two) = (
                    &self.physics.bodies[joint.body1()],
                    &self.physics.bodies[joint.body2()],
                );
                let a = one.position() * joint.data.local_anchor1();
                let b = two.position() * joint.data.local_anchor2();
                (a - b).length()
            })
            .fold(0.0, f64::max)
    }
}

/// Returns parameters that disable all limits and heuristics of a game engine that would alter the equations.
fn parameters(step_s: f64, sweeps: usize) -> IntegrationParameters {
    IntegrationParameters {
        dt: step_s,
        // Substeps would freeze Pinwheel's forces: an error of 97 % with the default 4.
        num_solver_iterations: 1,
        num_internal_pgs_iterations: sweeps,
        num_internal_stabilization_iterations: 0,
        warmstart_joints: true,
        normalized_max_linear_velocity: f64::MAX,
        normalized_max_corrective_velocity: f64::MAX,
        max_ccd_substeps: 0,
        contact_recycling: false,
        normalized_prediction_distance: 0.0,
        ..IntegrationParameters::default()
    }
}

fn rigid_body(state: &BodyState, of: &Body, driven: bool) -> RigidBodyBuilder {
    let builder = if driven {
        RigidBodyBuilder::kinematic_position_based()
    } else {
        RigidBodyBuilder::dynamic()
    };
    builder
        .translation(Vector::new(state.x, state.y))
        .rotation(state.angle)
        .linvel(Vector::new(state.vx, state.vy))
        .angvel(state.rate)
        .additional_mass_properties(MassProperties::new(Vector::ZERO, of.mass, of.moment))
        .gravity_scale(0.0)
        .can_sleep(false)
        .ccd_enabled(false)
        .allow_fast_rotation(true)
}

/// Returns the centre of `point` in the frame of `carrier`.
pub fn in_frame_of(carrier: &BodyState, point: &BodyState) -> Vector {
    let (sin, cos) = carrier.angle.sin_cos();
    let (dx, dy) = (point.x - carrier.x, point.y - carrier.y);
    Vector::new(cos * dx + sin * dy, cos * dy - sin * dx)
}

/// Returns the angle equal to `wrapped` modulo a turn that is closest to `near`.
pub fn unwrapped(wrapped: f64, near: f64) -> f64 {
    wrapped + std::f64::consts::TAU * ((near - wrapped) / std::f64::consts::TAU).round()
}
