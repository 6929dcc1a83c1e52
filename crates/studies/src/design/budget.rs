//! The compliance budget: what gives way, part by part.
//!
//! The gear is balanced with contacts alone, then with its eccentric bearings, then with the bending of its output pins, then with
//! carrier and flange, each time with all before. Compliances add up, so a part's share is what the twist under load grows by when it joins.

use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::{Bearings, Scene};
use serde::Serialize;

use super::mesh::Poses;
use super::{FEW, Spread, twisted};
use crate::StudyError;
use crate::control::{compile, of_scene};

/// One part, and the gear with all parts up to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Share {
    /// What gives way.
    pub part: &'static str,
    /// Share of the whole compliance that it adds.
    pub share: f64,
    /// Stiffness of the gear with it and all parts before, mean over the mesh, N m/arcmin.
    pub stiffness_n_m_per_arcmin: f64,
    /// Lost motion of that gear, largest over the mesh, arcmin.
    pub lost_motion_arcmin: f64,
}

/// Of the gear under the `working` load; empty where contacts alone give way.
pub(super) fn of(gearbox: &Gearbox, working: f64) -> Result<Vec<Share>, StudyError> {
    let all = gearbox.scene.bearings;
    let parts = [
        ("contacts", true, Bearings::default()),
        (
            "eccentric bearings",
            all.eccentric.is_some(),
            Bearings {
                eccentric: all.eccentric,
                ..Bearings::default()
            },
        ),
        (
            "output pins",
            all.internal_sleeve_stiffness_n_m.is_some(),
            Bearings {
                eccentric: all.eccentric,
                internal_sleeve_stiffness_n_m: all.internal_sleeve_stiffness_n_m,
                ..Bearings::default()
            },
        ),
        (
            "carrier and flange",
            all.output_torsion_n_m_rad.is_some(),
            all,
        ),
    ];
    let mut shares: Vec<Share> = Vec::new();
    if parts.iter().filter(|(_, is_there, _)| *is_there).count() == 1 {
        return Ok(shares);
    }
    let mut compliance = Vec::new();
    for (part, is_there, bearings) in parts {
        if !is_there {
            continue;
        }
        let mut scene = Scene::clone(&gearbox.scene);
        scene.bearings = bearings;
        let gearbox = compile(&scene)?;
        let of_scene = |source| of_scene(&gearbox.scene, source);
        let poses = Poses::of(&scene.gear).few(FEW);
        let mut statics = Statics::new(&gearbox).map_err(of_scene)?;
        let found = twisted(&mut statics, &poses, &gearbox, working).map_err(of_scene)?;
        let stiffness = Spread::of(found.1.into_iter().flatten()).mean;
        compliance.push(1.0 / stiffness);
        shares.push(Share {
            part,
            share: 0.0,
            stiffness_n_m_per_arcmin: stiffness,
            lost_motion_arcmin: Spread::of(found.0).max,
        });
    }
    let whole = compliance.last().copied().unwrap_or(1.0);
    let mut before = 0.0;
    for (share, compliance) in shares.iter_mut().zip(compliance) {
        share.share = (compliance - before) / whole;
        before = compliance;
    }
    Ok(shares)
}
