//! State machine of a unit during a simulation: permitted order and effect of calls [FMI 2.0, 4.2].

use std::sync::Arc;

use pinwheel_files::fnv;
use pinwheel_gearbox::cosimulation::{CoSimulation, Shafts};
use pinwheel_scene::keys::LONGEST_S;
use serde::{Deserialize, Serialize};

use crate::model::{Input, Model, Shaft, Variable, What};

/// Reason of a refused call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal(pub String);

impl From<String> for Refusal {
    fn from(what: String) -> Self {
        Self(what)
    }
}

fn refused<T>(what: impl Into<String>) -> Result<T, Refusal> {
    Err(Refusal(what.into()))
}

/// Checks an input against the bounds of the scene's key: beyond them steps become too small to finish.
fn within(call: &str, name: &str, input: Input, value: f64) -> Result<(), Refusal> {
    match input.key().and_then(|key| key.refuses(value)) {
        Some(words) => refused(format!("{call}: {name} must be {words}, not {value:e}")),
        None => Ok(()),
    }
}

/// Phase in the life of a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Phase {
    Instantiated,
    Initialising,
    Stepping,
    Terminated,
    /// A step failed: the unit continues from an earlier state or a reset.
    Failed,
}

impl Phase {
    fn words(self) -> &'static str {
        match self {
            Self::Instantiated => "before fmi2EnterInitializationMode",
            Self::Initialising => "in initialization mode",
            Self::Stepping => "after fmi2ExitInitializationMode",
            Self::Terminated => "after fmi2Terminate",
            Self::Failed => "after a step that failed",
        }
    }
}

/// State on which the next calls depend, except for the gear.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Prescribed {
    phase: Phase,
    /// Values of the variables, by value reference.
    values: Vec<f64>,
    /// Slopes of the inputs, change per second; valid for the next step only.
    slopes: Vec<f64>,
    start_s: f64,
    stop_s: Option<f64>,
    tolerance: Option<f64>,
    /// Values at the start of the gear.
    begun: Vec<f64>,
}

/// Complete saved state of a unit.
#[derive(Serialize, Deserialize)]
struct Saved {
    guid: String,
    prescribed: Prescribed,
    gear: Option<Vec<u8>>,
}

/// Unit of FMI with its gear and state.
pub struct Instance {
    model: Arc<Model>,
    prescribed: Prescribed,
    gear: Option<CoSimulation>,
    /// Observation at the present time.
    observed: Option<(Shafts, Vec<f64>)>,
}

impl Instance {
    /// Returns a new unit.
    pub fn new(model: Arc<Model>) -> Self {
        let values: Vec<f64> = model.variables().iter().map(|v| v.start).collect();
        Self {
            prescribed: Prescribed {
                phase: Phase::Instantiated,
                slopes: vec![0.0; values.len()],
                begun: values.clone(),
                values,
                start_s: 0.0,
                stop_s: None,
                tolerance: None,
            },
            model,
            gear: None,
            observed: None,
        }
    }

    fn in_phase(&self, call: &str, phases: &[Phase]) -> Result<(), Refusal> {
        if phases.contains(&self.prescribed.phase) {
            return Ok(());
        }
        let wanted: Vec<&str> = phases.iter().map(|phase| phase.words()).collect();
        let (now, then) = (self.prescribed.phase.words(), wanted.join(" or "));
        refused(format!("{call} was called {now}; it may be called {then}"))
    }

    /// Sets times and tolerance, as `fmi2SetupExperiment`.
    ///
    /// # Errors
    /// A call at the wrong moment, or invalid times.
    pub fn setup(
        &mut self,
        tolerance: Option<f64>,
        start_s: f64,
        stop_s: Option<f64>,
    ) -> Result<(), Refusal> {
        self.in_phase("fmi2SetupExperiment", &[Phase::Instantiated])?;
        if !start_s.is_finite() {
            return refused(format!(
                "fmi2SetupExperiment: a start at {start_s} s is not a valid time"
            ));
        }
        if let Some(stop) = stop_s.filter(|stop| !(*stop >= start_s)) {
            return refused(format!(
                "fmi2SetupExperiment: a stop at {stop} s does not follow a start at {start_s} s"
            ));
        }
        if let Some(wrong) = tolerance.filter(|tolerance| !(*tolerance > 0.0 && *tolerance < 0.1)) {
            return refused(format!(
                "fmi2SetupExperiment: a tolerance must be above 0 and below 0.1, not {wrong}"
            ));
        }
        self.prescribed.tolerance = tolerance;
        (self.prescribed.start_s, self.prescribed.stop_s) = (start_s, stop_s);
        Ok(())
    }

