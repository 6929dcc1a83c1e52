//! The contact forces of a whole gearbox as a function of its bodies' states.

pub use pinwheel_mbs::ContactEnergy;
use pinwheel_mbs::sliding::RateStage;
use pinwheel_mbs::{BodyState, Jacobian, Wrench};

use crate::Sleeve;

/// One pair of wheel and sleeve at its closest points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairContact {
    /// Wheel number (0, 1, ...), not a body index.
    pub wheel: usize,
    /// The sleeve.
    pub sleeve: Sleeve,
    /// W, the wheel's point closest to the sleeve centre; both forces act here. Ground frame, m.
    pub point: [f64; 2],
    /// n, unit vector from the sleeve centre P to W. Ground frame.
    pub normal: [f64; 2],
    /// delta, m: above 0 where they touch, below 0 a gap.
    pub penetration_m: f64,
    /// v_n = d(delta)/dt, m/s.
    pub normal_rate_m_s: f64,
    /// v_t along t = R90 n, sleeve relative to wheel, m/s.
    pub tangential_rate_m_s: f64,
    /// K, N/m^1.5.
    pub stiffness: f64,
    /// F_n >= 0, N: pushes the sleeve along -n, the wheel along +n.
    pub normal_force_n: f64,
    /// Force along t on the sleeve, N (opposite sign to v_t); the wheel takes its reaction.
    pub friction_force_n: f64,
    /// Force along t **at the sleeve's centre** on the sleeve, N, its reaction on the wheel at the same point:
    /// the part of an energy's gradient that lies along the profile; 0 for laws that are normal only.
    pub along_force_n: f64,
    /// The sleeve's centre P. Ground frame, m.
    pub centre: [f64; 2],
}

impl PairContact {
    /// Force on the sleeve in the ground frame, N. The wheel takes the opposite; all of it acts at W but
    /// [`along_force_n`](Self::along_force_n), which acts at the sleeve's centre.
    #[must_use]
    pub fn force_on_sleeve(&self) -> [f64; 2] {
        let [nx, ny] = self.normal;
        let (fn_, ft) = (
            self.normal_force_n,
            self.friction_force_n + self.along_force_n,
        );
        [-fn_ * nx - ft * ny, -fn_ * ny + ft * nx]
    }
}

/// Contact forces of a gearbox. `bodies` and `loads` are in [`Layout`](crate::Layout) order.
///
/// Implementations keep no history: the same states give the same bits.
pub trait ContactField: Send {
    /// Adds every body's contact load (force, and moment about the centre of mass) to `loads`.
    fn add_loads(&mut self, bodies: &[BodyState], loads: &mut [Wrench]);

    /// What the contacts store and dissipate at these states.
    fn energy(&mut self, bodies: &[BodyState]) -> ContactEnergy;

    /// Both at once.
    fn add_loads_with_energy(
        &mut self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
    ) -> ContactEnergy {
        self.add_loads(bodies, loads);
        self.energy(bodies)
    }

    /// Adds the contacts' moments about the pins of wheels and output (N m, by body) where every body stands where its joints
    /// hold it: only angles and rates are read. False, the default, and nothing was added, if this field has no such way.
    fn add_moments(&mut self, _bodies: &[BodyState], _moments: &mut [f64]) -> bool {
        false
    }

    /// From angles and rates alone, as [`add_moments`](Self::add_moments): writes the contacts' loads on all bodies to `loads` and
    /// adds their moments about the pins of wheels, output and input. `None`, the default, and nothing was touched, if this
    /// field has no such way.
    fn hold(
        &mut self,
        _bodies: &[BodyState],
        _moments: &mut [f64],
        _loads: &mut [Wrench],
    ) -> Option<ContactEnergy> {
        None
    }

    /// [`add_loads`](Self::add_loads), or where the state is `observed`
    /// [`add_loads_with_energy`](Self::add_loads_with_energy).
    fn add_asked_loads(
        &mut self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        observed: bool,
    ) -> Option<ContactEnergy> {
        if observed {
            return Some(self.add_loads_with_energy(bodies, loads));
        }
        self.add_loads(bodies, loads);
        None
    }

    /// The same with every body standing where its joints hold it, to `loads` of 0 on wheels and sleeves.
    fn add_held_loads(
        &mut self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        observed: bool,
    ) -> Option<ContactEnergy> {
        self.add_asked_loads(bodies, loads, observed)
    }

    /// Visits every touching pair (penetration > 0), wheel by wheel, external before internal.
    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact));

    /// One pair, touching or not; without contact its forces are 0 and its penetration is minus the gap.
    /// For looking at single pairs: away from contact it searches the whole curve.
    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact;

    /// F_n of a pair that [`touching`](Self::touching) found, N, if it closed at `rate` (m/s) at the same positions.
    fn normal_force(&self, pair: &PairContact, rate: f64) -> f64;

    /// Adds every load but friction and solves the friction of a stage, if this field has a way of its own;
    /// else `None`, and nothing was touched. See [`Forces::solve_friction`](pinwheel_mbs::Forces::solve_friction).
    fn solve_friction(
        &mut self,
        _bodies: &[BodyState],
        _loads: &mut [Wrench],
        _stage: &mut RateStage<'_>,
    ) -> Option<bool> {
        None
    }

    /// Adds to `slopes` how the moments about the pins change with the free angles, the free rates and the time, where the
    /// input turns at a constant rate; false, and nothing was added, if this field has no way to. See
    /// [`Forces::moment_slopes`](pinwheel_mbs::Forces::moment_slopes). Free are all bodies but the input, in their order,
    /// and without friction the output and the wheels alone.
    fn add_slopes(&mut self, _bodies: &[BodyState], _slopes: &mut Jacobian) -> bool {
        false
    }

    /// [`add_loads`](Self::add_loads) and [`add_slopes`](Self::add_slopes) at once; the answer is the latter's.
    fn add_loads_with_slopes(
        &mut self,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        slopes: &mut Jacobian,
    ) -> bool {
        self.add_loads(bodies, loads);
        self.add_slopes(bodies, slopes)
    }
}
