//! Pair of disc and pin, and the loops over all pairs of a gear.

use pinwheel_contact::PinLaw;
use pinwheel_mbs::{BodyState, ContactEnergy, Evaluation};

use crate::Sleeve;

/// Pair of disc and pin at its closest points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairContact {
    /// Disc number (0, 1, ...), not a body index.
    pub wheel: usize,
    /// Pin of the pair.
    pub sleeve: Sleeve,
    /// Contact point W, the disc's point closest to the pin centre, where both forces act. Ground frame, m.
    pub point: [f64; 2],
    /// Unit vector n from the pin centre P to W. Ground frame.
    pub normal: [f64; 2],
    /// Penetration delta, m: above 0 in contact, below 0 a gap. For a sleeve on a bending pin it includes contact and bending.
    pub penetration_m: f64,
    /// Closing speed v_n = d(delta)/dt, m/s.
    pub normal_rate_m_s: f64,
    /// Sliding speed v_t along t = R90 n, pin relative to disc, m/s.
    pub tangential_rate_m_s: f64,
    /// Stiffness K, N/m^1.5.
    pub stiffness: f64,
    /// Normal force F_n >= 0, N: pushes the pin along -n, the disc along +n.
    pub normal_force_n: f64,
    /// Force along t on the pin, N (opposite sign to v_t); its reaction acts on the disc.
    pub friction_force_n: f64,
    /// Force along t **at the pin's centre** on the pin, N, with its reaction on the disc at the same point: the part of an
    /// energy's gradient along the profile; 0 for laws with a normal force only.
    pub along_force_n: f64,
    /// Pin centre P. Ground frame, m.
    pub centre: [f64; 2],
    /// Stiffness of the pin, or of its seat, in series with the contact, N/m; `None`: rigid.
    pub pin_n_m: Option<f64>,
    /// Share of the pair in the energy of a pin that several discs bend together, beyond what each bends alone, J.
    pub shared_j: f64,
}

impl PairContact {
    /// Returns the force on the pin in the ground frame, N; the opposite force acts on the disc. The force acts at W, except
    /// for [`along_force_n`](Self::along_force_n), which acts at the pin's centre.
    #[must_use]
    pub fn force_on_sleeve(&self) -> [f64; 2] {
        let [nx, ny] = self.normal;
        let (fn_, ft) = (
            self.normal_force_n,
            self.friction_force_n + self.along_force_n,
        );
        [-fn_ * nx - ft * ny, -fn_ * ny + ft * nx]
    }

    /// Returns F_n of a touching pair, N, for a closing rate `rate` (m/s) at equal positions.
    #[must_use]
    pub fn normal_force_at(&self, law: &PinLaw, rate: f64) -> f64 {
        self.observed(law, rate)[0]
    }

    /// Returns the normal force at `rate` (m/s) and at rest, N, and the stored energy, J.
    fn observed(&self, law: &PinLaw, rate: f64) -> [f64; 3] {
        law.on(self.pin_n_m)
            .observed(self.stiffness, self.penetration_m, rate)
    }

    /// Adds the pair's stored energy and dissipated power.
    pub(super) fn add_energy(&self, law: &PinLaw, sum: &mut ContactEnergy) {
        let [_, elastic, stored] = self.observed(law, 0.0);
        sum.stored_j += stored + self.shared_j;
        sum.damping_w += (self.normal_force_n - elastic) * self.normal_rate_m_s;
        sum.contact_friction_w -= self.friction_force_n * self.tangential_rate_m_s;
    }
}

/// Contacts of all discs and pins of a gear. `bodies` and loads are in [`Layout`](crate::Layout) order.
///
/// Implementations keep no history: equal states give equal bits.
pub trait PairField: Send {
    /// See [`Forces::work_from_angles`](pinwheel_mbs::Forces::work_from_angles).
    fn work_from_angles(&self) -> bool;

    /// See [`Forces::have_derivatives`](pinwheel_mbs::Forces::have_derivatives).
    fn have_derivatives(&self) -> bool;

    /// See [`ContactField::evaluate`](super::ContactField::evaluate).
    fn evaluate(&mut self, bodies: &[BodyState], request: &mut Evaluation<'_>);

    /// Visits every touching pair (penetration > 0), disc by disc, external before internal.
    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact));

    /// Returns one pair, touching or not; without contact its forces are 0 and its penetration is minus the gap.
    /// Away from contact it searches the entire curve.
    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact;
}
