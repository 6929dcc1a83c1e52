//! Draws the labelled figure of the paper's gear, from the geometry that the solver uses:
//! `cargo run -p pinwheel-gearbox --example figure > docs/gear.svg`
#![allow(
    clippy::print_stdout,
    reason = "a program whose result is what it prints"
)]

use std::error::Error;
use std::f64::consts::{FRAC_PI_4, TAU};

use pinwheel_contact::Complex;
use pinwheel_gearbox::Geometry;
use pinwheel_scene::{Gear, Scene};

/// Where millimetres of the gear land in the picture.
#[derive(Clone, Copy)]
struct View {
    centre: [f64; 2],
    per_mm: f64,
}

impl View {
    /// Picture coordinates (y down) of a point in metres (y up).
    fn at(self, p: Complex) -> [f64; 2] {
        let [x, y] = p.scale(1e3 * self.per_mm).to_array();
        [self.centre[0] + x, self.centre[1] - y]
    }

    fn circle(self, class: &str, centre: Complex, radius: f64) -> String {
        let [x, y] = self.at(centre);
        let r = 1e3 * self.per_mm * radius;
        format!("<circle class='{class}' cx='{x:.2}' cy='{y:.2}' r='{r:.2}'/>\n")
    }

    fn line(self, class: &str, from: Complex, to: Complex) -> String {
        let ([x1, y1], [x2, y2]) = (self.at(from), self.at(to));
        format!("<path class='{class}' d='M{x1:.2} {y1:.2}L{x2:.2} {y2:.2}'/>\n")
    }

    /// A label on the drawing; `symbol` may hold a subscript after `_`.
    fn label(self, symbol: &str, p: Complex) -> String {
        let [x, y] = self.at(p);
        format!(
            "<text class='symbol' x='{x:.1}' y='{y:.1}'>{}</text>\n",
            subscript(symbol)
        )
    }

    /// The wheel's profile C - q n, placed and turned as in the mesh.
    fn wheel(self, gear: &Gear, geometry: &Geometry, centre: Complex, turn: Complex) -> String {
        let points = 40 * (gear.external_sleeves - 1);
        let path: Vec<String> = (0..points)
            .map(|i| {
                let at = geometry.curve.at(TAU * i as f64 / points as f64);
                let profile = at.position - at.normal.scale(gear.external_sleeve_radius_m);
                let [x, y] = self.at(centre + turn * profile);
                format!("{x:.2} {y:.2}")
            })
            .collect();
        format!("<path class='wheel' d='M{}Z'/>\n", path.join("L"))
    }
}

fn subscript(symbol: &str) -> String {
    match symbol.split_once('_') {
        Some((letter, below)) => format!("{letter}<tspan class='sub' dy='7'>{below}</tspan>"),
        None => symbol.into(),
    }
}

