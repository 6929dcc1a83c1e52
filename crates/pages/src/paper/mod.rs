//! The study of the paper as a page.

use std::sync::atomic::AtomicBool;

use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_report::animation::markup as animate;
use pinwheel_report::format::significant;
use pinwheel_report::study::{
    self, Axis, Block, Cell, Chart, Column, Section, Series, Study, Style, Table, Tile, Tone,
    render,
};
use pinwheel_scene::Scene;
use pinwheel_studies::paper::claims::Verdict;
use pinwheel_studies::paper::{Figure, Paper, Plot};

use pinwheel_studies::Provenance;

use crate::{PageError, animation};

mod text;
mod words;

pub use text::text;

/// The page; `cancel` stops it while the motion is computed.
///
/// # Errors
/// Stopped, or the page cannot be made.
pub fn page(found: &Paper, made: &Provenance, cancel: &AtomicBool) -> Result<String, PageError> {
    let verdicts = || {
        let figures = found
            .figures
            .iter()
            .filter(|f| f.id.starts_with("fig"))
            .map(|f| f.verdict);
        figures.chain(found.claims.iter().map(|c| c.verdict))
    };
    let count = |wanted: Verdict| verdicts().filter(|v| *v == wanted).count();
    let all = verdicts().count();
    let (holds, sometimes, not) = (
        count(Verdict::Holds),
        count(Verdict::Conditional),
        count(Verdict::DoesNotHold),
    );
    let mut sections = vec![overview(found)];
    if !found.claims.is_empty() {
        sections.push(claims(found));
    }
    sections.extend(motion(cancel)?);
    sections.extend(found.figures.iter().map(section));
    sections.push(costs(found));
    let study = Study {
        title: "The paper, computed again".into(),
        eyebrow: "Figures and claims of Król's multibody model of a cycloidal gearbox".into(),
        lead: "Each figure from our own runs in the paper's axes and units: what the paper says it shows, whether ours \
               shows it, and by which number. Figures of the paper are not reproduced here; the words are a summary."
            .into(),
        // A claim that does not hold is a finding, not a failure.
        verdict: Some(study::Verdict {
            tone: Tone::Neutral,
            headline: format!("{holds} of {all} figures and claims hold when computed again"),
            detail: format!(
                "{sometimes} hold under a condition, {not} do not; by {} runs.",
                found.runs
            ),
        }),
        tiles: tiles(found),
        sections,
        command: made.command.clone(),
        versions: made.versions(),
        machine: made.machine.rows(),
        ..Study::default()
    };
    Ok(render(&study)?)
}

/// One number of a figure, if it is there.
fn number(found: &Paper, figure: &str, name: &str) -> Option<f64> {
    let figure = found.figures.iter().find(|f| f.id == figure)?;
    figure
        .numbers
        .iter()
        .find(|n| n.name == name)
        .map(|n| n.value)
}

fn tiles(found: &Paper) -> Vec<Tile> {
    let mut tiles = Vec::new();
    let mut add = |label: &str, value: Option<String>, unit: &str, detail: &str| {
        if let Some(value) = value {
            tiles.push(Tile {
                label: label.into(),
                value,
                unit: unit.into(),
                detail: detail.into(),
            });
        }
    };
    let per_cent = |v: f64| format!("{:+.0}", 100.0 * v);
    add(
        "External force, 0.6 mm of backlash",
        number(found, "fig-12", "growth").map(per_cent),
        "%",
        "the paper: 50 %",
    );
    add(
        "Internal peaks, 0.6 mm, steady",
        number(found, "fig-13", "growth_steady").map(|v| format!("{:+.1}", 100.0 * v)),
        "%",
        "the paper: up to 25 %, temporarily",
    );
    add(
        "Torque at predicted orders",
        number(found, "spectrum", "predicted_share, exact profile")
            .map(|v| format!("{:.1}", 100.0 * v)),
        "%",
        "the paper: a random function of time",
    );
    if let Some(cost) = found.costs.iter().find(|c| c.what.starts_with("4000")) {
        add(
            "0.6 s with 4000 points",
            Some(format!("{:.2}", cost.ours_s)),
            "s",
            "the paper: 25 min",
        );
    }
    tiles
}

