//! Builds the page of the simulated knob as one HTML file. The page loads nothing from elsewhere, and its content security policy
//! forbids loading.

use crate::desk::{FACTS, ROW, TRACE_COLUMNS};
use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use sha2::{Digest, Sha256};

/// The simulator's loop as a WebAssembly module, built by `cargo xtask live`. The file `MADE.txt` next to the module records the
/// compiler and the profile of the build.
pub const MODULE: &[u8] = include_bytes!("../module/touchstone_live.wasm");

/// The first bytes of every page. By these bytes the program recognises a page that it wrote itself and may overwrite.
pub const MARK: &str = "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\"";

const PAGE: &str = include_str!("../page/page.html");
pub(crate) const STYLE: &str = include_str!("../page/page.css");
pub(crate) const MEMORY: &str = include_str!("../page/memory.js");
pub(crate) const UNPACK: &str = include_str!("../page/unpack.js");
pub(crate) const PACING: &str = include_str!("../page/pacing.js");
const WORKER: [&str; 4] = [
    "\"use strict\";\n",
    MEMORY,
    PACING,
    include_str!("../page/worker.js"),
];
pub(crate) const VIEW: &str = include_str!("../page/view.js");
pub(crate) const SAVE: &str = include_str!("../page/save.js");
pub(crate) const STAGE: &str = include_str!("../page/stage.js");
const SCRIPT: [&str; 11] = [
    "\"use strict\";\n",
    UNPACK,
    include_str!("../page/presets.js"),
    VIEW,
    include_str!("../page/profile.js"),
    include_str!("../page/parts.js"),
    SAVE,
    STAGE,
    include_str!("../page/page.js"),
    include_str!("../page/open.js"),
    include_str!("../page/start.js"),
];

/// Data that are written into the web page when it is built.
#[derive(Debug, Clone, Copy)]
pub struct Content<'a> {
    /// The scene (description of the simulation) as TOML text, with the changes of the command line.
    pub scene: &'a str,
    /// Name of the scene (the simulated situation), shown on the page.
    pub name: &'a str,
    /// What the simulation of the page shows, in one sentence.
    pub description: &'a str,
    /// Command-line arguments after `touchstone live` that give the same simulation as the page, quoted for a shell.
    pub source: &'a str,
    /// Name, version and commit of the program that made the page.
    pub program: &'a str,
    /// Whether the page begins with the editor of feels open.
    pub edits: bool,
}

/// Returns the page of the simulated knob as HTML.
#[must_use]
pub fn render(content: &Content) -> String {
    let script = SCRIPT.concat();
    let data = serde_json::json!({
        "scene": content.scene,
        "name": content.name,
        "description": content.description,
        "source": content.source,
        "feels": feels(),
        "edits": content.edits,
        "row": ROW,
        "facts": FACTS,
        "trace": TRACE_COLUMNS,
    });
    let policy = format!(
        "default-src 'none'; script-src '{}' 'wasm-unsafe-eval'; style-src '{}'; worker-src blob:; img-src data: blob:; base-uri 'none'; form-action 'none'",
        hash(&script),
        hash(STYLE)
    );
    let parts: [(&str, &str); 7] = [
        ("POLICY", &policy),
        ("STYLE", STYLE),
        ("PROGRAM", &escape(content.program)),
        ("CONTENT", &block(&data)),
        ("MODULE", &packed_module()),
        ("WORKER", &WORKER.concat()),
        ("SCRIPT", &script),
    ];
    fill(PAGE, &parts)
}

/// Name and description of every shipped haptic effect (detents, end stops and similar).
fn feels() -> Vec<(&'static str, String)> {
    let named = touchstone_sim::scene::feels().into_iter();
    named
        .map(|name| {
            let feel = touchstone_sim::scene::Scene::load(name).expect("a shipped scene");
            (name, feel.description)
        })
        .collect()
}

/// The WebAssembly module, compressed to about a third of its size and encoded as text for the page.
pub(crate) fn packed_module() -> String {
    BASE64.encode(miniz_oxide::deflate::compress_to_vec_zlib(MODULE, 9))
}

/// Replaces each placeholder `{{NAME}}` in the template by the text of the part of that name, and returns the result.
pub(crate) fn fill(template: &str, parts: &[(&str, &str)]) -> String {
    let mut page = String::with_capacity(1 << 20);
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").unwrap_or((after, ""));
        page.push_str(before);
        let part = parts.iter().find(|(known, _)| *known == name);
        page.push_str(part.map_or("", |(_, text)| text));
        rest = after;
    }
    page + rest
}

/// Writes data as JSON for a script block of the page, with `<` escaped, so that no text ends the block.
pub(crate) fn block(data: &serde_json::Value) -> String {
    data.to_string().replace('<', "\\u003c")
}

/// SHA-256 hash of a script or style block, in the format of a content security policy.
pub(crate) fn hash(text: &str) -> String {
    format!("sha256-{}", BASE64.encode(Sha256::digest(text)))
}

pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
