//! rapier with its own contacts: polyline discs and holes, round pins, its own collision detection, contact spring and Coulomb
//! friction.

use std::ops::Range;

use pinwheel_contact::Complex;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::channels::{PairSource, Visit};
use pinwheel_gearbox::contacts::{ContactEnergy, PairContact};
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::Sleeve;
use pinwheel_scene::scales::{Scales, external_force, internal_force};
use pinwheel_scene::{CheckedScene, Detection, Scene, Start, load_profile, speed_profile};
use rapier2d_f64::parry::query::PointQuery;
use rapier2d_f64::prelude::*;

use super::march::{Contacts, Grid, friction_is_plain, march};
use super::outlines::{closed, corners_for_sag, hole_edge, sag_of_corners, wheel_edge};
use super::sums::Evaluation;
use super::world::{World, in_frame_of};
use crate::engine::{Ending, Halt, Prepared, prepared};
use crate::refusals::pins_are_rigid;
use crate::spring::{contact_spring, spring_load};

/// Number of points of a disc's edge, and fewest of a lobe: on a gear of 39 lobes 103 points per lobe change the mean forces by
/// 0.8 % against 267.
pub const EDGE_POINTS: usize = 4000;
const LOBE_POINTS: usize = 100;
/// Largest number of points of an edge: a finer outline costs more than it improves.
const MOST_POINTS: usize = 16_000;
/// Fewest and most points of a hole's edge: with the fewest, chords are 0.3 micrometres deep in a hole of 8.8 mm.
pub const HOLE_POINTS: usize = 400;
const MOST_HOLE_POINTS: usize = 4000;
/// Target and largest distance between an outline and its curve, as shares of the depth of contacts.
const SAG: f64 = 0.01;
const MOST_SAG: f64 = 0.05;

/// Gauss-Seidel sweeps per step, as in the contact hook.
const SWEEPS: usize = 20;

/// Longest step, s, and fewest steps in a turn of the input. The spring is implicit, and only means are compared: five times
/// finer steps change the means by less than 0.05 %.
const LONGEST_STEP_S: f64 = 1e-4;
const STEPS_PER_TURN: f64 = 1200.0;
/// Largest number of periods of the contact spring in a step: beyond one, the implicit spring is too soft (a gear of 3 mm in
/// plastics slips through its teeth at 1.9; the paper's has 0.1, steel 0.5).
const PERIODS: f64 = 0.5;

pub fn prepare(gearbox: &Gearbox) -> Result<Prepared<'static>, Halt> {
    let scene = &gearbox.scene;
    friction_is_plain(scene)?;
    pins_are_rigid(scene)?;
    if scene.drive.start == Start::Equilibrium {
        return Err(Ending::unsupported(
                "its contact spring is not the scene's law, so the equilibrium of drive.start = \"equilibrium\" is not \
                 its own; use \"kinematic\"",
            )
            .into());
    }
    if scene.contact.detection == Detection::Points {
        return Err(Ending::unsupported(
                "it finds contacts itself, so contact.detection = \"points\" has no meaning for it; use \"exact\"",
            )
            .into());
    }
    let mut field = gearbox.contact_field().map_err(Ending::unsupported)?;
    let spring = contact_spring(gearbox, &mut field).map_err(Ending::unsupported)?;
    let corners = Corners::of(scene, spring.stiffness_n_m).map_err(Ending::unsupported)?;
    let frequency = spring.frequency_hz;
    let grid = Grid::new(scene, step_s(scene, frequency))?;
    let mut gearbox = gearbox.clone();
    if let Some([external, internal]) = spring.masses_kg {
        let mut lighter = Scene::clone(scene);
        let (mass, gear) = (&mut lighter.mass, &scene.gear);
        let (count, less_kg, radius) = match scene.ring_turns() {
            true => (
                gear.external_sleeves,
                mass.external_sleeve.mass_kg - external,
                gear.pitch_radius_m(),
            ),
            false => (
                gear.internal_sleeves,
                mass.internal_sleeve.mass_kg - internal,
                gear.internal_circle_radius_m,
            ),
        };
        mass.output_shaft.moment_kg_m2 += count as f64 * less_kg * radius.powi(2);
        for (sleeve, kg) in [
            (&mut mass.external_sleeve, external),
            (&mut mass.internal_sleeve, internal),
        ] {
            sleeve.moment_kg_m2 *= kg / sleeve.mass_kg;
            sleeve.mass_kg = kg;
        }
        // Only this engine uses the changed scene; its other values were checked.
        gearbox = Gearbox::new(&CheckedScene::unchecked(lighter)).map_err(Ending::unsupported)?;
    }
    Ok(prepared(gearbox, move |gearbox, control| {
        let mut world = World::new(gearbox, grid.step_s, SWEEPS);
        world.contact_spring(frequency);
        let mut contacts = Solid::new(gearbox, &mut world, grid.step_s, corners);
        let [external, internal] = spring.stiffness_n_m;
        let masses = match spring.masses_kg {
            Some(_) => "sleeves' masses that make both stages right",
            None => "the scene's masses, exact for the mean of both stages",
        };
        let settings = format!(
            "impulse revolutes, 1 substep, {SWEEPS} constraint sweeps, warm start; {} corners a disc, {} a hole; contact \
             springs of {external:.2e} N/m outside, {internal:.2e} N/m inside, {frequency:.0} Hz, {masses}",
            corners.wheel, corners.hole
        );
        let mut run = march(gearbox, world, &mut contacts, &grid, settings, control)?;
        // The native law is not evaluated.
        run.stats.rhs_calls = 0;
        run.stats.notes = notes(gearbox, &grid);
        Ok(run)
    }))
}

