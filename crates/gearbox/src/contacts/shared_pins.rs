//! Output pins as beams that all discs bend at once.
//!
//! A pin without mass follows the forces at rest, F_v of disc v on the pin against the normal n_v. At disc w it is displaced by
//!
//! ```text
//! s_w = -sum_v a_wv F_v n_v = b_w - a_ww F_w n_w
//! ```
//! The disc's own part is a pin of the stiffness 1/a_ww in series with the contact ([`PinLaw`]), with its damping. The part b_w of the
//! other discs moves the pin in the hole. All forces on a pin follow from each other: Newton steps, and where one gains nothing a
//! sweep from disc to disc, each of which lowers the energy.

use nalgebra::{SMatrix, SVector};
use pinwheel_contact::{Complex, Dual, NormalLaw as _, PinLaw};
use pinwheel_mbs::{BodyState, Derivatives, Variable};
use pinwheel_scene::structure::MOST_DISCS;

use super::detection::Touch;
use super::motion::{Motion, WheelFrame};
use crate::Layout;
use crate::scene::Scene;

/// Largest number of steps, and the error of forces at which they end, relative to the largest. Rounding of the places may exceed
/// it, and then ends them.
const STEPS: usize = 200;
const SETTLED: f64 = 1e-13;

/// Number of variables of a pair, and the numbers of the disc's x and y among them.
const VARIABLES: usize = 9;
const PLACE: [usize; 2] = [1, 2];
/// Largest number of components of the forces on one pin.
const BOTH: usize = 2 * MOST_DISCS;

/// Touching pair of a disc and a shared pin, with the derivatives of its loads.
pub(super) struct OnShared {
    pub(super) wheel: usize,
    pub(super) pin: usize,
    pub(super) variables: [Variable; VARIABLES],
    /// Loads with their rows.
    pub(super) rows: [(Option<usize>, Dual<VARIABLES>); 5],
    /// Force on the pin at rest, ground frame.
    pub(super) at_rest: [Dual<VARIABLES>; 2],
}

/// Pins of a gear, and their displacements in the last states.
pub(super) struct SharedPins {
    layout: Layout,
    /// a_wv, m/N.
    influence: Vec<Vec<f64>>,
    frames: Vec<WheelFrame>,
    /// By disc, then pin.
    bent: Vec<Bent>,
}

/// Effect of the other discs on a pin at a disc.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bent {
    /// Displacement b, ground frame, m.
    pub(super) moved: Complex,
    /// Half of its work with the disc's own force, J.
    pub(super) shared_j: f64,
}

/// Forces of the discs on one pin, N, and their normals.
#[derive(Default)]
struct Pressed {
    forces: SVector<f64, MOST_DISCS>,
    normals: [Complex; MOST_DISCS],
}

