//! Native equations with changes of the model: columns at a given state, and the flow from it.

use std::cell::Cell;

use pinwheel_contact::PinLaw;
use pinwheel_gearbox::contacts::{ContactField, PairContact};
use pinwheel_gearbox::internals::GearForces;
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_mbs::integrators::{Segments, StepSettings, Stepper as _};
use pinwheel_mbs::{
    BodyState, Detail, Evaluation, Forces, Formulation as _, Jacobian, Mechanism, OdeSystem,
    Reduced, Structure, Wrench, add_pair,
};
use pinwheel_scene::load_profile::{self, LoadSegment};
use pinwheel_scene::{Drive, Layout, Scene, Start};

/// Gear, with the number of evaluations that judging a run has used and may use.
pub(super) struct Work<'a> {
    pub(super) gearbox: &'a Gearbox,
    /// Number of evaluations so far, and their limit.
    taken: Cell<u64>,
    most: Cell<u64>,
}

impl<'a> Work<'a> {
    /// Creates the work on a gear with at most `most` evaluations.
    pub(super) fn new(gearbox: &'a Gearbox, most: u64) -> Self {
        let [taken, most] = [0, most].map(Cell::new);
        Self {
            gearbox,
            taken,
            most,
        }
    }

    /// Returns the number of evaluations so far.
    pub(super) fn taken(&self) -> u64 {
        self.taken.get()
    }

    /// Returns the number of remaining evaluations.
    pub(super) fn left(&self) -> u64 {
        self.most.get().saturating_sub(self.taken())
    }

    /// Sets the limit of evaluations for the search for a cause.
    pub(super) fn allow(&self, most: u64) {
        self.most.set(most);
    }

    fn take(&self, evaluations: u64) {
        self.taken.set(self.taken() + evaluations);
    }
}

/// Change of the model, of size p.
pub(super) enum Change {
    /// Keys of the scene.
    Scene(Box<dyn Fn(&mut Scene, f64)>),
    /// Masses and moments of inertia.
    Mass(Box<dyn Fn(&mut Mechanism, f64)>),
    /// Forces of a pair.
    Pair(Box<dyn Fn(&mut PairContact, &PinLaw, f64)>),
    /// Moments of contact forces on the discs.
    Lever,
    /// Moments of the output pins computed with initial positions; holds the initial states of all bodies.
    Frozen(Vec<BodyState>),
    /// Load on the output.
    Load,
    /// Share of a disc in the driver torque.
    DriverShare(usize),
    /// Motion within a step.
    Step,
    /// Shift of the written columns, from one index to before another.
    Column(usize, usize),
}

impl Change {
    /// True if the change affects the motion.
    pub(super) fn moves(&self) -> bool {
        !matches!(self, Self::Column(..) | Self::DriverShare(_))
    }

    /// True if the change applies to single pairs.
    fn is_of_pairs(&self) -> bool {
        matches!(self, Self::Pair(_) | Self::Lever | Self::DriverShare(_))
    }

    fn is_step(&self) -> bool {
        matches!(self, Self::Step)
    }

    /// True if the change alters applied forces at a given state.
    fn is_force(&self) -> bool {
        !matches!(
            self,
            Self::Scene(_) | Self::Mass(_) | Self::Step | Self::Column(..)
        )
    }
}

/// Changes with their sizes; empty for the native model.
pub(super) type Changes<'a> = Vec<(&'a Change, f64)>;

/// Applied forces with changes.
struct Altered<'a> {
    inner: GearForces,
    /// Contact field for changes of pairs and for the native pairs.
    field: Option<ContactField>,
    layout: Layout,
    load: LoadSegment,
    drive: Drive,
    changes: Changes<'a>,
}

impl Altered<'_> {
    /// True if the forces are those of the gear without changes.
    fn is_plain(&self) -> bool {
        !self.changes.iter().any(|(change, _)| change.is_force())
    }
}