/// Returns remarks for the reader.
fn notes(gearbox: &Gearbox, grid: &Grid) -> Vec<String> {
    let mut notes = vec![format!(
        "Steps of {} s of its own choice instead of solver.step_s; its contact law is not the scene's, so no \
         evaluation of that is counted.",
        grid.step_s
    )];
    let scene = &gearbox.scene;
    if !scene.drive.load_changes.is_empty() {
        notes.push(format!(
            "Its one contact spring is right for a load of {} N m; under the scene's other loads it is too stiff or too \
             soft.",
            spring_load(scene)
        ));
    }
    notes
}

/// Numbers of corners of outlines.
#[derive(Debug, Clone, Copy)]
pub struct Corners {
    pub wheel: usize,
    pub hole: usize,
}

impl Corners {
    /// Selects the numbers of corners for outlines within a hundredth of the contact depth. The depth is that of springs of
    /// `stiffness_n_m` (external, internal, N/m) under the static load.
    pub fn of(scene: &Scene, stiffness_n_m: [f64; 2]) -> Result<Self, String> {
        let gear = &scene.gear;
        let torque = Scales::of(scene).wheel_torque_n_m;
        let forces = [external_force(gear, torque), internal_force(gear, torque)];
        let depth = |stage: usize| forces[stage] / stiffness_n_m[stage];
        let fewest = EDGE_POINTS.max(LOBE_POINTS * gear.lobes());
        // Without a load contacts have no depth.
        if load_profile::largest(&scene.drive) == 0.0 {
            return Ok(Self {
                wheel: fewest,
                hole: HOLE_POINTS,
            });
        }
        let wanted = corners_for_sag(gear, SAG * depth(0)).ceil();
        let wheel = (wanted.min(MOST_POINTS as f64) as usize).max(fewest);
        let sag = sag_of_corners(gear, wheel);
        if sag > MOST_SAG * depth(0) {
            return Err(format!(
                "limited by its polygon: with {wheel} corners an edge misses the curve by {sag:.1e} m, and contacts are \
                 pressed in by {:.1e} m; take a softer contact, or the engine rapier-own-contact-hook",
                depth(0)
            ));
        }
        // The sagitta of a chord over an angle a of a circle of radius r is r a^2/8.
        let hole = std::f64::consts::TAU * (gear.hole_radius_m / (8.0 * SAG * depth(1))).sqrt();
        let hole = (hole.ceil().min(MOST_HOLE_POINTS as f64) as usize).max(HOLE_POINTS);
        Ok(Self { wheel, hole })
    }
}

/// Returns the longest permitted step that divides the sampling step; `frequency` of the contact spring, Hz.
fn step_s(scene: &Scene, frequency: f64) -> f64 {
    let turn_s = std::f64::consts::TAU / speed_profile::fastest_rad_s(&scene.drive).abs();
    let longest = LONGEST_STEP_S
        .min(turn_s / STEPS_PER_TURN)
        .min(PERIODS / frequency);
    let sample_s = scene.solver.sample_s;
    sample_s / (sample_s / longest * (1.0 - 1e-9)).ceil().max(1.0)
}

/// Collider on a disc and the pin that it meets.
struct Meeting {
    edge: ColliderHandle,
    ball: ColliderHandle,
    wheel: usize,
    sleeve: Sleeve,
}

/// Colliders with their step and pairs.
struct Solid {
    step_s: f64,
    meetings: Vec<Meeting>,
}

