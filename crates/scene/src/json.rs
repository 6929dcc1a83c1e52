//! JSON form of scenes: tables and keys as in TOML, alone or as the `scene` of a job file.

use serde_json::Value;

/// Version of job files (`scene.json`).
pub const JOB_PROTOCOL: u64 = 1;

/// True if a text is JSON: no TOML begins with a brace.
pub(crate) fn is_json(text: &str) -> bool {
    text.trim_start().starts_with('{')
}

/// Returns the scene of a JSON text as TOML, or line and fault.
pub(crate) fn as_toml(text: &str) -> Result<String, (usize, String)> {
    let mut value: Value =
        serde_json::from_str(text).map_err(|error| (error.line(), error.to_string()))?;
    if let Some(protocol) = value.get("protocol") {
        if protocol.as_u64() != Some(JOB_PROTOCOL) {
            return Err((
                1,
                format!("protocol {protocol} is unknown; this program has protocol {JOB_PROTOCOL}"),
            ));
        }
        value = value["scene"].take();
        if !value.is_object() {
            return Err((1, "the job holds no `scene`".to_owned()));
        }
    }
    without_nulls(&mut value);
    toml::to_string(&value).map_err(|error| (1, error.to_string()))
}

/// Removes nulls, which TOML does not have.
fn without_nulls(value: &mut Value) {
    if let Value::Object(table) = value {
        table.retain(|_, inner| !inner.is_null());
        table.values_mut().for_each(without_nulls);
    }
}
