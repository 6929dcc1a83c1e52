//! Measured and computed drive of the preset `printed-drive`: figures, and the picture of docs/design.md.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::PathBuf;

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;
use pinwheel_studies::Control;
use pinwheel_studies::design::{self, DesignResult};
use pinwheel_timeseries::figure::FigureDef;
use pinwheel_timeseries::figure::definitions::{LOST_MOTION, STIFFNESS};

const ARCMIN: f64 = 10_800.0 / PI;

fn repository(place: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(place)
}

/// Measured values of the drive.
struct Measured {
    /// Least and largest slope of the branches, N m/rad.
    stiffness: [f64; 2],
    /// Distance between the branches at zero torque, degrees.
    apart_deg: f64,
    /// Ends of the loop, N m.
    torque: f64,
    /// Range of the discs' Young's modulus, Pa.
    young: [f64; 2],
}

impl Measured {
    fn read() -> Self {
        let text =
            std::fs::read_to_string(repository("reference/published/printed-drive.toml")).unwrap();
        let table: toml::Table = text.parse().unwrap();
        let of = |key: &str| table[key].as_float().unwrap();
        let two = |key: &str| {
            let list = table[key].as_array().unwrap();
            [0, 1].map(|k: usize| list[k].as_float().unwrap())
        };
        Self {
            stiffness: two("stiffness_n_m_rad"),
            apart_deg: of("apart_deg"),
            torque: of("torque_n_m"),
            young: two("young_pa"),
        }
    }

    fn middle(&self) -> f64 {
        0.5 * (self.stiffness[0] + self.stiffness[1])
    }
}

/// Computes the drive with this modulus of the discs, Pa, and a spring between carrier and output, N m/rad.
fn ours(young_pa: f64, torsion: Option<f64>) -> DesignResult {
    let mut scene = Scene::load("printed-drive", &[]).unwrap().into_scene();
    scene.contact.young_pa = young_pa;
    scene.bearings.output_torsion_n_m_rad = torsion;
    let gearbox = Gearbox::new(&scene.check().unwrap()).unwrap();
    design::run(&gearbox, false, &Control::quiet()).unwrap()
}

fn figure(result: &DesignResult, def: &FigureDef) -> f64 {
    let figure = result.figures.iter().find(|figure| figure.is(def));
    figure.and_then(|figure| figure.value).unwrap()
}

/// The stated contacts and clearances give at most a fiftieth of the compliance and about a fifth of the loop; the remainder is
/// fitted. The test bounds the part that contacts can explain, and does not validate their law.
#[test]
fn published_measured_drive_is_softer_than_its_contacts() {
    let measured = Measured::read();
    let per_arcmin = measured.stiffness.map(|k| k / ARCMIN);
    for young in measured.young {
        let mut contacts = ours(young, None);
        let times = figure(&contacts, &STIFFNESS) / per_arcmin[1];
        assert!((40.0..120.0).contains(&times), "{times}");
        let share = figure(&contacts, &LOST_MOTION) / (60.0 * measured.apart_deg);
        assert!((0.1..0.3).contains(&share), "{share}");
        // Fitting the remainder reproduces the middle of the measurements.
        let stated = measured.middle() / ARCMIN;
        contacts.fit_rest(stated).unwrap();
        let rest = contacts.rest.unwrap();
        let fitted = ours(young, Some(rest.output_torsion_n_m_rad));
        let off = figure(&fitted, &STIFFNESS) / stated - 1.0;
        println!(
            "E = {young:.1e}: rest {:.1} N m/rad, stiffness off by {off:.1e}",
            rest.output_torsion_n_m_rad
        );
        assert!(off.abs() < 1e-3, "{off}");
        assert!(fitted.budget[0].share < 0.025, "{:?}", fitted.budget);
        let shares: Vec<f64> = contacts.shares().iter().map(|(_, share)| *share).collect();
        assert!(
            (shares[0] - fitted.budget[0].share).abs() < 1e-4,
            "{shares:?}"
        );
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        // A drive stiffer than its contacts leaves no remainder to fit.
        assert!(
            contacts
                .fit_rest(1.01 * figure(&contacts, &STIFFNESS))
                .is_err()
        );
        assert!(contacts.fit_rest(f64::NAN).is_err() && contacts.fit_rest(0.0).is_err());
    }
}

/// Width and height of the picture, and corners of its plot, pixels.
const SIZE: [f64; 2] = [720.0, 420.0];
const PLOT: [f64; 4] = [64.0, 20.0, 700.0, 366.0];
/// Ends of the plot's axes, degrees and N m.
const ENDS: [f64; 2] = [7.0, 28.0];

fn at(twist_deg: f64, torque: f64) -> String {
    let [left, top, right, bottom] = PLOT;
    let x = left + (right - left) * (0.5 + 0.5 * twist_deg / ENDS[0]);
    let y = bottom - (bottom - top) * (0.5 + 0.5 * torque / ENDS[1]);
    format!("{x:.1},{y:.1}")
}

fn path(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let points = points.into_iter().map(|(twist, torque)| at(twist, torque));
    points.collect::<Vec<_>>().join(" ")
}

/// Returns the path of twist, degrees, over torque, N m.
fn course(result: &DesignResult, most: f64) -> String {
    let torsion = &result.torsion;
    let all = torsion.torque_n_m.iter().zip(&torsion.twist_arcmin);
    let mut all: Vec<(f64, f64)> = all.map(|(torque, twist)| (twist / 60.0, *torque)).collect();
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    path(
        all.into_iter()
            .filter(|(_, torque)| torque.abs() <= 1.001 * most),
    )
}

