//! Setting values as tests write them, and a check of messages.

use touchstone_control::Si;

/// A setting value from its decimal text.
///
/// # Panics
/// The text is not a number.
#[must_use]
pub fn si(text: &str) -> Si {
    text.parse()
        .unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// The next larger or smaller setting value, one quantum apart.
#[must_use]
pub fn next(value: Si, up: bool) -> Si {
    let step = if up { 1 } else { -1 };
    Si::from_bits(value.to_bits() + step)
}

/// Asserts that a message for a user is one line and complete.
///
/// # Panics
/// The message is not.
pub fn assert_one_line(text: &str) {
    assert!(!text.is_empty() && !text.contains('\n'), "{text:?}");
    assert_eq!(text.trim(), text, "{text:?}");
}
