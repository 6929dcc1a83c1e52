//! Sets every number of a scene, one at a time, to extreme values: it is refused by name, or the scene runs soundly.

use pinwheel_fuzz::targets;
use pinwheel_scene::Scene;
use pinwheel_scene::keys::{KEYS, Key, Kind, Range};

const VALUES: [&str; 16] = [
    "1e-320",
    "1e-307",
    "1e-100",
    "1e-12",
    "-0.0",
    "0",
    "-1e-307",
    "1e12",
    "1e100",
    "1e300",
    "-1e300",
    "inf",
    "nan",
    "9223372036854775807",
    "-9223372036854775808",
    "1.7976931348623157e308",
];

/// Returns the ends of a key's range, and their neighbours.
fn ends(kind: Kind) -> Vec<String> {
    match kind {
        Kind::Number(Range::From(low, high) | Range::Between(low, high)) => {
            let near = [low, 1.001 * low, 10.0 * low, 0.1 * high, 0.999 * high, high];
            near.map(|value| format!("{value:?}")).to_vec()
        }
        Kind::Count(low, high) => [low, low + 1, high - 1, high]
            .map(|count| count.to_string())
            .to_vec(),
        _ => Vec::new(),
    }
}

/// Returns settings that a key requires of other keys.
fn beside(key: &str) -> &'static str {
    match key {
        "bearings.sleeve_friction_coefficient" => return "bearings.sleeve_bore_m = 0.01\n",
        "bearings.sleeve_bore_m" => return "bearings.sleeve_friction_coefficient = 0.01\n",
        "structure.output_pin_diameter_m" => {
            return "bearings.internal_sleeves_held = \"one-end\"\n";
        }
        "structure.output_seat_length_m" => {
            return "bearings.internal_sleeves_held = \"one-end\"\nstructure.output_pin_diameter_m = 0.006\n";
        }
        "structure.plate_thickness_m" => return "structure.plate_radius_m = 0.02\n",
        "structure.plate_radius_m" => return "structure.plate_thickness_m = 0.005\n",
        _ if key.starts_with("temperature.") => return "contact.material = \"steel\"\n",
        _ => {}
    }
    match key.strip_prefix("bearings.eccentric.") {
        None | Some("stiffness_n_m") => "",
        Some("rollers") => "bearings.eccentric.roller_length_m = 0.01\n",
        Some("friction_coefficient") => {
            "bearings.eccentric.stiffness_n_m = 5e8\nbearings.eccentric.bore_m = 0.02\n"
        }
        Some("bore_m") => {
            "bearings.eccentric.stiffness_n_m = 5e8\nbearings.eccentric.friction_coefficient = 0.002\n"
        }
        Some("roller_length_m") => "bearings.eccentric.rollers = 16\n",
        Some(_) => "bearings.eccentric.stiffness_n_m = 5e8\n",
    }
}

/// Returns all numeric keys, each with its lines of a scene file and `@` for its value.
fn lines() -> Vec<(&'static Key, String)> {
    let number = |key: &&Key| matches!(key.kind, Kind::Number(_) | Kind::Count(..));
    let mut lines = Vec::new();
    for key in KEYS {
        if number(&key) {
            lines.push((key, format!("{}{} = @", beside(key.name), key.name)));
        }
        if let Kind::Tables(rows) = key.kind {
            for row in rows.iter().filter(number) {
                let name = |key: &Key| key.name.rsplit('.').next().unwrap_or(key.name).to_owned();
                let cells = rows.iter().filter(number).map(|other| {
                    let value = if other.name == row.name { "@" } else { "1e-5" };
                    format!("{} = {value}", name(other))
                });
                let cells: Vec<String> = cells.collect();
                lines.push((row, format!("{} = [{{ {} }}]", key.name, cells.join(", "))));
            }
        }
    }
    lines
}

#[test]
fn bad_input_every_number_at_its_ends() {
    let (mut refused, mut ran, mut total) = (0, 0, 0);
    for preset in ["backlash-0.6", "paper-friction", "rv-40e-like"] {
        for (key, line) in lines() {
            // Only an RV gear has cranks.
            if key.name.starts_with("cranks.") != (preset == "rv-40e-like") {
                continue;
            }
            let own = ends(key.kind);
            for value in VALUES.iter().copied().chain(own.iter().map(String::as_str)) {
                let text = format!("base = \"{preset}\"\n{}\n", line.replace('@', value));
                total += 1;
                println!("{text}");
                match Scene::from_toml(&text, "/nonexistent/e.toml", &[]) {
                    Ok(_) => {
                        ran += usize::from(targets::scene(text.as_bytes()));
                        targets::first_steps(text.as_bytes());
                    }
                    Err(error) => {
                        let message = error.to_string();
                        let name = key.name.rsplit('.').next().unwrap_or(key.name);
                        // An end of the key's own range may contradict another key, which is named instead.
                        let clash = own.iter().any(|end| end == value) && message.contains('`');
                        assert!(clash || message.contains(name), "{text}{message}");
                        assert!(message.len() < 1000, "{message}");
                        refused += 1;
                    }
                }
            }
        }
    }
    println!("{total} scenes: {refused} refused, {ran} compiled");
    assert!(total > 1500 && ran > 100, "{total} {ran}");
}
