//! Newton's method for the angles in balance.
//!
//! A disc's moment depends on its own angle and the output's, so with a_i = dM_i/d theta_i, b_i = dM_i/d psi,
//! c_i = dM_out/d theta_i and d = dM_out/d psi the step is
//!
//! ```text
//! (d - sum c_i b_i/a_i) d psi = -(M_out - sum c_i M_i/a_i),    d theta_i = -(M_i + b_i d psi)/a_i
//! ```
//! It begins beyond the free play, pressed in deeper than the load will press: forces that stiffen with the depth then lead
//! back without passing the balance, and all that will carry touches from the start.

use super::{ANGLE, Equilibrium, MOST_STEPS, Statics};
use crate::Layout;

/// Twist to begin with, in those of the load by the estimate for adaptive steps.
const TWIST: f64 = 2.0;
/// Steps that no longer shrink have ended at rounding if they are shorter than this, rad.
const ROUNDING: f64 = 1e-12;

/// Share of a step in the one before by which a disc gives itself away that will carry nothing: a force like delta^n falls to
/// it by 1 - 1/n a step, for as long as one likes. Of the laws n is from 10/9 to 5/2.
const IDLE: std::ops::Range<f64> = 0.05..0.75;
/// The output then moves less than this of what the disc does.
const ALONE: f64 = 1e-3;
/// Share of the last step up to which derivatives are kept: so they err by less than this, and take a step more at most.
const KEPT: f64 = 0.1;
/// Such a disc is turned to where its steps lead together, and by this more, so that it touches nothing.
const BEYOND: f64 = 1.001;

/// Number of the output among the free bodies; the discs follow.
const OUTPUT: usize = Layout::OUTPUT - 1;