/// A name in the margin with a line to what it names.
fn callout(text: &str, anchor: &str, at: [f64; 2], bend: [f64; 2], to: [f64; 2]) -> String {
    format!(
        "<path class='leader' d='M{:.1} {:.1}L{:.1} {:.1}'/><circle class='dot' cx='{2:.1}' cy='{3:.1}' r='4'/>\n\
         <text x='{}' y='{}' text-anchor='{anchor}'>{text}</text>\n",
        bend[0], bend[1], to[0], to[1], at[0], at[1],
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let gear = Scene::load("paper", &[])?.into_scene().gear;
    let geometry = Geometry::new(&gear)?;
    let (e, q, ring) = (
        gear.eccentricity_m,
        gear.external_sleeve_radius_m,
        geometry.curve.pitch_radius(),
    );
    let (hole, inner) = (gear.hole_radius_m, gear.internal_circle_radius_m);
    let axis = Complex::default();
    let wheel = Complex::unit(geometry.wheel_phases[0]).scale(e);
    let turn = Complex::unit(geometry.ideal_wheel_angle(0, 0.0));
    let main = View {
        centre: [400.0, 418.0],
        per_mm: 4.55,
    };

    let mut svg = String::from(HEAD);
    svg += &main.circle("housing", axis, ring + 1.9 * q);
    svg += &main.circle("cavity", axis, ring + 0.45 * q);
    svg += &main.wheel(&gear, &geometry, wheel, turn);
    for centre in &geometry.hole_centres[0] {
        svg += &main.circle("hole", wheel + turn * *centre, hole);
    }
    for direction in &geometry.external_directions {
        svg += &main.circle("external", direction.scale(ring), q);
    }
    svg += &main.circle("thin", axis, inner);
    svg += &main.circle("thin", axis, ring);
    for [x, y] in &geometry.internal_points {
        svg += &main.circle(
            "internal",
            Complex::new(*x, *y),
            gear.internal_sleeve_radius_m,
        );
    }
    svg += &main.circle("eccentric", wheel, 0.53 * inner);
    svg += &main.circle("shaft", axis, 0.3 * inner);

    // Dimensions. Sleeves stand every 22.5 degrees outside and every 45 degrees inside.
    let external = |j: usize| geometry.external_directions[j];
    let mm = |x: f64, y: f64| Complex::new(1e-3 * x, 1e-3 * y);
    svg += &main.line("dimension", axis, external(5).scale(ring));
    svg += &main.label("R", external(5).scale(0.8 * ring) + mm(4.5, 0.0));
    let left = Complex::new(-1.0, 0.0);
    svg += &main.line("dimension", axis, left.scale(inner));
    svg += &main.label("R_w", left.scale(0.66 * inner) + mm(0.0, 2.2));
    svg += &main.line(
        "dimension",
        external(2).scale(ring),
        external(2).scale(ring) + mm(q * 1e3, 0.0),
    );
    svg += &main.label("q", external(2).scale(ring) + mm(q * 1e3 + 3.5, -1.8));
    let low = wheel + turn * geometry.hole_centres[0][7];
    svg += &main.line(
        "dimension",
        low,
        low + Complex::unit(-3.0 * FRAC_PI_4).scale(hole),
    );
    svg += &main.label(
        "r_h",
        low + Complex::unit(-3.0 * FRAC_PI_4).scale(hole) + mm(-3.5, -4.0),
    );
    for x in [0.0, e] {
        svg += &main.line("extension", mm(1e3 * x, 0.0), mm(1e3 * x, -9.5));
    }
    svg += &main.line("dimension", mm(-5.5, -8.5), mm(0.0, -8.5));
    svg += &main.line("dimension", mm(8.3, -8.5), mm(1e3 * e, -8.5));
    svg += &main.label("e", mm(11.3, -10.0));
    for p in [axis, wheel] {
        svg += &main.circle("dot", p, 0.9e-3);
    }

    // Names.
    let (zk, zi) = (gear.external_sleeves, gear.internal_sleeves);
    let external_name = format!(
        "external sleeves, z<tspan class='sub' dy='6'>k</tspan><tspan dy='-6'> = {zk}</tspan>"
    );
    let internal_name = format!(
        "internal sleeves, z<tspan class='sub' dy='6'>i</tspan><tspan dy='-6'> = {zi}</tspan>"
    );
    svg += &callout(
        &external_name,
        "start",
        [24.0, 44.0],
        [150.0, 56.0],
        main.at(external(6).scale(ring)),
    );
    svg += &callout(
        &format!("wheel, {} lobes", zk - 1),
        "end",
        [776.0, 44.0],
        [690.0, 56.0],
        main.at(mm(27.0, 47.0)),
    );
    svg += &callout(
        &internal_name,
        "start",
        [24.0, 810.0],
        [197.0, 784.0],
        main.at(Complex::unit(5.0 * FRAC_PI_4).scale(inner)),
    );
    svg += &callout(
        "holes of the wheel",
        "end",
        [776.0, 810.0],
        [565.0, 784.0],
        main.at(low + mm(5.6, -5.2)),
    );
    svg += &callout(
        "eccentric on the input shaft",
        "middle",
        [456.0, 846.0],
        [456.0, 820.0],
        main.at(mm(12.3, -15.0)),
    );

    // Backlash, drawn far larger than any gear has it.
    let (inset, d) = (
        View {
            centre: [46.0 - 57.0 * 9.0, 1000.0],
            per_mm: 9.0,
        },
        3.2e-3,
    );
    svg += "<g clip-path='url(#inset)'><rect class='cavity' x='24' y='880' width='244' height='240'/>\n";
    svg += &inset.wheel(&gear, &geometry, wheel, turn);
    let right = Complex::ONE;
    svg += &inset.circle("ghost", right.scale(ring), q);
    svg += &inset.circle("external", right.scale(ring + d), q);
    for x in [ring, ring + d] {
        svg += &inset.line("extension", right.scale(x), right.scale(x) + mm(0.0, 10.0));
    }
    svg += &inset.line(
        "dimension",
        right.scale(ring - 5e-3) + mm(0.0, 9.0),
        right.scale(ring) + mm(0.0, 9.0),
    );
    svg += &inset.line(
        "dimension",
        right.scale(ring + d + 5e-3) + mm(0.0, 9.0),
        right.scale(ring + d) + mm(0.0, 9.0),
    );
    svg += &inset.label("d", right.scale(ring + d + 7e-3) + mm(0.0, 8.0));
    svg += "<text class='note' x='256' y='1106'>d enlarged</text></g>\n<rect class='frame' x='24' y='880' width='244' height='240'/>\n";

    let rows = [
        ("e", format!("eccentricity, {:.1} mm", 1e3 * e)),
        ("R", format!("external circle radius, {:.0} mm", 1e3 * ring)),
        ("q", format!("external sleeve radius, {:.0} mm", 1e3 * q)),
        (
            "R_w",
            format!("internal circle radius, {:.0} mm", 1e3 * inner),
        ),
        ("r_h", format!("hole radius, {:.1} mm", 1e3 * hole)),
        ("d", "backlash: sleeves sit at R + d".into()),
    ];
    for (i, (symbol, words)) in rows.iter().enumerate() {
        let y = 906 + 41 * i;
        svg += &format!(
            "<text class='symbol' x='306' y='{y}'>{}</text><text x='342' y='{y}'>{words}</text>\n",
            subscript(symbol),
        );
    }
    println!("{svg}</svg>");
    Ok(())
}

/// Size, a background of its own (pages are light or dark), and how things are drawn.
const HEAD: &str = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 800 1144' width='800' height='1144' role='img' aria-labelledby='title'>
<title id='title'>A cycloidal gear with one wheel: external sleeves on the circle R, holes around internal sleeves, the eccentric e, and the backlash d</title>
<defs>
<marker id='arrow' viewBox='0 0 10 10' refX='9.5' refY='5' markerWidth='11' markerHeight='11' markerUnits='userSpaceOnUse' orient='auto'><path d='M0 1L10 5L0 9Z' fill='#14181d'/></marker>
<clipPath id='inset'><rect x='24' y='880' width='244' height='240' rx='8'/></clipPath>
</defs>
<style>
text{font:25px system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif;fill:#14181d}
.symbol{font-style:italic;font-weight:700;font-size:28px;text-anchor:middle;paint-order:stroke;stroke:#fff;stroke-width:5px;stroke-linejoin:round}
.sub{font-size:19px}.note{font-size:21px;text-anchor:end}
.housing{fill:#dfe3e8;stroke:#8b95a1;stroke-width:1.5}.cavity{fill:#f6f7f8}
.wheel{fill:#bcd7f2;stroke:#1f5fa8;stroke-width:2.5}
.hole{fill:#f6f7f8;stroke:#1f5fa8;stroke-width:2.5}
.external{fill:#f5c58f;stroke:#9a5410;stroke-width:2}
.internal{fill:#b5dfc4;stroke:#1e7145;stroke-width:2}
.ghost{fill:none;stroke:#9a5410;stroke-width:2;stroke-dasharray:6 5}
.eccentric{fill:#e6e1f2;stroke:#6b5aa5;stroke-width:2}.shaft{fill:#fff;stroke:#6b5aa5;stroke-width:2}
.thin{fill:none;stroke:#5d6875;stroke-width:1.2;stroke-dasharray:9 5}
.dimension{fill:none;stroke:#14181d;stroke-width:2;marker-end:url(#arrow)}
.extension{stroke:#14181d;stroke-width:1.2}.leader{stroke:#14181d;stroke-width:1.5;fill:none}.dot{fill:#14181d}
.frame{fill:none;stroke:#8b95a1;stroke-width:1.5;rx:8px}
</style>
<rect width='800' height='1144' rx='14' fill='#fff' stroke='#d4d9df'/>
";
