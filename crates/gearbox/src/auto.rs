//! `integrator = "auto"`: the method that a scene's forces ask for, and why.

use pinwheel_mbs::integrators::METHODS;

use crate::load_course;
use crate::scene::{Detection, FrictionLaw, Scene};

pub use pinwheel_scene::names::AUTO;

/// Relaxations of a spin within a step, above which a step is not fixed but follows the tolerance. `imex2` damps
/// what relaxes within a step whatever its rate, but lighter sleeves also follow the contacts ever more closely: its
/// error is 0.1 % at 4 (the paper's sleeves with friction), 0.25 % at some 100, and 1 % at 4e6.
const MOST_RELAXATIONS: f64 = 1000.0;

/// A method and the reason for it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Choice {
    /// Name of the method.
    pub integrator: String,
    /// Why, one sentence.
    pub reason: String,
}

/// The integrator that a run of `scene` uses.
#[must_use]
pub fn integrator(scene: &Scene) -> Choice {
    let named = &scene.solver.integrator;
    if named != AUTO {
        return Choice {
            integrator: named.clone(),
            reason: "named by the scene".to_owned(),
        };
    }
    let registered = |name: &str| METHODS.iter().any(|method| method.name == name);
    let contact = &scene.contact;
    let rubs = contact.friction_coefficient > 0.0;
    let (name, reason) = if rubs && contact.friction_law == FrictionLaw::Adams {
        let reason = "friction that falls with speed is no convex problem, so it is followed explicitly, \
                      with steps from the tolerance where that is possible";
        let name = if registered("dopri5") {
            "dopri5"
        } else {
            "rk4"
        };
        (name, reason.to_owned())
    } else if rubs {
        let rate = friction_rate(scene);
        let step = scene.solver.step_s;
        // Forces that jump from point to point would only shorten adaptive steps.
        let smooth = contact.detection == Detection::Exact;
        if smooth && rate * step > MOST_RELAXATIONS && registered("imex2-adaptive") {
            let reason = format!(
                "friction relaxes the sleeves' spins at about {rate:.1e} 1/s, {:.0e} times within the scene's step of \
                 {step:.1e} s: implicitly, with steps from solver.tolerance = {:.1e}",
                rate * step,
                scene.solver.tolerance
            );
            return Choice {
                integrator: "imex2-adaptive".to_owned(),
                reason,
            };
        }
        let reason = format!(
            "friction relaxes the sleeves' spins at about {rate:.1e} 1/s, which explicit methods must follow with \
             steps below {:.1e} s; imex2 treats it implicitly at the scene's step of {step:.1e} s",
            2.0 / rate
        );
        ("imex2", reason)
    } else if contact.detection == Detection::Points {
        let reason = "without friction nothing is stiff, and forces that jump from point to point \
                      would only shorten the steps of an adaptive method";
        ("rk4", reason.to_owned())
    } else if registered("dopri5") {
        let reason = format!(
            "without friction the forces are smooth between contacts: order five with steps from \
             solver.tolerance = {:.1e}, whatever the stiffness",
            scene.solver.tolerance
        );
        ("dopri5", reason)
    } else {
        let reason = "without friction nothing is stiff: order four at the scene's step";
        ("rk4", reason.to_owned())
    };
    Choice {
        integrator: name.to_owned(),
        reason,
    }
}

/// Rate mu F q^2/(v_s J) of the faster kind of sleeve under the largest static force
/// (4 T/(e zs zk) a wheel, and 4 T/(zi R_w)), 1/s: how fast friction relaxes a spin.
#[must_use]
pub fn friction_rate(scene: &Scene) -> f64 {
    let (gear, contact, mass) = (&scene.gear, &scene.contact, &scene.mass);
    let torque = load_course::largest(&scene.drive) / gear.wheels as f64;
    let lever = gear.eccentricity_m * gear.lobes() as f64;
    let external = 4.0 * torque / (lever * gear.external_sleeves as f64);
    let internal = 4.0 * torque / (gear.internal_circle_radius_m * gear.internal_sleeves as f64);
    let rate = |force: f64, radius: f64, moment: f64| {
        contact.friction_coefficient * force * radius * radius
            / (contact.friction_ramp_m_s * moment)
    };
    rate(
        external,
        gear.external_sleeve_radius_m,
        mass.external_sleeve.moment_kg_m2,
    )
    .max(rate(
        internal,
        gear.internal_sleeve_radius_m,
        mass.internal_sleeve.moment_kg_m2,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_follows_what_the_scene_holds() {
        let mut scene = Scene::paper();
        assert_eq!(integrator(&scene).integrator, "rk2", "named");
        scene.solver.integrator = AUTO.to_owned();
        let smooth = integrator(&scene).integrator;
        assert!(["dopri5", "rk4"].contains(&smooth.as_str()));
        scene.contact.detection = Detection::Points;
        assert_eq!(integrator(&scene).integrator, "rk4");
        scene.contact.friction_coefficient = 0.1;
        assert_eq!(integrator(&scene).integrator, "imex2");
        scene.mass.external_sleeve.moment_kg_m2 = 1e-11;
        assert_eq!(integrator(&scene).integrator, "imex2", "points");
        scene.contact.detection = Detection::Exact;
        assert_eq!(integrator(&scene).integrator, "imex2-adaptive");
        scene.contact.friction_law = FrictionLaw::Adams;
        assert_eq!(integrator(&scene).integrator, "dopri5");
    }

    /// By hand: 6.5e5 1/s for a sleeve of the paper at 100 N; the static 65 N give two thirds of it.
    #[test]
    fn friction_rate_of_the_paper() {
        let mut scene = Scene::paper();
        scene.contact.friction_coefficient = 0.1;
        let rate = friction_rate(&scene);
        assert!((rate / 6.5e5 - 1.0).abs() < 0.5, "{rate}");
    }
}
