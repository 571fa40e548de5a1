//! Makes the JSON schema of the results of `touchstone hard`, stored in `docs/schema/hard.schema.json`.

use serde_json::Value;

use touchstone_report::plain_schema::{array, document, object, program};

/// The JSON schema of the results of `touchstone hard`.
#[must_use]
pub fn schema() -> Value {
    let finding = object(
        &[
            (
                "subject",
                "string",
                "plant, integrator, or law with its number format",
            ),
            (
                "value",
                "number?",
                "what was measured, in the case's unit; null: beyond all numbers",
            ),
            ("bound", "number", "its limit"),
            (
                "fails_because",
                "string?",
                "why this case is expected to exceed the limit; null: it must not",
            ),
        ],
        &[],
    );
    let case = object(
        &[
            ("name", "string", "name of the case"),
            ("about", "string", "what is hard"),
            ("oracle", "string", "what knows the answer"),
            ("unit", "string", "unit of values and bounds"),
            (
                "passed",
                "boolean",
                "every case gave the expected result, expected failures included",
            ),
            ("seconds", "number", "time it took; s"),
        ],
        &[("findings", array(finding))],
    );
    document(
        "Hard cases of Touchstone",
        "What `touchstone hard --json` prints.",
        object(
            &[
                ("schema_version", "integer", "version of this layout"),
                ("long", "boolean", "whether the long form ran"),
                ("passed", "boolean", "whether every case passed"),
            ],
            &[("program", program()), ("cases", array(case))],
        ),
    )
}
