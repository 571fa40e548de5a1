//! The page that shows a board: drawn by the code of the simulated one, fed by one socket of the program.

use crate::page::{MARK, STAGE, STYLE, VIEW, block, escape, fill, hash};

const PAGE: &str = include_str!("../page/board.html");
const BOARD_STYLE: &str = include_str!("../page/board.css");
const SCRIPT: [&str; 5] = [
    "\"use strict\";\n",
    VIEW,
    STAGE,
    include_str!("../page/board_link.js"),
    include_str!("../page/board.js"),
];

/// What the page starts with.
#[derive(Debug, Clone, Copy)]
pub struct Content<'a> {
    /// Address of the socket, token included.
    pub socket: &'a str,
    /// Names of the numbers of a record.
    pub columns: &'a [&'a str],
    /// Where the device is.
    pub place: &'a str,
    /// Name, version and commit of the program.
    pub program: &'a str,
}

/// The page, and its content security policy.
#[must_use]
pub fn render(content: &Content) -> (String, String) {
    let script = SCRIPT.concat();
    let style = format!("{STYLE}{BOARD_STYLE}");
    let data = serde_json::json!({
        "socket": content.socket,
        "columns": content.columns,
        "place": content.place,
    });
    // A policy names paths without what is asked of them.
    let socket = content.socket.split('?').next().unwrap_or_default();
    let policy = format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; connect-src {socket}; img-src data:; base-uri 'none'; form-action 'none'",
        hash(&script),
        hash(&style)
    );
    let page = fill(
        PAGE,
        &[
            ("POLICY", &policy),
            ("STYLE", &style),
            ("PROGRAM", &escape(content.program)),
            ("CONTENT", &block(&data)),
            ("SCRIPT", &script),
        ],
    );
    debug_assert!(page.starts_with(MARK));
    (page, policy)
}
