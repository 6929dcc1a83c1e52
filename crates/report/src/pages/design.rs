//! Page and text of a design: motion of the shafts, load sharing, and loads of the contacts.

use std::f64::consts::PI;

use crate::figure::{self, number, table};
use crate::format::{self, joined, significant};
use crate::stack::stack;
use crate::study::{Axis, Block, Chart, Decision, Fact, Mark, Question, Section, Study, Style};
use crate::terminal::{self, list, titled};
use pinwheel_scene::catalogue::{Draft, MANY};
use pinwheel_scene::derived;
use pinwheel_studies::Provenance;
use pinwheel_studies::design::{DesignResult, Joint, Limits, Rest, Share};
use pinwheel_timeseries::figure::{Figure, FigureDef, definitions as defs};
use pinwheel_timeseries::table::{Shown, Table};

mod curves;
mod limits;
mod loads;

pub use limits::answer;
pub(crate) use limits::{both_bear, tile as bears};
pub(crate) use loads::{bearing_chart, sharing_charts};

use crate::pages::{DOUBT, animation, band, doubts, next, render, sure};
use curves::{Drawn, chart, degrees, line, of_design};
use loads::{bearings, sharing};

/// True for figures of the first screen.
pub(crate) fn is_headline(def: &FigureDef) -> bool {
    let headlines = [
        &defs::LOST_MOTION,
        &defs::STIFFNESS,
        &defs::ERROR_RATED,
        &defs::EXTERNAL_FORCE,
        &defs::EXTERNAL_PRESSURE,
        &defs::EFFICIENCY,
    ];
    headlines.iter().any(|headline| headline.key == def.key)
}

/// Returns name and sentence of the parts whose compliance lost motion and stiffness include.
fn given_way(design: &DesignResult) -> (&'static str, String) {
    match design.budget.split_last() {
        None => (CONTACTS, CONTACTS_ONLY.to_owned()),
        Some((last, before)) => {
            let before = joined(", ", before.iter().map(|share| share.part));
            let names = joined(" and ", [&before, last.part]);
            let text = format!(
                "Lost motion and stiffness are those of {names}; all else, and the housing, is rigid here."
            );
            ("what gives way", text)
        }
    }
}

const CONTACTS: &str = "contacts only";
/// Sentence on lost motion and stiffness of a scene without bearings.
const CONTACTS_ONLY: &str = "Lost motion and stiffness are those of the contacts: bearings, pins, discs and housing are rigid here. Real \
                             gears are softer by factors.";

/// Returns the page.
pub fn page(design: &DesignResult, origin: &Provenance) -> String {
    let scene = &design.scene;
    let caption = "For a data sheet; after \u{b1} how far a figure may be off numerically: by the poses that were looked at, or by the run's own \
                   verification";
    let all = table(caption, &design.figures, |one| how(design, one));
    let mut first = Section::new("figures", "Figures").with(all);
    if !design.shares().is_empty() {
        let caption = "Compliance: what gives way under the rated load";
        first = first.with(Block::Html(stack(caption, &design.shares())));
    }
    if !design.budget.is_empty() {
        first = first.with(budget(design));
    }
    first = first.with(Vec::from_iter(design.bands.iter().flat_map(band::blocks)));
    let mut sections = vec![
        first,
        limits::section(&design.limits),
        torsion(design),
        transmission(design),
        sharing(design),
        bearings(design),
    ];
    if !design.efficiency.is_empty() {
        sections.push(efficiency(design));
    }
    sections.extend(design.joint.as_ref().map(joint));
    sections.push(dimensions(design));
    let study = Study {
        title: scene.name.clone(),
        eyebrow: "Pinwheel design".to_owned(),
        lead: format!(
            "{} A gear of ratio {} under its rated {} N m. Statics unless said otherwise: contacts in balance, exact geometry, \
             the law `{}`.",
            sentence(&scene.description),
            design.dimensions.ratio,
            format::plain(design.rated_torque_n_m),
            scene.contact.law
        ),
        tiles_title: format!("At {} N m", format::plain(design.rated_torque_n_m)),
        decision: decision(design, origin),
        tiles: headlines(design).map(figure::tile).collect(),
        below: vec![
            Block::heading("May I use them?"),
            Block::Facts(
                unsure(design)
                    .into_iter()
                    .chain(notes(design))
                    .map(fact)
                    .collect(),
            ),
            Block::Html(files(design)),
        ],
        aside: animation::aside(design.motion.as_ref()),
        sections,
        ..Study::default()
    };
    render(study, origin)
}

