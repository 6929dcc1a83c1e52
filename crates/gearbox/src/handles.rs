//! Handles for C programs: unique numbers in the form of addresses.
//!
//! A closed or invented handle refers to no value, never to freed memory; closing it again has no effect.
//!
//! ```
//! use pinwheel_gearbox::handles::Handles;
//!
//! static GEARS: Handles<&str> = Handles::new();
//! let handle = GEARS.open::<u8>("gear");
//! assert_eq!(GEARS.find(handle).as_deref(), Some(&"gear"));
//! assert!(GEARS.close(handle).is_some());
//! assert!(GEARS.find(handle).is_none() && GEARS.close(handle).is_none());
//! ```

use std::ptr;
use std::sync::{Arc, PoisonError, RwLock};

/// All values ever opened, by number - 1; closed ones leave an empty entry.
pub struct Handles<T>(RwLock<Vec<Option<Arc<T>>>>);

impl<T> Handles<T> {
    /// Creates an empty table.
    pub const fn new() -> Self {
        Self(RwLock::new(Vec::new()))
    }

    /// Stores a value and returns its handle, an address that is never read.
    pub fn open<P>(&self, held: T) -> *mut P {
        let mut all = self.0.write().unwrap_or_else(PoisonError::into_inner);
        all.push(Some(Arc::new(held)));
        ptr::without_provenance_mut(all.len())
    }

    /// Returns the value of a handle; `None` if it is not open.
    pub fn find<P>(&self, handle: *const P) -> Option<Arc<T>> {
        let all = self.0.read().unwrap_or_else(PoisonError::into_inner);
        all.get(handle.addr().checked_sub(1)?)?.clone()
    }

    /// Closes a handle and returns its value, if it was open. Threads that use the value keep it until they are done.
    pub fn close<P>(&self, handle: *const P) -> Option<Arc<T>> {
        let mut all = self.0.write().unwrap_or_else(PoisonError::into_inner);
        all.get_mut(handle.addr().checked_sub(1)?)?.take()
    }

    /// Closes all handles for whose values `which` is true.
    pub fn close_all(&self, which: impl Fn(&T) -> bool) {
        let mut all = self.0.write().unwrap_or_else(PoisonError::into_inner);
        for place in all.iter_mut() {
            if place.as_deref().is_some_and(&which) {
                *place = None;
            }
        }
    }
}

impl<T> Default for Handles<T> {
    fn default() -> Self {
        Self::new()
    }
}
