//! Balances of a gear whose discs float on elastic bearings.
//!
//! Unknowns are the output's angle and three coordinates of every disc; each body must be free of force and moment. With
//! clearance there are states that nothing holds, so no bracket and no cold start can be relied upon. A continuation can: it
//! begins at the balance of rigid eccentrics, displaces each disc by a small share s of the deflection of its bearing under the
//! force at that balance, and takes the bearing's offsets from s to all of themselves:
//!
//! ```text
//! offset of the bearing under F:   s (g + (F/K)^(1/p)),   s -> 1
//! ```
//! Newton's method balances every step, with differences where contacts have no derivatives. A light load is approached from the scene's largest, by parts of it:
//! near no load nothing but the last balance tells where a disc floats. Without a load discs rest at the middle of their
//! clearance.

mod descent;

use nalgebra::{DMatrix, DVector};
use pinwheel_mbs::{BodyState, Evaluation, Wrench};

use super::{ANGLE, Equilibrium, OF_A_WHEEL, Statics, next_root};
use crate::contacts::EccentricBearings;
use crate::{GearboxError, Layout, load_profile, scene::Detection};

/// Difference steps, and the first share s, in the depths and twists of contacts under the load.
const DIFFERENCE: f64 = 1e-4;
const FIRST: f64 = 0.2;
/// Growth of s from step to step, shrunk by its root where a step fails, and its least.
const GROWTH: f64 = 4.0;
const LEAST_GROWTH: f64 = 1.001;
/// Ratio of successive loads on the way to a light one, replaced by its root where a step fails. A load above this
/// share of the largest is not light.
const LIGHTER: f64 = 0.25;
/// Least share of the largest load that sizes follow.
const LEAST_SIZE: f64 = 1e-2;
/// Balances that are remembered.
const REMEMBERED: usize = 8;
/// Least step of the clearance, as a share of it.
const LEAST_LOOSER: f64 = 1e-4;
/// Steps at most of a root in a bracket.
const BISECTIONS: usize = 200;
/// Permitted residual of forces and moments, as a share of the load's.
const LEFT: f64 = 1e-9;
/// How much more of bearings' offsets a balance turns the output by at most than they would if all were across the eccentric.
const GIVEN_WAY: f64 = 4.0;
/// Roundings of a disc's place that may be left as a force of its bearing.
const ROUNDINGS: f64 = 4.0;
/// Why points may leave a disc without a balance.
const POINTS: &str = "contact.detection = \"points\": forces jump from point to point, and between two of them a disc on an \
                      elastic bearing has no balance; use detection = \"exact\"";

/// Scales of forces and places.
#[derive(Clone, Copy)]
struct Size {
    length: f64,
    angle: f64,
    force: f64,
    moment: f64,
}

impl Size {
    /// Size of an unknown.
    fn of_place(self, unknown: usize) -> f64 {
        match is_length(unknown) {
            true => self.length,
            false => self.angle,
        }
    }

    /// Size of the residual at an unknown.
    fn of_load(self, unknown: usize) -> f64 {
        match is_length(unknown) {
            true => self.force,
            false => self.moment,
        }
    }

    /// The derivatives with springs to the last iterate, as a share of a contact's stiffness.
    fn held(self, mut derivatives: DMatrix<f64>, share: f64) -> DMatrix<f64> {
        for k in 0..derivatives.nrows() {
            derivatives[(k, k)] -= share * (self.of_load(k) / self.of_place(k));
        }
        derivatives
    }

    /// The largest share of their sizes that values of all unknowns have.
    fn largest(values: &DVector<f64>, size: impl Fn(usize) -> f64) -> f64 {
        let shares = values.iter().enumerate().map(|(k, x)| x.abs() / size(k));
        shares.fold(0.0, f64::max)
    }
}

