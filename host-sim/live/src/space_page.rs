//! Builds the web page of the simulated device with three axes.

use crate::page::{
    MARK, MEMORY, PACING, STYLE, UNPACK, VIEW, block, escape, fill, hash, packed_module,
};
use touchstone_control::settings::ImpactSettings;

use crate::space_loop::{SPACE_ROW, SpaceChoice, SpaceObject};

const PAGE: &str = include_str!("../page/space.html");
const SPACE_STYLE: &str = include_str!("../page/space.css");
const BASIS: &str = include_str!("../page/space_basis.js");
const STRICT: &str = "\"use strict\";\n";
const WORKER: [&str; 5] = [
    STRICT,
    MEMORY,
    PACING,
    BASIS,
    include_str!("../page/space_worker.js"),
];
const SCRIPT: [&str; 6] = [
    STRICT,
    UNPACK,
    VIEW,
    BASIS,
    include_str!("../page/space_view.js"),
    include_str!("../page/space_page.js"),
];

/// Returns the page as HTML. The simulation starts with the settings in `shipped`. If the user chooses a law by its name, the
/// settings are those in `thesis`, with that law. `materials` are the names of materials, with pulse and vibration at the touch of the
/// shipped wall. `program` is the name, version and commit shown.
#[must_use]
pub fn render(
    shipped: &SpaceChoice,
    thesis: &SpaceChoice,
    materials: &[(&str, ImpactSettings)],
    program: &str,
) -> String {
    let script = SCRIPT.concat();
    let style = format!("{STYLE}{SPACE_STYLE}");
    let object = match shipped.object {
        SpaceObject::Sphere(_) => "sphere",
        SpaceObject::Plane([x, y, _]) if x == 0.0 && y == 0.0 => "plane",
        SpaceObject::Plane(_) => "inclined",
    };
    let materials: Vec<(&str, String)> = materials
        .iter()
        .map(|(name, impact)| {
            let mut choice = shipped.clone();
            choice.law.impact = *impact;
            let text = choice.to_text();
            let lines = text.lines().filter(|line| line.starts_with("impact_"));
            (*name, lines.map(|line| format!("{line}\n")).collect())
        })
        .collect();
    let data = serde_json::json!({
        "materials": materials,
        "shipped": shipped.to_text(),
        "thesis": thesis.to_text(),
        "object": object,
        "row": SPACE_ROW,
    });
    let policy = format!(
        "default-src 'none'; script-src '{}' 'wasm-unsafe-eval'; style-src '{}'; worker-src blob:; img-src data:; base-uri 'none'; form-action 'none'",
        hash(&script),
        hash(&style)
    );
    let page = fill(
        PAGE,
        &[
            ("POLICY", &policy),
            ("STYLE", &style),
            ("PROGRAM", &escape(program)),
            ("CONTENT", &block(&data)),
            ("MODULE", &packed_module()),
            ("WORKER", &WORKER.concat()),
            ("SCRIPT", &script),
        ],
    );
    debug_assert!(page.starts_with(MARK));
    page
}
