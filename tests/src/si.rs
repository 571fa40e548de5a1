//! SI values as tests write them, and checks of messages about them.

use touchstone_control::Si;

/// An SI value from its decimal text.
///
/// # Panics
/// The text is no number.
#[must_use]
pub fn si(text: &str) -> Si {
    text.parse()
        .unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// The next value up or down.
#[must_use]
pub fn next(value: Si, up: bool) -> Si {
    let step = if up { 1 } else { -1 };
    Si::from_bits(value.to_bits() + step)
}

/// A message for people is one line without loose ends.
///
/// # Panics
/// If it is not.
pub fn assert_one_line(text: &str) {
    assert!(!text.is_empty() && !text.contains('\n'), "{text:?}");
    assert_eq!(text.trim(), text, "{text:?}");
}
