//! Stores in a file whether each deliberately wrong change was caught, so that an interrupted run can continue.
//!
//! A stored result counts only for the same sources, the same change and, if one is given, the same tested program.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A stored result: one word such as `caught`, and the reason.
pub type StoredResult = (String, String);

/// The stored results of the wrong changes, and the file that holds them.
pub struct Memo {
    file: PathBuf,
    ground: u64,
    known: BTreeMap<u64, StoredResult>,
}

impl Memo {
    /// Opens the file of stored results. `asked` is the tested program. A result for other sources or another program has another
    /// key, so it is never found.
    pub fn open(file: PathBuf, sources: &Path, asked: Option<&Path>) -> std::io::Result<Self> {
        let mut hasher = DefaultHasher::new();
        take(sources, sources, &mut hasher)?;
        if let Some(program) = asked {
            std::fs::read(program)?.hash(&mut hasher);
        }
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let known = text.lines().filter_map(line).collect();
        Ok(Self {
            file,
            ground: hasher.finish(),
            known,
        })
    }

    /// The key under which the result for a change is stored: a hash of the change, the sources and the tested program.
    pub fn key(&self, question: &impl Hash) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.ground.hash(&mut hasher);
        question.hash(&mut hasher);
        hasher.finish()
    }

    /// The stored result with this key, if there is one.
    pub fn get(&self, key: u64) -> Option<&StoredResult> {
        self.known.get(&key)
    }

    /// Stores a result and appends it to the file at once.
    pub fn keep(&mut self, key: u64, word: &str, reason: &str) -> std::io::Result<()> {
        let mut file = std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(&self.file)?;
        let reason = reason.replace(['\n', '\t'], " ");
        writeln!(file, "{key:016x}\t{word}\t{reason}")?;
        self.known.insert(key, (word.to_owned(), reason));
        Ok(())
    }
}

fn line(text: &str) -> Option<(u64, StoredResult)> {
    let mut words = text.splitn(3, '\t');
    let key = u64::from_str_radix(words.next()?, 16).ok()?;
    let (word, reason) = (words.next()?, words.next()?);
    Some((key, (word.to_owned(), reason.to_owned())))
}

/// Hashes the name and content of all files below a folder, in the order of their names.
fn take(root: &Path, from: &Path, hasher: &mut DefaultHasher) -> std::io::Result<()> {
    let mut entries = std::fs::read_dir(from)?.collect::<Result<Vec<_>, _>>()?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        if path.is_dir() {
            take(root, &path, hasher)?;
        } else {
            path.strip_prefix(root).unwrap_or(&path).hash(hasher);
            std::fs::read(&path)?.hash(hasher);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::changes::Entry;

    #[test]
    fn what_was_found_counts_for_the_same_sources_program_and_question_only() {
        let folder = std::env::temp_dir().join(format!("touchstone-memo-{}", std::process::id()));
        let sources = folder.join("sources/drive");
        std::fs::create_dir_all(&sources).unwrap();
        let (source, emulator) = (sources.join("a.rs"), folder.join("emulator"));
        let (root, kept) = (folder.join("sources"), folder.join("found.tsv"));
        let write = |path: &Path, text: &str| std::fs::write(path, text).unwrap();
        let open = || Memo::open(kept.clone(), &root, Some(&emulator)).unwrap();
        write(&source, "one");
        write(&emulator, "one");
        let entry = Entry::with(&[("name", "no limit"), ("only", "a row")]);
        let of = |memo: &Memo| memo.key(&("board", Some(&entry)));
        let mut memo = open();
        assert_eq!(memo.get(of(&memo)), None);
        memo.keep(of(&memo), "caught", "the outputs\tstay on")
            .unwrap();
        let again = open();
        let found = ("caught".to_owned(), "the outputs stay on".to_owned());
        assert_eq!(again.get(of(&again)), Some(&found));
        let other = Entry::with(&[("name", "no limit"), ("only", "another row")]);
        assert_eq!(again.get(again.key(&("board", Some(&other)))), None);
        let none: Option<&Entry> = None;
        assert_eq!(again.get(again.key(&("board", none))), None);
        for changed in [&source, &emulator] {
            write(changed, "two");
            let memo = open();
            assert_eq!(memo.get(of(&memo)), None);
            write(changed, "one");
        }
        let memo = open();
        assert_eq!(memo.get(of(&memo)), Some(&found));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
