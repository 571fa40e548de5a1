#![no_main]
//! Fuzzes the reading of STL meshes. The input serves as a file, and as choices for damaged text and binary files.

#[path = "../../tests/made/choices.rs"]
mod choices;
#[path = "../../tests/made/stl.rs"]
mod made;

use choices::Given;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for name in ["made.stl", "made.obj", "made.ply"] {
        made::is_read_as(name, bytes);
    }
    made::is_read(&made::made(&mut Given(bytes)));
});
