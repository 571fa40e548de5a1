//! Tests of an archive made of invented files: its layout, its checksums, and that its bytes are always the same.

use std::path::{Path, PathBuf};

use super::{Parts, pack};
use crate::answer::Answer;

const METADATA: &str = r#"{
  "packages": [
    { "id": "own", "name": "touchstone", "version": "0.1.0", "license": "MIT", "source": null, "manifest_path": "Cargo.toml" },
    { "id": "a", "name": "alpha", "version": "1.2.3", "license": "MIT", "source": "elsewhere", "manifest_path": "ALPHA/Cargo.toml" },
    { "id": "b", "name": "beta", "version": "4.5.6", "license": "0BSD", "source": "elsewhere", "manifest_path": "BETA/Cargo.toml" },
    { "id": "c", "name": "only-for-tests", "version": "1.0.0", "license": null, "source": "elsewhere", "manifest_path": "BETA/Cargo.toml" }
  ],
  "resolve": { "nodes": [
    { "id": "own", "deps": [
      { "pkg": "a", "dep_kinds": [{ "kind": null }] },
      { "pkg": "c", "dep_kinds": [{ "kind": "dev" }, { "kind": "build" }] } ] },
    { "id": "a", "deps": [{ "pkg": "b", "dep_kinds": [{ "kind": "build" }, { "kind": null }] }] },
    { "id": "b", "deps": [] },
    { "id": "c", "deps": [] }
  ] }
}"#;

/// An ELF program with segments of 4 and 2 bytes, which begin 8 bytes apart in the flash memory.
fn elf() -> Vec<u8> {
    let mut bytes = b"\x7fELF\x01\x01\x01".to_vec();
    bytes.resize(16, 0);
    let halves =
        |bytes: &mut Vec<u8>, all: &[u16]| all.iter().for_each(|it| bytes.extend(it.to_le_bytes()));
    let words =
        |bytes: &mut Vec<u8>, all: &[u32]| all.iter().for_each(|it| bytes.extend(it.to_le_bytes()));
    halves(&mut bytes, &[2, 40]);
    words(&mut bytes, &[1, 0, 52, 0, 0]);
    halves(&mut bytes, &[52, 32, 2, 40, 0, 0]);
    let start = 52 + 2 * 32;
    words(
        &mut bytes,
        &[1, start, 0x0800_0000, 0x0800_0000, 4, 4, 5, 4],
    );
    // The segment runs in RAM; its load address in flash decides where it is in the image.
    words(
        &mut bytes,
        &[1, start + 4, 0x2000_0000, 0x0800_0008, 2, 2, 6, 4],
    );
    bytes.extend([1, 2, 3, 4, 5, 6]);
    bytes
}

/// Creates a workspace with invented build results in a temporary folder of one test.
fn workspace(test: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("touchstone-dist-{}-{test}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    let files: [(&str, &[u8]); 12] = [
        ("docs/guide.md", b"guide"),
        ("docs/faults/01.md", b"fault"),
        ("README.md", b"abc"),
        ("CHANGELOG.md", b"changes"),
        ("LICENSE-APACHE", b"apache"),
        ("LICENSE-MIT", b"mit"),
        ("built/touchstone", b"program"),
        ("built/VERSION", b"commit 1\n"),
        ("built/libfmu.so", b"library"),
        ("built/board.elf", &elf()),
        ("ALPHA/LICENSE-MIT", b"text of alpha\r\n"),
        ("BETA/README", b"no licence"),
    ];
    for (name, content) in files {
        super::write(&folder.join(name), content).unwrap();
    }
    let own = METADATA.replace(
        "ALPHA",
        &folder.join("ALPHA").to_string_lossy().replace('\\', "/"),
    );
    let own = own.replace(
        "BETA",
        &folder.join("BETA").to_string_lossy().replace('\\', "/"),
    );
    super::write(&folder.join("built/metadata.json"), own.as_bytes()).unwrap();
    folder
}

fn packed(folder: &Path, out: &Path) -> Result<Answer, String> {
    let built = folder.join("built");
    pack(&Parts {
        out,
        name: "touchstone-x",
        seconds: 1_000_000_000,
        version: &built.join("VERSION"),
        program: &built.join("touchstone"),
        library: Some(&built.join("libfmu.so")),
        boards: vec![("some-board", &built.join("board.elf"))],
        metadata: vec![&built.join("metadata.json")],
        workspace: folder,
    })
}

