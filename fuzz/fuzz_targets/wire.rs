#![no_main]
//! Fuzzes the serial protocol: the input as bytes from the wire, and the input as choices for damaged frames.

#[path = "../../tests/made/choices.rs"]
mod choices;
#[path = "../../tests/made/wire.rs"]
mod made;

use choices::Given;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    made::messages(bytes);
    made::looked_into(bytes);
    made::messages(&made::made(&mut Given(bytes)));
});
