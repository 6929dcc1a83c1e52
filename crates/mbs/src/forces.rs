//! Forces on the bodies of a mechanism.

use crate::sliding::Contact;
use crate::{BodyId, BodyState, ContactEnergy, Jacobian, Variable, Wrench};

/// Reliability of the bodies' poses in an evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pose {
    /// Poses may violate the joints by the integrator's error.
    #[default]
    Any,
    /// Every body has the pose and velocity that its joints prescribe. Forces that work [from angles](Forces::work_from_angles)
    /// read only angles and rates, and the positions of bodies without a joint.
    Prescribed,
}

/// Numbers of the bodies' free coordinates in a Jacobian.
#[derive(Debug, Clone, Default)]
pub struct Coordinates {
    angles: Vec<Option<usize>>,
    places: Vec<Option<usize>>,
}

impl Coordinates {
    /// Numbers the angles of the `turning` bodies among `bodies`, then x and y of each of the `floating` bodies.
    pub fn new(bodies: usize, turning: &[BodyId], floating: &[BodyId]) -> Self {
        let (mut angles, mut places) = (vec![None; bodies], vec![None; bodies]);
        for (k, &body) in turning.iter().enumerate() {
            angles[body] = Some(k);
        }
        for (k, &body) in floating.iter().enumerate() {
            places[body] = Some(turning.len() + 2 * k);
        }
        Self { angles, places }
    }

    /// Numbers the angle of a body as that of the `carrier` to which a driver fixes it.
    pub(crate) fn hold(&mut self, body: BodyId, carrier: BodyId) {
        self.angles[body] = self.angles[carrier];
    }

    /// Returns the number of a body's angle, if it is free, or that of its carrier's if fixed to it.
    pub fn angle(&self, body: BodyId) -> Option<usize> {
        self.angles[body]
    }

    /// Returns the number of a body's x, if it is free; y has the next.
    pub fn place(&self, body: BodyId) -> Option<usize> {
        self.places[body]
    }
}

/// Jacobian to which forces add their derivatives. Rows of free angles receive those of moments about the pins, loads of
/// carried bodies included; rows of positions those of forces on bodies without a joint.
#[derive(Debug)]
pub struct Derivatives<'a> {
    /// Derivatives with respect to coordinates (N m/rad), rates (N m s/rad) and time (N m/s), and those of forces.
    pub jacobian: &'a mut Jacobian,
    /// Rows and columns of the bodies.
    pub coordinates: &'a Coordinates,
}

impl Derivatives<'_> {
    /// Adds the derivatives `by` the variables of a force or moment to its row, if that is of a free coordinate.
    #[inline]
    pub fn add(&mut self, row: Option<usize>, variables: &[Variable], by: &[f64]) {
        let Some(row) = row else { return };
        for (&variable, &value) in variables.iter().zip(by) {
            self.jacobian.add(row, variable, value);
        }
    }
}

/// Outputs to which an evaluation of the forces adds; `None` if not requested.
#[derive(Debug, Default)]
pub struct Evaluation<'a> {
    /// Reliability of the bodies' poses.
    pub pose: Pose,
    /// Loads on all bodies, in order: ground frame, N and N m about the centre of mass; 0 on entry with a prescribed pose.
    pub loads: Option<&'a mut [Wrench]>,
    /// True if only loads on bodies without a joint are needed, because `moments` cover all others.
    pub floating_alone: bool,
    /// Moments about the pins by body, N m, loads of carried bodies included, of forces that work [from
    /// angles](Forces::work_from_angles). They are those of the free bodies of [`Reduced`](crate::Reduced); if `loads` are
    /// requested too, also those of the driven bodies.
    pub moments: Option<&'a mut [f64]>,
    /// Derivatives, of forces that [have them](Forces::have_derivatives).
    pub derivatives: Option<Derivatives<'a>>,
    /// Energy of the contacts; 0 on entry if requested, `None` afterwards if these forces do not provide it.
    pub energy: Option<ContactEnergy>,
}

impl<'a> Evaluation<'a> {
    /// Requests loads alone.
    pub fn of_loads(loads: &'a mut [Wrench]) -> Self {
        Self {
            loads: Some(loads),
            ..Self::default()
        }
    }

    /// Requests moments alone, of bodies in the poses that their joints prescribe.
    pub fn of_moments(moments: &'a mut [f64]) -> Self {
        Self {
            pose: Pose::Prescribed,
            moments: Some(moments),
            ..Self::default()
        }
    }

    /// Requests derivatives alone.
    pub fn of_derivatives(jacobian: &'a mut Jacobian, coordinates: &'a Coordinates) -> Self {
        Self {
            derivatives: Some(Derivatives {
                jacobian,
                coordinates,
            }),
            ..Self::default()
        }
    }

    /// Requests the energy of the contacts, too.
    #[must_use]
    pub fn with_energy(mut self) -> Self {
        self.energy = Some(ContactEnergy::default());
        self
    }
}

/// Applied loads as a function of time and of all bodies' states.
pub trait Forces {
    /// Adds every applied load to `loads` (body order of the mechanism).
    fn apply(&mut self, time: f64, bodies: &[BodyState], loads: &mut [Wrench]);

    /// True if moments, and loads with them, follow from angles and rates alone. Called once.
    fn work_from_angles(&self) -> bool {
        false
    }

    /// True if these forces have derivatives. Called once.
    fn have_derivatives(&self) -> bool {
        false
    }

    /// Adds to the outputs of `request`, which never exceeds what these forces [work](Self::work_from_angles) and
    /// [have](Self::have_derivatives).
    ///
    /// By default forces provide their loads alone.
    fn evaluate(&mut self, t: f64, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        request.energy = None;
        if let Some(loads) = request.loads.as_deref_mut() {
            self.apply(t, bodies, loads);
        }
    }

    /// Adds every applied load except the friction of contacts, and lists these contacts.
    ///
    /// By default there is no separate friction.
    fn apply_without_friction(
        &mut self,
        time: f64,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        contacts: &mut Vec<Contact>,
    ) {
        contacts.clear();
        self.apply(time, bodies, loads);
    }

    /// Switches to the loads of the segment that begins at `from` (s), which apply up to and including its end, until the next
    /// call; see [`OdeSystem::restart_at`](crate::OdeSystem::restart_at). By default there are no segments.
    fn restart_at(&mut self, _from: f64) {}

    /// Returns the normal force (N) of contact `index` of the last list for another closing rate `rate` (m/s, along its normal,
    /// first body against second). `listed`: force in the list.
    fn normal_force(&self, _index: usize, listed: f64, _rate: f64) -> f64 {
        listed
    }
}
