//! Recorder of states at sample times as the contract's time series, used by every engine.

use pinwheel_mbs::{BodyState, Observation, Wrench};
use pinwheel_timeseries::sampling::{self, Between, Point, QUANTITIES};
use pinwheel_timeseries::{TimeSeries, columns};

use crate::Gearbox;
use crate::Layout;
use crate::channels::{EngineState, Values};
use crate::contacts::ContactField;

/// Recording of a run: columns in the contract's order.
#[derive(Debug, Clone)]
pub struct Recorder {
    layout: Layout,
    /// True if the ring is the output.
    ring_turns: bool,
    time: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// Samples, one after the other, that are not yet in the columns: with this many columns, writing several samples at a time
    /// is faster.
    rows: Vec<f64>,
    /// Number of samples in `rows`.
    pending: usize,
    /// Loads of all bodies.
    loads: Vec<Wrench>,
    /// Channels that the scene requests besides the contract's columns.
    channels: Option<Values>,
    /// Record between samples, if the solver provides one, and a row of its columns at one time.
    between: Option<Between>,
    row: Vec<f64>,
}

/// Number of samples written to the columns at a time.
const ROWS: usize = 128;

impl Recorder {
    /// Returns the names of the contract's columns after the time, in their order.
    pub fn contract(gearbox: &Gearbox) -> Vec<String> {
        let layout = gearbox.layout;
        columns::of_gearbox(layout.external_sleeves, layout.internal_sleeves).collect()
    }

    /// Creates an empty recording with capacity for the scene's samples.
    pub fn new(gearbox: &Gearbox) -> Self {
        Self::with_room(gearbox, gearbox.scene.solver.sample_times_s().len())
    }

    /// Creates an empty recording with capacity for `samples` samples.
    pub(crate) fn with_room(gearbox: &Gearbox, samples: usize) -> Self {
        let layout = gearbox.layout;
        let sleeves = layout.external_sleeves + layout.internal_sleeves;
        Self {
            rows: vec![0.0; ROWS * (columns::HEAD.len() + sleeves)],
            pending: 0,
            layout,
            ring_turns: gearbox.scene.ring_turns(),
            time: Vec::with_capacity(samples),
            // The clone of an empty column would have no capacity.
            columns: (0..columns::HEAD.len() + sleeves)
                .map(|_| Vec::with_capacity(samples))
                .collect(),
            loads: vec![Wrench::default(); layout.bodies()],
            channels: Values::new(gearbox, samples),
            between: None,
            row: Vec::new(),
        }
    }

    /// Creates an empty recording with capacity for `samples` samples, for a solver that also evaluates quantities between
    /// samples ([`record_between`](Self::record_between)).
    pub(crate) fn with_between(gearbox: &Gearbox, samples: usize) -> Self {
        let recorder = Self::with_room(gearbox, samples);
        Self {
            between: Some(Between::new(&QUANTITIES, samples)),
            row: vec![0.0; recorder.columns.len()],
            ..recorder
        }
    }

    /// Records a sample from the bodies' states, with contact forces of the native law. `driver_torque`: on the input shaft, N
    /// m.
    pub fn record(
        &mut self,
        t: f64,
        driver_torque: f64,
        bodies: &[BodyState],
        field: &mut ContactField,
    ) {
        let mut loads = std::mem::take(&mut self.loads);
        loads.fill(Wrench::default());
        field.add_loads(bodies, &mut loads);
        self.record_loads(t, driver_torque, bodies, &loads);
        self.loads = loads;
    }

    /// Records a sample from a formulation's observation, in which contacts are the only load of a pin. `shafts`: torque of the
    /// driver and load on the output, N m.
    pub fn record_observed(&mut self, at: &Observation<'_>, shafts: [f64; 2]) {
        let (head, sleeves) = self.head(at, shafts);
        self.record_known(at.time, head, sleeves);
        if let Some(between) = &mut self.between {
            let row = &self.rows[(self.pending - 1) * self.columns.len()..];
            between.push(at.time, true, &points(self.layout, row));
        }
    }

    /// Records an observation between samples.
    pub(crate) fn record_between(&mut self, at: &Observation<'_>, shafts: [f64; 2]) {
        let (head, sleeves) = self.head(at, shafts);
        if let Some(between) = &mut self.between {
            fill(&mut self.row, head, sleeves);
            between.push(at.time, false, &points(self.layout, &self.row));
        }
    }

