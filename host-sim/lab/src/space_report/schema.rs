//! Makes JSON schemas of two types of `results.json`: the comparison in three degrees of freedom, and a run on a haptic device. The
//! texts are stored in `docs/schema`.

use crate::scorecard::measure::Measure;
use serde_json::{Value, json};
use touchstone_report::plain_schema::{array, document, object};

/// The schema of a value that may be null.
fn optional(mut schema: Value) -> Value {
    schema["type"] = json!([schema["type"], "null"]);
    schema
}

fn items(kind: &str, meaning: &str) -> Value {
    json!({"type": "array", "items": {"type": kind}, "description": meaning})
}

/// Schema of a scorecard's figures in one direction.
fn figures() -> Value {
    let leaf = json!({"type": ["number", "null"], "description": "in the unit of its name, a ripple in newtons; null: lost"});
    let named = Measure::ALL.map(|measure| {
        (
            json!(measure).as_str().unwrap_or_default().to_owned(),
            leaf.clone(),
        )
    });
    let further: Vec<(&str, Value)> = named
        .iter()
        .map(|(name, leaf)| (name.as_str(), leaf.clone()))
        .collect();
    object(&[], &further)
}

const SETTLE: (&str, &str, &str) = (
    "settle_from_ramp_end_s",
    "number?",
    "until a press stayed within 5 %; s; null: it never did",
);
const FILES: &str = "what is in the folder";

fn held_out() -> Value {
    let worst = object(
        &[
            ("measure", "string", "which figure"),
            ("value", "number?", "the largest; null: lost"),
            ("median", "number?", "in the middle of all walls"),
            ("beyond", "integer", "how many walls are beyond its limit"),
            ("wall", "string", "the wall of the largest"),
        ],
        &[],
    );
    let beyond = object(
        &[
            ("wall", "string", "which wall, hand and device"),
            (
                "longest_n",
                "number",
                "largest force commanded of the motors; N",
            ),
            (
                "cause",
                "string",
                "the one change that brings it within: motors-limit, delay, damping, inertia; or none-alone",
            ),
        ],
        &[("figures", items("string", "what is beyond its limit"))],
    );
    optional(object(
        &[
            ("seed", "integer", "of the draw"),
            ("walls", "integer", "how many were played"),
            (
                "beyond",
                "integer",
                "how many have a figure beyond its limit",
            ),
            (
                "beyond_at_the_motors_limit",
                "integer",
                "of these, how many for a push that the motors cannot answer",
            ),
            SETTLE,
        ],
        &[("worst", array(worst)), ("beyond_walls", array(beyond))],
    ))
}

/// Schema of the results of `touchstone thesis --dof 3`.
#[must_use]
pub fn comparison() -> Value {
    let run = object(
        &[
            ("object", "string", "what was touched"),
            ("texture", "string?", "grooves in its surface; null: smooth"),
            (
                "material",
                "string?",
                "vibration at the touch: a material, or its values; null: none",
            ),
            (
                "approach",
                "string",
                "the law, and how it is applied to three axes",
            ),
            ("k_desired_n_per_mm", "number", "desired stiffness; N/mm"),
            ("verdict", "string", "how it ended, as of one axis"),
            (
                "not_judged",
                "string?",
                "why it could not be judged; null: it was",
            ),
            ("stopped", "boolean", "whether the mechanism ended it early"),
            (
                "displayed_at_rest_n_per_mm",
                "number?",
                "stiffness shown in the hold; N/mm",
            ),
            ("ripple_at_rest_mm", "number?", "RMS motion in the hold; mm"),
            (
                "displayed_sliding_n_per_mm",
                "number?",
                "stiffness shown while sliding; N/mm",
            ),
            ("slide_mm_per_s", "number?", "mean speed of the slide; mm/s"),
            (
                "most_tangential_over_normal",
                "number?",
                "largest tangential over normal force of the slide",
            ),
            (
                "largest_tangential_step_over_normal",
                "number?",
                "its largest change in a tick",
            ),
            (
                "energy_out_j",
                "number",
                "most energy that the hand got beyond what it gave; J",
            ),
            (
                "books_off_j",
                "number?",
                "by how much the energy audit is off; J",
            ),
        ],
        &[],
    );
    let claim = object(
        &[
            ("name", "string", "name of the claim"),
            ("source", "string", "where it is made"),
            ("statement", "string", "what is claimed"),
            ("outcome", "string", "whether it was reproduced"),
            ("measured", "string", "what was found"),
        ],
        &[],
    );
    let device = object(
        &[("device", "string", "how the device differs"), SETTLE],
        &[("figures", figures())],
    );
    let direction = object(
        &[("direction", "string", "the normal, in words"), SETTLE],
        &[
            ("normal", items("number", "out of the wall")),
            ("worst", figures()),
            ("devices", array(device)),
        ],
    );
    document(
        "The comparison in three degrees of freedom",
        "What `touchstone thesis --dof 3` writes as results.json.",
        object(
            &[
                ("command", "string", "the command that makes it again"),
                ("program", "string", "version of the program"),
                ("dof", "integer", "3"),
                (
                    "mechanism",
                    "string",
                    "what it was played on: cartesian or delta",
                ),
            ],
            &[
                ("files", items("string", FILES)),
                ("held_out", held_out()),
                ("runs", array(run)),
                ("claims", array(claim)),
                ("directions", array(direction)),
            ],
        ),
    )
}

