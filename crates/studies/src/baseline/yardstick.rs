//! A fixed little workload whose time stands for the machine's speed.
//!
//! Times of runs are given as multiples of it, measured in the same process on the same thread, so that they can be
//! compared from one machine to the next (roughly: to some ten per cent, see `limits`).

use std::hint::black_box;

use cpu_time::ThreadTime;

/// Oscillators and steps of the workload: about a millisecond.
const OSCILLATORS: usize = 16;
const STEPS: usize = 8000;

/// CPU time of the workload on this thread, s.
#[must_use]
pub(super) fn measure() -> f64 {
    let start = ThreadTime::now();
    black_box(work(black_box(1.0)));
    start.elapsed().as_secs_f64()
}

/// Pendulums by the symplectic Euler method: sines, roots, divisions, multiplications.
fn work(scale: f64) -> f64 {
    let mut angles = [0.0; OSCILLATORS];
    let mut rates: [f64; OSCILLATORS] = std::array::from_fn(|k| scale * (0.5 + 0.1 * k as f64));
    for _ in 0..STEPS {
        for (angle, rate) in angles.iter_mut().zip(&mut rates) {
            let drag = (1.0 + *rate * *rate).sqrt();
            *rate -= 1e-3 * f64::sin(*angle) / drag;
            *angle += 1e-3 * *rate;
        }
    }
    angles.iter().sum()
}