/// Collision groups: edges meet ring pins, and each hole meets its own pin.
const EDGES: Group = Group::GROUP_1;
const EXTERNALS: Group = Group::GROUP_2;
const HOLES: Group = Group::GROUP_3;
const INTERNALS: Group = Group::GROUP_4;

impl Solid {
    fn new(gearbox: &Gearbox, world: &mut World, step_s: f64, corners: Corners) -> Self {
        let (layout, gear, geometry) = (gearbox.layout, &gearbox.scene.gear, &gearbox.geometry);
        let friction = gearbox.scene.contact.friction_coefficient;
        // Hole and pin have the pin's number as their tag.
        let mut add =
            |shape: ColliderBuilder, body: usize, own: Group, other: Group, tag: usize| {
                let collider = shape
                    .density(0.0)
                    .friction(friction)
                    .friction_combine_rule(CoefficientCombineRule::Average)
                    .restitution(0.0)
                    .collision_groups(InteractionGroups::new(own, other, InteractionTestMode::And))
                    .active_hooks(
                        ActiveHooks::FILTER_CONTACT_PAIRS | ActiveHooks::MODIFY_SOLVER_CONTACTS,
                    )
                    .user_data(tag as u128);
                world.attach(collider, body)
            };
        let mut discs = |radii: &[f64], bodies: Range<usize>, own: Group, edge: Group| {
            let each = radii.iter().zip(bodies).enumerate();
            let each = each.map(|(number, (&radius, body))| {
                let tag = if own == INTERNALS { number } else { 0 };
                add(ColliderBuilder::ball(radius), body, own, edge, tag)
            });
            each.collect::<Vec<ColliderHandle>>()
        };
        let radii = &geometry.external_radii_m;
        let externals = discs(radii, layout.external_bodies(), EXTERNALS, EDGES);
        let radii = &geometry.internal_radii_m;
        let internals = discs(radii, layout.internal_bodies(), INTERNALS, HOLES);

        let starts = gearbox.kinematic_states();
        let mut meetings = Vec::new();
        for (wheel, body) in layout.wheel_bodies().enumerate() {
            let outline = wheel_edge(gear, corners.wheel);
            let segments = closed(outline.len());
            let outline = ColliderBuilder::polyline(outline, Some(segments));
            let edge = add(outline, body, EDGES, EXTERNALS, 0);
            meetings.extend(externals.iter().enumerate().map(|(j, &ball)| Meeting {
                edge,
                ball,
                wheel,
                sleeve: Sleeve::External(j),
            }));
            for (k, &ball) in internals.iter().enumerate() {
                let sleeve = Sleeve::Internal(k);
                let centre = if gear.errors.is_none() {
                    // At t = 0 a hole's position relative to its disc is that of its pin relative to the output's centre, the
                    // origin.
                    // the output's centre, the origin.
                    let wheel = BodyState {
                        angle: starts[body].angle,
                        ..BodyState::default()
                    };
                    in_frame_of(&wheel, &starts[layout.sleeve_body(sleeve)])
                } else {
                    let Complex { re, im } = geometry.hole_centres[wheel][k];
                    Vector::new(re, im)
                };
                let outline = ColliderBuilder::polyline_with_flags(
                    hole_edge(centre, geometry.hole_radii_m[wheel][k], corners.hole),
                    Some(closed(corners.hole)),
                    PolylineFlags::ORIENTED,
                );
                let edge = add(outline, body, HOLES, INTERNALS, k);
                meetings.push(Meeting {
                    edge,
                    ball,
                    wheel,
                    sleeve,
                });
            }
        }
        Self { step_s, meetings }
    }
}

impl Contacts for Solid {
    fn step(
        &mut self,
        world: &mut World,
        _now: &[BodyState],
        loads: &mut [Wrench],
    ) -> Result<(), String> {
        world.load(loads);
        world.advance(&Nearest)
    }

    fn forces(&mut self, world: &World, _now: &[BodyState], share: f64, sums: &mut Evaluation) {
        let per_impulse = 1.0 / (share * self.step_s);
        for meeting in &self.meetings {
            meeting.impulses(world, &mut |_, impulse| {
                let force = per_impulse * impulse;
                sums.add(meeting.wheel, meeting.sleeve, [force.x, force.y]);
            });
        }
    }

    fn pair_source<'a>(&'a mut self, world: &'a World, _share: f64) -> Box<dyn PairSource + 'a> {
        Box::new(Own {
            meetings: &self.meetings,
            world,
            step_s: self.step_s,
        })
    }
}

