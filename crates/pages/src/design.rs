//! A design's page and text: what it is like to the shafts, who carries the load, and what the contacts bear.

use pinwheel_report::format::significant;
use pinwheel_report::study::{
    self, Axis, Block, Cell, Chart, Column, Section, Series, Study, Style, Table, Tile,
};
use pinwheel_report::terminal::{self, TITLE, lines, styled};
use pinwheel_scene::catalogue::Draft;
use pinwheel_scene::derived;
use pinwheel_studies::Provenance;
use pinwheel_studies::design::{Outcome, Sharing, Spread, Transmission};

use crate::PageError;

/// Significant digits of a figure: what a data sheet gives.
const DIGITS: usize = 4;

/// The whole page.
///
/// # Errors
/// The page cannot be made.
pub fn page(found: &Outcome, made: &Provenance) -> Result<String, PageError> {
    let scene = &found.scene;
    let mut sections = vec![
        torsion(found),
        transmission(found),
        sharing(found),
        bearings(found),
    ];
    if !found.efficiency.is_empty() {
        sections.push(efficiency(found));
    }
    sections.push(dimensions(found));
    Ok(study::render(&Study {
        title: scene.name.clone(),
        eyebrow: "Pinwheel design".to_owned(),
        lead: format!(
            "{} A gear of ratio {} under its rated {} N m. Statics unless said otherwise: contacts in balance, exact geometry, \
             the law `{}`.",
            sentence(&scene.description),
            found.dimensions.ratio,
            figure(found.rated_torque_n_m),
            scene.contact.law
        ),
        verdict: None,
        tiles: tiles(found),
        sections,
        command: made.command.clone(),
        versions: made.versions(),
        machine: made.machine.rows(),
    })?)
}

/// What a terminal shows.
#[must_use]
pub fn text(found: &Outcome) -> String {
    let rows: Vec<Vec<terminal::Cell>> = figures(found)
        .into_iter()
        .map(|(what, value, unit, how)| {
            vec![
                terminal::Cell::text(what),
                terminal::Cell::figure(value),
                terminal::Cell::text(unit),
                terminal::Cell::text(how),
            ]
        })
        .collect();
    format!("{}\n{}", styled(TITLE, &found.scene.name), lines(&rows))
}

/// What a terminal shows of a scene made of a catalogue's data.
#[must_use]
pub fn draft(draft: &Draft) -> String {
    let row = |what: &str, value: String, how: &str| {
        vec![
            terminal::Cell::text(what),
            terminal::Cell::figure(value),
            terminal::Cell::text(how),
        ]
    };
    let of = derived(&draft.scene);
    let mm = |metres: f64| format!("{} mm", figure(1e3 * metres));
    let mut rows = vec![
        row("ratio", of.ratio.to_string(), "input turns per output turn"),
        row("wall, hole to profile", mm(of.walls.hole_to_profile_m), ""),
        row("wall, hole to hole", mm(of.walls.hole_to_hole_m), ""),
        row("gap, pin to pin", mm(of.walls.sleeve_to_sleeve_m), ""),
        row(
            "sharpest bend of the pins' path",
            mm(of.smallest_convex_radius_m),
            "a larger pin radius undercuts the wheel",
        ),
        row(
            "largest pin force",
            format!("{} N", figure(of.external_force_estimate_n)),
            "external, rigid: 4 T/(e zs zk)",
        ),
    ];
    for key in &draft.suggested {
        let name = key.rsplit('.').next().unwrap_or(key);
        rows.push(row("suggested", String::new(), name));
    }
    format!("{}\n{}", styled(TITLE, &draft.scene.name), lines(&rows))
}

fn figure(value: f64) -> String {
    significant(value, DIGITS)
}

fn span(spread: &Spread) -> String {
    format!(
        "{} to {} over the mesh",
        figure(spread.min),
        figure(spread.max)
    )
}

fn sentence(text: &str) -> String {
    match text.trim_end_matches('.') {
        "" => String::new(),
        text => format!("{text}."),
    }
}