impl SharedPins {
    /// Returns the pins of a scene; `None` where discs do not share them.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let layout = Layout::of(&scene.gear);
        let influence = scene.pin_influence_m_n()?;
        Some(Self {
            bent: vec![Bent::default(); influence.len() * layout.internal_sleeves],
            frames: Vec::with_capacity(influence.len()),
            influence,
            layout,
        })
    }

    /// Returns what the other discs do to a pin at a disc.
    pub(super) fn bent(&self, wheel: usize, pin: usize) -> Bent {
        self.bent[wheel * self.layout.internal_sleeves + pin]
    }

    /// Returns the stiffness of a pin at a disc against that disc's force, N/m.
    pub(super) fn stiffness_n_m(&self, wheel: usize) -> f64 {
        self.influence[wheel][wheel].recip()
    }

    /// Bends the pins; `touch` is that of a disc with a pin at a place in the disc's frame, with or without contact.
    pub(super) fn bend(
        &mut self,
        law: &PinLaw,
        bodies: &[BodyState],
        touch: impl Fn(usize, usize, Complex) -> Touch,
    ) {
        let discs = bodies[self.layout.wheel_bodies()].iter();
        self.frames.clear();
        self.frames
            .extend(discs.map(|disc| WheelFrame::of(&Motion::of(disc))));
        for (pin, body) in self.layout.internal_bodies().enumerate() {
            let centre = Complex::new(bodies[body].x, bodies[body].y);
            let touch = |wheel: usize, moved: Complex| {
                let frame = &self.frames[wheel];
                let touch = touch(wheel, pin, frame.point(centre + moved));
                (
                    touch.penetration,
                    touch.stiffness,
                    touch.normal * frame.turn,
                )
            };
            let pressed = self.pressed(law, f64::EPSILON * centre.norm(), touch);
            for wheel in 0..self.influence.len() {
                let moved = self.moved(wheel, &pressed);
                let work = -pressed.forces[wheel] * pressed.normals[wheel].dot(moved);
                self.bent[wheel * self.layout.internal_sleeves + pin] = Bent {
                    moved,
                    shared_j: 0.5 * work,
                };
            }
        }
    }

    /// Adds the derivatives of the pairs' loads by the displacements of their pins. With f_v the force of disc v on a pin:
    ///
    /// ```text
    /// db_w = sum_v!=w a_wv (df_v - f_v,x db_v),    loads,b = -loads,x       x the disc's place
    /// ```
    pub(super) fn add_bending(&self, pairs: &[OnShared], derivatives: &mut Derivatives<'_>) {
        let by_others = |one: &OnShared, other: &OnShared, axis: usize, k: usize| match one.wheel {
            same if same == other.wheel => 0.0,
            wheel => self.influence[wheel][other.wheel] * other.at_rest[axis].by[k],
        };
        for pin in 0..self.layout.internal_sleeves {
            let on: Vec<_> = pairs.iter().filter(|pair| pair.pin == pin).collect();
            let column = |other: &OnShared, k: usize| {
                SVector::<f64, BOTH>::from_fn(|row, _| {
                    on.get(row / 2)
                        .map_or(0.0, |one| by_others(one, other, row % 2, k))
                })
            };
            let mut matrix = SMatrix::<f64, BOTH, BOTH>::identity();
            for (j, pair) in on.iter().enumerate() {
                for (axis, k) in PLACE.into_iter().enumerate() {
                    let mut own = matrix.column_mut(2 * j + axis);
                    own += column(pair, k);
                }
            }
            let Some(inverse) = matrix.try_inverse().filter(|_| on.len() > 1) else {
                continue;
            };
            for (pair, k) in on
                .iter()
                .flat_map(|pair| (0..VARIABLES).map(move |k| (pair, k)))
            {
                let moved = inverse * column(pair, k);
                for (j, one) in on.iter().enumerate() {
                    for (row, load) in &one.rows {
                        let [x, y] = PLACE.map(|k| load.by[k]);
                        let change = -(x * moved[2 * j] + y * moved[2 * j + 1]);
                        derivatives.add(*row, &[pair.variables[k]], &[change]);
                    }
                }
            }
        }
    }

    /// Returns the displacement of a pin at a disc by the forces of the others, m.
    fn moved(&self, wheel: usize, pressed: &Pressed) -> Complex {
        let row = self.influence[wheel].iter().enumerate();
        row.filter(|(other, _)| *other != wheel)
            .map(|(other, a)| pressed.normals[other].scale(-a * pressed.forces[other]))
            .fold(Complex::default(), |sum, part| sum + part)
    }

    /// Solves the forces on one pin; `touch` is depth, K and normal at a disc, with the pin displaced; `rounding_m` is the
    /// depth's error.
    fn pressed(
        &self,
        law: &PinLaw,
        rounding_m: f64,
        touch: impl Fn(usize, Complex) -> (f64, f64, Complex),
    ) -> Pressed {
        let discs = self.influence.len();
        let mut pressed = Pressed::default();
        // Force of a disc under those of the others, and its slope by the depth; its normal is kept.
        let follow = |wheel: usize, pressed: &mut Pressed| {
            let (depth, stiffness, normal) = touch(wheel, self.moved(wheel, pressed));
            pressed.normals[wheel] = normal;
            if depth <= 0.0 {
                return [0.0; 2];
            }
            let pin = self.stiffness_n_m(wheel);
            let [_, force, _] = law.on(Some(pin)).observed(stiffness, depth, 0.0);
            let contact = law.law.tangent(stiffness, depth - force / pin);
            [force, contact * pin / (contact + pin)]
        };
        let mut before = f64::INFINITY;
        for _ in 0..STEPS {
            let (mut left, mut slopes) = (pressed.forces, [0.0; MOST_DISCS]);
            let mut largest = left.amax();
            for (wheel, slope) in slopes.iter_mut().enumerate().take(discs) {
                let force;
                [force, *slope] = follow(wheel, &mut pressed);
                left[wheel] -= force;
                largest = largest.max(force);
            }
            let error = left.amax();
            let stiffest = slopes.into_iter().fold(0.0, f64::max);
            if error <= (SETTLED * largest).max(stiffest * rounding_m) {
                break;
            }
            let matrix = SMatrix::<f64, MOST_DISCS, MOST_DISCS>::from_fn(|one, other| {
                if one == other || one >= discs || other >= discs {
                    return f64::from(u8::from(one == other));
                }
                let along = pressed.normals[one].dot(pressed.normals[other]);
                slopes[one] * self.influence[one][other] * along
            });
            match matrix.lu().solve(&left) {
                Some(step) if error < before => {
                    pressed.forces = (pressed.forces - step).map(|force| force.max(0.0));
                    before = error;
                }
                _ => {
                    for wheel in 0..discs {
                        pressed.forces[wheel] = follow(wheel, &mut pressed)[0];
                    }
                    before = f64::INFINITY;
                }
            }
        }
        pressed
    }
}