    /// Returns the columns before the pins', and the pins' loads.
    fn head<'a>(
        &self,
        at: &Observation<'a>,
        [driver_torque, load]: [f64; 2],
    ) -> ([f64; columns::HEAD.len()], &'a [Wrench]) {
        let sleeves = &at.loads[self.layout.external_bodies().start..];
        let output = Layout::OUTPUT;
        // Moment on the output without its load.
        let torque = match at.moments {
            Some(moments) => moments[output] - load,
            None => self.output_torque(at.bodies, sleeves) + (at.loads[output].moment - load),
        };
        ([driver_torque, torque, at.bodies[output].angle], sleeves)
    }

    /// Records a sample from known pin forces (ground frame, N, external then internal). Other torques on the output, without
    /// its load, are in N m.
    pub fn record_forces(
        &mut self,
        t: f64,
        driver_torque: f64,
        bodies: &[BodyState],
        forces: &[[f64; 2]],
        own_n_m: f64,
    ) {
        let mut loads = std::mem::take(&mut self.loads);
        loads[Layout::OUTPUT].moment = own_n_m;
        let sleeves = &mut loads[self.layout.external_bodies().start..];
        for (load, &[fx, fy]) in sleeves.iter_mut().zip(forces) {
            (load.fx, load.fy) = (fx, fy);
        }
        self.record_loads(t, driver_torque, bodies, &loads);
        self.loads = loads;
    }

    fn record_loads(&mut self, t: f64, driver_torque: f64, bodies: &[BodyState], loads: &[Wrench]) {
        let forces = &loads[self.layout.external_bodies().start..];
        let torque = self.output_torque(bodies, forces) + loads[Layout::OUTPUT].moment;
        let angle = bodies[Layout::OUTPUT].angle;
        self.record_known(t, [driver_torque, torque, angle], forces);
    }

    /// Returns the torque of the forces on the output's pins, N m.
    fn output_torque(&self, bodies: &[BodyState], forces: &[Wrench]) -> f64 {
        let output = bodies[Layout::OUTPUT];
        let (pins, first) = match self.ring_turns {
            true => (self.layout.external_bodies(), 0),
            false => (self.layout.internal_bodies(), self.layout.external_sleeves),
        };
        let sleeves = bodies[pins].iter().zip(&forces[first..]);
        let moments = sleeves.map(|(body, force)| {
            let Wrench { fx, fy, .. } = force;
            (body.x - output.x) * fy - (body.y - output.y) * fx
        });
        moments.sum()
    }

    /// Records the columns' `head` and the magnitudes of the forces.
    fn record_known(&mut self, t: f64, head: [f64; columns::HEAD.len()], forces: &[Wrench]) {
        if self.pending == ROWS {
            self.flush();
        }
        self.time.push(t);
        let width = self.columns.len();
        fill(
            &mut self.rows[self.pending * width..][..width],
            head,
            forces,
        );
        self.pending += 1;
    }

    /// Writes the pending samples to their columns.
    fn flush(&mut self) {
        let width = self.columns.len();
        for (k, column) in self.columns.iter_mut().enumerate() {
            let values: [f64; ROWS] = std::array::from_fn(|row| self.rows[row * width + k]);
            column.extend_from_slice(&values[..self.pending]);
        }
        self.pending = 0;
    }

    /// True if the scene requests channels: [`record_channels`](Self::record_channels) must then follow every sample. Columns
    /// without values are missing in the time series.
    pub fn wants_channels(&self) -> bool {
        self.channels.is_some()
    }

    /// Adds the channels of the last sample.
    pub fn record_channels(&mut self, state: &mut EngineState<'_>) {
        let last = self.pending.checked_sub(1);
        let output_torque = last.map_or(0.0, |row| self.rows[row * self.columns.len() + 1]);
        if let Some(channels) = &mut self.channels {
            channels.record(state, output_torque);
        }
    }

    /// Removes the last sample and writes its values to `row` in the order of the columns, NaN if unknown.
    pub fn take_last(&mut self, row: &mut Vec<f64>) {
        self.flush();
        row.clear();
        self.time.pop();
        row.extend(self.columns.iter_mut().filter_map(Vec::pop));
        if let Some(channels) = &mut self.channels {
            channels.take_last(row);
        }
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Returns true before the first sample.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Returns the time series recorded so far.
    ///
    /// # Errors
    /// Samples were not recorded in increasing time.
    pub fn finish(mut self) -> Result<TimeSeries, pinwheel_timeseries::TimeSeriesError> {
        self.flush();
        let samples = self.time.len();
        let mut time_series = TimeSeries::new(self.time)?;
        let layout = self.layout;
        let names = columns::of_gearbox(layout.external_sleeves, layout.internal_sleeves);
        for (name, values) in names.zip(self.columns) {
            time_series.push(name, values)?;
        }
        for (name, values) in self.channels.into_iter().flat_map(|c| c.finish(samples)) {
            time_series.push(name, values)?;
        }
        Ok(time_series.with_between(self.between.and_then(Between::finish)))
    }
}

/// Writes the columns' `head` and the magnitudes of the forces.
fn fill(row: &mut [f64], head: [f64; columns::HEAD.len()], forces: &[Wrench]) {
    let (heads, magnitudes) = row.split_at_mut(head.len());
    heads.copy_from_slice(&head);
    // `hypot` would be exact where squares overflow, but costs 2 % of a fast run.
    for (magnitude, Wrench { fx, fy, .. }) in magnitudes.iter_mut().zip(forces) {
        *magnitude = (fx * fx + fy * fy).sqrt();
    }
}

/// Returns the quantities of [`QUANTITIES`] in a row of columns.
fn points(layout: Layout, row: &[f64]) -> [Point; QUANTITIES.len()] {
    let (head, sleeves) = row.split_at(columns::HEAD.len());
    let (externals, others) = sleeves.split_at(layout.external_sleeves);
    let internals = &others[..layout.internal_sleeves];
    [&head[..1], &head[1..2], externals, internals].map(|all| sampling::point(all.iter().copied()))
}
