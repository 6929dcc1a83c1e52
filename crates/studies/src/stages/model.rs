//! The native equations with one change: columns at a given state, and the flow from it.

use pinwheel_gearbox::contacts::{ContactField, PairContact};
use pinwheel_gearbox::internals::GearForces;
use pinwheel_gearbox::{Gearbox, native};
use pinwheel_mbs::integrators::{Segments, StepSettings, Stepper as _};
use pinwheel_mbs::{
    BodyState, Detail, Forces, Formulation as _, Mechanism, OdeSystem, Reduced, Structure, Wrench,
    add_pair,
};
use pinwheel_scene::{Layout, Scene, Start, load_profile};

/// A change of the model, of size p.
pub(super) enum Change {
    /// Nothing is changed.
    None,
    /// Keys of the scene.
    Scene(Box<dyn Fn(&mut Scene, f64)>),
    /// Masses and moments of inertia.
    Mass(Box<dyn Fn(&mut Mechanism, f64)>),
    /// Forces of a pair beside its own where p = 1, N: normal, friction, and along the profile. The pair's elastic force, N,
    /// is given.
    Pair(Box<dyn Fn(&PairContact, f64) -> [f64; 3]>),
    /// Moments of contact forces on the discs.
    Lever,
    /// The load on the output.
    Load,
    /// Share of a disc in the driver's torque.
    DriverShare(usize),
    /// Motion within a step.
    Step,
    /// Columns as they are written: from one place to before another.
    Column(usize, usize),
}

/// Applied forces with a change of size `by`.
struct Altered<'a> {
    inner: GearForces,
    field: ContactField,
    layout: Layout,
    load: load_profile::LoadSegment,
    drive: &'a pinwheel_scene::Drive,
    change: &'a Change,
    by: f64,
}

impl Forces for Altered<'_> {
    fn apply(&mut self, time: f64, bodies: &[BodyState], loads: &mut [Wrench]) {
        self.inner.apply(time, bodies, loads);
        let (layout, change, by) = (self.layout, self.change, self.by);
        let wheels = layout.wheel_bodies().start;
        if let Change::Load = change {
            loads[Layout::OUTPUT].moment += by * self.load.torque(time);
        }
        if !matches!(
            change,
            Change::Pair(_) | Change::Lever | Change::DriverShare(_)
        ) {
            return;
        }
        let law = *self.field.law();
        self.field.touching(bodies, &mut |pair| {
            let (sleeve, wheel) = (layout.sleeve_body(pair.sleeve), wheels + pair.wheel);
            match change {
                Change::Pair(force) => {
                    let [normal, friction, along] = force(pair, pair.normal_force_at(&law, 0.0));
                    let extra = PairContact {
                        normal_force_n: by * normal,
                        friction_force_n: by * friction,
                        along_force_n: 0.0,
                        ..*pair
                    };
                    let [nx, ny] = pair.normal;
                    let beside = [-by * along * ny, by * along * nx];
                    let bodies_of = [sleeve, wheel];
                    add_pair(
                        loads,
                        bodies,
                        bodies_of,
                        pair.point,
                        extra.force_on_sleeve(),
                    );
                    add_pair(loads, bodies, bodies_of, pair.centre, beside);
                }
                Change::Lever => {
                    let [fx, fy] = pair.force_on_sleeve();
                    let centre = bodies[wheel];
                    let [x, y] = [pair.point[0] - centre.x, pair.point[1] - centre.y];
                    loads[wheel].moment -= by * (x * fy - y * fx);
                }
                Change::DriverShare(of) if *of == pair.wheel => {
                    let [fx, fy] = pair.force_on_sleeve();
                    let centre = bodies[wheel];
                    loads[Layout::INPUT].moment -= by * (centre.x * fy - centre.y * fx);
                }
                _ => {}
            }
        });
    }

    fn restart_at(&mut self, from: f64) {
        self.load = load_profile::piece_at(self.drive, from);
        self.inner.restart_at(from);
    }
}

/// Equations of a gear with a change.
pub(super) struct Model<'a> {
    system: Reduced<Altered<'a>>,
    gearbox: &'a Gearbox,
    change: &'a Change,
    by: f64,
}

/// Error of a step of the flow, as a share of the twist under load: without friction and with it.
const TOLERANCES: [f64; 2] = [1e-10, 1e-8];
/// Steps of the flow over one interval; more are no flow.
const STEPS: usize = 4000;

