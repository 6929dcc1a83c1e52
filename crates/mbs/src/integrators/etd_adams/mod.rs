//! Exponential Adams: a multistep method that is exact for the system's linear part and extrapolates the remainder.
//!
//! ```text
//! y' = L y + g(t),    g = f - L y at the last evaluations
//! predict:  y* = phi_0(h L) y + h sum_{j<K} Gamma_j(h L) D^j g_n,        D^j: backward differences
//! evaluate: f(t + h, y*),    g_n+1 = f - L y*
//! correct:  y+ = y* + h Gamma_K D^K g_n+1,      error = h (Gamma_K+1 - Gamma_K) D^(K+1) g_n+1
//! Gamma_j = int_0^1 exp((1 - s) h L) s (s + 1) ... (s + j - 1)/j! ds
//! ```
//! [Norsett 1969; Calvo & Palencia, Numer. Math. 102 (2006) 367; Hochbruck & Ostermann, Acta Numerica 19 (2010) 209, 2.6]. L is
//! the system's own Jacobian, updated from time to time. Oscillations that L describes are exact at any phase within a step.
//! Only the remainder of f limits the step, mainly by contacts that open and close. A step costs one evaluation; an explicit
//! Runge-Kutta method of order five takes six for a slightly longer step.
//!
//! Every segment begins with Dormand-Prince, whose dense output gives the history. Dormand-Prince takes over again if steps
//! fall below a fiftieth of its own, and makes all steps of a system without a Jacobian.
//!
//! Steps end at the times that the caller requests next ([`Stepper::set_stop_time`]): the step to a sample and the sample share
//! one evaluation. The sample is then the predicted state, unless its error is too large. Steps change by factors of two (and
//! to fractions of an uneven distance to the next sample), so that all processors take equal steps.

pub(crate) mod columns;
pub(crate) mod history;
mod multistep;
pub(crate) mod propagator;

use serde::{Deserialize, Serialize};

use self::columns::{Factors, Judge, copy, padded};
use self::multistep::{Multistep, ORDERS, SAME, TERMS};
use super::clock::Method as _;
use super::dopri5::{Dense, Dopri5};
use super::{
    ADAPTIVE, Family, MethodInfo, StepCounts, StepError, Stepper, restored, saved, short_step,
};
use crate::OdeSystem;
use crate::jacobian::Jacobian;

pub(super) const INFO: MethodInfo = MethodInfo {
    name: "etd-adams",
    summary: "exponential Adams, exact for the linear part, steps from the tolerance, one evaluation a step: for gears without \
                  friction",
    order: 4,
    family: Family::Exponential,
    // Steps end at samples, so that all runs of a refinement take equal steps in smooth intervals. Errors reached 3.3
    // tolerances where these runs agreed (28 random gears; a gear of three discs differed by 1.4 from foreign engines).
    shared_error: 4.0,
    // Doubling of the step for ten times the tolerance.
    step_power: std::f64::consts::LOG10_2,
    ..ADAPTIVE
};

/// Errors in tolerances: above the first a step is rejected, above the second the next step is halved; the expected error of a
/// doubled step must be below the third.
const REJECT: f64 = 3.0;
const HALVE: f64 = 1.0;
const GROW: f64 = 0.5;
/// Largest distance of predicted from corrected states, in tolerances, at which they serve as samples.
const SHOWN: f64 = 10.0;
/// Steps between checks of the Jacobian, and the relative change from which a new one is used: updating the linear part at
/// every step makes the method unstable at the higher order.
const LOOK: u64 = 16;
const MOVED: f64 = 0.1;
/// Share of the permitted change below which the interval between checks doubles, up to the second constant; shorter steps
/// reset it.
const CALM: f64 = 0.5;
const RAREST_LOOK: u64 = 128;
/// Permitted change of the Jacobian if springs turn with the mechanism: this share over (|h| |L|)^2, at most the share above.
/// On needles `paper` takes 4335 evaluations with as many Jacobians, with an error of 3e-4 of the driver's torque; the share
/// above took 5105 for 1.3e-3.
const TURNING: f64 = 0.05;
/// Longest step, as |h| |L| with the size of [`Linear`], half as much again if a new Jacobian is stiffer. The second applies to
/// springs that turn, whose Jacobian is updated often.
const TURNS: f64 = 3.0;
const TURNING_TURNS: f64 = 6.0;
/// Longest step of any springs, as |h| |L|, where the tolerance is [`COARSE`] or looser. Rounding of the exponential's series
/// is 1e-11 there.
const COARSE_TURNS: f64 = 12.0;
const COARSE: f64 = 1e-6;
/// Shortest step, relative to Dormand-Prince's: a closing contact takes few such steps, which cost less than a restart.
const LEAST: f64 = 0.02;
/// Number of steps of Dormand-Prince before the first attempt; doubled after a failure, up to the second constant.
const WAIT: u64 = 4;
const LONGEST_WAIT: u64 = 64;
/// Distance to the next requested time, in steps of Dormand-Prince, beyond which the method begins before that time.
const FAR: f64 = 8.0;
/// Number of steps after which an attempt counts as a success.
const SUCCESS: u64 = 16;

