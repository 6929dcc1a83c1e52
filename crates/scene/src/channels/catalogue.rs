//! Catalogue of channels: names, numbers and meanings.
//!
//! A scene selects a channel by the name of its column. A name ends in its unit and, for channels of several parts, in a
//! number (the pin's or the disc's); names of a pair of disc and pin begin with the disc's number. `*` matches any
//! characters.

use pinwheel_files::fits;

use crate::layout::{Layout, Sleeve};

/// Quantity of a pair of disc and pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairQuantity {
    /// Penetration: pin radius less distance, m.
    Penetration,
    /// Rate of the penetration, m/s.
    NormalVelocity,
    /// Sliding velocity along R90 n, m/s.
    TangentialVelocity,
    /// Stiffness K of the law.
    Stiffness,
    /// The disc's closest point, x, m.
    PointX,
    /// Contact point y, m.
    PointY,
    /// Normal force F_n, N.
    NormalForce,
    /// Friction on the pin along R90 n, N.
    FrictionForce,
    /// Total force on the disc, x, N.
    ForceX,
    /// Force y, N.
    ForceY,
    /// Pressure p0 of a line contact, Pa.
    Pressure,
    /// p0 times the sliding speed, W/m^2.
    PressureSliding,
}

/// Group of revolute joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joint {
    /// Input shaft on the housing.
    Input,
    /// Output shaft on the housing.
    Output,
    /// Disc on its eccentric.
    Eccentric,
    /// Sleeve of a ring pin.
    ExternalPin,
    /// Sleeve of an output pin.
    InternalPin,
}

/// Component of a joint's force on the carried body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Magnitude of the force.
    Magnitude,
    /// Along x of the ground frame.
    X,
    /// Along y of the ground frame.
    Y,
    /// Component away from the input shaft's axis.
    Radial,
    /// Component along the radial direction turned by +90 degrees.
    Tangential,
}

/// Component of a body's state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Component {
    /// Angle, rad, not reduced to one turn.
    Angle,
    /// Rate of the angle, rad/s.
    Rate,
    /// Position of the centre of mass, x, m.
    X,
    /// Position y, m.
    Y,
    /// Velocity of the centre of mass, x, m/s.
    VelocityX,
    /// Velocity y, m/s.
    VelocityY,
}

/// Quantities of the gearbox or of a disc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whole {
    /// Output power over input power.
    Efficiency,
    /// Driver torque times speed, W.
    InputPower,
    /// Moment of the contacts on the output times its speed, W.
    OutputPower,
    /// Power lost by damping, W.
    DampingLoss,
    /// Power lost by sliding, W.
    FrictionLoss,
    /// Output angle less that of the ideal mesh, arcmin.
    TransmissionError,
    /// Disc angle less that of the ideal mesh, arcmin.
    WheelTransmissionError,
    /// Offset of a disc's centre from its eccentric's, x.
    BearingOffsetX,
    /// Component y.
    BearingOffsetY,
    /// Number of loaded ring pins.
    ExternalContacts,
    /// Number of loaded output pins.
    InternalContacts,
}

/// Content of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum What {
    /// Quantity of a pair of disc and pin.
    Pair(PairQuantity),
    /// Force of a revolute joint.
    Joint(Joint, Part),
    /// Quantity of the gearbox or a disc.
    Whole(Whole),
    /// State of a joint's body, ground frame.
    State(Joint, Component),
}

/// Parts whose numbers replace the `*` of a family.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Over {
    One,
    Wheels,
    External,
    Internal,
    WheelsExternal,
    WheelsInternal,
}

/// Channels that differ only in their numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Family {
    /// Name with `*` for every number, which is also the pattern for all channels of the family.
    pub pattern: &'static str,
    /// Meaning of the column with sign and frame.
    pub about: &'static str,
    over: Over,
    what: What,
}

/// Column of a gearbox.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chosen {
    /// Name of the column.
    pub name: String,
    /// Content of the column.
    pub what: What,
    /// Disc and pin of a pair.
    pub pair: Option<(usize, Sleeve)>,
    /// Number within the family, if not of a pair.
    pub number: usize,
}

/// Columns that every engine records without request.
const CONTRACT: [(&str, Over); 6] = [
    ("time_s", Over::One),
    ("input_torque_n_m", Over::One),
    ("output_torque_n_m", Over::One),
    ("output_angle_rad", Over::One),
    ("external_sleeve_force_n_*", Over::External),
    ("internal_sleeve_force_n_*", Over::Internal),
];

macro_rules! families {
    ($($pattern:literal $over:ident $what:expr, $about:literal;)*) => {
        &[$(Family { pattern: $pattern, over: Over::$over, what: $what, about: $about }),*]
    };
}

use {Component as C, Joint as J, PairQuantity as P, Part as X, Whole as W};

