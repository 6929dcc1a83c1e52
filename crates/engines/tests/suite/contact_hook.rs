//! Pinwheel's forces in rapier's contact solver.

use pinwheel_engines::rapier::contact_hook::*;
use pinwheel_engines::rapier::march::Contacts as _;
use pinwheel_engines::rapier::world::World;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::contacts::PairContact;
use pinwheel_mbs::Wrench;

/// Forces that rapier transmits in a step, from its impulses, are those of the law, with friction that is bounded and opposes
/// sliding.
#[test]
fn transmits_the_law_and_bounds_friction() {
    let mut scene = pinwheel_scene::Scene::paper();
    scene.contact.friction_coefficient = 0.1;
    let gearbox = &Gearbox::new(&scene.check().unwrap()).unwrap();
    let step_s = gearbox.scene.solver.step_s;
    let mut world = World::new(gearbox, step_s, SWEEPS);
    let field = gearbox.contact_field().unwrap();
    let mut hooked = Hooked::new(gearbox, field, &mut world, step_s);
    let (mut now, mut sliding) = (Vec::new(), 0);
    for step in 0..300 {
        world.at_node(&mut now);
        let mut loads = vec![Wrench::default(); gearbox.layout.bodies()];
        loads[pinwheel_scene::Layout::OUTPUT].moment = 22.0;
        let share = world.share();
        hooked.step(&mut world, &now, &mut loads).unwrap();
        let mut asked: Vec<PairContact> = Vec::new();
        gearbox
            .contact_field()
            .unwrap()
            .touching(&now, &mut |pair| asked.push(*pair));
        let mut got = Vec::new();
        hooked.transmitted(&world, share, &mut |pair| got.push(*pair));
        for pair in asked.iter().filter(|pair| pair.normal_force_n > 0.0) {
            let point = got
                .iter()
                .find(|point| point.wheel == pair.wheel && point.sleeve == pair.sleeve)
                .unwrap_or_else(|| panic!("step {step}: {pair:?} is missing"));
            let (force, wanted) = (point.normal_force_n, pair.normal_force_n);
            assert!(
                (force - wanted).abs() < 1e-6 * wanted + 1e-5,
                "step {step}: {force} for {wanted}"
            );
            assert!(point.friction_force_n.abs() <= 0.1 * force * (1.0 + 1e-9));
            // Clear sliding is opposed by all of mu F_n.
            if pair.tangential_rate_m_s.abs() > 0.05 {
                let full = -0.1 * force * pair.tangential_rate_m_s.signum();
                assert!(
                    (point.friction_force_n - full).abs() < 1e-9 * force + 1e-5,
                    "{point:?} {full}"
                );
                sliding += 1;
            }
        }
        assert_eq!(got.len(), asked.len());
    }
    assert!(sliding > 100, "only {sliding} sliding contacts");
}