/// Figures of the first screen.
fn headlines(design: &DesignResult) -> impl Iterator<Item = &Figure> {
    let figures = design.figures.iter();
    figures.filter(|one| is_headline(&one.def))
}

fn decision(design: &DesignResult, origin: &Provenance) -> Decision {
    let cycle = design.cycle.as_ref();
    let run = cycle.and_then(|cycle| cycle.lost_motion_arcmin);
    let both = design.torsion.lost_motion_at_0_arcmin.zip(run);
    let right = |answer, why| Question::Right.answered(Mark::Warn, answer, why);
    let right = match both.filter(|(statics, _)| *statics != 0.0) {
        Some((statics, run)) => {
            let off = format::relative((run / statics - 1.0).abs());
            let why = "lost motion by statics and by a run; no other program";
            right(format!("two ways, {off} apart"), why)
        }
        None => right("one way".to_owned(), "statics alone; no other program"),
    };
    let sure = sure(headlines(design));
    let open = "whether other engines confirm the forces";
    let next = next(origin, "compare", open);
    [Some(right), Some(bears(&design.limits)), sure, Some(next)]
}

/// Links to the files that stand beside the page.
fn files(design: &DesignResult) -> String {
    let link = |name: &str| format!("<a href=\"{name}\">{name}</a>");
    let discs = design.discs.iter();
    let discs = discs.map(|disc| link(&format!("disc_{}.dxf", disc.number())));
    let joint = design.joint.iter().map(|_| link("joint.urdf"));
    let links = joined(", ", discs.chain(joint));
    format!("<p class=\"about\">Drawings beside this page: {links}</p>")
}

/// Returns notes on the use of the figures.
fn notes(design: &DesignResult) -> Vec<(&'static str, String)> {
    let mut notes = vec![given_way(design)];
    let rest = design.rest.as_ref();
    notes.extend(rest.map(|rest| ("stated stiffness", fitted(rest))));
    let parts = design.budget.iter();
    let most = parts.max_by(|a, b| a.share.total_cmp(&b.share));
    notes.extend(most.map(|most| {
        let share = significant(100.0 * most.share, 2);
        let text = format!("{}: {share} % of the compliance", most.part);
        ("stiffen this first", text)
    }));
    notes.extend(design.bands.iter().flat_map(band::rows));
    let (scene, drive) = (&design.scene, &design.scene.drive);
    if drive.output_torque_n_m * drive.input_speed_rad_s * scene.output_per_input() > 0.0 {
        let text =
            "drives this gear; give drive.output_torque_n_m the other sign for a load that resists";
        notes.push(("load", text.to_owned()));
    }
    notes
}

/// Returns rows on implausible values of the scene, and on limits that were not judged.
fn unsure(design: &DesignResult) -> Vec<(&'static str, String)> {
    let mut rows = doubts(&design.scene);
    rows.extend(limits::unjudged(&design.limits).map(|open| ("not judged", open)));
    rows
}

fn fact((label, text): (&str, String)) -> Fact {
    let is_warning = [CONTACTS, band::OUTSIDE, DOUBT].contains(&label);
    let mark = if is_warning { Mark::Warn } else { Mark::None };
    Fact::new(label, mark, text)
}

