//! The interactive page inside a report ("Try this cell"), on which a reader can try a run's wall with the mouse.

use super::ReportInput;
use super::origin::Origin;
use super::svg::escape;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use touchstone_sim::scene::MotionSpec;

/// Controls with which a reader tries a run's wall with the mouse: a button, if the report contains the interactive page, and a
/// command line. Empty if the scene was not written out.
pub fn button(input: &ReportInput, origin: &Origin, index: usize) -> String {
    let Some(scene) = origin.runs.get(index).and_then(|run| run.scene.as_ref()) else {
        return String::new();
    };
    let path = escape(&scene.path);
    let command = format!("<code>touchstone live {path}</code>");
    let recorded = |index: usize| {
        let scene = input.scenes.get(index);
        scene.is_some_and(|scene| matches!(scene.operator.motion, MotionSpec::Recorded(_)))
    };
    match input.live_page {
        None => {
            format!("<p class=\"note\">Push this wall yourself, from this folder: {command}</p>\n")
        }
        Some(_) if recorded(index) => format!(
            "<p class=\"note\">Push this wall yourself, from this folder: {command}. It is not part of this page, because its hand is a recording in a file.</p>\n"
        ),
        Some(_) => format!(
            "<p class=\"note\"><button type=\"button\" class=\"try\" data-scene=\"{path}\" hidden>Try this cell</button> Push this wall yourself; from this folder: {command}</p>\n"
        ),
    }
}

/// Text of a scene file without comments and empty lines.
fn bare(text: &str) -> String {
    let mut bare = String::with_capacity(text.len() / 2);
    for line in text.lines() {
        // A `#` inside a quoted text does not start a comment.
        let line = match line.split_once('#') {
            Some((before, _)) if !before.contains('"') => before.trim_end(),
            _ => line,
        };
        if !line.is_empty() {
            bare.push_str(line);
            bare.push('\n');
        }
    }
    bare
}

/// Writes data as a script block of the page; the sequence that would end the block is escaped.
fn block(page: &mut String, id: &str, data: &serde_json::Value) {
    let data = data.to_string().replace('<', "\\u003c");
    let _ = writeln!(
        page,
        "<script type=\"application/json\" id=\"{id}\">{data}</script>"
    );
}

/// Writes the interactive page, the scenes, and the script that starts them; nothing if there is no page or no scene.
pub fn inside(page: &mut String, input: &ReportInput, origin: &Origin) {
    let scenes: BTreeMap<&str, String> = origin
        .runs
        .iter()
        .filter_map(|run| run.scene.as_ref())
        .map(|scene| (scene.path.as_str(), bare(&scene.text)))
        .collect();
    let Some(live) = input.live_page.filter(|_| !scenes.is_empty()) else {
        return;
    };
    page.push_str("<dialog id=\"live\" aria-label=\"The wall, live\"><form method=\"dialog\"><button>Close</button></form><iframe title=\"The wall, live\"></iframe></dialog>\n");
    block(page, "live-page", &live.into());
    block(page, "live-scenes", &serde_json::json!(scenes));
    let _ = write!(page, "<script>\n{}</script>\n", include_str!("try_cell.js"));
}

#[cfg(test)]
mod tests {
    use super::bare;

    #[test]
    fn a_scene_loses_its_comments_and_nothing_else() {
        let text = "# head\nname = \"a # b\" # c\n\n[wall]\n# absent: x\nk = 5.0  # N·m/rad\n";
        assert_eq!(bare(text), "name = \"a # b\" # c\n[wall]\nk = 5.0\n");
    }
}
