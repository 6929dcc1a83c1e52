//! Writes the test vectors of the contact law: states, contact points and forces for every law.
//!
//! `cargo run -p pinwheel-law --example vectors -- reference/law-vectors`; the folder's README describes the files.

use std::fmt::Write as _;
use std::path::PathBuf;

use pinwheel_contact::laws::LAWS;
use pinwheel_gearbox::Gearbox;
use pinwheel_law::numbers;
use pinwheel_mbs::{BodyState, Wrench};
use pinwheel_scene::Scene;

type Failure = Box<dyn std::error::Error>;

/// Returns name, preset and overrides of each case.
pub fn cases() -> Vec<(String, &'static str, Vec<String>)> {
    let set = |text: &str| vec![text.to_owned()];
    let laws = LAWS.iter().map(|law| {
        let name = format!("law-{}", law.name);
        (name, "paper", set(&format!("contact.law={}", law.name)))
    });
    let geometry = [
        "forty-pins",
        "one-wheel",
        "backlash-0.6",
        "eleven-pins",
        "steel",
    ];
    let geometry = geometry.map(|name| (name.to_owned(), name, Vec::new()));
    let friction = |law: &str| {
        let sets = [
            "contact.friction_coefficient=0.1".to_owned(),
            format!("contact.friction_law={law}"),
        ];
        (format!("friction-{law}"), "paper", sets.to_vec())
    };
    let points = (
        "points".to_owned(),
        "paper",
        set("contact.detection=points"),
    );
    let others = [friction("regularised"), friction("adams"), points];
    laws.chain(geometry).chain(others).collect()
}

/// Input as at the start of a run, output and discs twisted against it until pins are pressed in by some micrometres, and
/// all else moving a little differently from the ideal mesh.
fn pose(gearbox: &Gearbox) -> Vec<BodyState> {
    let turned = 0.0;
    let twist = 1.2e-5 / gearbox.scene.gear.lever_m();
    let mut states = gearbox.kinematic_states();
    let mechanism = gearbox.mechanism();
    let first_sleeve = gearbox.layout.external_bodies().start;
    for index in 0..states.len() {
        let uneven = 1.0 + 0.3 * (1.7 * index as f64).sin();
        let body = &mut states[index];
        body.angle = match index {
            0 => turned,
            1 => gearbox.geometry.ideal_output_angle(turned) + 2.5 * twist,
            _ if index < first_sleeve => {
                gearbox.geometry.ideal_wheel_angle(index - 2, turned) + twist * uneven
            }
            _ => 0.1 * uneven,
        };
        if index > 0 {
            body.rate *= 1.0 + 0.02 * uneven;
        }
        if index >= first_sleeve {
            body.rate += 0.5 * uneven;
        }
        let Some(pin) = mechanism.revolutes.iter().find(|pin| pin.child == index) else {
            continue;
        };
        let carrier = pin
            .parent
            .map_or_else(BodyState::default, |parent| states[parent]);
        let (s, c) = carrier.angle.sin_cos();
        let [u, v] = pin.parent_point;
        let (x, y) = (c * u - s * v, s * u + c * v);
        let body = &mut states[index];
        (body.x, body.y) = (carrier.x + x, carrier.y + y);
        (body.vx, body.vy) = (carrier.vx - carrier.rate * y, carrier.vy + carrier.rate * x);
    }
    states
}

/// Returns the files by name.
pub fn files() -> Result<Vec<(&'static str, String)>, Failure> {
    let mut list = "case,preset,set\n".to_owned();
    let mut bodies =
        "case,body,x_m,y_m,angle_rad,vx_m_s,vy_m_s,rate_rad_s,force_x_n,force_y_n,moment_n_m\n"
            .to_owned();
    let mut contacts = "case,wheel,sleeve_body,point_x_m,point_y_m,normal_x,normal_y,penetration_m,normal_rate_m_s,\
        tangential_rate_m_s,stiffness_n_m15,normal_force_n,friction_force_n,along_force_n\n"
        .to_owned();
    let row = |text: &mut String, head: String, values: &[f64]| {
        text.push_str(&head);
        for value in values {
            let _ = write!(text, ",{value:e}");
        }
        text.push('\n');
    };
    for (case, preset, sets) in cases() {
        let overrides: Result<Vec<_>, _> = sets.iter().map(|set| set.parse()).collect();
        let gearbox = Gearbox::new(&Scene::load(preset, &overrides?)?)?;
        let _ = writeln!(list, "{case},{preset},{}", sets.join(" "));
        let states = pose(&gearbox);
        let mut field = gearbox.contact_field()?;
        let mut loads = vec![Wrench::default(); states.len()];
        field.add_loads(&states, &mut loads);
        for (index, (state, load)) in states.iter().zip(&loads).enumerate() {
            let values = [&numbers(state)[..], &[load.fx, load.fy, load.moment]].concat();
            row(&mut bodies, format!("{case},{index}"), &values);
        }
        field.touching(&states, &mut |pair| {
            let head = format!(
                "{case},{},{}",
                pair.wheel,
                gearbox.layout.sleeve_body(pair.sleeve)
            );
            let [[x, y], [nx, ny]] = [pair.point, pair.normal];
            let values = [
                x,
                y,
                nx,
                ny,
                pair.penetration_m,
                pair.normal_rate_m_s,
                pair.tangential_rate_m_s,
                pair.stiffness,
                pair.normal_force_n,
                pair.friction_force_n,
                pair.along_force_n,
            ];
            row(&mut contacts, head, &values);
        });
    }
    Ok(vec![
        ("cases.csv", list),
        ("bodies.csv", bodies),
        ("contacts.csv", contacts),
    ])
}

#[allow(dead_code, reason = "the test reads the files and does not write them")]
fn main() -> Result<(), Failure> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    let folder = folder.ok_or("give the folder to write to")?;
    for (name, text) in files()? {
        std::fs::write(folder.join(name), text)?;
    }
    Ok(())
}
