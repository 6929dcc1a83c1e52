//! Check of the parts' loads against their limits.
//!
//! | limit | default without one in `[limits]` |
//! |---|---|
//! | pressure of contacts | hardened steel: 4000 MPa (ISO 76, roller bearings, static), and 1500 MPa for endurance (ISO 281:2007, the fatigue limit; E. V. Zaretsky, In search of a fatigue limit, TLT, August 2010); others: yield begins at 1.67 Y (K. L. Johnson, Contact Mechanics, 1985, section 6.1) |
//! | pressure times sliding of sleeves | of the softer material, if tabulated ([`MATERIALS`](pinwheel_scene::catalogue::MATERIALS)) |
//! | bearing of a disc | static safety 1 after ISO 76; a life only if stated |
//! | bending of output pins | yield strength |
//! | walls of a disc | shear yields at Y/sqrt(3) (von Mises) |
//!
//! A value is judged with its numerical uncertainty at the worse end of its bands. Without a known limit it is not judged,
//! and then the answer is never *yes*.

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::catalogue::{Catalogue, Material, material};
use pinwheel_scene::{Held, Scene, Sleeve, derived};
use pinwheel_timeseries::figure::{Figure, FigureDef, definitions as defs};
use serde::Serialize;

use crate::StudyError;
use crate::balances::figures::{Balances, balanced, parted};
use crate::balances::mesh::{Pair, Pose, Stage};
use crate::balances::poses::Poses;
use crate::balances::solve::{FEW, at_poses};
use crate::band::{self, Bands, intervals};

/// Material with the limits of rolling bearings.
const ROLLING: &str = "steel";
/// Pressures of rolling bearings, MPa: static, and for endurance.
const ROLLING_MPA: [f64; 2] = [4000.0, 1500.0];
/// Pressure of a line contact at which yield begins, over the yield strength.
const YIELDS: f64 = 1.67;

/// Largest number of tried sizes, and factor on each beyond the margin required.
const SIZES: usize = 4;
const LARGER: f64 = 1.02;

/// Limit of a figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Limit {
    /// Definition of the limited figure.
    #[serde(flatten)]
    pub def: FigureDef,
    /// Kind of limit for a figure with two, else empty.
    pub of: &'static str,
    /// Value of the figure.
    pub value: Option<f64>,
    /// Value with its uncertainty, at the worse end of its bands.
    pub worst: Option<f64>,
    /// Largest, or least, permitted value.
    pub permissible: Option<f64>,
    /// Margin of the worst value: at least 1 within the limit; `None`: not judged.
    pub margin: Option<f64>,
    /// Source of the permitted value, or the key to state it.
    pub source: String,
    /// True for a limit of the user.
    pub is_stated: bool,
}

/// Answer to the question whether the gear bears its load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Answer {
    /// All limits are judged and met.
    Yes,
    /// All judged limits are met, others are not judged.
    AsFarAsJudged,
    /// At least one limit is exceeded.
    No,
    /// No limit is known.
    #[default]
    NotJudged,
}

/// All limits of a gear.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Limits {
    /// Answer of all limits.
    pub bears_its_load: Answer,
    /// Least margin of the judged limits.
    pub margin: Option<f64>,
    /// Every limit.
    pub each: Vec<Limit>,
}

/// Returns the materials of discs and pins, if known.
fn materials(scene: &Scene) -> [Option<&'static Material>; 2] {
    let [disc, pin] = [&scene.contact.material, &scene.contact.pin_material];
    [disc, pin.as_ref().map_or(disc, |_| pin)].map(|name| material(name.as_deref()?))
}

/// Returns the permitted product of pressure and sliding for sleeves of these materials, MPa m/s, and the material.
fn sliding_mpa_m_s(scene: &Scene) -> Option<(f64, String)> {
    let known = materials(scene).into_iter().flatten();
    let known = known.filter_map(|one| Some((1e-6 * one.pressure_sliding_w_m2?, one.name)));
    let (least, name) = known.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((least, format!("{name}, boundary lubrication (Mott)")))
}