/// Returns the text for a terminal; `verbose`: with the definition of each figure.
pub fn text(design: &DesignResult, verbose: bool) -> String {
    let mut table = table("", &design.figures, |one| how(design, one));
    let mut rows = vec![(limits::QUESTION, limits::sentence(&design.limits))];
    rows.extend(unsure(design));
    if !verbose {
        table.columns.pop();
        // Reasons for missing figures are essential.
        let without = design.figures.iter();
        rows.extend(without.filter_map(|one| Some((&*one.def.label, one.withheld.clone()?))));
    }
    for share in &design.budget {
        rows.push(("budget", budgeted(share)));
    }
    rows.extend(notes(design));
    let next = "`pinwheel compare` of this scene: whether other engines confirm the forces";
    rows.push(("next", next.to_owned()));
    if !verbose {
        let hint = "how each figure is, and every limit: --verbose, or the page";
        rows.push(("counted", hint.to_owned()));
    }
    let limits = &design.limits;
    let limits = verbose.then(|| terminal::table(&limits::table(limits)) + "\n");
    let table = terminal::table(&table) + "\n";
    let parts = [table, limits.unwrap_or_default(), terminal::pairs(rows)];
    titled(&design.scene.name, parts)
}

/// Returns the text for a terminal on a scene from catalogue data. `weak`: limits of a gear that does not bear its load,
/// and the factor on the pin circle with which it does.
pub fn draft(draft: &Draft, weak: Option<(Limits, Option<f64>)>) -> String {
    let row = |what: &str, value: String, how: &str| [what.to_owned(), value, how.to_owned()];
    let of = derived(&draft.scene);
    let mm = |metres: f64| format!("{} mm", number(1e3 * metres));
    let turns = match draft.scene.cranks {
        None if of.ratio > MANY => {
            "input turns per output turn, in one stage; of two stages in one housing make each a scene"
        }
        _ => "input turns per output turn",
    };
    let mut rows = vec![
        row("ratio", of.ratio.to_string(), turns),
        row("wall, hole to profile", mm(of.walls.hole_to_profile_m), ""),
        row("wall, hole to hole", mm(of.walls.hole_to_hole_m), ""),
        row("gap, pin to pin", mm(of.walls.sleeve_to_sleeve_m), ""),
    ];
    let bend = mm(of.smallest_convex_radius_m);
    let undercut = "a larger pin radius undercuts the disc";
    rows.push(row("sharpest bend of the pins' path", bend, undercut));
    let force = format!("{} N", number(of.external_force_estimate_n));
    let how = "external, rigid: 4 T/(e zs zk)";
    rows.push(row("largest pin force", force, how));
    if let Some((limits, times)) = weak {
        let (word, why) = answer(&limits);
        let remedy = times.map_or_else(
            || "give a larger diameter or a smaller torque".to_owned(),
            |times| format!("a diameter {} times as large does", significant(times, 3)),
        );
        rows.push(row(limits::QUESTION, word, &format!("{why}; {remedy}")));
    }
    for key in &draft.suggested {
        let name = key.rsplit('.').next().unwrap_or(key);
        rows.push(row("suggested", String::new(), name));
    }
    titled(&draft.scene.name, [list(rows)])
}

fn sentence(text: &str) -> String {
    match text.trim_end_matches('.') {
        "" => String::new(),
        text => format!("{text}."),
    }
}

/// Returns the definition of a figure, its spread over the mesh, and the lost motion by statics.
fn how(design: &DesignResult, one: &Figure) -> String {
    let statics = design.torsion.lost_motion_at_0_arcmin;
    let statics = statics.filter(|_| one.is(&defs::LOST_MOTION_RUN));
    let statics = statics.map(|lost| format!("{} by statics at that pose", number(lost)));
    joined("; ", [figure::how(one)].into_iter().chain(statics))
}

