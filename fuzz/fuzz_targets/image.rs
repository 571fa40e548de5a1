#![no_main]
//! Images of settings in flash: the bytes under a right sum, and as damages of whole images.

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