/// What a data sheet gives: label, figure, unit, how it was found.
fn figures(found: &Outcome) -> Vec<(&'static str, String, &'static str, String)> {
    let torsion = &found.torsion;
    let [loaded, unloaded] = &found.transmission;
    let [external, internal] = &found.pressure;
    let peak = |sharing: &Sharing| figure(sharing.largest_force_n.max);
    let mut rows = vec![
        (
            "lost motion",
            figure(torsion.lost_motion_arcmin.max),
            "arcmin",
            format!(
                "between +3 and -3 % of the rated torque; {}",
                span(&torsion.lost_motion_arcmin)
            ),
        ),
        (
            "torsional stiffness",
            figure(torsion.stiffness_n_m_per_arcmin.mean),
            "N m/arcmin",
            format!(
                "between 50 and 100 % of the rated torque; {}",
                span(&torsion.stiffness_n_m_per_arcmin)
            ),
        ),
        (
            "transmission error, rated load",
            figure(loaded.peak_to_peak_arcmin),
            "arcmin",
            "peak to peak".to_owned(),
        ),
        (
            "transmission error, no load",
            figure(unloaded.peak_to_peak_arcmin),
            "arcmin",
            format!("peak to peak at {} N m", figure(unloaded.torque_n_m)),
        ),
        (
            "largest pin force, external",
            peak(&found.sharing[0]),
            "N",
            touching(&found.sharing[0]),
        ),
        (
            "largest pin force, internal",
            peak(&found.sharing[1]),
            "N",
            touching(&found.sharing[1]),
        ),
        (
            "largest pressure, external",
            figure(1e-6 * external.largest_pa),
            "MPa",
            "line contact over the face width, edges left out".to_owned(),
        ),
        (
            "largest pressure, internal",
            figure(1e-6 * internal.largest_pa),
            "MPa",
            String::new(),
        ),
        (
            "largest pressure times sliding",
            figure(
                1e-6 * external
                    .pressure_sliding_w_m2
                    .max(internal.pressure_sliding_w_m2),
            ),
            "MPa m/s",
            "on pins that do not turn".to_owned(),
        ),
    ];
    if let Some(bearing) = found.bearings.first() {
        rows.push((
            "eccentric bearing, largest force",
            figure(bearing.force_n.max),
            "N",
            span(&bearing.force_n),
        ));
    }
    if let Some(cycle) = &found.cycle {
        let (value, how) = match (cycle.lost_motion_arcmin, cycle.width_arcmin) {
            (Some(lost), Some(width)) => (
                figure(lost),
                format!(
                    "of a slow loop of the load; {} by statics at that pose; the loop is {} arcmin wide at no load",
                    figure(static_lost_motion(found)),
                    figure(width)
                ),
            ),
            _ => (
                "-".to_owned(),
                format!("the slow loop of the load {}", cycle.status),
            ),
        };
        rows.push(("lost motion by a run", value, "arcmin", how));
    }
    let rated = found.efficiency.last();
    if let Some(efficiency) = rated.and_then(|run| run.efficiency) {
        rows.push((
            "efficiency, rated",
            figure(100.0 * efficiency.of_losses),
            "%",
            format!(
                "by what contacts lose; {} % by the works, {:+.2} % of them created by the law",
                figure(100.0 * efficiency.measured),
                100.0 * efficiency.created_share
            ),
        ));
    }
    rows
}

/// Lost motion by statics at the input angle 0, where the loop is run too, arcmin.
fn static_lost_motion(found: &Outcome) -> f64 {
    let torsion = &found.torsion;
    let at = |share: f64| {
        let wanted = share * found.rated_torque_n_m;
        let near = torsion.torque_n_m.iter().zip(&torsion.twist_arcmin);
        near.min_by(|a, b| (a.0 - wanted).abs().total_cmp(&(b.0 - wanted).abs()))
            .map_or(f64::NAN, |(_, twist)| *twist)
    };
    at(0.03) - at(-0.03)
}

fn touching(sharing: &Sharing) -> String {
    format!(
        "{} pins touch a wheel on average",
        figure(sharing.touching.mean)
    )
}

fn tiles(found: &Outcome) -> Vec<Tile> {
    const WANTED: [&str; 6] = [
        "lost motion",
        "torsional stiffness",
        "transmission error, rated load",
        "largest pin force, external",
        "largest pressure, external",
        "efficiency, rated",
    ];
    let rows = figures(found).into_iter();
    rows.filter(|(label, ..)| WANTED.contains(label))
        .map(|(label, value, unit, detail)| Tile {
            label: label.to_owned(),
            value,
            unit: unit.to_owned(),
            detail,
        })
        .collect()
}

fn line(label: &str, x: &[f64], y: &[f64]) -> Series {
    Series {
        label: label.to_owned(),
        x: x.to_vec(),
        y: y.to_vec(),
        ..Series::default()
    }
}

fn chart(title: &str, x: &str, y: &str, series: Vec<Series>, note: &str) -> Chart {
    Chart {
        title: title.to_owned(),
        x: Axis::linear(x),
        y: Axis::linear(y),
        series,
        note: note.to_owned(),
    }
}

fn section(id: &str, title: &str, blocks: Vec<Block>) -> Section {
    Section {
        id: id.to_owned(),
        title: title.to_owned(),
        blocks,
    }
}