/// Number of stored steps of Dormand-Prince.
const PIECES: usize = 8;

/// Run with steps from a tolerance.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EtdAdams {
    #[serde(skip, default = "pulp::Arch::new")]
    arch: pulp::Arch,
    tolerance: f64,
    time: f64,
    y: Vec<f64>,
    /// Next requested time, s; infinite: none.
    stop_time: f64,
    /// Longest step, s.
    longest: f64,
    counts: StepCounts,
    /// Dormand-Prince, and its last steps, the newest first.
    start: Dopri5,
    pieces: Vec<Dense>,
    known_pieces: usize,
    /// Steps of Dormand-Prince since it began, and their number before the next attempt.
    begun: u64,
    wait: u64,
    /// True while the multistep method has a history.
    runs: bool,
    /// True if the system has no Jacobian.
    refused: bool,
    multistep: Option<Box<Multistep>>,
    /// Distance of the points, and the desired next step, s.
    h: f64,
    wanted: f64,
    /// Typical step of Dormand-Prince, s.
    explicit: f64,
    /// True if the last step ended at a requested time.
    at_stop: bool,
    /// Steps since the multistep method took over, and since the last check of the Jacobian.
    taken: u64,
    since_look: u64,
    look_after: u64,
    /// Index into [`ORDERS`] of the order of the next step.
    which: usize,
    /// Predicted state, at which f was evaluated, padded, and true if it serves as the sample.
    predicted: Vec<f64>,
    shown: bool,
    /// f of all rows, and errors; padded.
    f: Vec<f64>,
    /// Scales of the components' errors, then the inverses of the permitted errors; padded.
    scales: Vec<f64>,
    weights: Vec<f64>,
}

impl EtdAdams {
    /// Starts at (t, y) with a first step `h` (s) and a relative `tolerance` per step.
    pub fn new(h: f64, tolerance: f64, t: f64, y: &[f64]) -> Self {
        let zeros = vec![0.0; padded(y.len())];
        Self {
            arch: pulp::Arch::new(),
            tolerance,
            time: t,
            y: y.to_vec(),
            stop_time: f64::INFINITY,
            longest: f64::INFINITY,
            counts: StepCounts::default(),
            start: Dopri5::new(h, tolerance, t, y),
            pieces: vec![Dense::new(y.len()); PIECES],
            known_pieces: 0,
            begun: 0,
            wait: WAIT,
            runs: false,
            refused: false,
            multistep: None,
            h,
            wanted: f64::INFINITY,
            explicit: 0.0,
            at_stop: false,
            taken: 0,
            since_look: 0,
            look_after: LOOK,
            which: 0,
            predicted: zeros.clone(),
            shown: false,
            f: zeros.clone(),
            scales: vec![f64::NAN; zeros.len()],
            weights: zeros,
        }
    }

    /// Returns the longest step, as |h| |L|.
    fn most_turns(&self, system: &dyn OdeSystem) -> f64 {
        match system.has_turning_springs() {
            _ if self.tolerance >= COARSE => COARSE_TURNS,
            true => TURNING_TURNS,
            false => TURNS,
        }
    }

    /// Returns the number of equal steps, none longer than `most`, to the next requested time; 0 if none is requested.
    fn count_to_stop(&self, most: f64) -> f64 {
        let distance = self.stop_time - self.time;
        if distance.is_finite() && distance > SAME * most {
            (distance / most - SAME).ceil().max(1.0)
        } else {
            0.0
        }
    }

