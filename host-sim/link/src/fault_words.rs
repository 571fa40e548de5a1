//! The documentation's text on a device's fault, for a person at the device.

/// Fault number and text of each documentation page in `docs/faults`.
const PAGES: &[(u8, &str)] = include!(concat!(env!("OUT_DIR"), "/faults.rs"));

/// The text below a heading, e.g. `Meaning`, on the documentation page of the fault with number `code`. `None` for a fault that
/// this version does not have.
#[must_use]
pub fn section(code: u8, heading: &str) -> Option<&'static str> {
    let (_, page) = PAGES.iter().find(|(known, _)| *known == code)?;
    let (_, after) = page.split_once(&format!("## {heading}\n"))?;
    Some(after.split("\n## ").next().unwrap_or(after).trim())
}

#[cfg(test)]
mod tests {
    use super::{PAGES, section};

    #[test]
    fn every_page_says_what_it_means_what_to_check_and_how_to_clear_it() {
        assert!(PAGES.len() >= 20, "{}", PAGES.len());
        for (code, _) in PAGES {
            for heading in ["Meaning", "What to check", "How to clear"] {
                let text = section(*code, heading);
                assert!(
                    text.is_some_and(|text| text.len() > 10 && !text.contains("##")),
                    "{code} {heading}: {text:?}"
                );
            }
        }
        assert_eq!(section(250, "Meaning"), None);
    }
}
