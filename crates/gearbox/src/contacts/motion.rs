//! States of the bodies that a contact or bearing joins, with or without derivatives.

use pinwheel_contact::{Complex, Dual, Scalar};
use pinwheel_mbs::{BodyState, Variable};

/// Position, direction and velocities of a body.
#[derive(Clone, Copy)]
pub(super) struct Motion<S = f64> {
    pub(super) place: Complex<S>,
    pub(super) velocity: Complex<S>,
    /// Rotation e^{i angle}.
    pub(super) turn: Complex<S>,
    pub(super) rate: S,
}

impl Motion {
    #[inline]
    pub(super) fn of(body: &BodyState) -> Self {
        Self {
            place: Complex::new(body.x, body.y),
            velocity: Complex::new(body.vx, body.vy),
            turn: Complex::unit(body.angle),
            rate: body.rate,
        }
    }
}

impl<S: Scalar> Motion<S> {
    /// Returns the motion of a body that the output carries; `angle` and `rate` are the output's.
    pub(super) fn carried(body: &BodyState, output: &BodyState, [angle, rate]: [S; 2]) -> Self {
        let turn = Complex::unit(angle - angle.like(output.angle));
        let place = Complex::new(body.x, body.y).like(angle) * turn;
        Self {
            place,
            velocity: place.turned().scale(rate),
            turn,
            rate,
        }
    }
}

/// Frame and motion of a disc.
#[derive(Clone, Copy)]
pub(super) struct WheelFrame<S = f64> {
    pub(super) centre: Complex<S>,
    /// e^{i theta}, disc frame to ground.
    pub(super) turn: Complex<S>,
    /// Velocity of the centre in the disc's directions.
    pub(super) velocity: Complex<S>,
    pub(super) rate: S,
}

impl<S: Scalar> WheelFrame<S> {
    pub(super) fn of(disc: &Motion<S>) -> Self {
        let Motion {
            place,
            velocity,
            turn,
            rate,
        } = *disc;
        Self {
            centre: place,
            turn,
            velocity: velocity * turn.conj(),
            rate,
        }
    }

    #[inline]
    pub(super) fn point(&self, place: Complex<S>) -> Complex<S> {
        (place - self.centre) * self.turn.conj()
    }
}

/// Returns angle, x, y and their rates, in this order, of a disc as variables.
pub(super) fn values(disc: &BodyState) -> [f64; 6] {
    [disc.angle, disc.x, disc.y, disc.rate, disc.vx, disc.vy]
}

/// Returns the motion of a disc from its [`values`].
pub(super) fn of_values<const N: usize>(
    [angle, x, y, rate, vx, vy]: [Dual<N>; 6],
) -> Motion<Dual<N>> {
    Motion {
        place: Complex::new(x, y),
        velocity: Complex::new(vx, vy),
        turn: Complex::unit(angle),
        rate,
    }
}

/// Returns a coordinate by its number; `None` for a function of time with this speed.
pub(super) fn position(number: Option<usize>, speed: f64) -> Variable {
    number.map_or(Variable::Time(speed), Variable::Position)
}

/// Returns the rate of a coordinate by its number; `None` for a function of time with this acceleration.
pub(super) fn rate(number: Option<usize>, acceleration: f64) -> Variable {
    number.map_or(Variable::Time(acceleration), Variable::Rate)
}

/// Returns the variables of a disc's [`values`]; a disc whose position is not free moves with the input.
pub(super) fn variables(
    coordinates: &pinwheel_mbs::Coordinates,
    number: usize,
    disc: &BodyState,
    input: &BodyState,
) -> [Variable; 6] {
    let (angle, x) = (coordinates.angle(number), coordinates.place(number));
    let (y, squared) = (x.map(|x| x + 1), input.rate * input.rate);
    [
        position(angle, disc.rate),
        position(x, disc.vx),
        position(y, disc.vy),
        rate(angle, 0.0),
        rate(x, -squared * (disc.x - input.x)),
        rate(y, -squared * (disc.y - input.y)),
    ]
}
