//! Tests of the simulated knob's web page: it is one complete file, loads nothing, and texts with HTML in them cannot inject a
//! script.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use sha2::{Digest, Sha256};
use touchstone_live::page::{Content, MARK, MODULE, render};

fn page() -> String {
    render(&Content {
        scene: "name = \"a\"\n",
        name: "</script><script>alert(1)</script>",
        description: "{{MODULE}} <b>",
        source: "a.toml --set x=\"1\"",
        program: "Touchstone <0.1>",
        edits: true,
    })
}

/// The text of `page` between `from` and `to`.
fn between<'a>(page: &'a str, from: &str, to: &str) -> &'a str {
    let (_, rest) = page.split_once(from).unwrap_or_else(|| panic!("no {from}"));
    rest.split_once(to).unwrap_or_else(|| panic!("no {to}")).0
}

#[test]
fn it_is_one_file_small_enough_to_send() {
    let page = page();
    assert!(page.starts_with(MARK));
    assert!(page.len() <= 1_500_000, "{} bytes", page.len());
    let module = between(&page, "id=\"module\">", "</script>");
    let packed = BASE64.decode(module).unwrap();
    let unpacked = miniz_oxide::inflate::decompress_to_vec_zlib(&packed).unwrap();
    assert_eq!(unpacked, MODULE);
    // The only `{{` that remains is in the description, which is data and no placeholder.
    assert_eq!(page.matches("{{").count(), 1);
}

#[test]
fn nothing_comes_from_elsewhere() {
    // The name of an XML namespace, not an address that is fetched.
    let page = page().replace("http://www.w3.org/2000/svg", "");
    for foreign in [
        "http:",
        "https:",
        "src=",
        "href=",
        "@import",
        "url(",
        "<link",
        "fetch(",
        "XMLHttpRequest",
        "WebSocket",
        "eval(",
        "importScripts",
    ] {
        assert!(!page.contains(foreign), "{foreign}");
    }
}

#[test]
fn the_policy_allows_this_script_and_no_other() {
    let page = page();
    let policy = between(&page, "content=\"", "\"");
    let script = page.rsplit_once("<script>").unwrap().1;
    let script = script.split_once("</script>").unwrap().0;
    let style = between(&page, "<style>", "</style>");
    for (directive, text) in [("script-src", script), ("style-src", style)] {
        let hash = BASE64.encode(Sha256::digest(text));
        assert!(
            policy.contains(&format!("{directive} 'sha256-{hash}'")),
            "{directive}"
        );
    }
    assert!(policy.starts_with("default-src 'none'; ") && policy.contains("worker-src blob:"));
    assert!(!policy.contains("unsafe-inline") && !policy.contains("'unsafe-eval'"));
}

#[test]
fn what_a_scene_says_stays_data() {
    let page = page();
    assert!(!page.contains("<script>alert") && page.contains("Touchstone &lt;0.1>"));
    assert_eq!(page.matches("</script>").count(), 4);
    let content: serde_json::Value =
        serde_json::from_str(between(&page, "id=\"content\">", "</script>")).unwrap();
    assert_eq!(content["name"], "</script><script>alert(1)</script>");
    assert_eq!(content["description"], "{{MODULE}} <b>");
}
