#![no_main]
//! Fuzzes the reading of settings images from flash. The input serves as an image, as an image with a correct checksum, and as
//! choices for a damaged image.

#[path = "../../tests/made/choices.rs"]
mod choices;
#[path = "../../tests/made/image.rs"]
mod made;

use choices::Given;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut sealed = bytes.to_vec();
    made::seal(&mut sealed);
    made::is_taken(bytes);
    made::is_taken(&sealed);
    made::is_taken(&made::made(&mut Given(bytes)));
});
