//! Quantities: a channel, or a group of numbered channels that are compared jointly.

use pinwheel_timeseries::{TimeSeries, group_of, stem_and_unit};
use serde::Serialize;

/// Torque of the driver on the input shaft.
pub use pinwheel_timeseries::columns::INPUT_TORQUE;
/// Angle of the output shaft.
pub use pinwheel_timeseries::columns::OUTPUT_ANGLE;
/// Torque on the output shaft without its load.
pub use pinwheel_timeseries::columns::OUTPUT_TORQUE;

/// Compared quantity, e.g. `external_sleeve_force_n` with its 16 channels.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Quantity {
    /// Name of the channel, or of the group without the number.
    pub name: String,
    /// Name for readers, e.g. `External sleeve force`.
    pub label: String,
    /// Unit taken from the name's suffix, e.g. `N m`; empty if unknown.
    pub unit: String,
    /// Channel names in the order of their numbers.
    pub channels: Vec<String>,
}

impl Quantity {
    #[doc(hidden)]
    pub fn new(name: &str) -> Self {
        let (stem, unit) = stem_and_unit(name);
        let words = stem
            .replace("external_sleeve", "ring pin")
            .replace("internal_sleeve", "output pin")
            .replace("wheel", "disc")
            .replace('_', " ");
        let mut letters = words.chars();
        let label = if name == INPUT_TORQUE {
            "Driver torque".to_owned()
        } else {
            letters.next().map_or_else(String::new, |first| {
                first.to_uppercase().chain(letters).collect()
            })
        };
        Self {
            name: name.to_owned(),
            label,
            unit: unit.to_owned(),
            channels: Vec::new(),
        }
    }

    /// True if time series have any channel of the quantity.
    pub(crate) fn is_in(&self, time_series: &TimeSeries) -> bool {
        let mut channels = self.channels.iter();
        channels.any(|name| time_series.channel(name).is_some())
    }

    /// True for a force or a torque, the quantities of the matrices.
    pub fn is_load(&self) -> bool {
        self.is_force() || self.is_torque()
    }

    /// True for a quantity in newtons.
    pub fn is_force(&self) -> bool {
        self.unit == "N"
    }

    /// True for a quantity in newton metres.
    pub fn is_torque(&self) -> bool {
        self.unit == "N m"
    }
}

/// Returns the label of the quantity `name` for readers, and its unit; empty if unknown.
pub fn label_and_unit(name: &str) -> (String, String) {
    let Quantity { label, unit, .. } = Quantity::new(name);
    (label, unit)
}

/// Returns the quantities of all time series in the order of their first appearance; numbered channels of one name form one
/// quantity, ordered by number.
pub fn derive<'a>(time_series: impl IntoIterator<Item = &'a TimeSeries>) -> Vec<Quantity> {
    type Members = Vec<(Option<usize>, String)>;
    let mut quantities: Vec<(Quantity, Members)> = Vec::new();
    for channel in time_series.into_iter().flat_map(TimeSeries::channels) {
        let (name, number) = group_of(&channel.name);
        let known = quantities.iter().position(|(q, _)| q.name == name);
        let place = known.unwrap_or_else(|| {
            quantities.push((Quantity::new(name), Vec::new()));
            quantities.len() - 1
        });
        let members = &mut quantities[place].1;
        if !members.iter().any(|(_, known)| *known == channel.name) {
            members.push((number, channel.name.clone()));
        }
    }
    let with_channels = |(mut quantity, mut members): (Quantity, Members)| {
        members.sort();
        quantity.channels = members.into_iter().map(|(_, name)| name).collect();
        quantity
    };
    quantities.into_iter().map(with_channels).collect()
}
