//! Faults on purpose, for tests that a guard sees them. Not used by the program.

use pinwheel_contact::Law;
use pinwheel_gearbox::contacts::{ContactField, PairContact};
use pinwheel_mbs::{Ask, BodyState, Sums};
use pinwheel_scene::{CheckedScene, Sleeve};

use super::engine::PythonEngine;
use crate::control::Control;
use crate::engine::{Ending, Halt, Run, compile};
use crate::registry;

/// What goes wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// Contact loads hold their value over four calls (MuJoCo only).
    FrozenForces,
    /// From this call on the loads are not numbers.
    NotANumber(u64),
    /// From this call on the loads are this many times too large.
    TooLarge(u64, f64),
}

/// Runs a scene in a shared-law engine with the fault.
///
/// # Errors
/// The halt that the guard makes of it, or an unknown engine.
pub fn run(engine: &str, scene: &CheckedScene, fault: Fault) -> Result<Run, Halt> {
    let unknown = || Ending::unsupported("there is no such Python engine");
    let engine = PythonEngine(registry::info(engine).ok_or_else(unknown)?);
    let every = if fault == Fault::FrozenForces { 4 } else { 1 };
    let faulty = |field| {
        Box::new(Faulty {
            field,
            fault,
            calls: 0,
        }) as Box<dyn ContactField>
    };
    let gearbox = compile(None, scene)?;
    engine.run_with(&gearbox, &Control::quiet(), faulty, every)
}

struct Faulty {
    field: Box<dyn ContactField>,
    fault: Fault,
    calls: u64,
}

impl ContactField for Faulty {
    fn evaluate(&mut self, bodies: &[BodyState], ask: Ask, sums: &mut Sums<'_>) -> bool {
        let told = self.field.evaluate(bodies, ask, sums);
        self.calls += 1;
        let factor = match self.fault {
            Fault::NotANumber(from) if self.calls >= from => f64::NAN,
            Fault::TooLarge(from, factor) if self.calls >= from => factor,
            _ => return told,
        };
        for load in sums.loads.iter_mut().flat_map(|loads| loads.iter_mut()) {
            load.fx *= factor;
            load.fy *= factor;
            load.moment *= factor;
        }
        told
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        self.field.touching(bodies, visit);
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        self.field.nearest(bodies, wheel, sleeve)
    }

    fn law(&self) -> &Law {
        self.field.law()
    }
}
