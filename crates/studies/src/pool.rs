//! Pool of threads that take numbered pieces of work in order.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Returns the results of `work(state, k)` for k = 0 .. `count` on `threads` threads including this one, each with its own
/// `state`; or the first error.
///
/// Pieces begin in order. After an error no new piece begins, and running pieces finish.
pub fn map<S, T: Send, E: Send>(
    threads: usize,
    count: usize,
    state: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, usize) -> Result<T, E> + Sync,
) -> (Vec<Option<T>>, Option<E>) {
    let next = AtomicUsize::new(0);
    let none: Vec<Option<T>> = (0..count).map(|_| None).collect();
    let results = Mutex::new((none, None));
    let take = || {
        let mut mine = state();
        while lock(&results).1.is_none() {
            let k = next.fetch_add(1, Ordering::Relaxed);
            if k >= count {
                break;
            }
            let result = work(&mut mine, k);
            let (all, first) = &mut *lock(&results);
            match result {
                Ok(result) => all[k] = Some(result),
                Err(error) => _ = first.get_or_insert(error),
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads.clamp(1, count.max(1)) {
            scope.spawn(take);
        }
        take();
    });
    results.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// Locks a mutex, also after another thread panicked: its content is consistent after every piece.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
