//! rapier's bodies, joints and time integration under Pinwheel's contact forces.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::channels::{LawPairs, PairSource};
use pinwheel_gearbox::contacts::ContactField;
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::Scene;

use super::march::{Contacts, Grid, march};
use super::sums::Sums;
use super::world::World;
use crate::control::Control;
use crate::engine::{Ending, Engine, Halt, Prepared, Run, RunStats, Track};

const NAME: &str = "rapier-shared-law";

/// Gauss-Seidel sweeps a step. Ten leave the joints an error below that of the time step: four
/// double the error of the internal sleeves, forty change nothing.
const SWEEPS: usize = 10;

/// See the module.
pub(super) struct SharedLaw;

impl SharedLaw {
    fn grid(scene: &Scene) -> Result<Grid, Ending> {
        Grid::new(scene, scene.solver.step_s).map_err(Ending::unsupported)
    }
}

impl Engine for SharedLaw {
    fn name(&self) -> &'static str {
        NAME
    }

    fn track(&self) -> Track {
        Track::SharedLaw
    }

    fn version(&self) -> String {
        super::version()
    }

    fn summary(&self) -> &'static str {
        "rapier2d's bodies, joints and time integration; contact forces from Pinwheel's law"
    }

    fn differences(&self) -> &'static str {
        "Every body keeps its three coordinates. Revolutes are held by impulses, found by sweeps of projected \
         Gauss-Seidel from the last step's values, and their position errors are fed back. Time integration is \
         rapier's semi-implicit Euler used as leapfrog, which is second order: the first step carries half of every \
         force, and the contact law sees velocities extrapolated by half a step. The law is evaluated once a step, \
         friction included, so friction is explicit. The driver torque follows from the virtual work of the contact \
         forces on the eccentrics. Contact points and contact law are the native solver's own: this comparison \
         cannot find an error in them."
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Box<dyn Prepared + 'a>, Halt> {
        let grid = Self::grid(&gearbox.scene)?;
        let gearbox = gearbox.clone();
        Ok(Box::new(move |control: &Control<'_>| {
            run(&gearbox, &grid, control)
        }))
    }
}

fn run(gearbox: &Gearbox, grid: &Grid, control: &Control<'_>) -> Result<Run, Halt> {
    let field = gearbox.contact_field().map_err(Ending::unsupported)?;
    let world = World::new(gearbox, grid.step_s, SWEEPS);
    let mut notes = Vec::new();
    if gearbox.has_friction() {
        notes.push(
                "Friction is explicit here, and its regularisation takes steps of about 2e-7 s to resolve."
                    .to_owned(),
            );
    }
    let stats = RunStats {
        settings: format!(
            "impulse revolutes, leapfrog, 1 substep, {SWEEPS} constraint sweeps, warm start"
        ),
        notes,
        ..RunStats::default()
    };
    march(
        gearbox,
        world,
        &mut Law { field, calls: 0 },
        grid,
        stats,
        control,
    )
}

/// Pinwheel's contact law as a load.
struct Law {
    field: Box<dyn ContactField>,
    calls: u64,
}

impl Contacts for Law {
    fn step(
        &mut self,
        world: &mut World,
        now: &[BodyState],
        loads: &mut [Wrench],
    ) -> Result<(), String> {
        self.calls += 1;
        self.field.add_loads(now, loads);
        world.load(loads);
        world.advance(&())
    }

    fn forces(&mut self, _world: &World, now: &[BodyState], _share: f64, sums: &mut Sums) {
        self.field.touching(now, &mut |pair| {
            sums.add(pair.wheel, pair.sleeve, pair.force_on_sleeve());
        });
    }

    fn seen<'a>(&'a mut self, _world: &'a World, _share: f64) -> Box<dyn PairSource + 'a> {
        Box::new(LawPairs(self.field.as_mut()))
    }

    fn law_calls(&self) -> u64 {
        self.calls
    }
}
