//! Builds the browser page for a real board. The page draws with the same JavaScript as the page for the simulated knob. The
//! board's data come through a WebSocket of the program `touchstone`, or through the serial port, which a page can open itself
//! in a browser with WebSerial.

use crate::page::{
    MARK, MEMORY, STAGE, STYLE, UNPACK, VIEW, block, escape, fill, hash, packed_module,
};

const PAGE: &str = include_str!("../page/board.html");
const BOARD_STYLE: &str = include_str!("../page/board.css");
const BOARD: &str = include_str!("../page/board.js");
const SOCKET: &str = include_str!("../page/board_link.js");
const SERIAL: [&str; 3] = [UNPACK, MEMORY, include_str!("../page/serial_link.js")];

/// The connection between the page and the board.
#[derive(Debug, Clone, Copy)]
pub enum Way<'a> {
    /// Through the program `touchstone`. Holds the address of its WebSocket, with the access token.
    Socket(&'a str),
    /// The browser opens the serial port itself (WebSerial).
    Serial,
}

/// Data that are written into the web page when it is built.
#[derive(Debug, Clone, Copy)]
pub struct Content<'a> {
    /// The connection between the page and the board.
    pub way: Way<'a>,
    /// Column names of the numbers that the page gets for each telemetry record of the board, in their order.
    pub columns: &'a [&'a str],
    /// Name of the board's port as shown to the user, such as a serial port.
    pub place: &'a str,
    /// Name, version and commit of the program that made the page.
    pub program: &'a str,
}

/// Returns the board's page as HTML, and the page's content security policy.
#[must_use]
pub fn render(content: &Content) -> (String, String) {
    let link = match content.way {
        Way::Socket(_) => SOCKET.to_owned(),
        Way::Serial => SERIAL.concat(),
    };
    let script = ["\"use strict\";\n", VIEW, STAGE, &link, BOARD].concat();
    let style = format!("{STYLE}{BOARD_STYLE}");
    let mut data = serde_json::json!({
        "columns": content.columns,
        "place": content.place,
    });
    let (runs, connects, module, gone, way) = match content.way {
        Way::Socket(socket) => {
            data["socket"] = socket.into();
            // A content security policy names addresses without their query (`?token=…`).
            let socket = socket.split('?').next().unwrap_or_default();
            (
                "",
                format!("; connect-src {socket}"),
                String::new(),
                "When this page is closed or hangs, the program disarms the device.",
                "This page communicates only with the program on this computer.",
            )
        }
        Way::Serial => (
            " 'wasm-unsafe-eval'",
            String::new(),
            packed_module(),
            "When this page is closed, it stops a device that is on. When the page hangs, the device switches itself off after limits.host_silence_s, 2 s as shipped.",
            "This page communicates only with the port that you choose. It uses the program's own code, as WebAssembly.",
        ),
    };
    let policy = format!(
        "default-src 'none'; script-src '{}'{runs}; style-src '{}'{connects}; img-src data:; base-uri 'none'; form-action 'none'",
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
            ("GONE", gone),
            ("WAY", way),
            ("MODULE", &module),
            ("SCRIPT", &script),
        ],
    );
    debug_assert!(page.starts_with(MARK));
    (page, policy)
}