impl Statics<'_> {
    /// The bearings, which the rigid solution leaves out.
    ///
    /// # Errors
    /// No disc floats.
    fn bearings(&self) -> Result<EccentricBearings, GearboxError> {
        let none = || GearboxError::Geometry("no disc floats".to_owned());
        self.bearings.clone().ok_or_else(none)
    }

    fn size(&self, load: f64, bearings: &EccentricBearings) -> Size {
        let (scales, gear) = (self.gearbox.error_scales(), &self.gearbox.scene.gear);
        let least = self.gearbox.least_force_n();
        let moment = load.abs().max(least * gear.lever_m());
        let largest = load_profile::largest(&self.gearbox.scene.drive).max(moment);
        let share = (moment / largest).max(LEAST_SIZE);
        // Places are known to their rounding, and so are forces, however light the load.
        let moment = share * largest;
        let force = moment / gear.lever_m();
        let stiffest = bearings.law.slope_under(force);
        // Where bearings sit: of cranks on their circle, about which forces have moments as well.
        let circle = self
            .gearbox
            .scene
            .cranks
            .map(|cranks| cranks.circle_radius_m);
        let place = circle.unwrap_or(gear.eccentricity_m);
        let rounding = ROUNDINGS * f64::EPSILON * place * stiffest;
        Size {
            length: share * scales.length,
            angle: share * scales.angle,
            force: force.max(rounding / LEFT),
            moment: moment.max(circle.unwrap_or_default() * rounding / LEFT),
        }
    }

    /// Puts all bodies in place, with the velocities of the motion about which forces are taken.
    fn place_floating(&mut self, phi: f64, u: &[f64], velocities: Option<&[f64]>) {
        let wheels: Vec<f64> = u[1..].chunks(OF_A_WHEEL).map(|wheel| wheel[2]).collect();
        self.put(phi, &wheels, u[0]);
        for (i, body) in self.gearbox.layout.wheel_bodies().enumerate() {
            let at = 1 + OF_A_WHEEL * i;
            let (body, centre) = (&mut self.bodies[body], self.motion.centres[i][0]);
            (body.x, body.y) = (u[at], u[at + 1]);
            (body.vx, body.vy) = (centre[0], centre[1]);
        }
        let Some(v) = velocities else { return };
        self.bodies[Layout::OUTPUT].rate = v[0];
        for (k, body) in self.gearbox.layout.internal_bodies().enumerate() {
            self.bodies[body] = self.gearbox.geometry.internal_state(k, [u[0], v[0]]);
        }
        for (i, body) in self.gearbox.layout.wheel_bodies().enumerate() {
            let (at, body) = (1 + OF_A_WHEEL * i, &mut self.bodies[body]);
            (body.vx, body.vy, body.rate) = (v[at], v[at + 1], v[at + 2]);
        }
    }

    /// Forces and moments that are not in balance at `u`.
    fn left(
        &mut self,
        phi: f64,
        load: f64,
        bearings: &EccentricBearings,
        u: &[f64],
        velocities: Option<&[f64]>,
    ) -> DVector<f64> {
        self.begin();
        self.place_floating(phi, u, velocities);
        let on_output = self.add_contacts();
        bearings.add_loads(&self.bodies, &mut self.loads, None);
        let layout = self.gearbox.layout;
        let mut moments = vec![0.0; layout.wheels];
        let mut left = DVector::zeros(u.len());
        left[0] = self.summed(&mut moments) + on_output + load;
        let mass = self.gearbox.scene.mass.wheel.mass_kg;
        for (i, body) in layout.wheel_bodies().enumerate() {
            let (at, Wrench { fx, fy, .. }) = (1 + OF_A_WHEEL * i, self.loads[body]);
            let [ax, ay] = self.motion.centres[i][1];
            (left[at], left[at + 1]) = (fx - mass * ax, fy - mass * ay);
            left[at + 2] = moments[i];
        }
        left
    }

    /// Adds the contacts' loads on the discs; those on the output's pins too, unless they tell their moment, which is returned.
    fn add_contacts(&mut self) -> f64 {
        if !self.field.work_from_angles() {
            self.field.add_loads(&self.bodies, &mut self.loads);
            return 0.0;
        }
        self.moments_by_body.fill(0.0);
        let mut request = Evaluation {
            floating_alone: true,
            loads: Some(&mut self.loads),
            ..Evaluation::of_moments(&mut self.moments_by_body)
        };
        self.field.evaluate(&self.bodies, &mut request);
        self.moments_by_body[Layout::OUTPUT]
    }

    /// How what is left changes with the unknowns, from `here`.
    fn matrix(
        &mut self,
        phi: f64,
        load: f64,
        bearings: &EccentricBearings,
        (u, here): (&[f64], &DVector<f64>),
        size: Size,
    ) -> DMatrix<f64> {
        self.begin();
        self.place_floating(phi, u, None);
        self.floating_slopes.clear();
        if !self.field.have_derivatives() {
            return self.differences(phi, load, bearings, (u, here), size);
        }
        let (jacobian, coordinates) = (&mut self.floating_slopes, &self.coordinates[1]);
        let mut request = Evaluation::of_derivatives(jacobian, coordinates);
        self.field.evaluate(&self.bodies, &mut request);
        if let Some(derivatives) = &mut request.derivatives {
            bearings.add_jacobian(&self.bodies, derivatives);
        }
        let wheels = self.gearbox.layout.wheels;
        // Angles first, then places.
        let free = |unknown: usize| match unknown {
            0 => 0,
            k => {
                let (wheel, part) = ((k - 1) / OF_A_WHEEL, (k - 1) % OF_A_WHEEL);
                match is_length(k) {
                    true => 1 + wheels + 2 * wheel + part,
                    false => 1 + wheel,
                }
            }
        };
        let position = self.floating_slopes.position.as_ref();
        let entry = |i, j| position.map_or(0.0, |derivatives| derivatives.entry(free(i), free(j)));
        DMatrix::from_fn(u.len(), u.len(), entry)
    }

    /// Derivatives of the residual with respect to the unknowns by differences.
    fn differences(
        &mut self,
        phi: f64,
        load: f64,
        bearings: &EccentricBearings,
        (u, here): (&[f64], &DVector<f64>),
        size: Size,
    ) -> DMatrix<f64> {
        let n = u.len();
        let mut matrix = DMatrix::zeros(n, n);
        let mut moved = u.to_vec();
        for k in 0..n {
            let h = DIFFERENCE * size.of_place(k);
            moved[k] = u[k] + h;
            let there = self.left(phi, load, bearings, &moved, None);
            moved[k] = u[k];
            matrix.set_column(k, &((there - here) / h));
        }
        matrix
    }

    /// A balance near `u`; what is left there, or `None` where there is none before teeth jump.
    fn balance(
        &mut self,
        phi: f64,
        load: f64,
        bearings: &EccentricBearings,
        u: &mut Vec<f64>,
    ) -> Option<DVector<f64>> {
        let left = self.newton_on_bearings(phi, load, bearings, u)?;
        let gear = &self.gearbox.scene.gear;
        let force = load.abs() / (gear.lever_m() * gear.wheels as f64);
        let given_way = bearings.law.offset_under(force) / gear.lever_m();
        let turned = u[0] - self.gearbox.geometry.ideal_output_angle(phi);
        (turned.abs() <= self.brackets().1 + GIVEN_WAY * given_way).then_some(left)
    }

    /// Unknowns of bodies in place.
    fn unknowns(&self, bodies: &[BodyState], output: f64) -> Vec<f64> {
        let wheels = self.gearbox.layout.wheel_bodies().map(|body| bodies[body]);
        let wheels = wheels.flat_map(|wheel| [wheel.x, wheel.y, wheel.angle]);
        std::iter::once(output).chain(wheels).collect()
    }

    /// The balance at `u`, where so much is left.
    fn floating_equilibrium(&mut self, phi: f64, u: &[f64], left: &DVector<f64>) -> Equilibrium {
        self.place_floating(phi, u, None);
        let moments = left.iter().enumerate().filter(|(k, _)| !is_length(*k));
        Equilibrium {
            input: phi,
            wheels: u[1..].chunks(OF_A_WHEEL).map(|wheel| wheel[2]).collect(),
            output: u[0],
            bodies: self.bodies.clone(),
            residual: moments.map(|(_, x)| x.abs()).fold(0.0, f64::max),
        }
    }

    /// The balance of floating discs at the input angle `phi`.
    pub(super) fn solve_floating(
        &mut self,
        phi: f64,
        load: f64,
    ) -> Result<Equilibrium, GearboxError> {
        if load == 0.0 {
            return self.float_from_rigid(phi, load);
        }
        // The nearest of the last loads in the same direction: mostly the same one, at the pose before.
        let apart = |from: f64| (load / from).ln().abs();
        let near = (0..self.floated.len())
            .filter(|&k| self.floated[k].1 * load > 0.0)
            .min_by(|&a, &b| apart(self.floated[a].1).total_cmp(&apart(self.floated[b].1)));
        let known = near.map(|k| match self.floated[k].1 == load {
            true => self.floated.remove(k),
            false => self.floated[k].clone(),
        });
        let found = known.and_then(|(near, from)| self.float_towards(near, from, (phi, load)).ok());
        let found = match found {
            Some(found) => found,
            None => self
                .solve_cold(phi, load)
                .map_err(|error| self.why(error))?,
        };
        if self.floated.len() == REMEMBERED {
            self.floated.remove(0);
        }
        self.floated.push((found.clone(), load));
        Ok(found)
    }

    /// The error with its cause, where that is not the load.
    fn why(&self, error: GearboxError) -> GearboxError {
        match (self.gearbox.scene.contact.detection, error) {
            (Detection::Points, GearboxError::NoEquilibrium { .. }) => {
                GearboxError::Geometry(POINTS.to_owned())
            }
            (_, error) => error,
        }
    }

    /// The equilibrium of floating discs without a known one near by.
    fn solve_cold(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        let heavy = load_profile::largest(&self.gearbox.scene.drive).copysign(load);
        if load.abs() >= LIGHTER * heavy.abs() {
            return self.float_from_rigid(phi, load);
        }
        let here = self.float_from_rigid(phi, heavy)?;
        self.float_towards(here, heavy, (phi, load))
    }

    /// From a balance under the load `at`, in the same direction, to another input angle and load.
    fn float_towards(
        &mut self,
        mut here: Equilibrium,
        mut at: f64,
        (phi, load): (f64, f64),
    ) -> Result<Equilibrium, GearboxError> {
        let mut part = LIGHTER;
        while at != load || here.input != phi {
            let next = match load.abs() < at.abs() {
                true => load.signum() * (at * part).abs().max(load.abs()),
                false => load.signum() * (at / part).abs().min(load.abs()),
            };
            match self.continue_from(&here, phi, next) {
                Some(found) => (here, at) = (found, next),
                None => part = f64::min(next / at, at / next).sqrt(),
            }
            if part * LEAST_GROWTH > 1.0 {
                return Err(GearboxError::NoEquilibrium { load_n_m: load });
            }
        }
        Ok(here)
    }

    /// The equilibrium of floating discs by continuation from that of rigid eccentrics.
    fn float_from_rigid(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        let (rigid, bearings) = (self.solve_rigid(phi, load)?, self.bearings()?);
        let mut u = self.unknowns(&rigid.bodies, rigid.output);
        // Forces of the contacts alone: what the bearings will have to carry.
        let contacts = self.left(phi, load, &bearings, &u, None);
        let (eccentric_centres, forces) = self.carried(&rigid.bodies, contacts.as_slice());
        let most = forces.iter().flatten().map(|[x, y]| x.hypot(*y));
        let most = most.fold(0.0, f64::max);
        if most <= LEFT * self.size(load, &bearings).force {
            return Ok(self.floating_equilibrium(phi, &u, &contacts));
        }
        let whole = bearings.law.offset_under(most);
        let mut share = (FIRST * self.size(load, &bearings).length / whole).min(1.0);
        for (wheel, forces) in u[1..].chunks_mut(OF_A_WHEEL).zip(&forces) {
            for (&[sx, sy], &[fx, fy]) in eccentric_centres.iter().zip(forces) {
                let size = fx.hypot(fy);
                if size > 0.0 {
                    let offset = share * bearings.law.offset_under(size) / size;
                    let offset = offset / eccentric_centres.len() as f64;
                    wheel[0] += offset * fx;
                    wheel[1] += offset * fy;
                    let lever = (sx * sx + sy * sy).max(f64::MIN_POSITIVE);
                    wheel[2] += offset * (sx * fy - sy * fx) / lever;
                }
            }
        }
        let none = || GearboxError::NoEquilibrium { load_n_m: load };
        // The bearings of one disc do not all deflect along these forces: their clearance comes last.
        let tight = if self.gearbox.scene.cranks.is_some() {
            0.0
        } else {
            1.0
        };
        // A first step that fails is tried from nearer to the rigid gear.
        let mut before: Option<(f64, Vec<f64>)> = None;
        let mut growth = GROWTH;
        loop {
            let mut there = match &before {
                Some((last, at)) => self.stretched(phi, at, share / last),
                None => u.clone(),
            };
            let shared = bearings.share(share, tight * share);
            if let Some(left) = self.balance(phi, load, &shared, &mut there) {
                if share >= 1.0 {
                    let (whole, left) = match self.gearbox.scene.cranks {
                        Some(_) => self
                            .loosened(phi, load, &bearings, there)
                            .ok_or_else(none)?,
                        None => (there, left),
                    };
                    return Ok(self.floating_equilibrium(phi, &whole, &left));
                }
                before = Some((share, there));
            } else {
                growth = growth.sqrt();
                if growth < LEAST_GROWTH {
                    return Err(none());
                }
            }
            share = match &before {
                Some((last, _)) => (last * growth).min(1.0),
                None => {
                    u = self.stretched(phi, &u, 0.25);
                    0.25 * share
                }
            };
        }
    }

    /// From the balance on bearings without clearance to that with all of it: each step moves discs on by what their bearings
    /// give way more, along the offsets that they have.
    fn loosened(
        &mut self,
        phi: f64,
        load: f64,
        bearings: &EccentricBearings,
        mut u: Vec<f64>,
    ) -> Option<(Vec<f64>, DVector<f64>)> {
        let (mut share, mut step, mut left) = (0.0, 1.0, None);
        let layout = self.gearbox.layout;
        while share < 1.0 && step > LEAST_LOOSER {
            let next = f64::min(share + step, 1.0);
            let looser = bearings.share(1.0, next);
            self.place_floating(phi, &u, None);
            let mut there = u.clone();
            for (i, wheel) in there[1..].chunks_mut(OF_A_WHEEL).enumerate() {
                for (crank, seat) in layout.internal_bodies().enumerate() {
                    let [dx, dy] = bearings.of_crank(&self.bodies, i, crank).offset_m;
                    let seat = self.bodies[seat];
                    let further = (next - share) * bearings.clearance_m(i, crank)
                        / (dx.hypot(dy).max(f64::MIN_POSITIVE) * layout.internal_sleeves as f64);
                    wheel[0] += further * dx;
                    wheel[1] += further * dy;
                    let square = seat.x * seat.x + seat.y * seat.y;
                    wheel[2] += further * (seat.x * dy - seat.y * dx) / square;
                }
            }
            match self.balance(phi, load, &looser, &mut there) {
                found @ Some(_) => (share, u, step, left) = (next, there, 2.0 * step, found),
                None => step *= 0.5,
            }
        }
        (share >= 1.0).then_some((u, left?))
    }

    /// Where bearings sit from a disc's centre, m, and what each will have to carry of `contacts`, N: of cranks the least that
    /// holds force and moment, evenly.
    fn carried(
        &self,
        bodies: &[BodyState],
        contacts: &[f64],
    ) -> (Vec<[f64; 2]>, Vec<Vec<[f64; 2]>>) {
        let eccentric_centres: Vec<[f64; 2]> = match self.gearbox.scene.cranks {
            Some(_) => {
                let cranks = bodies[self.gearbox.layout.internal_bodies()].iter();
                cranks.map(|crank| [crank.x, crank.y]).collect()
            }
            None => vec![[0.0; 2]],
        };
        let polar: f64 = eccentric_centres.iter().map(|[x, y]| x * x + y * y).sum();
        let share = 1.0 / eccentric_centres.len() as f64;
        let of_wheel = |loads: &[f64]| {
            let turn = if polar > 0.0 { loads[2] / polar } else { 0.0 };
            let at =
                |&[x, y]: &[f64; 2]| [share * loads[0] - turn * y, share * loads[1] + turn * x];
            eccentric_centres.iter().map(at).collect()
        };
        let forces = contacts[1..].chunks(OF_A_WHEEL).map(of_wheel).collect();
        (eccentric_centres, forces)
    }

    /// The balance of an RV gear all of whose cranks' bearings are rigid: discs turn with the output, and one angle is free.
    pub(super) fn solve_on_cranks(
        &mut self,
        phi: f64,
        load: f64,
    ) -> Result<Equilibrium, GearboxError> {
        let geometry = &self.gearbox.geometry;
        let (rho, middle) = (geometry.teeth_ratio, geometry.ideal_output_angle(phi));
        let homes: Vec<f64> = (0..self.gearbox.layout.wheels)
            .map(|i| geometry.ideal_wheel_angle(i, 0.0))
            .collect();
        let half = self.brackets().1;
        let mut moment = |psi: f64| {
            let wheels: Vec<f64> = homes.iter().map(|home| home + psi).collect();
            self.place(phi, &wheels, psi);
            self.field.add_loads(&self.bodies, &mut self.loads);
            let of = |body: usize| {
                let (BodyState { x, y, .. }, load) = (self.bodies[body], self.loads[body]);
                load.moment + (1.0 + rho) * (x * load.fy - y * load.fx)
            };
            load + self.gearbox.layout.wheel_bodies().map(of).sum::<f64>()
        };
        let (mut low, mut high) = (middle - half, middle + half);
        if moment(low) < 0.0 || moment(high) > 0.0 {
            return Err(GearboxError::NoEquilibrium { load_n_m: load });
        }
        let (mut psi, mut last) = (middle, f64::INFINITY);
        for _ in 0..BISECTIONS {
            let here = moment(psi);
            if here == 0.0 || last < ANGLE {
                break;
            }
            let slope =
                (moment(psi + DIFFERENCE * ANGLE.sqrt()) - here) / (DIFFERENCE * ANGLE.sqrt());
            let next = next_root(psi, here, slope, (&mut low, &mut high), last);
            (last, psi) = ((next - psi).abs(), next);
        }
        moment(psi);
        Ok(Equilibrium {
            input: phi,
            wheels: homes.iter().map(|home| home + psi).collect(),
            output: psi,
            bodies: self.bodies.clone(),
            residual: 0.0,
        })
    }

    /// Unknowns with the discs' offsets from their eccentrics times `factor`, and of cranks their turns against the
    /// output.
    fn stretched(&mut self, phi: f64, u: &[f64], factor: f64) -> Vec<f64> {
        let mut there = u.to_vec();
        for i in 0..self.gearbox.layout.wheels {
            let geometry = &self.gearbox.geometry;
            let own = match self.gearbox.scene.cranks {
                Some(_) => geometry.ideal_wheel_angle(i, 0.0) + u[0],
                None => u[OF_A_WHEEL * (i + 1)],
            };
            let eccentric = geometry.eccentric_angle(phi, u[0]);
            let home = geometry.wheel_state(i, [eccentric, 0.0], [own, 0.0]);
            let at = 1 + OF_A_WHEEL * i;
            for (k, home) in [home.x, home.y, home.angle].into_iter().enumerate() {
                there[at + k] = home + factor * (u[at + k] - home);
            }
        }
        there
    }

    /// The balance near another one; `None`: it leads nowhere.
    pub(super) fn continue_from(
        &mut self,
        near: &Equilibrium,
        phi: f64,
        load: f64,
    ) -> Option<Equilibrium> {
        let bearings = self.bearings().ok()?;
        let mut u = self.unknowns(&near.bodies, near.output);
        let geometry = &self.gearbox.geometry;
        u[0] += geometry.ideal_output_angle(phi) - geometry.ideal_output_angle(near.input);
        let (s, c) = geometry.ideal_eccentric_angle(phi - near.input).sin_cos();
        for (i, wheel) in u[1..].chunks_mut(OF_A_WHEEL).enumerate() {
            let [x, y] = [wheel[0], wheel[1]];
            (wheel[0], wheel[1]) = (c * x - s * y, s * x + c * y);
            wheel[2] +=
                geometry.ideal_wheel_angle(i, phi) - geometry.ideal_wheel_angle(i, near.input);
        }
        let left = self.balance(phi, load, &bearings, &mut u)?;
        Some(self.floating_equilibrium(phi, &u, &left))
    }

    /// As [`Statics::compliance`], of discs that float. To first order in the rates the shape of the deflection is that at rest.
    pub(super) fn floating_compliance(&mut self, at: &Equilibrium) -> Option<[f64; 2]> {
        let bearings = self.bearings().ok()?;
        let load = self.gearbox.scene.drive.output_torque_n_m;
        let u = self.unknowns(&at.bodies, at.output);
        let (size, phi) = (self.size(load, &bearings), at.input);
        let here = self.left(phi, 0.0, &bearings, &u, None);
        let matrix = self.matrix(phi, 0.0, &bearings, (&u, &here), size);
        let mut unit = DVector::zeros(u.len());
        unit[0] = -1.0;
        let shape = matrix.lu().solve(&unit)?;
        let stiffness = 1.0 / shape[0];
        let shape = shape * stiffness;
        let rate = self.gearbox.error_scales().frequency * DIFFERENCE * size.angle;
        let velocities: Vec<f64> = shape.iter().map(|x| rate * x).collect();
        let moving = self.left(phi, 0.0, &bearings, &u, Some(&velocities));
        Some([stiffness, -shape.dot(&(moving - here)) / rate])
    }
}

/// True if an unknown is a place of a disc, and no angle.
fn is_length(unknown: usize) -> bool {
    unknown > 0 && !unknown.is_multiple_of(OF_A_WHEEL)
}
