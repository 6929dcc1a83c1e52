//! Pinwheel's normal force in rapier's contact solver: proxy colliders create one contact per disc and pin, and a hook writes
//! exact point, normal and load into it.
//!
//! rapier's contact is a spring of stiffness k = m w^2 with m the pair's effective mass. Implicit in time, it gives the impulse
//! h k (depth - h v) over a step. With w so small that (h w)^2 is negligible, the depth for F_n is very large, h v is
//! negligible beside it, and the contact transmits F_n h exactly. rapier's Coulomb friction, implicit and bounded by mu F_n h,
//! completes the contact.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::channels::{PairSource, Visit};
use pinwheel_gearbox::contacts::{ContactEnergy, ContactField, PairContact};
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::{Layout, Sleeve};
use rapier2d_f64::prelude::*;

use super::march::{Contacts, Grid, friction_is_plain, march};
use super::sums::{Evaluation, sleeve_slot};
use super::world::World;
use crate::engine::{Ending, Halt, Prepared, prepared};
use crate::refusals::{pins_turn, wheels_are_held};

/// Gauss-Seidel sweeps per step. Friction couples the pins through the shafts: the error of the driver torque is 1.6e-2 with
/// five, 1.0e-3 with ten, 8.9e-4 with twenty, 8.6e-4 with forty (mu = 0.1, steady, 1e-5 s).
pub const SWEEPS: usize = 20;

/// Product h w of the contact spring. The spring's own damping, m (h w)^2 v/h, is then about 1e-6 N, and its depth leaves the
/// contact point exact to 1e-12 m.
const STEP_TIMES_FREQUENCY: f64 = 1e-4;

/// Least depth of contacts, as a share of the ring pins' circle radius. Rounding of rapier's coordinates of that size could
/// turn shallower contacts into gaps, which it closes with a rigid contact. In the paper's gear at 1e-5 s the depth is 1e-9 m
/// and carries 3e-9 N.
const LEAST_DEPTH: f64 = 1.6e-8;

pub fn prepare(gearbox: &Gearbox) -> Result<Prepared<'static>, Halt> {
    friction_is_plain(&gearbox.scene)?;
    wheels_are_held(&gearbox.scene)?;
    pins_turn(&gearbox.scene)?;
    let grid = Grid::new(&gearbox.scene, gearbox.scene.solver.step_s)?;
    Ok(prepared(gearbox.clone(), move |gearbox, control| {
        let field = gearbox.contact_field().map_err(Ending::unsupported)?;
        let mut world = World::new(gearbox, grid.step_s, SWEEPS);
        let mut contacts = Hooked::new(gearbox, field, &mut world, grid.step_s);
        let settings = format!(
            "impulse revolutes, leapfrog, 1 substep, {SWEEPS} constraint sweeps, warm start; contacts by hook"
        );
        march(gearbox, world, &mut contacts, &grid, settings, control)
    }))
}

/// Table of pairs that Pinwheel's law fills and rapier's hook reads.
pub struct Hooked {
    layout: Layout,
    field: ContactField,
    friction: f64,
    /// Least depth of a contact, m, by [`LEAST_DEPTH`].
    least_depth_m: f64,
    step_s: f64,
    /// Collider of each disc.
    wheels: Vec<ColliderHandle>,
    /// Colliders of the ring pins, then of the output pins.
    sleeves: Vec<ColliderHandle>,
    /// Loads at disc * pins + pin; `None` without contact.
    table: Vec<Option<Load>>,
}

/// Contact as the hook writes it.
#[derive(Clone, Copy)]
struct Load {
    pair: PairContact,
    /// Depth at which rapier's spring carries the force, m.
    depth: f64,
}

