//! Animation of the gearbox: an engine's time series, packed for the page's script.
//!
//! Angles are stored as differences from the ideal mesh, forces by pairs, packed with an error of 1/16 000 of the channel's
//! largest value. The script computes points and directions of contact from the same curve as the solver.

use std::f64::consts::{PI, TAU};

use crate::format::significant;
use crate::script::json_text;
use crate::study::escape;
use pinwheel_scene::{Scene, speed_profile};
use pinwheel_studies::motion::{channels, floats};
use pinwheel_timeseries::TimeSeries;
use serde_json::{Value, json};

use crate::pages::packed::{Rounding, Writer};

/// Number of stored binary digits of a channel's largest value.
const DIGITS: i32 = 14;
/// Smallest drawn force, as a share of the largest.
const LEAST: f64 = 1e-3;
/// Largest drawn offset of a disc from its eccentric, as a share of the pins' circle.
const OFFSET: f64 = 0.02;

/// Returns the magnification 1, 2, 5, 10, ... of offsets up to `largest`, drawn at most `wanted` long.
fn magnified(largest: f64, wanted: f64) -> f64 {
    let ratio = wanted / largest;
    if !(ratio.is_finite() && ratio > 1.0) {
        return 1.0;
    }
    let decade = 10.0_f64.powf(ratio.log10().floor());
    let steps = [5.0, 2.0, 1.0].into_iter();
    let mut steps = steps.filter(|step| step * decade <= ratio);
    steps.next().unwrap_or(1.0) * decade
}

/// Gearbox ready for drawing.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Animation {
    title: String,
    /// True if parts have errors.
    deviates: bool,
    /// Data for the page's script (see [`Animation::of`]).
    view: Value,
}

/// Returns a gear for the page's script: lengths in mm, angles in rad.
///
/// `e`: eccentricity; `zk`, `r`, `q`: ring pins, radius of their circle and their own; `m`: m' of the discs' curve, `edge`:
/// the edge's offset from it, `turn`: angle of turned flanks; `zi`, `rw`, `ri`: output pins; `rh`: radius of holes; `per`:
/// turns of the eccentrics against the ring per turn of the input; `ring`: true if the ring turns and the carrier is held; `sun`: the sun's radius if cranks carry the discs; `d`: backlash. Parts
/// include their errors: `external` and `internal` pins as centre and radius in the frame of their support, discs
/// (`bodies`) with length and angle of their eccentric and with their holes.
fn gear_json(scene: &Scene) -> Value {
    let gear = &scene.gear;
    let mm = |metres: f64| 1e3 * metres;
    // Coordinates rounded to a tenth of a nanometre.
    let place = |[x, y]: [f64; 2], radius: f64| [x, y, radius].map(|v| (1e10 * v).round() * 1e-7);
    let outer = |j| {
        let radius_m = gear.external_sleeve_radius_of_m(j);
        place(gear.external_sleeve_m(j), radius_m)
    };
    let inner = |k| {
        let radius_m = gear.internal_sleeve_radius_of_m(k);
        place(gear.internal_sleeve_m(k), radius_m)
    };
    let lobes = gear.external_sleeves as f64 - 1.0;
    let body = |i: usize| {
        // Holes are cut at the pins' positions for eccentrics without errors.
        let start = (PI - TAU * i as f64 / gear.wheels as f64) / lobes;
        let hole = |k| place(gear.hole_m(i, k, -start), gear.hole_radius_of_m(i, k));
        let holes = (0..gear.internal_sleeves).map(hole);
        json!({
            "e": mm(gear.eccentricity_of_m(i)),
            "phase": gear.phase_of_rad(i),
            "holes": holes.collect::<Vec<_>>(),
        })
    };
    let sun = scene.cranks.map(|cranks| {
        let rho = cranks.teeth_ratio();
        mm(cranks.circle_radius_m * rho / (1.0 + rho))
    });
    json!({
        "e": mm(gear.eccentricity_m),
        "zk": gear.external_sleeves,
        "r": mm(gear.pitch_radius_m()),
        "m": gear.generating_shortening(),
        "q": mm(gear.external_sleeve_radius_m),
        "edge": mm(gear.edge_offset_m()),
        "turn": gear.modification.rotational_rad,
        "own": gear.modification.normal_m.of_lobe().map(|offset| {
            let at = |k: u32| 1e3 * offset.at(TAU * f64::from(k) / 720.0)[0];
            (0..720).map(at).collect::<Vec<_>>()
        }),
        "zi": gear.internal_sleeves,
        "ri": mm(gear.internal_sleeve_radius_m),
        "rw": mm(gear.internal_circle_radius_m),
        "rh": mm(gear.hole_radius_m),
        "wheels": gear.wheels,
        "per": scene.eccentric_per_input(),
        "sun": sun,
        "ring": scene.ring_turns(),
        "d": mm(gear.backlash_m),
        "external": (0..gear.external_sleeves).map(outer).collect::<Vec<_>>(),
        "internal": (0..gear.internal_sleeves).map(inner).collect::<Vec<_>>(),
        "bodies": (0..gear.wheels).map(body).collect::<Vec<_>>(),
    })
}

