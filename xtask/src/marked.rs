//! Tables that a command writes into a page of the documentation, between two marks.

/// The page's text with `table` in place of what is between the lines `begin` and `end`; `None` if the page lacks these lines.
pub fn between(page: &str, begin: &str, end: &str, table: &str) -> Option<String> {
    let (before, rest) = page.split_once(begin)?;
    let (_, after) = rest.split_once(end)?;
    Some(format!("{before}{begin}{table}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::between;

    #[test]
    fn a_table_takes_the_place_of_the_last_one() {
        let between = |page: &str| between(page, "[\n", "]\n", "new\n");
        let replaced = between("before\n[\nold\n]\nafter\n");
        assert_eq!(replaced.as_deref(), Some("before\n[\nnew\n]\nafter\n"));
        assert_eq!(between("no place"), None);
    }
}