/// Returns figures that only limits need, if the scene has the data.
pub(super) fn figures(balances: &Balances, scene: &Scene) -> Vec<Figure> {
    let (gear, limits) = (&scene.gear, &scene.limits);
    let length = scene.contact.line_length_m;
    let width = gear.face_width_m.unwrap_or(length);
    let walls = derived(scene).walls;
    let wall = walls.hole_to_profile_m.min(walls.hole_to_hole_m);
    let wall = wall.min(walls.hole_to_bore_m);
    let slides = limits.pressure_sliding_w_m2.is_some() || sliding_mpa_m_s(scene).is_some();
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    parted(balances.parts, |every, of| {
        let poses = balances.loaded.iter().skip(of).step_by(every);
        let safety = scene.roller_ratings_n().map(|[rating_n, _]| {
            let carried = balances.carried(scene, every, of);
            rating_n / most(&mut carried.into_iter().flatten())
        });
        let held = scene.bearings.internal_sleeves_held;
        let bending = held.map(|held| 1e-6 * bending_pa(poses.clone(), scene, held));
        let sliding = slides.then(|| {
            let pairs = poses.clone().flat_map(|pose| &pose.pairs);
            let of_pair = |pair: &Pair| {
                let radius = match pair.sleeve {
                    Sleeve::External(_) => gear.external_sleeve_radius_m,
                    Sleeve::Internal(_) => gear.internal_sleeve_radius_m,
                };
                1e-6 * pair.force_n * pair.sliding_m_s / (2.0 * radius * length)
            };
            most(&mut pairs.map(of_pair))
        });
        let shear = materials(scene)[0].map(|_| {
            let internal = poses.flat_map(|pose| pose.of(Stage::Internal));
            1e-6 * most(&mut internal.map(|pair| pair.force_n)) / (2.0 * wall * width)
        });
        let each = [
            (&defs::STATIC_SAFETY, safety),
            (&defs::PIN_BENDING, bending),
            (&defs::PROJECTED_SLIDING, sliding),
            (&defs::WALL_SHEAR, shear),
            (&defs::WALL, limits.wall_m.map(|_| 1e3 * wall)),
        ];
        let each = each.into_iter();
        each.filter_map(|(def, value)| Some(balanced(def, value?)))
            .collect()
    })
}

/// Returns the largest bending stress of an output pin, Pa; a sleeve turns on it, if there is one.
fn bending_pa<'a>(poses: impl Iterator<Item = &'a Pose>, scene: &Scene, held: Held) -> f64 {
    let (gear, bearings) = (&scene.gear, &scene.bearings);
    let (places, span) = scene.output_pins_m();
    let mut largest: f64 = 0.0;
    for pose in poses {
        let mut pins = vec![vec![0.0; gear.wheels]; gear.internal_sleeves];
        for pair in pose.of(Stage::Internal) {
            if let Sleeve::Internal(pin) = pair.sleeve {
                pins[pin][pair.wheel] += pair.force_n;
            }
        }
        for pin in pins {
            let sum = |arm: &dyn Fn(f64) -> f64| -> f64 {
                let each = pin.iter().zip(&places);
                each.map(|(force, place)| force * arm(*place)).sum()
            };
            let under = |x: f64| sum(&|a| x.min(a) * (span - x.max(a)) / span);
            largest = match held {
                Held::OneEnd => largest.max(sum(&|a| a)).max(sum(&|a| span - a)),
                Held::BothEnds => places.iter().copied().map(under).fold(largest, f64::max),
            };
        }
    }
    let diameter = 2.0 * gear.internal_sleeve_radius_m;
    let stated = scene.structure.output_pin_diameter_m;
    let pin = diameter.min(stated.or(bearings.sleeve_bore_m).unwrap_or(diameter));
    32.0 * largest / (PI * pin.powi(3))
}

/// Returns the largest end of a figure's bands by contact laws and fits, over its value.
fn larger(figure: &Figure) -> f64 {
    let ends = [figure.by_contact_law, figure.by_fit];
    let shares = ends.into_iter().flatten();
    let shares = shares.filter_map(|[_, high]| Some(high / figure.value?));
    shares.filter(|share| share.is_finite()).fold(1.0, f64::max)
}