impl Hooked {
    pub fn new(gearbox: &Gearbox, field: ContactField, world: &mut World, step_s: f64) -> Self {
        let (layout, gear) = (gearbox.layout, &gearbox.scene.gear);
        world.contact_spring(STEP_TIMES_FREQUENCY / (step_s * std::f64::consts::TAU));

        // A disc's proxy covers every pin at any position in a run, so that every pair meets.
        let reach = 2.0 * (gear.pitch_radius_m() + gear.backlash_m + gear.external_sleeve_radius_m);
        let (wheel, sleeve) = (Group::GROUP_1, Group::GROUP_2);
        let mut proxy = |body: usize, radius: f64, member: Group, filter: Group, tag: usize| {
            let ball = ColliderBuilder::ball(radius)
                .density(0.0)
                .collision_groups(InteractionGroups::new(
                    member,
                    filter,
                    InteractionTestMode::And,
                ))
                .active_hooks(ActiveHooks::MODIFY_SOLVER_CONTACTS)
                .user_data(tag as u128);
            world.attach(ball, body)
        };
        let wheels: Vec<ColliderHandle> = layout
            .wheel_bodies()
            .enumerate()
            .map(|(i, body)| proxy(body, reach, wheel, sleeve, i))
            .collect();
        let externals = layout
            .external_bodies()
            .map(|body| (body, gear.external_sleeve_radius_m));
        let internals = layout
            .internal_bodies()
            .map(|body| (body, gear.internal_sleeve_radius_m));
        let sleeves: Vec<ColliderHandle> = externals
            .chain(internals)
            .enumerate()
            .map(|(i, (body, radius))| proxy(body, radius, sleeve, wheel, layout.wheels + i))
            .collect();
        Self {
            layout,
            field,
            friction: gearbox.scene.contact.friction_coefficient,
            least_depth_m: LEAST_DEPTH * gear.pitch_radius_m(),
            step_s,
            table: vec![None; wheels.len() * sleeves.len()],
            wheels,
            sleeves,
        }
    }

    /// Visits the pairs that touched in the last step, with the forces of rapier's impulses.
    pub fn transmitted(&self, world: &World, share: f64, visit: &mut dyn FnMut(&PairContact)) {
        for Load { pair, .. } in self.table.iter().flatten() {
            visit(&self.with_forces(world, share, *pair));
        }
    }

    /// Returns a pair that touched in the last step with the forces of rapier's impulses.
    fn with_forces(&self, world: &World, share: f64, pair: PairContact) -> PairContact {
        let per_impulse = 1.0 / (share * self.step_s);
        let sleeve = self.sleeves[sleeve_slot(self.layout, pair.sleeve)];
        let contacts = world
            .physics
            .narrow_phase
            .contact_pair(self.wheels[pair.wheel], sleeve);
        let point = contacts
            .and_then(|contacts| contacts.manifolds().first())
            .filter(|manifold| !manifold.data.solver_contacts.is_empty())
            .and_then(|manifold| manifold.points.first());
        // rapier's friction impulse acts on the first body, along that body's normal force rotated by 90 degrees: t on a disc,
        // with the opposite on the pin, or -t on a pin.
        let (normal, friction) = point.map_or((0.0, 0.0), |point| {
            (point.data.impulse, -point.data.tangent_impulse.x)
        });
        PairContact {
            normal_force_n: normal * per_impulse,
            friction_force_n: friction * per_impulse,
            ..pair
        }
    }
}

/// Contacts at a sample: Pinwheel's geometry, rapier's forces.
struct Transmitted<'a> {
    hooked: &'a mut Hooked,
    world: &'a World,
    share: f64,
}

impl PairSource for Transmitted<'_> {
    fn pair(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> Option<PairContact> {
        let pair = self.hooked.field.nearest(bodies, wheel, sleeve);
        let count = self.hooked.sleeves.len();
        let slot = wheel * count + sleeve_slot(self.hooked.layout, sleeve);
        Some(match self.hooked.table[slot] {
            Some(_) => self.hooked.with_forces(self.world, self.share, pair),
            None => pair,
        })
    }

    fn loaded(&mut self, _: &[BodyState], least_n: f64, visit: Visit<'_>) {
        self.hooked
            .transmitted(self.world, self.share, &mut |pair| {
                if pair.normal_force_n > least_n {
                    visit(pair.wheel, pair.sleeve);
                }
            });
    }

    fn losses(&mut self, _bodies: &[BodyState]) -> Option<ContactEnergy> {
        let mut sum = ContactEnergy::default();
        self.hooked
            .transmitted(self.world, self.share, &mut |pair| {
                let elastic = pair.normal_force_at(self.hooked.field.law(), 0.0);
                sum.damping_w += (pair.normal_force_n - elastic) * pair.normal_rate_m_s;
                sum.contact_friction_w -= pair.friction_force_n * pair.tangential_rate_m_s;
            });
        Some(sum)
    }
}

