//! Job file (`scene.json`): all data of a scene for foreign solvers that read JSON.

use std::path::Path;

use pinwheel_gearbox::{Gearbox, Recorder};
use pinwheel_scene::{JOB_PROTOCOL, KEYS, keys::Kind, schema};
use pinwheel_timeseries::columns;
use serde_json::{Value, json};

use crate::law::{Law, LawError};
use crate::{JOB_FILE, STATE};

/// File of the time series that a solver writes.
pub const COURSES_FILE: &str = "courses.csv";
/// File of the time series as Parquet; a solver writes either this or [`COURSES_FILE`].
pub const PARQUET_FILE: &str = "courses.parquet";
/// File for counts and remarks, which a solver may write.
pub const RESULT_FILE: &str = "result.json";

/// Reason why a job could not be written.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// Fault of the scene.
    #[error(transparent)]
    Law(#[from] LawError),
    /// Fault of the folder.
    #[error("{0}")]
    Io(#[from] std::io::Error),
}

/// Returns the columns that the time series of a scene must have, in order, the time first.
pub fn required(gearbox: &Gearbox) -> Vec<String> {
    let time = std::iter::once(columns::TIME.to_owned());
    time.chain(Recorder::contract(gearbox)).collect()
}

/// Returns the job of a scene. `law_library`: path of `libpinwheel_law`, if known.
///
/// # Errors
/// A scene whose contacts cannot be built.
pub fn job(gearbox: &Gearbox, law_library: Option<&Path>) -> Result<Value, LawError> {
    let law = Law::of(gearbox)?;
    let mut scene = gearbox.scene.to_json();
    // Keys whose value means `none` are written, too.
    for key in KEYS {
        let nothing = match key.kind {
            Kind::Texts | Kind::Choices(..) | Kind::Numbers(_) | Kind::Tables(_) => json!([]),
            Kind::Text => json!(""),
            Kind::Flag => json!(true),
            Kind::Number(_) | Kind::Count(..) | Kind::Choice(..) => continue,
        };
        let path = key.name.split('.');
        let place = path.fold(&mut scene, |at, part| &mut at[part]);
        if place.is_null() {
            *place = nothing;
        }
    }
    let bodies = law
        .bodies()
        .iter()
        .zip(law.start().chunks(STATE))
        .map(|(body, start)| {
            json!({
                "name": body.name,
                "carrier": body.carrier.number(),
                "seat_m": body.seat_m,
                "mass_kg": body.mass_kg,
                "moment_kg_m2": body.moment_kg_m2,
                "start": start,
            })
        });
    let mut columns = required(gearbox);
    columns.extend(gearbox.channels.names().map(str::to_owned));
    let scales = gearbox.error_scales();
    Ok(json!({
        "protocol": JOB_PROTOCOL,
        "scene": scene,
        "bodies": bodies.collect::<Vec<_>>(),
        "rate_rad_s": gearbox.scene.drive.input_speed_rad_s,
        "elastic_twist_rad": scales.angle,
        "vibration_rad_s": scales.frequency,
        "samples_s": law.samples,
        "columns": columns,
        "law_library": law_library,
    }))
}

/// Writes the job of a scene into a folder.
///
/// # Errors
/// Errors of [`job`], and files that cannot be written.
pub fn write(gearbox: &Gearbox, folder: &Path, law_library: Option<&Path>) -> Result<(), JobError> {
    let text = format!("{:#}\n", job(gearbox, law_library)?);
    std::fs::write(folder.join(JOB_FILE), text)?;
    Ok(())
}

/// Returns the JSON schema (draft 2020-12) of job files of this protocol.
///
/// ```
/// let schema = pinwheel_law::job::schema();
/// assert_eq!(schema["properties"]["protocol"]["const"], 1);
/// assert!(schema["properties"]["scene"]["properties"]["gear"]["properties"]["wheels"].is_object());
/// ```
pub fn schema() -> Value {
    let numbers = |count: usize| json!({ "type": "array", "items": { "type": "number" }, "minItems": count, "maxItems": count });
    let with = |mut value: Value, about: &str| {
        value["description"] = json!(about);
        value
    };
    let mut scene = schema::schema();
    if let Some(root) = scene.as_object_mut() {
        root.remove("$schema");
    }
    if let Some(keys) = scene["properties"].as_object_mut() {
        keys.remove("base");
    }
    let body = json!({
        "type": "object",
        "properties": {
            "name": { "type": "string" },
            "carrier": { "type": "integer", "minimum": -2, "description": "index of the body it turns on; -1: the housing; -2: none, the body moves freely in the plane" },
            "seat_m": with(numbers(2), "centre of the body in the carrier's frame, whose origin is the carrier's centre (m)"),
            "mass_kg": { "type": "number" },
            "moment_kg_m2": { "type": "number", "description": "moment of inertia about the body's centre (kg m^2)" },
            "start": with(numbers(STATE), "x, y (m), angle (rad), vx, vy (m/s), rate (rad/s) in the ground frame at t = 0"),
        },
        "required": ["name", "carrier", "seat_m", "mass_kg", "moment_kg_m2", "start"],
    });
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A job of pinwheel for a foreign solver (scene.json)",
        "type": "object",
        "properties": {
            "protocol": { "const": JOB_PROTOCOL, "description": "version of this file and of the exit statuses" },
            "scene": with(scene, "the scene with the values of all keys"),
            "bodies": { "type": "array", "items": body, "description": "input shaft, output shaft, discs, ring pins, output pins" },
            "rate_rad_s": { "type": "number", "description": "constant rate of the input shaft (rad/s)" },
            "elastic_twist_rad": { "type": "number", "description": "twist of a disc under its largest static load: scale for errors of angles (rad)" },
            "vibration_rad_s": { "type": "number", "description": "angular frequency of a disc on its contacts; times the twist: scale for errors of rates (rad/s)" },
            "samples_s": { "type": "array", "items": { "type": "number" }, "description": "times of the rows of courses.csv (s)" },
            "columns": { "type": "array", "items": { "type": "string" }, "description": "columns of courses.csv: those of every run, then the channels that the scene asks for, which may be left out" },
            "law_library": { "type": ["string", "null"], "description": "path of libpinwheel_law; null if it was not built" },
        },
        "required": ["protocol", "scene", "bodies", "rate_rad_s", "elastic_twist_rad", "vibration_rad_s", "samples_s", "columns", "law_library"],
    })
}
