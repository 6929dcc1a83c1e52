//! A shipped solver as an engine: made ready at its first run, then run as any solver from outside.

use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};

use pinwheel_gearbox::Gearbox;

use super::cards::{CARDS, IDA, SIMBODY};
use super::ready::{Missing, Ready};
use super::{ida, simbody};
use crate::cards::Card;
use crate::control::{Cancelled, Control};
use crate::engine::{Ending, Engine, Halt, Knob, Prepared, Refinement, Run, Track};
use crate::external::{Solver, law_library};

/// One shipped solver.
struct Shipped {
    card: &'static Card,
    version: fn() -> String,
    /// Order of the error in `solver.tolerance`, measured.
    order: f64,
    /// Makes it ready.
    make: fn(&AtomicBool) -> Result<Ready, Missing>,
    /// What became of it, once a process: asking again for every engine of a comparison would only take time.
    made: &'static Mutex<Option<Result<Ready, Missing>>>,
    /// Its manifest for scenes without friction, and with.
    manifests: [&'static str; 2],
}

static MADE_SIMBODY: Mutex<Option<Result<Ready, Missing>>> = Mutex::new(None);
static MADE_IDA: Mutex<Option<Result<Ready, Missing>>> = Mutex::new(None);

/// All of them, in the order of their cards.
pub(crate) fn engines() -> impl Iterator<Item = Box<dyn Engine>> {
    CARDS.iter().filter_map(|card| {
        let shipped = match card.name {
            SIMBODY => Shipped {
                card,
                version: simbody::version,
                order: 0.9,
                make: simbody::ready,
                made: &MADE_SIMBODY,
                manifests: simbody::MANIFESTS,
            },
            IDA => Shipped {
                card,
                version: ida::version,
                order: 0.7,
                make: ida::ready,
                made: &MADE_IDA,
                manifests: [ida::MANIFEST; 2],
            },
            _ => return None,
        };
        Some(Box::new(shipped) as Box<dyn Engine>)
    })
}

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
        Ok(solver.known_as(self.card.name, ready.python))
    }

    fn run(&self, gearbox: &Gearbox, control: &Control<'_>) -> Result<Run, Halt> {
        self.solver(gearbox, control.cancel)?
            .prepare(gearbox)?
            .run(control)
    }
}

impl Engine for Shipped {
    fn name(&self) -> &str {
        self.card.name
    }

    fn track(&self) -> Track {
        self.card.track
    }

    fn version(&self) -> String {
        (self.version)()
    }

    fn summary(&self) -> &str {
        self.card.summary
    }

    fn differences(&self) -> &str {
        self.card.differences
    }

    fn refinement(&self) -> Option<Refinement> {
        Some(Refinement {
            knob: Knob::Tolerance,
            order: self.order,
        })
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Box<dyn Prepared + 'a>, Halt> {
        let gearbox = gearbox.clone();
        Ok(Box::new(move |control: &Control<'_>| {
            self.run(&gearbox, control)
        }))
    }
}