fn joint(joint: &Joint) -> Section {
    let caption = "Springs of the joint, which act beyond their dead band";
    let springs = Table::of(caption, &joint.springs)
        .figure("Dead band, both sides", "rad", |of| 2.0 * of.dead_band_rad)
        .figure("Stiffness", "N m/rad", |of| of.stiffness_n_m_per_rad);
    Section::new("joint", "As a joint")
        .with(format!(
            "The gear as one joint of a robot's model, of ratio {}: the files `joint_mujoco.xml`, `joint.urdf` and `joint.sdf` hold it, \
             the latter two for Drake as well. It has no transmission error, and everywhere the mesh's mean stiffness and play.",
            joint.ratio
        ))
        .with(table("What the joint is made of", &joint.figures, figure::how))
        .with(Block::folded("Springs in parallel", springs))
}

/// Returns the chart of twist over torque, by statics and by a run.
pub(crate) fn torsion_chart(designs: &Drawn<'_>) -> Chart {
    let mut series = Vec::new();
    for (k, (_, design)) in designs.iter().enumerate() {
        let torsion = &design.torsion;
        let statics = line(&torsion.torque_n_m, &torsion.twist_arcmin).styled(Style::Both);
        series.push(of_design(designs, k, (0, "statics"), statics));
        let Some(cycle) = &design.cycle else { continue };
        let closed = cycle.closed_from.min(cycle.angle_arcmin.len());
        let half = closed + (cycle.angle_arcmin.len() - closed) / 2;
        for (what, range) in [
            ((1, "run, load falls"), closed..half),
            ((2, "run, load rises"), half..cycle.angle_arcmin.len()),
        ] {
            let (x, y) = (&cycle.torque_n_m[range.clone()], &cycle.angle_arcmin[range]);
            series.push(of_design(designs, k, what, line(x, y)));
        }
    }
    let (x, y) = ("Torque on the output (N m)", "Twist (arcmin)");
    chart("Twist of the output, input locked", x, y, series)
}

fn torsion(design: &DesignResult) -> Section {
    let mut text = "The input is locked and the load is taken from one direction to the other. Lost motion is the twist between +3 and -3 % of \
                    the rated torque, the largest of all poses over the mesh; stiffness the slope between 50 and 100 %."
        .to_owned();
    if design.cycle.is_some() {
        text.push_str(
            " The run takes the load there and back so slowly that the gear follows; the width of its loop is what friction holds back. \
             Friction is regularised: a contact that hardly slides gives way slowly.",
        );
    }
    Section::new("torsion", "Lost motion and stiffness")
        .with(text)
        .with(vec![torsion_chart(&[("", design)])])
}

/// Names of the loads of transmission errors and their orders.
const LOADS: [&str; 2] = ["rated load", "no load"];

/// Returns charts of the transmission error over the period of each, and of its orders; for several designs under the rated
/// load.
pub(crate) fn transmission_charts(designs: &Drawn<'_>) -> [Chart; 2] {
    let (mut series, mut spectrum) = (Vec::new(), Vec::new());
    for (k, (_, design)) in designs.iter().enumerate() {
        let turn = degrees(&design.input_angle_rad);
        for (n, (of, load)) in design.transmission.iter().zip(LOADS).enumerate() {
            let about_mean = of.error_arcmin.iter().map(|error| error - of.mean_arcmin);
            let error = line(&turn, &about_mean.collect::<Vec<_>>());
            series.push(of_design(designs, k, (n, load), error));
            if n > 0 && designs.len() > 1 {
                continue; // Points have no dash to distinguish them.
            }
            let harmonics = of.harmonics.iter();
            let harmonics = harmonics.map(|h| (h.input_order, h.amplitude_arcmin));
            let (orders, amplitudes): (Vec<f64>, Vec<f64>) = harmonics.unzip();
            let points = line(&orders, &amplitudes).styled(Style::Points);
            spectrum.push(of_design(designs, k, (n, load), points));
        }
    }
    let (x, y) = ("Input angle (degrees)", "Error about its mean (arcmin)");
    let error = chart("Transmission error", x, y, series);
    let (x, y) = (
        Axis::linear("Cycles per turn of the input"),
        Axis::log("Amplitude (arcmin)"),
    );
    [error, Chart::new("Orders", x, y, spectrum)]
}