impl Limits {
    /// Judges figures of a design against the scene's limits and those of its materials.
    #[must_use]
    pub fn of(scene: &Scene, figures: &[Figure]) -> Self {
        let get = |def: &FigureDef| figures.iter().find(|one| one.is(def));
        // Figure with the bands, exponent of `def` in it, the user's limit, that of a source, and the key to state.
        let judged = |def: &FigureDef,
                      (load, power): (&FigureDef, f64),
                      stated: Option<f64>,
                      own: Option<(f64, &str)>,
                      needs: &str| {
            let (value, off) = get(def).map_or((None, None), |one| (one.value, one.uncertainty));
            let share = get(load).map_or(1.0, larger).powf(power);
            let worst = value.map(|value| share * (value + off.unwrap_or(0.0).copysign(power)));
            let allowed = stated.map(|limit| (limit, "[limits]")).or(own);
            let allowed = allowed.filter(|_| value.is_some());
            let margin = worst.zip(allowed);
            let margin = margin.map(|(is, (may, _))| (may / is).powf(power.signum()));
            Limit {
                def: def.clone(),
                of: "",
                value,
                worst,
                permissible: allowed.map(|(may, _)| may),
                margin: margin.filter(|margin| margin.is_finite()),
                source: allowed.map_or_else(|| format!("state {needs}"), |(_, by)| by.to_owned()),
                is_stated: stated.is_some(),
            }
        };
        let (limits, [disc, pin]) = (&scene.limits, materials(scene));
        let mpa = |pa: Option<f64>| pa.map(|pa| 1e-6 * pa);
        let mut each = Vec::new();

        let both = disc.zip(pin).map(|(disc, pin)| [disc, pin]);
        let soft = both.into_iter().flatten().filter(|one| one.name != ROLLING);
        let softest = soft.min_by(|a, b| a.yield_pa.total_cmp(&b.yield_pa));
        let by = softest.map(|one| format!("yield of {} begins, 1.67 Y (Johnson)", one.name));
        let at_rest = match softest.zip(by.as_deref()) {
            Some((one, by)) => (1e-6 * YIELDS * one.yield_pa, by),
            None => (ROLLING_MPA[0], "hardened steel, static (ISO 76)"),
        };
        let endures = (ROLLING_MPA[1], "hardened steel, endurance (ISO 281)");
        let needs = "contact.material, or limits.pressure_pa";
        for def in [&defs::EXTERNAL_PRESSURE, &defs::INTERNAL_PRESSURE] {
            if get(def).is_none() {
                continue;
            }
            let stated = mpa(limits.pressure_pa);
            let kinds = match both.filter(|_| softest.is_none() && stated.is_none()) {
                Some(_) => vec![("at rest", at_rest), ("for endurance", endures)],
                None => vec![("", at_rest)],
            };
            each.extend(kinds.into_iter().map(|(of, own)| {
                let own = both.map(|_| own);
                Limit {
                    of,
                    ..judged(def, (def, 1.0), stated, own, needs)
                }
            }));
        }
        let (on_pin, on_bearing) = match scene.cranks {
            Some(_) => (&defs::CRANK_FORCE, &defs::CRANK_FORCE),
            None => (&defs::INTERNAL_FORCE, &defs::BEARING_FORCE),
        };
        let slides = sliding_mpa_m_s(scene);
        each.push(judged(
            &defs::PROJECTED_SLIDING,
            (&defs::EXTERNAL_FORCE, 1.0),
            mpa(limits.pressure_sliding_w_m2),
            slides.as_ref().map(|(most, by)| (*most, &**by)),
            "limits.pressure_sliding_w_m2",
        ));
        each.push(judged(
            &defs::STATIC_SAFETY,
            (on_bearing, -1.0),
            limits.static_safety,
            Some((1.0, "C0 of ISO 76")),
            "bearings.eccentric.roller_diameter_m with rollers, and gear.eccentric_bore_radius_m",
        ));
        if limits.life_h.is_some() {
            let needs = "bearings.eccentric.dynamic_rating_n";
            let load = (on_bearing, -10.0 / 3.0);
            each.push(judged(
                &defs::BEARING_LIFE,
                load,
                limits.life_h,
                None,
                needs,
            ));
        }
        if scene.cranks.is_none() {
            let needs = "bearings.internal_sleeves_held, and contact.material or limits.bending_pa";
            let own = pin.map(|pin| (1e-6 * pin.yield_pa, "yield of the pins' material"));
            let stated = mpa(limits.bending_pa);
            each.push(judged(
                &defs::PIN_BENDING,
                (on_pin, 1.0),
                stated,
                own,
                needs,
            ));
        }
        each.push(match limits.wall_m {
            Some(least) => judged(
                &defs::WALL,
                (&defs::WALL, -1.0),
                Some(1e3 * least),
                None,
                "",
            ),
            None => {
                let own = disc.map(|disc| 1e-6 * disc.yield_pa / 3.0_f64.sqrt());
                let own =
                    own.map(|most| (most, "yield of the discs' material in shear, Y/sqrt(3)"));
                let needs = "contact.material, or limits.wall_m";
                judged(&defs::WALL_SHEAR, (on_pin, 1.0), None, own, needs)
            }
        });
        let margin = each
            .iter()
            .filter_map(|limit| limit.margin)
            .min_by(f64::total_cmp);
        let bears_its_load = match margin {
            None => Answer::NotJudged,
            Some(margin) if margin < 1.0 => Answer::No,
            Some(_) if each.iter().all(|limit| limit.margin.is_some()) => Answer::Yes,
            Some(_) => Answer::AsFarAsJudged,
        };
        Self {
            bears_its_load,
            margin,
            each,
        }
    }