impl Animation {
    /// Packs the samples from `from_s` to `to_s`, evenly spaced; `None` if a channel is missing or there
    /// are fewer than two samples.
    ///
    /// Data for the script: `gear`; `speed` of the input; `from`, `step` and `count` of the samples; `full`: force of a
    /// full arrow, N, above 99 % of the samples of loaded pins in the second half; `least`: the smallest drawn force;
    /// `offset`: magnification of the discs' offsets from their eccentrics, 0 without offsets; `samples`: all
    /// `channels` columns in sequence.
    pub(crate) fn of(
        title: impl Into<String>,
        scene: &Scene,
        time_series: &TimeSeries,
        (from_s, to_s): (f64, f64),
    ) -> Option<Self> {
        let range = time_series.window(from_s, to_s);
        let time = time_series.time_s().get(range.clone())?;
        let (&start, &end) = (time.first()?, time.last()?);
        if time.len() < 2 {
            return None;
        }
        let channels = channels(scene);
        let column = |(name, factor): &(String, f64)| -> Option<Vec<f64>> {
            let values = time_series.channel(name)?.get(range.clone())?;
            Some(values.iter().map(|v| v * factor).collect())
        };
        let columns: Vec<Vec<f64>> = channels.iter().map(column).collect::<Option<_>>()?;
        let mut writer = Writer::default();
        for column in &columns {
            let finite = |v: &f64| if v.is_finite() { *v } else { 0.0 };
            let column: Vec<f64> = column.iter().map(finite).collect();
            writer.column(&column, Rounding::OfPeak(DIGITS));
        }
        // Later samples of the channels whose names contain `part`.
        let later = |part: &'static str| {
            let all = channels.iter().zip(&columns);
            let of = all.filter(move |((name, _), _)| name.contains(part));
            of.flat_map(|(_, column)| column[time.len() / 2..].iter().copied())
        };
        let mut loads: Vec<f64> = later("_normal_force_").filter(|f| *f > 0.0).collect();
        let most = loads.len() * 99 / 100;
        let full = match loads.is_empty() {
            true => 1.0,
            false => *loads.select_nth_unstable_by(most, f64::total_cmp).1,
        };
        let largest = later("_offset_").fold(0.0, |most: f64, mm| most.max(mm.abs()));
        let wanted = OFFSET * 1e3 * scene.gear.pitch_radius_m();
        let view = json!({
            "gear": gear_json(scene),
            "speed": speed_profile::fastest_rad_s(&scene.drive),
            "motions": speed_profile::motions(&scene.drive),
            "from": start,
            "step": (end - start) / (time.len() - 1) as f64,
            "count": time.len(),
            "full": full,
            "least": LEAST * full,
            "offset": if floats(scene) { magnified(largest, wanted) } else { 0.0 },
            "channels": columns.len(),
            "samples": writer.finish(),
        });
        Some(Self {
            title: title.into(),
            deviates: !scene.gear.errors.is_none(),
            view,
        })
    }

    /// Sets another title.
    pub(crate) fn titled(self, title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..self
        }
    }

    /// Returns data for the page's script that replace another animation with as many samples.
    pub(crate) fn json(self) -> Value {
        self.view
    }
}

