//! Makes the JSON schema of the results of `touchstone accuracy`, stored in `docs/schema/accuracy.schema.json`.

use serde_json::{Value, json};

use touchstone_report::plain_schema::{array, document, object, program};

const TIME: &[(&str, &str, &str)] = &[
    ("least_ns", "number", "least of the repeats; ns"),
    ("lower_quartile_ns", "number", "lower quartile; ns"),
    ("median_ns", "number", "median; ns"),
    ("upper_quartile_ns", "number", "upper quartile; ns"),
];

fn nullable(mut object: Value) -> Value {
    object["type"] = json!(["object", "null"]);
    object
}

/// The JSON schema of the results of `touchstone accuracy`.
#[must_use]
pub fn schema() -> Value {
    let time = object(TIME, &[]);
    let point = object(
        &[
            ("method", "string", "method, by its name in scenes"),
            (
                "substeps",
                "integer?",
                "substeps a tick; null: the exact step has none",
            ),
            (
                "error_rad",
                "number?",
                "largest error of the angle at any tick's end; rad; null: it diverged",
            ),
            (
                "error_rms_rad",
                "number?",
                "root of the mean square of that error; rad",
            ),
            (
                "energy_gap",
                "number?",
                "largest gap in the energy's books over what went through them",
            ),
        ],
        &[("time", time.clone())],
    );
    let diagram = object(
        &[
            ("problem", "string", "name of the problem"),
            ("about", "string", "what is hard about it"),
            ("ticks", "integer", "simulated milliseconds"),
            ("events", "integer", "stops and starts in them"),
            (
                "reference_floor_rad",
                "number",
                "largest possible error of the reference; rad",
            ),
        ],
        &[("points", array(point))],
    );
    let cheapest = nullable(object(
        &[
            ("method", "string", "method"),
            ("substeps", "integer?", "substeps a tick"),
            ("error_rad", "number", "its error; rad"),
            (
                "least_ns",
                "number",
                "its least time per simulated millisecond; ns",
            ),
        ],
        &[],
    ));
    let chosen = object(
        &[
            ("problem", "string", "name of the problem"),
            (
                "times_the_exact",
                "number?",
                "time of the cheapest other method over the exact step's",
            ),
        ],
        &[("of_all", cheapest.clone()), ("without_exact", cheapest)],
    );
    let law = object(
        &[
            ("law", "string", "law"),
            ("number", "string", "number format"),
            (
                "refused",
                "string?",
                "why the format does not hold the law's settings",
            ),
            (
                "force_error_n_m",
                "number?",
                "largest difference of the force from f64; N·m",
            ),
            (
                "force_error_rms_n_m",
                "number?",
                "root of the mean square of that difference; N·m",
            ),
            (
                "energy_error_j",
                "number?",
                "largest difference of the energy that the wall took; J",
            ),
            (
                "force_floor_n_m",
                "number",
                "the force's change in f64 when positions change by 1e-12 of themselves; N·m",
            ),
            ("energy_floor_j", "number", "the energy's; J"),
            (
                "board_instructions",
                "number?",
                "instructions of a tick on a Cortex-M4F, in the mean of hostile motions; null: not counted",
            ),
            ("board_instructions_worst", "integer?", "the same at worst"),
        ],
        &[("time", nullable(time))],
    );
    let sampling = object(
        &[
            ("law", "string", "law"),
            (
                "k_desired_n_m_per_rad",
                "number",
                "desired stiffness; N·m/rad",
            ),
            ("rate_hz", "integer", "control rate; Hz"),
            ("counts_per_rev", "integer", "encoder's counts a turn"),
            ("verdict", "string", "how the run ended"),
            (
                "stiffness_error",
                "number?",
                "displayed stiffness at rest over the desired one, less 1",
            ),
            (
                "dynamic_stiffness_error",
                "number?",
                "modulus of force over penetration over the desired stiffness, less 1",
            ),
            (
                "dynamic_stiffness_phase_deg",
                "number?",
                "phase of the force before the penetration; degrees",
            ),
            (
                "ripple_rms_n_m",
                "number?",
                "torque's change from tick to tick, rms; N·m",
            ),
            (
                "energy_out_wall_worst_window_j",
                "number?",
                "most energy that the wall's port gave in any window; J",
            ),
            (
                "energy_out_worst_window_j",
                "number?",
                "most energy that the hand got in any window; J",
            ),
            (
                "k_max_n_m_per_rad",
                "number",
                "least unstable stiffness of the bare device's loop; N·m/rad",
            ),
            (
                "board_load_at_most",
                "number?",
                "share of the board's processor at most; null: no board takes this rate",
            ),
        ],
        &[],
    );
    let closed = object(
        &[
            ("scene", "string", "scene"),
            ("method", "string", "method"),
            ("substeps", "integer?", "substeps a tick"),
            ("verdict", "string", "how the run ended"),
            (
                "k_displayed_n_m_per_rad",
                "number?",
                "displayed stiffness at rest; N·m/rad",
            ),
            (
                "energy_out_worst_window_j",
                "number",
                "most energy that the hand got in any window; J",
            ),
            (
                "penetration_max_rad",
                "number?",
                "deepest penetration; rad; null: the run left all numbers",
            ),
            (
                "path_difference_rad",
                "number?",
                "largest difference from the exact run's path; rad",
            ),
            (
                "k_max_n_m_per_rad",
                "number?",
                "least unstable stiffness under this method; N·m/rad; null: none is stable",
            ),
            (
                "k_max_error",
                "number?",
                "the same over the exact step's, less 1",
            ),
        ],
        &[],
    );
    let machine = object(
        &[
            ("cpu", "string", "processor"),
            ("compiler", "string", "compiler"),
            (
                "optimised",
                "boolean",
                "built for speed; if not, no time means anything",
            ),
        ],
        &[],
    );
    let files =
        json!({"type": "array", "items": {"type": "string"}, "description": "files of the folder"});
    let whole = object(
        &[
            ("schema_version", "integer", "version of this layout"),
            ("command", "string", "command line that makes this again"),
            ("quick", "boolean", "a quick run, not to be published"),
            ("repeats", "integer", "repeats of every time"),
            ("count_rad", "number", "one encoder count; rad"),
            (
                "force_quantum_n_m",
                "number",
                "one step of force of the 32-bit format; N·m",
            ),
        ],
        &[
            ("program", program()),
            ("machine", machine),
            ("files", files),
            ("plant", array(diagram)),
            ("within_a_count", array(chosen)),
            ("law", array(law)),
            ("sampling", array(sampling)),
            ("closed_loop", array(closed)),
        ],
    );
    document(
        "Accuracy of Touchstone",
        "results.json of the folder of `touchstone accuracy`, and what its --json prints.",
        whole,
    )
}
