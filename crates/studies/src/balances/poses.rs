//! Input angles of one period of the mesh at which a gear is balanced.

use std::f64::consts::TAU;

use pinwheel_scene::Scene;

use crate::fourier::resolves;

/// Number of poses for one passage of a pin.
const PER_MESH: usize = 16;
/// Largest number of poses with at least four a passage, for gears with errors whose pins meet again after many passages.
pub const MOST: usize = 4096;
/// Largest number of poses. For a large gear with deviations they sample tooth passages at differing places; the +- includes
/// the differences of their parts.
pub const MOST_OF_ALL: usize = 4 * MOST;
/// Poses of one period.
///
/// Angles are those of the eccentrics, which are the input's except in RV gears: ring pins follow each other at the
/// eccentric after 2 pi/zk of the input, output pins after 2 pi zs/(zi zk). Both repeat together after 2 pi zs/(g zk), g =
/// gcd(zs, zi): less than a turn of the input. Parts with individual errors repeat only after a turn of the output.
pub struct Poses {
    /// Input angles, rad.
    pub angles: Vec<f64>,
    /// Number of parts for uncertainties.
    pub(crate) parts: usize,
    wheels: usize,
    /// Period of the input, rad.
    pub(crate) period: f64,
    /// Passages of ring and output pins in a period.
    pub meshes: [usize; 2],
    /// Periods per turn of the input.
    pub(crate) per_turn: f64,
    /// Input turns per output turn.
    pub(crate) ratio: f64,
}

/// Least number of poses of a part: its mean then excludes no visible harmonic of the mesh.
const LEAST_PART: usize = 9;
/// Least number of poses of a sweep. Over 50 random gears forces are then within 0.3 % of the result with all poses, and
/// transmission errors within 6 %.
const LEAST_RESOLVING: usize = 48;

/// Returns at least `least` equidistant angles over a period, in equal interleaved parts, and the number of parts. Every
/// part and all together sample the mesh of every disc at as many different places as they have angles, because neither
/// number has a common factor with the passages.
fn spread(period: f64, meshes: [usize; 2], least: usize) -> (Vec<f64>, usize) {
    let alone = |n: &usize| alone(*n, meshes);
    let parts = (3..).find(alone).unwrap_or(3);
    let part = least.div_ceil(parts).max(LEAST_PART);
    let count = parts * (part..).find(alone).unwrap_or(part);
    (equidistant(period, count), parts)
}

/// True if a number of poses has no factor in common with the passages.
fn alone(count: usize, meshes: [usize; 2]) -> bool {
    meshes.iter().all(|mesh| gcd(count, *mesh) == 1)
}

fn equidistant(period: f64, count: usize) -> Vec<f64> {
    let angle = |k: usize| period * k as f64 / count as f64;
    (0..count).map(angle).collect()
}

fn gcd(mut a: usize, mut b: usize) -> usize {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl Poses {
    /// Returns at least `least` poses of the same period.
    pub fn few(&self, least: usize) -> Self {
        let (angles, parts) = spread(self.period, self.passages(), least);
        Self {
            angles,
            parts,
            ..*self
        }
    }

    /// Returns the fewest poses of the same period that resolve the first four orders of both meshes, in one part. Gears whose
    /// parts have individual errors keep all poses.
    pub(crate) fn resolving(self) -> Self {
        let passages = self.passages();
        let good = |n: &usize| alone(*n, passages) && resolves(*n, self.meshes, 4);
        let alike = gcd(self.meshes[0], self.meshes[1]) == 1;
        let count = (LEAST_RESOLVING..self.angles.len()).find(good);
        match count.filter(|_| alike) {
            Some(count) => Self {
                angles: equidistant(self.period, count),
                parts: 1,
                ..self
            },
            None => self,
        }
    }

    /// Returns the numbers of all poses in an order with little motion of both kinds of pins between neighbours, because a
    /// balance starts from the previous one. Pins with individual errors are distinct.
    pub fn walk(&self) -> impl Iterator<Item = usize> + use<> {
        let count = self.angles.len();
        let moved = |stride: usize| {
            let of = |mesh: usize| stride * mesh % count;
            self.meshes.map(|mesh| of(mesh).min(count - of(mesh)))
        };
        // Passages have a common factor if pins have errors.
        let own = gcd(self.meshes[0], self.meshes[1]) > 1;
        let stride = (1..if own { 2 } else { count })
            .filter(|stride| gcd(*stride, count) == 1)
            .min_by_key(|stride| moved(*stride).into_iter().max())
            .unwrap_or(1);
        (0..count).map(move |k| k * stride % count)
    }

    /// Returns the passages of both kinds of pins at all discs.
    fn passages(&self) -> [usize; 2] {
        self.meshes.map(|mesh| mesh * self.wheels)
    }

    /// True if the number of poses resolves the harmonics of both meshes.
    pub fn has_harmonics(&self) -> bool {
        self.angles.len() > 2 * self.meshes[0].max(self.meshes[1]) + 1
    }

    /// Returns the poses of a scene's gear.
    pub fn of(scene: &Scene) -> Self {
        let gear = &scene.gear;
        let g = gcd(gear.lobes(), gear.internal_sleeves);
        let all = g * gear.external_sleeves;
        let times = if gear.errors.is_none() { 1 } else { all };
        let meshes = [gear.lobes() / g, gear.internal_sleeves / g].map(|mesh| mesh * times);
        let turned = TAU * meshes[0] as f64 / gear.external_sleeves as f64;
        let period = turned / scene.eccentric_per_input().abs();
        let most = meshes[0].max(meshes[1]);
        let count = (most * PER_MESH.min(MOST / most).max(4)).min(MOST_OF_ALL);
        let wheels = gear.wheels;
        let (angles, parts) = spread(period, meshes.map(|mesh| mesh * wheels), count);
        Self {
            angles,
            parts,
            wheels,
            period,
            meshes,
            per_turn: TAU / period,
            ratio: scene.ratio(),
        }
    }
}
