//! Texts from files, boards and services, as they may come to a terminal or a log.

/// Whether a terminal could obey a letter, or show the letters around it in another order: control characters, line and paragraph
/// separators, and marks of writing direction.
#[must_use]
pub fn is_harmful(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A name as one line: a space instead of each end of a line or tab, U+FFFD instead of any other harmful letter. A log of CI obeys lines
/// that begin as its commands do.
#[must_use]
pub fn one_line(text: &str) -> String {
    let harmless = |letter: char| match letter {
        '\n' | '\r' | '\t' => ' ',
        _ if is_harmful(letter) => '\u{fffd}',
        _ => letter,
    };
    text.chars().map(harmless).collect()
}

#[cfg(test)]
mod tests {
    use super::one_line;

    #[test]
    fn a_name_is_a_line_that_nothing_obeys() {
        for (text, expected) in [
            ("Stück 1 – “ß” 結", "Stück 1 – “ß” 結"),
            ("a\n::error::b", "a ::error::b"),
            ("a\r\tb", "a  b"),
            (
                "a\u{1b}[31mb\u{7f}\u{9b}c",
                "a\u{fffd}[31mb\u{fffd}\u{fffd}c",
            ),
            ("a\u{202e}b\u{2028}c\u{2066}", "a\u{fffd}b\u{fffd}c\u{fffd}"),
        ] {
            assert_eq!(one_line(text), expected, "{text:?}");
        }
    }
}
