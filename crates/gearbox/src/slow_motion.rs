//! Driver torque and efficiency of slow motion by statics, including all friction.
//!
//! In slow motion all parts slide at the rates of the ideal mesh in that pose. Discs and output are in equilibrium under
//! contact forces and the friction of these rates, without damping and inertia. Pins that turn without a stated friction roll
//! freely.

use nalgebra::{DMatrix, DVector};
use pinwheel_mbs::{BodyState, Detail, ErrorScales, Formulation as _, OdeSystem as _, Reduced};

use crate::forces::GearForces;
use crate::native::reduced;
use crate::scene::{Scene, Start};
use crate::{Gearbox, GearboxError};

/// Largest number of Newton steps, and of halvings of a step.
const STEPS: usize = 40;
const HALVINGS: i32 = 8;
/// Change of an unknown at convergence, and difference step, relative to the scale of errors.
const KNOWN: f64 = 1e-9;
const NUDGE: f64 = 1e-5;
/// Bore of sleeves that roll freely, m; its value has no effect.
const BORE_M: f64 = 1e-3;

/// Slow motion of a gear under one load.
pub struct SlowMotion {
    gearbox: Gearbox,
    system: Reduced<GearForces>,
    /// Scale of errors of every unknown.
    scales: Vec<f64>,
}

impl SlowMotion {
    /// Creates the slow motion of a gear under a torque on its output, N m, at the scene's speed.
    ///
    /// # Errors
    /// A load that the scene's checks refuse.
    pub fn new(gearbox: &Gearbox, load_n_m: f64) -> Result<Self, GearboxError> {
        let scene = gearbox.scene.changed(|scene| still(scene, load_n_m))?;
        let gearbox = Gearbox::after(Some(gearbox), &scene)?;
        let system = reduced(&gearbox, gearbox.mechanism(), GearForces::new(&gearbox)?)?;
        let ErrorScales { angle, length, .. } = gearbox.error_scales();
        let mut scales = vec![length; system.dimension() / 2];
        scales[..system.free_bodies().len()].fill(angle);
        Ok(Self {
            gearbox,
            system,
            scales,
        })
    }

    /// Returns the driver's torque at an input angle, N m, from the poses of the bodies in frictionless equilibrium there;
    /// `None` if there is no equilibrium with friction near it.
    pub fn driver_torque(&mut self, phi: f64, at: &[BodyState]) -> Option<f64> {
        let t = phi / self.gearbox.scene.drive.input_speed_rad_s;
        let n = self.scales.len();
        let mut y = self.start(phi, at);
        let mut rates = vec![0.0; 2 * n];
        let mut left = self.left(t, &y, &mut rates);
        for _ in 0..STEPS {
            let mut jacobian = DMatrix::zeros(n, n);
            for k in 0..n {
                let (kept, nudge) = (y[k], NUDGE * self.scales[k]);
                y[k] += nudge;
                let moved = (self.left(t, &y, &mut rates) - &left) / nudge;
                y[k] = kept;
                jacobian.set_column(k, &moved);
            }
            let step = jacobian.lu().solve(&left)?;
            let before = y.clone();
            for halving in 0..=HALVINGS {
                let share = 0.5_f64.powi(halving);
                (0..n).for_each(|k| y[k] = before[k] - share * step[k]);
                let next = self.left(t, &y, &mut rates);
                if next.norm() < left.norm() || halving == HALVINGS {
                    left = next;
                    break;
                }
            }
            if (0..n).all(|k| (y[k] - before[k]).abs() <= KNOWN * self.scales[k]) {
                let seen = self.system.observe(t, &y, Detail::Forces);
                return Some(seen.driver_torques[0]);
            }
        }
        None
    }

    /// Returns the efficiency of a motion with this mean driver torque, N m; either shaft may drive. At most 0 for a
    /// self-locking gear.
    #[must_use]
    pub fn efficiency(&self, driver_n_m: f64) -> f64 {
        let drive = &self.gearbox.scene.drive;
        let turns = self.gearbox.geometry.ideal_output_angle(1.0);
        let delivered = -drive.output_torque_n_m * turns;
        match delivered * drive.input_speed_rad_s > 0.0 {
            true => delivered / driver_n_m,
            false => driver_n_m / delivered,
        }
    }

    /// Returns the accelerations, the residuals of the equilibrium.
    fn left(&mut self, t: f64, y: &[f64], rates: &mut [f64]) -> DVector<f64> {
        self.system.derivative(t, y, rates);
        DVector::from_column_slice(&rates[self.scales.len()..])
    }

    /// Returns the state with these poses and the rates of the ideal mesh.
    fn start(&self, phi: f64, at: &[BodyState]) -> Vec<f64> {
        let (geometry, layout) = (&self.gearbox.geometry, self.gearbox.layout);
        let speed = self.gearbox.scene.drive.input_speed_rad_s;
        let slow = geometry.ideal_output_angle(speed);
        let turning = geometry.ideal_eccentric_angle(speed);
        let free = self.system.free_bodies();
        let floating = if self.gearbox.floats() {
            layout.wheels
        } else {
            0
        };
        let discs = layout.wheel_bodies().take(floating).enumerate();
        let poses: Vec<_> = discs
            .map(|(i, body)| {
                let ideal = geometry.wheel_state(
                    i,
                    [geometry.ideal_eccentric_angle(phi), turning],
                    [0.0, slow],
                );
                (at[body], ideal)
            })
            .collect();
        let angles = free.iter().map(|&body| at[body].angle);
        let places = poses.iter().flat_map(|(pose, _)| [pose.x, pose.y]);
        let velocities = poses.iter().flat_map(|(_, ideal)| [ideal.vx, ideal.vy]);
        let rates = std::iter::repeat_n(slow, free.len());
        angles
            .chain(places)
            .chain(rates)
            .chain(velocities)
            .collect()
    }
}

/// Removes damping, load changes and the start in equilibrium from a scene, and adds free-rolling sleeves.
fn still(scene: &mut Scene, load_n_m: f64) {
    let (drive, bearings) = (&mut scene.drive, &mut scene.bearings);
    drive.output_torque_n_m = load_n_m;
    drive.load_ramp_s = 0.0;
    drive.load_changes.clear();
    drive.start = Start::Kinematic;
    scene.contact.damping_n_s_m = 0.0;
    if let Some(eccentric) = &mut bearings.eccentric {
        eccentric.damping_n_s_m = Some(0.0);
    }
    if scene.contact.friction_coefficient > 0.0 {
        bearings.sleeve_friction_coefficient.get_or_insert(0.0);
        bearings.sleeve_bore_m.get_or_insert(BORE_M);
    }
}