impl Meeting {
    /// Visits the impulses of the last step: magnitude of the normal one, and total on the pin.
    fn impulses(&self, world: &World, visit: &mut dyn FnMut(f64, Vector)) {
        let contacts = world
            .physics
            .narrow_phase
            .contact_pair(self.edge, self.ball);
        let Some(contacts) = contacts else { return };
        let sign = if contacts.collider1 == self.edge {
            1.0
        } else {
            -1.0
        };
        for manifold in contacts.manifolds() {
            if manifold.data.solver_contacts.is_empty() {
                continue;
            }
            for point in &manifold.points {
                // rapier's normal points out of the first body and pushes the second along it;
                // its friction impulse is on the first, along minus the normal turned by 90 degrees.
                let (normal, turned) = (manifold.data.normal, manifold.data.normal.perp());
                let impulse = point.data.impulse * normal + point.data.tangent_impulse.x * turned;
                visit(point.data.impulse, sign * impulse);
            }
        }
    }
}

/// Contacts resolved by rapier itself, which provide only the list of pressing pairs. rapier's penetrations refer to polylines,
/// and its stiffness to no contact law, so neither is given.
struct Own<'a> {
    meetings: &'a [Meeting],
    world: &'a World,
    step_s: f64,
}

impl PairSource for Own<'_> {
    fn pair(&mut self, _: &[BodyState], _wheel: usize, _sleeve: Sleeve) -> Option<PairContact> {
        None
    }

    fn loaded(&mut self, _: &[BodyState], least_n: f64, visit: Visit<'_>) {
        let impulse_n_s = least_n * self.step_s;
        for meeting in self.meetings {
            let mut presses = false;
            meeting.impulses(self.world, &mut |normal, _| presses |= normal > impulse_n_s);
            if presses {
                visit(meeting.wheel, meeting.sleeve);
            }
        }
    }

    fn losses(&mut self, _: &[BodyState]) -> Option<ContactEnergy> {
        None
    }
}

/// Contact filter that keeps only the nearest of the segments that touch a pin, because the others belong to the same contact.
/// Pairs that do not touch are skipped: their boxes overlap with hundreds of segments each.
struct Nearest;

/// Returns the edge of a pair, its polyline, and the pin.
fn edge_and_ball<'a>(
    first: &'a Collider,
    second: &'a Collider,
) -> Option<(&'a Collider, &'a Polyline, &'a Collider)> {
    match (first.shape().as_polyline(), second.shape().as_polyline()) {
        (Some(line), _) => Some((first, line, second)),
        (_, Some(line)) => Some((second, line, first)),
        _ => None,
    }
}

/// Returns the pin's centre in the edge's frame.
fn centre(edge: &Collider, ball: &Collider) -> Vector {
    let centre = ball.position().translation;
    edge.position().inverse_transform_point(centre)
}

impl PhysicsHooks for Nearest {
    fn filter_contact_pair(&self, context: &PairFilterContext<'_>) -> Option<SolverFlags> {
        let [first, second] =
            [context.collider1, context.collider2].map(|one| &context.colliders[one]);
        let touching = edge_and_ball(first, second).is_none_or(|(edge, line, ball)| {
            let radius = ball
                .shape()
                .as_ball()
                .map_or(f64::INFINITY, |ball| ball.radius);
            edge.user_data == ball.user_data
                && line.distance_to_local_point(centre(edge, ball), false) < radius
        });
        touching.then_some(SolverFlags::COMPUTE_RIGID_IMPULSES)
    }

    fn modify_solver_contacts(&self, context: &mut ContactModificationContext<'_>) {
        let [first, second] =
            [context.collider1, context.collider2].map(|one| &context.colliders[one]);
        let Some(contact) = context.rigid_mut() else {
            return;
        };
        if contact.solver_contacts.is_empty() {
            return;
        }
        let Some((edge, line, ball)) = edge_and_ball(first, second) else {
            return;
        };
        let segment = match first.shape().as_polyline() {
            Some(_) => contact.manifold.subshape1,
            None => contact.manifold.subshape2,
        };
        let centre = centre(edge, ball);
        let count = line.num_segments() as u32;
        let distance = |segment: u32| {
            line.segment(segment % count)
                .distance_to_local_point(centre, false)
        };
        // Distances have minima along the contact; of two equally near segments at a corner the first counts.
        let here = distance(segment);
        if distance(segment + count - 1) <= here || distance(segment + 1) < here {
            contact.solver_contacts.clear();
        }
    }
}
