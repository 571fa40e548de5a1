//! An archive for a maker without a compiler: the program, every board's firmware, the guide, licences, checksums.
//!
//! Of the same files it is the same to the byte: entries in the order of their names, one time for all, no owner.

mod archive;
mod image;
mod licences;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::answer::Answer;
use archive::Entry;

/// Files of the workspace that are copied unchanged.
const AS_IT_IS: [&str; 5] = [
    "docs",
    "README.md",
    "CHANGELOG.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
];

/// Parts of an archive.
pub struct Parts<'a> {
    /// Where the archive goes; its file and its one folder are called `name`.
    pub out: &'a Path,
    /// Such as `touchstone-0.1.0-x86_64-linux`.
    pub name: &'a str,
    /// The time of all entries, seconds since 1970: the commit's.
    pub seconds: u64,
    /// The text that says which version it is.
    pub version: &'a Path,
    /// The built program for this machine.
    pub program: &'a Path,
    /// Names of boards with their ELF files.
    pub boards: Vec<(&'a str, &'a Path)>,
    /// What `cargo metadata` says of the program and of the firmware.
    pub metadata: Vec<&'a Path>,
    /// The workspace's folder.
    pub workspace: &'a Path,
}

impl<'a> Parts<'a> {
    /// Parses the words of a command line; `None` if they are wrong.
    pub fn named(words: &[&'a str]) -> Option<Self> {
        let [out, name, seconds, version, program, rest @ ..] = words else {
            return None;
        };
        let mut parts = Self {
            out: Path::new(*out),
            name,
            seconds: seconds.parse().ok()?,
            version: Path::new(*version),
            program: Path::new(*program),
            boards: Vec::new(),
            metadata: Vec::new(),
            workspace: Path::new("."),
        };
        for word in rest {
            match word.split_once('=')? {
                ("metadata", file) => parts.metadata.push(Path::new(file)),
                (board, file) => parts.boards.push((board, Path::new(file))),
            }
        }
        Some(parts)
    }
}

/// Makes the archive, and unpacks it again beside itself.
pub fn pack(parts: &Parts<'_>) -> Result<Answer, String> {
    let mut entries = BTreeMap::new();
    for name in AS_IT_IS {
        from_workspace(parts.workspace, Path::new(name), &mut entries)?;
    }
    let program_name = format!("touchstone{}", std::env::consts::EXE_SUFFIX);
    entries.insert(program_name, Entry::program(read(parts.program)?));
    for (board, elf) in &parts.boards {
        let program = read(elf)?;
        let image = image::of(&program).map_err(|why| format!("{}: {why}", elf.display()))?;
        let folder = format!("firmware/{board}");
        entries.insert(format!("{folder}/touchstone.bin"), Entry::text(image));
        entries.insert(format!("{folder}/touchstone.elf"), Entry::text(program));
    }
    entries.insert("VERSION".into(), Entry::text(read(parts.version)?));
    let others = licences::text(&parts.metadata)?;
    entries.insert("THIRD-PARTY.txt".into(), Entry::text(others.into_bytes()));
    let sums = sums(&entries);
    entries.insert("SHA256SUMS".into(), Entry::text(sums.into_bytes()));

    let file = parts.out.join(format!("{}.tar.gz", parts.name));
    let packed = archive::packed(parts.name, parts.seconds, &entries)
        .map_err(|why| format!("{}: {why}", file.display()))?;
    write(&file, &packed)?;
    let sum = format!("{}  {}.tar.gz\n", digest(&packed), parts.name);
    write(&file.with_extension("gz.sha256"), sum.as_bytes())?;
    archive::unpack(&packed, parts.out)
        .map_err(|why| format!("{} cannot be unpacked: {why}", file.display()))?;
    Ok(Answer::Right(format!(
        "{}: {} files, {:.1} MB, SHA-256 {}",
        file.display(),
        entries.len(),
        packed.len() as f64 / 1e6,
        digest(&packed)
    )))
}

/// A file of the workspace, or all files of a folder, under their own names.
fn from_workspace(
    workspace: &Path,
    name: &Path,
    entries: &mut BTreeMap<String, Entry>,
) -> Result<(), String> {
    let path = workspace.join(name);
    if path.is_dir() {
        for inside in sorted(&path)? {
            from_workspace(workspace, &name.join(inside), entries)?;
        }
        return Ok(());
    }
    let parts: Vec<_> = name.iter().map(|part| part.to_string_lossy()).collect();
    entries.insert(parts.join("/"), Entry::text(read(&path)?));
    Ok(())
}

/// The names in a folder, sorted: a directory has no order of its own.
fn sorted(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let wrong = |why: std::io::Error| format!("{}: {why}", folder.display());
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        names.push(PathBuf::from(entry.map_err(wrong)?.file_name()));
    }
    names.sort();
    Ok(names)
}

/// Checksums in the format of `sha256sum --check`.
fn sums(entries: &BTreeMap<String, Entry>) -> String {
    let line = |(name, entry): (&String, &Entry)| format!("{}  {name}\n", digest(&entry.content));
    entries.iter().map(line).collect()
}

fn digest(content: &[u8]) -> String {
    let bytes = Sha256::digest(content);
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|why| format!("{}: {why}", path.display()))
}

fn write(path: &Path, content: &[u8]) -> Result<(), String> {
    let folder = path.parent().map_or(Ok(()), std::fs::create_dir_all);
    folder
        .and_then(|()| std::fs::write(path, content))
        .map_err(|why| format!("{}: {why}", path.display()))
}