#[test]
fn an_archive_has_everything_under_its_sum() {
    let folder = workspace("layout");
    let out = folder.join("out");
    assert!(matches!(packed(&folder, &out), Ok(Answer::Right(_))));
    let inside = out.join("touchstone-x");
    let sums = std::fs::read_to_string(inside.join("SHA256SUMS")).unwrap();
    let names: Vec<&str> = sums
        .lines()
        .map(|line| line.split_once("  ").unwrap().1)
        .collect();
    let program = format!("touchstone{}", std::env::consts::EXE_SUFFIX);
    assert_eq!(
        names,
        [
            "CHANGELOG.md",
            "LICENSE-APACHE",
            "LICENSE-MIT",
            "README.md",
            "THIRD-PARTY.txt",
            "VERSION",
            "docs/faults/01.md",
            "docs/guide.md",
            "firmware/some-board/touchstone.bin",
            "firmware/some-board/touchstone.elf",
            "libfmu.so",
            &program,
        ]
    );
    // SHA-256 of `abc`, from the standard FIPS 180-4.
    let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  README.md\n";
    assert!(sums.contains(abc), "{sums}");
    for name in names {
        let sum = super::digest(&std::fs::read(inside.join(name)).unwrap());
        assert!(sums.contains(&format!("{sum}  {name}\n")), "{name}");
    }
    let image = std::fs::read(inside.join("firmware/some-board/touchstone.bin")).unwrap();
    assert_eq!(image, [1, 2, 3, 4, 255, 255, 255, 255, 5, 6]);
    let others = std::fs::read_to_string(inside.join("THIRD-PARTY.txt")).unwrap();
    for part in [
        "alpha 1.2.3",
        "text of alpha\n",
        "beta 4.5.6",
        "0BSD  (no text",
    ] {
        assert!(others.contains(part), "{part}: {others}");
    }
    assert!(!others.contains("only-for-tests"), "{others}");
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let of = |name: &str| std::fs::metadata(inside.join(name)).unwrap();
        assert_eq!(
            (
                of("touchstone").mode() & 0o777,
                of("VERSION").mode() & 0o777
            ),
            (0o755, 0o644)
        );
        assert_eq!(of("docs/guide.md").mtime(), 1_000_000_000);
    }
}

#[test]
fn the_same_files_are_the_same_archive() {
    let (first, second) = (workspace("first"), workspace("second"));
    // One file is written again, so that order and time stamps differ.
    std::fs::remove_file(second.join("docs/faults/01.md")).unwrap();
    std::fs::write(second.join("docs/faults/01.md"), b"fault").unwrap();
    let bytes = |folder: &Path| {
        packed(folder, &folder.join("out")).unwrap();
        std::fs::read(folder.join("out/touchstone-x.tar.gz")).unwrap()
    };
    let one = bytes(&first);
    assert_eq!(one, bytes(&second));
    std::fs::write(second.join("docs/guide.md"), b"other").unwrap();
    assert_ne!(one, bytes(&second));
}

#[test]
fn what_is_missing_or_no_program_is_named() {
    let folder = workspace("missing");
    let refused = |name: &str| {
        let why = packed(&folder, &folder.join("out")).unwrap_err();
        assert!(why.contains(name), "{why}");
        assert!(!folder.join("out/touchstone-x.tar.gz").exists());
    };
    std::fs::write(folder.join("built/board.elf"), b"no program").unwrap();
    refused("board.elf");
    std::fs::write(folder.join("built/board.elf"), elf()).unwrap();
    let metadata = folder.join("built/metadata.json");
    let text = std::fs::read_to_string(&metadata).unwrap();
    std::fs::write(&metadata, text.replace("\"0BSD\"", "null")).unwrap();
    refused("beta 4.5.6 names no licence");
    std::fs::write(&metadata, text).unwrap();
    std::fs::remove_file(folder.join("LICENSE-MIT")).unwrap();
    refused("LICENSE-MIT");
}