fn picture(measured: &Measured) -> String {
    let soft = measured.young[0];
    let mut contacts = ours(soft, None);
    contacts.fit_rest(measured.middle() / ARCMIN).unwrap();
    let fitted = ours(soft, contacts.rest.map(|rest| rest.output_torsion_n_m_rad));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" aria-labelledby=\"title desc\" font-family=\"system-ui, sans-serif\" font-size=\"14\">\n",
        SIZE[0], SIZE[1]
    );
    svg += "<title id=\"title\">Torque over twist of a printed drive, measured and computed</title>\n\
            <desc id=\"desc\">Two measured branches, 3.4 degrees apart at no torque, as bands of the slopes that were read off. Our contacts alone are far \
            steeper and less than a degree apart; with the rest fitted to the measured slope ours is as steep, and still a fifth as wide.</desc>\n\
            <style>text { fill: #1a1a1a } .quiet { fill: #595959; font-size: 12px } .axis { stroke: #595959; fill: none } .band { fill: #c9d8ea; opacity: .8 } \
            .own { fill: none; stroke: #b3261e; stroke-width: 2 } .fit { fill: none; stroke: #1a7f5a; stroke-width: 2; stroke-dasharray: 7 4 } \
            .red { fill: #b3261e } .green { fill: #1a7f5a } .blue { fill: #33567d } \
            @media (prefers-color-scheme: dark) { text { fill: #eaeaea } .quiet { fill: #b5b5b5 } .axis { stroke: #b5b5b5 } .band { fill: #35506e } \
            .own { stroke: #ff7b72 } .fit { stroke: #4cc38a } .red { fill: #ff7b72 } .green { fill: #4cc38a } .blue { fill: #a9c7ea } }</style>\n";
    // Branches are bands between the slopes, each shifted by half of the gap.
    for side in [-1.0, 1.0] {
        let shift = 0.5 * side * measured.apart_deg;
        let ends = |k: f64, torque: f64| (shift + (torque / k).to_degrees(), torque);
        let [low, high] = measured.stiffness;
        let t = measured.torque;
        let corners = [
            ends(low, -t),
            (shift, 0.0),
            ends(high, t),
            ends(low, t),
            (shift, 0.0),
            ends(high, -t),
        ];
        let _ = writeln!(
            svg,
            "<polygon class=\"band\" points=\"{}\"/>",
            path(corners)
        );
    }
    let [left, top, right, bottom] = PLOT;
    let _ = writeln!(
        svg,
        "<rect class=\"axis\" x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\"/>",
        right - left,
        bottom - top
    );
    for k in -3..=3 {
        let twist = 2.0 * f64::from(k);
        let place = at(twist, -ENDS[1]);
        let (x, _) = place.split_once(',').unwrap();
        let _ = writeln!(
            svg,
            "<text class=\"quiet\" x=\"{x}\" y=\"384\" text-anchor=\"middle\">{twist}</text>"
        );
    }
    for torque in [-20.0, -10.0, 0.0, 10.0, 20.0] {
        let place = at(-ENDS[0], torque);
        let (_, y) = place.split_once(',').unwrap();
        let _ = writeln!(
            svg,
            "<text class=\"quiet\" x=\"56\" y=\"{y}\" text-anchor=\"end\" dominant-baseline=\"middle\">{torque}</text>"
        );
    }
    let _ = writeln!(
        svg,
        "<polyline class=\"fit\" points=\"{}\"/>",
        course(&fitted, measured.torque)
    );
    let _ = writeln!(
        svg,
        "<polyline class=\"own\" points=\"{}\"/>",
        course(&contacts, measured.torque)
    );
    for (class, y, text) in [
        ("blue", 300, "measured, friction included"),
        ("red", 322, "ours, contacts and clearances as stated"),
        ("green", 344, "ours with the rest fitted to the slope"),
    ] {
        let _ = writeln!(
            svg,
            "<text class=\"{class}\" x=\"412\" y=\"{y}\">{text}</text>"
        );
    }
    svg + "<text x=\"382\" y=\"408\" text-anchor=\"middle\">twist of the output (degrees)</text>\n\
           <text transform=\"translate(16 193) rotate(-90)\" text-anchor=\"middle\">torque (N m)</text>\n</svg>\n"
}

/// The documentation's picture equals the computed one; `PINWHEEL_DRAW=1` redraws it.
#[test]
fn published_measured_loop_is_the_picture_of_the_documentation() {
    let place = repository("docs/printed-drive.svg");
    let drawn = picture(&Measured::read());
    if std::env::var_os("PINWHEEL_DRAW").is_some() {
        std::fs::write(&place, &drawn).unwrap();
    }
    let kept = std::fs::read_to_string(&place).unwrap();
    // Coordinates have a digit of a tenth of a pixel, which rounding on another machine may change.
    let numbers = |svg: &str| -> Vec<f64> {
        let words = svg.split(|c: char| !(c.is_ascii_digit() || ".-".contains(c)));
        words.filter_map(|word| word.parse().ok()).collect()
    };
    let (kept, drawn) = (numbers(&kept), numbers(&drawn));
    assert_eq!(kept.len(), drawn.len(), "draw it anew");
    let off = kept
        .iter()
        .zip(&drawn)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(off < 0.11, "{off} pixels: draw it anew");
}
