//! Load over time: its start and the changes of `drive.load_changes`.
//!
//! ```text
//! L(t) = before + (after - before) clamp((t - from)/ramp, 0, 1),    ramp = 0: after
//! ```
//! with one [`LoadSegment`] for the start and one for each change. At a change without a ramp L jumps, and has a value for
//! the ending and one for the beginning segment. Integration therefore goes from one [`breaks`] to the next, with one
//! segment for both ends.

use crate::{Drive, Scene, speed_profile};

/// Least distance of two changes, s: more than the rounding of times.
pub const APART_S: f64 = 1e-9;

/// Load between two changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadSegment {
    /// Start of the segment, s.
    pub from_s: f64,
    /// Load at the start, N m.
    pub before_n_m: f64,
    /// Load at the end of the ramp, N m.
    pub after_n_m: f64,
    /// Duration of the ramp, s; 0: a jump.
    pub ramp_s: f64,
}

impl LoadSegment {
    /// Returns the torque on the output shaft at time `t` (s), N m, counter-clockwise positive; constant outside the ramp.
    #[inline]
    pub fn torque(&self, t: f64) -> f64 {
        if self.ramp_s > 0.0 {
            let share = ((t - self.from_s) / self.ramp_s).clamp(0.0, 1.0);
            self.before_n_m + (self.after_n_m - self.before_n_m) * share
        } else {
            self.after_n_m
        }
    }

    /// Returns the end of the ramp, s.
    pub fn settled_s(&self) -> f64 {
        self.from_s + self.ramp_s
    }
}

/// Returns the first segment of a load.
fn first_piece(drive: &Drive) -> LoadSegment {
    LoadSegment {
        from_s: 0.0,
        before_n_m: 0.0,
        after_n_m: drive.output_torque_n_m,
        ramp_s: drive.load_ramp_s,
    }
}

/// Returns the segments of a load in their order, the first from 0 on.
pub fn pieces(drive: &Drive) -> impl Iterator<Item = LoadSegment> + '_ {
    let mut before_n_m = drive.output_torque_n_m;
    let changes = drive.load_changes.iter().map(move |change| {
        let piece = LoadSegment {
            from_s: change.time_s,
            before_n_m,
            after_n_m: change.output_torque_n_m,
            ramp_s: change.ramp_s,
        };
        before_n_m = change.output_torque_n_m;
        piece
    });
    std::iter::once(first_piece(drive)).chain(changes)
}

/// Returns the segment at time `t` (s); at a change the one that begins.
pub fn piece_at(drive: &Drive, t: f64) -> LoadSegment {
    let changes = pieces(drive).skip(1);
    let begun = changes.take_while(|piece| !(piece.from_s > t));
    begun.last().unwrap_or_else(|| first_piece(drive))
}

/// Returns the times of jumps and kinks of the load or the input's speed, s, increasing: no step may pass over one.
///
/// Empty without changes: a ramp at the start alone is left to the step control, so that results of such scenes stay the
/// same to the last bit.
pub fn breaks(drive: &Drive) -> Vec<f64> {
    let mut times = breaks_of_load(drive);
    let motions = speed_profile::motions(drive);
    times.extend(motions.iter().skip(1).map(|motion| motion.from_s));
    times.sort_unstable_by(f64::total_cmp);
    // Of times that differ by rounding the later one stays, at which both have changed.
    times.dedup_by(|later, kept| {
        let same = *later - *kept < APART_S;
        if same {
            *kept = *later;
        }
        same
    });
    times
}

/// Returns the breaks of the load alone.
fn breaks_of_load(drive: &Drive) -> Vec<f64> {
    if drive.load_changes.is_empty() {
        return Vec::new();
    }
    let mut times: Vec<f64> = Vec::with_capacity(2 * drive.load_changes.len() + 1);
    for piece in pieces(drive) {
        // The end of a ramp is no break if its change begins there, or the next one does up to rounding.
        if times.last().is_some_and(|t| piece.from_s - t < APART_S) {
            times.pop();
        }
        times.extend([piece.from_s, piece.settled_s()]);
        if piece.ramp_s < APART_S {
            times.pop();
        }
    }
    times.retain(|&t| t > 0.0);
    times
}

/// Returns the mean load from `from` to `to` (s, `to > from`), N m, for a step with a constant load.
pub fn mean(drive: &Drive, from: f64, to: f64) -> f64 {
    let mut ends: Vec<f64> = breaks_of_load(drive);
    ends.retain(|&t| t > from && t < to);
    ends.push(to);
    let (mut start, mut impulse) = (from, 0.0);
    for end in ends {
        // The load is linear in between, so the middle is the mean.
        let middle = 0.5 * (start + end);
        impulse += (end - start) * piece_at(drive, middle).torque(middle);
        start = end;
    }
    impulse / (to - from)
}

/// Returns the largest magnitude of the load over the run, N m: the reference of forces and stiffness.
pub fn largest(drive: &Drive) -> f64 {
    pieces(drive).map(|p| p.after_n_m.abs()).fold(0.0, f64::max)
}

/// Time at which load and speed of a run reach their last values, s; `None` if neither changes before the run's end.
pub fn last_change_s(scene: &Scene) -> Option<f64> {
    let end = scene.solver.duration_s;
    let began = pieces(&scene.drive).skip(1).filter(|p| p.from_s < end);
    let load = began.last().map(|piece| piece.settled_s().min(end));
    let mut ramps = scene.drive.speed_changes.iter().filter(|c| c.time_s < end);
    let speed = ramps.next_back().map(|c| (c.time_s + c.ramp_s).min(end));
    load.into_iter().chain(speed).reduce(f64::max)
}

/// Returns the load at the end of a run of `scene`, N m.
pub fn final_load(scene: &Scene) -> f64 {
    let end = scene.solver.duration_s;
    let began = pieces(&scene.drive).take_while(|p| p.from_s == 0.0 || p.from_s < end);
    began
        .last()
        .map_or(scene.drive.output_torque_n_m, |piece| piece.after_n_m)
}

/// Returns the time from which load and speed of a run of `scene` are [`final_load`] and the [final
/// speed](speed_profile::final_rad_s), s.
pub fn final_from_s(scene: &Scene) -> f64 {
    let ramp = first_piece(&scene.drive).settled_s();
    last_change_s(scene).map_or(ramp, |last| last.max(ramp))
}

/// Returns a message on changes that come after the end of the run, if any.
pub fn unreached(scene: &Scene) -> Option<String> {
    let (end, drive) = (scene.solver.duration_s, &scene.drive);
    let loads = drive.load_changes.iter().map(|c| c.time_s);
    let speeds = drive.speed_changes.iter().map(|c| c.time_s);
    let late = loads.clone().chain(speeds.clone()).filter(|t| *t >= end);
    let first = late.clone().reduce(f64::min)?;
    Some(format!(
        "{} of {} changes of load and speed come when the run is over: the first at {first} s, the run ends at {end} s.",
        late.count(),
        loads.len() + speeds.len()
    ))
}
