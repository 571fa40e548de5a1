#![no_main]
//! STL: the bytes as a file, and as damages of whole files of both forms.

#[path = "../../tests/made/choices.rs"]
mod choices;
#[path = "../../tests/made/stl.rs"]
mod made;

use choices::Given;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    made::is_read(bytes);
    made::is_read(&made::made(&mut Given(bytes)));
});