/// The gearbox without and with backlash, over the input turn that most figures draw.
fn motion(cancel: &AtomicBool) -> Result<Vec<Section>, PageError> {
    const TURN: (f64, f64) = (0.24, 0.36);
    let mut views = Vec::new();
    for backlash_mm in [0.0, 0.6] {
        let mut scene = Scene::paper();
        scene.gear.backlash_m = 1e-3 * backlash_mm;
        let title = if backlash_mm > 0.0 {
            format!("{backlash_mm} mm of backlash")
        } else {
            "without backlash".to_owned()
        };
        let built = scene.check().map_err(GearboxError::from);
        if let Ok(gearbox) = built.and_then(|scene| Gearbox::new(&scene)) {
            let (step, _) = animation::sampled(&gearbox.scene);
            views.extend(animation::window(&gearbox, &title, TURN, step, cancel)?);
        }
    }
    if views.is_empty() {
        return Ok(Vec::new());
    }
    let markup = animate(&views, TURN.0)?;
    Ok(vec![Section {
        id: "motion".into(),
        title: "Motion".into(),
        blocks: vec![
            Block::Text(
                "One turn of the input, from 0.24 to 0.36 s, as our solver computes it: with backlash fewer external sleeves carry the \
                 same load, each with a higher force."
                    .into(),
            ),
            Block::Html(markup),
        ],
    }])
}

fn overview(found: &Paper) -> Section {
    let rows = found
        .figures
        .iter()
        .map(|figure| {
            vec![
                Cell::text(&figure.name),
                Cell::text(words::figure(figure.verdict)).marked(words::mark(figure.verdict)),
                Cell::text(&figure.says),
                Cell::text(&figure.found),
            ]
        })
        .collect();
    Section {
        id: "figures".into(),
        title: "Overview".into(),
        blocks: vec![Block::Table(Table {
            caption: "What the paper's figures say, and what ours show".into(),
            columns: ["Figure", "By our runs", "The paper says", "By which number"]
                .map(Column::text)
                .to_vec(),
            rows,
        })],
    }
}

fn section(figure: &Figure) -> Section {
    let numbers = figure
        .numbers
        .iter()
        .map(|n| {
            vec![
                Cell::text(n.name.replace('_', " ")),
                Cell::number(significant(n.value, 5), n.value),
                Cell::text(&n.unit),
            ]
        })
        .collect();
    Section {
        id: figure.id.clone(),
        title: figure.name.clone(),
        blocks: vec![Block::Details {
            summary: format!("{}: {}", figure.title, words::figure(figure.verdict)),
            blocks: vec![
                Block::Html(said(figure)),
                Block::Charts(figure.plots.iter().map(chart).collect()),
                Block::Details {
                    summary: "Numbers".into(),
                    blocks: vec![Block::Table(Table {
                        caption: format!("Numbers of {}", figure.name),
                        columns: vec![
                            Column::text("Number"),
                            Column::number("Value"),
                            Column::text("Unit"),
                        ],
                        rows: numbers,
                    })],
                },
            ],
        }],
    }
}

/// What the paper says, the verdict, the number, the reason.
fn said(figure: &Figure) -> String {
    let (class, sign) = match words::good(figure.verdict) {
        Some(true) => ("within", "\u{2713}"),
        Some(false) => ("exceeded", "\u{2715}"),
        None => ("unjudged", "!"),
    };
    format!(
        "<dl class=\"facts\"><dt>The paper says</dt><dd>{}</dd><dt>Ours <span class=\"badge {class}\">{sign} {}</span></dt><dd>{}</dd>\
         <dt>Why</dt><dd>{}</dd></dl>",
        escape(&figure.says),
        words::figure(figure.verdict),
        escape(&figure.found),
        escape(&figure.why)
    )
}

/// Text as markup.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