/// All families, in the order of the columns.
pub const FAMILIES: &[Family] = families! {
    "efficiency" One What::Whole(W::Efficiency), "output power over input power at the instant; 0 where the driver's power is not positive";
    "input_power_w" One What::Whole(W::InputPower), "driver torque times the input's speed";
    "output_power_w" One What::Whole(W::OutputPower), "output_torque_n_m times the output's speed";
    "damping_loss_w" One What::Whole(W::DampingLoss), "power lost by the damping of the normal forces";
    "friction_loss_w" One What::Whole(W::FrictionLoss), "power lost by sliding";
    "transmission_error_arcmin" One What::Whole(W::TransmissionError), "output angle less the ideal mesh's, counter-clockwise";
    "wheel_transmission_error_arcmin_*" Wheels What::Whole(W::WheelTransmissionError), "disc angle less the ideal mesh's, counter-clockwise";
    "external_contact_ratio_*" Wheels What::Whole(W::ExternalContacts), "ring pins that press on the disc; the mean is the contact ratio";
    "internal_contact_ratio_*" Wheels What::Whole(W::InternalContacts), "output pins that press on the disc; the mean is the contact ratio";
    "input_bearing_force_n" One What::Joint(J::Input, X::Magnitude), "force of the housing on the input shaft";
    "input_bearing_force_x_n" One What::Joint(J::Input, X::X), "its x, ground frame";
    "input_bearing_force_y_n" One What::Joint(J::Input, X::Y), "its y, ground frame";
    "output_bearing_force_n" One What::Joint(J::Output, X::Magnitude), "force of the housing on the output shaft";
    "output_bearing_force_x_n" One What::Joint(J::Output, X::X), "its x, ground frame";
    "output_bearing_force_y_n" One What::Joint(J::Output, X::Y), "its y, ground frame";
    "eccentric_bearing_force_n_*" Wheels What::Joint(J::Eccentric, X::Magnitude), "force of the eccentric on the disc";
    "eccentric_bearing_force_x_n_*" Wheels What::Joint(J::Eccentric, X::X), "its x, ground frame";
    "eccentric_bearing_force_y_n_*" Wheels What::Joint(J::Eccentric, X::Y), "its y, ground frame";
    "eccentric_bearing_radial_force_n_*" Wheels What::Joint(J::Eccentric, X::Radial), "its part away from the input's axis";
    "eccentric_bearing_tangential_force_n_*" Wheels What::Joint(J::Eccentric, X::Tangential), "its part counter-clockwise about the input's axis: times e, the torque this disc takes";
    "eccentric_bearing_offset_x_m_*" Wheels What::Whole(W::BearingOffsetX), "the disc's centre less its eccentric's, x, ground frame; 0 without `[bearings]`";
    "eccentric_bearing_offset_y_m_*" Wheels What::Whole(W::BearingOffsetY), "its y";
    "external_pin_force_n_*" External What::Joint(J::ExternalPin, X::Magnitude), "force of the housing's pin on the ring pin";
    "external_pin_force_x_n_*" External What::Joint(J::ExternalPin, X::X), "its x, ground frame";
    "external_pin_force_y_n_*" External What::Joint(J::ExternalPin, X::Y), "its y, ground frame";
    "internal_pin_force_n_*" Internal What::Joint(J::InternalPin, X::Magnitude), "force of the output shaft's pin on the output pin";
    "internal_pin_force_x_n_*" Internal What::Joint(J::InternalPin, X::X), "its x, ground frame";
    "internal_pin_force_y_n_*" Internal What::Joint(J::InternalPin, X::Y), "its y, ground frame";
    "wheel_*_external_penetration_m_*" WheelsExternal What::Pair(P::Penetration), "sleeve radius less the distance of its centre from the disc; negative: the gap";
    "wheel_*_external_normal_velocity_m_s_*" WheelsExternal What::Pair(P::NormalVelocity), "rate of the penetration";
    "wheel_*_external_tangential_velocity_m_s_*" WheelsExternal What::Pair(P::TangentialVelocity), "sliding of the pin against the disc at the contact point, along R90 n";
    "wheel_*_external_stiffness_n_m15_*" WheelsExternal What::Pair(P::Stiffness), "K of the law at the contact point";
    "wheel_*_external_contact_x_m_*" WheelsExternal What::Pair(P::PointX), "the disc's point closest to the pin's centre, ground frame";
    "wheel_*_external_contact_y_m_*" WheelsExternal What::Pair(P::PointY), "its y";
    "wheel_*_external_normal_force_n_*" WheelsExternal What::Pair(P::NormalForce), "F_n";
    "wheel_*_external_friction_force_n_*" WheelsExternal What::Pair(P::FrictionForce), "friction on the pin along R90 n";
    "wheel_*_external_force_x_n_*" WheelsExternal What::Pair(P::ForceX), "force of the pin on the disc, friction with it, x, ground frame";
    "wheel_*_external_force_y_n_*" WheelsExternal What::Pair(P::ForceY), "its y";
    "wheel_*_external_pressure_pa_*" WheelsExternal What::Pair(P::Pressure), "p0 of a line contact over the face width";
    "wheel_*_external_pressure_sliding_w_m2_*" WheelsExternal What::Pair(P::PressureSliding), "p0 times the sliding speed";
    "wheel_*_internal_penetration_m_*" WheelsInternal What::Pair(P::Penetration), "sleeve radius less the distance of its centre from the hole; negative: the gap";
    "wheel_*_internal_normal_velocity_m_s_*" WheelsInternal What::Pair(P::NormalVelocity), "rate of the penetration";
    "wheel_*_internal_tangential_velocity_m_s_*" WheelsInternal What::Pair(P::TangentialVelocity), "sliding of the pin against the disc at the contact point, along R90 n";
    "wheel_*_internal_stiffness_n_m15_*" WheelsInternal What::Pair(P::Stiffness), "K of the law";
    "wheel_*_internal_contact_x_m_*" WheelsInternal What::Pair(P::PointX), "the hole's point closest to the pin's centre, ground frame";
    "wheel_*_internal_contact_y_m_*" WheelsInternal What::Pair(P::PointY), "its y";
    "wheel_*_internal_normal_force_n_*" WheelsInternal What::Pair(P::NormalForce), "F_n";
    "wheel_*_internal_friction_force_n_*" WheelsInternal What::Pair(P::FrictionForce), "friction on the pin along R90 n";
    "wheel_*_internal_force_x_n_*" WheelsInternal What::Pair(P::ForceX), "force of the pin, or of the crank's bearing, on the disc, friction with it, x, ground frame";
    "wheel_*_internal_force_y_n_*" WheelsInternal What::Pair(P::ForceY), "its y";
    "wheel_*_internal_pressure_pa_*" WheelsInternal What::Pair(P::Pressure), "p0 of a line contact over the face width";
    "wheel_*_internal_pressure_sliding_w_m2_*" WheelsInternal What::Pair(P::PressureSliding), "p0 times the sliding speed";
    "output_rate_rad_s" One What::State(J::Output, C::Rate), "rate of output_angle_rad";
    "wheel_angle_rad_*" Wheels What::State(J::Eccentric, C::Angle), "disc angle, counter-clockwise, ground frame";
    "wheel_rate_rad_s_*" Wheels What::State(J::Eccentric, C::Rate), "its rate";
    "wheel_x_m_*" Wheels What::State(J::Eccentric, C::X), "place of the disc's centre, x, ground frame";
    "wheel_y_m_*" Wheels What::State(J::Eccentric, C::Y), "its y";
    "wheel_velocity_x_m_s_*" Wheels What::State(J::Eccentric, C::VelocityX), "velocity of the disc's centre, x, ground frame";
    "wheel_velocity_y_m_s_*" Wheels What::State(J::Eccentric, C::VelocityY), "its y";
    "external_sleeve_rate_rad_s_*" External What::State(J::ExternalPin, C::Rate), "rate of a ring pin about its centre, counter-clockwise";
    "internal_sleeve_rate_rad_s_*" Internal What::State(J::InternalPin, C::Rate), "rate of an output pin about its centre, counter-clockwise, ground frame";
};

