//! Linear spring that represents a law.

use pinwheel_engines::spring::*;
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;

fn frequency(change: impl Fn(&mut Scene)) -> Result<f64, String> {
    let mut scene = Scene::paper();
    change(&mut scene);
    let gearbox = Gearbox::new(&scene.clone().check().unwrap()).unwrap();
    let spring = contact_spring(&gearbox, &mut gearbox.contact_field().unwrap())?;
    Ok(spring.frequency_hz)
}

/// Both stages have the law's secants: k = m w^2 with the mass assigned to ring pins.
#[test]
fn both_stages_are_as_stiff_as_the_law() {
    let gearbox = Gearbox::new(&Scene::paper().check().unwrap()).unwrap();
    let spring = contact_spring(&gearbox, &mut gearbox.contact_field().unwrap()).unwrap();
    let [external, internal] = spring.stiffness_n_m;
    // At most K^(2/3) F^(1/3) of the paper's contacts, and less at lower loads.
    assert!((0.7e6..3e6).contains(&external), "{external:e}");
    assert!((1.5e6..6e6).contains(&internal), "{internal:e}");
    let [outer, inner] = spring.masses_kg.unwrap();
    assert!(outer > 0.0 && inner < 0.048);
}

/// For K delta^1.5 at a given force k = K^(2/3) F^(1/3), so f ~ K^(1/3), where S(delta) = 1, as nearly everywhere here. The
/// load shares of the pins depend slightly on the stiffness.
#[test]
fn follows_the_hertzian_exponent() {
    let soft = frequency(|scene| scene.contact.stiffness_multiplier = 1e-2).unwrap();
    let softer = frequency(|scene| scene.contact.stiffness_multiplier = 0.25e-2).unwrap();
    let ratio = soft / softer;
    assert!((ratio - 4.0_f64.cbrt()).abs() < 0.02 * ratio, "{ratio}");
}

/// The secant stiffness of an output pin at half its largest static force is 1e6 to 1e7 N/m
/// and the effective masses of light pins are about 3 g: some 4000 Hz.
#[test]
fn of_the_paper_is_some_kilohertz() {
    let f = frequency(|_| ()).unwrap();
    assert!((3500.0..4700.0).contains(&f), "{f}");
}

#[test]
fn load_direction_and_no_load() {
    let f = frequency(|scene| scene.drive.output_torque_n_m *= -1.0).unwrap();
    assert!((3500.0..4700.0).contains(&f), "{f}");
    assert!(
        frequency(|scene| scene.drive.output_torque_n_m = 0.0)
            .unwrap()
            .is_finite()
    );
}

#[test]
fn refuses_contacts_that_carry_nothing() {
    let refusal = frequency(|scene| scene.contact.stiffness_multiplier = 1e-9).unwrap_err();
    assert!(
        refusal.contains("contact.stiffness_multiplier"),
        "{refusal}"
    );
}

/// An oversized hole is reported as such, not as a soft contact.
#[test]
fn blames_the_hole_where_it_is_wrong() {
    let refusal = frequency(|scene| scene.gear.hole_radius_m += 4.5e-3).unwrap_err();
    assert!(refusal.contains("gear.hole_radius_m"), "{refusal}");
    assert!(!refusal.contains("stiffness"), "{refusal}");
}
