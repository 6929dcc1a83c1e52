//! Lagrange form with implicit friction.
//!
//! In a mechanism of centre-pinned bodies the friction of a stage follows from the free rates ([`crate::sliding`]). It is then
//! a known load, and both parts of the derivative follow from the saddle-point system:
//!
//! ```text
//! M i + D' mu = friction,      D i = 0        v = v* + a i
//! M e + D' mu = other loads,   D e = gamma(v)
//! ```

use nalgebra::Vector3;

use super::Lagrange;
use crate::Forces;
use crate::state::{Wrench, add_pair};

impl<F: Forces> Lagrange<F> {
    /// Solves one stage; `None` without a solution. See [`crate::OdeSystem::split_stage`].
    pub(super) fn split(
        &mut self,
        t: f64,
        a: f64,
        y: &mut [f64],
        e: &mut [f64],
        i: &mut [f64],
    ) -> Option<()> {
        let n = self.bodies.len();
        self.prepare(t, y);
        self.loads.fill(Wrench::default());
        let mut none = Vec::new();
        let listed = match &mut self.contacts {
            Some(contacts) => &mut contacts.stage.contacts,
            None => &mut none,
        };
        self.forces
            .apply_without_friction(t, &self.bodies, &mut self.loads, listed);
        if !none.is_empty() {
            return None;
        }
        self.factor_beside().ok()?;
        if let Some(contacts) = &mut self.contacts {
            let (free, floating) = (&contacts.free, &contacts.floating);
            let bodies = &self.bodies;
            self.rates.clear();
            self.rates.extend(free.iter().map(|&b| bodies[b].rate));
            let velocities = floating.iter().flat_map(|&b| [bodies[b].vx, bodies[b].vy]);
            self.rates.extend(velocities);
            self.guess.clear();
            self.guess.extend(free.iter().map(|&b| i[3 * (n + b) + 2]));
            let sliding = floating
                .iter()
                .flat_map(|&b| [3 * (n + b), 3 * (n + b) + 1]);
            self.guess.extend(sliding.map(|at| i[at]));
            let rates = &mut self.rates;
            if !contacts.solve(a, &self.guess, &self.bodies, &self.forces, rates) {
                return None;
            }
            self.friction.fill(Wrench::default());
            for (contact, normal, friction) in contacts.stage.contact_forces() {
                let [nx, ny] = contact.normal;
                let (pair, point) = (contact.bodies, contact.point);
                let slip = [friction * ny, -friction * nx];
                add_pair(&mut self.friction, &self.bodies, pair, point, slip);
                let push = [-normal * nx, -normal * ny];
                add_pair(&mut self.loads, &self.bodies, pair, point, push);
            }
        }
        self.saddle.constraints().fill(Vector3::zeros());
        self.saddle.set_loads(&self.friction);
        self.saddle.solve();
        self.projected.valid = false;
        for (k, i) in i[3 * n..].chunks_exact_mut(3).enumerate() {
            i.copy_from_slice(self.saddle.bodies()[k].as_slice());
            let body = &mut self.bodies[k];
            body.vx += a * i[0];
            body.vy += a * i[1];
            body.rate += a * i[2];
        }
        self.rest();
        self.set_gamma(t);
        self.saddle.set_loads(&self.loads);
        self.saddle.solve();
        for (k, e) in e[3 * n..].chunks_exact_mut(3).enumerate() {
            e.copy_from_slice(self.saddle.bodies()[k].as_slice());
        }
        i[..3 * n].fill(0.0);
        super::write(&self.bodies, y);
        e[..3 * n].copy_from_slice(&y[3 * n..]);
        Some(())
    }
}
