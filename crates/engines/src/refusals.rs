//! Refusals of scenes that several engines do not support.

use pinwheel_scene::Scene;
use pinwheel_timeseries::Ending;

use crate::external::structure_at_contacts;

/// Refuses scenes that require elastic bearings, for engines with revolutes at their discs.
pub(crate) fn wheels_are_held(scene: &Scene) -> Result<(), Ending> {
    let bearings = &scene.bearings;
    if bearings.eccentric.is_some() {
        let reason = "it holds discs by revolutes, and bearings.eccentric lets them move radially";
        return Err(Ending::unsupported(reason));
    }
    let losses = [
        ("input_seal_n_m", bearings.input_seal_n_m),
        ("output_seal_n_m", bearings.output_seal_n_m),
        (
            "sleeve_friction_coefficient",
            bearings.sleeve_friction_coefficient,
        ),
    ];
    let mut some = losses
        .into_iter()
        .filter(|(_, size)| size.is_some_and(|size| size > 0.0));
    some.next().map_or(Ok(()), |(key, _)| {
        let reason =
            format!("only its contacts and joints load its bodies, and bearings.{key} does too");
        Err(Ending::unsupported(reason))
    })
}

/// Refuses scenes with pins that do not turn, for engines with their own friction.
pub(crate) fn pins_turn(scene: &Scene) -> Result<(), Ending> {
    let gear = &scene.gear;
    let turn = [
        ("external_sleeves_turn", gear.external_sleeves_turn),
        ("internal_sleeves_turn", gear.internal_sleeves_turn),
    ];
    let held = turn.into_iter().find(|(_, turns)| !turns);
    held.filter(|_| scene.slides()).map_or(Ok(()), |(key, _)| {
        let reason = format!("its own friction turns pins, and gear.{key} = false holds them");
        Err(Ending::unsupported(reason))
    })
}

/// Refuses scenes with elastic pins, bearings or warm parts, for engines with their own contact springs.
pub(crate) fn pins_are_rigid(scene: &Scene) -> Result<(), Ending> {
    wheels_are_held(scene)?;
    pins_turn(scene)?;
    let pins = scene.bearings.internal_sleeve_stiffness_n_m;
    let stiffness = pins.map(|_| "bearings.internal_sleeve_stiffness_n_m");
    let key = stiffness.or_else(|| structure_at_contacts(scene));
    key.map_or(Ok(()), |key| {
        let reason =
            format!("its contacts are springs of its own, and {key} acts through the scene's law");
        Err(Ending::unsupported(reason))
    })
}
