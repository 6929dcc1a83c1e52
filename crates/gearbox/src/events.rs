//! Events between two samples of a native run: entries of the energy account, breaks of the load, the sample.
//!
//! A break that falls on a sample comes first, so that the sample sees the load that begins there. Where it falls
//! between samples, the account needs an entry on both its sides, and the cubics of its segments need four each.

use crate::energy::EnergyAccount;

/// Distance, in steps, within which two times are the same: times are products and sums of decimal numbers.
const SAME: f64 = 1e-9;
/// Intervals of the account beside a break.
const BESIDE_A_BREAK: u64 = 3;

/// Something due.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Event {
    /// An entry of the energy account, s.
    Entry(f64),
    /// The end of a segment, s: an entry with the load that ends. The second time is the break as the scene gives it.
    Break(f64, f64),
    /// The sample, s.
    Sample(f64),
}

impl Event {
    /// When, s.
    pub(crate) fn time(self) -> f64 {
        let (Self::Entry(time) | Self::Break(time, _) | Self::Sample(time)) = self;
        time
    }

    /// Puts all that is due after the sample at `from` up to the one at `to`, s, into `list`. `breaks` increase.
    #[inline]
    pub(crate) fn list(list: &mut Vec<Self>, from: f64, to: f64, breaks: &[f64], step: f64) {
        let same = SAME * step;
        list.clear();
        let beside = |b: &f64| from - same <= *b && *b <= to + same;
        // Nearly every sample of a run comes here for itself alone.
        if !EnergyAccount::is_short(from, to, step) || breaks.iter().any(beside) {
            Self::list_before(list, from, to, breaks, step);
        }
        list.push(Self::Sample(to));
    }

    /// Appends the events before the sample.
    fn list_before(list: &mut Vec<Self>, from: f64, to: f64, breaks: &[f64], step: f64) {
        let same = SAME * step;
        let (mut start, mut beside) = (from, breaks.iter().any(|b| (b - from).abs() <= same));
        // Stretches end at breaks, and one at the sample.
        let mut stretch = |list: &mut Vec<Self>, end: f64, at_break: bool| {
            let least = if beside || at_break {
                BESIDE_A_BREAK
            } else {
                1
            };
            // Nothing is left between a break on the sample and the sample.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn words(from: f64, to: f64, breaks: &[f64]) -> String {
        let word = |due: &Event| match due {
            Event::Entry(_) => 'e',
            Event::Break(..) => 'B',
            Event::Sample(_) => 's',
        };
        let mut list = vec![Event::Sample(f64::NAN)];
        Event::list(&mut list, from, to, breaks, 1e-5);
        assert!(list.windows(2).all(|p| p[0].time() <= p[1].time()));
        list.iter().map(word).collect()
    }

    #[test]
    fn breaks_come_between_entries_and_before_their_sample() {
        assert_eq!(words(0.0, 1e-4, &[]), "s");
        assert_eq!(words(0.0, 1e-3, &[2e-3]), "eeeeeeeees");
        assert_eq!(words(0.0, 1e-4, &[3e-5]), "eeBeees");
        // On the sample up to rounding, from either side; the next interval then begins at it.
        for at in [1e-4, 1e-4 + 1e-17, 1e-4 - 1e-17] {
            assert_eq!(words(0.0, 1e-4, &[at]), "eeBs");
            assert_eq!(words(1e-4, 2e-4, &[at]), "ees");
        }
        assert_eq!(words(0.0, 1e-4, &[3e-5, 3.1e-5]), "eeBeeeBeees");
        assert_eq!(words(0.0, 0.0, &[]), "s");
    }

    #[test]
    fn a_run_without_breaks_has_the_entries_it_always_had() {
        let mut due = Vec::new();
        Event::list(&mut due, 1e-4, 3.5e-4, &[], 1e-5);
        let times: Vec<f64> = due.into_iter().map(Event::time).collect();
        let plain = EnergyAccount::between(1e-4, 3.5e-4, 1e-5, 1);
        assert_eq!(times, plain.chain([3.5e-4]).collect::<Vec<_>>());
    }
}
