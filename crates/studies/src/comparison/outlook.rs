//! Remaining time of engines that share some threads, by what is known of each: its usual cost, then its own reports.
//!
//! ```text
//!  usual cost x pace of those that reported ──> remaining time of each, with a standard deviation ──> of all, if within a third
//!  ──> if it did not move by more than a third of itself since half of the time
//! ```

/// Relative standard deviation of a duration by the usual cost of an engine. Measured on three presets: 0.35 of its logarithm;
/// on a gear of `init` an engine took a tenfold.
const USUAL: f64 = 0.7;
/// Relative standard deviation of a reported remaining time.
const REPORTED: f64 = 0.2;
/// Largest relative standard deviation of a remaining time that is shown.
const SHOWN: f64 = 1.0 / 3.0;
/// Share of the time from which on an end must have been foretold.
const SINCE: f64 = 0.65;

/// Ends that were foretold, as times of the statement and of the end, s.
#[derive(Debug, Default)]
pub struct Foretold(Vec<[f64; 2]>);

impl Foretold {
    /// Returns a remaining time if the end stood still: since half of the time until `now_s`, by a third of that time.
    pub fn steady(&mut self, left_s: Option<f64>, now_s: f64) -> Option<f64> {
        let left = left_s?;
        self.0.push([now_s, now_s + left]);
        self.0.retain(|[at_s, _]| *at_s >= now_s / 2.0);
        let ends = || self.0.iter().map(|[_, end_s]| *end_s);
        let moved = ends().fold(0.0, f64::max) - ends().fold(f64::INFINITY, f64::min);
        let since_s = self.0[0][0];
        (since_s <= SINCE * now_s && moved <= SHOWN * left).then_some(left)
    }
}

/// Expected work of an engine; times count from the start of all, s.
#[derive(Debug, Clone, Copy, Default)]
pub struct Outlook {
    /// Duration as far as known before the work.
    pub usual_s: f64,
    /// Start of the work.
    pub begun_s: Option<f64>,
    /// Time of the latest report, and the remaining time in it.
    pub reported_s: Option<[f64; 2]>,
    /// End of the work.
    pub ended_s: Option<f64>,
}

impl Outlook {
    /// Creates the outlook of work with a usual duration, s.
    pub fn usual(usual_s: f64) -> Self {
        Self {
            usual_s,
            ..Self::default()
        }
    }

    /// Returns the duration as it is known now.
    fn total_s(&self) -> Option<f64> {
        let end_s = self.reported_s.map(|[at_s, left_s]| at_s + left_s);
        Some(self.ended_s.or(end_s)? - self.begun_s?)
    }
}

/// Returns the remaining time of all on `jobs` threads at `now_s`; `None` where it cannot be known to about a third.
pub fn left_s(all: &[Outlook], jobs: usize, now_s: f64) -> Option<f64> {
    let known = all.iter().filter_map(|one| Some((one.total_s()?, one)));
    let [mut took_s, mut usual_s, mut squares] = [0.0; 3];
    for (total_s, one) in known {
        took_s += total_s;
        usual_s += one.usual_s;
        squares += one.usual_s * one.usual_s;
    }
    // Without any report the speed of the machine is unknown as well.
    let (pace, doubt) = match usual_s > 0.0 {
        true => (took_s / usual_s, USUAL * squares.sqrt() / usual_s),
        false => (1.0, 2.0 * USUAL),
    };
    let (mut sum, mut square, mut common, mut longest) = (0.0, 0.0, 0.0, [0.0_f64; 2]);
    for one in all.iter().filter(|one| one.ended_s.is_none()) {
        let (left, own, shared) = match one.reported_s {
            Some([at_s, left_s]) => {
                let left = (at_s + left_s - now_s).max(0.0);
                (left, REPORTED * left, 0.0)
            }
            None => {
                let total = pace * one.usual_s;
                let since = one.begun_s.map_or(0.0, |begun_s| now_s - begun_s);
                let left = (total - since).max(total / 4.0);
                (left, USUAL * total, doubt * left)
            }
        };
        sum += left;
        square += own * own;
        common += shared;
        if left > longest[0] {
            longest = [left, own.hypot(shared)];
        }
    }
    let shared = [sum, square.sqrt().hypot(common)].map(|time| time / jobs as f64);
    let [left, off] = if longest[0] > shared[0] {
        longest
    } else {
        shared
    };
    (left > 0.0 && off <= SHOWN * left).then_some(left)
}
