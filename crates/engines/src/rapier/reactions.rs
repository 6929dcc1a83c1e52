//! Forces of the revolutes from the motion of the bodies: mass times acceleration equals the contact forces on a body plus the
//! force of its own revolute, less the forces of the revolutes of the bodies it carries.
//!
//! rapier's impulses also contain the position corrections of its solver. The force here is the one that the computed motion
//! requires.

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Layout;

use super::sums::Evaluation;
use super::world::World;

/// Writes the force of the revolute that carries each body, N, ground frame, in [`Layout`] order; the sample's contact forces
/// are `sums`, and the last step is centred at the sample.
pub fn reactions(gearbox: &Gearbox, world: &World, sums: &Evaluation, into: &mut Vec<[f64; 2]>) {
    let layout = gearbox.layout;
    into.clear();
    into.resize(layout.bodies(), [0.0; 2]);
    let mass = &gearbox.scene.mass;
    let carried = [
        (
            layout.wheel_bodies(),
            mass.wheel.mass_kg,
            Some(Layout::INPUT),
        ),
        (layout.external_bodies(), mass.external_sleeve.mass_kg, None),
        (
            layout.internal_bodies(),
            mass.internal_sleeve.mass_kg,
            Some(Layout::OUTPUT),
        ),
    ];
    for (bodies, mass, carrier) in carried {
        for body in bodies {
            let ([ax, ay], [fx, fy]) = (world.acceleration(body), sums.on_body(body));
            into[body] = [mass * ax - fx, mass * ay - fy];
            if let Some(carrier) = carrier {
                into[carrier][0] += into[body][0];
                into[carrier][1] += into[body][1];
            }
        }
    }
    let [ax, ay] = world.acceleration(Layout::OUTPUT);
    into[Layout::OUTPUT][0] += mass.output_shaft.mass_kg * ax;
    into[Layout::OUTPUT][1] += mass.output_shaft.mass_kg * ay;
}