    /// Takes over from Dormand-Prince if its last steps reach back far enough and the system has a Jacobian.
    fn take_over(&mut self, system: &mut dyn OdeSystem) -> bool {
        // The method begins at a requested time, or if the next one is far.
        let begins = self.at_stop || self.stop_time - self.time > FAR * self.pieces[0].taken;
        let due = !self.refused && self.begun >= self.wait;
        if !due || self.known_pieces < 2 || !begins {
            return false;
        }
        let mut multistep = match self.multistep.take() {
            Some(mut multistep) => {
                multistep.jacobian.clear();
                system.jacobian(self.time, &self.y, &mut multistep.jacobian);
                multistep
            }
            None => {
                let mut jacobian = Jacobian::new(&system.structure(), self.y.len());
                if !system.jacobian(self.time, &self.y, &mut jacobian) {
                    self.refused = true;
                    return false;
                }
                Box::new(Multistep::new(system, jacobian, &self.y))
            }
        };
        self.counts.jacobians += 1;
        multistep.newer.read(&multistep.jacobian);
        self.runs = self.begin(&mut multistep, system);
        self.multistep = Some(multistep);
        self.runs
    }

    /// Computes the history from the last steps of Dormand-Prince, at whose end the newest Jacobian was evaluated.
    fn begin(&mut self, multistep: &mut Multistep, system: &mut dyn OdeSystem) -> bool {
        let order = ORDERS[0];
        let oldest = &self.pieces[self.known_pieces - 1];
        let span = self.time - (oldest.end - oldest.taken);
        let steps = self.pieces[..self.known_pieces]
            .iter()
            .map(|piece| piece.taken);
        let explicit = steps.fold(0.0, f64::max);
        let most = self
            .wanted
            .min(self.longest)
            .min(explicit)
            .min(span / order as f64)
            .min(self.most_turns(system) / multistep.newer.size);
        if !(most > LEAST * explicit) {
            self.wait += self.begun;
            return false;
        }
        let count = self.count_to_stop(most);
        let h = if count > 0.0 {
            (self.stop_time - self.time) / (count as u64).next_power_of_two() as f64
        } else {
            short_step(most)
        };
        let (first, n) = (multistep.linear.first, self.y.len());
        for k in 0..=order {
            let time = self.time - k as f64 * h;
            let point = &mut multistep.history.points[k];
            if k == 0 {
                point.y[..n].copy_from_slice(&self.y);
            } else {
                let pieces = self.pieces[..self.known_pieces].iter();
                let reaches = |piece: &&Dense| time >= piece.end - piece.taken - SAME * h;
                let Some(piece) = pieces.clone().find(reaches) else {
                    return false;
                };
                piece.interpolate(time, &mut point.y[..n]);
            }
            system.derivative(time, &point.y[..n], &mut self.f[..n]);
            point.f[..n - first].copy_from_slice(&self.f[first..n]);
        }
        self.counts.evaluations += order as u64 + 1;
        multistep.history.count = order + 1;
        multistep.renew(self.time, h, &self.y);
        (self.h, self.wanted, self.explicit) = (h, h, explicit);
        (self.taken, self.since_look, self.which) = (0, 0, 0);
        self.look_after = LOOK;
        true
    }

    /// Returns the step to take, s: the desired one, or one that divides the distance to the next requested time.
    fn fitting(&self, multistep: &Multistep) -> f64 {
        let distance = self.stop_time - self.time;
        let is_next = (distance - self.h).abs() <= SAME * self.h;
        if is_next && self.wanted >= self.h && self.h <= self.longest {
            return self.h;
        }
        let room = multistep.history.count > 2 * ORDERS[self.which];
        let largest = if self.wanted > self.h && !room {
            self.h
        } else {
            self.wanted
        };
        let fit = |most: f64| {
            let count = self.count_to_stop(most);
            if count > 0.0 {
                (self.stop_time - self.time) / count
            } else {
                most
            }
        };
        let h = fit(largest.min(self.longest));
        let alike = |a: f64, b: f64| (a - b).abs() <= 10.0 * SAME * b;
        let doubled = alike(h, 2.0 * self.h);
        // Between one and two steps there is no history.
        let h = if h > self.h && !doubled {
            fit(self.h.min(self.longest))
        } else {
            h
        };
        if alike(h, self.h) { self.h } else { h }
    }