fn torsion(found: &Outcome) -> Section {
    let torsion = &found.torsion;
    let mut series = vec![Series {
        style: Style::Both,
        ..line("statics", &torsion.torque_n_m, &torsion.twist_arcmin)
    }];
    let mut text = "The input is locked and the load is taken from one direction to the other. Lost motion is the twist between +3 and -3 % of \
                    the rated torque, stiffness the slope between 50 and 100 %."
        .to_owned();
    if let Some(cycle) = &found.cycle {
        let closed = cycle.closed_from.min(cycle.angle_arcmin.len());
        // About the same middle: where the output stands at 0 is arbitrary in a run.
        let half = closed + (cycle.angle_arcmin.len() - closed) / 2;
        for (label, range) in [
            ("run, load falls", closed..half),
            ("run, load rises", half..cycle.angle_arcmin.len()),
        ] {
            series.push(line(
                label,
                &cycle.torque_n_m[range.clone()],
                &cycle.angle_arcmin[range],
            ));
        }
        text.push_str(
            " The run takes the load there and back so slowly that the gear follows; the width of its loop is what friction holds back. \
             Friction is regularised: a contact that hardly slides gives way slowly.",
        );
    }
    section(
        "torsion",
        "Lost motion and stiffness",
        vec![
            Block::Text(text),
            Block::Charts(vec![chart(
                "Twist of the output, input locked",
                "Torque on the output (N m)",
                "Twist (arcmin)",
                series,
                "",
            )]),
        ],
    )
}

fn transmission(found: &Outcome) -> Section {
    let turn: Vec<f64> = found
        .input_angle_rad
        .iter()
        .map(|angle| angle.to_degrees())
        .collect();
    let courses = found.transmission.iter().zip(["rated load", "no load"]);
    let about_mean = |of: &Transmission| -> Vec<f64> {
        let mean = of.mean_arcmin;
        of.error_arcmin.iter().map(|error| error - mean).collect()
    };
    let series = courses
        .clone()
        .map(|(of, label)| line(label, &turn, &about_mean(of)))
        .collect();
    let spectrum = courses
        .clone()
        .map(|(of, label)| Series {
            style: Style::Points,
            ..line(
                label,
                &column(of, |harmonic| harmonic.input_order),
                &column(of, |harmonic| harmonic.amplitude_arcmin),
            )
        })
        .collect();
    let rows = courses.flat_map(|(of, label)| {
        of.harmonics.iter().take(6).map(move |harmonic| {
            vec![
                Cell::text(label),
                Cell::number(figure(harmonic.input_order), harmonic.input_order),
                Cell::number(figure(harmonic.output_order), harmonic.output_order),
                Cell::number(figure(harmonic.amplitude_arcmin), harmonic.amplitude_arcmin),
                Cell::text(harmonic.of),
            ]
        })
    });
    section(
        "transmission-error",
        "Transmission error",
        vec![
            Block::Text(
                "Output angle less that of the ideal mesh, about its mean, over one period in which both meshes come round. What repeats with the \
                 mesh excites the machine at its order times the input's speed."
                    .to_owned(),
            ),
            Block::Charts(vec![
                chart(
                    "Transmission error",
                    "Input angle (degrees)",
                    "Error about its mean (arcmin)",
                    series,
                    "",
                ),
                Chart {
                    y: Axis::log("Amplitude (arcmin)"),
                    ..chart(
                        "Orders",
                        "Cycles per turn of the input",
                        "",
                        spectrum,
                        "",
                    )
                },
            ]),
            Block::Table(Table {
                caption: "Largest orders".to_owned(),
                columns: vec![
                    Column::text("Load"),
                    Column::number("Per input turn"),
                    Column::number("Per output turn"),
                    Column::number("Amplitude (arcmin)"),
                    Column::text("Of"),
                ],
                rows: rows.collect(),
            }),
        ],
    )
}

fn column(
    of: &Transmission,
    value: impl Fn(&pinwheel_studies::design::Harmonic) -> f64,
) -> Vec<f64> {
    of.harmonics.iter().map(value).collect()
}

