//! Tests the CMake package: installs it, moves it, and builds a project outside with `find_package`.

mod program;

use program::{ROOT, file, is_here, library};
use std::path::Path;
use std::process::{Command, Output};

fn cmake(arguments: &[&str], in_folder: &Path) -> Output {
    let ran = Command::new("cmake")
        .args(arguments)
        .current_dir(in_folder)
        .output()
        .expect("cmake can be started");
    assert!(
        ran.status.success(),
        "cmake {arguments:?}: {}{}",
        String::from_utf8_lossy(&ran.stdout),
        String::from_utf8_lossy(&ran.stderr)
    );
    ran
}

const PROJECT: &str = "cmake_minimum_required(VERSION 3.18)
project(outside LANGUAGES C)
find_package(touchstone 0.1 REQUIRED)
add_executable(end_stop end_stop.c)
target_link_libraries(end_stop PRIVATE touchstone::touchstone)
";

#[test]
fn a_project_outside_finds_the_installed_library() {
    if !(is_here("cmake") && is_here("cc")) {
        return;
    }
    let folder = std::env::temp_dir().join(format!("touchstone-c-cmake-{}", std::process::id()));
    let outside = folder.join("outside");
    std::fs::create_dir_all(&outside).expect("a folder");
    let archive = format!("-DTOUCHSTONE_LIBRARY={}", library().display());
    cmake(&["-S", ROOT, "-B", "built", &archive], &folder);
    cmake(&["--build", "built"], &folder);
    cmake(&["--install", "built", "--prefix", "installed"], &folder);
    // The package holds no path of the folder in which it was installed.
    std::fs::rename(folder.join("installed"), folder.join("moved")).expect("a move");

    std::fs::write(outside.join("CMakeLists.txt"), PROJECT).expect("a project");
    std::fs::copy(file("examples/end_stop.c"), outside.join("end_stop.c")).expect("a source");
    let prefix = format!("-DCMAKE_PREFIX_PATH={}", folder.join("moved").display());
    cmake(&["-S", ".", "-B", "built", &prefix], &outside);
    cmake(&["--build", "built"], &outside);
    let ran = Command::new(outside.join("built/end_stop"))
        .output()
        .expect("the program can be started");
    std::fs::remove_dir_all(&folder).expect("the folder can be removed");
    assert!(ran.status.success(), "{}", ran.status);
    assert!(ran.stdout.starts_with(b"thrown with 1.00 J"));
}
