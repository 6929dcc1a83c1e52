//! States of a run from its columns, in coordinates of the reduced form.

use pinwheel_gearbox::Gearbox;
use pinwheel_timeseries::{TimeSeries, columns, group_of};

use super::model::{Model, Work};

/// Columns of each coordinate of a gear and of its rate, in the order of the reduced form's y; `None` for a pin's angle that
/// affects nothing.
pub(super) struct Columns {
    pub(super) names: Vec<Option<String>>,
    /// Name of each coordinate in words.
    pub(super) coordinates: Vec<String>,
    /// Number of free angles.
    angles: usize,
}

impl Columns {
    /// Returns the columns of a gear whose `free` bodies have angles of their own, with or without floating discs.
    pub(super) fn of(gearbox: &Gearbox, free: &[usize]) -> Self {
        let layout = gearbox.layout;
        let kinds = [
            ("disc", "wheel", layout.wheel_bodies()),
            ("ring pin", "external_sleeve", layout.external_bodies()),
            ("output pin", "internal_sleeve", layout.internal_bodies()),
        ];
        let kind = |of: &usize| {
            let mut kinds = kinds.iter();
            let kind = kinds.find(|(.., bodies)| bodies.contains(of));
            kind.map(|(word, name, bodies)| (*word, *name, of - bodies.start))
        };
        let angle = |of: &usize| match kind(of) {
            None => Some(columns::OUTPUT_ANGLE.to_owned()),
            Some(("disc", name, disc)) => Some(format!("{name}_angle_rad_{disc}")),
            Some(_) => None,
        };
        let rate = |of: &usize| match kind(of) {
            None => Some("output_rate_rad_s".to_owned()),
            Some((_, name, number)) => Some(format!("{name}_rate_rad_s_{number}")),
        };
        let turning = |of: &usize| match kind(of) {
            None => "output".to_owned(),
            Some((word, _, number)) => format!("{word} {number}"),
        };
        let floating = if gearbox.floats() { layout.wheels } else { 0 };
        let plane = |[x, y]: [&str; 2]| {
            let both = move |w: usize, name: &str| Some(format!("{name}_{w}"));
            let (x, y) = (x.to_owned(), y.to_owned());
            (0..floating).flat_map(move |w| [both(w, &x), both(w, &y)])
        };
        let places = plane(["wheel_x_m", "wheel_y_m"]);
        let velocities = plane(["wheel_velocity_x_m_s", "wheel_velocity_y_m_s"]);
        let floats =
            (0..floating).flat_map(|w| ["x", "y"].map(|axis| format!("{axis} of disc {w}")));
        let coordinates = free.iter().map(turning).chain(floats).collect();
        let angles = free.iter().map(angle).chain(places);
        let rates = free.iter().map(rate).chain(velocities);
        Self {
            names: angles.chain(rates).collect(),
            coordinates,
            angles: free.len(),
        }
    }

    /// Returns the columns of a gear's native model; `None` if it has no reduced form.
    pub(super) fn native(gearbox: &Gearbox) -> Option<Self> {
        let work = Work::new(gearbox, 0);
        Some(Self::of(gearbox, Model::new(&work, Vec::new())?.free()))
    }

    /// Returns the number of coordinates that are positions.
    pub(super) fn places(&self) -> usize {
        self.coordinates.len() - self.angles
    }

    /// Returns the columns beyond the standard ones.
    pub(super) fn channels(&self) -> Vec<String> {
        let names = self.names.iter().flatten();
        let asked = names.filter(|name| *name != columns::OUTPUT_ANGLE);
        asked.cloned().collect()
    }

    /// Returns patterns of the columns that a run lacks.
    pub(super) fn missing(&self, run: &TimeSeries) -> Vec<String> {
        let names = self.channels().into_iter();
        patterns(names.filter(|name| run.channel(name).is_none()))
    }

    /// Returns patterns of the columns beyond the standard ones.
    pub(super) fn patterns(&self) -> Vec<String> {
        patterns(self.channels().into_iter())
    }

    /// Returns the state of a run at a sample; NaN for missing columns.
    pub(super) fn at(&self, run: &TimeSeries, sample: usize) -> Vec<f64> {
        let value = |name: &Option<String>| match name {
            None => 0.0,
            Some(name) => run.channel(name).map_or(f64::NAN, |column| column[sample]),
        };
        self.names.iter().map(value).collect()
    }
}

fn patterns(names: impl Iterator<Item = String>) -> Vec<String> {
    let mut patterns: Vec<String> = names
        .map(|name| match group_of(&name) {
            (family, Some(_)) => format!("{family}_*"),
            (family, None) => family.to_owned(),
        })
        .collect();
    patterns.dedup();
    patterns
}
