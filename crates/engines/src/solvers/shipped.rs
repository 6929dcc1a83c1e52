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
    /// Returns the missing parts on this machine, with the command that installs them.
    needs: fn() -> Option<String>,
    /// Builds or installs the solver.
    make: fn(&AtomicBool) -> Result<Ready, Halt>,
    ready: Memo<Ready>,
    /// Manifests for scenes without and with friction.
    manifests: [&'static str; 2],
}

static SHIPPED: [Shipped; 2] = [
    Shipped {
        info: &facts::SIMBODY,
        version: simbody::version,
        needs: simbody::needs,
        make: simbody::ready,
        ready: Memo::empty(),
        manifests: simbody::MANIFESTS,
    },
    Shipped {
        info: &facts::IDA,
        version: ida::version,
        needs: || ida::REQUIREMENTS.needs(),
        make: ida::ready,
        ready: Memo::empty(),
        manifests: [ida::MANIFEST; 2],
    },
];

fn shipped(info: &EngineInfo<'_>) -> Option<&'static Shipped> {
    SHIPPED.iter().find(|own| own.info == info)
}

/// Returns a shipped solver; `None` if the facts belong to another engine.
pub(crate) fn engine(info: &EngineInfo<'_>) -> Option<Box<dyn Engine>> {
    Some(Box::new(shipped(info)?))
}

/// Returns the missing parts of a shipped solver on this machine; `None` if it runs now.
pub(crate) fn needs(info: &EngineInfo<'_>) -> Option<String> {
    let no_law = || law_library().err();
    (shipped(info)?.needs)().or_else(no_law)
}

impl Shipped {
    /// Returns the solver for a scene, prepared if necessary.
    fn solver(&self, gearbox: &Gearbox, cancel: &AtomicBool) -> Result<Solver, Halt> {
        let ready = self.ready.get(|| (self.make)(cancel))?;
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
