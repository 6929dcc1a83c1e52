//! A shipped solver as an engine: made ready at its first run, then run as any solver from outside.

use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};

use pinwheel_gearbox::Gearbox;

use super::ready::{Missing, Ready};
use super::{ida, simbody};
use crate::control::{Cancelled, Control};
use crate::engine::{Ending, Engine, Halt, Prepared, Run};
use crate::external::{Solver, law_library};
use crate::registry::{self, EngineInfo};

/// One shipped solver.
pub(crate) struct Shipped {
    info: &'static EngineInfo<'static>,
    version: fn() -> String,
    /// Makes it ready.
    make: fn(&AtomicBool) -> Result<Ready, Missing>,
    /// What became of it, once a process: asking again for every engine of a comparison would only take time.
    made: Mutex<Option<Result<Ready, Missing>>>,
    /// Its manifest for scenes without friction, and with.
    manifests: [&'static str; 2],
}

pub(crate) static SIMBODY: Shipped = Shipped {
    info: &registry::SIMBODY,
    version: simbody::version,
    make: simbody::ready,
    made: Mutex::new(None),
    manifests: simbody::MANIFESTS,
};

pub(crate) static IDA: Shipped = Shipped {
    info: &registry::IDA,
    version: ida::version,
    make: ida::ready,
    made: Mutex::new(None),
    manifests: [ida::MANIFEST; 2],
};

impl Shipped {
    /// The solver for a scene, made ready if it is not.
    fn solver(&self, gearbox: &Gearbox, cancel: &AtomicBool) -> Result<Solver, Halt> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let outcome = match made.as_ref() {
            Some(known) => known.clone(),
            None => (self.make)(cancel),
        };
        if !matches!(outcome, Err(Missing::Stopped)) {
            *made = Some(outcome.clone());
        }
        drop(made);
        let ready = outcome.map_err(|missing| match missing {
            Missing::Stopped => Halt::from(Cancelled),
            Missing::Because(reason) => Ending::Absent { reason }.into(),
        })?;
        law_library().map_err(Ending::absent)?;
        let manifest = ready
            .here
            .join(self.manifests[usize::from(gearbox.has_friction())]);
        let solver = Solver::open(&manifest).map_err(Ending::failed)?;
        Ok(solver.known_as(self.info.name, ready.python))
    }

    fn run(&self, gearbox: &Gearbox, control: &Control<'_>) -> Result<Run, Halt> {
        self.solver(gearbox, control.cancel)?
            .prepare(gearbox)?
            .run(control)
    }
}

impl Engine for Shipped {
    fn info(&self) -> EngineInfo<'_> {
        *self.info
    }

    fn version(&self) -> String {
        (self.version)()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Box<dyn Prepared + 'a>, Halt> {
        let gearbox = gearbox.clone();
        Ok(Box::new(move |control: &Control<'_>| {
            self.run(&gearbox, control)
        }))
    }
}
