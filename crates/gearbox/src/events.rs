//! Events between two samples of a native run: entries of the energy account, breaks of the load, the sample.
//!
//! A break at the time of a sample comes first, so that the sample has the load that begins there. At a break between samples
//! the account needs an entry on both sides, and four entries in each segment for its cubics.

use crate::energy::EnergyAccount;

/// Distance, in steps, within which two times count as equal: times are products and sums of decimal numbers.
const SAME: f64 = 1e-9;
/// Least number of intervals of the account beside a break.
const BESIDE_A_BREAK: u64 = 3;

/// Event of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// Time of an entry of the energy account, s.
    Entry(f64),
    /// End of a segment, s: an entry with the ending load. The second time is the break of the scene.
    Break(f64, f64),
    /// Time of the sample, s.
    Sample(f64),
}

impl Event {
    /// Returns the time of the event, s.
    pub fn time(self) -> f64 {
        let (Self::Entry(time) | Self::Break(time, _) | Self::Sample(time)) = self;
        time
    }

    /// Writes to `list` all events after the sample at `from` up to the one at `to`, s. `breaks` increase.
    #[inline]
    pub fn list(list: &mut Vec<Self>, from: f64, to: f64, breaks: &[f64], step: f64) {
        let same = SAME * step;
        list.clear();
        let beside = |b: &f64| from - same <= *b && *b <= to + same;
        // For nearly every sample of a run it is the only event.
        if !EnergyAccount::is_short(from, to, step) || breaks.iter().any(beside) {
            Self::list_before(list, from, to, breaks, step);
        }
        list.push(Self::Sample(to));
    }

    /// Appends the events before the sample.
    fn list_before(list: &mut Vec<Self>, from: f64, to: f64, breaks: &[f64], step: f64) {
        let same = SAME * step;
        let (mut start, mut beside) = (from, breaks.iter().any(|b| (b - from).abs() <= same));
        // Intervals end at breaks, and the last one at the sample.
        let mut stretch = |list: &mut Vec<Self>, end: f64, at_break: bool| {
            let least = if beside || at_break {
                BESIDE_A_BREAK
            } else {
                1
            };
            // No entry is between a break at the sample's time and the sample.
            let least = if end - start > same { least } else { 0 };
            list.extend(EnergyAccount::between(start, end, step, least).map(Self::Entry));
            (start, beside) = (end, true);
        };
        for &at in breaks {
            if at > from + same && at <= to + same {
                let on_sample = (at - to).abs() <= same;
                let end = if on_sample { to } else { at };
                stretch(list, end, true);
                list.push(Self::Break(end, at));
                if !on_sample {
                    list.push(Self::Entry(end));
                }
            }
        }
        stretch(list, to, false);
    }
}
