//! Tests of reading, overriding, checking and printing scenes.

mod errors;
mod overrides;
mod round_trip;

use std::path::Path;

use crate::error::Result;

use super::*;

/// Parses text as the file `s.toml`.
fn parse(text: &str) -> Result<Scene> {
    Scene::parse(text, Path::new("s.toml"))
}

/// The message for text that must not parse.
fn refusal(text: &str) -> String {
    let message = parse(text).expect_err("this must be refused").to_string();
    assert_eq!(message.lines().count(), 1, "one line: {message}");
    message
}