fn sharing(found: &Outcome) -> Section {
    let charts = found
        .sharing
        .iter()
        .zip(["External pins", "Internal pins"])
        .map(|(sharing, title)| {
            chart(
                title,
                "Place of the pin from the eccentric (degrees)",
                "Force (N)",
                vec![line("largest force", &sharing.place_deg, &sharing.force_n)],
                &touching(sharing),
            )
        })
        .collect();
    let rows = found
        .sharing
        .iter()
        .zip(&found.pressure)
        .zip(["external", "internal"])
        .map(|((sharing, pressure), label)| {
            let cell = |value: f64| Cell::number(figure(value), value);
            vec![
                Cell::text(label),
                cell(sharing.largest_force_n.max),
                cell(1e-6 * pressure.largest_pa),
                cell(pressure.largest_at_deg),
                cell(pressure.sliding_m_s),
                cell(1e-6 * pressure.pressure_sliding_w_m2),
            ]
        });
    section(
        "contacts",
        "Load sharing and pressure",
        vec![
            Block::Text(
                "Forces of all wheels and poses under the rated load, by where the pin stands from the wheel's eccentric. Pressure is that of a \
                 line contact after Hertz over the face width; the edges of wheels and pins are left out, and press harder. Sliding is that of the \
                 wheel on pins that do not turn."
                    .to_owned(),
            ),
            Block::Charts(charts),
            Block::Table(Table {
                caption: "Contacts under the rated load".to_owned(),
                columns: vec![
                    Column::text("Pins"),
                    Column::number("Largest force (N)"),
                    Column::number("Largest pressure (MPa)"),
                    Column::number("at (degrees)"),
                    Column::number("Largest sliding (m/s)"),
                    Column::number("p v (MPa m/s)"),
                ],
                rows: rows.collect(),
            }),
        ],
    )
}

fn bearings(found: &Outcome) -> Section {
    let turn: Vec<f64> = found
        .input_angle_rad
        .iter()
        .map(|angle| angle.to_degrees())
        .collect();
    let series = found.bearings.iter().take(1).flat_map(|bearing| {
        [
            line("away from the input's axis", &turn, &bearing.radial_n),
            line("around the input's axis", &turn, &bearing.tangential_n),
        ]
    });
    section(
        "bearings",
        "Bearing of the eccentric",
        vec![
            Block::Text(format!(
                "What the contacts press on a wheel, its bearing carries on the eccentric. The part around the axis makes the driver's torque; the part \
                 away from it only loads the bearing. Wheel 0 of {}; the others follow a share of a turn later.",
                found.bearings.len()
            )),
            Block::Charts(vec![chart(
                "Force on the wheel's bearing",
                "Input angle (degrees)",
                "Force (N)",
                series.collect(),
                "",
            )]),
        ],
    )
}

fn efficiency(found: &Outcome) -> Section {
    let rows = found.efficiency.iter().map(|run| {
        let rpm = run.input_speed_rad_s.abs() * 30.0 / std::f64::consts::PI;
        let percent = |value: Option<f64>| match value {
            Some(value) => Cell::number(format!("{:.2}", 100.0 * value), value),
            None => Cell::text("-"),
        };
        vec![
            Cell::number(figure(rpm), rpm),
            Cell::number(figure(run.output_torque_n_m), run.output_torque_n_m),
            percent(run.efficiency.map(|e| e.of_losses)),
            percent(run.efficiency.map(|e| e.measured)),
            percent(run.efficiency.map(|e| e.created_share)),
            Cell::text(run.status),
        ]
    });
    section(
        "efficiency",
        "Efficiency",
        vec![
            Block::Text(
                "Runs with the scene's own friction and damping. Losses of bearings, seals and oil are not in the model. What a contact law creates or \
                 destroys by itself stands beside it: the figure by losses is free of it."
                    .to_owned(),
            ),
            Block::Table(Table {
                caption: "Efficiency over speed and torque".to_owned(),
                columns: vec![
                    Column::number("Input (rpm)"),
                    Column::number("Load (N m)"),
                    Column::number("By losses (%)"),
                    Column::number("By works (%)"),
                    Column::number("Created by the law (%)"),
                    Column::text("Run"),
                ],
                rows: rows.collect(),
            }),
        ],
    )
}

fn dimensions(found: &Outcome) -> Section {
    let of = &found.dimensions;
    let mm = |what: &str, metres: f64, how: &str| {
        vec![
            Cell::text(what),
            Cell::number(figure(1e3 * metres), metres),
            Cell::text(how),
        ]
    };
    let rows = vec![
        mm(
            "circle of the external pins",
            of.pitch_radius_m,
            "R, radius",
        ),
        mm("profile, from", of.profile_radii_m[1], "radius in the pits"),
        mm("profile, to", of.profile_radii_m[0], "radius at the tips"),
        mm(
            "sharpest convex bend of the pins' path",
            of.smallest_convex_radius_m,
            "a larger pin radius undercuts the wheel",
        ),
        mm("wall, hole to profile", of.walls.hole_to_profile_m, ""),
        mm("wall, hole to hole", of.walls.hole_to_hole_m, ""),
        mm("gap, pin to pin", of.walls.sleeve_to_sleeve_m, "external"),
        mm("clearance in the holes", of.hole_clearance_m, ""),
    ];
    section(
        "dimensions",
        "Dimensions",
        vec![Block::Table(Table {
            caption: "What follows from the dimensions".to_owned(),
            columns: vec![Column::text("What"), Column::number("mm"), Column::text("")],
            rows,
        })],
    )
}
