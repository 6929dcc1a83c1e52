//! JSON schema of scene files from the table of keys, for completion and checks in editors.

use serde_json::{Map, Value, json};

use crate::keys::{DefaultValue, KEYS, Key, Kind, Range};

/// Title of the schema.
pub const TITLE: &str = "A scene of pinwheel";

/// JSON schema (draft 2020-12) of a scene file.
///
/// ```
/// let schema = pinwheel_scene::schema::schema();
/// let wheels = &schema["properties"]["gear"]["properties"]["wheels"];
/// assert_eq!((wheels["type"].as_str(), wheels["minimum"].as_u64()), (Some("integer"), Some(1)));
/// ```
pub fn schema() -> Value {
    let mut root = table();
    for row in KEYS {
        let mut at = &mut root;
        let path = row.path();
        let (name, tables) = path.split_last().unwrap_or((&"", &[]));
        for part in tables {
            let inner = &mut at["properties"][*part];
            if inner.is_null() {
                *inner = table();
            }
            at = inner;
        }
        at["properties"][*name] = of(row);
    }
    root["properties"][crate::uncertain::UNCERTAIN] = json!({
        "type": "object",
        "description": "how well values are known, by key: gear.backlash_m = { plus_minus = 5e-6 }",
    });
    root["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    root["title"] = json!(TITLE);
    root["properties"]["base"] = json!({
        "type": "string",
        "description": "preset or scene file from which everything is taken that is left out here",
    });
    root
}

fn table() -> Value {
    json!({ "type": "object", "additionalProperties": false, "properties": {} })
}

fn of(row: &Key) -> Value {
    let mut about = row.about.to_owned();
    if !row.unit().is_empty() {
        about = format!("{about} ({})", row.unit());
    }
    let mut schema: Map<String, Value> = match row.kind {
        Kind::Number(range) => number(range),
        Kind::Count(low, high) => json!({ "type": "integer", "minimum": low, "maximum": high }),
        Kind::Choice(_, names) => json!({ "enum": names() }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Text => json!({ "type": "string" }),
        Kind::Choices(_, names) => json!({
            "type": ["string", "array"], "items": { "enum": names() },
        }),
        Kind::Texts => json!({ "type": ["string", "array"], "items": { "type": "string" } }),
        Kind::Numbers(range) => json!({ "type": "array", "items": number(range) }),
        Kind::Tables(rows) => {
            let mut item = table();
            for row in rows {
                item["properties"][row.name] = of(row);
            }
            let needed = rows
                .iter()
                .filter(|row| matches!(row.otherwise, DefaultValue::Required));
            item["required"] = needed.map(|row| row.name).collect();
            json!({ "type": "array", "items": item })
        }
    }
    .as_object()
    .cloned()
    .unwrap_or_default();
    match row.otherwise {
        DefaultValue::Required | DefaultValue::Needed | DefaultValue::Nothing => {}
        DefaultValue::Constant(text, why) => {
            about = format!("{about}; if left out {text}: {why}");
            let value: Option<toml::Value> = text.parse().ok();
            if let Some(value) = value.and_then(|value| serde_json::to_value(value).ok()) {
                schema.insert("default".to_owned(), value);
            }
        }
        DefaultValue::Formula(_, formula) => about = format!("{about}; if left out: {formula}"),
    }
    schema.insert("description".to_owned(), Value::String(about));
    Value::Object(schema)
}

fn number(range: Range) -> Value {
    match range {
        Range::From(low, high) => json!({ "type": "number", "minimum": low, "maximum": high }),
        Range::Between(low, high) => {
            json!({ "type": "number", "exclusiveMinimum": low, "exclusiveMaximum": high })
        }
    }
}
