//! Sections of a comparison's page: tracks with their pairs and figures, energy, costs, engines.

use crate::format::{self, distinct, joined};
use crate::study::{Block, Section};
use pinwheel_compare::comparison::{EngineSummary, Figures};
use pinwheel_compare::uncertainty::Norm;
use pinwheel_compare::{Assessment, Metric, Quantity, SharedModel, quantities};
use pinwheel_timeseries::norms::Statistics;
use pinwheel_timeseries::table::{Mark, Shown, Table};

use super::common::{Page, mark, span};
use super::{pairs, words};

impl<'a> Page<'a> {
    /// Returns sections in the order measured, shared law, own contact, native. A user with measured data looks for these
    /// first. Tables of all tracks include native runs, so only their mutual comparisons come at the end.
    pub(super) fn tracks(&self) -> Vec<Section> {
        let finished = self.comparison.engines.iter();
        let finished = finished.filter(|e| e.status.is_finished());
        let mut names: Vec<SharedModel> = finished.map(|e| e.track).collect();
        let last = |of: SharedModel| (of == SharedModel::Native, of != SharedModel::Measured, of);
        names.sort_by_key(|&name| last(name));
        names.dedup();
        let alone = names.len() == 1;
        let sections = names.iter().enumerate();
        let sections = sections.map(|(k, &track)| self.track(track, k, alone));
        sections.flatten().collect()
    }

    fn track(&self, track: SharedModel, place: usize, alone: bool) -> Option<Section> {
        let (title, about) = match track {
            SharedModel::Native => (
                "Native",
                "Pinwheel's own solver: its runs against each other, and each against the load.",
            ),
            SharedModel::SharedLaw => (
                "Shared law",
                "Each engine supplies bodies, joints and time integration; all evaluate the same \
                 contact law inside their steps. This checks the multibody side to many digits. It \
                 cannot find an error in the law, which all sides share.",
            ),
            SharedModel::OwnContact => (
                "Own contact",
                "Each engine detects and resolves contact itself. This checks geometry and law \
                 independently, to a few per cent.",
            ),
            SharedModel::Measured => (
                "Measured",
                "Data from elsewhere, another program's export or a test rig, by a map of its columns. \
                 Model, parameters, units and sampling may differ. Only limits and uncertainties that the \
                 map states are used.",
            ),
        };
        let mut blocks = vec![about.into()];
        if track == SharedModel::Measured {
            blocks.extend(words::of_measured(self.comparison).map(Block::Text));
        }
        let explains = place == 0;
        let pairs = self.pairs(track, explains);
        // Native figures are beside those of every other track, and repeated only without one.
        let figures = if track == SharedModel::Native && !alone {
            Vec::new()
        } else {
            self.figures(track)
        };
        if pairs.is_empty() && figures.is_empty() {
            return None;
        }
        blocks.extend(self.matrices(track, explains));
        blocks.extend(pairs);
        blocks.extend(figures);
        Some(Section::new(format!("track-{}", place + 1), title).with(blocks))
    }

    /// Returns every engine of a track against every other, by window.
    fn matrices(&self, track: SharedModel, explains: bool) -> Vec<Block> {
        let all = self.comparison.matrices.iter();
        let all: Vec<_> = all.filter(|matrix| matrix.track == track).collect();
        if all.is_empty() {
            return Vec::new();
        }
        let mut blocks = vec![Block::heading("Every engine against every other")];
        if explains {
            blocks.push(
                "Each cell shows the relative difference that decides the pair's verdict, and after \u{b1} the numerical \
                 uncertainty of both together, or how it was measured. Green agrees, red differs; the darker, the more of \
                 that uncertainty is used. Choose a cell for all that was compared."
                    .into(),
            );
        }
        for matrix in all {
            // A triangle suffices: a difference has no direction.
            let rows = matrix.engines.iter().enumerate().skip(1);
            let mut table =
                Table::of(self.window(matrix.window), rows).text("", "Engine", |(_, name)| *name);
            let last = matrix.engines.len().saturating_sub(1);
            for (j, name) in matrix.engines.iter().enumerate().take(last) {
                let cell = |i: usize| matrix.cell(i, j).filter(|_| j < i);
                let result = |i: usize| cell(i).map(|cell| &cell.result);
                table = table
                    .number("", name, |(i, _)| Some(result(*i)?.difference?.abs()))
                    .display(|(i, _)| Some(result(*i).map_or_else(String::new, decisive)))
                    .shaded(|(i, _)| result(*i).map(|result| shade(result.share())))
                    .marked(|(i, _)| result(*i).map_or(Mark::None, mark))
                    .linked(|(i, _)| Some(pairs::id(cell(*i)?.pair)));
            }
            blocks.push(table.into());
        }
        blocks
    }

