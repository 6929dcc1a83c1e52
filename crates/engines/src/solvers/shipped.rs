//! Shipped solver as an engine: prepared at its first run, then run like any external solver.

use std::sync::atomic::AtomicBool;

use pinwheel_gearbox::Gearbox;

use super::ready::Ready;
use super::{ida, simbody};
use crate::cache::Memo;
use crate::engine::{Ending, Engine, Halt, Prepared, prepared};
use crate::external::{Solver, law_library};
use crate::info::EngineInfo;
use crate::known::solvers as facts;

/// Shipped solver.
struct Shipped {
    info: &'static EngineInfo<'static>,
    version: fn() -> String,
    /// Builds or installs the solver.
    make: fn(&AtomicBool) -> Result<Ready, Halt>,
    made: Memo<Ready>,
    /// Manifests for scenes without and with friction.
    manifests: [&'static str; 2],
}

static SIMBODY: Shipped = Shipped {
    info: &facts::SIMBODY,
    version: simbody::version,
    make: simbody::ready,
    made: Memo::empty(),
    manifests: simbody::MANIFESTS,
};

static IDA: Shipped = Shipped {
    info: &facts::IDA,
    version: ida::version,
    make: ida::ready,
    made: Memo::empty(),
    manifests: [ida::MANIFEST; 2],
};

/// Returns a shipped solver; `None` if the facts belong to another engine.
pub(crate) fn engine(info: &EngineInfo<'_>) -> Option<Box<dyn Engine>> {
    let shipped = [&SIMBODY, &IDA].into_iter().find(|own| own.info == info)?;
    Some(Box::new(shipped))
}

impl Shipped {
    /// Returns the solver for a scene, prepared if necessary.
    fn solver(&self, gearbox: &Gearbox, cancel: &AtomicBool) -> Result<Solver, Halt> {
        let ready = self.made.get(|| (self.make)(cancel))?;
        law_library().map_err(Ending::absent)?;
        let manifest = ready
            .here
            .join(self.manifests[usize::from(gearbox.has_friction())]);
        let solver = Solver::open(&manifest).map_err(Ending::failed)?;
        Ok(solver.known_as(self.info.name, ready.python))
    }
}

impl Engine for &'static Shipped {
    fn info(&self) -> EngineInfo<'_> {
        *self.info
    }

    fn version(&self) -> String {
        (self.version)()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        Ok(prepared(gearbox.clone(), |gearbox, control| {
            let solver = self.solver(gearbox, control.cancel)?;
            solver.prepare(gearbox)?(control)
        }))
    }
}
