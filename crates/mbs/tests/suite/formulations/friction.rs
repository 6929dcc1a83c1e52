//! Implicit friction in both formulations.

use super::bounds::holds;
use super::{HUB, Weight, carousel, weight};
use pinwheel_mbs::sliding::Contact;
use pinwheel_mbs::{
    BodyState, Forces, Formulation, Lagrange, Mechanism, OdeSystem, Reduced, Stabilisation, Wrench,
};

/// Weight, and three rubbing pairs: carried on carried, carried on its carrier, and pinned on carried. Their normal forces grow
/// with the closing speed.
struct Rubbing {
    weight: Weight,
    ramp: f64,
    damping: f64,
}

impl Rubbing {
    fn of(mechanism: &Mechanism, ramp: f64) -> Self {
        let weight = weight(mechanism);
        Self {
            weight,
            ramp,
            damping: 0.2,
        }
    }

    fn contacts(&self) -> [Contact; 3] {
        let contact = |bodies, [x, y]: [f64; 2], normal, normal_force| Contact {
            bodies,
            point: [HUB[0] + x, HUB[1] + y],
            normal,
            normal_force,
            coefficient: 0.3,
            ramp: self.ramp,
        };
        [
            contact([1, 2], [0.2, 0.9], [0.6, 0.8], 5.0),
            contact([2, 0], [-0.5, -0.1], [-0.8, 0.6], 9.0),
            contact([3, 1], [2.0, 0.7], [0.0, 1.0], 2.0),
        ]
    }
}

impl Forces for Rubbing {
    fn apply(&mut self, _: f64, _: &[BodyState], _: &mut [Wrench]) {
        unreachable!("an implicit stage asks for contacts")
    }

    fn apply_without_friction(
        &mut self,
        t: f64,
        bodies: &[BodyState],
        loads: &mut [Wrench],
        contacts: &mut Vec<Contact>,
    ) {
        self.weight.apply(t, bodies, loads);
        contacts.clear();
        contacts.extend(self.contacts());
    }

    fn normal_force(&self, _: usize, listed: f64, rate: f64) -> f64 {
        listed + self.damping * rate
    }
}

/// Implicit friction is equal in both formulations, for free and driven carriers, sliding and sticking.
#[test]
fn implicit_friction_is_the_same_in_both_forms() {
    for (driven, a) in [(false, 1e-3), (true, 1e-3), (false, 1.0), (true, 1.0)] {
        let m = carousel(driven);
        let rubbing = || Rubbing::of(&m, 1e-3);
        let mut reduced = Reduced::new(m.clone(), rubbing(), &[]).unwrap();
        let contacts = Reduced::new(m.clone(), rubbing(), &[])
            .unwrap()
            .into_contacts();
        let mut lagrange = Lagrange::new(m.clone(), rubbing(), Stabilisation::Projection)
            .unwrap()
            .with_contacts(contacts);
        let free = reduced.free_bodies().to_vec();
        let (mut y, mut z) = (reduced.initial(), lagrange.initial());
        let (mut e, mut i) = (vec![0.0; y.len()], vec![0.0; y.len()]);
        let (mut f, mut j) = (vec![0.0; z.len()], vec![0.0; z.len()]);
        // The estimates select the speeds at which normal forces are evaluated.
        for (k, body) in free.iter().enumerate() {
            let guess = 0.3 + 0.1 * k as f64;
            (i[free.len() + k], j[12 + 3 * body + 2]) = (guess, guess);
        }
        reduced.split_stage(0.0, a, &mut y, &mut e, &mut i);
        lagrange.split_stage(0.0, a, &mut z, &mut f, &mut j);
        let n = free.len();
        for (k, body) in free.iter().enumerate() {
            let at = 12 + 3 * body + 2;
            for (what, actual, expected) in [
                ("rate", z[at], y[n + k]),
                ("slope of the angle", f[at - 12], e[k]),
                ("explicit part", f[at], e[n + k]),
                ("implicit part", j[at], i[n + k]),
            ] {
                let off = (actual - expected).abs() / expected.abs().max(1.0);
                holds(&format!("{driven} {a} {body}"), what, off, ..1e-10);
            }
            assert!(i[n + k] != 0.0, "body {body} slides");
        }
        assert_eq!(reduced.newton_steps(), lagrange.newton_steps());
        assert!(reduced.newton_steps() > 0);
        // Velocities of carried bodies follow from the hub's rate after friction.
        let hub = z[14];
        for (body, [x, y]) in [(1, [0.6, 0.2]), (2, [-0.3, 0.4])] {
            for (actual, expected) in [(z[12 + 3 * body], -hub * y), (z[13 + 3 * body], hub * x)] {
                let off = (actual - expected).abs();
                holds(
                    &format!("{driven} {a}"),
                    "speed of a centre, m/s",
                    off,
                    ..1e-10,
                );
            }
        }
    }
}

