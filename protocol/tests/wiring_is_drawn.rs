//! Checks that the wiring pictures of the build guide are those that `docs/wiring/draw.py` draws from the guide's table of pins and
//! the boards' firmware.

use std::path::Path;
use std::process::Command;

#[test]
fn the_wiring_pictures_are_those_of_table_and_firmware() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/wiring/draw.py");
    let Ok(checked) = Command::new("python3").arg(&script).arg("--check").output() else {
        println!("not run: no python3 here");
        return;
    };
    let why = String::from_utf8_lossy(&checked.stderr);
    assert!(
        checked.status.success(),
        "{why}{}",
        String::from_utf8_lossy(&checked.stdout)
    );
}
