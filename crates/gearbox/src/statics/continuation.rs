//! Balances of a gear whose discs float on elastic bearings, by continuation.
//!
//! Discs in clearance have poses at which no force restores them, so neither brackets nor a start without a known balance are
//! reliable. The continuation begins at the balance of rigid bearings. It displaces each disc by a small share s of the
//! deflection of its bearing under the force at that balance, and raises s to 1:
//!
//! ```text
//! offset of the bearing under F:   s (g + (F/K)^(1/p)),   s -> 1
//! ```
//! Newton's method solves the balance at every s. A light load is approached from the scene's largest in steps of the load:
//! near no load only the previous balance determines where a disc floats. Without a load discs rest at the middle of their
//! clearance.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::problem::{Balanced, LEFT, OF_A_DISC, Problem};
use super::{Equilibrium, Statics};
use crate::{GearboxError, scene::Detection};

/// First share s, relative to the depths of contacts under the load.
const FIRST: f64 = 0.2;
/// Growth factor of s from step to step, replaced by its square root where a step fails, and the least factor.
const GROWTH: f64 = 4.0;
const LEAST_GROWTH: f64 = 1.001;
/// Ratio of successive loads on the way to a light one, replaced by its square root where a step fails. A load above this share
/// of the largest is not light.
const LIGHTER: f64 = 0.25;
/// Number of stored balances for starts.
const REMEMBERED: usize = 8;
/// Least step of the clearance, relative to the full clearance.
const LEAST_LOOSER: f64 = 1e-4;
/// Distances of input angles from which a lost balance is sought, and the least step from there, as shares of a pin's passage.
const BESIDE: [f64; 5] = [0.2, 0.05, 1e-2, 1e-3, 1e-6];
const LEAST_BESIDE: f64 = 1e-7;
/// Explanation for a missing balance with contacts at discrete points.
const POINTS: &str = "contact.detection = \"points\": forces jump from point to point, and between two of them a disc on an \
                      elastic bearing has no balance; use detection = \"exact\"";

/// Positions of a disc's bearings relative to its centre, m.
type Seats = Vec<[f64; 2]>;
/// Forces on the bearings of every disc, N.
type Forces = Vec<Vec<[f64; 2]>>;

