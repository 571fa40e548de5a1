//! Makes the JSON schema of the description of how a scene is simulated, stored in `docs/schema/plan.schema.json`.

use serde_json::{Value, json};

use touchstone_report::plain_schema::{array, document, object, program};

/// The JSON schema of the description of how a scene is simulated.
#[must_use]
pub fn schema() -> Value {
    let eigenvalue = object(
        &[
            (
                "re_per_s",
                "number",
                "real part: growth where positive; 1/s",
            ),
            (
                "im_rad_per_s",
                "number",
                "imaginary part, not negative; rad/s",
            ),
            (
                "frequency_hz",
                "number?",
                "frequency of a swinging pair; Hz",
            ),
        ],
        &[],
    );
    let named = object(
        &[
            ("name", "string", "an effect"),
            ("place", "string", "where it stands in the loop"),
            (
                "instructions",
                "number?",
                "instructions a tick that it adds alone, by the ladder",
            ),
            (
                "ns",
                "number?",
                "time of a tick with it less that without it; ns",
            ),
        ],
        &[],
    );
    let moved = object(
        &[
            ("output", "string", "an output, as the results name it"),
            (
                "without",
                "number?",
                "without the effect, in the results' unit",
            ),
            ("with", "number?", "with it"),
        ],
        &[],
    );
    let omitted = object(
        &[
            ("name", "string", "an effect that the scene does not name"),
            ("field", "string", "field or table that would name it"),
            ("typical", "string", "the magnitude at which it was tried"),
            ("source", "string", "source for this magnitude"),
            (
                "verdict",
                "string?",
                "the verdict with it, where that is another",
            ),
            ("not_tried", "string?", "why it was not tried"),
        ],
        &[("moves", array(moved))],
    );
    let mut measured = object(
        &[
            ("least_ns", "number", "least of the repeats; ns a tick"),
            ("lower_quartile_ns", "number", "lower quartile; ns"),
            ("median_ns", "number", "median; ns"),
            ("upper_quartile_ns", "number", "upper quartile; ns"),
        ],
        &[],
    );
    measured["type"] = json!(["object", "null"]);
    let words = || json!({"type": "array", "items": {"type": "string"}});
    document(
        "A plan of Touchstone",
        "What `touchstone plan --json` prints.",
        object(
            &[
                ("schema_version", "integer", "version of this layout"),
                ("scene", "string", "the scene"),
                ("tier", "string", "how the plant crosses a tick"),
                (
                    "substeps",
                    "integer",
                    "substeps of a tick; 1 for an exact step",
                ),
                (
                    "predicted_instructions",
                    "number?",
                    "instructions a tick by the ladder",
                ),
                (
                    "tolerance",
                    "number",
                    "relative change of an output from which on an effect is listed",
                ),
            ],
            &[
                ("program", program()),
                ("states", words()),
                ("eigenvalues", array(eigenvalue)),
                ("reasons", words()),
                ("effects", array(named)),
                ("measured", measured),
                ("omitted", array(omitted)),
            ],
        ),
    )
}
