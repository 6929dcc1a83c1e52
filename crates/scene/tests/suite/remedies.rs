//! Every remedy is applied, on randomly spoilt gears.

use crate::catalogue::catalogue;
use pinwheel_scene::catalogue::Catalogue;
use pinwheel_scene::{Override, Scene, SceneError};

/// Random numbers from 0 to 1, equal on every machine.
struct Random(u64);

impl Random {
    fn share(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) as f64 / (1_u64 << 31) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.share() * all.len() as f64) as usize]
    }
}

/// Returns a valid gear, as a scene with R and holes that follow, or with m and all values.
fn sound(random: &mut Random) -> (String, bool) {
    let size = 10_f64.powf(random.between(1.0, 2.8));
    let ratio = random.between(5.0, 90.0) as usize;
    let draft = Catalogue {
        wheels: Some(random.between(1.0, 4.0) as usize),
        ..catalogue(ratio as f64, size)
    };
    let draft = draft.draft().unwrap();
    let gives_circle = random.share() < 0.5;
    let text = if gives_circle {
        draft.text
    } else {
        draft.scene.to_toml()
    };
    (text, gives_circle)
}

/// Returns a key of a gear and a wrong value: times a factor, or for a value of 0 a share of the eccentricity.
fn spoilt(random: &mut Random, scene: &Scene, gives_circle: bool) -> (String, f64) {
    let gear = &scene.gear;
    let circle = if gives_circle {
        ("gear.pin_circle_radius_m", gear.pitch_radius_m())
    } else {
        ("gear.shortening", gear.shortening)
    };
    let e = gear.eccentricity_m;
    let (key, value) = random.one_of(&[
        circle,
        ("gear.eccentricity_m", e),
        (
            "gear.external_sleeve_radius_m",
            gear.external_sleeve_radius_m,
        ),
        (
            "gear.internal_sleeve_radius_m",
            gear.internal_sleeve_radius_m,
        ),
        (
            "gear.internal_circle_radius_m",
            gear.internal_circle_radius_m,
        ),
        ("gear.hole_radius_m", gear.hole_radius_m),
        ("gear.backlash_m", 0.5 * e),
        ("gear.modification.equidistant_m", 0.5 * e),
        ("gear.modification.radial_m", -0.5 * e),
    ]);
    (key.to_owned(), value * random.between(-1.6, 1.6).exp())
}

fn load(text: &str, sets: &[(String, f64)]) -> Result<(), SceneError> {
    let sets: Vec<Override> = sets
        .iter()
        .map(|(key, value)| Override::new(key, format!("{value:e}")))
        .collect();
    Scene::from_toml(text, "mine.toml", &sets).map(|_| ())
}

/// Returns the remedies of a geometry message: ways, each with keys to set. `None`: a single value out of its range.
fn offered(error: &SceneError) -> Option<Vec<Vec<(String, f64)>>> {
    let SceneError::Key {
        key, what, remedy, ..
    } = error
    else {
        panic!("{error}");
    };
    if what.contains("must be") {
        return None;
    }
    if let Some(meant) = remedy.strip_prefix("did you mean ") {
        let (value, _) = meant.split_once('?').unwrap();
        return Some(vec![vec![(key.clone(), value.parse().unwrap())]]);
    }
    let Some(ways) = remedy.strip_prefix("would do: ") else {
        return Some(Vec::new());
    };
    let ways = ways.split(", or ").map(|way| {
        let sets = way.split(" and ").map(|set| {
            let (key, value) = set.split_once(" = ").unwrap();
            (key.to_owned(), value.parse().unwrap())
        });
        sets.collect()
    });
    Some(ways.collect())
}

/// Each way of a remedy leads to a valid gear, in two steps at most.
#[test]
fn every_remedy_of_every_geometry_error_works() {
    let mut random = Random(7);
    let (mut wrong, mut ways_followed, mut second, mut without) = (0, 0, 0, Vec::new());
    for _ in 0..300 {
        let (text, gives_circle) = sound(&mut random);
        let scene = Scene::from_toml(&text, "mine.toml", &[])
            .unwrap()
            .into_scene();
        let faults = 1 + usize::from(random.share() < 0.3);
        let sets: Vec<_> = (0..faults)
            .map(|_| spoilt(&mut random, &scene, gives_circle))
            .collect();
        let Err(error) = load(&text, &sets) else {
            continue;
        };
        let Some(ways) = offered(&error) else {
            continue;
        };
        wrong += 1;
        if ways.is_empty() {
            without.push(error.to_string());
        }
        for way in ways {
            ways_followed += 1;
            let mut once = sets.clone();
            once.extend(way);
            let Err(other) = load(&text, &once) else {
                continue;
            };
            second += 1;
            let again = offered(&other).unwrap_or_default();
            assert!(!again.is_empty(), "{sets:?}: {error}\nthen {other}");
            for way in again {
                let mut twice = once.clone();
                twice.extend(way);
                if let Err(last) = load(&text, &twice) {
                    panic!("{sets:?}: {error}\nthen {other}\nthen {last}");
                }
            }
        }
    }
    println!(
        "{wrong} wrong gears, {ways_followed} ways, {second} needed a second step, {} had none",
        without.len()
    );
    assert!(without.is_empty(), "{without:#?}");
    assert!(wrong > 100 && ways_followed > wrong);
}

/// A catalogue of inconsistent data names the value whose omission or suggestion gives a valid gear.
#[test]
fn every_remedy_of_a_catalogue_works() {
    let mut random = Random(3);
    let (mut wrong, mut without) = (0, Vec::new());
    for _ in 0..300 {
        let size = 10_f64.powf(random.between(1.5, 2.5));
        let mut some = |value: f64| {
            let given = random.share() < 0.4;
            given.then(|| 1e-3 * value * random.between(-0.9, 0.9).exp())
        };
        let given = Catalogue {
            pin_diameter_m: some(0.05 * size),
            eccentricity_m: some(0.011 * size),
            output_pin_diameter_m: some(0.1 * size),
            output_circle_diameter_m: some(0.6 * size),
            ..catalogue(29, size)
        };
        let Err(fault) = given.draft() else { continue };
        wrong += 1;
        fn field<'a>(of: &'a mut Catalogue, key: &str) -> &'a mut Option<f64> {
            match key {
                "gear.internal_circle_radius_m" => &mut of.output_circle_diameter_m,
                "gear.internal_sleeve_radius_m" => &mut of.output_pin_diameter_m,
                "gear.external_sleeve_radius_m" => &mut of.pin_diameter_m,
                "gear.eccentricity_m" => &mut of.eccentricity_m,
                other => panic!("{other}"),
            }
        }
        if fault.remedy == "leave both out" {
            let mut followed = given.clone();
            for key in &fault.keys {
                *field(&mut followed, key) = None;
            }
            assert!(followed.draft().is_ok(), "{given:?}: {fault}");
            continue;
        }
        let Some(rest) = fault.remedy.strip_prefix("leave it out, or give ") else {
            without.push(fault.to_string());
            continue;
        };
        let value = 1e-3 * rest.split_once(',').unwrap().0.parse::<f64>().unwrap();
        for value in [None, Some(value)] {
            let mut followed = given.clone();
            *field(&mut followed, &fault.keys[0]) = value;
            if let Err(again) = followed.draft() {
                panic!("{given:?}: {fault}\nthen {again}");
            }
        }
    }
    println!(
        "{wrong} wrong catalogues, {} without a single way: {without:#?}",
        without.len()
    );
    assert!(wrong > 60 && without.is_empty());
}
