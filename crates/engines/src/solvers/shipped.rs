//! A shipped solver as an engine: made ready at its first run, then run as any solver from outside.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use pinwheel_gearbox::Gearbox;

use super::{ida, simbody};
use crate::cache::Memo;
use crate::engine::{Ending, Engine, Halt, Prepared, prepared};
use crate::external::{Solver, law_library};
use crate::registry::{self, EngineInfo};

/// Folder and interpreter with which a solver runs.
#[derive(Debug, Clone)]
pub(super) struct Ready {
    /// The folder of its manifests and of what they start.
    pub(super) here: PathBuf,
    /// Its interpreter, if it needs one.
    pub(super) python: Option<PathBuf>,
}

/// One shipped solver.
pub(crate) struct Shipped {
    info: &'static EngineInfo<'static>,
    version: fn() -> String,
    /// Makes it ready.
    make: fn(&AtomicBool) -> Result<Ready, Halt>,
    made: Memo<Ready>,
    /// Its manifest for scenes without friction, and with.
    manifests: [&'static str; 2],
}

pub(crate) static SIMBODY: Shipped = Shipped {
    info: &registry::SIMBODY,
    version: simbody::version,
    make: simbody::ready,
    made: Memo::new(),
    manifests: simbody::MANIFESTS,
};

pub(crate) static IDA: Shipped = Shipped {
    info: &registry::IDA,
    version: ida::version,
    make: ida::ready,
    made: Memo::new(),
    manifests: [ida::MANIFEST; 2],
};

impl Shipped {
    /// The solver for a scene, made ready if it is not.
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
