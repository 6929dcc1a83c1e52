//! Curve C of the ring pins' centres relative to a disc, for checks.
//!
//! C(a) = R e^{ia} + e e^{i zk a} with R = e zk/m (Eq. 1 without its q terms). The disc profile is the inward offset of C
//! by q (R and q with their modifications, [`crate::deviations`]), so C shows faults of a profile: with c = cos(zs a),
//! curvature kappa(c) = (1 + m^2 zk + m (1 + zk) c) / (R (1 + m^2 + 2 m c)^1.5).

use pinwheel_contact::{CurvePoint, Epitrochoid};

use super::model::Gear;

/// Epitrochoid of a gear with positive, finite numbers and zk of at least 3.
#[derive(Debug, Clone)]
pub struct Profile {
    eccentricity: f64,
    radius: f64,
    offset: f64,
    shortening: f64,
    pins: f64,
    /// Curve C with a user-defined offset.
    own: Option<Epitrochoid>,
}

impl Profile {
    /// Returns the curve of a gear.
    pub fn of(gear: &Gear) -> Self {
        Self {
            eccentricity: gear.eccentricity_m,
            radius: gear.generating_radius_m(),
            offset: gear.edge_offset_m(),
            shortening: gear.generating_shortening(),
            pins: gear.external_sleeves as f64,
            own: gear.own_curve(),
        }
    }

    fn own_at(&self, a: f64) -> Option<CurvePoint> {
        self.own.as_ref().map(|curve| curve.at(a))
    }

    /// Returns the number of lobes zs.
    pub fn lobes(&self) -> f64 {
        self.pins - 1.0
    }

    /// Returns C(a), m, in the disc's frame.
    pub fn point(&self, a: f64) -> [f64; 2] {
        if let Some(at) = self.own_at(a) {
            return [at.position.re, at.position.im];
        }
        let (sin, cos) = a.sin_cos();
        let (sin_k, cos_k) = (self.pins * a).sin_cos();
        [
            self.radius * cos + self.eccentricity * cos_k,
            self.radius * sin + self.eccentricity * sin_k,
        ]
    }

    /// Returns the profile C - q n, m, in the disc's frame.
    pub fn offset_point(&self, a: f64) -> [f64; 2] {
        if let Some(at) = self.own_at(a) {
            let point = at.position - at.normal.scale(self.offset);
            return [point.re, point.im];
        }
        let tangent = self.tangent(a);
        let scale = self.offset / tangent[0].hypot(tangent[1]);
        let [x, y] = self.point(a);
        [x - scale * tangent[1], y + scale * tangent[0]]
    }

    /// Returns dP/da of the profile, m: C' (1 - q kappa), because the offset of a curve is parallel to it.
    pub fn offset_slope(&self, a: f64) -> [f64; 2] {
        if let Some(at) = self.own_at(a) {
            let slope = at.speed * (1.0 - self.offset * at.curvature);
            return [-at.normal.im, at.normal.re].map(|x| slope * x);
        }
        let share = 1.0 - self.offset * self.curvature((self.lobes() * a).cos());
        let scale = self.radius * share;
        self.tangent(a).map(|x| scale * x)
    }

    /// Returns C' divided by R: i (e^{ia} + m e^{i zk a}); its length is at least 1 - m > 0.
    fn tangent(&self, a: f64) -> [f64; 2] {
        let (sin, cos) = a.sin_cos();
        let (sin_k, cos_k) = (self.pins * a).sin_cos();
        let m = self.shortening;
        [-sin - m * sin_k, cos + m * cos_k]
    }

    /// Returns the curvature kappa of C at cos(zs a) = c, 1/m; positive on a lobe.
    pub fn curvature(&self, c: f64) -> f64 {
        if let Some(at) = self.own_at(c.acos() / self.lobes()) {
            return at.curvature;
        }
        let (m, zk) = (self.shortening, self.pins);
        (1.0 + m * m * zk + m * (1.0 + zk) * c)
            / (self.radius * (1.0 + m * m + 2.0 * m * c).powf(1.5))
    }

    /// Returns the smallest convex radius of C, m: a larger pin undercuts the disc.
    ///
    /// kappa is largest at an end of c in [-1, 1] or at a zero of its derivative, c = ((1 + zk)(1 + m^2) - 3 - 3 m^2 zk)/(m
    /// (1 + zk)); there the radius is R sqrt(27 (1 - m^2)(zk - 1)/(zk + 1)^3).
    pub fn smallest_convex_radius(&self) -> f64 {
        if let Some(curve) = &self.own {
            // Within this reach, which has a margin of a tenth, an edge neither folds nor crosses itself.
            return curve.reach_inside;
        }
        let (m, zk) = (self.shortening, self.pins);
        let mut kappa = self.curvature(-1.0).max(self.curvature(1.0));
        let inner = ((1.0 + zk) * (1.0 + m * m) - 3.0 - 3.0 * m * m * zk) / (m * (1.0 + zk));
        if inner.abs() < 1.0 {
            kappa = kappa.max(self.curvature(inner));
        }
        1.0 / kappa
    }

    /// Returns the radii of the profile's pits and tips, its smallest and largest distance from the disc centre, m.
    pub fn radii(&self) -> [f64; 2] {
        if self.own.is_none() {
            let [pit, tip] = [-self.eccentricity, self.eccentricity];
            return [
                self.radius + pit - self.offset,
                self.radius + tip - self.offset,
            ];
        }
        let step = 2.0 * std::f64::consts::PI / (720.0 * self.lobes());
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
