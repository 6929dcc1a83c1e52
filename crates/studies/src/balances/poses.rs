//! Input angles of one period of the mesh at which a gear is balanced.

use std::f64::consts::TAU;

use pinwheel_scene::Scene;

/// Poses for one passage of a pin.
const PER_MESH: usize = 16;
/// Poses at most, of which a passage has four at least where pins of a gear with errors meet again after many.
pub const MOST: usize = 4096;
/// Poses at most of any gear. Those of a large one with errors meet passages at places that differ from one to the next, and what
/// parts of them differ by is in the +-.
pub const MOST_OF_ALL: usize = 4 * MOST;
/// The poses of one period.
///
/// With angles of the eccentrics, which are the input's but in RV gears: from the eccentric a ring pin follows the other after 2 pi/zk of the input, an internal one after
/// 2 pi zs/(zi zk). Both come round together after 2 pi zs/(g zk), g = gcd(zs, zi): less than a turn of the input. Parts with
/// errors of their own meet again only when the output has turned once.
pub struct Poses {
    /// Input angles, rad.
    pub angles: Vec<f64>,
    /// Parts of them that figures are read off.
    pub(crate) parts: usize,
    wheels: usize,
    /// Period of the input, rad.
    pub(crate) period: f64,
    /// Passages of ring and output pins in it.
    pub meshes: [usize; 2],
    /// Periods per turn of the input.
    pub(crate) per_turn: f64,
    /// Input turns per output turn.
    pub(crate) ratio: f64,
}

/// Fewest poses of a part: a mean over them leaves out no harmonic of the mesh that is seen.
const LEAST_PART: usize = 9;

/// At least so many angles at equal distances over a period, in equal parts that take turns, and the number of parts. Every part
/// and all together meet either mesh of every disc at as many different places as they have angles, because neither number
/// has a factor in common with the passages.
fn spread(period: f64, meshes: [usize; 2], least: usize) -> (Vec<f64>, usize) {
    let alone = |n: &usize| meshes.iter().all(|mesh| gcd(*n, *mesh) == 1);
    let parts = (3..).find(alone).unwrap_or(3);
    let part = least.div_ceil(parts).max(LEAST_PART);
    let count = parts * (part..).find(alone).unwrap_or(part);
    let angle = |k: usize| period * k as f64 / count as f64;
    ((0..count).map(angle).collect(), parts)
}

fn gcd(mut a: usize, mut b: usize) -> usize {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl Poses {
    /// At least so many of the same period.
    pub fn few(&self, least: usize) -> Self {
        let (angles, parts) = spread(self.period, self.passages(), least);
        Self {
            angles,
            parts,
            ..*self
        }
    }

    /// Numbers of all poses, in an order in which pins of both kinds stand nearly as at the one before: a balance begins at
    /// the last. Pins with errors of their own stand as themselves.
    pub fn walk(&self) -> impl Iterator<Item = usize> + use<> {
        let count = self.angles.len();
        let moved = |stride: usize| {
            let of = |mesh: usize| stride * mesh % count;
            self.meshes.map(|mesh| of(mesh).min(count - of(mesh)))
        };
        // Passages have a common factor where pins have errors.
        let own = gcd(self.meshes[0], self.meshes[1]) > 1;
        let stride = (1..if own { 2 } else { count })
            .filter(|stride| gcd(*stride, count) == 1)
            .min_by_key(|stride| moved(*stride).into_iter().max())
            .unwrap_or(1);
        (0..count).map(move |k| k * stride % count)
    }

    /// Passages of both kinds of pins at all discs.
    fn passages(&self) -> [usize; 2] {
        self.meshes.map(|mesh| mesh * self.wheels)
    }

    /// True if harmonics of both meshes can be told from so many poses.
    pub fn has_harmonics(&self) -> bool {
        self.angles.len() > 2 * self.meshes[0].max(self.meshes[1]) + 1
    }

    /// Poses of a scene's gear.
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
