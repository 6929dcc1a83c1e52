//! rapier's bodies, joints and time integration under Pinwheel's contact forces.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::channels::{LawPairs, PairSource};
use pinwheel_gearbox::contacts::ContactField;
use pinwheel_mbs::{BodyState, Wrench};

use super::march::{Contacts, Grid, march};
use super::sums::Sums;
use super::world::World;
use crate::engine::{Ending, Halt, Prepared, prepared};

/// Gauss-Seidel sweeps a step. Ten leave the joints an error below that of the time step: four
/// double the error of the internal sleeves, forty change nothing.
const SWEEPS: usize = 10;

pub(super) fn prepare(gearbox: &Gearbox) -> Result<Prepared<'static>, Halt> {
    let grid = Grid::new(&gearbox.scene, gearbox.scene.solver.step_s)?;
    Ok(prepared(gearbox.clone(), move |gearbox, control| {
        let mut law = Law(gearbox.contact_field().map_err(Ending::unsupported)?);
        let world = World::new(gearbox, grid.step_s, SWEEPS);
        let settings = format!(
            "impulse revolutes, leapfrog, 1 substep, {SWEEPS} constraint sweeps, warm start"
        );
        march(gearbox, world, &mut law, &grid, settings, control)
    }))
}

/// Pinwheel's contact law as a load.
struct Law(Box<dyn ContactField>);

impl Contacts for Law {
    fn step(
        &mut self,
        world: &mut World,
        now: &[BodyState],
        loads: &mut [Wrench],
    ) -> Result<(), String> {
        self.0.add_loads(now, loads);
        world.load(loads);
        world.advance(&())
    }

    fn forces(&mut self, _world: &World, now: &[BodyState], _share: f64, sums: &mut Sums) {
        let add = &mut |wheel, sleeve, force| sums.add(wheel, sleeve, force);
        self.0.on_sleeves(now, add);
        if let Some(bearings) = self.0.bearings() {
            bearings.on_output(now, &mut |sleeve, force| sums.add_to_sleeve(sleeve, force));
        }
    }

    fn driver_torque(&self, now: &[BodyState], sums: &Sums) -> f64 {
        let wheels = match self.0.bearings() {
            Some(bearings) => bearings.driver_torque(now),
            None => sums.driver_torque(now),
        };
        let seals = self.0.seals();
        wheels + seals.map_or(0.0, |seals| seals.driver_torque(now))
    }

    fn seen<'a>(&'a mut self, _world: &'a World, _share: f64) -> Box<dyn PairSource + 'a> {
        Box::new(LawPairs(self.0.as_mut()))
    }
}
