//! Tests of a real board's web page: it loads nothing, connects to one WebSocket only, and a name with HTML in it cannot inject a
//! script.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use sha2::{Digest, Sha256};
use touchstone_live::board_page::{Content, Way, render};
use touchstone_live::page::MARK;

fn page() -> (String, String) {
    render(&Content {
        way: Way::Socket("ws://127.0.0.1:4000/socket?token=ab"),
        columns: &["clock", "missing"],
        place: "</script><script>alert(1)</script>",
        program: "Touchstone <0.1>",
    })
}

#[test]
fn it_speaks_to_one_socket_and_to_nothing_else() {
    let (page, policy) = page();
    assert!(
        page.starts_with(MARK) && page.len() < 100_000,
        "{}",
        page.len()
    );
    assert!(policy.starts_with("default-src 'none'; "));
    assert!(policy.contains("connect-src ws://127.0.0.1:4000/socket; "));
    assert!(!policy.contains("unsafe") && !policy.contains("token"));
    assert!(page.contains(&format!("content=\"{policy}\"")));
    let drawn = page.replace("http://www.w3.org/2000/svg", "");
    for foreign in [
        "http:", "https:", "src=", "@import", "url(", "fetch(", "eval(",
    ] {
        assert!(!drawn.contains(foreign), "{foreign}");
    }
    assert_eq!(page.matches("new WebSocket(").count(), 1);
}

#[test]
fn its_policy_allows_its_own_script_and_style() {
    let (page, policy) = page();
    for (open, close, directive) in [
        ("<script>", "</script>", "script-src"),
        ("<style>", "</style>", "style-src"),
    ] {
        let (_, text) = page.rsplit_once(open).unwrap();
        let text = text.split_once(close).unwrap().0;
        let hash = BASE64.encode(Sha256::digest(text));
        assert!(
            policy.contains(&format!("{directive} 'sha256-{hash}'")),
            "{directive}"
        );
    }
}

#[test]
fn what_a_place_is_called_stays_data() {
    let (page, _) = page();
    assert!(!page.contains("<script>alert") && page.contains("Touchstone &lt;0.1>"));
    assert_eq!(page.matches("</script>").count(), 3);
}

#[test]
fn a_page_that_has_the_port_itself_connects_to_nothing() {
    let (page, policy) = render(&Content {
        way: Way::Serial,
        columns: &["clock"],
        place: "serial port",
        program: "Touchstone",
    });
    assert!(page.len() <= 1_500_000, "{}", page.len());
    assert!(!policy.contains("connect-src") && policy.contains(" 'wasm-unsafe-eval'; style-src"));
    let drawn = page.replace("http://www.w3.org/2000/svg", "");
    for foreign in [
        "http:",
        "https:",
        "src=",
        "url(",
        "fetch(",
        " eval(",
        "WebSocket(",
    ] {
        assert!(!drawn.contains(foreign), "{foreign}");
    }
    assert!(page.contains("requestPort()"));
}
