//! How what the cranks of an RV reducer do changes with all that is free, and with the time as the input turns.
//!
//! With n along the offset d, t across it, and v its rate, of each bearing
//!
//! ```text
//! dF = (F_d n.dd + F_v (n.dv + (v.t) t.dd/|d|)) n + F t (t.dd)/|d|,     dd = dH - dC
//! ```
//! Deflections of the support and of the mesh move with the offsets as their balance has it.

use arrayvec::ArrayVec;
use pinwheel_mbs::{BodyState, Jacobian};

use super::{CrankSet, Deflection, OfCrank, Springs, WHEELS, cross, pressed};
use crate::Layout;
use crate::contacts::pairs::places;

/// Place of the output among the free bodies; discs follow.
const OUTPUT: usize = 0;
const AXES: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

/// Motion in a bearing by one of the coordinates or rates, or by the time.
#[derive(Debug, Clone, Copy, Default)]
struct Move {
    /// The offset, where nothing gives way, and its rate.
    way: [f64; 2],
    faster: [f64; 2],
    /// The bore from the disc's centre.
    arm: [f64; 2],
    /// The crank, rad.
    turned: f64,
    /// How fast disc and crank turn against each other.
    turning: f64,
}

/// A bearing and its derivatives.
#[derive(Debug, Clone, Copy)]
struct Held {
    n: [f64; 2],
    t: [f64; 2],
    offset: f64,
    force: f64,
    by_offset: f64,
    by_rate: f64,
    /// Speed of the offset across itself.
    passing: f64,
    drag_by_force: f64,
    drag_by_rate: f64,
    arm: [f64; 2],
    eccentric: [f64; 2],
    /// As of the bearing, and by how much of the largest eccentricity that is.
    across: [f64; 2],
    /// Force at rest, and its derivatives xx, xy, yy.
    pressed: [f64; 2],
    elastic: [f64; 3],
}

/// The bearings of one crank.
struct Sprung {
    held: ArrayVec<Held, WHEELS>,
    seat: [f64; 2],
    /// Springs that deflect and their deflection; `None`: nothing does.
    yielding_cranks: Option<(Springs, Deflection)>,
    throw_m: f64,
    per_output: f64,
    /// Row of the first disc's place.
    first: usize,
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn left([x, y]: [f64; 2]) -> [f64; 2] {
    [-y, x]
}

/// a p + b q.
fn sum(a: f64, p: [f64; 2], b: f64, q: [f64; 2]) -> [f64; 2] {
    [a * p[0] + b * q[0], a * p[1] + b * q[1]]
}

impl Sprung {
    /// Visits the rows that something moves, with the slope of their force or moment: all discs do through what gives way.
    fn moved(
        &self,
        cranks: &CrankSet,
        seat: [f64; 2],
        of: impl Fn(usize, &Held) -> Move,
        mut visit: impl FnMut(usize, f64),
    ) {
        // How an eccentric's way across moves as its crank turns, and the offset with it where the mesh has given way.
        let across_of = |held: &Held, turned: f64| left(held.across).map(|x| turned * x);
        let turn = self.yielding_cranks.map_or(0.0, |(_, [_, _, turn])| turn);
        let way_of =
            |held: &Held, moves: &Move| sum(1.0, moves.way, -turn, across_of(held, moves.turned));
        let given = self.yielding_cranks.map_or([0.0; 3], |(springs, _)| {
            let mut force = [0.0; 3];
            for (i, held) in self.held.iter().enumerate() {
                let moves = of(i, held);
                let ([x, y], [xx, xy, yy]) = (way_of(held, &moves), held.elastic);
                let push = [xx * x + xy * y, xy * x + yy * y];
                let turned = across_of(held, moves.turned);
                force[0] += push[0];
                force[1] += push[1];
                force[2] += dot(held.across, push) + dot(turned, held.pressed);
            }
            let (springs, force) = cranks.held(springs, force);
            springs.solve(force)
        });
        let [x, y, further] = given;
        let (mut all, mut pushes, mut moment) = ([0.0; 2], [0.0; 2], 0.0);
        for (i, held) in self.held.iter().enumerate() {
            let moves = of(i, held);
            let way = sum(1.0, way_of(held, &moves), -further, held.across);
            let way = [way[0] - x, way[1] - y];
            let across = dot(way, held.t) / held.offset;
            let faster = dot(moves.faster, held.n) + held.passing * across;
            let grown = held.by_offset * dot(way, held.n) + held.by_rate * faster;
            let push = sum(grown, held.n, held.force * across, held.t);
            let force = held.n.map(|n| held.force * n);
            let drag = held.drag_by_force * grown + held.drag_by_rate * moves.turning;
            visit(
                OUTPUT + 1 + i,
                drag - cross(moves.arm, force) - cross(held.arm, push),
            );
            visit(self.first + 2 * i, -push[0]);
            visit(self.first + 2 * i + 1, -push[1]);
            all = sum(1.0, all, 1.0, force);
            pushes = sum(1.0, pushes, 1.0, push);
            let eccentric = sum(moves.turned, left(held.eccentric), further, held.across);
            moment += cross(eccentric, force) + cross(held.eccentric, push) - drag;
        }
        let on_output = cross(seat, all) + cross(self.seat, pushes);
        visit(OUTPUT, on_output + self.per_output * moment);
    }
}

impl CrankSet {
    /// A crank's bearings with their derivatives; those that do not carry have none.
    fn sprung(&self, crank: usize, bearings: &OfCrank, given: Deflection) -> Sprung {
        let mut springs = self.springs();
        let held = bearings.iter().enumerate().map(|(i, bearing)| {
            let law = self.law(i, crank);
            let [dx, dy] = bearing.load.offset_m;
            let offset = dx.hypot(dy);
            let (n, by) = match offset > 0.0 {
                true => ([dx / offset, dy / offset], offset),
                false => ([1.0, 0.0], 1.0),
            };
            let t = left(n);
            let [force, by_offset, by_rate] = law.derivatives(offset, bearing.load.rate);
            let (pressed, elastic) = pressed(&law, bearing.load.offset_m);
            springs.add(elastic, bearing.across);
            let [drag_by_force, drag_by_rate] = law.drag_slopes(force, bearing.load.turning);
            Held {
                n,
                t,
                offset: by,
                force,
                by_offset,
                by_rate,
                passing: dot(bearing.velocity, t),
                drag_by_force,
                drag_by_rate,
                arm: bearing.arm,
                eccentric: bearing.eccentric,
                across: bearing.across,
                pressed,
                elastic,
            }
        });
        let held = held.collect();
        Sprung {
            held,
            seat: [0.0; 2],
            yielding_cranks: (self.support.is_some() || self.mesh.is_some())
                .then_some((springs, given)),
            throw_m: self.throw_m,
            per_output: 1.0 + self.teeth_ratio,
            first: 0,
        }
    }