impl Statics<'_> {
    /// Stiffness, N m/rad, and damping, N m s/rad, of the output about a balance, the input locked and the discs following.
    /// `None`: the contacts have no derivatives.
    ///
    /// With s the rate of change all derivatives are K + s D. Discs that follow are eliminated as in a step of Newton's method; what
    /// is left is taken to first order in s.
    pub fn compliance(&mut self, at: &Equilibrium) -> Option<[f64; 2]> {
        if self.gearbox.floats() {
            return self.floating_compliance(at);
        }
        let mut moments = vec![0.0; at.wheels.len()];
        self.moments_with_slopes(at.input, &at.wheels, at.output, &mut moments)?;
        let (k, d) = (self.derivatives.position.as_ref()?, &self.derivatives.rate);
        let (mut stiffness, mut damping) = (k.entry(OUTPUT, OUTPUT), d.entry(OUTPUT, OUTPUT));
        for hub in OUTPUT + 1..=OUTPUT + at.wheels.len() {
            let (to, from, own) = (
                k.entry(OUTPUT, hub),
                k.entry(hub, OUTPUT),
                k.entry(hub, hub),
            );
            if own == 0.0 {
                continue;
            }
            stiffness -= to * from / own;
            damping -= (d.entry(OUTPUT, hub) * from + to * d.entry(hub, OUTPUT)
                - to * from * d.entry(hub, hub) / own)
                / own;
        }
        Some([-stiffness, -damping])
    }

    /// Derivatives by the angles of the moments that contacts tell, `out` and `on_output` there, to four digits at least: by
    /// differences, in a quarter of the time that their own take. `None`: contacts tell none.
    #[doc(hidden)]
    pub fn differ(
        &mut self,
        phi: f64,
        wheels: &[f64],
        psi: f64,
        out: &[f64],
        on_output: f64,
    ) -> Option<()> {
        self.derivatives.clear();
        // Rounding of the angles weighs as much as the bend over the twist that the load makes.
        let step = (ANGLE * self.gearbox.error_scales().angle).sqrt();
        let mut angles = [&[psi], wheels].concat();
        let mut beside = vec![0.0; wheels.len()];
        for turned in 0..angles.len() {
            let angle = angles[turned];
            angles[turned] += step;
            let there = self.frictionless_moments(phi, &angles[1..], angles[0], &mut beside)?;
            let over = (angles[turned] - angle).recip();
            angles[turned] = angle;
            let (derivatives, of) = (self.derivatives.position.as_mut()?, OUTPUT + turned);
            derivatives.add(OUTPUT, of, (there - on_output) * over);
            for (i, (beside, here)) in beside.iter().zip(out).enumerate() {
                // Discs do not feel each other.
                if turned == 0 || turned == i + 1 {
                    derivatives.add(OUTPUT + 1 + i, of, (beside - here) * over);
                }
            }
        }
        Some(())
    }

    /// Newton's step of the output where `output` and `moments` are left, the discs' into `steps`. `None`: derivatives do not lead to
    /// a balance.
    fn step(&self, output: f64, moments: &[f64], steps: &mut [f64]) -> Option<f64> {
        let derivatives = self.derivatives.position.as_ref()?;
        let (mut slope, mut moment) = (derivatives.entry(OUTPUT, OUTPUT), output);
        let hubs = OUTPUT + 1..;
        for (hub, own) in hubs.clone().zip(moments) {
            let own_slope = derivatives.entry(hub, hub);
            // A disc that touches nothing carries nothing, wherever in its play it is.
            if own_slope == 0.0 && *own == 0.0 {
                continue;
            }
            let share = derivatives.entry(OUTPUT, hub) / own_slope;
            slope -= share * derivatives.entry(hub, OUTPUT);
            moment -= share * own;
        }
        let turned = -moment / slope;
        let mut falls = slope < 0.0;
        for ((hub, own), step) in hubs.zip(moments).zip(steps) {
            let own_slope = derivatives.entry(hub, hub);
            *step = 0.0;
            if own_slope != 0.0 {
                *step = -(own + derivatives.entry(hub, OUTPUT) * turned) / own_slope;
                falls &= own_slope < 0.0;
            }
        }
        falls.then_some(turned)
    }

    /// The output's angle in balance, the discs' in `wheels`, which holds the ideal mesh on entry. `None`: the contacts have no
    /// derivatives, or the way led out of the brackets.
    pub(super) fn newton(&mut self, phi: f64, load: f64, wheels: &mut [f64]) -> Option<f64> {
        let geometry = &self.gearbox.geometry;
        let twist = TWIST * self.gearbox.error_scales().angle;
        let wheel = geometry.wheel_play_rad + twist;
        let pressed = load.signum() * (wheel + twist + geometry.hole_play_rad);
        let psi = geometry.ideal_output_angle(phi) + pressed;
        for wheel_angle in wheels.iter_mut() {
            *wheel_angle += load.signum() * wheel;
        }
        self.newton_from(phi, load, wheels, psi, MOST_STEPS)
    }

    /// From the output's angle `psi` and those of `wheels`, in so many `steps` at most.
    pub(super) fn newton_from(
        &mut self,
        phi: f64,
        load: f64,
        wheels: &mut [f64],
        mut psi: f64,
        steps: usize,
    ) -> Option<f64> {
        let middle = self.gearbox.geometry.ideal_output_angle(phi);
        let ideal = self.ideal_wheels(phi);
        let (half_wheel, half) = self.brackets();
        let n = wheels.len();
        let (mut moments, mut turns, mut last_turns) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut last: Option<f64> = None;
        for _ in 0..steps {
            let told = self.frictionless_moments(phi, wheels, psi, &mut moments);
            let output = match told {
                Some(told) => told,
                None => self.moments_with_slopes(phi, wheels, psi, &mut moments)?,
            };
            let mut step = self.step(output + load, &moments, &mut turns);
            // Derivatives of a step before serve while steps shrink fast.
            let is_short =
                |step: &f64| last.is_some_and(|last| largest(*step, &turns) < KEPT * last);
            let is_kept = told.is_some() && step.as_ref().is_some_and(is_short);
            if told.is_some() && !is_kept {
                self.differ(phi, wheels, psi, &moments, output)?;
                step = self.step(output + load, &moments, &mut turns);
            }
            let step = step?;
            for (turn, last) in turns.iter_mut().zip(&mut last_turns) {
                let left = *turn / *last;
                *last = *turn;
                if !is_kept && IDLE.contains(&left) && step.abs() < ALONE * turn.abs() {
                    *turn *= BEYOND / (1.0 - left);
                }
            }
            psi += step;
            let mut inside = (psi - middle).abs() < half;
            for ((angle, turn), ideal) in wheels.iter_mut().zip(&turns).zip(&ideal) {
                *angle += turn;
                inside &= *turn == 0.0 || (*angle - ideal).abs() < half_wheel;
            }
            if !inside {
                return None;
            }
            let moved = largest(step, &turns);
            let ends = |last: f64| moved < ROUNDING && moved >= 0.5 * last;
            if moved < ANGLE || last.is_some_and(ends) {
                return Some(psi);
            }
            last = Some(moved);
        }
        None
    }
}

/// Largest step of all angles.
fn largest(output: f64, wheels: &[f64]) -> f64 {
    wheels
        .iter()
        .map(|step| step.abs())
        .fold(output.abs(), f64::max)
}
