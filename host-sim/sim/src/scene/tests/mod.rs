//! Tests of reading, changing, checking and printing scenes.

mod errors;
mod overrides;
mod round_trip;

use std::path::Path;

use crate::error::Result;

use super::*;

/// Parses a scene's text as if it were the file `s.toml`.
fn parse(text: &str) -> Result<Scene> {
    Scene::parse(text, Path::new("s.toml"))
}

/// The error message for a scene's text that must be refused.
fn refusal(text: &str) -> String {
    let message = parse(text).expect_err("this must be refused").to_string();
    assert_eq!(message.lines().count(), 1, "one line: {message}");
    message
}
