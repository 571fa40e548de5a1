#![no_main]
//! Fuzzes the reading of recorded hand motions. The input serves as CSV text, and as choices for the header and rows of a CSV text.

#[path = "../../tests/made/choices.rs"]
mod choices;
#[path = "../../tests/made/recording.rs"]
mod made;

use choices::Given;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        made::is_read(text);
    }
    made::is_read(&made::made(&mut Given(bytes)));
});