fn device_card() -> Value {
    let figure = object(
        &[
            ("key", "string", "which figure"),
            (
                "value",
                "number?",
                "in the unit of its name; null: not measured, or lost",
            ),
            ("limit", "number?", "its limit; null: no limit"),
            (
                "not_measured",
                "string?",
                "why it is not known; null: it is",
            ),
        ],
        &[],
    );
    let moved = object(
        &[
            ("frequency_hz", "number", "of the hand; Hz"),
            (
                "modulus_n_per_m",
                "number?",
                "|F/x|; N/m; null: the hand left the wall",
            ),
            ("phase_deg", "number?", "lead of the force; degrees"),
            ("stretches", "integer", "in how many stretches"),
        ],
        &[],
    );
    optional(object(
        &[(
            "commanded",
            "boolean",
            "whether the hand followed the scorecard's programme",
        )],
        &[("figures", array(figure)), ("moved", array(moved))],
    ))
}

/// Schema of the results of `touchstone device run --out`.
#[must_use]
pub fn device_run() -> Value {
    let wall = object(
        &[
            ("law", "string", "the law along the normal"),
            ("k_desired_n_per_m", "number", "desired stiffness; N/m"),
            ("source", "string", "where law and stiffness come from"),
            (
                "caution",
                "string?",
                "limits that the wall is known to exceed",
            ),
            ("guarded", "boolean", "whether the energy guard was in"),
        ],
        &[],
    );
    let class = object(
        &[
            (
                "up_to_us",
                "number?",
                "upper end of the class; us; null: the last has none",
            ),
            ("ticks", "integer", "ticks that were so late"),
        ],
        &[],
    );
    let run = object(
        &[
            ("device", "string", "its name"),
            ("rate_hz", "integer", "control rate; Hz"),
            ("ticks", "integer", "ticks that were played"),
            (
                "missed_ticks",
                "integer",
                "ticks that were left out for lateness",
            ),
            (
                "late_limit_ms",
                "number",
                "a force held longer than this ends a run; ms",
            ),
            ("lateness_max_us", "number", "the latest tick; us"),
            ("stale_ticks", "integer", "ticks with an old position"),
            (
                "saturated_ticks",
                "integer",
                "ticks in which the motors saturated",
            ),
            ("outside_ticks", "integer", "ticks outside the workspace"),
            ("force_max_n", "number", "longest force; N"),
            ("speed_max_m_per_s", "number", "fastest motion; m/s"),
            (
                "guard_account_min_j",
                "number?",
                "least that the guard's account had; J; null: no guard",
            ),
            (
                "real_time_priority",
                "boolean?",
                "whether it ran first among threads; null: not in real time",
            ),
            ("memory_locked", "boolean?", "whether its memory was locked"),
            ("fault", "string?", "what ended it; null: nothing did"),
            (
                "release_failed",
                "string?",
                "what of the release failed; null: nothing",
            ),
        ],
        &[
            ("wall", wall),
            ("lateness", array(class)),
            ("scorecard", device_card()),
        ],
    );
    document(
        "A wall on a haptic device",
        "What `touchstone device run --out` writes as results.json.",
        object(
            &[
                ("command", "string", "the command that makes it again"),
                ("version", "string", "version of the program"),
                ("commit", "string?", "commit that it was built from"),
                (
                    "modified",
                    "boolean",
                    "whether its sources differed from the commit",
                ),
            ],
            &[("files", items("string", FILES)), ("run", run)],
        ),
    )
}

#[cfg(test)]
mod tests {
    use crate::documented::is_documented;

    #[test]
    fn the_documented_schemas_are_these() {
        is_documented("thesis-space.schema.json", &super::comparison());
        is_documented("device-run.schema.json", &super::device_run());
    }
}