fn chart(plot: &Plot) -> Chart {
    let axis = |label: &str, log| Axis {
        label: label.to_owned(),
        log,
    };
    let series = plot.curves.iter().map(|curve| {
        // A curve has its own abscissae: where it has no value there is nothing to join.
        let there = plot.x.iter().zip(&curve.y).filter(|(_, y)| y.is_finite());
        let (x, y) = there.map(|(x, y)| (*x, *y)).unzip();
        Series {
            label: curve.label.clone(),
            style: if curve.points {
                Style::Points
            } else {
                Style::Line
            },
            x,
            y,
            ..Series::default()
        }
    });
    Chart {
        title: plot.title.clone(),
        x: axis(&plot.x_label, false),
        y: axis(&plot.y_label, plot.y_log),
        series: series.collect(),
        note: plot.note.clone(),
    }
}

fn claims(found: &Paper) -> Section {
    let judged = found.claims.iter().map(|judged| {
        vec![
            Cell::text(&judged.claim.claim),
            Cell::text(words::claim(judged.verdict)).marked(words::mark(judged.verdict)),
            Cell::text(&judged.figure),
        ]
    });
    let reasons = found.claims.iter().map(|judged| {
        vec![
            Cell::text(&judged.claim.claim),
            Cell::text(&judged.claim.remark),
            Cell::text(&judged.claim.judged_by),
            Cell::text(&judged.claim.place),
        ]
    });
    let table = |caption: &str, columns: &[&str], rows: Vec<Vec<Cell>>| {
        Block::Table(Table {
            caption: caption.into(),
            columns: columns.iter().copied().map(Column::text).collect(),
            rows,
        })
    };
    let reasons = table(
        "Why, by which computation, and where in the paper",
        &["Claim", "Why", "Judged by", "Where"],
        reasons.collect(),
    );
    Section {
        id: "claims".into(),
        title: "Claims".into(),
        blocks: vec![
            table(
                "What the paper says in words, each judged by a computation of its own",
                &["Claim", "Verdict", "Our figure"],
                judged.collect(),
            ),
            Block::Details {
                summary: "Why, by which computation, and where in the paper".into(),
                blocks: vec![reasons],
            },
        ],
    }
}

fn costs(found: &Paper) -> Section {
    let mut rows: Vec<Vec<Cell>> = found
        .costs
        .iter()
        .map(|cost| {
            let paper = match cost.paper_s {
                Some(s) => Cell::number(format!("{:.0} min", s / 60.0), s),
                None => Cell::text("-"),
            };
            let ratio = match cost.paper_s {
                Some(s) => Cell::number(format!("{:.0}", s / cost.ours_s), s / cost.ours_s),
                None => Cell::text("-"),
            };
            vec![
                Cell::text(&cost.what),
                paper,
                Cell::number(format!("{:.2} s", cost.ours_s), cost.ours_s),
                ratio,
            ]
        })
        .collect();
    rows.push(vec![
        Cell::text(format!("this whole study, {} runs", found.runs)),
        Cell::text("-"),
        Cell::number(format!("{:.0} s", found.wall_s), found.wall_s),
        Cell::text("-"),
    ]);
    Section {
        id: "cost".into(),
        title: "Cost".into(),
        blocks: vec![Block::Details {
            summary: "time of a run, beside the paper's".into(),
            blocks: vec![
            Block::Text(
                "Wall time of 0.6 s of the gearbox, 60 000 steps of 1e-5 s by Heun's method, on one core. The paper's machine is not \
                 named, so the ratio compares program and machine together. The paper scans all points for every sleeve; only points \
                 near the ideal mesh can touch, so their number need not cost time. Adams took over an hour."
                    .into(),
            ),
            Block::Table(Table {
                caption: "Cost of a run".into(),
                columns: vec![
                    Column::text("Analysis"),
                    Column::number("The paper"),
                    Column::number("Ours"),
                    Column::number("Ratio"),
                ],
                rows,
            }),
        ],
        }],
    }
}