    /// Builds the gear, as `fmi2EnterInitializationMode`.
    ///
    /// # Errors
    /// A call at the wrong moment, or values without a valid gear.
    pub fn enter_initialization(&mut self) -> Result<(), Refusal> {
        self.in_phase("fmi2EnterInitializationMode", &[Phase::Instantiated])?;
        self.prescribed.phase = Phase::Initialising;
        self.begin()
            .inspect_err(|_| self.prescribed.phase = Phase::Instantiated)
    }

    /// Begins the stepping phase, as `fmi2ExitInitializationMode`.
    ///
    /// # Errors
    /// Errors of [`enter_initialization`](Self::enter_initialization).
    pub fn exit_initialization(&mut self) -> Result<(), Refusal> {
        self.in_phase("fmi2ExitInitializationMode", &[Phase::Initialising])?;
        self.begin()?;
        self.prescribed.phase = Phase::Stepping;
        Ok(())
    }

    /// Ends the simulation, as `fmi2Terminate`.
    ///
    /// # Errors
    /// A call at the wrong moment.
    pub fn terminate(&mut self) -> Result<(), Refusal> {
        self.in_phase("fmi2Terminate", &[Phase::Stepping, Phase::Failed])?;
        self.prescribed.phase = Phase::Terminated;
        Ok(())
    }

    /// Returns the unit to its state after instantiation, as `fmi2Reset`.
    pub fn reset(&mut self) {
        *self = Self::new(Arc::clone(&self.model));
    }

    /// Builds the gear at its start, unless it exists.
    fn begin(&mut self) -> Result<(), Refusal> {
        if self.gear.is_none() {
            let values = &self.prescribed.values;
            let mut gear = self.model.begin(values, self.prescribed.tolerance)?;
            let holders = self.model.holders(values);
            gear.prescribe(holders.map(|k| (values[k], 0.0)));
            self.prescribed.begun.clone_from(values);
            (self.gear, self.observed) = (Some(gear), None);
        }
        Ok(())
    }

    fn variable(&self, call: &str, reference: u32) -> Result<(usize, &Variable), Refusal> {
        let place = usize::try_from(reference).unwrap_or(usize::MAX);
        let none = || format!("{call}: there is no variable of value reference {reference}");
        let variable = self.model.variables().get(place).ok_or_else(none)?;
        Ok((place, variable))
    }

    /// Returns the index of a variable; `boolean`: the required type.
    fn place_of(&self, call: &str, reference: u32, boolean: bool) -> Result<usize, Refusal> {
        let (place, variable) = self.variable(call, reference)?;
        if variable.is_boolean() != boolean {
            let kind = if boolean { "Real" } else { "Boolean" };
            return refused(format!("{call}: {} is a {kind}", variable.name));
        }
        Ok(place)
    }

    /// Sets one variable, as `fmi2SetReal`.
    ///
    /// # Errors
    /// No such variable, one that cannot be set now, or a value that is not finite.
    pub fn set_real(&mut self, reference: u32, value: f64) -> Result<(), Refusal> {
        let place = self.place_of("fmi2SetReal", reference, false)?;
        self.set("fmi2SetReal", place, value)
    }

    /// Sets one Boolean variable, as `fmi2SetBoolean`.
    ///
    /// # Errors
    /// Errors of [`set_real`](Self::set_real).
    pub fn set_boolean(&mut self, reference: u32, value: bool) -> Result<(), Refusal> {
        let place = self.place_of("fmi2SetBoolean", reference, true)?;
        self.set("fmi2SetBoolean", place, f64::from(u8::from(value)))
    }

    fn set(&mut self, call: &str, place: usize, value: f64) -> Result<(), Refusal> {
        let variable = &self.model.variables()[place];
        let name = &variable.name;
        if variable.is_output() {
            return refused(format!("{call}: {name} is an output, which is computed"));
        }
        if !value.is_finite() {
            let what = format!("{call}: {name} must be a finite number, not {value}");
            return refused(what);
        }
        if let What::Input(input) = variable.what {
            within(call, name, input, value)?;
        }
        let phases = [Phase::Instantiated, Phase::Initialising, Phase::Stepping];
        let (kind, phases) = match variable.what {
            What::Input(_) => ("input", &phases[..]),
            _ => ("parameter", &phases[..2]),
        };
        self.in_phase(&format!("{call} of the {kind} {name}"), phases)?;
        self.prescribed.values[place] = value;
        if self.prescribed.phase != Phase::Stepping {
            self.gear = None;
        }
        Ok(())
    }

