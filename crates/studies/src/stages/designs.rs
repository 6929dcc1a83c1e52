//! Two models: the second one at the states of the first.

use pinwheel_gearbox::contacts::PairContact;
use pinwheel_gearbox::{Frequencies, Gearbox};
use pinwheel_mbs::OdeSystem as _;

use super::fit::dot;
use super::forces::{Columns, rows};
use super::judged::{FLOW, Judged, ROUNDING, SAMPLES, Stage};
use super::locate::{Located, by_columns, start};
use super::model::{Model, Work};
use super::motion::{Sample, numbered, strengths};
use super::states;

/// Radians of the contacts' vibration from one sample to the next.
const SAMPLE_RAD: f64 = 1.0;

/// A native run of a model, at whose states others are judged.
pub struct Course<'a> {
    gearbox: &'a Gearbox,
    samples: Vec<Sample>,
}

impl<'a> Course<'a> {
    /// Follows a model from its start; `None` where it has no reduced form.
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

/// Judges each stage of a model at the states of another. `None`: the two have not the same bodies, or no reduced form.
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
    // A pin that turns in one alone does there as at the start.
    let places = |y: &[f64], from: &[usize], to: &[usize], otherwise: &[f64]| -> Vec<f64> {
        let (of, other) = (y.len() / 2, otherwise.len() / 2);
        let half = |y: &[f64], otherwise: &[f64]| -> Vec<f64> {
            let place = |body: &usize| from.iter().position(|other| other == body);
            let turned = to.iter().zip(otherwise);
            let turned = turned.map(|(body, start)| place(body).map_or(*start, |k| y[k]));
            turned.chain(y[from.len()..].iter().copied()).collect()
        };
        let halves = [(0..of, 0..other), (of..2 * of, other..2 * other)];
        halves
            .map(|(of, other)| half(&y[of], &otherwise[other]))
            .concat()
    };
    let (from, to) = (first.free().to_vec(), second.free().to_vec());
    let carried = |sample: &Sample| Sample {
        y: places(&sample.y, &from, &to, &second.start()),
        ..*sample
    };
    let carried: Vec<Sample> = samples.iter().map(carried).collect();
    let native = rows(&mut second, &carried);
    let columns = Columns::held(b, &carried, written, native);
    let of = states::Columns::of(b, &to);
    let (begun, picture) = start(&carried[0].y, &second, &of.coordinates);
    let mut stages = vec![begun];
    let mut pictures = vec![picture];
    stages.extend(by_columns(&columns, None));
    // Both know their pairs, with and without force.
    let (mut deepest, mut apart, mut when) = (0.0_f64, 0.0, 0.0);
    for (own, other) in samples.iter().zip(&carried) {
        let (_, one) = first.pairs(own.time_s, &own.y);
        let (_, two) = second.pairs(other.time_s, &other.y);
        for pair in one.iter().chain(&two) {
            let depth = |all: &[PairContact]| {
                let mut all = all.iter();
                let same = all.find(|it| (it.sleeve, it.wheel) == (pair.sleeve, pair.wheel));
                same.map_or(0.0, |it| it.penetration_m)
            };
            let off = (depth(&one) - depth(&two)).abs();
            deepest = deepest.max(pair.penetration_m);
            if off > apart {
                (apart, when) = (off, own.time_s);
            }
        }
    }
    let note = format!("penetrations most at t = {when:.3e} s");
    let off = apart / deepest.max(f64::MIN_POSITIVE);
    stages[1] = Judged::told(Stage::ContactSearch, off, ROUNDING, note);
    let is_open = |judged: &Judged| !judged.is_off() || judged.stage == Stage::Start;
    stages.push(if stages[..4].iter().all(is_open) {
        let weights = strengths(b, &second, &of);
        let (mut most, mut all) = ((0.0_f64, 0.0), Vec::new());
        for (own, other) in samples.iter().zip(&carried) {
            let mut of = [vec![0.0; own.y.len()], vec![0.0; other.y.len()]];
            first.derivative(own.time_s, &own.y, &mut of[0]);
            second.derivative(other.time_s, &other.y, &mut of[1]);
            let [a, b] = [places(&of[0], &from, &to, &of[1]), of[1].clone()];
            let off = a.iter().zip(&b).skip(weights.len()).zip(&weights);
            let row: Vec<f64> = off.map(|((a, b), weight)| (a - b) * weight).collect();
            let off = dot(&row, &row).sqrt();
            if off > most.0 {
                most = (off, own.time_s);
            }
            all.push(row);
        }
        pictures.push(columns.over_time(Stage::Equations, &all));
        let note = format!("accelerations most at t = {:.3e} s", most.1);
        Judged::told(Stage::Equations, most.0, FLOW, note)
    } else {
        Judged::untold(Stage::Equations, "hidden by an earlier stage")
    });
    stages.sort_by_key(|judged| judged.stage);
    pictures.extend(columns.pictures(&mut second, b.layout, &carried));
    let located = Located {
        run: b.scene.name.clone(),
        stages,
        pictures,
        ..Located::default()
    };
    Some(located.seen())
}