    /// Evaluates the Jacobian from time to time, and adopts it if the stiffness has changed.
    fn look(&mut self, system: &mut dyn OdeSystem) {
        self.since_look += 1;
        let Some(multistep) = &mut self.multistep else {
            return;
        };
        if self.since_look < self.look_after {
            return;
        }
        let look_after = std::mem::replace(&mut self.look_after, LOOK);
        self.since_look = 0;
        multistep.jacobian.clear();
        self.counts.jacobians += 1;
        if system.jacobian(self.time, &self.y, &mut multistep.jacobian) {
            multistep.newer.read(&multistep.jacobian);
            let moved = multistep.newer.distance(&multistep.linear);
            let most = match system.has_turning_springs() {
                true => MOVED.min(TURNING / (self.h * multistep.linear.size).powi(2)),
                false => MOVED,
            };
            if moved > most {
                multistep.renew(self.time, self.h, &self.y);
            } else if moved < CALM * most {
                self.look_after = (2 * look_after).min(RAREST_LOOK);
            }
        }
    }

    /// Updates the weights of errors for the last evaluated state.
    fn weigh(&mut self, system: &dyn OdeSystem) {
        let n = self.y.len();
        system.scale(&self.predicted[..n], &mut self.f[..n]);
        for ((scale, known), weight) in self.f[..n]
            .iter()
            .zip(&mut self.scales)
            .zip(&mut self.weights)
        {
            // Most scales are unchanged, and a quotient would take as long as everything else here.
            if *scale != *known {
                (*known, *weight) = (*scale, (self.tolerance * *scale).recip());
            }
        }
    }

    /// Makes one step of the multistep method; false if Dormand-Prince must continue.
    fn multistep_step(&mut self, system: &mut dyn OdeSystem) -> bool {
        self.look(system);
        let Some(mut multistep) = self.multistep.take() else {
            return false;
        };
        let done = loop {
            let h = self.fitting(&multistep);
            if h < LEAST * self.explicit {
                break false;
            }
            if h * multistep.linear.size > 1.5 * self.most_turns(system) {
                self.wanted = 0.5 * h;
                continue;
            }
            if !self.space(&mut multistep, h) {
                break false;
            }
            if let Some(done) = self.attempt(&mut multistep, system) {
                break done;
            }
        };
        self.multistep = Some(multistep);
        done
    }

    /// Changes the distance of the points to `h`; false if that is not possible.
    fn space(&mut self, multistep: &mut Multistep, h: f64) -> bool {
        if h > self.h {
            multistep.history.thin();
        } else if h < self.h {
            if !multistep.respace(self.time, &self.y, self.h, h) {
                return false;
            }
            self.look_after = LOOK;
        }
        if multistep.history.count <= ORDERS[self.which] {
            self.which = 0;
        }
        self.h = h;
        true
    }

