//! Opens pages in the user's default browser.

use std::ffi::OsStr;
use std::process::{Command, Stdio};

/// Opens a file or an address in the user's default browser. Returns whether a program accepted it.
pub fn open(page: &OsStr) -> bool {
    let openers: &[&[&str]] = if cfg!(target_os = "macos") {
        &[&["open"]]
    } else if cfg!(windows) {
        &[&["cmd", "/C", "start", ""]]
    } else {
        &[&["xdg-open"], &["gio", "open"]]
    };
    openers.iter().any(|words| {
        Command::new(words[0])
            .args(&words[1..])
            .arg(page)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status()
            .is_ok_and(|status| status.success())
    })
}
