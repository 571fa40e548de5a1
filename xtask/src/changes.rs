//! Deliberately wrong changes in a copy of the sources, used by `prove --mutants` and `fil --sabotage` to check that the tests
//! detect them.
//!
//! The copy is below `target/`; the sources themselves are only read. The text to be changed must occur exactly once in its file. A
//! list that no longer fits the sources is therefore reported.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::outcome::Outcome;
use crate::{inspect, shell};

/// One entry of a list of deliberately wrong changes.
#[derive(Debug, Default, Clone, Hash)]
pub struct Entry {
    /// Fields of the entry other than its changes, by the field's name.
    words: BTreeMap<String, String>,
    pub changes: Vec<Change>,
}

/// One replacement of text in a file.
#[derive(Debug, Default, Clone, Hash)]
pub struct Change {
    /// Path of the file, relative to the workspace's folder.
    pub file: String,
    /// Text that is replaced. It must occur exactly once in the file.
    pub find: String,
    /// Text that takes the place of `find`.
    pub replace: String,
}

impl Entry {
    /// The entry's text in the field of this name; empty if the entry has no such field.
    pub fn word(&self, name: &str) -> &str {
        self.words.get(name).map_or("", String::as_str)
    }

    /// For tests: an entry with these fields.
    #[cfg(test)]
    pub fn with(words: &[(&str, &str)]) -> Self {
        let mut entry = Self::default();
        for (name, text) in words {
            entry.add(name, text);
        }
        entry
    }

    fn add(&mut self, name: &str, text: &str) {
        if name == "file" {
            self.changes.push(Change::default());
        }
        match (name, self.changes.last_mut()) {
            ("file", Some(change)) => change.file = text.into(),
            ("find", Some(change)) => change.find = text.into(),
            ("replace", Some(change)) => change.replace = text.into(),
            _ => drop(self.words.insert(name.into(), text.into())),
        }
    }
}

/// Reads the entries of a list of wrong changes; `path` is the list's file in the workspace.
pub fn list(path: &str) -> Result<Vec<Entry>, Outcome> {
    match inspect::ask(["changes", path]) {
        (lines, Outcome::Ok(_)) => Ok(entries(&lines)),
        (_, other) => Err(other),
    }
}

/// Parses the entries from lines of a name, a tab and a text. The name `next` begins an entry. A line separator (U+2028) in a text
/// stands for a line's end.
fn entries(lines: &[String]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for (name, text) in lines.iter().filter_map(|line| line.split_once('\t')) {
        match (name, entries.last_mut()) {
            ("next", _) => entries.push(Entry::default()),
            (_, Some(entry)) => entry.add(name, &text.replace('\u{2028}', "\n")),
            (_, None) => {}
        }
    }
    entries
}

/// Copies `members`, `more` and `Cargo.lock` from the workspace to `folder/work`. The copy has a manifest of a workspace with the
/// members `members`.
pub fn copy(folder: &Path, members: &[&str], more: &[&str]) -> Result<PathBuf, String> {
    let work = folder.join("work");
    let said = |path: &Path| {
        let path = path.display().to_string();
        move |why: std::io::Error| format!("{path}: {why}")
    };
    if work.exists() {
        std::fs::remove_dir_all(&work).map_err(said(&work))?;
    }
    std::fs::create_dir_all(&work).map_err(said(&work))?;
    let root = shell::root();
    for part in members.iter().chain(more).chain(&["Cargo.lock"]) {
        let (from, to) = (root.join(part), work.join(part));
        copy_all(&from, &to).map_err(said(&from))?;
    }
    let manifest = root.join("Cargo.toml");
    let text = std::fs::read_to_string(&manifest).map_err(said(&manifest))?;
    let manifest = work.join("Cargo.toml");
    std::fs::write(&manifest, with_members(&text, members)).map_err(said(&manifest))?;
    Ok(work)
}

/// Copies a file, or a folder without the build results in it.
fn copy_all(from: &Path, to: &Path) -> std::io::Result<()> {
    if !from.is_dir() {
        return std::fs::copy(from, to).map(|_| ());
    }
    std::fs::create_dir_all(to)?;
    for entry in std::fs::read_dir(from)? {
        let entry = entry?;
        if entry.file_name() != "target" {
            copy_all(&entry.path(), &to.join(entry.file_name()))?;
        }
    }
    Ok(())
}

/// The text of the workspace's manifest, with `members` in the place of its members.
fn with_members(manifest: &str, members: &[&str]) -> String {
    let mut kept = String::new();
    // A list of members may span several lines.
    let mut within = false;
    for line in manifest.lines() {
        let list = ["members = [", "default-members = [", "exclude = ["]
            .iter()
            .any(|key| line.starts_with(key));
        if list || within {
            within = !line.contains(']');
        } else {
            kept += line;
            kept += "\n";
        }
        if line.starts_with("members = [") {
            kept += &format!("members = {members:?}\nexclude = [\"firmware\"]\n");
        }
    }
    kept
}

impl Change {
    /// Checks that the text to be replaced occurs exactly once in the source.
    pub fn fits(&self, source: &str) -> Result<(), String> {
        match source.matches(&self.find).count() {
            1 => Ok(()),
            count => Err(format!(
                "{}: `{}` is there {count} times, not once",
                self.file, self.find
            )),
        }
    }
}

/// Applies the changes of an entry, calls `ask` on the changed sources, and undoes the changes. Errors: a change does not fit the
/// sources, or `ask` fails.
pub fn with<T>(
    work: &Path,
    changes: &[Change],
    ask: impl FnOnce() -> Result<T, String>,
) -> Result<T, String> {
    let mut before: Vec<(PathBuf, String)> = Vec::new();
    let made = (|| {
        for change in changes {
            let path = work.join(&change.file);
            let said = |why: std::io::Error| format!("{}: {why}", change.file);
            let source = std::fs::read_to_string(&path).map_err(said)?;
            change.fits(&source)?;
            let changed = source.replace(&change.find, &change.replace);
            before.push((path.clone(), source));
            std::fs::write(&path, changed).map_err(said)?;
        }
        Ok(())
    })();
    let answer = made.and_then(|()| ask());
    // In reverse order, because two changes may be in one file.
    for (path, source) in before.iter().rev() {
        std::fs::write(path, source).map_err(|why| format!("{}: {why}", path.display()))?;
    }
    answer
}

#[cfg(test)]
mod tests {
    use super::entries;

    #[test]
    fn lines_become_entries_with_their_changes() {
        let lines = "next\t\nname\tno limit\nfile\ta.rs\nfind\tx\nreplace\t\nfile\tb.rs\nfind\ty\nreplace\tz\nnext\t\nname\tb";
        let lines: Vec<String> = lines.lines().map(str::to_owned).collect();
        let found = entries(&lines);
        assert_eq!(found.len(), 2);
        assert_eq!(
            (found[0].word("name"), found[1].word("name")),
            ("no limit", "b")
        );
        assert_eq!(found[0].word("board"), "");
        let change = &found[0].changes[1];
        assert_eq!(
            (&*change.file, &*change.find, &*change.replace),
            ("b.rs", "y", "z")
        );
        assert!(found[0].changes[0].replace.is_empty() && found[1].changes.is_empty());
    }
}