/// Returns the markup of one block with a common clock for all `views`, which must have the same sample times. It includes
/// style and script, so a page may have only one. `begin_s`: start and restart of the animation.
pub(crate) fn markup(views: &[Animation], begin_s: f64) -> String {
    let Some(first) = views.first() else {
        return String::new();
    };
    let number = |key: &str| first.view[key].as_f64().unwrap_or_default();
    let begin = ((begin_s - number("from")) / number("step")).round();
    let begin = begin.clamp(0.0, number("count") - 1.0) as usize;
    let data: Vec<&Value> = views.iter().map(|one| &one.view).collect();
    let data = json!({ "views": data, "begin": begin });
    let drawn = views.iter().map(|Animation { title, view, .. }| {
        let count = |key: &str| view["gear"][key].as_u64().unwrap_or_default();
        format!(
            include_str!("../../../templates/gearbox.html"),
            title = escape(title),
            wheels = count("wheels"),
            lobes = count("zk") - 1,
            external = count("zk"),
            internal = count("zi")
        )
    });
    let wheels = first.view["gear"]["wheels"].as_u64().unwrap_or_default();
    let wheels = (0..wheels).map(|i| {
        let colour = i % 4;
        format!(
            "<button type=\"button\" data-wheel=\"{i}\" aria-pressed=\"true\"><i style=\"--dot:var(--wheel-{colour});--rim:var(--wheel-{colour}-edge)\"></i>Disc {i}</button>"
        )
    });
    format!(
        include_str!("../../../templates/gearboxes.html"),
        css = include_str!("../../../assets/animation.css"),
        views = drawn.collect::<String>(),
        wheels = wheels.collect::<String>(),
        full = significant(number("full"), 3),
        deviations = match views.iter().any(|v| v.deviates) {
            true => " and its errors; parts stand where theirs put them, to scale",
            false => "",
        },
        data = json_text(&data),
        gearbox = include_str!("../../../assets/gearbox.js"),
        picture = include_str!("../../../assets/gearbox-picture.js"),
        animation = include_str!("../../../assets/animation.js")
    )
}

#[cfg(test)]
mod tests {
    use pinwheel_studies::motion::{BYTES, sampled};

    use super::*;

    fn scene() -> Scene {
        let mut scene = Scene::paper();
        let gear = &mut scene.gear;
        (gear.external_sleeves, gear.internal_sleeves, gear.wheels) = (3, 2, 1);
        scene
    }

    fn time_series() -> TimeSeries {
        let mut time_series =
            TimeSeries::new((0..11).map(|k| f64::from(k) * 1e-3).collect()).unwrap();
        let mut push = |name: &str, value: f64| {
            time_series
                .push(name, (0..11).map(|k| value + f64::from(k)).collect())
                .unwrap();
        };
        for name in [
            "input_torque_n_m",
            "output_torque_n_m",
            "transmission_error_arcmin",
            "wheel_transmission_error_arcmin_0",
        ] {
            push(name, 1.0);
        }
        for n in 0..3 {
            push(
                &format!("wheel_0_external_normal_force_n_{n}"),
                10.0 * f64::from(n),
            );
        }
        for n in 0..2 {
            push(&format!("wheel_0_internal_normal_force_n_{n}"), 5.0);
        }
        time_series
    }

    #[test]
    fn a_window_is_packed_channel_by_channel() {
        let drawn = Animation::of("a <gear>", &scene(), &time_series(), (0.002, 0.006)).unwrap();
        assert_eq!(
            [&drawn.view["count"], &drawn.view["channels"]],
            [&json!(5), &json!(channels(&scene()).len())]
        );
        // The first channel rises from 3 to 7 N m.
        let first =
            crate::pages::packed::tests::Reader::new(drawn.view["samples"].as_str().unwrap())
                .column();
        for (value, wanted) in first.iter().zip([3.0, 4.0, 5.0, 6.0, 7.0]) {
            assert!((value - wanted).abs() < 7.0 / 16_000.0, "{first:?}");
        }
        let html = markup(&[drawn], 0.004);
        assert!(html.contains("a &lt;gear&gt;") && html.contains("\"begin\":2"));
        assert!(!html.contains("http:") && !html.contains("https:"));
    }

