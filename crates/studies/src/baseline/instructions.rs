//! Instructions of a piece of work, where the machine counts them and lets us ask.
//!
//! Linux with a performance counter that the user may read (`perf_event_paranoid` at most 2); virtual machines
//! often have none. Without it everything else still works, and the reason is told.

/// A counter, or why there is none.
pub(super) struct Counter(Result<inner::Counter, String>);

impl Counter {
    /// Counts this thread's instructions in user space.
    pub(super) fn new() -> Self {
        Self(inner::Counter::new())
    }

    /// Why nothing is counted.
    pub(super) fn refusal(&self) -> Option<&str> {
        self.0.as_ref().err().map(String::as_str)
    }

    /// Does the work and counts.
    pub(super) fn count<T>(&mut self, work: impl FnOnce() -> T) -> (T, Option<u64>) {
        match &mut self.0 {
            Ok(counter) => counter.count(work),
            Err(_) => (work(), None),
        }
    }
}

#[cfg(all(target_os = "linux", feature = "instructions"))]
mod inner {
    use perf_event::events::Hardware;
    use perf_event::{Builder, Counter as Events};

    pub(super) struct Counter(Events);

    impl Counter {
        pub(super) fn new() -> Result<Self, String> {
            Builder::new(Hardware::INSTRUCTIONS)
                .exclude_kernel(true)
                .exclude_hv(true)
                .build()
                .map(Self)
                .map_err(|error| format!("the machine does not count instructions for us: {error}"))
        }

        pub(super) fn count<T>(&mut self, work: impl FnOnce() -> T) -> (T, Option<u64>) {
            let started = self.0.reset().and_then(|()| self.0.enable());
            let result = work();
            let stopped = self.0.disable();
            let count = match (started, stopped) {
                // A counter that shared its place with others has seen only a part.
                (Ok(()), Ok(())) => self.0.read_count_and_time().ok().and_then(|seen| {
                    (seen.time_enabled == seen.time_running && seen.count > 0).then_some(seen.count)
                }),
                _ => None,
            };
            (result, count)
        }
    }
}

#[cfg(not(all(target_os = "linux", feature = "instructions")))]
mod inner {
    pub(super) struct Counter;

    impl Counter {
        pub(super) fn new() -> Result<Self, String> {
            Err(
                "instructions are counted on Linux only, in builds with the feature `instructions`"
                    .to_owned(),
            )
        }

        pub(super) fn count<T>(&mut self, work: impl FnOnce() -> T) -> (T, Option<u64>) {
            (work(), None)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same work takes the same instructions, within the counter's own overhead, or a reason is given.
    #[test]
    fn counts_or_says_why() {
        let mut counter = Counter::new();
        let work = || (0..100_000_u64).map(std::hint::black_box).sum::<u64>();
        let (one, first) = counter.count(work);
        let (_, second) = counter.count(work);
        assert_eq!(one, 4_999_950_000);
        match (first, second) {
            (Some(a), Some(b)) => {
                assert!(a > 100_000 && a.abs_diff(b) < 1000, "{a} {b}");
            }
            _ => assert!(counter.refusal().is_none_or(|reason| !reason.is_empty())),
        }
    }
}
