//! Parts of a design's page on load sharing and bearing forces.

use crate::figure::number;
use crate::study::{Axis, Chart, Section, Series, Style};
use pinwheel_studies::design::DesignResult;
use pinwheel_timeseries::table::Table;

use super::curves::{Drawn, chart, degrees, line, of_design};

/// Returns the name of the parts that carry discs on the output's side.
fn inner(design: &DesignResult) -> &'static str {
    match design.scene.cranks {
        Some(_) => "Crank bearings",
        None => "Output pins",
    }
}

/// Returns charts of the force over the angle, of ring pins, and of output pins or crank bearings.
pub(crate) fn sharing_charts(designs: &Drawn<'_>) -> Vec<Chart> {
    let of = |(stage, title): (usize, &str)| {
        let series = designs.iter().enumerate().map(|(k, (_, design))| {
            let sharing = &design.sharing[stage];
            // Angles without a touching pin in any pose are not zeros of a curve.
            let all = sharing.place_deg.iter().zip(&sharing.force_n);
            let (x, y): (Vec<f64>, Vec<f64>) = all.filter(|(_, force)| **force > 0.0).unzip();
            of_design(designs, k, (0, "largest force"), line(&x, &y))
        });
        let note = match designs {
            [(_, design)] => {
                let touching = number(design.sharing[stage].touching.mean);
                match (stage, design.scene.cranks) {
                    (1, Some(_)) => format!("{touching} bearings of a disc carry on average."),
                    _ => format!("{touching} pins touch a disc on average."),
                }
            }
            _ => String::new(),
        };
        let (x, y) = ("Place of the pin from the eccentric (degrees)", "Force (N)");
        Chart {
            note,
            ..chart(title, x, y, series.collect())
        }
    };
    let inner = designs.first().map(|(_, design)| inner(design));
    let stages = ["Ring pins", inner.unwrap_or("Output pins")];
    stages.into_iter().enumerate().map(of).collect()
}

pub(super) fn sharing(design: &DesignResult) -> Section {
    // Cranks carry no pins.
    let kinds = if design.scene.cranks.is_some() { 1 } else { 2 };
    let sharing = ["external", "internal"].into_iter().zip(&design.sharing);
    let rows = sharing.take(kinds).zip(&design.pressure);
    let rows = rows.map(|((pins, force), pressure)| (pins, force, pressure));
    let contacts = Table::of("Contacts under the rated load", rows)
        .text("", "Pins", |(pins, ..)| *pins)
        .figure("Largest force", "N", |(_, of, _)| of.largest_force_n.max)
        .figure("Largest pressure", "MPa", |(.., of)| 1e-6 * of.largest_pa)
        .figure("at", "degrees", |(.., of)| of.largest_at_deg)
        .figure("Largest sliding", "m/s", |(.., of)| of.sliding_m_s)
        .figure("p v", "MPa m/s", |(.., of)| 1e-6 * of.pressure_sliding_w_m2);
    Section::new("contacts", "Load sharing and pressure")
        .with(
            "Forces of all discs and poses under the rated load, by where the pin stands from the disc's eccentric. Pressure is that of a \
             line contact after Hertz over the face width; the edges of discs and pins are left out, and press harder. Sliding is that of the \
             disc on pins that do not turn.",
        )
        .with(sharing_charts(&[("", design)]))
        .with(contacts)
}

/// Returns the chart of the force on the most loaded bearing over the period of each.
pub(crate) fn bearing_chart(designs: &Drawn<'_>) -> Chart {
    let mut series = Vec::new();
    for (k, (_, design)) in designs.iter().enumerate() {
        let Some(bearing) = design.most_loaded() else {
            continue;
        };
        let turn = degrees(&design.input_angle_rad);
        for (part, force) in [
            ((0, "away from the input's axis"), &bearing.radial_n),
            ((1, "around the input's axis"), &bearing.tangential_n),
        ] {
            series.push(of_design(designs, k, part, line(&turn, force)));
        }
    }
    let (x, y) = ("Input angle (degrees)", "Force (N)");
    chart("Force on the disc's bearing", x, y, series)
}

/// Returns the harmonics of the force component that only loads the bearing.
fn bearing_orders(design: &DesignResult) -> Chart {
    let wheel = design.most_loaded().into_iter();
    let harmonics = wheel.flat_map(|bearing| &bearing.radial_harmonics);
    let (orders, sizes): (Vec<f64>, Vec<f64>) =
        harmonics.map(|h| (h.input_order, h.amplitude_n)).unzip();
    let points = Series::line("away from the input's axis", orders, sizes).styled(Style::Points);
    let x = Axis::linear("Cycles per turn of the input");
    let y = Axis::log("Amplitude (N)");
    Chart::new("Orders of the force", x, y, vec![points])
}

pub(super) fn bearings(design: &DesignResult) -> Section {
    let (title, carried) = match design.scene.cranks {
        Some(_) => (
            "Force on a disc",
            "What the contacts press on a disc, the bearings of its cranks carry together, beside what turns the output.",
        ),
        None => (
            "Bearing of the eccentric",
            "What the contacts press on a disc, its bearing carries on the eccentric. The part around the axis makes the driver's torque; \
             the part away from it only loads the bearing.",
        ),
    };
    let others = match design.scene.gear.errors.is_none() {
        true => "the others follow a share of a turn later",
        false => "no other carries more",
    };
    let most = design.most_loaded().map_or(0, |bearing| bearing.wheel);
    let all = design.bearings.len();
    Section::new("bearings", title)
        .with(format!("{carried} Disc {most} of {all}; {others}."))
        .with(vec![bearing_chart(&[("", design)]), bearing_orders(design)])
}