impl Statics<'_> {
    /// Solves the balance of floating discs at the input angle `phi`.
    pub(super) fn solve_floating(
        &mut self,
        phi: f64,
        load: f64,
    ) -> Result<Equilibrium, GearboxError> {
        if load == 0.0 {
            return self.continue_from_rigid(phi, load);
        }
        // Nearest of the last loads in the same direction: mostly the same load, at the previous pose.
        let apart = |from: f64| (load / from).ln().abs();
        let near = (0..self.floated.len())
            .filter(|&k| self.floated[k].1 * load > 0.0)
            .min_by(|&a, &b| apart(self.floated[a].1).total_cmp(&apart(self.floated[b].1)));
        let known = near.map(|k| match self.floated[k].1 == load {
            true => self.floated.remove(k),
            false => self.floated[k].clone(),
        });
        let balance =
            known.and_then(|(near, from)| self.continue_towards(near, from, (phi, load)).ok());
        let balance = match balance {
            Some(balance) => balance,
            None => match self.solve_cold(phi, load) {
                Ok(balance) => balance,
                Err(error) => {
                    let balance = self.solve_from_beside(phi, load);
                    balance.ok_or_else(|| self.explained(error))?
                }
            },
        };
        if self.floated.len() == REMEMBERED {
            self.floated.remove(0);
        }
        self.floated.push((balance.clone(), load));
        Ok(balance)
    }

    /// Solves the balance from those of input angles beside it. Under light loads contacts open and close on the way from a heavy
    /// load, and the way is lost in a few poses of a hundred thousand.
    fn solve_from_beside(&mut self, phi: f64, load: f64) -> Option<Equilibrium> {
        let pins = self.gearbox.scene.gear.external_sleeves as f64;
        let mesh = TAU / pins / self.gearbox.scene.eccentric_per_input().abs();
        BESIDE
            .iter()
            .flat_map(|share| [-share, *share])
            .find_map(|share| {
                let mut here = self.solve_cold(phi + share * mesh, load).ok()?;
                let mut step = phi - here.input;
                while here.input != phi {
                    let left = phi - here.input;
                    let next = if step.abs() < left.abs() {
                        here.input + step
                    } else {
                        phi
                    };
                    match self.continue_from(&here, next, load) {
                        Some(balance) => here = balance,
                        None if step.abs() > LEAST_BESIDE * mesh => step *= 0.5,
                        None => return None,
                    }
                }
                Some(here)
            })
    }

    /// Returns the error with its cause, where that is not the load.
    fn explained(&self, error: GearboxError) -> GearboxError {
        match (self.gearbox.scene.contact.detection, error) {
            (Detection::Points, GearboxError::NoEquilibrium { .. } | GearboxError::Lost { .. }) => {
                GearboxError::Geometry(POINTS.to_owned())
            }
            (_, error) => error,
        }
    }

    /// Solves the equilibrium of floating discs without a known nearby balance.
    fn solve_cold(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        let heavy = self.largest_n_m.copysign(load);
        if load.abs() >= LIGHTER * heavy.abs() {
            return self.continue_from_rigid(phi, load);
        }
        let here = self.continue_from_rigid(phi, heavy)?;
        self.continue_towards(here, heavy, (phi, load))
    }

    /// Continues from a balance under the load `at`, in the same direction, to another input angle and load.
    fn continue_towards(
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
                Some(balance) => (here, at) = (balance, next),
                None => part = f64::min(next / at, at / next).sqrt(),
            }
            if part * LEAST_GROWTH > 1.0 {
                return Err(GearboxError::Lost {
                    load_n_m: load,
                    from_n_m: at,
                });
            }
        }
        Ok(here)
    }

    /// Solves the equilibrium of floating discs by continuation from that of rigid bearings.
    fn continue_from_rigid(&mut self, phi: f64, load: f64) -> Result<Equilibrium, GearboxError> {
        let rigid = self.solve_rigid(phi, load)?;
        let full = self.problem(phi, load, &self.carrier);
        let mut u = full.unknowns(&rigid.bodies, self.gearbox.layout);
        // Forces of the contacts alone, which the bearings will carry.
        let contacts = self.residual(&full, &u);
        let (seats, forces) = self.carried(&rigid, contacts.as_slice());
        let most = forces.iter().flatten().map(|[x, y]| x.hypot(*y));
        let most = most.fold(0.0, f64::max);
        if most <= LEFT * full.size.force {
            return Ok(self.equilibrium(&full, &u, (contacts, None)));
        }
        let carrier = self.carrier.clone();
        let mut share = (FIRST * full.size.length / carrier.offset_under(most)).min(1.0);
        for (disc, forces) in u[1..].chunks_mut(OF_A_DISC).zip(&forces) {
            for (&seat, &[fx, fy]) in seats.iter().zip(forces) {
                let size = fx.hypot(fy);
                if size > 0.0 {
                    let offset = share * carrier.offset_under(size) / size;
                    displace(disc, seat, [fx, fy], offset / seats.len() as f64);
                }
            }
        }
        let none = || GearboxError::NoEquilibrium { load_n_m: load };
        // The bearings of one disc do not all deflect along these forces: their clearance comes last.
        let tight = if carrier.cranks().is_some() { 0.0 } else { 1.0 };
        // After a failed first step, a smaller one nearer to the rigid gear is tried.
        let mut before: Option<(f64, Vec<f64>)> = None;
        let mut growth = GROWTH;
        loop {
            let mut there = match &before {
                Some((last, at)) => self.stretched(phi, at, share / last),
                None => u.clone(),
            };
            let shared = Arc::new(carrier.share(share, tight * share));
            let shared = self.problem(phi, load, &shared);
            if let Some(balanced) = self.newton(&shared, &mut there, None) {
                if share >= 1.0 {
                    let (u, balanced) = match carrier.cranks() {
                        Some(_) => self.loosened(&full, there).ok_or_else(none)?,
                        None => (there, balanced),
                    };
                    return Ok(self.equilibrium(&full, &u, balanced));
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

    /// Continues from the balance on bearings without clearance to that with full clearance. Each step moves discs by the
    /// additional clearance of their bearings, along their present offsets.
    fn loosened(&mut self, full: &Problem, mut u: Vec<f64>) -> Option<(Vec<f64>, Balanced)> {
        let (mut share, mut step, mut left) = (0.0, 1.0, None);
        let carrier = self.carrier.clone();
        let cranks = carrier.cranks()?;
        let layout = self.gearbox.layout;
        while share < 1.0 && step > LEAST_LOOSER {
            let next = f64::min(share + step, 1.0);
            self.place(full, &u);
            let mut there = u.clone();
            for (i, disc) in there[1..].chunks_mut(OF_A_DISC).enumerate() {
                for (k, body) in layout.internal_bodies().enumerate() {
                    let offset = cranks.bearing(&self.bodies, i, k).0.offset_m;
                    let seat = [self.bodies[body].x, self.bodies[body].y];
                    let size = offset[0].hypot(offset[1]).max(f64::MIN_POSITIVE);
                    let further = (next - share) * cranks.law(i, k).clearance_m / size;
                    displace(disc, seat, offset, further / layout.internal_sleeves as f64);
                }
            }
            let looser = Arc::new(carrier.share(1.0, next));
            let looser = self.problem(full.phi, full.load, &looser);
            match self.newton(&looser, &mut there, None) {
                root @ Some(_) => (share, u, step, left) = (next, there, 2.0 * step, root),
                None => step *= 0.5,
            }
        }
        (share >= 1.0).then_some((u, left?))
    }

    /// Returns the positions of bearings relative to a disc's centre, and the share of `contacts` that each will carry. On
    /// cranks these are the least forces that balance force and moment, evenly spread.
    fn carried(&self, rigid: &Equilibrium, contacts: &[f64]) -> (Seats, Forces) {
        let seats: Seats = match self.carrier.cranks() {
            Some(_) => {
                let cranks = rigid.bodies[self.gearbox.layout.internal_bodies()].iter();
                cranks.map(|crank| [crank.x, crank.y]).collect()
            }
            None => vec![[0.0; 2]],
        };
        let polar: f64 = seats.iter().map(|[x, y]| x * x + y * y).sum();
        let share = 1.0 / seats.len() as f64;
        let of_disc = |loads: &[f64]| {
            let turn = if polar > 0.0 { loads[2] / polar } else { 0.0 };
            let at =
                |&[x, y]: &[f64; 2]| [share * loads[0] - turn * y, share * loads[1] + turn * x];
            seats.iter().map(at).collect()
        };
        let forces = contacts[1..].chunks(OF_A_DISC).map(of_disc).collect();
        (seats, forces)
    }

    /// Returns the unknowns with the discs' offsets from their eccentrics multiplied by `factor`; with cranks, also the discs'
    /// turns against the output.
    fn stretched(&self, phi: f64, u: &[f64], factor: f64) -> Vec<f64> {
        let geometry = &self.gearbox.geometry;
        let eccentric = geometry.eccentric_angle(phi, u[0]);
        let mut there = u.to_vec();
        for (i, disc) in there[1..].chunks_mut(OF_A_DISC).enumerate() {
            let own = match self.carrier.cranks() {
                Some(_) => geometry.ideal_wheel_angle(i, 0.0) + u[0],
                None => disc[2],
            };
            let home = geometry.wheel_state(i, [eccentric, 0.0], [own, 0.0]);
            for (at, home) in disc.iter_mut().zip([home.x, home.y, home.angle]) {
                *at = home + factor * (*at - home);
            }
        }
        there
    }
}

/// Moves a disc by `by` times a direction, and turns it by the motion of a seat beside its centre.
fn displace(disc: &mut [f64], [sx, sy]: [f64; 2], [x, y]: [f64; 2], by: f64) {
    disc[0] += by * x;
    disc[1] += by * y;
    disc[2] += by * (sx * y - sy * x) / (sx * sx + sy * sy).max(f64::MIN_POSITIVE);
}