impl Forces for Altered<'_> {
    fn work_from_angles(&self) -> bool {
        self.is_plain() && self.inner.work_from_angles()
    }

    fn have_derivatives(&self) -> bool {
        self.is_plain() && self.inner.have_derivatives()
    }

    fn evaluate(&mut self, t: f64, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        if self.is_plain() {
            self.inner.evaluate(t, bodies, request);
        } else if let Some(loads) = request.loads.as_deref_mut() {
            self.apply(t, bodies, loads);
        }
        request.energy = None;
    }

    fn apply(&mut self, time: f64, bodies: &[BodyState], loads: &mut [Wrench]) {
        self.inner.apply(time, bodies, loads);
        let layout = self.layout;
        let wheels = layout.wheel_bodies().start;
        for &(change, by) in &self.changes {
            if let Change::Load = change {
                loads[Layout::OUTPUT].moment += by * self.load.torque(time);
            }
            if let Change::Frozen(start) = change {
                for pin in layout.internal_bodies() {
                    let [x, y] = [start[pin].x - bodies[pin].x, start[pin].y - bodies[pin].y];
                    let moment = x * loads[pin].fy - y * loads[pin].fx;
                    loads[Layout::OUTPUT].moment += by * moment;
                }
            }
            let Some(field) = self.field.as_mut().filter(|_| change.is_of_pairs()) else {
                continue;
            };
            let law = *field.law();
            field.touching(bodies, &mut |pair| {
                let (sleeve, wheel) = (layout.sleeve_body(pair.sleeve), wheels + pair.wheel);
                let centre = bodies[wheel];
                let [fx, fy] = pair.force_on_sleeve();
                match change {
                    Change::Pair(change) => {
                        let mut extra = *pair;
                        change(&mut extra, &law, by);
                        extra.normal_force_n -= pair.normal_force_n;
                        extra.friction_force_n -= pair.friction_force_n;
                        let along = extra.along_force_n - pair.along_force_n;
                        extra.along_force_n = 0.0;
                        let [nx, ny] = pair.normal;
                        let beside = [-along * ny, along * nx];
                        let of = [sleeve, wheel];
                        add_pair(loads, bodies, of, pair.point, extra.force_on_sleeve());
                        add_pair(loads, bodies, of, pair.centre, beside);
                    }
                    Change::Lever => {
                        let [x, y] = [pair.point[0] - centre.x, pair.point[1] - centre.y];
                        loads[wheel].moment -= by * (x * fy - y * fx);
                    }
                    Change::DriverShare(of) if *of == pair.wheel => {
                        loads[Layout::INPUT].moment -= by * (centre.x * fy - centre.y * fx);
                    }
                    _ => {}
                }
            });
        }
    }

    fn restart_at(&mut self, from: f64) {
        self.load = load_profile::piece_at(&self.drive, from);
        self.inner.restart_at(from);
    }
}

/// Equations of a gear with changes.
pub(super) struct Model<'a> {
    system: Reduced<Altered<'a>>,
    work: &'a Work<'a>,
    changes: Changes<'a>,
    /// True if the Jacobian is computed by differences. Changed forces need this; errors of runs computed alike then cancel.
    pub(super) by_differences: bool,
}

/// Tolerance of a step of the flow, as a share of the twist under load, without and with friction.
const TOLERANCES: [f64; 2] = [1e-9, 1e-8];
/// Tolerance for a run followed over many samples, where judgements need fewer digits.
const RUN: [f64; 2] = [1e-8, 1e-6];
/// Number of evaluations that a Jacobian counts as.
const JACOBIAN: u64 = 4;
/// Largest number of steps of the flow over one interval.
const STEPS: usize = 100;

impl<'a> Model<'a> {
    /// Creates the equations of a gear with changes; `None` if the changed gear is invalid.
    pub(super) fn new(work: &'a Work<'a>, changes: Changes<'a>) -> Option<Self> {
        let gearbox = work.gearbox;
        let is_key = |change: &Change| matches!(change, Change::Scene(_));
        let altered;
        let used = if changes.iter().any(|(change, _)| is_key(change)) {
            let scene = gearbox.scene.changed(|scene| {
                scene.drive.start = Start::Kinematic;
                for &(change, by) in &changes {
                    if let Change::Scene(set) = change {
                        set(scene, by);
                    }
                }
            });
            altered = Gearbox::after(Some(gearbox), &scene.ok()?).ok()?;
            &altered
        } else {
            gearbox
        };
        let mut mechanism = used.mechanism();
        for &(change, by) in &changes {
            if let Change::Mass(set) = change {
                set(&mut mechanism, by);
            }
        }
        // A contact field costs as much as some tens of evaluations.
        let is_seen = changes.is_empty() || changes.iter().any(|(change, _)| change.is_of_pairs());
        let forces = Altered {
            inner: GearForces::new(used).ok()?,
            field: is_seen.then(|| used.contact_field()).transpose().ok()?,
            layout: gearbox.layout,
            load: load_profile::piece_at(&used.scene.drive, 0.0),
            drive: used.scene.drive.clone(),
            changes: changes.clone(),
        };
        let system = native::reduced(used, mechanism, forces).ok()?;
        Some(Self {
            system,
            work,
            changes,
            by_differences: false,
        })
    }

