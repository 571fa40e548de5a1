//! Packs a release archive for users without a compiler: the program, every board's firmware, documentation, licences and
//! checksums.
//!
//! The same files always give the same archive, byte for byte: entries are sorted by name, have one time stamp and no owner.

mod archive;
mod image;
mod licences;
#[cfg(test)]
mod tests;
mod zip;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::answer::Answer;
use archive::Entry;

/// Files and folders of the workspace that are copied into the archive unchanged.
const AS_IT_IS: [&str; 5] = [
    "docs",
    "README.md",
    "CHANGELOG.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
];

/// Where the archive is written and what goes into it.
pub struct Parts<'a> {
    /// Folder to write the archive to. The archive's file and the single folder inside the archive are called `name`.
    pub out: &'a Path,
    /// Name such as `touchstone-0.1.0-x86_64-linux`.
    pub name: &'a str,
    /// Time stamp of all entries in seconds since 1970: the time of the commit, or `SOURCE_DATE_EPOCH`.
    pub seconds: u64,
    /// File with the text that names the version.
    pub version: &'a Path,
    /// The program built for this machine.
    pub program: &'a Path,
    /// The shared library for FMUs, which the program looks for in its own folder; `None` if there is none.
    pub library: Option<&'a Path>,
    /// Names of boards, each with the path of its firmware as an ELF file.
    pub boards: Vec<(&'a str, &'a Path)>,
    /// Files with the output of `cargo metadata` for the program and for the firmware.
    pub metadata: Vec<&'a Path>,
    /// The workspace's folder.
    pub workspace: &'a Path,
}

impl<'a> Parts<'a> {
    /// Parses the command's arguments into the parts of an archive; `None` if they are wrong.
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
            library: None,
            boards: Vec::new(),
            metadata: Vec::new(),
            workspace: Path::new("."),
        };
        for word in rest {
            match word.split_once('=')? {
                ("library", file) => parts.library = Some(Path::new(file)),
                ("metadata", file) => parts.metadata.push(Path::new(file)),
                (board, file) => parts.boards.push((board, Path::new(file))),
            }
        }
        Some(parts)
    }
}

/// Writes the archive and its checksum, and unpacks the archive in the same folder.
pub fn pack(parts: &Parts<'_>) -> Result<Answer, String> {
    let mut entries = BTreeMap::new();
    for name in AS_IT_IS {
        from_workspace(parts.workspace, Path::new(name), &mut entries)?;
    }
    let program_name = format!("touchstone{}", std::env::consts::EXE_SUFFIX);
    entries.insert(program_name, Entry::program(read(parts.program)?));
    if let Some(library) = parts.library {
        let name = library.file_name().unwrap_or_default().to_string_lossy();
        entries.insert(name.into_owned(), Entry::program(read(library)?));
    }
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

/// Packs files of a folder into a zip archive and writes its checksum beside it. `names` are the files' paths in the folder.
pub fn zip(file: &Path, folder: &Path, names: &[&str]) -> Result<Answer, String> {
    let mut files = Vec::new();
    for name in names {
        files.push(((*name).to_owned(), read(&folder.join(name))?));
    }
    let packed = zip::packed(&files).map_err(|why| format!("{}: {why}", file.display()))?;
    write(file, &packed)?;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let sum = format!("{}  {name}\n", digest(&packed));
    write(&file.with_added_extension("sha256"), sum.as_bytes())?;
    Ok(Answer::Right(format!(
        "{}: {} files, {:.1} MB, SHA-256 {}",
        file.display(),
        files.len(),
        packed.len() as f64 / 1e6,
        digest(&packed)
    )))
}

/// Adds a file of the workspace, or all files of a folder, to `entries`, with the same path in the archive.
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

/// The paths in a folder, sorted, since the file system lists them in any order.
fn sorted(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let wrong = |why: std::io::Error| format!("{}: {why}", folder.display());
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        names.push(PathBuf::from(entry.map_err(wrong)?.file_name()));
    }
    names.sort();
    Ok(names)
}

/// SHA-256 checksums of the archive's entries, in the format that `sha256sum --check` reads.
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