impl Over {
    /// Returns the numbers that replace the `*`, first slowest; `None` for a missing number.
    fn numbers(self, layout: Layout) -> Vec<(Option<usize>, Option<usize>)> {
        let alone = |count: usize| (0..count).map(|k| (None, Some(k))).collect();
        let pairs = |count: usize| {
            let wheels = 0..layout.wheels;
            wheels
                .flat_map(|w| (0..count).map(move |k| (Some(w), Some(k))))
                .collect()
        };
        match self {
            Self::One => vec![(None, None)],
            Self::Wheels => alone(layout.wheels),
            Self::External => alone(layout.external_sleeves),
            Self::Internal => alone(layout.internal_sleeves),
            Self::WheelsExternal => pairs(layout.external_sleeves),
            Self::WheelsInternal => pairs(layout.internal_sleeves),
        }
    }
}

impl Family {
    /// True for states of bodies.
    pub fn is_state(&self) -> bool {
        matches!(self.what, What::State(..))
    }

    /// Returns the columns of the family in a gearbox.
    pub fn members(&self, layout: Layout) -> impl Iterator<Item = Chosen> {
        let family = *self;
        self.over.numbers(layout).into_iter().map(move |numbers| {
            let (wheel, last) = numbers;
            let number = last.unwrap_or(0);
            let sleeve = if family.over == Over::WheelsInternal {
                Sleeve::Internal(number)
            } else {
                Sleeve::External(number)
            };
            Chosen {
                name: numbered(family.pattern, [wheel, last].into_iter().flatten()),
                what: family.what,
                pair: wheel.map(|wheel| (wheel, sleeve)),
                number,
            }
        })
    }
}

/// Returns the pattern with numbers in place of its `*`.
fn numbered(pattern: &str, numbers: impl Iterator<Item = usize>) -> String {
    numbers.fold(pattern.to_owned(), |name, number| {
        name.replacen('*', &number.to_string(), 1)
    })
}

/// True if a pattern matches a column that every engine records.
pub fn always_there(pattern: &str, layout: Layout) -> bool {
    CONTRACT.iter().any(|(name, over)| {
        let numbers = over.numbers(layout).into_iter();
        numbers
            .map(|(_, number)| numbered(name, number.into_iter()))
            .any(|name| fits(pattern, &name))
    })
}
