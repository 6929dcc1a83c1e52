//! rapier's bodies, joints and time integration under Pinwheel's contact forces.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::channels::{LawPairs, PairSource};
use pinwheel_gearbox::contacts::ContactField;
use pinwheel_mbs::{BodyState, Wrench};

use super::march::{Contacts, Grid, march};
use super::sums::Evaluation;
use super::world::World;
use crate::engine::{Ending, Halt, Prepared, prepared};

/// Gauss-Seidel sweeps per step. With ten the error of the joints is below that of the time step: four double the error of the
/// output pins, forty change nothing.
const SWEEPS: usize = 10;

pub(super) fn prepare(gearbox: &Gearbox) -> Result<Prepared<'static>, Halt> {
    let grid = Grid::new(&gearbox.scene, gearbox.scene.solver.step_s)?;
    Ok(prepared(gearbox.clone(), move |gearbox, control| {
        let mut law = Law {
            field: gearbox.contact_field().map_err(Ending::unsupported)?,
            loads: vec![Wrench::default(); gearbox.layout.bodies()],
        };
        let world = World::new(gearbox, grid.step_s, SWEEPS);
        let settings = format!(
            "impulse revolutes, leapfrog, 1 substep, {SWEEPS} constraint sweeps, warm start"
        );
        march(gearbox, world, &mut law, &grid, settings, control)
    }))
}

/// Pinwheel's contact law as a load.
struct Law {
    field: ContactField,
    /// Loads at a sample.
    loads: Vec<Wrench>,
}

impl Contacts for Law {
    fn step(
        &mut self,
        world: &mut World,
        now: &[BodyState],
        loads: &mut [Wrench],
    ) -> Result<(), String> {
        self.field.add_loads(now, loads);
        world.load(loads);
        world.advance(&())
    }

    fn forces(&mut self, _world: &World, now: &[BodyState], _share: f64, sums: &mut Evaluation) {
        self.loads.fill(Wrench::default());
        self.field.add_loads(now, &mut self.loads);
        sums.take(&self.loads);
    }

    fn pair_source<'a>(&'a mut self, _world: &'a World, _share: f64) -> Box<dyn PairSource + 'a> {
        Box::new(LawPairs(&mut self.field))
    }
}
