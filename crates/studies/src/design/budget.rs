//! Compliance budget: deflection by parts.
//!
//! The gear is balanced with its contacts alone, then also with its eccentric bearings, then with the parts behind them, then
//! with carrier and flange. Compliances add up, so the share of a part is the increase of the twist under load when it is
//! added.

use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::{Scene, Structure};
use serde::Serialize;

use super::DesignResult;
use crate::balances::poses::Poses;
use crate::balances::solve::{FEW, twisted};
use crate::balances::spread::{ARCMIN, Spread};
use crate::control::{compile, of_scene};
use crate::{Control, StudyError};

/// Compliance of one part, and of the gear with all parts up to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Share {
    /// Part that deflects.
    pub part: &'static str,
    /// Share of the total compliance.
    pub share: f64,
    /// Stiffness of the gear with this part and all earlier ones, mean over the mesh, N m/arcmin.
    pub stiffness_n_m_per_arcmin: f64,
    /// Lost motion of that gear, largest over the mesh, arcmin.
    pub lost_motion_arcmin: f64,
}

/// Remaining compliance beyond the scene's parts, fitted to a stated stiffness of a catalogue or a measurement.
///
/// The model has one spring for it between carrier and output: its size is known, its cause is not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rest {
    /// Stated stiffness, N m/arcmin.
    pub stated_n_m_per_arcmin: f64,
    /// Value of `bearings.output_torsion_n_m_rad` that gives the scene that stiffness.
    pub output_torsion_n_m_rad: f64,
    /// Share of the total compliance.
    pub share: f64,
}

impl Rest {
    /// Computes the remaining compliance of a gear with a stated stiffness.
    ///
    /// # Errors
    /// A stated stiffness that is not positive, or not below the gear's.
    pub(super) fn of(design: &DesignResult, stated: f64) -> Result<Self, StudyError> {
        let before = design.budget.iter().rfind(|share| share.part != REST);
        let own = before.map_or(design.torsion.stiffness_n_m_per_arcmin.mean, |share| {
            share.stiffness_n_m_per_arcmin
        });
        if !(stated > 0.0 && stated < own) {
            return Err(StudyError::Input(format!(
                "a stated stiffness of {stated} N m/arcmin leaves nothing to fit: the gear has {own:.3} N m/arcmin by what the \
                 scene says; state less than that and more than 0"
            )));
        }
        let share = 1.0 - stated / own;
        Ok(Self {
            stated_n_m_per_arcmin: stated,
            output_torsion_n_m_rad: stated / share * ARCMIN,
            share,
        })
    }
}

/// Part that deflects in every gear.
pub(super) const CONTACTS: &str = "contacts";
/// Part that a fit replaces.
pub(super) const REST: &str = "carrier and flange";

/// Function that copies the values of one part from the complete scene.
type Give = fn(&mut Scene, &Scene);
/// Parts behind the bearings of the discs, in the order in which they are added.
const PARTS: [(&str, Give); 9] = [
    ("crank supports", |scene, all| {
        if let (Some(cranks), Some(all)) = (&mut scene.cranks, all.cranks) {
            cranks.support_stiffness_n_m = all.support_stiffness_n_m;
        }
    }),
    ("first stage", |scene, all| scene.cranks = all.cranks),
    ("output pins", |scene, all| {
        scene.bearings.internal_sleeve_stiffness_n_m = all.bearings.internal_sleeve_stiffness_n_m;
        scene.structure.output_pin_diameter_m = all.structure.output_pin_diameter_m;
    }),
    ("seats of output pins", |scene, all| {
        scene.structure.output_seat_length_m = all.structure.output_seat_length_m;
    }),
    ("slots of ring pins", |scene, all| {
        scene.structure.ring_slot_clearance_m = all.structure.ring_slot_clearance_m;
    }),
    ("seats of ring pins", |scene, all| {
        scene.structure.ring_seat_length_m = all.structure.ring_seat_length_m;
    }),
    ("output plate", |scene, all| {
        scene.structure.plate_thickness_m = all.structure.plate_thickness_m;
        scene.structure.plate_radius_m = all.structure.plate_radius_m;
    }),
    ("input shaft", |scene, all| {
        scene.structure.input_torsion_n_m_rad = all.structure.input_torsion_n_m_rad;
    }),
    (REST, |scene, all| scene.bearings = all.bearings),
];

/// Computes the budget of the gear of `known` under the `working` load; empty if only the contacts deflect.
pub(super) fn of(
    known: &mut Statics<'_>,
    working: f64,
    control: &Control<'_>,
) -> Result<Vec<Share>, StudyError> {
    let all = &known.gearbox().scene;
    // The first gear has rigid bearings, which a scene with cranks cannot state.
    let mut scene = Scene::clone(all);
    scene.bearings.output_torsion_n_m_rad = None;
    scene.bearings.internal_sleeve_stiffness_n_m = None;
    let housing_material = scene.structure.housing_material.take();
    scene.structure = Structure {
        housing_material,
        ..Structure::default()
    };
    if let Some(cranks) = &mut scene.cranks {
        (cranks.support_stiffness_n_m, cranks.mesh_stiffness_n_m) = (None, None);
    }
    let mut parts = vec![(CONTACTS, scene.clone())];
    if all.bearings.eccentric.is_some() {
        let part = match scene.cranks {
            Some(_) => "crank bearings",
            None => "eccentric bearings",
        };
        parts.push((part, scene.clone()));
    }
    for (part, give) in PARTS {
        let before = scene.clone();
        give(&mut scene, all);
        if scene != before {
            parts.push((part, scene.clone()));
        }
    }
    let mut shares: Vec<Share> = Vec::new();
    if parts.len() == 1 {
        return Ok(shares);
    }
    let mut compliance = Vec::new();
    for (part, scene) in parts {
        let balanced = |statics: &mut Statics<'_>| {
            let gearbox = statics.gearbox();
            let poses = Poses::of(&scene).few(FEW);
            twisted(statics, &poses, gearbox, working, &mut |_| {
                Ok(control.check()?)
            })
        };
        let (lost, stiffness) = if part != CONTACTS && scene == *known.gearbox().scene {
            balanced(known)?
        } else {
            let gearbox = compile(&scene)?;
            let of_scene = |source| of_scene(&gearbox.scene, source);
            let mut statics = Statics::new(&gearbox).map_err(of_scene)?;
            if part == CONTACTS {
                statics = statics.on_rigid_bearings();
            }
            balanced(&mut statics)?
        };
        let stiffness = Spread::of(stiffness.into_iter().flatten()).mean;
        compliance.push(1.0 / stiffness);
        shares.push(Share {
            part,
            share: 0.0,
            stiffness_n_m_per_arcmin: stiffness,
            lost_motion_arcmin: Spread::of(lost).max,
        });
    }
    let total = compliance.last().copied().unwrap_or(1.0);
    let mut before = 0.0;
    for (share, compliance) in shares.iter_mut().zip(compliance) {
        share.share = (compliance - before) / total;
        before = compliance;
    }
    Ok(shares)
}