    #[test]
    fn parts_stand_where_their_errors_put_them() {
        let mut scene = scene();
        let nominal = gear_json(&scene);
        let errors = &mut scene.gear.errors;
        errors.external_sleeve_radial_m = vec![1e-5, 0.0, 0.0];
        errors.external_sleeve_tangential_m = vec![2e-5, 0.0, 0.0];
        errors.external_sleeve_radius_m = vec![-3e-6, 0.0, 0.0];
        errors.internal_sleeve_radial_m = vec![4e-6, 0.0];
        errors.hole_radius_m = vec![0.0, 5e-6];
        errors.eccentricity_m = vec![6e-6];
        errors.phase_rad = vec![1e-3];
        let moved = gear_json(&scene);
        let by = |a: &Value, b: &Value| {
            let [a, b] = [a, b].map(|value| value.as_f64().unwrap());
            (1e5 * (b - a)).round() / 1e5
        };
        let between =
            |a: &Value, b: &Value, k: usize| [0, 1, 2].map(|axis| by(&a[k][axis], &b[k][axis]));
        // Pin 0 is on the x axis.
        assert_eq!(
            between(&nominal["external"], &moved["external"], 0),
            [0.01, 0.02, -0.003]
        );
        assert_eq!(nominal["external"][1], moved["external"][1]);
        assert_eq!(
            between(&nominal["internal"], &moved["internal"], 0),
            [0.004, 0.0, 0.0]
        );
        let [was, is] = [&nominal["bodies"][0], &moved["bodies"][0]];
        assert_eq!(between(&was["holes"], &is["holes"], 1), [0.0, 0.0, 0.005]);
        assert_eq!(
            (by(&was["e"], &is["e"]), &is["phase"]),
            (0.006, &json!(1e-3))
        );
    }

    #[test]
    fn offsets_are_drawn_as_large_as_can_be_seen() {
        for (largest, times) in [(0.01, 100.0), (0.009, 100.0), (0.004, 200.0), (2.0, 1.0)] {
            assert_eq!(magnified(largest, 1.04), times, "{largest}");
        }
        assert_eq!(magnified(0.0, 1.0), 1.0);
        // The offsets are the last packed channels. A scene without bearings has no offsets.
        let mut scene = scene();
        let mut series = time_series();
        for axis in ["x", "y"] {
            let name = format!("eccentric_bearing_offset_{axis}_m_0");
            series.push(name, vec![1e-5; 11]).unwrap();
        }
        let rigid = Animation::of("x", &scene, &series, (0.0, 1.0)).unwrap();
        let view = |it: Animation| [it.view["offset"].clone(), it.view["channels"].clone()];
        assert_eq!(view(rigid), [json!(0.0), json!(9)]);
        scene.bearings.eccentric = Some(Default::default());
        let floating = Animation::of("x", &scene, &series, (0.0, 1.0)).unwrap();
        assert_eq!(view(floating), [json!(20.0), json!(11)]);
    }

    #[test]
    fn without_the_channels_there_is_none() {
        let bare = TimeSeries::new(vec![0.0, 1.0]).unwrap();
        assert!(Animation::of("x", &scene(), &bare, (0.0, 1.0)).is_none());
        assert!(Animation::of("x", &scene(), &time_series(), (0.5, 1.0)).is_none());
        assert_eq!(markup(&[], 0.0), "");
    }

    #[test]
    fn a_page_stays_small_for_any_gear() {
        let mut large = scene();
        let gear = &mut large.gear;
        (gear.external_sleeves, gear.internal_sleeves, gear.wheels) = (60, 12, 4);
        for mut scene in [scene(), large] {
            scene.solver.duration_s = 1e3;
            let (step, stretch) = sampled(&scene);
            assert!(
                step > 0.0
                    && 2.0 * channels(&scene).len() as f64 * (stretch / step) < 1.01 * BYTES as f64
            );
        }
    }
}