    /// Returns the main figures of every engine of a track, by window.
    fn figures(&self, track: SharedModel) -> Vec<Block> {
        let loads = self.comparison.quantities.iter().filter(|q| q.is_load());
        let loads: Vec<&Quantity> = loads.collect();
        let mut blocks = Vec::new();
        for window in &self.comparison.windows {
            let engines = self.comparison.engines.iter();
            let engines = engines.filter(|e| e.track == track || e.track == SharedModel::Native);
            let rows = engines.filter_map(|e| Some((e, e.figures_in(window.kind)?)));
            let rows: Vec<(&EngineSummary, &Figures)> = rows.collect();
            if rows.is_empty() || loads.is_empty() {
                continue;
            }
            let label = self.window(window.kind);
            let mut table = self.of_engines(&label, rows.iter().copied(), |(engine, _)| engine);
            for quantity in &loads {
                for (name, of, norm) in statistics(quantity) {
                    let label = format!("{}, {name}", quantity.label);
                    table = table
                        .number("", &label, |(_, figures)| {
                            figures.quantities.get(&quantity.name).map(of)
                        })
                        .unit(&quantity.unit)
                        .uncertain(|(engine, figures)| {
                            let sampling = figures.sampling.get(&quantity.name).map_or(0.0, of);
                            Some(engine.u(&quantity.name, window.kind, *norm)? + sampling)
                        });
                }
            }
            let percent = |share: Option<f64>| share.map(|share| 100.0 * share);
            let table = table
                .number("", "Efficiency", |(_, figures)| percent(figures.efficiency))
                .unit("%");
            let mut shown = vec![table.done().without_empty().into()];
            shown.extend(without_efficiency(&rows));
            if blocks.is_empty() {
                blocks.extend(shown);
            } else {
                let title = format!("Figures of each engine: {label}");
                blocks.push(Block::folded(title, shown));
            }
        }
        if !blocks.is_empty() {
            blocks.insert(0, Block::heading("Figures of each engine"));
        }
        blocks
    }

    /// Returns the section on the energy of each run.
    pub(super) fn energy(&self) -> Option<Section> {
        let engines = self.comparison.engines.iter();
        let rows = engines.flat_map(|e| e.cost.energy.iter().map(move |energy| (e, energy)));
        let mut table = self
            .of_engines("Energy of each engine", rows, |(engine, _)| engine)
            .text("", "Window", |(_, e)| span(e.from_s, e.to_s));
        // Tenths of a millijoule of tens of joules: smaller remainders are rounding.
        type Joules = fn(&pinwheel_timeseries::EnergyAudit) -> Option<f64>;
        let joules: [(&str, Joules); 11] = [
            ("Driver", |e| Some(e.driver_j)),
            ("Load", |e| Some(e.load_j)),
            ("Kinetic", |e| Some(e.kinetic_j)),
            ("Stored", |e| Some(e.stored_j)),
            ("Damping", |e| Some(e.damping_j)),
            ("Friction", |e| Some(e.friction_j)),
            ("of contacts", |e| e.contact_friction_j),
            ("of bearings", |e| e.bearing_friction_j),
            ("of sleeves on pins", |e| e.sleeve_friction_j),
            ("of seals", |e| e.seal_friction_j),
            ("Remainder", |e| Some(e.remainder_j)),
        ];
        for (label, of) in joules {
            table = table
                .number("", label, |(_, e)| of(e))
                .unit("J")
                .shown(Shown::Decimals(4));
        }
        let table = table
            .number("", "Share of work", |(_, e)| e.remainder_share)
            .unit("%")
            .shown(Shown::Percent)
            .done()
            .without_empty();
        let about = "Growth of kinetic and stored energy = work of driver and load \u{2212} losses + remainder. The remainder is \
                     unaccounted energy: an integrator's error, or a contact law that creates energy because it has no potential.";
        let section = Section::new("energy", "Energy");
        (!table.is_empty()).then(|| section.with(about).with(table).folded(""))
    }

