//! Makes texts from files, boards and services safe to print on a terminal or in a log.

/// Whether a terminal could interpret the character as a command, or show neighbouring characters in another order. Such characters
/// are control characters, line and paragraph separators, and marks of writing direction.
#[must_use]
pub fn is_harmful(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Returns the text as one line: line ends and tabs become spaces, other harmful characters U+FFFD. One line matters because
/// continuous-integration services interpret some lines of a log as commands.
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
