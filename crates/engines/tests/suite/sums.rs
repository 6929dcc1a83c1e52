//! Sums of contact forces.

use pinwheel_engines::rapier::sums::*;
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::{Layout, Sleeve};

#[test]
fn driver_torque_is_the_virtual_work_of_the_wheels() {
    let mut sums = Evaluation::new(Layout {
        wheels: 2,
        external_sleeves: 3,
        internal_sleeves: 2,
    });
    let mut bodies = vec![BodyState::default(); sums.layout.bodies()];
    (bodies[2].x, bodies[3].x) = (0.5, -0.5);
    // 10 N upwards on the pins: the discs are pushed down, 5 N m each, then one of them less.
    sums.add(0, Sleeve::External(1), [0.0, 10.0]);
    sums.add(1, Sleeve::Internal(1), [0.0, 10.0]);
    assert_eq!(sums.driver_torque(&bodies, false), 0.0);
    sums.add(1, Sleeve::Internal(1), [3.0, -4.0]);
    assert_eq!(sums.driver_torque(&bodies, false), 0.5 * 4.0);
    assert_eq!(
        sums.sleeves,
        [[0.0; 2], [0.0, 10.0], [0.0; 2], [0.0; 2], [3.0, 6.0]]
    );
    // A seal on the input shaft, and the force of a bearing on it.
    let mut loads = vec![Wrench::default(); bodies.len()];
    (loads[Layout::INPUT].moment, loads[2].fy, loads[5].fx) = (-0.25, 4.0, 7.0);
    sums.take(&loads);
    assert_eq!(sums.driver_torque(&bodies, false), 0.25 - 0.5 * 4.0);
    assert_eq!(sums.driver_torque(&bodies, true), 0.25);
    assert_eq!(sums.sleeves[1], [7.0, 0.0]);
}
