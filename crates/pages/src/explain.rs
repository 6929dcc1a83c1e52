//! What a scene models, assumes and lets one expect.

use pinwheel_report::terminal::{Cell, TITLE, lines, paragraph, styled};
use pinwheel_scene::{Derived, Scene};
use pinwheel_studies::explained::Explanation;

/// The whole text.
#[must_use]
pub fn text(explanation: &Explanation<'_>) -> String {
    let title = paragraph(&crate::title(explanation.scene));
    let mut text = format!("{}\n", styled(TITLE, &title));
    let mut section = |title: &str, rows: Vec<Vec<Cell>>| {
        if !rows.is_empty() {
            text.push_str(&format!("\n{}\n{}", styled(TITLE, title), lines(&rows)));
        }
    };
    let two = |what: &str, why: &str| vec![Cell::text(what), Cell::text(why)];
    let statements = |list: &[pinwheel_gearbox::Statement]| {
        list.iter()
            .map(|s| two(&s.what, &s.why))
            .collect::<Vec<_>>()
    };
    section("Modelled", statements(&explanation.model.modelled));
    section("Left out", statements(&explanation.model.left_out));
    section(
        "What follows from the dimensions",
        geometry(explanation.scene, &explanation.derived),
    );
    section(
        "To be expected",
        expected(explanation.scene, &explanation.derived),
    );
    section("Frequencies", frequencies(&explanation.derived));
    section(
        "Assumptions",
        explanation
            .assumptions
            .iter()
            .map(|a| {
                vec![
                    Cell::text(&a.key),
                    Cell::text(&a.value),
                    Cell::text(&a.reason),
                ]
            })
            .collect(),
    );
    text
}

fn geometry(scene: &Scene, figures: &Derived) -> Vec<Vec<Cell>> {
    let row = |what: &str, value: String, how: &str| {
        vec![Cell::text(what), Cell::figure(value), Cell::text(how)]
    };
    let mm = |metres: f64| format!("{:.4} mm", 1e3 * metres);
    let mut rows = vec![
        row(
            "ratio",
            format!("{} : 1", figures.ratio),
            "the output turns against the input",
        ),
        row(
            "circle of the external sleeves",
            mm(figures.pitch_radius_m + scene.gear.backlash_m),
            "R + d, R = e zk/m",
        ),
        row("profile from", mm(figures.profile_radii_m[1]), "pits"),
        row("profile to", mm(figures.profile_radii_m[0]), "lobe tips"),
        row(
            "radius of curvature, lobe tip",
            mm(figures.tip_curvature_radius_m),
            "",
        ),
        row(
            "radius of curvature, pit",
            mm(figures.pit_curvature_radius_m),
            "negative: concave",
        ),
        row(
            "largest external sleeve",
            mm(figures.smallest_convex_radius_m),
            "a larger one undercuts the wheel",
        ),
        row(
            "clearance in the holes",
            mm(figures.hole_clearance_m),
            "hole - sleeve - eccentricity",
        ),
    ];
    let walls = &figures.walls;
    for (what, wall, how) in [
        (
            "wall, hole to profile",
            walls.hole_to_profile_m,
            "thinnest place of all holes",
        ),
        ("wall, hole to hole", walls.hole_to_hole_m, ""),
        (
            "gap, external sleeves",
            walls.sleeve_to_sleeve_m,
            "between neighbours",
        ),
    ] {
        rows.push(row(what, mm(wall), how));
    }
    if scene.gear.backlash_m > 0.0 {
        rows.push(row(
            "free play to one side",
            format!("{:.4} mrad", 1e3 * figures.free_play_rad),
            "d sqrt(1 - m^2)/(e zs), at the wheel",
        ));
    }
    rows
}

fn expected(scene: &Scene, figures: &Derived) -> Vec<Vec<Cell>> {
    let row = |what: &str, value: String, how: &str| {
        vec![Cell::text(what), Cell::figure(value), Cell::text(how)]
    };
    let phase = |same: bool| {
        if same {
            "in phase: no ripple cancels"
        } else {
            "out of phase: ripple partly cancels"
        }
    };
    vec![
        row(
            "driver torque, ideal",
            format!("{:.4} N m", figures.ideal_input_torque_n_m),
            if scene.drive.load_changes.is_empty() {
                "load/zs, if the contacts neither lose nor create energy"
            } else {
                "the last load/zs, if the contacts neither lose nor create energy"
            },
        ),
        row(
            "largest external sleeve force",
            format!("{:.1} N", figures.external_force_estimate_n),
            "a wheel, rigid and without clearance: 4 T/(e zs zk)",
        ),
        row(
            "largest internal sleeve force",
            format!("{:.1} N", figures.internal_force_estimate_n),
            "a wheel, likewise: 4 T/(zi Rw)",
        ),
        row(
            "wheels at the external sleeves",
            String::new(),
            phase(figures.external_ripple_in_phase),
        ),
        row(
            "wheels at the internal sleeves",
            String::new(),
            phase(figures.internal_ripple_in_phase),
        ),
    ]
}

fn frequencies(figures: &Derived) -> Vec<Vec<Cell>> {
    figures
        .frequencies
        .iter()
        .map(|frequency| {
            vec![
                Cell::text(frequency.what),
                Cell::figure(format!("{:.3} Hz", frequency.hertz)),
                Cell::text(format!("order {:.4} of the input", frequency.order)),
            ]
        })
        .collect()
}
