//! The one pool of threads: they take the next piece of work until there is none.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Does `work(state, k)` for k = 0 .. `count` on `threads` threads, this one among them, each with a `state` of its own.
///
/// Pieces begin in their order. One that returns false lets no other begin; those that run come to their end.
pub(crate) fn each<S>(
    threads: usize,
    count: usize,
    state: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, usize) -> bool + Sync,
) {
    let (next, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
    let take = || {
        let mut mine = state();
        while !stopped.load(Ordering::Relaxed) {
            let k = next.fetch_add(1, Ordering::Relaxed);
            if k >= count {
                break;
            }
            if !work(&mut mine, k) {
                stopped.store(true, Ordering::Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads.clamp(1, count.max(1)) {
            scope.spawn(take);
        }
        take();
    });
}

/// The lock, also after another thread panicked: what it holds is whole after every piece.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_piece_once_and_none_after_a_stop() {
        for threads in [0, 1, 2, 7] {
            let done = Mutex::new(Vec::new());
            each(
                threads,
                20,
                || (),
                |(), k| {
                    lock(&done).push(k);
                    true
                },
            );
            let mut done = done.into_inner().unwrap();
            done.sort_unstable();
            assert_eq!(done, (0..20).collect::<Vec<_>>());
            let begun = AtomicUsize::new(0);
            each(
                threads,
                1000,
                || (),
                |(), k| {
                    begun.fetch_add(1, Ordering::Relaxed);
                    k != 3
                },
            );
            assert!(begun.into_inner() <= 4 + 7, "{threads}");
        }
    }
}
