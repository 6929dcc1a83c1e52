//! The load over time: what it begins with, and what `drive.load_changes` make of it.
//!
//! ```text
//! L(t) = before + (after - before) clamp((t - from)/ramp, 0, 1),    ramp = 0: after
//! ```
//! one [`LoadSegment`] for the start and one for each change. At a change without a ramp L jumps, and there it is two
//! loads: that of the piece that ends and that of the piece that begins. Integration therefore goes in segments from
//! one [`breaks`] to the next, each with one piece to both its ends.

use crate::{Drive, Scene, speed_profile};

/// Least distance of two changes, s: breaks stand apart by more than the rounding of times.
pub const APART_S: f64 = 1e-9;

/// The load between two changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadSegment {
    /// Start of the segment, s.
    pub from_s: f64,
    /// The load it begins with, N m.
    pub before_n_m: f64,
    /// The load it comes to, N m.
    pub after_n_m: f64,
    /// Over this time, s; 0: at once.
    pub ramp_s: f64,
}

impl LoadSegment {
    /// Torque on the output shaft at time `t` (s), N m, counter-clockwise positive; constant outside the ramp.
    #[must_use]
    pub fn torque(&self, t: f64) -> f64 {
        if self.ramp_s > 0.0 {
            let share = ((t - self.from_s) / self.ramp_s).clamp(0.0, 1.0);
            self.before_n_m + (self.after_n_m - self.before_n_m) * share
        } else {
            self.after_n_m
        }
    }

    /// End of the ramp, s.
    #[must_use]
    pub fn settled_s(&self) -> f64 {
        self.from_s + self.ramp_s
    }
}

/// The piece that a load begins with.
fn first_piece(drive: &Drive) -> LoadSegment {
    LoadSegment {
        from_s: 0.0,
        before_n_m: 0.0,
        after_n_m: drive.output_torque_n_m,
        ramp_s: drive.load_ramp_s,
    }
}

/// The pieces of a load in their order, the first from 0 on.
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

/// The piece that holds at time `t` (s); at a change the one that begins.
#[must_use]
pub fn piece_at(drive: &Drive, t: f64) -> LoadSegment {
    let changes = pieces(drive).skip(1);
    let begun = changes.take_while(|piece| !(piece.from_s > t));
    begun.last().unwrap_or_else(|| first_piece(drive))
}

/// Times at which the load or the input's speed jumps or bends, s, increasing: no step may pass over one.
///
/// Empty without changes: a ramp at the start alone is left to the step control, as ever, so that the results of
/// such scenes stay what they are to the last bit.
#[must_use]
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
        // A ramp that ends where its change begins, or where this one does up to rounding, is no break of its own.
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

/// Mean load from `from` to `to` (s, `to > from`), N m: what a step that takes one value for the load has to take.
#[must_use]
pub fn mean(drive: &Drive, from: f64, to: f64) -> f64 {
    let mut ends: Vec<f64> = breaks_of_load(drive);
    ends.retain(|&t| t > from && t < to);
    ends.push(to);
    let (mut start, mut impulse) = (from, 0.0);
    for end in ends {
        // Linear in between: the middle is the mean.
        let middle = 0.5 * (start + end);
        impulse += (end - start) * piece_at(drive, middle).torque(middle);
        start = end;
    }
    impulse / (to - from)
}

/// Returns the largest magnitude of the load over the run, N m: the reference of forces and stiffness.
#[must_use]
pub fn largest(drive: &Drive) -> f64 {
    pieces(drive).map(|p| p.after_n_m.abs()).fold(0.0, f64::max)
}

/// Time at which load and speed of a run reach their last values, s; `None` if neither changes before the run's end.
#[must_use]
pub fn last_change_s(scene: &Scene) -> Option<f64> {
    let end = scene.solver.duration_s;
    let began = pieces(&scene.drive).skip(1).filter(|p| p.from_s < end);
    let load = began.last().map(|piece| piece.settled_s().min(end));
    let mut ramps = scene.drive.speed_changes.iter().filter(|c| c.time_s < end);
    let speed = ramps.next_back().map(|c| (c.time_s + c.ramp_s).min(end));
    load.into_iter().chain(speed).reduce(f64::max)
}

/// The load with which a run of `scene` ends, N m.
#[must_use]
pub fn final_load(scene: &Scene) -> f64 {
    let end = scene.solver.duration_s;
    let began = pieces(&scene.drive).take_while(|p| p.from_s == 0.0 || p.from_s < end);
    began
        .last()
        .map_or(scene.drive.output_torque_n_m, |piece| piece.after_n_m)
}

/// Returns the time from which on load and speed of a run of `scene` are [`final_load`] and the
/// [final speed](speed_profile::final_rad_s), s.
#[must_use]
pub fn final_from_s(scene: &Scene) -> f64 {
    let ramp = first_piece(&scene.drive).settled_s();
    last_change_s(scene).map_or(ramp, |last| last.max(ramp))
}

/// Says which changes come too late for the run, if any do.
#[must_use]
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