    /// Returns the section with the cost of every run.
    pub(super) fn costs(&self) -> Section {
        let all = &self.comparison.engines;
        // Measured data have no cost, and a recording's time is another machine's.
        let own = |e: &&EngineSummary| e.track != SharedModel::Measured;
        let time = |e: &&EngineSummary, of: f64| Some(of).filter(|_| own(e));
        let wall = |e: &&EngineSummary| Some(e.cost.wall_s).filter(|_| e.cost.recorded.is_none());
        let longest = all.iter().filter_map(|e| wall(&e)).fold(0.0, f64::max);
        let count = |e: &&EngineSummary, of: u64| Some(of).filter(|_| own(e));
        let grouped = |n: u64| format::count(n);
        let table = self
            .of_engines("Costs of each engine", all, |e| e)
            .text("", "Shares", |e| e.track.shares())
            .text("", "Run", |e| match (&e.cost.recorded, &e.cost.kept) {
                (Some(_), _) => "recorded",
                (None, Some(_)) => "kept",
                (None, None) => e.status.word(),
            })
            .number("", "Wall time", |e| time(e, e.cost.wall_s))
            .shown(Shown::Seconds)
            .shaded(|e| wall(e).filter(|_| longest > 0.0).map(|s| 0.6 * s / longest))
            .number("", "CPU time", |e| time(e, e.cost.cpu_s))
            .shown(Shown::Seconds)
            .integers("", "Right-hand sides", |e| count(e, e.cost.rhs_calls))
            .display(|e| count(e, e.cost.rhs_calls).map(grouped))
            .integers("", "Steps", |e| count(e, e.cost.steps))
            .display(|e| count(e, e.cost.steps).map(grouped));
        let rejects = all.iter().any(|e| e.cost.rejected_steps > 0);
        let rejected = |e: &&EngineSummary| count(e, e.cost.rejected_steps).filter(|_| rejects);
        let table = table
            .integers("", "Rejected", rejected)
            .display(|e| rejected(e).map(grouped))
            .number("", "Step", |e| time(e, e.cost.step_s))
            .shown(Shown::Seconds)
            .integers("", "Degrees of freedom", |e| {
                count(e, e.cost.degrees_of_freedom as u64)
            })
            .integers("", "Bodies", |e| count(e, e.cost.bodies as u64))
            .number("", "Joint drift", |e| e.cost.joint_drift_m)
            .shown(Shown::Metres)
            .text("", "Settings and notes", |e| {
                let notes = e.cost.recorded.iter().chain(&e.cost.notes);
                let all = [&e.cost.settings].into_iter().chain(notes);
                joined("; ", all.filter(|text| !text.is_empty()))
            });
        Section::new("costs", "Costs")
            .with("Times are of this machine and now, but for those of recorded and kept runs; counts are not.")
            .with(table.done().without_empty())
            .folded("")
    }

    /// Returns the section that describes the engines.
    pub(super) fn engines(&self) -> Section {
        let (caption, engines) = ("The engines and how they differ", &self.comparison.engines);
        let table = self
            .of_engines(caption, engines, |e| e)
            .text("", "Version", |e| &e.version)
            .text("", "Shares", |e| e.track.shares())
            .text("", "What it is", |e| &e.summary)
            .text("", "How it differs", |e| &e.differences)
            .text("", "Run", |e| {
                let kept = e.cost.kept.as_ref();
                let kept = kept.map(|of| format!("Kept: run by this version of Pinwheel on {of}."));
                let earlier = e.cost.recorded.clone().or(kept);
                e.status.reason().or(earlier).unwrap_or_default()
            })
            .marked(|e| Mark::bad(e.status.is_broken()));
        let section = Section::new("engines", "Engines").with(table);
        section.folded("how they differ")
    }
}

/// Returns the decisive figure with its uncertainty, or else its metric.
fn decisive(result: &Assessment) -> String {
    let figure = format::relative_or_none(result.difference.map(f64::abs));
    match result.combined() {
        Some(u) => format!("{figure} \u{b1}\u{202f}{}", format::relative(u)),
        None => format!("{figure} {}", result.metric.map_or("", Metric::label)),
    }
}

/// Returns the shade for a share of a bound: 0 for nothing, 1 for the full bound and more.
fn shade(share: f64) -> f64 {
    match share.is_nan() {
        true => 0.0,
        false => share.clamp(0.0, 1.0),
    }
}

/// Column of a quantity: label, statistic, and the norm of its uncertainty.
type Shows = (&'static str, fn(&Statistics) -> f64, Norm);

fn statistics(quantity: &Quantity) -> &'static [Shows] {
    if quantity.name == quantities::OUTPUT_TORQUE {
        &[("mean", |s| s.mean, Norm::Mean)]
    } else if quantity.is_torque() {
        &[
            ("mean", |s| s.mean, Norm::Mean),
            ("min", |s| s.min, Norm::Linf),
            ("max", |s| s.max, Norm::Linf),
        ]
    } else {
        &[
            ("max", |s| s.max, Norm::Peak),
            ("mean", |s| s.mean, Norm::Mean),
            ("rms", |s| s.rms, Norm::Rms),
        ]
    }
}

/// Returns the distinct reasons for missing efficiencies.
fn without_efficiency(rows: &[(&EngineSummary, &Figures)]) -> Vec<Block> {
    let of = |(_, figures): &(_, &Figures)| figures.efficiency_reason.clone();
    let reasons = distinct(rows.iter().filter_map(of));
    let texts = reasons.into_iter().map(|reason| {
        let without = rows.iter().filter(|row| of(row).as_ref() == Some(&reason));
        let whose = match without.clone().count() == rows.len() {
            true => String::new(),
            false => {
                let names = without.map(|(engine, _)| words::short(&engine.name));
                format!(" of {}", joined(", ", names))
            }
        };
        format!("No efficiency{whose}: {reason}.").into()
    });
    texts.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shades_are_shares() {
        assert_eq!([0.0, 0.5, 3.0, f64::NAN].map(shade), [0.0, 0.5, 1.0, 0.0]);
    }
}
