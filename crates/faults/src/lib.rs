//! Known faults that tests switch on to check that the checks detect them; and a count of expensive operations.
//!
//! The solver's crates call [`armed`] and [`factor`] at the place of each possible fault. Without the feature
//! `inject` both are constants, and the compiled program contains no trace of the faults. With the feature (tests only)
//! a fault acts in the thread that owns an `Armed`, as long as the `Armed` lives.

/// Programming fault that a check must detect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Friction drives the sliding instead of opposing it.
    FrictionSign,
    /// The constraints' accelerations leave out the centripetal terms (gamma of Eq. 9).
    DroppedGamma,
    /// The foot point stays where the search began, at the ideal mesh.
    StaleFoot,
    /// The step control lets a step grow right after a rejected one.
    ForgottenRejection,
    /// A step passes over a time at which the load jumps.
    PassedBreak,
    /// The Hertzian stiffness is 1 % too large.
    Stiffness,
    /// The last disc's eccentric is 0.1 mrad out of phase with its holes and its teeth.
    WheelPhase,
    /// An engine in Python gets contact loads that hold their value over four calls (MuJoCo only).
    FrozenLoads,
    /// An engine in Python gets loads that are not numbers, after a while.
    NanLoads,
    /// An engine in Python gets loads that are 1e9 times too large, after a while.
    HugeLoads,
}

impl Fault {
    /// Faults of the native solver that show in its results.
    pub const ALL: [Self; 7] = [
        Self::FrictionSign,
        Self::DroppedGamma,
        Self::StaleFoot,
        Self::ForgottenRejection,
        Self::PassedBreak,
        Self::Stiffness,
        Self::WheelPhase,
    ];
}

/// True if `fault` acts in this thread.
#[cfg(not(feature = "inject"))]
#[inline(always)]
pub const fn armed(_fault: Fault) -> bool {
    false
}

/// `wrong` where `fault` acts, otherwise 1.
#[cfg(not(feature = "inject"))]
#[inline(always)]
pub const fn factor(_fault: Fault, _wrong: f64) -> f64 {
    1.0
}

/// Notes that a gearbox was compiled.
#[cfg(not(feature = "inject"))]
#[inline(always)]
pub const fn compiled() {}

#[cfg(feature = "inject")]
pub use switch::{Armed, armed, compilations, compiled, factor};

#[cfg(feature = "inject")]
mod switch {
    use std::cell::Cell;
    use std::marker::PhantomData;
    use std::sync::atomic::{AtomicU64, Ordering};

    use crate::Fault;

    thread_local! {
        static ACTING: Cell<Option<Fault>> = const { Cell::new(None) };
    }

    /// True if `fault` acts in this thread.
    #[inline]
    pub fn armed(fault: Fault) -> bool {
        ACTING.get() == Some(fault)
    }

    /// `wrong` where `fault` acts, otherwise 1.
    #[inline]
    pub fn factor(fault: Fault, wrong: f64) -> f64 {
        if armed(fault) { wrong } else { 1.0 }
    }

    static COMPILED: AtomicU64 = AtomicU64::new(0);

    /// Notes that a gearbox was compiled.
    pub fn compiled() {
        COMPILED.fetch_add(1, Ordering::Relaxed);
    }

    /// Gearboxes compiled by this process so far.
    pub fn compilations() -> u64 {
        COMPILED.load(Ordering::Relaxed)
    }

    /// A fault acts in this thread until this is dropped.
    #[derive(Debug)]
    pub struct Armed(PhantomData<*const ()>);

    impl Armed {
        /// Lets `fault` act; the one before no longer does.
        pub fn with(fault: Fault) -> Self {
            ACTING.set(Some(fault));
            Self(PhantomData)
        }
    }

    impl Drop for Armed {
        fn drop(&mut self) {
            ACTING.set(None);
        }
    }
}
