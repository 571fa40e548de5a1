//! Makes the JSON schema of a map's `results.json`, stored in `docs/schema/sweep.schema.json`.

use super::measure::verdicts;
use serde_json::{Value, json};
use touchstone_report::plain_schema::{Field, array, document, object, program};

/// The JSON schema of a map's `results.json`.
#[must_use]
pub fn schema() -> Value {
    let texts = || array(json!({"type": "string"}));
    let axis = object(
        &[
            ("field", "string", "path of the field in a scene"),
            (
                "unit",
                "string",
                "its unit; empty: a plain number, or words",
            ),
            (
                "log",
                "boolean",
                "whether the values are evenly spaced on a logarithmic scale",
            ),
        ],
        &[(
            "values",
            array(json!({"type": ["number", "string", "boolean"]})),
        )],
    );
    let words: Vec<Field> = verdicts()
        .into_iter()
        .map(|word| (word, "integer", "cells of this verdict"))
        .collect();
    let measure = object(
        &[
            ("name", "string", "name of the column"),
            ("unit", "string", "SI unit; `1` is a plain number"),
            ("meaning", "string", "what it is"),
            ("cells", "integer", "cells that have one"),
            ("least", "number?", "least value; null: no cell has one"),
            ("most", "number?", "largest value"),
        ],
        &[],
    );
    let shard = object(
        &[
            ("index", "integer", "which part of the cells, from 1"),
            ("of", "integer", "in how many parts; 1: the whole"),
        ],
        &[],
    );
    let input = object(
        &[
            ("path", "string", "a file that the scene reads"),
            ("sha256", "string", "hash of its bytes"),
            ("bytes", "integer", "its length"),
        ],
        &[],
    );
    document(
        "A map of Touchstone",
        "What `touchstone sweep` writes as results.json and prints with --json.",
        object(
            &[
                ("schema_version", "integer", "version of this layout"),
                (
                    "command",
                    "string",
                    "the command that makes the whole again",
                ),
                ("scene", "string", "name of the scene that was varied"),
                ("scene_sha256", "string", "hash of scene.toml"),
                ("cells", "integer", "cells in this folder"),
            ],
            &[
                ("program", program()),
                ("inputs", array(input)),
                ("files", texts()),
                ("shard", shard),
                ("x", axis.clone()),
                ("y", axis),
                ("verdicts", object(&words, &[])),
                ("measures", array(measure)),
                ("lines", texts()),
            ],
        ),
    )
}
