//! Live page of a scene: sliders, two states of the gear side by side, and the results of a run and balances for each.
//!
//! The program `pinwheel explore` serves it: the page sends the values of a state, and [`run`] and [`balances`] format its
//! computed results.

use crate::format::significant;
use crate::study::{Block, Study};
use crate::{figure, script};
use pinwheel_contact::laws::LAWS;
use pinwheel_scene::Scene;
use pinwheel_studies::design::Limits;
use pinwheel_studies::explore::{GEARS, RIGID, sliders};
use pinwheel_studies::motion::Motion;
use pinwheel_studies::{Provenance, band};
use pinwheel_timeseries::columns;
use pinwheel_timeseries::figure::Figure;
use serde_json::{Value, json};

use crate::pages::animation::{Animation, drawn, markup};
use crate::pages::design::{answer, is_headline};

/// Returns the motion of a state for the page's script, or the reason for a missing one.
///
/// # Errors
/// No motion to draw.
pub fn run(motion: Option<&Motion>) -> Result<Value, String> {
    moved(motion).map(|(view, mut series)| {
        series["view"] = view.json();
        series
    })
}

fn moved(motion: Option<&Motion>) -> Result<(Animation, Value), String> {
    let view = motion.and_then(drawn);
    let Some((view, motion)) = view.zip(motion) else {
        return Err("the run diverges at once; take a smaller solver.step_s".to_owned());
    };
    let series = &motion.time_series;
    let times = series.time_s().len();
    let short = |values: &[f64]| -> Vec<f32> { values.iter().map(|v| *v as f32).collect() };
    let torque = series.channel(columns::INPUT_TORQUE).map(short);
    let largest = |group: &str| -> Vec<f32> {
        let channels = series.group(group);
        let at = |k: usize| {
            let values = channels.iter().filter_map(|channel| channel.get(k));
            values.fold(0.0, |most: f64, value| most.max(value.abs())) as f32
        };
        (0..times).map(at).collect()
    };
    let curves = json!({
        "time": short(series.time_s()),
        "series": {
            "Largest external force (N)": largest(columns::EXTERNAL_FORCE),
            "Largest internal force (N)": largest(columns::INTERNAL_FORCE),
            "Driver torque (N m)": torque,
        },
    });
    Ok((view, curves))
}

/// Returns figures of a state's balances for the page: label, value, unit, formatted value, bounds, and numerical
/// uncertainty; and the reason for missing bands.
#[must_use]
pub fn balances(figures: &[Figure], limits: Option<&Limits>, scene: &Scene) -> Value {
    let shown = figures.iter().filter(|one| is_headline(&one.def));
    let rows = shown.map(|one| {
        let (shown, bounds) = figure::shown(one);
        let def = &one.def;
        json!([
            def.label,
            one.value,
            def.unit,
            shown,
            bounds,
            one.uncertainty
        ])
    });
    let margin = limits.and_then(|limits| {
        let ((_, why), margin) = (answer(limits), limits.margin?);
        let shown = significant(margin, 3);
        Some(json!([
            "least margin of a limit",
            margin,
            "",
            shown,
            why,
            Value::Null
        ]))
    });
    let rows: Vec<Value> = rows.chain(margin).collect();
    let why = band::declined(scene).map(|why| format!("No band by contact law: {why}."));
    json!({"figures": rows, "why": why})
}

/// Returns the yield of a sample within the tolerances for the page's script: share and confidence limits, %.
#[must_use]
pub fn sample(estimate: Option<[f64; 3]>) -> Value {
    let row = estimate.map(|estimate| {
        let [share, low, high] = estimate.map(|share| 100.0 * share);
        let how = format!("of {GEARS} gears within [uncertain], those within limits; {low:.0} to {high:.0} % with 95 % confidence");
        json!(["yield", share, "%", format!("{share:.0}"), how, 0.5 * (high - low)])
    });
    json!({"figures": row.into_iter().collect::<Vec<_>>()})
}

/// Returns the live page of a scene; both states begin with the motion of the scene.
///
/// # Errors
/// No motion to draw, as text.
pub fn page(scene: &Scene, motion: Option<&Motion>, origin: &Provenance) -> Result<String, String> {
    let (view, rest) = moved(motion)?;
    let views = [view.clone().titled("A"), view.titled("B")];
    let data = json!({ "first": rest, "sliders": sliders(scene), "rigid": RIGID });
    let law = &scene.contact.law;
    let laws = LAWS.iter().map(|info| {
        let chosen = if info.name == law { " selected" } else { "" };
        format!("<option{chosen}>{}</option>", info.name)
    });
    let explorer = format!(
        include_str!("../../templates/explore.html"),
        motion = markup(&views, 0.0),
        laws = laws.collect::<String>(),
        data = script::json_text(&data)
    );
    let study = Study {
        title: scene.name.clone(),
        eyebrow: "Pinwheel explore".to_owned(),
        below: vec![
            Block::Live {
                markup: explorer,
                scripts: script::code(include_str!("../../assets/explore.js")),
                asks: true,
            },
            Block::from(
                "Move a slider: the native solver runs one turn from the loaded balance, without start-up, and the balances \
               at a few poses of the mesh follow. The run is quick and not verified: its curves are good to half a per cent. \
               Contacts, and eccentric bearings that have a stiffness, are all that gives way.",
            ),
        ],
        ..Study::default()
    };
    Ok(crate::pages::render(study, origin))
}
