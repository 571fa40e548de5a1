//! `cargo xtask doc`: builds the documentation of all crates; any warning, such as a broken link, is an error. Packs the two
//! published crates, and builds and runs the examples of their README files in a crate outside of the workspace. Builds both crates
//! for microcontrollers, which have no standard library.

use std::path::Path;

use crate::outcome::Outcome;
use crate::{shell, toolchain};

/// The crates that are published, each after those that it depends on.
const PUBLISHED: [&str; 2] = ["touchstone-control", "touchstone-protocol"];

/// Targets without a standard library: without and with a float unit.
const WITHOUT_STD: [&str; 2] = ["thumbv6m-none-eabi", toolchain::BOARD];

/// Pairs of a published crate and the features with which it is built for these targets.
const FEATURES: [(&str, &str); 5] = [
    ("touchstone-control", ""),
    ("touchstone-control", "float"),
    ("touchstone-control", "float,laws"),
    ("touchstone-protocol", ""),
    ("touchstone-protocol", "flash,large"),
];

pub fn run(_: &[String]) -> Outcome {
    let mut command = shell::cargo_locked("doc");
    command
        .args(["--workspace", "--no-deps"])
        .env("RUSTDOCFLAGS", "-D warnings");
    match shell::run(&mut command).went_well() {
        Ok(()) => outside().unwrap_or_else(|outcome| outcome),
        Err(outcome) => outcome,
    }
}

/// Packs the published crates and runs their README examples in a crate that has only the packed files.
fn outside() -> Result<Outcome, Outcome> {
    let mut package = shell::cargo_locked("package");
    package.args(["--allow-dirty", "--no-verify"]);
    for name in PUBLISHED {
        package.args(["-p", name]);
    }
    shell::run(&mut package).went_well()?;

    let folder = shell::target("outside");
    let bins = folder.join("src/bin");
    let _ = std::fs::remove_dir_all(&bins);
    done(std::fs::create_dir_all(&bins), &bins)?;
    let version = env!("CARGO_PKG_VERSION");
    let mut manifest =
        "[package]\nname = \"outside\"\nedition = \"2024\"\n\n[workspace]\n\n[dependencies]\n"
            .to_owned();
    let mut patch = "\n[patch.crates-io]\n".to_owned();
    let mut examples = Vec::new();
    for name in PUBLISHED {
        let packed = shell::target("package").join(format!("{name}-{version}"));
        let mut unpack = shell::program("tar");
        unpack.arg("-xzf").arg(packed.with_added_extension("crate"));
        unpack.arg("-C").arg(shell::target("package"));
        shell::run(&mut unpack).went_well()?;
        manifest += &format!("{name} = \"{version}\"\n");
        patch += &format!("{name} = {{ path = {:?} }}\n", packed.display().to_string());
        let readme = packed.join("README.md");
        let text = done(std::fs::read_to_string(&readme), &readme)?;
        for (number, code) in (1..).zip(blocks(&text)) {
            let example = format!("{}-{number}", name.trim_start_matches("touchstone-"));
            let file = bins.join(format!("{example}.rs"));
            done(std::fs::write(&file, whole(code)), &file)?;
            examples.push(example);
        }
    }
    let file = folder.join("Cargo.toml");
    done(std::fs::write(&file, manifest + &patch), &file)?;
    for example in &examples {
        let mut run = shell::cargo("run");
        run.args(["--quiet", "--bin", example]).current_dir(&folder);
        run.arg("--target-dir").arg(folder.join("target"));
        shell::run(&mut run).went_well()?;
    }
    let mut builds = 0;
    for target in WITHOUT_STD {
        let compiler = toolchain::obtain(target)?;
        for (package, features) in FEATURES {
            let (mut build, options) = compiler.cargo(&["core"]);
            build.args(["--quiet", "--lib", "--package", package]);
            build.args(["--no-default-features", "--features", features]);
            build.arg("--target-dir").arg(shell::target("without-std"));
            shell::run(build.args(options)).went_well()?;
            builds += 1;
        }
    }
    Ok(Outcome::Ok(format!(
        "{} README examples run in a crate outside; {builds} builds without the standard library",
        examples.len()
    )))
}

/// The Rust code blocks of a Markdown text.
fn blocks(text: &str) -> Vec<&str> {
    let after = text.split("```rust\n").skip(1);
    after.filter_map(|rest| rest.split("```").next()).collect()
}

/// A complete program for a code block that is a program already or consists of statements only.
fn whole(code: &str) -> String {
    if code.contains("fn main()") {
        code.to_owned()
    } else {
        format!("fn main() {{\n{code}}}\n")
    }
}

fn done<T>(result: std::io::Result<T>, path: &Path) -> Result<T, Outcome> {
    result.map_err(|why| Outcome::Failed(format!("{}: {why}", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rust_blocks_are_found_and_made_programs() {
        let text = "a\n```rust\nlet b = 1;\n```\n```sh\nc\n```\n```rust\nfn main() {}\n```\n";
        assert_eq!(blocks(text), ["let b = 1;\n", "fn main() {}\n"]);
        assert_eq!(whole(blocks(text)[0]), "fn main() {\nlet b = 1;\n}\n");
        assert_eq!(whole(blocks(text)[1]), "fn main() {}\n");
    }
}
