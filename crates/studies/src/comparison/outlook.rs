//! Remaining time of engines that share some threads: by the usual cost of each, then by its own progress reports.
//!
//! ```text
//!  usual cost x pace of those that reported ──> remaining time of all, if those without a report have little of it
//!  ──> if its end did not move by more than a third of it since half of the time, and is not near
//! ```

/// Largest share of a shown remaining time that may belong to engines without a report or stored costs of the scene. Usual costs
/// are costs of `paper`; in five live comparisons they were off by factors of 1 to 265.
const UNREPORTED: f64 = 0.3;
/// Least remaining time over the elapsed one that is shown. Differences, which follow the engines, took up to 0.07 of it.
const NEAR: f64 = 0.2;
/// Largest change of an end that is shown, over the remaining time.
const MOVED: f64 = 1.0 / 3.0;
/// Share of the time from which on an end must have been foretold.
const SINCE: f64 = 0.8;

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
        (since_s <= SINCE * now_s && moved <= MOVED * left).then_some(left)
    }
}

/// Expected work of an engine; times count from the start of all, s.
#[derive(Debug, Clone, Copy, Default)]
pub struct Outlook {
    /// Duration as far as known before the work.
    pub usual_s: f64,
    /// True if it was measured on the same scene.
    pub measured: bool,
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

/// Returns the remaining time of all on `jobs` threads at `now_s`; `None` where it is not known to within a factor of 1.5.
pub fn left_s(all: &[Outlook], jobs: usize, now_s: f64) -> Option<f64> {
    let known = all
        .iter()
        .filter_map(|one| Some((one.total_s()?, one.usual_s)));
    let (took_s, usual_s) = known.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let pace = if usual_s > 0.0 { took_s / usual_s } else { 1.0 };
    let [mut sum, mut unreported, mut longest] = [0.0_f64; 3];
    for one in all.iter().filter(|one| one.ended_s.is_none()) {
        let left = match one.reported_s {
            Some([at_s, left_s]) => (at_s + left_s - now_s).max(0.0),
            None => {
                let left = pace * one.usual_s;
                unreported += if one.measured { 0.0 } else { left };
                left
            }
        };
        sum += left;
        longest = longest.max(left);
    }
    let left = longest.max(sum / jobs as f64);
    (left > NEAR * now_s && unreported <= UNREPORTED * left).then_some(left)
}