impl Contacts for Hooked {
    fn step(
        &mut self,
        world: &mut World,
        now: &[BodyState],
        loads: &mut [Wrench],
    ) -> Result<(), String> {
        self.table.fill(None);
        let (layout, table, count) = (self.layout, &mut self.table, self.sleeves.len());
        let per_inverse_mass = world.share() / (STEP_TIMES_FREQUENCY / self.step_s).powi(2);
        self.field.touching(now, &mut |pair| {
            let wheel = world.body(layout.wheel_bodies().start + pair.wheel);
            let sleeve = world.body(layout.sleeve_body(pair.sleeve));
            let inverse_mass = inverse_mass_along(wheel, pair) + inverse_mass_along(sleeve, pair);
            let depth = pair.normal_force_n * inverse_mass * per_inverse_mass;
            let slot = pair.wheel * count + sleeve_slot(layout, pair.sleeve);
            table[slot] = Some(Load { pair: *pair, depth });
            add_along_force(layout, now, pair, loads);
        });
        world.load(loads);
        world.advance(&Hook {
            table: &self.table,
            wheels: self.wheels.len(),
            sleeves: count,
            friction: self.friction,
            least_depth_m: self.least_depth_m,
        })
    }

    fn forces(&mut self, world: &World, _now: &[BodyState], share: f64, sums: &mut Evaluation) {
        self.transmitted(world, share, &mut |pair| {
            sums.add(pair.wheel, pair.sleeve, pair.force_on_sleeve());
        });
    }

    fn pair_source<'a>(&'a mut self, world: &'a World, share: f64) -> Box<dyn PairSource + 'a> {
        Box::new(Transmitted {
            hooked: self,
            world,
            share,
        })
    }
}

/// Adds the force of some laws along the profile, which rapier's contacts lack, as a load at the pin's centre.
fn add_along_force(layout: Layout, now: &[BodyState], pair: &PairContact, loads: &mut [Wrench]) {
    let [nx, ny] = pair.normal;
    let (fx, fy) = (-pair.along_force_n * ny, pair.along_force_n * nx);
    let (wheel, sleeve) = (
        layout.wheel_bodies().start + pair.wheel,
        layout.sleeve_body(pair.sleeve),
    );
    loads[sleeve].fx += fx;
    loads[sleeve].fy += fy;
    loads[wheel].fx -= fx;
    loads[wheel].fy -= fy;
    let [x, y] = pair.centre;
    loads[wheel].moment -= (x - now[wheel].x) * fy - (y - now[wheel].y) * fx;
}

/// Returns 1/m + (r x n)^2/I of a body at the contact point, 1/kg.
fn inverse_mass_along(body: &RigidBody, pair: &PairContact) -> f64 {
    let at = body.translation();
    let lever = (pair.point[0] - at.x) * pair.normal[1] - (pair.point[1] - at.y) * pair.normal[0];
    let own = &body.mass_properties().local_mprops;
    own.inv_mass + lever * lever * own.inv_principal_inertia
}

/// Writes the table into rapier's contacts.
struct Hook<'a> {
    table: &'a [Option<Load>],
    wheels: usize,
    sleeves: usize,
    friction: f64,
    least_depth_m: f64,
}

impl PhysicsHooks for Hook<'_> {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext<'_>) {
        let tag = |handle: ColliderHandle| context.colliders[handle].user_data as usize;
        let (first, second) = (tag(context.collider1), tag(context.collider2));
        let wheel_first = first < self.wheels;
        let (wheel, sleeve) = if wheel_first {
            (first, second)
        } else {
            (second, first)
        };
        let load = self.table[wheel * self.sleeves + sleeve - self.wheels];
        let Some(contact) = context.rigid_mut() else {
            return;
        };
        let Some(Load { pair, depth }) = load.filter(|load| load.depth > self.least_depth_m) else {
            contact.solver_contacts.clear();
            return;
        };
        // rapier's normal points out of the first body: -n out of a disc.
        let n = Vector::new(pair.normal[0], pair.normal[1]);
        let normal = if wheel_first { -n } else { n };
        *contact.normal = normal;
        *contact.friction = self.friction;
        *contact.restitution = 0.0;
        for solver in contact.solver_contacts.iter_mut() {
            // rapier moves the first anchor by the depth along the normal and uses the lever arm of the midpoint; half a depth
            // before W, that midpoint is W.
            let anchor = Vector::new(pair.point[0], pair.point[1]) - 0.5 * depth * normal;
            solver.anchor1 = anchor;
            solver.anchor2 = anchor;
            solver.dist = -depth;
        }
    }
}