    /// Sets the slope of one input over the next step, change per second, as `fmi2SetRealInputDerivatives`.
    ///
    /// # Errors
    /// No input, another order than the first, a wrong moment, or a value that is not finite.
    pub fn set_slope(&mut self, reference: u32, order: i32, value: f64) -> Result<(), Refusal> {
        const CALL: &str = "fmi2SetRealInputDerivatives";
        let (place, variable) = self.variable(CALL, reference)?;
        if !matches!(variable.what, What::Input(_)) {
            return refused(format!("{CALL}: {} is no input", variable.name));
        }
        if order != 1 {
            return refused(format!(
                "{CALL}: only the first derivative counts, not {order}"
            ));
        }
        if !value.is_finite() {
            let name = &variable.name;
            return refused(format!("{CALL}: {name} must be finite, not {value}"));
        }
        self.in_phase(CALL, &[Phase::Initialising, Phase::Stepping])?;
        self.prescribed.slopes[place] = value;
        Ok(())
    }

    /// Returns the value of one variable, as `fmi2GetReal`.
    ///
    /// # Errors
    /// No such variable, or one without a value yet.
    pub fn real(&mut self, reference: u32) -> Result<f64, Refusal> {
        let place = self.place_of("fmi2GetReal", reference, false)?;
        let variable = &self.model.variables()[place];
        let what = variable.what;
        if !variable.is_output() {
            return Ok(self.prescribed.values[place]);
        }
        let known = [Phase::Initialising, Phase::Stepping, Phase::Terminated];
        self.in_phase(&format!("fmi2GetReal of {}", variable.name), &known)?;
        self.begin()?;
        let Some(gear) = &mut self.gear else {
            return refused("fmi2GetReal: there is no gear");
        };
        let (shafts, row) = self.observed.get_or_insert_with(|| {
            let mut row = Vec::new();
            (gear.observe(&mut row), row)
        });
        let value = match what {
            What::Shaft(Shaft::InputAngle) => shafts.input[0],
            What::Shaft(Shaft::InputSpeed) => shafts.input[1],
            What::Shaft(Shaft::OutputSpeed) => shafts.output_speed_rad_s,
            What::Shaft(Shaft::Load) => shafts.load_torque_n_m,
            What::Shaft(Shaft::LargestForce) => shafts.largest_force_n,
            What::Column(column) => row.get(column).copied().unwrap_or(f64::NAN),
            _ => f64::NAN,
        };
        Ok(value)
    }

    /// Returns the value of one Boolean variable, as `fmi2GetBoolean`.
    ///
    /// # Errors
    /// No such variable.
    pub fn boolean(&self, reference: u32) -> Result<bool, Refusal> {
        let place = self.place_of("fmi2GetBoolean", reference, true)?;
        Ok(self.prescribed.values[place] != 0.0)
    }

    /// Advances the gear by one step, as `fmi2DoStep`.
    ///
    /// # Errors
    /// A call at the wrong moment, a wrong time, or a motion that cannot continue.
    pub fn step(&mut self, from_s: f64, step_s: f64) -> Result<(), Refusal> {
        self.step_unless(from_s, step_s, &|| false)
    }

    /// Advances the gear by one step, as `fmi2DoStep`; ends early when `cancelled`, called during the step, returns true.
    ///
    /// # Errors
    /// Errors of [`step`](Self::step), or cancellation.
    pub fn step_unless(
        &mut self,
        from_s: f64,
        step_s: f64,
        cancelled: &dyn Fn() -> bool,
    ) -> Result<(), Refusal> {
        self.in_phase("fmi2DoStep", &[Phase::Stepping])?;
        let Some(gear) = &mut self.gear else {
            return refused("fmi2DoStep: there is no gear");
        };
        let to = from_s + step_s;
        if !(step_s > 0.0 && to.is_finite() && to > from_s) {
            return refused(format!(
                "fmi2DoStep: a step of {step_s} s from {from_s} s is invalid"
            ));
        }
        let now = self.prescribed.start_s + gear.time_s();
        if !((from_s - now).abs() <= 1e-6 * step_s + 1e-12 * now.abs()) {
            return refused(format!(
                "fmi2DoStep: the time is {now} s, not {from_s} s; an earlier state goes back"
            ));
        }
        let rounding = 1e-6 * step_s + 1e-12 * to.abs();
        if let Some(stop) = self.prescribed.stop_s.filter(|stop| to > stop + rounding) {
            return refused(format!(
                "fmi2DoStep: a step to {to} s leads beyond the stop time, {stop} s"
            ));
        }
        if to - self.prescribed.start_s > LONGEST_S + rounding {
            return refused(format!(
                "fmi2DoStep: a step to {to} s leads beyond the longest simulation, {LONGEST_S} s"
            ));
        }
        let holders = self.model.holders(&self.prescribed.values);
        let held = holders.map(|k| (self.prescribed.values[k], self.prescribed.slopes[k]));
        for (k, (value, slope)) in holders.into_iter().zip(held) {
            let variable = &self.model.variables()[k];
            if let What::Input(input) = variable.what {
                let end = format!("{} at {to} s", variable.name);
                within("fmi2DoStep", &end, input, value + slope * step_s)?;
            }
        }
        gear.prescribe(held);
        self.prescribed.slopes.fill(0.0);
        self.observed = None;
        let advanced = gear.advance(to - self.prescribed.start_s, cancelled);
        advanced.map_err(|what| {
            self.prescribed.phase = Phase::Failed;
            Refusal(format!("fmi2DoStep: {what}"))
        })
    }

