//! Derivatives of the loads of an RV reducer's cranks with respect to all free coordinates, and to time as the input turns.
//!
//! With s the deflection of a crank's support and mesh, and r the unbalanced force there at rest:
//!
//! ```text
//! dF/dq = F_q + F_s ds/dq,    r(q, s) = 0,    ds/dq = -r_s^-1 r_q
//! ```

use arrayvec::ArrayVec;
use pinwheel_contact::{Complex, Dual};
use pinwheel_mbs::{BodyState, Derivatives, Variable};
use pinwheel_scene::bearings::BearingLaw;

use super::{CrankSet, Deflection, OfCrank, WHEELS, pressed};
use crate::Layout;
use crate::contacts::motion::{self, Motion, of_values};

/// Variables of a bearing: six of the disc, two of the output, the input's angle, and the crank's deflection.
const VARIABLES: usize = 12;
/// Index of the first deflection among the variables.
const GIVEN: usize = 9;

/// Bearing with its derivatives.
struct Joint {
    variables: [Variable; GIVEN],
    /// Forces and moment on the disc and moment on the output, with their rows.
    rows: [(Option<usize>, Dual<VARIABLES>); 4],
    /// Contribution of the bearing to the balance of the crank at rest.
    balance: [Dual<VARIABLES>; 3],
    across: Complex,
}

impl Joint {
    /// Returns the derivatives of the balance with respect to a variable.
    fn balance_by(&self, k: usize) -> Deflection {
        [0, 1, 2].map(|row| self.balance[row].by[k])
    }
}

impl CrankSet {
    /// Adds the derivatives of [`add_loads`](Self::add_loads).
    pub(crate) fn add_jacobian(&self, bodies: &[BodyState], derivatives: &mut Derivatives<'_>) {
        let mut bearings = OfCrank::new();
        for crank in 0..self.count() {
            let offset = self.crank(bodies, crank, &mut bearings);
            // Filled in place, because its capacity is for the largest number of discs.
            let mut joints = ArrayVec::<Joint, WHEELS>::new();
            for wheel in 0..bearings.len() {
                let (law, at) = (self.law(wheel, crank), [wheel, crank]);
                joints.push(self.joint(&law, bodies, at, offset, derivatives));
            }
            for joint in &joints {
                for (row, load) in &joint.rows {
                    derivatives.add(*row, &joint.variables, &load.by);
                }
            }
            if self.support.is_some() || self.mesh.is_some() {
                self.add_deflection(&joints, derivatives);
            }
        }
    }

    /// Adds the derivatives by the deflection of the crank of these bearings.
    fn add_deflection(&self, joints: &[Joint], derivatives: &mut Derivatives<'_>) {
        let mut springs = self.springs();
        for joint in joints {
            let [x, y, _] = joint.balance;
            let stiffness = [x.by[GIVEN], x.by[GIVEN + 1], y.by[GIVEN + 1]];
            springs.add(stiffness.map(|k| -k), joint.across);
        }
        for (moved, k) in joints
            .iter()
            .flat_map(|joint| (0..GIVEN).map(move |k| (joint, k)))
        {
            let force = moved.balance_by(k);
            if force == [0.0; 3] {
                continue;
            }
            let (springs, force) = self.constrained(springs, force);
            let further = springs.solve(force);
            for (row, load) in joints.iter().flat_map(|joint| &joint.rows) {
                let by = &load.by[GIVEN..];
                let change: f64 = by.iter().zip(further).map(|(by, s)| by * s).sum();
                derivatives.add(*row, &[moved.variables[k]], &[change]);
            }
        }
    }

    /// Returns the bearing of a disc on a crank with its law, with derivatives.
    fn joint(
        &self,
        law: &BearingLaw,
        bodies: &[BodyState],
        [wheel, crank]: [usize; 2],
        offset: Deflection,
        derivatives: &Derivatives<'_>,
    ) -> Joint {
        let body = self.layout.wheel_bodies().start + wheel;
        let [input, output, disc] = [Layout::INPUT, Layout::OUTPUT, body].map(|k| &bodies[k]);
        let [angle, x, y, rate, vx, vy] = motion::values(disc);
        let [
            angle,
            x,
            y,
            rate,
            vx,
            vy,
            psi,
            psi_rate,
            phi,
            sx,
            sy,
            turned,
        ] = Dual::variables([
            angle,
            x,
            y,
            rate,
            vx,
            vy,
            output.angle,
            output.rate,
            input.angle,
            offset[0],
            offset[1],
            offset[2],
        ]);
        let seat = &bodies[self.layout.internal_bodies().start + crank];
        let Motion {
            place, velocity, ..
        } = Motion::carried(seat, output, [psi, psi_rate]);
        let rates = [psi_rate, Dual::constant(input.rate)];
        let shaft = Motion {
            place,
            velocity,
            ..self.shaft([psi, phi], rates, crank)
        };
        let disc_motion = of_values([angle, x, y, rate, vx, vy]);
        let bearing = self
            .unloaded(wheel, crank, &disc_motion, &shaft)
            .loaded(law, [sx, sy, turned]);
        let at_rest = pressed(law, bearing.load.offset_m);
        let [on_disc, on_crank] = bearing.moments();
        let on_output =
            place.cross(bearing.on_crank()) + Dual::constant(1.0 + self.teeth_ratio) * on_crank;
        let coordinates = derivatives.coordinates;
        let (place, carrier) = (coordinates.place(body), coordinates.angle(Layout::OUTPUT));
        let [fx, fy] = bearing.load.on_wheel;
        let [angle, x, y, rate, vx, vy] = motion::variables(coordinates, body, disc, input);
        Joint {
            variables: [
                angle,
                x,
                y,
                rate,
                vx,
                vy,
                motion::position(carrier, output.rate),
                motion::rate(carrier, 0.0),
                Variable::Time(input.rate),
            ],
            rows: [
                (place, fx),
                (place.map(|x| x + 1), fy),
                (coordinates.angle(body), on_disc),
                (carrier, on_output),
            ],
            balance: [at_rest.re, at_rest.im, bearing.across.dot(at_rest)],
            across: Complex::new(bearing.across.re.value, bearing.across.im.value),
        }
    }
}