/// Without the contacts' dependence on the rates an implicit stage gives NaN.
#[test]
fn implicit_friction_needs_the_contacts() {
    let m = carousel(false);
    let mut system = Lagrange::new(m.clone(), Rubbing::of(&m, 1e-3), Stabilisation::None).unwrap();
    let mut z = system.initial();
    let (mut f, mut j) = (vec![0.0; z.len()], vec![0.0; z.len()]);
    system.split_stage(0.0, 1e-3, &mut z, &mut f, &mut j);
    assert!(f.iter().all(|x| x.is_nan()));
}

/// Contribution of friction and of closing contacts to each rate, evaluated by definition from the speeds of both bodies at the
/// contact.
#[test]
fn implicit_friction_is_that_of_the_speeds_at_the_contacts() {
    for (driven, idle) in [(false, &[][..]), (true, &[]), (true, &[3])] {
        let m = carousel(driven);
        let stage = |damping: f64| {
            let rubbing = Rubbing {
                damping,
                ..Rubbing::of(&m, 10.0)
            };
            let mut system = Reduced::new(m.clone(), rubbing, idle).unwrap();
            let n = system.free_bodies().len();
            let mut y = system.initial();
            let (mut e, mut i) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
            system.split_stage(0.0, 0.02, &mut y, &mut e, &mut i);
            (system.free_bodies().to_vec(), y, e, i)
        };
        let (free, y, explicit, implicit) = stage(0.2);
        let (_, _, without, _) = stage(0.0);
        let n = free.len();
        let before: Vec<BodyState> = m.bodies.iter().map(|b| b.start).collect();
        let mut bodies = before.clone();
        for (k, &body) in free.iter().enumerate() {
            bodies[body].rate = y[n + k];
        }
        let hub = bodies[0].rate;
        for body in [1, 2] {
            let (x, y) = (bodies[body].x - HUB[0], bodies[body].y - HUB[1]);
            (bodies[body].vx, bodies[body].vy) = (-hub * y, hub * x);
        }
        let (mut has_friction, mut pushes) = ([0.0; 4], [0.0; 4]);
        for contact in Rubbing::of(&m, 10.0).contacts() {
            let [nx, ny] = contact.normal;
            let [first, second] = contact.bodies;
            let arm = |b: &BodyState| (contact.point[0] - b.x, contact.point[1] - b.y);
            let velocity = |b: &BodyState| {
                let (px, py) = arm(b);
                [b.vx - b.rate * py, b.vy + b.rate * px]
            };
            let apart = |of: &[BodyState]| {
                let ([ax, ay], [bx, by]) = (velocity(&of[first]), velocity(&of[second]));
                [ax - bx, ay - by]
            };
            let [x, y] = apart(&before);
            let change = 0.2 * (x * nx + y * ny);
            let [x, y] = apart(&bodies);
            let slip = nx * y - ny * x;
            assert!(slip.abs() > 0.01 && slip.abs() < contact.ramp, "{slip}");
            assert!(change.abs() > 0.01, "{change}");
            let normal = contact.normal_force + change;
            let friction = contact.coefficient * normal * slip / contact.ramp;
            for (moments, fx, fy) in [
                (&mut has_friction, ny * friction, -nx * friction),
                (&mut pushes, -nx * change, -ny * change),
            ] {
                for (body, sign) in [(first, 1.0), (second, -1.0)] {
                    let b = &bodies[body];
                    let (px, py) = arm(b);
                    moments[body] += sign * (px * fy - py * fx);
                    if body == 1 || body == 2 {
                        moments[0] += sign * ((b.x - HUB[0]) * fy - (b.y - HUB[1]) * fx);
                    }
                }
            }
        }
        let mut inertia = [0.5, 0.1, 0.2, 0.3];
        inertia[0] += 1.0 * (0.36 + 0.04) + 3.0 * (0.09 + 0.16);
        for (k, &body) in free.iter().enumerate() {
            let rubbed = implicit[n + k] - has_friction[body] / inertia[body];
            let pushed = explicit[n + k] - without[n + k] - pushes[body] / inertia[body];
            for (what, off) in [("has_friction", rubbed), ("pushes", pushed)] {
                holds("stage", &format!("{what} {body}"), off.abs(), ..1e-12);
            }
        }
    }
}
