//! `cargo xtask wheel`: builds the Python package that contains the program, `target/wheel/*.whl`. Installs it in an environment
//! without the sources and runs its tests.

use std::path::{Path, PathBuf};

use crate::outcome::Outcome;
use crate::shell;

const USAGE: &str = "cargo xtask wheel";
/// Python packages that build, test and type-check the wheel. Tests whose packages are missing would be skipped, so the list
/// contains all.
const TOOLS: [&str; 11] = [
    "maturin>=1.9,<2",
    "pytest>=7",
    "numpy>=1.22",
    "gymnasium>=1",
    "mypy>=1.11",
    "distributed",
    "mujoco",
    "pandas>=1.5",
    "nbclient",
    "ipykernel",
    "fmpy",
];

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage(USAGE.into());
    }
    made().unwrap_or_else(|outcome| outcome)
}

fn made() -> Result<Outcome, Outcome> {
    let folder = shell::target("wheel");
    let python = tools(&folder)?;
    let package = shell::root().join("bindings/python");
    program(&package)?;
    // The package promises type hints, so they are checked.
    let mut types = shell::program(&python);
    types.args(["-m", "mypy", "--strict"]);
    types.arg(package.join("python"));
    shell::run(types.current_dir(&folder)).went_well()?;
    let out = folder.join("built");
    // Removes older wheels, whose names may differ.
    if out.exists() {
        done(std::fs::remove_dir_all(&out), &out)?;
    }
    let mut maturin = shell::program(python.with_file_name("maturin"));
    maturin.args(["build", "--release", "--out"]).arg(&out);
    maturin.arg("--target-dir").arg(folder.join("build"));
    shell::run(maturin.current_dir(&package)).went_well()?;
    let wheel = wheel_in(&out)?;

    let mut pip = shell::program(&python);
    pip.args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--force-reinstall",
        "--no-deps",
    ]);
    shell::run(pip.arg(&wheel)).went_well()?;
    // Runs in another folder, so that the tests import the installed package.
    let mut tests = shell::program(&python);
    // `-rs` names the tests that were skipped.
    tests.args(["-m", "pytest", "--quiet", "-rs", "-p", "no:cacheprovider"]);
    tests.arg(package.join("tests"));
    // LeRobot is not installed here (some 8 GB), so the tests that need it are skipped.
    tests.arg(shell::root().join("bindings/lerobot/tests"));
    tests.env("TOUCHSTONE_MOCK_DHD", mock()?);
    tests.env_remove("TOUCHSTONE_PROGRAM");
    shell::run(tests.current_dir(&folder)).went_well()?;
    Ok(Outcome::Ok(format!(
        "{}, its tests passed",
        wheel.display()
    )))
}

/// Creates a Python environment with the packages in `TOOLS`, unless it exists; returns the path of its Python.
fn tools(folder: &Path) -> Result<PathBuf, Outcome> {
    let place = folder.join("venv");
    let python = place.join("bin/python3");
    let complete = folder.join("venv-complete");
    if std::fs::read_to_string(&complete).is_ok_and(|has| has == TOOLS.join(" ")) {
        return Ok(python);
    }
    done(std::fs::create_dir_all(folder), folder)?;
    let missing = |_| {
        Outcome::NotRun(
            "no Python with the packages of the wheel's tests; `apt-get install python3-venv`, network"
                .into(),
        )
    };
    let mut venv = shell::program("python3");
    venv.args(["-m", "venv", "--clear"]).arg(&place);
    shell::run(&mut venv).went_well().map_err(missing)?;
    let mut pip = shell::program(&python);
    pip.args(["-m", "pip", "install", "--quiet"]).args(TOOLS);
    shell::run(&mut pip).went_well().map_err(missing)?;
    done(std::fs::write(&complete, TOOLS.join(" ")), &complete)?;
    Ok(python)
}

/// Builds the program and the shared library for FMUs as in the release, and copies them to the folders from which the packaging tool
/// maturin takes programs and other files.
fn program(package: &Path) -> Result<(), Outcome> {
    let mut cargo = shell::cargo_locked("build");
    cargo.args(["--profile", "dist", "--package", "touchstone"]);
    cargo.args(["--package", "touchstone-fmi"]);
    cargo.args([
        "--features",
        "touchstone/mesh,touchstone/parquet,touchstone/keys",
    ]);
    shell::run(&mut cargo).went_well()?;
    let program = format!("touchstone{}", std::env::consts::EXE_SUFFIX);
    for (name, folder) in [(program, "data/scripts"), (fmu_library(), "data/data/lib")] {
        let folder = package.join(folder);
        done(std::fs::create_dir_all(&folder), &folder)?;
        let copied = std::fs::copy(shell::target("dist").join(&name), folder.join(&name));
        done(copied.map(|_| ()), &folder)?;
    }
    Ok(())
}

/// Builds the mock of Force Dimension's library, with which a test drives an omega.3.
fn mock() -> Result<PathBuf, Outcome> {
    let mut cargo = shell::cargo_locked("build");
    cargo.args(["--profile", "dist", "--package", "touchstone-mock-dhd"]);
    shell::run(&mut cargo).went_well()?;
    let (first, last) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    Ok(shell::target("dist").join(format!("{first}touchstone_mock_dhd{last}")))
}

/// File name of the shared library for FMUs.
pub fn fmu_library() -> String {
    let (first, last) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    format!("{first}touchstone_fmi{last}")
}

fn wheel_in(folder: &Path) -> Result<PathBuf, Outcome> {
    let files = std::fs::read_dir(folder).map(|files| files.flatten().map(|file| file.path()));
    let wheel = files.ok().and_then(|mut files| {
        files.find(|file| file.extension().is_some_and(|ending| ending == "whl"))
    });
    wheel.ok_or_else(|| Outcome::Failed(format!("{}: maturin left no wheel", folder.display())))
}

fn done(result: std::io::Result<()>, path: &Path) -> Result<(), Outcome> {
    result.map_err(|why| Outcome::Failed(format!("{}: {why}", path.display())))
}
