//! Comparison of two models: the second is evaluated at the states of the first.

use pinwheel_gearbox::contacts::PairContact;
use pinwheel_gearbox::{Frequencies, Gearbox};
use pinwheel_mbs::OdeSystem as _;

use super::fit::dot;
use super::forces::{Columns, rows};
use super::judged::{FLOW, Judged, ROUNDING, SAMPLES, Stage};
use super::locate::{Located, by_columns, start};
use super::model::{Model, Work};
use super::motion::{Sample, numbered, strengths};
use super::pictures::Picture;
use super::states;

/// Interval between samples, radians of the contacts' vibration.
const SAMPLE_RAD: f64 = 1.0;

/// Native run of a model; other models are evaluated at its states.
pub struct Course<'a> {
    gearbox: &'a Gearbox,
    samples: Vec<Sample>,
}

impl<'a> Course<'a> {
    /// Runs a model from its start; `None` if it has no reduced form.
    pub fn of(gearbox: &'a Gearbox) -> Option<Self> {
        let work = Work::new(gearbox, u64::MAX);
        let mut model = Model::new(&work, Vec::new())?;
        let step = SAMPLE_RAD / Frequencies::of(&gearbox.scene).contact_rad_s;
        let times: Vec<f64> = (0..SAMPLES).map(|k| k as f64 * step).collect();
        let begun = model.start();
        let samples = numbered(&times, model.follow(0.0, &begun, &times)?);
        Some(Self { gearbox, samples })
    }
}

/// Judges each stage of a model at the states of another; `None` if their bodies differ or one has no reduced form.
pub fn between(course: &Course<'_>, b: &Gearbox) -> Option<Located> {
    let (a, samples) = (course.gearbox, &course.samples);
    if a.layout != b.layout || a.floats() != b.floats() {
        return None;
    }
    let works = [a, b].map(|gearbox| Work::new(gearbox, u64::MAX));
    let both = works.each_ref().map(|work| Model::new(work, Vec::new()));
    let [Some(mut first), Some(mut second)] = both else {
        return None;
    };
    let written = rows(&mut first, samples);
    let [from, of] = [(a, &first), (b, &second)]
        .map(|(gearbox, model)| states::Columns::of(gearbox, model.free()));
    // A pin that turns only in the second model keeps its initial angle.
    let places = |y: &[f64], otherwise: &[f64]| -> Vec<f64> {
        let place = |name: &Option<String>| {
            let mut own = from.names.iter();
            own.position(|own| own.is_some() && own == name)
        };
        let all = of.names.iter().zip(otherwise);
        all.map(|(name, start)| place(name).map_or(*start, |k| y[k]))
            .collect()
    };
    let begun = second.start();
    let carried = |sample: &Sample| Sample {
        y: places(&sample.y, &begun),
        ..*sample
    };
    let carried: Vec<Sample> = samples.iter().map(carried).collect();
    let columns = Columns::held(b, &mut second, &carried, written);
    let (begun, picture) = start(&carried[0].y, &second, &of.coordinates);
    let mut stages = vec![begun];
    let mut pictures = vec![picture];
    stages.extend(by_columns(&columns, None));
    // Both models know their pairs, with and without force.
    let (mut deepest, mut apart) = (f64::MIN_POSITIVE, Vec::new());
    for (own, (_, two)) in samples.iter().zip(&columns.contacts) {
        let (_, one) = first.pairs(own.time_s, &own.y);
        let mut row = vec![0.0_f64; columns.forces().len()];
        for pair in one.iter().chain(two) {
            let depth = |all: &[PairContact]| {
                let mut all = all.iter();
                let same = all.find(|it| (it.sleeve, it.wheel) == (pair.sleeve, pair.wheel));
                same.map_or(0.0, |it| it.penetration_m)
            };
            let pin = b.layout.sleeve_body(pair.sleeve) - b.layout.external_bodies().start;
            row[pin] = row[pin].max((depth(&one) - depth(two)).abs());
            deepest = deepest.max(pair.penetration_m);
        }
        apart.push(row);
    }
    let shares = apart.iter_mut().flatten();
    shares.for_each(|off| *off /= deepest);
    let over_time = columns.over_time(Stage::ContactSearch, &apart);
    stages[1] = most(&over_time, "deepest penetration", ROUNDING);
    let by_pin = Picture::over_columns(Stage::ContactSearch, &apart, Vec::new());
    pictures.extend([over_time, by_pin]);
    let is_open = |judged: &Judged| !judged.is_off() || judged.stage == Stage::Start;
    stages.push(if stages[..4].iter().all(is_open) {
        let weights = strengths(b, &second, &of);
        let mut all = Vec::new();
        for (own, other) in samples.iter().zip(&carried) {
            let mut of = [vec![0.0; own.y.len()], vec![0.0; other.y.len()]];
            first.derivative(own.time_s, &own.y, &mut of[0]);
            second.derivative(other.time_s, &other.y, &mut of[1]);
            let a = places(&of[0], &of[1]);
            let off = a.iter().zip(&of[1]).skip(weights.len()).zip(&weights);
            let row: Vec<f64> = off.map(|((a, b), weight)| (a - b) * weight).collect();
            all.push(vec![dot(&row, &row).sqrt()]);
        }
        let over_time = columns.over_time(Stage::Equations, &all);
        let judged = most(&over_time, "load's accelerations", FLOW);
        pictures.push(over_time);
        judged
    } else {
        Judged::unknown(Stage::Equations, "hidden by an earlier stage")
    });
    stages.sort_by_key(|judged| judged.stage);
    let of_forces = columns.pictures().into_iter();
    pictures.extend(of_forces.filter(|picture| picture.stage != Stage::ContactSearch));
    let located = Located {
        run: b.scene.name.clone(),
        stages,
        pictures,
        ..Located::default()
    };
    Some(located.with_pictures())
}

/// Judges a stage by the largest value of its picture over time.
fn most(over_time: &Picture, of: &str, bound: f64) -> Judged {
    let values = &over_time.curves[0].1;
    let all = values.iter().zip(&over_time.x);
    let (most, when) = all
        .max_by(|a, b| a.0.total_cmp(b.0))
        .unwrap_or((&0.0, &0.0));
    let note = format!("of the {of}, most at t = {when:.3e} s");
    Judged::measured(over_time.stage, *most, bound, note)
}
