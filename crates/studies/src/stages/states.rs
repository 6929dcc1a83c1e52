//! States of a run from its columns, in the coordinates of the reduced form.

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Layout;
use pinwheel_timeseries::{TimeSeries, columns, group_of};

/// Column of each coordinate of a gear and of its rate, in the order of the reduced form's y. `None`: a pin's angle, on which
/// nothing depends.
pub(super) struct Columns {
    names: Vec<Option<String>>,
    /// Number of free angles.
    angles: usize,
}

impl Columns {
    /// Columns of a gear whose `free` bodies have angles of their own, and whose discs float or do not.
    pub(super) fn of(gearbox: &Gearbox, free: &[usize]) -> Self {
        let layout = gearbox.layout;
        let wheel = |body: usize| body - layout.wheel_bodies().start;
        let angle = |&body: &usize| match body {
            Layout::OUTPUT => Some(columns::OUTPUT_ANGLE.to_owned()),
            _ if layout.wheel_bodies().contains(&body) => {
                Some(format!("wheel_angle_rad_{}", wheel(body)))
            }
            _ => None,
        };
        let rate = |&body: &usize| {
            Some(match body {
                Layout::OUTPUT => "output_rate_rad_s".to_owned(),
                _ if layout.wheel_bodies().contains(&body) => {
                    format!("wheel_rate_rad_s_{}", wheel(body))
                }
                _ if layout.external_bodies().contains(&body) => {
                    let pin = body - layout.external_bodies().start;
                    format!("external_sleeve_rate_rad_s_{pin}")
                }
                _ => {
                    let pin = body - layout.internal_bodies().start;
                    format!("internal_sleeve_rate_rad_s_{pin}")
                }
            })
        };
        let floating = if gearbox.floats() { layout.wheels } else { 0 };
        let plane = |[x, y]: [&str; 2]| {
            let both = move |w: usize, name: &str| Some(format!("{name}_{w}"));
            let (x, y) = (x.to_owned(), y.to_owned());
            (0..floating).flat_map(move |w| [both(w, &x), both(w, &y)])
        };
        let places = plane(["wheel_x_m", "wheel_y_m"]);
        let velocities = plane(["wheel_velocity_x_m_s", "wheel_velocity_y_m_s"]);
        let angles = free.iter().map(angle).chain(places);
        let rates = free.iter().map(rate).chain(velocities);
        Self {
            names: angles.chain(rates).collect(),
            angles: free.len(),
        }
    }

    /// Number of coordinates that are places.
    pub(super) fn places(&self) -> usize {
        self.names.len() / 2 - self.angles
    }

    /// Columns beyond those that every run has.
    pub(super) fn channels(&self) -> Vec<String> {
        let names = self.names.iter().flatten();
        let asked = names.filter(|name| *name != columns::OUTPUT_ANGLE);
        asked.cloned().collect()
    }

    /// Columns that a run lacks, as patterns.
    pub(super) fn missing(&self, run: &TimeSeries) -> Vec<String> {
        let names = self.channels().into_iter();
        patterns(names.filter(|name| run.channel(name).is_none()))
    }

    /// Columns beyond those that every run has, as patterns.
    pub(super) fn patterns(&self) -> Vec<String> {
        patterns(self.channels().into_iter())
    }

    /// State of a run at a sample; NaN for what it lacks.
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
