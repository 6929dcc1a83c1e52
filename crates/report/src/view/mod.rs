//! The page as text: every number formatted, every word chosen, so that the templates only place
//! things. Nothing here is escaped: the templates do that.

mod banner;
mod costs;
mod energy;
mod figures;
mod matrices;
mod pairs;
mod tracks;

use askama::Template;
use pinwheel_compare::{Assessment, Comparison, Track, Verdict, WindowKind};

use crate::assets::{ASSETS, Assets};
use crate::chart_data::{ChartData, json_for_script};
use crate::{Fact, ReportError, ReportInput, animation, colours, format, packed};
use banner::{Banner, Difference, Tile};
use costs::Costs;
use tracks::TrackSection;

/// The whole page.
#[derive(Template)]
#[template(path = "page.html")]
pub(crate) struct Page<'a> {
    scene: &'a str,
    description: &'a str,
    banner: Banner,
    tiles: Vec<Tile>,
    /// The window of the tiles.
    tiles_label: String,
    differences: Vec<Difference>,
    remarks: Vec<String>,
    /// Markup of the moving gearbox, or nothing.
    animation: Option<String>,
    chart_notes: Vec<String>,
    chart_json: Option<String>,
    /// All metrics of all pairs, packed: nobody reads them all, and as markup they are a sixth of the page.
    metrics: String,
    tracks: Vec<TrackSection>,
    engines: Vec<EngineCard>,
    energy: Vec<energy::EnergyRow>,
    costs: Costs,
    modelled: &'a [Fact],
    left_out: &'a [Fact],
    assumptions: &'a [Fact],
    versions: &'a [(String, String)],
    machine: &'a [(String, String)],
    command: &'a str,
    scene_toml: &'a str,
    made: Option<&'a str>,
    assets: Assets,
    page_js: &'static str,
}

/// One engine in words.
struct EngineCard {
    name: String,
    version: String,
    track: Track,
    summary: String,
    differences: String,
    /// Colour and dash.
    style: usize,
    /// Why it was not judged, if it was not.
    trouble: Option<String>,
    /// When and why, for a recorded run.
    recorded: Option<String>,
}

impl<'a> Page<'a> {
    pub(crate) fn of(input: &'a ReportInput<'a>) -> Result<Self, ReportError> {
        let comparison = input.comparison;
        for engine in &comparison.engines {
            if !input.participants.iter().any(|p| p.name == engine.name) {
                return Err(ReportError::UnknownEngine(engine.name.clone()));
            }
        }
        let names: Vec<&str> = comparison.engines.iter().map(|e| e.name.as_str()).collect();
        let styles = colours::styles(&names);
        let charts = ChartData::of(comparison, input.participants);
        let tracks = tracks::sections(comparison, &styles);
        let groups = tracks.iter().flat_map(|track| &track.groups);
        let pairs = groups.flat_map(|group| &group.pairs);
        Ok(Self {
            scene: &comparison.context.scene,
            description: &comparison.context.description,
            banner: banner::banner(comparison),
            tiles: banner::tiles(comparison),
            tiles_label: banner::tiles_label(comparison),
            differences: banner::differences(comparison),
            remarks: comparison
                .absent_windows
                .iter()
                .map(|w| format!("No {} window: {}.", w.kind.word(), w.reason))
                .chain(comparison.windows.iter().filter_map(|w| w.remark()))
                .chain(comparison.context.divergence.iter().map(|d| d.told.clone()))
                .collect(),
            animation: input
                .animation
                .as_ref()
                .map(|(view, begin)| animation::markup(std::slice::from_ref(view), *begin))
                .transpose()?,
            chart_notes: charts.as_ref().map(notes).unwrap_or_default(),
            chart_json: charts.as_ref().map(json_for_script).transpose()?,
            metrics: packed::text(&serde_json::to_string(&pairs::all_metrics(pairs))?),
            tracks,
            engines: engine_cards(comparison, &styles),
            energy: energy::rows(comparison, &styles),
            costs: costs::table(comparison, &styles),
            modelled: &input.modelled,
            left_out: &input.left_out,
            assumptions: &input.assumptions,
            versions: &input.versions,
            machine: &input.machine,
            command: &input.command,
            scene_toml: &input.scene_toml,
            made: input.made.as_deref(),
            assets: ASSETS,
            page_js: include_str!("../../assets/report.js"),
        })
    }
}

/// What a reader of the charts has to know.
fn notes(charts: &ChartData) -> Vec<String> {
    let mut notes = charts.notes.clone();
    notes.push(
        "Samples of recordings are marks. No engine is the truth: differences can be taken to any."
            .to_owned(),
    );
    notes
}

fn engine_cards(comparison: &Comparison, styles: &[usize]) -> Vec<EngineCard> {
    comparison
        .engines
        .iter()
        .zip(styles)
        .map(|(engine, &style)| EngineCard {
            name: engine.name.clone(),
            version: engine.version.clone(),
            track: engine.track,
            summary: engine.summary.clone(),
            differences: engine.differences.clone(),
            style,
            trouble: engine.status.reason(),
            recorded: engine.cost.recorded.clone(),
        })
        .collect()
}

/// A window in words, e.g. `Steady, 0.3–0.6 s`.
fn window_label(comparison: &Comparison, kind: WindowKind) -> String {
    let word = match kind {
        WindowKind::Steady => "Steady",
        WindowKind::Transient => "Transient",
        WindowKind::Whole => "Whole run",
    };
    match comparison.windows.iter().find(|w| w.kind == kind) {
        Some(window) => {
            format!(
                "{word}, {}\u{2013}{}\u{202f}s",
                format::plain(window.from_s),
                format::plain(window.to_s)
            )
        }
        None => word.to_owned(),
    }
}

/// A quantity in words; its name if the comparison does not list it.
fn quantity_label<'a>(comparison: &'a Comparison, name: &'a str) -> &'a str {
    comparison
        .quantities
        .iter()
        .find(|q| q.name == name)
        .map_or(name, |q| &q.label)
}

/// A verdict as class, mark and word; never by colour alone.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Mark {
    class: &'static str,
    sign: &'static str,
    word: &'static str,
}

impl Mark {
    /// Of what nothing is known.
    const NOTHING: Self = Self {
        class: "unjudged",
        sign: "\u{25cb}",
        word: "not compared",
    };
}

fn mark(found: &Assessment) -> Mark {
    let (class, sign) = match found.verdict {
        Verdict::Agree => ("within", "\u{2713}"),
        Verdict::Differ => ("exceeded", "\u{2715}"),
        Verdict::Inconclusive | Verdict::NotCompared => ("unjudged", "\u{25cb}"),
    };
    Mark {
        class,
        sign,
        word: found.verdict.word(),
    }
}