    /// Tries a step of the points' distance. True: accepted; false: the method must end; `None`: a shorter step is needed.
    fn attempt(&mut self, multistep: &mut Multistep, system: &mut dyn OdeSystem) -> Option<bool> {
        let (which, h) = (self.which, self.h);
        let order = ORDERS[which];
        let lands = ((self.stop_time - self.time) / h - 1.0).abs() < 1e-3;
        let end = if lands { self.stop_time } else { self.time + h };
        let matrices = multistep.matrices(h);
        multistep.history.differ(order);
        let Multistep {
            linear,
            line,
            history,
            steps,
            x,
            product,
            ..
        } = multistep;
        let step = &steps[matrices];
        line.measure(self.time, &self.y, history.x_mut());
        let known = history.known(order);
        self.arch
            .dispatch(step.propagator.predict(linear, known, x, product));
        copy(x, &mut self.predicted);
        line.restore(end, &mut self.predicted);
        let (predicted, f) = (
            &self.predicted[..linear.dimension],
            &mut self.f[..linear.dimension],
        );
        system.derivative_at_end(end, predicted, lands, f);
        self.counts.evaluations += 1;
        let point = history.push();
        copy(&self.predicted, &mut point.y);
        point.set(&f[linear.first..], product);
        let known = history.count;
        history.differ(known.min(TERMS));
        self.weigh(system);
        let factors = |k: usize| -> Option<Factors<'_>> {
            let order = ORDERS[k];
            (order + 1 < known).then(|| (&step.errors[k], 0, history.difference(order + 1)))
        };
        let change = history.difference(order);
        let change = step.propagator.term(linear, order, change);
        let squares = self.arch.dispatch(Judge {
            factors: [factors(0), factors(1), Some(change)],
            weights: &self.weights,
            out: &mut self.f,
        });
        // Mean squares of errors, in tolerances, and of corrections.
        let squares = squares.map(|square| square / self.y.len() as f64);
        let error = squares[which];
        if !(error <= REJECT * REJECT) {
            self.counts.rejected += 1;
            history.pop();
            (self.wanted, self.which) = (0.5 * h, 0);
            return (!error.is_finite()).then_some(false);
        }
        for ((y, predicted), change) in self.y.iter_mut().zip(&self.predicted).zip(&self.f) {
            *y = predicted + change;
        }
        self.shown = squares[2] <= SHOWN * SHOWN;
        self.time = end;
        self.taken += 1;
        self.counts.steps += 1;
        system.project(self.time, &mut self.y);
        self.which = usize::from(squares[1] < squares[0]);
        let error = squares[self.which];
        let gain = (4 << ORDERS[self.which]) as f64;
        let may_grow = 2.0 * h * linear.size <= self.most_turns(system);
        self.wanted = if error > HALVE * HALVE {
            0.5 * h
        } else if may_grow && error * gain * gain < GROW * GROW {
            2.0 * h
        } else {
            h
        };
        Some(true)
    }

    /// Makes one step of Dormand-Prince.
    fn explicit_step(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        let stepper: &mut dyn Stepper = &mut self.start;
        stepper.shorten(self.longest);
        let distance = self.stop_time - self.time;
        let same = SAME * stepper.next_step();
        let waits = !self.refused && self.begun + 1 >= self.wait;
        if (waits || self.begun == 0) && distance > same {
            // The multistep method begins at a requested time, and a failed step, which went no farther, is replaced.
            stepper.shorten(distance);
        }
        stepper.step(system)?;
        self.time = stepper.time();
        self.at_stop = (self.time - self.stop_time).abs() <= same;
        self.y.copy_from_slice(stepper.state());
        self.begun += 1;
        self.pieces.rotate_right(1);
        self.pieces[0].copy_from(self.start.dense());
        self.known_pieces = (self.known_pieces + 1).min(PIECES);
        Ok(())
    }
}

impl Stepper for EtdAdams {
    fn step(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError> {
        if !self.runs {
            self.take_over(system);
        }
        if self.runs {
            if self.multistep_step(system) {
                return Ok(());
            }
            self.runs = false;
            // A short trial is repeated later.
            self.wait = if self.taken < SUCCESS {
                (2 * self.wait).min(LONGEST_WAIT)
            } else {
                WAIT
            };
            self.begun = 0;
            self.known_pieces = 0;
            self.wanted = f64::INFINITY;
            let h = 0.5 * self.explicit;
            self.start.restart(h, self.time, &self.y);
        }
        self.explicit_step(system)
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn state(&self) -> &[f64] {
        &self.y
    }

    fn next_step(&self) -> f64 {
        match &self.multistep {
            Some(multistep) if self.runs => self.fitting(multistep),
            _ => self.start.clock().h,
        }
    }

    fn shorten(&mut self, longest: f64) {
        self.longest = longest;
    }

    fn set_stop_time(&mut self, time: f64) {
        self.stop_time = time;
    }

    fn interpolate(&mut self, system: &mut dyn OdeSystem, t: f64, y: &mut [f64]) {
        let is_here = (t - self.time).abs() <= SAME * self.h;
        match &mut self.multistep {
            Some(multistep) if self.runs && self.taken > 0 => {
                if is_here {
                    y.copy_from_slice(if self.shown {
                        &self.predicted[..y.len()]
                    } else {
                        &self.y
                    });
                } else {
                    multistep.state_at(self.time, &self.y, self.h, t - self.time, y);
                    system.project(t, y);
                }
            }
            _ => self.start.interpolate(system, t, y),
        }
    }

    fn evaluated_state(&self) -> Option<&[f64]> {
        match self.runs && self.taken > 0 {
            true => self.shown.then(|| &self.predicted[..self.y.len()]),
            false => Stepper::evaluated_state(&self.start),
        }
    }

    fn counts(&self) -> StepCounts {
        self.counts + self.start.clock().counts
    }

    fn save(&self) -> Vec<u8> {
        saved(self)
    }

    fn restore(&mut self, bytes: &[u8]) -> bool {
        restored(bytes).map(|saved| *self = saved).is_some()
    }
}
