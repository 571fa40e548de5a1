//! The search for Force Dimension's library: the places where the program looks, and the message if it finds none.

use crate::Dhd;
use std::env;
use std::fmt;
use std::path::{Path, PathBuf};

/// Environment variables that the search for Force Dimension's library uses. The first names the library's file; the other two,
/// which the maker uses as well, name the folder of the SDK.
pub const ENVIRONMENT: [&str; 3] = ["TOUCHSTONE_DHD", "FDSDK", "FORCEDIM_SDK"];

/// File names of the library without a version, in the order of trying. `drd` comes first because it contains all functions of
/// `dhd`.
#[cfg(target_os = "windows")]
const NAMES: [&str; 4] = ["drd64.dll", "dhd64.dll", "drd.dll", "dhd.dll"];
#[cfg(target_os = "macos")]
const NAMES: [&str; 2] = ["libdrd.dylib", "libdhd.dylib"];
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const NAMES: [&str; 4] = ["libdrd.so.3", "libdrd.so", "libdhd.so.3", "libdhd.so"];

/// Parts of library file names with a version: the text before the version, and the text after it.
#[cfg(target_os = "windows")]
const VERSIONED: [(&str, &str); 0] = [];
#[cfg(target_os = "macos")]
const VERSIONED: [(&str, &str); 2] = [("libdrd", ".dylib"), ("libdhd", ".dylib")];
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const VERSIONED: [(&str, &str); 2] = [("libdrd.so", ""), ("libdhd.so", "")];

/// The places in which the program looks for Force Dimension's library.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LibrarySearch {
    /// The library's file, if the user named one; then no other place is tried.
    pub file: Option<PathBuf>,
    /// Folders to search, in the order of trying.
    pub folders: Vec<PathBuf>,
    /// Whether the program finally tries the bare file names, which the operating system's loader then searches for.
    pub system: bool,
}

/// The error if Force Dimension's library could not be loaded from any place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotLoaded {
    /// Places that the program tried, each with the reason for the failure.
    pub tried: Vec<(PathBuf, String)>,
    /// Whether the user named the library's file.
    pub named: bool,
}

impl fmt::Display for NotLoaded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.named {
            let (path, why) = &self.tried[0];
            return write!(f, "{} cannot be loaded: {why}", path.display());
        }
        write!(f, "libdrd and libdhd were not found in")?;
        for (i, (path, why)) in self.tried.iter().enumerate() {
            let comma = if i > 0 { "," } else { "" };
            write!(f, "{comma} {} ({why})", path.display())?;
        }
        Ok(())
    }
}

impl NotLoaded {
    /// Advice to the user on how to make the library available.
    #[must_use]
    pub fn fix(&self) -> &'static str {
        if self.tried.iter().any(|(_, why)| why.contains("usb")) {
            return "install libusb 1.0, which the library needs (Debian, Ubuntu: apt install libusb-1.0-0)";
        }
        "install Force Dimension's SDK (forcedimension.com/software/sdk) and set FDSDK to its folder, or name the library by --library FILE"
    }
}

impl LibrarySearch {
    /// The default search. It uses the file `named`, else the file in the variable `TOUCHSTONE_DHD`, else the folders of the SDK
    /// and of the operating system.
    #[must_use]
    pub fn new(named: Option<&Path>) -> Self {
        let set = |name| env::var_os(name).filter(|text| !text.is_empty());
        let file = named
            .map(Path::to_owned)
            .or_else(|| set(ENVIRONMENT[0]).map(PathBuf::from));
        if file.is_some() {
            return Self {
                file,
                ..Self::default()
            };
        }
        let mut folders = Vec::new();
        for sdk in ENVIRONMENT[1..].iter().filter_map(|name| set(name)) {
            let sdk = PathBuf::from(sdk);
            folders.extend(children(&sdk.join("lib").join("release"), &platform()));
            folders.extend([sdk.join("lib"), sdk.join("bin"), sdk]);
        }
        if let Some(home) = set("HOME") {
            folders.push(PathBuf::from(home).join(".local").join("lib"));
        }
        if cfg!(unix) {
            folders.push("/usr/local/lib".into());
        }
        for root in [set("LOCALAPPDATA"), set("ProgramFiles")]
            .into_iter()
            .flatten()
        {
            let vendor = PathBuf::from(root).join("Force Dimension");
            folders.extend(
                children(&vendor, "sdk-")
                    .into_iter()
                    .map(|sdk| sdk.join("bin")),
            );
        }
        Self {
            file: None,
            folders,
            system: true,
        }
    }

