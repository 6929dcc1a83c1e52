//! Remedies for a gear that cannot be built: values that pass all checks.
//!
//! Each value of a gear is moved to both sides until the gear can be built, and then back as far as possible. The checks do
//! not know whether holes follow from pin and eccentricity, so a remedy must fit both cases. The remedy names R or m,
//! whichever the scene gives.

use super::geometry;
use crate::error::Fault;
use crate::model::Gear;
use crate::number::nearest;

/// Ratio of neighbouring trial values, and their number to either side.
const RATIO: f64 = 1.05;
const TRIED: i32 = 80;
/// Number of halvings towards the limit.
const HALVINGS: usize = 12;
/// Logarithm of the largest change; beyond it the value belongs to another gear.
const ANOTHER_GEAR: f64 = 1.6;
/// Largest number of offered remedies.
const OFFERED: usize = 3;
/// Largest number of holes of all discs: each trial measures all of them, and a user-defined profile.
const MOST_HOLES: usize = 100;

type Value = (&'static str, fn(&mut Gear) -> &mut f64);

macro_rules! values {
    ($($($field:ident).+),*) => {
        [$((concat!("gear" $(, ".", stringify!($field))+), |gear| &mut gear.$($field).+)),*]
    };
}

/// Values that a remedy may change; the last three also to zero.
const VALUES: [Value; 10] = values!(
    eccentricity_m,
    shortening,
    external_sleeve_radius_m,
    internal_sleeve_radius_m,
    internal_circle_radius_m,
    hole_radius_m,
    backlash_m,
    modification.equidistant_m,
    modification.radial_m,
    modification.rotational_rad
);
const SHORTENING: &str = "gear.shortening";
const ECCENTRICITY: &str = "gear.eccentricity_m";

/// Check of one stage: true if a gear passes it.
type Builds = fn(&Gear) -> bool;

/// Returns the fault with remedies, nearest first; unchanged if there is none.
pub(super) fn tried(gear: &Gear, gives_circle: bool, fault: Fault) -> Fault {
    let own = !gear.modification.normal_m.is_none();
    if own || gear.wheels * gear.internal_sleeves > MOST_HOLES {
        return fault;
    }
    let checked: Builds = |gear| geometry::entire(gear).is_ok();
    let outside: Builds = |gear| geometry::outside(gear).is_ok();
    // Keys named by the fault come first.
    let place = |key: &str| fault.keys.iter().position(|known| known == key);
    let single = |builds| single(gear, gives_circle, builds);
    let mut changes = single(checked);
    if changes.is_empty() {
        changes.extend(output_stage(gear, gives_circle));
    }
    // With two faults at once, first that of the profile, then the other.
    if changes.is_empty() && !outside(gear) {
        changes = single(outside);
        if changes.is_empty() {
            changes.extend(external_stage(gear, gives_circle));
        }
    }
    if changes.is_empty() {
        return fault;
    }
    if changes.iter().any(|change| change.far < ANOTHER_GEAR) {
        changes.retain(|change| change.far < ANOTHER_GEAR);
    }
    let far = |change: &Remedy| (place(change.key).unwrap_or(usize::MAX), change.far);
    changes.sort_by(|a, b| {
        far(a)
            .partial_cmp(&far(b))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let words = changes.into_iter().take(OFFERED).map(|change| change.words);
    Fault {
        remedy: format!("would do: {}", words.collect::<Vec<_>>().join(", or ")),
        ..fault
    }
}

/// Change that makes a gear buildable.
struct Remedy {
    key: &'static str,
    /// Magnitude of the logarithmic change.
    far: f64,
    words: String,
}

/// Returns the changes of a single value.
fn single(gear: &Gear, gives_circle: bool, builds: Builds) -> Vec<Remedy> {
    let mut changes = Vec::new();
    for (key, of) in VALUES {
        let from = *of(&mut gear.clone());
        let put = |value: f64| {
            let mut moved = gear.clone();
            *of(&mut moved) = value;
            moved
        };
        if from == 0.0 {
            continue;
        }
        let fits = |value: f64| {
            let meant = variants(gear, &put(value));
            in_range(key, value) && !meant.is_empty() && meant.iter().all(builds)
        };
        let far = |value: f64| (value / from).ln().abs();
        let mut values: Vec<f64> = [RATIO, 1.0 / RATIO]
            .into_iter()
            .filter_map(|ratio| {
                let mut steps = (1..=TRIED).map(|k| from * ratio.powi(k));
                edge(from, steps.find(|value| fits(*value))?, &fits)
            })
            .collect();
        if key.starts_with("gear.modification.") && values.is_empty() && fits(0.0) {
            values.push(0.0);
        }
        values.sort_by(|a, b| far(*a).total_cmp(&far(*b)));
        changes.extend(values.first().map(|value| Remedy {
            key,
            far: far(*value),
            words: in_words(gear, gives_circle, key, *value),
        }));
    }
    changes
}

/// Returns the value of few digits that still fits next to the limit between `bad` and `good`, located by bisection.
fn edge(bad: f64, mut good: f64, fits: &dyn Fn(f64) -> bool) -> Option<f64> {
    let mut bad = bad;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (bad + good);
        *(if fits(middle) { &mut good } else { &mut bad }) = middle;
    }
    let rounded = |digits: i32| {
        let unit = 10_f64.powi(good.abs().log10().floor() as i32 + 1 - digits);
        let beside = [good, good - unit, good + unit].map(|value| nearest(value, digits));
        beside.into_iter().find(|value| fits(*value))
    };
    (2..=6).find_map(rounded)
}

/// Returns the gears that a scene may mean: with m or R unchanged, and with holes unchanged or recomputed.
fn variants(before: &Gear, moved: &Gear) -> Vec<Gear> {
    let mut all = Vec::new();
    // An invalid m follows from R only.
    if before.shortening < 1.0 || moved.shortening != before.shortening {
        all.push(moved.clone());
    }
    if moved.eccentricity_m != before.eccentricity_m {
        let shortening = moved.shortening * moved.eccentricity_m / before.eccentricity_m;
        all.push(Gear {
            shortening,
            ..moved.clone()
        });
    }
    let followed = before.internal_sleeve_radius_m + before.eccentricity_m;
    let follows = moved.internal_sleeve_radius_m + moved.eccentricity_m;
    let as_before = moved.hole_radius_m == before.hole_radius_m && follows != followed;
    if as_before && (before.hole_radius_m / followed - 1.0).abs() < 1e-9 {
        let following = all.clone().into_iter();
        all.extend(following.map(|gear| Gear {
            hole_radius_m: follows,
            ..gear
        }));
    }
    all
}

fn in_range(key: &str, value: f64) -> bool {
    crate::keys::key(key).is_some_and(|row| row.refuses(value).is_none())
}

/// Returns a change as text, `gear.hole_radius_m = 0.0088`; if the scene gives R, a change of m as the equivalent R.
fn in_words(gear: &Gear, gives_circle: bool, key: &str, value: f64) -> String {
    if key != SHORTENING || !gives_circle {
        return format!("{key} = {value}");
    }
    let radius = gear.eccentricity_m * gear.external_sleeves as f64 / value;
    format!("gear.pin_circle_radius_m = {}", nearest(radius, 6))
}

/// Returns a change of the profile: no modification, a usual m, and pins and backlash that fit.
fn external_stage(gear: &Gear, gives_circle: bool) -> Option<Remedy> {
    const USUAL: f64 = 0.7;
    let mut fitting = gear.clone();
    fitting.modification = crate::model::Modification::default();
    if geometry::outside(&fitting).is_err() {
        fitting.shortening = fitting.shortening.min(USUAL);
    }
    if geometry::outside(&fitting).is_err() {
        let convex = crate::profile::Profile::of(&fitting).smallest_convex_radius();
        let most = convex.min(geometry::half_pitch(&fitting));
        fitting.external_sleeve_radius_m = nearest(USUAL * most, 2);
        let play = 0.4 * fitting.eccentricity_m.min(fitting.external_sleeve_radius_m);
        fitting.backlash_m = fitting.backlash_m.min(nearest(play, 2));
    }
    geometry::outside(&fitting).ok()?;
    let changed = VALUES.into_iter().filter_map(|(key, of)| {
        let [before, after] = [gear, &fitting].map(|gear| *of(&mut gear.clone()));
        (before != after).then(|| in_words(gear, gives_circle, key, after))
    });
    Some(Remedy {
        key: "",
        far: 0.0,
        words: changed.collect::<Vec<_>>().join(" and "),
    })
}

/// Returns new pins and holes on the present or another circle; without room for them also a smaller eccentricity.
fn output_stage(gear: &Gear, gives_circle: bool) -> Option<Remedy> {
    let smaller = (0..30).map(|k| {
        if k == 0 {
            return gear.clone();
        }
        let eccentricity_m = nearest(gear.eccentricity_m * 0.85_f64.powi(k), 2);
        let shortening = gear.shortening * eccentricity_m / gear.eccentricity_m;
        Gear {
            eccentricity_m,
            shortening: nearest(shortening, 6),
            ..gear.clone()
        }
    });
    smaller.into_iter().find_map(|smaller| {
        let fitting = with_output_stage(&smaller)?;
        let e = fitting.eccentricity_m;
        let eccentricity = match (e == gear.eccentricity_m, gives_circle) {
            (true, _) => String::new(),
            (false, true) => format!("{ECCENTRICITY} = {e} and "),
            (false, false) => format!(
                "{ECCENTRICITY} = {e} and {SHORTENING} = {} and ",
                fitting.shortening
            ),
        };
        let Gear {
            internal_circle_radius_m: circle,
            internal_sleeve_radius_m: sleeve,
            hole_radius_m: hole,
            ..
        } = fitting;
        Some(Remedy {
            key: "",
            far: 0.0,
            words: format!(
                "{eccentricity}gear.internal_circle_radius_m = {circle} and gear.internal_sleeve_radius_m = {sleeve} and \
                 gear.hole_radius_m = {hole}"
            ),
        })
    })
}

fn with_output_stage(gear: &Gear) -> Option<Gear> {
    geometry::outside(gear).ok()?;
    let pit = crate::profile::Profile::of(gear).pit_radius();
    let shares = (0..=70).map(|k| 0.95 - 0.01 * f64::from(k));
    let circles =
        std::iter::once(gear.internal_circle_radius_m).chain(shares.map(|share| share * pit));
    let fitting = circles.map(|circle| {
        let circle = nearest(circle, 3);
        let half_pitch = circle * (std::f64::consts::PI / gear.internal_sleeves as f64).sin();
        let most = 0.9 * half_pitch.min(pit - circle).min(circle);
        let sleeve = nearest(most - gear.eccentricity_m, 2);
        Gear {
            internal_circle_radius_m: circle,
            internal_sleeve_radius_m: sleeve,
            hole_radius_m: nearest(sleeve + gear.eccentricity_m, 6),
            ..gear.clone()
        }
    });
    let mut fitting =
        fitting.filter(|gear| gear.internal_sleeve_radius_m > 0.1 * gear.eccentricity_m);
    fitting.find(|gear| geometry::entire(gear).is_ok())
}