    /// Returns 1 plus the sizes of all changes of a kind.
    fn factor(&self, of: fn(&Change) -> bool) -> f64 {
        let changes = self.changes.iter().filter(|(change, _)| of(change));
        1.0 + changes.map(|(_, by)| by).sum::<f64>()
    }

    /// Returns the bodies with angles of their own, in the order of y.
    pub(super) fn free(&self) -> &[usize] {
        self.system.free_bodies()
    }

    /// Returns the state at the scene's start.
    pub(super) fn start(&self) -> Vec<f64> {
        self.system.initial()
    }

    /// Evaluates the columns after the time at a state: driver torque, output torque, pin forces.
    pub(super) fn columns(&mut self, t: f64, y: &[f64]) -> Vec<f64> {
        let first = self.work.gearbox.layout.external_bodies().start;
        self.system.restart_at(t);
        let load = self.system.forces_mut().load.torque(t);
        let load = load * self.factor(|change| matches!(change, Change::Load));
        self.work.take(1);
        let observed = self.system.observe(t, y, Detail::Forces);
        let output = observed.moments.map_or(f64::NAN, |all| all[Layout::OUTPUT]) - load;
        let forces = observed.loads[first..].iter();
        let forces = forces.map(|load| load.fx.hypot(load.fy));
        let mut row: Vec<f64> = [observed.driver_torques[0], output]
            .into_iter()
            .chain(forces)
            .collect();
        for (change, by) in &self.changes {
            if let Change::Column(from, to) = **change {
                let written = row[from..to].iter_mut();
                written.for_each(|value| *value *= 1.0 + by);
            }
        }
        row
    }

    /// Evaluates the bodies at a state and the touching pairs.
    pub(super) fn pairs(&mut self, t: f64, y: &[f64]) -> (Vec<BodyState>, Vec<PairContact>) {
        self.work.take(2);
        let observed = self.system.observe(t, y, Detail::Everything);
        let bodies = observed.bodies.to_vec();
        let mut pairs = Vec::new();
        if let Some(field) = &mut self.system.forces_mut().field {
            field.touching(&bodies, &mut |pair| pairs.push(*pair));
        }
        (bodies, pairs)
    }

    /// Integrates the state `y` from `from` to `to`, s, by a converged method; `None` if it fails.
    pub(super) fn flow(&mut self, from: f64, y: &[f64], to: f64) -> Option<Vec<f64>> {
        self.follow(from, y, &[to])?.pop()
    }

    /// Returns the states at `times` from the state `y` at `from`, s, like [`flow`](Self::flow).
    pub(super) fn follow(&mut self, from: f64, y: &[f64], times: &[f64]) -> Option<Vec<Vec<f64>>> {
        let (first, last) = (*times.first()?, *times.last()?);
        let rough = self.work.gearbox.has_friction();
        let settings = StepSettings {
            step: 0.1 * (first - from).max((last - from) / times.len() as f64),
            tolerance: if times.len() > 1 { RUN } else { TOLERANCES }[usize::from(rough)],
        };
        let mut breaks = load_profile::breaks(&self.system.forces_mut().drive);
        breaks.retain(|&time| time < last);
        breaks.push(last);
        let method = if rough { "rodas5p" } else { "dop853" };
        let mut stepper = Segments::start(method, settings, from, y, &breaks)?;
        self.restart_at(from);
        let (mut at, mut steps) = (y.to_vec(), 0..STEPS * times.len());
        let reached = times.iter().map(|&time| {
            while time - stepper.time() > 1e-8 * settings.step {
                steps.next()?;
                stepper.step(self).ok()?;
            }
            match time > from {
                true => stepper.interpolate(self, time, &mut at),
                false => at.copy_from_slice(y),
            }
            Some(at.clone())
        });
        reached.collect()
    }
}

impl OdeSystem for Model<'_> {
    fn dimension(&self) -> usize {
        self.system.dimension()
    }

    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.work.take(1);
        self.system.derivative(t, y, dydt);
        let step = self.factor(Change::is_step);
        dydt.iter_mut().for_each(|value| *value *= step);
    }

    fn structure(&self) -> Structure {
        match self.factor(Change::is_step) {
            1.0 => self.system.structure(),
            _ => Structure::FirstOrder,
        }
    }

    fn jacobian(&mut self, t: f64, y: &[f64], jacobian: &mut Jacobian) -> bool {
        if self.by_differences || self.factor(Change::is_step) != 1.0 {
            return false;
        }
        self.work.take(JACOBIAN);
        self.system.jacobian(t, y, jacobian)
    }

    fn scale(&self, y: &[f64], scale: &mut [f64]) {
        self.system.scale(y, scale);
    }

    fn restart_at(&mut self, from: f64) {
        self.system.restart_at(from);
    }
}
