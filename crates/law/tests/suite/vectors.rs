//! Test vectors for authors of solvers equal the results of the law.

#[path = "../../examples/vectors.rs"]
#[allow(unreachable_pub, reason = "an example's main file")]
mod example;

use std::collections::BTreeMap;
use std::path::Path;

/// Reads rows by their names, with their numbers.
fn read(text: &str, names: usize) -> BTreeMap<String, Vec<f64>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let rows = reader.records().map(|row| row.expect("a row"));
    rows.map(|row| {
        let name: Vec<&str> = row.iter().take(names).collect();
        let values = row.iter().skip(names).map(|x| x.parse().expect("a number"));
        (name.join(","), values.collect())
    })
    .collect()
}

#[test]
fn regress_vectors_are_what_the_law_gives() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../reference/law-vectors");
    let stored = |name: &str| std::fs::read_to_string(folder.join(name)).expect(name);
    let now = example::files().expect("forces");
    for (name, text) in &now {
        if *name == "cases.csv" {
            assert_eq!(
                *text,
                stored(name),
                "write them anew: see the folder's README"
            );
            continue;
        }
        let names = if *name == "bodies.csv" { 2 } else { 3 };
        let (now, was) = (read(text, names), read(&stored(name), names));
        assert_eq!(
            now.keys().collect::<Vec<_>>(),
            was.keys().collect::<Vec<_>>(),
            "{name}"
        );
        for (row, values) in &now {
            for (k, (now, was)) in values.iter().zip(&was[row]).enumerate() {
                // Positions to 1e-15 m; forces have a slope of 1e6 N/m and more, so 1e-9 N. Other instruction sets differ by
                // 3e-12 relative at most.
                let near =
                    (now - was).abs() <= 1e-9 * was.abs() + 1e-9 * f64::from(u8::from(k > 1));
                assert!(near, "{name} {row} column {k}: {now:e}, stored {was:e}");
            }
        }
    }
    let (_, contacts) = &now[2];
    for (case, ..) in example::cases() {
        let touching = contacts
            .lines()
            .filter(|line| line.starts_with(&format!("{case},")))
            .count();
        assert!(touching >= 6, "{case}: {touching} contacts");
    }
}

/// Loads on the bodies follow from the contacts by hand: signs, points of attack and order as documented.
#[test]
fn forces_on_bodies_are_those_of_their_contacts() {
    let files = example::files().expect("forces");
    let (bodies, contacts) = (read(&files[1].1, 2), read(&files[2].1, 3));
    let mut sums: BTreeMap<String, [f64; 3]> =
        bodies.keys().map(|key| (key.clone(), [0.0; 3])).collect();
    for (row, c) in &contacts {
        let parts: Vec<&str> = row.split(',').collect();
        let (case, wheel, sleeve) = (
            parts[0],
            parts[1].parse::<usize>().expect("wheel"),
            parts[2],
        );
        let [x, y, nx, ny] = [c[0], c[1], c[2], c[3]];
        let (normal, friction, along) = (c[8], c[9], c[10]);
        let centre = &bodies[&format!("{case},{sleeve}")];
        // t = (-ny, nx); the part along the profile acts at the pin's centre, the other force at the point.
        let mut add = |body: String, at: [f64; 2], fx: f64, fy: f64| {
            let own = &bodies[&body];
            let sum = sums.get_mut(&body).expect("a body");
            sum[0] += fx;
            sum[1] += fy;
            sum[2] += (at[0] - own[0]) * fy - (at[1] - own[1]) * fx;
        };
        let (fx, fy) = (-normal * nx - friction * ny, -normal * ny + friction * nx);
        let (ax, ay) = (-along * ny, along * nx);
        for (body, sign) in [(sleeve.to_owned(), 1.0), ((wheel + 2).to_string(), -1.0)] {
            add(format!("{case},{body}"), [x, y], sign * fx, sign * fy);
            add(
                format!("{case},{body}"),
                [centre[0], centre[1]],
                sign * ax,
                sign * ay,
            );
        }
    }
    for (body, sum) in &sums {
        let given = &bodies[body][6..];
        for (sum, given) in sum.iter().zip(given) {
            // Rounding of sums of some hundred newtons with levers of a tenth of a metre.
            assert!((sum - given).abs() < 1e-9, "{body}: {sum} {given}");
        }
    }
}
