//! Contacts of the output pins with the holes.

use pinwheel_contact::{Complex, ComplexLanes, Lanes, PinLaw, Real};
use pinwheel_mbs::BodyState;
use pulp::Simd;

use super::{Evaluation, JointSpace, present, react, split};
use crate::Layout;
use crate::contacts::lanes::shapes::Shapes;

impl JointSpace {
    #[inline(always)]
    pub(super) fn internal<S: Simd, const LOADS: bool>(
        &mut self,
        simd: S,
        law: &PinLaw,
        shapes: &Shapes,
        bodies: &[BodyState],
        output: Complex,
        sums: &mut Evaluation<S>,
    ) {
        let c = |x: f64| Lanes::splat(simd, x);
        let count = self.layout.internal_sleeves;
        if self.segments[1].is_empty() {
            for number in 0..self.wheels.len() {
                split::<S>(&mut self.segments[1], number, 0, count, count);
            }
        }
        let over_input = c(bodies[Layout::OUTPUT].rate - bodies[Layout::INPUT].rate);
        let input_rate = c(bodies[Layout::INPUT].rate);
        let output_rate = c(bodies[Layout::OUTPUT].rate);
        let output = ComplexLanes::splat(simd, output);
        let stiffness = c(shapes.hole_stiffness);
        for &pair in &self.segments[1] {
            let (one, two) = (&self.wheels[pair[0].wheel], &self.wheels[pair[1].wheel]);
            let first = &shapes.holes[pair[0].wheel];
            let second = &shapes.holes[pair[1].wheel];
            let hole = ComplexLanes::new(
                Lanes::load_pair(simd, [&first.x[pair[0].from..], &second.x[pair[1].from..]]),
                Lanes::load_pair(simd, [&first.y[pair[0].from..], &second.y[pair[1].from..]]),
            ) * ComplexLanes::splat_pair(simd, [one.turn, two.turn]);
            let sleeve = self.points.load_pair(simd, pair) * output;
            let offset = sleeve - hole - ComplexLanes::splat_pair(simd, [one.centre, two.centre]);
            let squared = offset.dot(offset);
            let inverse = squared.inverse_sqrt();
            let depth = squared.mul_add(inverse, c(-shapes.clearance));
            let inside = c(0.0).less(depth).and(present(simd, pair));
            let normal = offset.scale(inverse);
            let (wheel_lever, output_lever) = (hole.cross(normal), sleeve.cross(normal));
            let wheel_rate = Lanes::splat_pair(simd, [one.rate, two.rate]);
            let closing = if LOADS && self.floats {
                let apart = output_lever * output_rate - wheel_lever * wheel_rate;
                apart - self.velocities(simd, bodies, pair).dot(normal)
            } else {
                wheel_lever.mul_add(input_rate - wheel_rate, output_lever * over_input)
            };
            let force = if sums.asked {
                let observed = law.observed(stiffness, depth, closing);
                sums.add_energy(observed, closing, inside)
            } else {
                law.force(stiffness, depth, closing)
            };
            sums.on_output = sums.on_output - (output_lever * force).only(inside);
            let mut moment = (wheel_lever * force).only(inside);
            let mut push = normal.scale(-force).only(inside);
            if let Some(pins) = &self.pins[1] {
                let radius = c(self.sleeve_radii[1]) - depth;
                // (W - c).n, W.n and the velocity of c along t.
                let on_wheel = hole.dot(normal) + c(self.sleeve_radii[1] + shapes.clearance);
                let on_output = sleeve.dot(normal) + radius;
                let carried = if LOADS && self.floats {
                    self.velocities(simd, bodies, pair).dot(normal.turned())
                } else {
                    (on_output - on_wheel) * input_rate
                };
                let passing = on_output * output_rate - on_wheel * wheel_rate - carried;
                let drag = pins
                    .along_lanes(simd, [force, radius, passing])
                    .only(inside);
                sums.on_output = sums.on_output + drag * on_output.only(inside);
                moment = moment - drag * on_wheel.only(inside);
                push = push + normal.turned().only(inside).scale(drag);
                if LOADS && !self.floats {
                    let lever = (on_output - on_wheel).only(inside);
                    sums.on_input = sums.on_input - drag * lever;
                }
                sums.on_pins = sums.on_pins + drag * radius.only(inside);
                if sums.asked {
                    sums.rubbed = sums.rubbed - drag * passing.only(inside);
                }
            }
            let moment = moment.sums();
            self.wheels[pair[0].wheel].moment += moment[0];
            self.wheels[pair[1].wheel].moment += moment[1];
            if LOADS {
                if !self.floats {
                    let lever = output_lever - wheel_lever;
                    sums.on_input = sums.on_input + (lever * force).only(inside);
                }
                if sums.on_sleeves {
                    self.forces[1].add_pair(pair, push);
                }
                react(&mut self.wheels, pair, push);
            }
        }
    }
}
