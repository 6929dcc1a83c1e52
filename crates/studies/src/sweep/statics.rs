//! Figures of balances as an engine of sweeps: no motion, so no time series, but what `pinwheel design` says of a gear.

use std::time::Instant;

use cpu_time::ThreadTime;
use pinwheel_engines::{
    Cancelled, Control, Ending, Engine, EngineInfo, Halt, Prepared, Run, RunStats, SharedModel,
};
use pinwheel_gearbox::Gearbox;
use pinwheel_timeseries::TimeSeries;

use crate::StudyError;
use crate::design::{self, DesignResult};

/// Its name in sweeps.
pub const STATICS: &str = "statics";

/// Columns of the results, and what they are of: over the poses of one period of the mesh, under the rated load unless the
/// name says otherwise.
pub(super) const FIGURES: [(&str, fn(&DesignResult) -> f64); 11] = [
    ("lost_motion_arcmin", |o| {
        o.torsion
            .lost_motion_arcmin
            .map_or(f64::NAN, |lost| lost.mean)
    }),
    ("largest_lost_motion_arcmin", |o| {
        o.torsion
            .lost_motion_arcmin
            .map_or(f64::NAN, |lost| lost.max)
    }),
    ("torsional_stiffness_n_m_per_arcmin", |o| {
        o.torsion.stiffness_n_m_per_arcmin.mean
    }),
    ("least_torsional_stiffness_n_m_per_arcmin", |o| {
        o.torsion.stiffness_n_m_per_arcmin.min
    }),
    ("transmission_error_peak_to_peak_arcmin", |o| {
        o.transmission[0].peak_to_peak_arcmin
    }),
    ("unloaded_transmission_error_peak_to_peak_arcmin", |o| {
        o.transmission[1].peak_to_peak_arcmin
    }),
    ("largest_external_sleeve_force_n", |o| {
        o.sharing[0].largest_force_n.max
    }),
    ("largest_internal_sleeve_force_n", |o| {
        o.sharing[1].largest_force_n.max
    }),
    ("largest_external_pressure_pa", |o| o.pressure[0].largest_pa),
    ("largest_internal_pressure_pa", |o| o.pressure[1].largest_pa),
    ("largest_bearing_force_n", |o| {
        let forces = o.bearings.iter().map(|bearing| bearing.force_n.max);
        forces.fold(0.0, f64::max)
    }),
];

/// Balances in place of a run.
pub(super) struct Statics;

impl Engine for Statics {
    fn info(&self) -> EngineInfo<'_> {
        EngineInfo {
            differences: "No motion: inertia, damping and friction have no part.",
            summary: "balances at rest over one period of the mesh; for sweeps alone",
            ..EngineInfo::own(STATICS, SharedModel::Native)
        }
    }

    fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").to_owned()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        let gearbox = gearbox.clone();
        Ok(Box::new(move |control: &Control<'_>| {
            let (wall, cpu) = (Instant::now(), ThreadTime::now());
            let watched = Control::silent(control.cancel);
            let found =
                design::figures_of(&gearbox, false, &watched).map_err(|error| match error {
                    StudyError::Cancelled => Halt::from(Cancelled),
                    error => Ending::unsupported(error).into(),
                })?;
            let stats = RunStats {
                wall_s: wall.elapsed().as_secs_f64(),
                cpu_s: cpu.elapsed().as_secs_f64(),
                settings: "balances".to_owned(),
                notes: found.preloaded.iter().cloned().collect(),
                ..RunStats::default()
            };
            let mut run = Run::new(TimeSeries::default(), stats);
            run.figures = FIGURES.map(|(name, of)| (name, of(&found))).to_vec();
            Ok(run)
        }))
    }
}