    /// Describes the method and the setting of its steps.
    pub fn method(&self) -> String {
        let words = |gear: &CoSimulation| {
            let (name, tolerance) = gear.method();
            match gear.adaptive() {
                true => format!("{name}, tolerance {tolerance:e}"),
                false => format!("{name}, steps of {:e} s", gear.step_s()),
            }
        };
        self.gear.as_ref().map_or_else(String::new, words)
    }

    /// Returns a note if the requested tolerance has no effect.
    pub fn unheeded(&self) -> Option<String> {
        let tolerance = self.prescribed.tolerance?;
        self.gear.as_ref().filter(|gear| !gear.adaptive())?;
        let method = self.method();
        Some(format!(
            "the tolerance {tolerance:e} has no effect on the scene's method ({method}); solver.integrator = \"auto\" heeds one"
        ))
    }

    /// Returns the present time, s.
    pub fn time_s(&self) -> f64 {
        self.prescribed.start_s + self.gear.as_ref().map_or(0.0, CoSimulation::time_s)
    }

    /// Returns the complete state as bytes, exact to the bit, as `fmi2GetFMUstate`.
    ///
    /// # Errors
    /// Internal fault: a state that cannot be written.
    pub fn save(&mut self) -> Result<Vec<u8>, Refusal> {
        let saved = Saved {
            guid: self.model.guid().to_owned(),
            prescribed: self.prescribed.clone(),
            gear: self.gear.as_mut().map(CoSimulation::save),
        };
        let mut bytes = postcard::to_allocvec(&saved)
            .map_err(|error| Refusal(format!("the state cannot be written: {error}")))?;
        bytes.extend(fnv(bytes.iter().copied()).to_le_bytes());
        Ok(bytes)
    }

    /// Restores a state of this unit or of another unit of the same model, as `fmi2SetFMUstate`.
    ///
    /// # Errors
    /// Bytes that are no state of this model; the unit is then unchanged.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), Refusal> {
        let saved = self.read(bytes)?;
        let prescribed = saved.prescribed;
        // Values are compared by their bits, because outputs are NaN.
        let begun = self.prescribed.begun.iter().zip(&prescribed.begun);
        let same = self.prescribed.tolerance == prescribed.tolerance
            && begun.fold(true, |same, (a, b)| same && a.to_bits() == b.to_bits());
        if let Some(state) = &saved.gear {
            let mut other = None;
            let gear = match &mut self.gear {
                Some(gear) if same => gear,
                _ => other.insert(self.model.begin(&prescribed.begun, prescribed.tolerance)?),
            };
            if !gear.restore(state) {
                return refused("the state is not one of this unit");
            }
            self.gear = other.or(self.gear.take());
        } else {
            self.gear = None;
        }
        (self.prescribed, self.observed) = (prescribed, None);
        Ok(())
    }

    /// Reads a saved state, which must be complete and of this model.
    fn read(&self, bytes: &[u8]) -> Result<Saved, Refusal> {
        let intact =
            |(state, sum): &(&[u8], &[u8; 8])| fnv(state.iter().copied()).to_le_bytes() == **sum;
        let state = bytes.split_last_chunk::<8>().filter(intact);
        let saved = state.and_then(|(state, _)| postcard::from_bytes::<Saved>(state).ok());
        let count = self.model.variables().len();
        let of_this = |saved: &Saved| {
            let Prescribed {
                values,
                slopes,
                begun,
                ..
            } = &saved.prescribed;
            let fits = [values, slopes, begun]
                .iter()
                .all(|list| list.len() == count);
            saved.guid == self.model.guid() && fits
        };
        match saved {
            None => refused("the state is damaged"),
            Some(saved) if of_this(&saved) => Ok(saved),
            Some(_) => refused("the state is of another unit"),
        }
    }

    /// Checks that bytes are a state of this model, as `fmi2DeSerializeFMUstate`.
    ///
    /// # Errors
    /// Bytes that are no state of this model.
    pub fn check(&self, bytes: &[u8]) -> Result<(), Refusal> {
        self.read(bytes).map(|_| ())
    }
}
