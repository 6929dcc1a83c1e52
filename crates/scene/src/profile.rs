//! Curve C of the ring pins' centres relative to a disc, for checks.
//!
//! The disc profile is the inward offset of C by q (R and q with their modifications, [`crate::deviations`]), so C shows faults
//! of a profile; see [`Epitrochoid`] for the formulas.

use pinwheel_contact::Epitrochoid;

use super::model::Gear;

/// Epitrochoid of a gear with positive, finite numbers and zk of at least 3.
#[derive(Debug, Clone)]
pub struct Profile {
    curve: Epitrochoid,
    eccentricity: f64,
    offset: f64,
}

impl Profile {
    /// Returns the curve of a gear.
    pub fn of(gear: &Gear) -> Self {
        let sleeves = u32::try_from(gear.external_sleeves).unwrap_or(u32::MAX);
        let shortening = gear.generating_shortening();
        let curve = gear.own_curve();
        let bare = || Epitrochoid::unsearched(gear.eccentricity_m, sleeves, shortening);
        Self {
            curve: curve.unwrap_or_else(bare),
            eccentricity: gear.eccentricity_m,
            offset: gear.edge_offset_m(),
        }
    }

    /// Returns the number of lobes zs.
    pub fn lobes(&self) -> f64 {
        f64::from(self.curve.lobes())
    }

    /// Returns C(a), m, in the disc's frame.
    pub fn point(&self, a: f64) -> [f64; 2] {
        let point = self.curve.at(a).position;
        [point.re, point.im]
    }

    /// Returns the profile C - q n, m, in the disc's frame.
    pub fn offset_point(&self, a: f64) -> [f64; 2] {
        let at = self.curve.at(a);
        let point = at.position - at.normal.scale(self.offset);
        [point.re, point.im]
    }

    /// Returns dP/da of the profile, m: C' (1 - q kappa), because the offset of a curve is parallel to it.
    pub fn offset_slope(&self, a: f64) -> [f64; 2] {
        let at = self.curve.at(a);
        let slope = at.speed * (1.0 - self.offset * at.curvature);
        [-at.normal.im, at.normal.re].map(|x| slope * x)
    }

    /// Returns the curvature kappa of C at cos(zs a) = c, 1/m; positive on a lobe.
    pub fn curvature(&self, c: f64) -> f64 {
        self.curve.at(c.acos() / self.lobes()).curvature
    }

    /// Returns the smallest convex radius of C, m: a larger pin undercuts the disc.
    pub fn smallest_convex_radius(&self) -> f64 {
        match self.curve.has_offset() {
            // Within this reach, which has a margin of a tenth, an edge neither folds nor crosses itself.
            true => self.curve.reach_inside,
            false => 1.0 / self.curve.largest_curvature(),
        }
    }

    /// Returns the radii of the profile's pits and tips, its smallest and largest distance from the disc centre, m.
    pub fn radii(&self) -> [f64; 2] {
        if !self.curve.has_offset() {
            let ends = [-self.eccentricity, self.eccentricity];
            return ends.map(|end| self.curve.pitch_radius() + end - self.offset);
        }
        let step = std::f64::consts::TAU / (720.0 * self.lobes());
        let all = (0..720).map(|k| self.offset_point(f64::from(k) * step));
        all.map(|[x, y]| x.hypot(y))
            .fold([f64::INFINITY, 0.0], |[low, high], r| {
                [r.min(low), r.max(high)]
            })
    }

    /// Returns the radius of the profile's pits, m.
    pub fn pit_radius(&self) -> f64 {
        self.radii()[0]
    }

    /// Returns the distance from `point` to the part of C within `reach` radians of `around`, m.
    ///
    /// Takes the best of `samples` evenly spaced points and refines it by ternary search. C is smooth, so with dense
    /// samples the distance has one minimum between the best sample's neighbours.
    pub fn distance(&self, point: [f64; 2], around: f64, reach: f64, samples: usize) -> f64 {
        let at = |a: f64| {
            let [x, y] = self.point(a);
            (x - point[0]).hypot(y - point[1])
        };
        let step = 2.0 * reach / samples as f64;
        let mut best = (f64::INFINITY, around);
        for i in 0..=samples {
            let a = around - reach + step * i as f64;
            let distance = at(a);
            if distance < best.0 {
                best = (distance, a);
            }
        }
        let (mut low, mut high) = (best.1 - step, best.1 + step);
        for _ in 0..40 {
            let third = (high - low) / 3.0;
            if at(low + third) < at(high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        at(0.5 * (low + high)).min(best.0)
    }
}
