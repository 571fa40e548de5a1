#![no_main]
//! Fuzzes the reading of scene files. The input serves as TOML text, and as choices among all fields and values.

#[path = "../../tests/made/choices.rs"]
mod choices;
#[path = "../../tests/made/scene.rs"]
mod made;

use choices::Given;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes)
        && let Err(error) =
            touchstone_sim::scene::Scene::parse(text, std::path::Path::new("made.toml"))
    {
        assert!(!error.to_string().contains('\n'), "{error}");
    }
    let (base, sets) = made::made(&mut Given(bytes));
    made::tried(base, &sets);
});
