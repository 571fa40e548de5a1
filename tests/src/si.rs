//! Makes values of settings from text, and checks the form of messages.

use touchstone_control::Si;

/// The value of a setting from its decimal text.
///
/// # Panics
/// The text is not a number.
#[must_use]
pub fn si(text: &str) -> Si {
    text.parse()
        .unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// The next larger (`up`) or smaller value that a setting can have: one step of its number format away.
#[must_use]
pub fn next(value: Si, up: bool) -> Si {
    let step = if up { 1 } else { -1 };
    Si::from_bits(value.to_bits() + step)
}

/// Asserts that a message for a user is one complete line.
///
/// # Panics
/// The message is empty, has several lines, or begins or ends with a space.
pub fn assert_one_line(text: &str) {
    assert!(!text.is_empty() && !text.contains('\n'), "{text:?}");
    assert_eq!(text.trim(), text, "{text:?}");
}