    /// Adds how all of them change: [`add_loads`](Self::add_loads) by everything that is free, and by the time.
    pub(crate) fn add_jacobian(&self, bodies: &[BodyState], derivatives: &mut Jacobian) {
        let layout = self.layout;
        let first = places(layout, derivatives);
        let Some(position) = &mut derivatives.position else {
            return;
        };
        let (rate, time) = (&mut derivatives.rate, &mut derivatives.time);
        let (input, output) = (bodies[Layout::INPUT].rate, bodies[Layout::OUTPUT].rate);
        let per_output = 1.0 + self.teeth_ratio;
        let per_input = -self.teeth_ratio * input;
        let turning = per_output * output + per_input;
        let mut found = OfCrank::new();
        for (crank, body) in layout.internal_bodies().enumerate() {
            let given = self.crank(bodies, crank, &mut found);
            let seat = [bodies[body].x, bodies[body].y];
            let sprung = Sprung {
                seat,
                first,
                ..self.sprung(crank, &found, given)
            };
            for (wheel, body) in layout.wheel_bodies().enumerate() {
                let only = |moves: Move| {
                    move |i: usize, _: &Held| if i == wheel { moves } else { Move::default() }
                };
                for (k, axis) in AXES.into_iter().enumerate() {
                    let column = first + 2 * wheel + k;
                    let way = Move {
                        way: axis,
                        ..Move::default()
                    };
                    let faster = Move {
                        faster: axis,
                        ..Move::default()
                    };
                    sprung.moved(self, [0.0; 2], only(way), |row, x| {
                        position.add(row, column, x)
                    });
                    sprung.moved(self, [0.0; 2], only(faster), |row, x| {
                        rate.add(row, column, x)
                    });
                }
                let (column, spin) = (OUTPUT + 1 + wheel, bodies[body].rate);
                let arm = sprung.held[wheel].arm;
                let turned = Move {
                    way: left(arm),
                    faster: arm.map(|x| -spin * x),
                    arm: left(arm),
                    ..Move::default()
                };
                let spun = Move {
                    faster: left(arm),
                    turning: 1.0,
                    ..Move::default()
                };
                sprung.moved(self, [0.0; 2], only(turned), |row, x| {
                    position.add(row, column, x);
                });
                sprung.moved(self, [0.0; 2], only(spun), |row, x| {
                    rate.add(row, column, x)
                });
            }
            // By the output the seats move as well as the eccentrics, by the time these alone.
            let throw = sprung.throw_m;
            let moving = |eccentric_centres: f64, by: f64| {
                move |_: usize, held: &Held| Move {
                    way: sum(-eccentric_centres, left(seat), -by * throw, held.across),
                    // The eccentric before it gave way is R-90 of that.
                    faster: sum(
                        eccentric_centres * output,
                        seat,
                        -turning * by * throw,
                        left(held.across),
                    ),
                    turned: by,
                    ..Move::default()
                }
            };
            let spun = |_: usize, held: &Held| Move {
                faster: sum(-1.0, left(seat), -per_output * throw, held.across),
                turning: -per_output,
                ..Move::default()
            };
            sprung.moved(self, left(seat), moving(1.0, per_output), |row, x| {
                position.add(row, OUTPUT, x);
            });
            sprung.moved(self, [0.0; 2], spun, |row, x| rate.add(row, OUTPUT, x));
            sprung.moved(self, [0.0; 2], moving(0.0, per_input), |row, x| {
                time[row] += x
            });
        }
    }
}
