//! Discrete contact points, as published, without a scan of all of them.
//!
//! The paper lists the points of the disc inside the pin and takes the one nearest to the pin's centre. Squared distances from
//! P to the profile C - q n and to C are stationary at the same parameters (both normals are n). So the nearest vertex is a
//! neighbour of the exact foot, and the cost of the closest-point search does not depend on the number of points. A downhill
//! walk from there covers coarse rows of points.

use crate::{Complex, Epitrochoid, HertzStiffness};

/// Discrete point of the disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Position in the disc frame, m.
    pub position: Complex,
    /// 1/R_c of the circle through it and its two neighbours (the paper's approximation of the curvature), 1/m.
    pub curvature: f64,
}

impl Vertex {
    /// Returns the contact stiffness K of a pin of radius `q` at the vertex, N/m^1.5: 1/(R_c R_p/(R_c + R_p)) = 1/R_c + 1/R_p.
    #[inline]
    pub fn stiffness(&self, q: f64, hertz: &HertzStiffness) -> f64 {
        hertz.of(q, 1.0 / (self.curvature + 1.0 / q))
    }
}

/// Points of the profile at equal steps of the parameter a (a_k = 2 pi k/N).
#[derive(Debug, Clone, PartialEq)]
pub struct ProfilePoints {
    vertices: Vec<Vertex>,
    per_radian: f64,
}

impl ProfilePoints {
    /// Creates `count` points on the offset of `curve` by `offset` (m) for pins up to a radius `q` (m).
    ///
    /// `None` if a pit is so coarsely sampled that the circle through three points is smaller than the pin: Eq. 23
    /// then has no real value.
    pub fn new(curve: &Epitrochoid, offset: f64, q: f64, count: usize) -> Option<Self> {
        let step = std::f64::consts::TAU / count as f64;
        let positions: Vec<Complex> = (0..count)
            .map(|k| {
                let at = curve.at(k as f64 * step);
                at.position - at.normal.scale(offset)
            })
            .collect();
        let vertices = (0..count)
            .map(|k| {
                let (before, here, after) = (
                    positions[(k + count - 1) % count],
                    positions[k],
                    positions[(k + 1) % count],
                );
                let curvature = circle_curvature(before, here, after);
                (curvature + 1.0 / q > 1e-6 / q).then_some(Vertex {
                    position: here,
                    curvature,
                })
            })
            .collect::<Option<Vec<_>>>()?;
        Some(Self {
            vertices,
            per_radian: 1.0 / step,
        })
    }

    /// Returns the vertex nearest to `p` for a foot of parameter `a` (rad), with its squared distance (m^2).
    #[inline]
    pub fn nearest(&self, p: Complex, a: f64) -> (&Vertex, f64) {
        let n = self.vertices.len() as i64;
        let vertex = |k: i64| &self.vertices[k.rem_euclid(n) as usize];
        let distance2 = |k: i64| (p - vertex(k).position).norm2();
        let low = (a * self.per_radian).floor() as i64;
        let (mut best, mut least) = (low, distance2(low));
        for direction in [1, -1] {
            let mut k = if direction == 1 { low + 1 } else { low - 1 };
            // At most n steps, so that the walk ends.
            for _ in 0..n {
                let value = distance2(k);
                if value >= least {
                    break;
                }
                (best, least) = (k, value);
                k += direction;
            }
        }
        (vertex(best), least)
    }
}

/// Returns the signed curvature (1/m) of the circle through three points, positive when they turn left.
fn circle_curvature(a: Complex, b: Complex, c: Complex) -> f64 {
    let area2 = (b - a).cross(c - a);
    2.0 * area2 / ((b - a).norm() * (c - b).norm() * (c - a).norm())
}

/// Points of a hole at equal angles, the first along the disc's x axis.
///
/// ```
/// use pinwheel_contact::{Complex, HolePoints};
///
/// // Four points: right, up, left, down. The one nearest to 100 degrees is up.
/// let nearest = HolePoints::new(4).nearest(Complex::unit(100_f64.to_radians()));
/// assert!((nearest - Complex::new(0.0, 1.0)).norm() < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HolePoints {
    directions: Vec<Complex>,
    per_radian: f64,
}

impl HolePoints {
    /// Creates `count` points on a circle.
    pub fn new(count: usize) -> Self {
        let step = std::f64::consts::TAU / count as f64;
        Self {
            directions: (0..count).map(|k| Complex::unit(k as f64 * step)).collect(),
            per_radian: 1.0 / step,
        }
    }

    /// Returns the direction (unit vector from the hole's centre) of the point nearest to the direction of `offset`.
    #[inline]
    pub fn nearest(&self, offset: Complex) -> Complex {
        let n = self.directions.len() as i64;
        let k = (offset.arg() * self.per_radian).round() as i64;
        self.directions[k.rem_euclid(n) as usize]
    }
}
