//! All wrong changes of a source in one: each can be chosen when the program runs, by its number.
//!
//! `a < b` becomes `(if on(7) { a <= b } else if on(8) { a > b } else { a < b })`: one build for all, where a build for each would
//! take days.

use std::fmt::Write as _;
use std::ops::Range;

use super::find::Wrong;

/// What a chosen change is asked of, in a crate.
pub fn question(file: &str) -> &'static str {
    if file.starts_with("control/") {
        "crate::mutant::on"
    } else {
        "touchstone_control::mutant::on"
    }
}

/// The module that answers, for `control`'s copy: the number stands in the environment.
pub const ANSWERS: &str = "
extern crate std;
/// Which wrong change is on.
#[allow(missing_docs)]
pub mod mutant {
    static CHOSEN: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    #[inline]
    pub fn on(number: u32) -> bool {
        let chosen = || std::env::var(\"TOUCHSTONE_MUTANT\").ok().and_then(|text| text.parse().ok());
        *CHOSEN.get_or_init(|| chosen().unwrap_or(0)) == number
    }
}
";

/// The source with the changes of these numbers in it, and the original where none is on.
pub fn instrumented(source: &str, file: &str, changes: &[(u32, &Wrong)]) -> String {
    // From the outside in.
    let mut ranges: Vec<Range<usize>> = changes.iter().map(|(_, wrong)| wrong.at.clone()).collect();
    ranges.sort_by_key(|at| (at.start, usize::MAX - at.end));
    ranges.dedup();
    let on = question(file);
    within(source, 0..source.len(), &ranges, changes, on)
}

fn within(
    source: &str,
    whole: Range<usize>,
    ranges: &[Range<usize>],
    changes: &[(u32, &Wrong)],
    on: &str,
) -> String {
    let (mut text, mut at, mut next) = (String::new(), whole.start, 0);
    while let Some(range) = ranges.get(next) {
        let inside = ranges[next + 1..]
            .iter()
            .take_while(|other| other.start < range.end)
            .count();
        text += &source[at..range.start];
        let inner = within(
            source,
            range.clone(),
            &ranges[next + 1..next + 1 + inside],
            changes,
            on,
        );
        text += &chosen(&inner, range, changes, on);
        at = range.end;
        next += 1 + inside;
    }
    text + &source[at..whole.end]
}

fn chosen(original: &str, range: &Range<usize>, changes: &[(u32, &Wrong)], on: &str) -> String {
    let here = changes.iter().filter(|(_, wrong)| wrong.at == *range);
    let mut text = String::new();
    let mut is_statement = false;
    for (number, wrong) in here {
        is_statement = wrong.is_statement;
        let word = if text.is_empty() { "if" } else { " else if" };
        let _ = write!(text, "{word} {on}({number}) {{ {} }}", wrong.instead);
    }
    if original.is_empty() {
        format!("{text} ")
    } else if is_statement {
        format!("{text} else {{ {original} }}")
    } else {
        format!("({text} else {{ {original} }})")
    }
}

/// The number of the change that a place of an instrumented source belongs to: the last one asked for before it.
pub fn number_at(instrumented: &str, byte: usize) -> Option<u32> {
    let until = instrumented.get(..byte.min(instrumented.len()))?;
    // The place may be the question itself.
    let more = &instrumented[until.len()..];
    let near = more
        .strip_prefix("crate::mutant::on(")
        .or_else(|| more.strip_prefix("touchstone_control::mutant::on("));
    let after = match near {
        Some(after) => after,
        None => until.rsplit_once("::mutant::on(")?.1,
    };
    let digits = after
        .find(|c: char| !c.is_ascii_digit())
        .unwrap_or(after.len());
    after[..digits].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::super::find::find;
    use super::*;

    #[test]
    fn all_changes_stand_beside_the_original() {
        let source = "fn f(a: i32) -> bool { g(); -a < 7 }";
        let all = find(source).expect("Rust");
        let numbered: Vec<(u32, &Wrong)> = (1..).zip(&all).collect();
        let text = instrumented(source, "control/src/x.rs", &numbered);
        let on = "crate::mutant::on";
        assert_eq!(
            text,
            format!(
                "fn f(a: i32) -> bool {{if {on}(1) {{ return true; }} else if {on}(2) {{ return false; }}  \
                 if {on}(3) {{  }} else {{ g(); }} \
                 (if {on}(5) {{ -a <= 7 }} else if {on}(6) {{ -a > 7 }} else {{ \
                 (if {on}(4) {{ a }} else {{ -a }}) < (if {on}(7) {{ 8 }} else if {on}(8) {{ 6 }} else {{ 7 }}) }}) }}"
            )
        );
        let at = |part: &str| number_at(&text, text.find(part).expect("there"));
        assert_eq!(at("-a > 7"), Some(6));
        assert_eq!(at(&format!("{on}(7)")), Some(7));
        assert_eq!(at("fn f"), None);
    }
}
