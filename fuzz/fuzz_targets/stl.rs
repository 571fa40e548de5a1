#![no_main]
//! Meshes: the bytes as a file of STL, OBJ and PLY, and as damages of whole STL files of both forms.

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
