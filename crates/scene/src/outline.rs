//! Drawing of a cycloidal disc: its edge as a polygon with a stated chord error, and its holes.
//!
//! The edge repeats zs times, and every lobe is its own mirror image, so only half a lobe is drawn, from the lobe's tip to
//! the pit's bottom; of a user-defined profile a full lobe. With a rotational modification delta that half lies on the
//! profile turned by -delta, between the polar angles 0 and pi/zs ([`crate::deviations`]). All corners lie on the edge; the
//! error is its largest distance from the chords.

use std::f64::consts::{PI, TAU};

use pinwheel_contact::bisect;

use crate::error::Fault;
use crate::model::Gear;
use crate::number::short;
use crate::profile::Profile;

/// Points on the edge that are checked between two corners before a chord is accepted.
const LOOKS: usize = 7;
/// Largest number of halvings of half a lobe: a million chords.
const HALVINGS: u32 = 20;

/// Disc in its own frame: the origin is its centre, a lobe's tip lies on the x axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Corners of the edge, m, counter-clockwise, closed from last to first.
    pub edge_m: Vec<[f64; 2]>,
    /// Largest distance of the edge from its chords, m.
    pub chord_error_m: f64,
    /// Holes: centre and radius, m.
    pub holes_m: Vec<([f64; 2], f64)>,
}

impl Gear {
    /// Draws the disc `wheel` with all modifications and errors to the chord error `chord_m`, m.
    ///
    /// ```
    /// use pinwheel_scene::Scene;
    ///
    /// let gear = Scene::paper().gear;
    /// let disc = gear.outline(0, 1e-6)?;
    /// assert!(disc.chord_error_m <= 1e-6 && disc.holes_m.len() == 8);
    /// assert_eq!(disc.edge_m.len() % 15, 0); // lobes
    /// # Ok::<(), pinwheel_scene::Fault>(())
    /// ```
    ///
    /// # Errors
    /// A chord error that is not positive, or below a billionth of the disc.
    pub fn outline(&self, wheel: usize, chord_m: f64) -> Result<Outline, Fault> {
        let least = 1e-9 * self.pitch_radius_m();
        if !(chord_m >= least && chord_m.is_finite()) {
            return Err(Fault {
                keys: Vec::new(),
                what: format!("a chord error of {} m cannot be drawn", short(chord_m)),
                remedy: format!("give {} m or more, e.g. 1e-6", short(least)),
            });
        }
        let edge = Edge::of(self);
        let half = edge.half(chord_m);
        let chord_error_m = edge.error(&half);
        let half: Vec<[f64; 2]> = half.iter().map(|&a| edge.point(a)).collect();
        let lobes = self.external_sleeves - 1;
        let pitch = TAU / lobes as f64;
        // A user-defined lobe may be asymmetric, so all of it is drawn.
        let mirrors = self.modification.normal_m.is_none();
        let mut edge_m = Vec::with_capacity(2 * (half.len() - 1) * lobes);
        for lobe in 0..lobes {
            let turn = pitch * lobe as f64;
            let own = if mirrors {
                &half[..]
            } else {
                &half[..half.len() - 1]
            };
            edge_m.extend(own.iter().map(|&p| turned(p, turn)));
            if !mirrors {
                continue;
            }
            // The other half without the pit's bottom and the next tip, which begins the next lobe.
            let mirrored = half[1..half.len() - 1].iter().rev();
            edge_m.extend(mirrored.map(|&[x, y]| turned([x, -y], turn + pitch)));
        }
        // Holes are cut at the pins' positions for eccentrics without errors.
        let start = (PI - TAU * wheel as f64 / self.wheels as f64) / lobes as f64;
        let hole = |k| {
            (
                self.hole_m(wheel, k, -start),
                self.hole_radius_of_m(wheel, k),
            )
        };
        Ok(Outline {
            edge_m,
            chord_error_m,
            holes_m: (0..self.internal_sleeves).map(hole).collect(),
        })
    }
}

/// Returns a point turned about the origin.
pub fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [x * cos - y * sin, x * sin + y * cos]
}

/// Edge of half a lobe, or of a full one.
struct Edge {
    profile: Profile,
    delta: f64,
    /// Parameters of the edge's ends on the profile.
    ends: [f64; 2],
}

impl Edge {
    fn of(gear: &Gear) -> Self {
        let profile = Profile::of(gear);
        let delta = gear.modification.rotational_rad;
        let pit = match gear.modification.normal_m.is_none() {
            true => PI / profile.lobes(),
            false => TAU / profile.lobes(),
        };
        let mut edge = Self {
            profile,
            delta,
            ends: [0.0, pit],
        };
        if delta > 0.0 {
            edge.ends = [edge.at_polar(delta), edge.at_polar(pit + delta)];
        }
        edge
    }

    /// Returns the parameter of the profile with this polar angle, within a lobe; both increase together.
    fn at_polar(&self, wanted: f64) -> f64 {
        let [low, high] = bisect([0.0, TAU / self.profile.lobes()], |a| {
            let [x, y] = self.profile.offset_point(a);
            y.atan2(x) < wanted
        });
        0.5 * (low + high)
    }

    fn point(&self, a: f64) -> [f64; 2] {
        turned(self.profile.offset_point(a), -self.delta)
    }

    /// Returns the parameters of the corners.
    fn half(&self, chord_m: f64) -> Vec<f64> {
        let mut corners = vec![self.ends[0]];
        self.halve(self.ends, chord_m, HALVINGS, &mut corners);
        corners
    }

    fn halve(&self, [from, to]: [f64; 2], chord_m: f64, left: u32, corners: &mut Vec<f64>) {
        // At least four chords: both ends and the middle of a wave may lie on a straight line.
        let fine = HALVINGS - left >= 2 && self.bulge([from, to], LOOKS) <= chord_m;
        if fine || left == 0 {
            corners.push(to);
            return;
        }
        let middle = 0.5 * (from + to);
        self.halve([from, middle], chord_m, left - 1, corners);
        self.halve([middle, to], chord_m, left - 1, corners);
    }

    /// Returns the largest distance of `looks` points of the edge from the chord between two parameters, m.
    fn bulge(&self, [from, to]: [f64; 2], looks: usize) -> f64 {
        let ([x0, y0], [x1, y1]) = (self.point(from), self.point(to));
        let (dx, dy) = (x1 - x0, y1 - y0);
        let length = dx.hypot(dy);
        let each = (1..=looks).map(|k| {
            let share = k as f64 / (looks + 1) as f64;
            let [x, y] = self.point(from + share * (to - from));
            ((x - x0) * dy - (y - y0) * dx).abs() / length
        });
        each.fold(0.0, f64::max)
    }

    /// Returns the largest chord error of the polygon, m, evaluated at many more points.
    fn error(&self, corners: &[f64]) -> f64 {
        let each = corners.windows(2);
        each.map(|pair| self.bulge([pair[0], pair[1]], 16 * (LOOKS + 1) - 1))
            .fold(0.0, f64::max)
    }
}