    /// Judges the loads of a gear's parts by balances at few poses, with the bands if there are some. Returns `None` for a gear
    /// without load or balance.
    ///
    /// # Errors
    /// Cancelled.
    pub fn of_gear(
        gearbox: &Gearbox,
        bands: Option<&Bands>,
        cancel: &AtomicBool,
    ) -> Result<Option<Self>, StudyError> {
        let scene = &gearbox.scene;
        let Ok(mut statics) = Statics::new(gearbox) else {
            return Ok(None);
        };
        let poses = Poses::of(scene).few(FEW);
        let Some(solved) = band::balanced(at_poses(&mut statics, (&poses, true), cancel))? else {
            return Ok(None);
        };
        let mut figures = solved.figures();
        figures.extend(solved.of_bearings(scene));
        figures.extend(self::figures(&solved, scene));
        solved.withhold_forces(&mut figures);
        if let Some(bands) = bands {
            bands.bound_all(&mut figures);
        }
        Ok(Some(Self::of(scene, &figures)))
    }

    /// Judges a gear of catalogue data at the largest of its clearances. If it cannot carry its load, returns its limits and
    /// the factor on the pin circle that suffices, if one was computed.
    ///
    /// # Errors
    /// Cancelled.
    pub fn too_weak(
        catalogue: &Catalogue,
        cancel: &AtomicBool,
    ) -> Result<Option<(Self, Option<f64>)>, StudyError> {
        let (mut weak, mut times) = (None, 1.0);
        for _ in 0..SIZES {
            let mut larger = catalogue.clone();
            larger.pin_circle_diameter_m *= times;
            let Ok(draft) = larger.draft() else { break };
            let mut ends = intervals(&draft.scene).into_iter();
            let loosest = ends.try_fold(draft.scene.clone(), |gear, (key, value, half)| {
                gear.with_number(key, value + half)
            });
            let gearbox = loosest.ok().and_then(|scene| Gearbox::new(&scene).ok());
            let solved = gearbox.map(|gearbox| Self::of_gear(&gearbox, None, cancel));
            let Some(solved) = solved.transpose()?.flatten() else {
                break;
            };
            let Some(margin) = solved.margin.filter(|margin| *margin < 1.0) else {
                return Ok(weak.map(|weak| (weak, Some(times))));
            };
            weak.get_or_insert(solved);
            // Pressures of line contacts fall with the diameter to the power of 1.5, or slower where clearances stay.
            times *= LARGER * margin.powf(-2.0 / 3.0);
        }
        Ok(weak.map(|weak| (weak, None)))
    }

    /// Returns the limit with the least margin.
    #[must_use]
    pub fn tightest(&self) -> Option<&Limit> {
        self.each
            .iter()
            .find(|limit| limit.margin.is_some() && limit.margin == self.margin)
    }

    /// Returns the first exceeded limit of the user.
    #[must_use]
    pub fn exceeded(&self) -> Option<&Limit> {
        let exceeded = |limit: &&Limit| limit.is_stated && limit.margin.is_some_and(|m| m < 1.0);
        self.each.iter().find(exceeded)
    }
}