    /// Loads the first library file of the search that can be loaded.
    ///
    /// # Errors
    /// No library could be loaded. The error lists all places with the reasons.
    pub fn load(&self) -> Result<Dhd, NotLoaded> {
        let mut tried = Vec::new();
        if let Some(file) = &self.file {
            // Made absolute, because the operating system's loader would search for a bare name.
            let here = std::path::absolute(file).unwrap_or_else(|_| file.clone());
            return Dhd::load(&here).map_err(|why| NotLoaded {
                tried: vec![(file.clone(), why)],
                named: true,
            });
        }
        for folder in &self.folders {
            let found = libraries(folder);
            if found.is_empty() {
                tried.push((folder.clone(), "not there".to_owned()));
            }
            for library in found {
                match Dhd::load(&library) {
                    Ok(dhd) => return Ok(dhd),
                    Err(why) => tried.push((library, why)),
                }
            }
        }
        for name in NAMES.iter().filter(|_| self.system) {
            match Dhd::load(Path::new(name)) {
                Ok(dhd) => return Ok(dhd),
                // The loader's message for an unknown name is the same for all names, so only other messages are kept.
                Err(why) if why.contains("usb") => tried.push((name.into(), why)),
                Err(_) => {}
            }
        }
        if self.system {
            tried.push(("the system's libraries".into(), "not there".to_owned()));
        }
        Err(NotLoaded {
            tried,
            named: false,
        })
    }
}

/// Name of this operating system and processor in the folders of the maker's SDK.
fn platform() -> String {
    let system = if cfg!(target_os = "macos") {
        "mac"
    } else {
        "lin"
    };
    let machine = match env::consts::ARCH {
        "aarch64" if cfg!(target_os = "macos") => "arm64",
        machine => machine,
    };
    format!("{system}-{machine}-")
}

/// The folders inside `folder` whose names begin with `prefix`, newer versions before older ones.
fn children(folder: &Path, prefix: &str) -> Vec<PathBuf> {
    let mut found = named(folder, |name| name.starts_with(prefix));
    found.retain(|path| path.is_dir());
    found
}

/// The library files in a folder: `drd` before `dhd`, newer versions before older ones.
fn libraries(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for (start, part) in VERSIONED {
        found.extend(named(folder, |name| {
            name.starts_with(start) && name.contains(part)
        }));
    }
    for name in NAMES {
        let path = folder.join(name);
        if path.is_file() && !found.contains(&path) {
            found.push(path);
        }
    }
    found
}

fn named(folder: &Path, wanted: impl Fn(&str) -> bool) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut found: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| {
            path.file_name()
                .and_then(|name| name.to_str())
                .is_some_and(&wanted)
        })
        .collect();
    found.sort_by_key(|path| std::cmp::Reverse(numbers(path)));
    found
}

/// A sort key from the numbers in a file name, so that 3.17.6 is newer than 3.9.1.
fn numbers(path: &Path) -> (Vec<u32>, PathBuf) {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let numbers = name.split(|letter: char| !letter.is_ascii_digit());
    (
        numbers.filter_map(|digits| digits.parse().ok()).collect(),
        path.to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newer_versions_come_first() {
        let key = |name: &str| numbers(Path::new(name)).0;
        assert!(key("libdrd.so.3.17.6") > key("libdrd.so.3.9.1"));
        assert!(key("sdk-3.17.6") > key("sdk-3.16.1"));
    }

    #[test]
    fn what_is_not_there_is_said_with_every_place_and_a_remedy() {
        let search = LibrarySearch {
            folders: vec!["/nowhere/a".into(), "/nowhere/b".into()],
            ..LibrarySearch::default()
        };
        let missing = search.load().expect_err("no library");
        let said = missing.to_string();
        assert!(
            said.contains("/nowhere/a (not there), /nowhere/b"),
            "{said}"
        );
        assert!(missing.fix().contains("FDSDK") && missing.fix().contains("--library"));
        let named = LibrarySearch::new(Some(Path::new("/nowhere/libdrd.so")));
        let missing = named.load().expect_err("no library");
        assert!(missing.named && missing.tried.len() == 1);
        assert!(
            missing
                .to_string()
                .starts_with("/nowhere/libdrd.so cannot be loaded")
        );
    }
}
