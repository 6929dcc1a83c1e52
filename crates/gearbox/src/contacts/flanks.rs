//! Disc whose flanks are rotated towards the middle of their lobes: the intersection of two discs, rotated by +delta and
//! -delta.
//!
//! From the middle of a lobe counter-clockwise to the middle of a pit its edge is that of the disc rotated by -delta, from
//! there to the next lobe that of the other one. The two edges meet in corners, all of which are convex. A pin touches the
//! nearer of the feet on the disc's edge, or, if there is none, the corner between them. A corner has no radius; its stiffness
//! is that of the adjacent flanks.

use std::f64::consts::PI;

use pinwheel_contact::Complex;

use super::detection::Touch;
use crate::geometry::Geometry;

/// Edge of a disc with rotated flanks.
pub struct Flanks {
    /// Rotation e^{i delta} of a flank.
    turn: Complex,
    lobes: f64,
    /// Corners at the lobes' middles, and in the pits.
    corners: [Corner; 2],
}

#[derive(Clone, Copy)]
struct Corner {
    /// Distance from the disc's centre, m.
    radius: f64,
    /// Curvature kappa of the curve of either flank, 1/m.
    curvature: f64,
}

/// Contact point of a pin on the profile.
#[derive(Clone, Copy)]
pub enum Seat {
    /// Curve point e^{ia} of a rotated disc.
    Foot {
        /// Point e^{ia} of the curve.
        unit: Complex,
        /// Rotation e^{i angle} of the disc.
        turn: Complex,
    },
    /// Corner between flanks, or a hole.
    Corner,
}

impl Flanks {
    /// Returns the edge of a disc with rotated flanks; `None` if they are not rotated.
    pub fn of(geometry: &Geometry) -> Option<Self> {
        let turn = geometry.flanks?;
        let curve = &geometry.curve;
        let half = PI / f64::from(curve.lobes());
        let edge = |a: f64| {
            let at = curve.at(a);
            at.position - at.normal.scale(geometry.edge_offset_m)
        };
        // The corner is the point of the edge with a polar angle of delta beyond the middle: rotated back by delta, it is in
        // the middle.
        let corner = |middle: f64| {
            let beyond = Complex::unit(middle) * turn;
            let (mut low, mut high) = (middle, middle + half);
            for _ in 0..60 {
                let a = 0.5 * (low + high);
                if beyond.cross(edge(a)) < 0.0 {
                    low = a;
                } else {
                    high = a;
                }
            }
            Corner {
                radius: edge(high).norm(),
                curvature: curve.at(high).curvature,
            }
        };
        Some(Self {
            turn,
            lobes: f64::from(curve.lobes()),
            corners: [corner(0.0), corner(half)],
        })
    }

    /// Returns the rotations of the two discs whose intersection the disc is.
    pub(super) fn turns(&self) -> [Complex; 2] {
        [self.turn, self.turn.conj()]
    }

    /// Returns the touch of a pin centred at `p`, chosen from the feet on either disc in the order of [`turns`](Self::turns);
    /// `stiffness` is K for a curvature kappa.
    pub fn touch(
        &self,
        p: Complex,
        radius: f64,
        feet: [(Touch, Seat); 2],
        stiffness: impl Fn(f64) -> f64,
    ) -> (Touch, Seat) {
        let [ccw, cw] = feet;
        // Counter-clockwise of a lobe's middle is the disc that is rotated clockwise.
        let side = |touch: &Touch| (self.lobes * touch.point.arg()).sin();
        match (side(&ccw.0) <= 0.0, side(&cw.0) >= 0.0) {
            (true, true) if cw.0.penetration > ccw.0.penetration => cw,
            (true, _) => ccw,
            (false, true) => cw,
            (false, false) => {
                let number = (p.arg() * self.lobes / PI).round();
                let corner = self.corners[usize::from(number.rem_euclid(2.0) == 1.0)];
                let point = Complex::unit(number * PI / self.lobes).scale(corner.radius);
                let k = stiffness(corner.curvature);
                (Touch::at_point(p, point, radius, k), Seat::Corner)
            }
        }
    }
}