fn transmission(design: &DesignResult) -> Section {
    let rows = design.transmission.iter().zip(LOADS);
    let rows = rows.flat_map(|(of, load)| of.harmonics.iter().take(6).map(move |h| (load, h)));
    let orders = Table::of("Largest orders of the transmission error", rows)
        .text("", "Load", |(load, _)| *load)
        .figure("Per input turn", "", |(_, h)| h.input_order)
        .figure("Per output turn", "", |(_, h)| h.output_order)
        .figure("Amplitude", "arcmin", |(_, h)| h.amplitude_arcmin)
        .text("", "Of", |(_, h)| h.of);
    Section::new("transmission-error", "Transmission error")
        .with(
            "Output angle less that of the ideal mesh, about its mean, over one period in which both meshes come round. What repeats with the \
             mesh excites the machine at its order times the input's speed.",
        )
        .with(Vec::from(transmission_charts(&[("", design)])))
        .with(Block::folded("Largest orders", orders))
}

/// Returns the table of the compliance budget, by parts.
fn budget(design: &DesignResult) -> Table {
    let caption = "Compliance budget: what gives way, each part with all before it";
    let (stiffness, lost) = ("Stiffness up to here", "Lost motion up to here");
    Table::of(caption, &design.budget)
        .text("", "Part", |share| share.part)
        .number("", "Share of the compliance", |share| 100.0 * share.share)
        .unit("%")
        .shown(Shown::Digits(3))
        .figure(stiffness, "N m/arcmin", |of| of.stiffness_n_m_per_arcmin)
        .figure(lost, "arcmin", |of| of.lost_motion_arcmin)
        .done()
}

/// Describes the fitted compliance and its limitations.
fn fitted(rest: &Rest) -> String {
    format!(
        "A fit, not a prediction: with bearings.output_torsion_n_m_rad={} the gear has the stated {} N m/arcmin. The rest is then {} % \
         of the compliance; nothing here says what it is made of. Figures stay without it until the scene has that key.",
        significant(rest.output_torsion_n_m_rad, 4),
        number(rest.stated_n_m_per_arcmin),
        significant(100.0 * rest.share, 2)
    )
}

fn budgeted(share: &Share) -> String {
    format!(
        "{} {} % of the compliance; with all before {} N m/arcmin, lost motion {} arcmin",
        share.part,
        significant(100.0 * share.share, 2),
        significant(share.stiffness_n_m_per_arcmin, 3),
        significant(share.lost_motion_arcmin, 2)
    )
}

fn efficiency(design: &DesignResult) -> Section {
    let rpm = |rad_s: f64| rad_s.abs() * 30.0 / PI;
    let efficiency = Table::of("Efficiency over speed and torque", &design.efficiency)
        .figure("Input", "rpm", |run| rpm(run.input_speed_rad_s))
        .figure("Load", "N m", |run| run.output_torque_n_m)
        .number("", "Lost in contacts", |run| {
            Some(run.efficiency?.lost_share)
        })
        .unit("%")
        .shown(Shown::Percent)
        .number("", "Created by the law", |run| {
            Some(run.efficiency?.created_share)
        })
        .unit("%")
        .display(|run| Some(format::signed_percent(run.efficiency?.created_share)))
        .text("", "Run", |run| run.status);
    Section::new("efficiency", "Efficiency")
        .with(
            "Runs with the scene's own friction and damping. Losses of bearings, seals and oil are not in the model. What a contact law creates or \
             destroys by itself stands beside them.",
        )
        .with(efficiency)
}

fn dimensions(design: &DesignResult) -> Section {
    let lines = design.dimensions.lines(&design.scene);
    let lengths = lines.iter().filter(|line| line.unit == "m");
    let sizes = Table::of("Sizes, walls and gaps", lengths)
        .text("", "What", |line| line.what)
        .figure("mm", "", |line| 1e3 * line.value)
        .text("", "How", |line| line.how);
    let sizes = Block::folded("What follows from the dimensions", sizes);
    Section::new("dimensions", "Dimensions").with(sizes)
}
