#![no_main]
//! Fuzzes the decoding of the serial protocol. The input serves as bytes from the serial line, and as choices for damaged frames.

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
