//! Builds the web page of the simulated device with three axes.

use crate::page::{
    MARK, MEMORY, PACING, SAVE, STYLE, UNPACK, VIEW, block, escape, fill, hash, packed_module,
};
use touchstone_control::Choice as _;
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
const SCRIPT: [&str; 8] = [
    STRICT,
    UNPACK,
    VIEW,
    BASIS,
    SAVE,
    include_str!("../page/space_view.js"),
    include_str!("../page/space_scene.js"),
    include_str!("../page/space_page.js"),
];

/// A material that the shipped wall can have.
#[derive(Debug, Clone)]
pub struct Material<'a> {
    /// The material's name.
    pub name: &'a str,
    /// Pulse and vibration at the touch.
    pub impact: ImpactSettings,
    /// The same as lines of the table `[law.impact]` of a scene of three axes.
    pub scene: String,
}

/// Returns the page as HTML. The simulation starts with the settings in `shipped`. If the user chooses a law by its name, the
/// settings are those in `thesis` for that law. `program` is the name, version and commit shown.
#[must_use]
pub fn render(
    shipped: &SpaceChoice,
    thesis: &[SpaceChoice],
    materials: &[Material],
    program: &str,
) -> String {
    let script = SCRIPT.concat();
    let style = format!("{STYLE}{SPACE_STYLE}");
    let object = match shipped.object {
        SpaceObject::Sphere(_) => "sphere",
        SpaceObject::Plane([x, y, _]) if x == 0.0 && y == 0.0 => "plane",
        SpaceObject::Plane(_) => "inclined",
    };
    let materials: Vec<(&str, String, &str)> = materials
        .iter()
        .map(|material| {
            let mut choice = shipped.clone();
            choice.law.impact = material.impact;
            let text = choice.to_text();
            let lines = text.lines().filter(|line| line.starts_with("impact_"));
            let lines = lines.map(|line| format!("{line}\n")).collect();
            (material.name, lines, &*material.scene)
        })
        .collect();
    let thesis: serde_json::Map<String, serde_json::Value> = thesis
        .iter()
        .map(|choice| (choice.law.law.word().to_owned(), choice.to_text().into()))
        .collect();
    let data = serde_json::json!({
        "materials": materials,
        "shipped": shipped.to_text(),
        "thesis": thesis,
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