impl<'a> Model<'a> {
    /// Returns the equations of a gear with a change of size `by`; `None` if there is no such gear.
    pub(super) fn new(gearbox: &'a Gearbox, change: &'a Change, by: f64) -> Option<Self> {
        let altered;
        let used = match change {
            Change::Scene(set) => {
                let scene = gearbox.scene.changed(|scene| {
                    scene.drive.start = Start::Kinematic;
                    set(scene, by);
                });
                altered = Gearbox::after(Some(gearbox), &scene.ok()?).ok()?;
                &altered
            }
            _ => gearbox,
        };
        let mut mechanism = used.mechanism();
        if let Change::Mass(set) = change {
            set(&mut mechanism, by);
        }
        let forces = Altered {
            inner: GearForces::new(used).ok()?,
            field: used.contact_field().ok()?,
            layout: gearbox.layout,
            load: load_profile::piece_at(&gearbox.scene.drive, 0.0),
            drive: &gearbox.scene.drive,
            change,
            by,
        };
        let system = native::reduced(used, mechanism, forces).ok()?;
        Some(Self {
            system,
            gearbox,
            change,
            by,
        })
    }

    /// Bodies with angles of their own, in the order of y.
    pub(super) fn free(&self) -> &[usize] {
        self.system.free_bodies()
    }

    /// State at the scene's start.
    pub(super) fn start(&self) -> Vec<f64> {
        self.system.initial()
    }

    /// Columns after the time at a state: driver's torque, output's torque, forces of the pins.
    pub(super) fn columns(&mut self, t: f64, y: &[f64]) -> Vec<f64> {
        let drive = &self.gearbox.scene.drive;
        let piece = load_profile::piece_at(drive, t);
        let more = matches!(self.change, Change::Load);
        let load = piece.torque(t) * (1.0 + if more { self.by } else { 0.0 });
        let first = self.gearbox.layout.external_bodies().start;
        self.system.restart_at(t);
        let seen = self.system.observe(t, y, Detail::Forces);
        let output = seen.moments.map_or(f64::NAN, |all| all[Layout::OUTPUT]) - load;
        let forces = seen.loads[first..].iter();
        let forces = forces.map(|load| load.fx.hypot(load.fy));
        let mut row: Vec<f64> = [seen.driver_torques[0], output]
            .into_iter()
            .chain(forces)
            .collect();
        if let Change::Column(from, to) = *self.change {
            row[from..to]
                .iter_mut()
                .for_each(|value| *value *= 1.0 + self.by);
        }
        row
    }

    /// Pairs that touch at the state of the last columns.
    pub(super) fn pairs(&mut self, t: f64, y: &[f64]) -> (Vec<BodyState>, Vec<PairContact>) {
        let bodies = self
            .system
            .observe(t, y, Detail::Everything)
            .bodies
            .to_vec();
        let mut pairs = Vec::new();
        let field = &mut self.system.forces_mut().field;
        field.touching(&bodies, &mut |pair| pairs.push(*pair));
        (bodies, pairs)
    }

    /// State at `to` from the state `y` at `from`, s, by a converged method; `None` where it does not come through.
    pub(super) fn flow(&mut self, from: f64, y: &[f64], to: f64) -> Option<Vec<f64>> {
        let rough = self.gearbox.has_friction();
        let settings = StepSettings {
            step: 0.1 * (to - from),
            tolerance: TOLERANCES[usize::from(rough)],
        };
        let mut breaks = load_profile::breaks(&self.gearbox.scene.drive);
        breaks.retain(|&time| time < to);
        breaks.push(to);
        let method = if rough { "rodas5p" } else { "dop853" };
        let mut stepper = Segments::start(method, settings, from, y, &breaks)?;
        self.restart_at(from);
        for _ in 0..STEPS {
            stepper.step(self).ok()?;
            if to - stepper.time() <= 1e-9 * (to - from) {
                return Some(stepper.state().to_vec());
            }
        }
        None
    }
}

impl OdeSystem for Model<'_> {
    fn dimension(&self) -> usize {
        self.system.dimension()
    }

    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.system.derivative(t, y, dydt);
        if let Change::Step = self.change {
            dydt.iter_mut().for_each(|value| *value *= 1.0 + self.by);
        }
    }

    fn structure(&self) -> Structure {
        match self.change {
            Change::Step => Structure::FirstOrder,
            _ => self.system.structure(),
        }
    }

    fn scale(&self, y: &[f64], scale: &mut [f64]) {
        self.system.scale(y, scale);
    }

    fn restart_at(&mut self, from: f64) {
        self.system.restart_at(from);
    }
}
