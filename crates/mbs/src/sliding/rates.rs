//! A friction stage handed to forces that know a faster way through their own contacts.

/// One implicit stage in the free rates of a mechanism, all slices in the order of
/// [`Reduced::free_bodies`](crate::Reduced::free_bodies).
#[derive(Debug)]
pub struct RateStage<'a> {
    /// The implicit share of the step, s; 0 to evaluate only.
    pub a: f64,
    /// v* on entry, the solution of `v = v* + a i(v)` on return, rad/s.
    pub rates: &'a mut [f64],
    /// Lumped moments of inertia, kg m^2.
    pub inertia: &'a [f64],
    /// Receives what the change of the normal forces does, 0 on entry, rad/s^2.
    pub explicit: &'a mut [f64],
    /// A guess of what friction does on entry (see [`SlidingStage::solve`](super::SlidingStage::solve)), receives what it
    /// does, rad/s^2.
    pub implicit: &'a mut [f64],
    /// Receives the Newton steps it took, 0 on entry.
    pub newton_steps: u64,
}
