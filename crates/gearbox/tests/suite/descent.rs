//! Descent of floating discs to an equilibrium.

use std::sync::atomic::{AtomicU64, Ordering};

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::{PairContact, PairField};
use pinwheel_gearbox::statics::Statics;
use pinwheel_mbs::{BodyState, Evaluation};
use pinwheel_scene::{Layout, Scene, Sleeve};

/// Largest rotation of a disc from its ideal mesh at any evaluation, rad, as bits.
static FARTHEST_SEEN: AtomicU64 = AtomicU64::new(0);

struct Watched(Box<dyn PairField>, Gearbox);

impl PairField for Watched {
    fn work_from_angles(&self) -> bool {
        self.0.work_from_angles()
    }

    fn have_derivatives(&self) -> bool {
        self.0.have_derivatives()
    }

    fn evaluate(&mut self, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        let (layout, geometry) = (self.1.layout, &self.1.geometry);
        for (i, body) in layout.wheel_bodies().enumerate() {
            let ideal = geometry.ideal_wheel_angle(i, bodies[Layout::INPUT].angle);
            // Positive numbers and their bits have the same order.
            let turned = (bodies[body].angle - ideal).abs().to_bits();
            FARTHEST_SEEN.fetch_max(turned, Ordering::Relaxed);
        }
        self.0.evaluate(bodies, request);
    }

    fn touching(&mut self, bodies: &[BodyState], visit: &mut dyn FnMut(&PairContact)) {
        self.0.touching(bodies, visit);
    }

    fn nearest(&mut self, bodies: &[BodyState], wheel: usize, sleeve: Sleeve) -> PairContact {
        self.0.nearest(bodies, wheel, sleeve)
    }
}

/// Newton steps within the free play are bounded under a light load. Unbounded ones crossed many teeth, where every pin
/// requires a search along the entire profile, and equilibria took 25 times as long.
#[test]
fn hard_steps_through_play_stay_within_a_tooth() {
    let sets = [
        "gear.external_sleeves=40",
        "gear.shortening=0.646",
        "gear.eccentricity_m=0.00084",
        "gear.external_sleeve_radius_m=0.00265",
        "gear.internal_sleeves=8",
        "gear.internal_sleeve_radius_m=0.01",
        "gear.internal_circle_radius_m=0.03",
        "gear.hole_radius_m=0.01084",
        "contact.law=\"line-hertz\"",
        "contact.line_length_m=0.0078",
        "drive.output_torque_n_m=200",
        "gear.backlash_m=6e-5",
        "bearings.eccentric.stiffness_n_m=1e9",
        "bearings.eccentric.clearance_m=5e-6",
    ];
    let sets = sets.map(|set| set.parse().unwrap());
    let gearbox = Gearbox::new(&Scene::load("paper", &sets).unwrap()).unwrap();
    let mut statics = Statics::new(&gearbox).unwrap();
    let contacts = gearbox.bare_field().unwrap().contacts;
    statics.field.contacts = Box::new(Watched(contacts, gearbox.clone()));
    let light = 1e-4 * gearbox.load_torque(0.1);
    let mut near = None;
    for k in 0..20 {
        let balance = statics.track(&mut near, 0.1114 * f64::from(k), light);
        balance.unwrap();
    }
    let farthest = f64::from_bits(FARTHEST_SEEN.load(Ordering::Relaxed));
    let share = farthest * gearbox.geometry.lobes() / std::f64::consts::TAU;
    println!("{share:.3} of a pitch from the ideal mesh");
    assert!(share < 0.25, "{share}");
}
