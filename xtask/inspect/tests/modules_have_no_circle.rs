//! Checks that no modules of a crate use each other in a circle, at any level of folders.
//!
//! A re-exported name counts as a use of the module that defines it. Tests do not count, nor what a macro names by `$crate`, since
//! that is used where the macro is called; `use …::*` is not followed. A module and the modules inside it may use each other.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

type Name = Vec<String>;

/// The modules of a crate, each with the paths that it writes and the names that it imports.
#[derive(Default)]
struct Modules(BTreeMap<Name, (Vec<Name>, BTreeMap<String, Name>)>);

fn is_sign(tree: Option<&TokenTree>, sign: char) -> bool {
    matches!(tree, Some(TokenTree::Punct(it)) if it.as_char() == sign)
}

impl Modules {
    /// Adds the source files in a folder of the crate.
    fn read(&mut self, folder: &Path, of: &Name) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let stem = path.file_stem().expect("a name").to_string_lossy();
            let mut module = of.clone();
            let root = of.is_empty() && ["lib", "main"].contains(&&*stem);
            if stem != "mod" && !root {
                module.push(stem.to_string());
            }
            if stem == "tests" || of.is_empty() && stem == "bin" {
                continue;
            }
            if path.is_dir() {
                self.0.entry(module.clone()).or_default();
                self.read(&path, &module);
            } else if path.extension().is_some_and(|it| it == "rs") {
                let text = std::fs::read_to_string(&path).expect("a source file");
                let tokens: TokenStream = text.parse().expect("Rust");
                self.0.entry(module.clone()).or_default();
                self.code(tokens, &module);
            }
        }
    }

    fn code(&mut self, tokens: TokenStream, module: &Name) {
        let all: Vec<TokenTree> = tokens.into_iter().collect();
        let ends = |from: usize, brace: bool| {
            let is_end = |tree: &TokenTree| match tree {
                TokenTree::Group(it) => brace && it.delimiter() == Delimiter::Brace,
                other => is_sign(Some(other), ';'),
            };
            let length = all[from..].iter().position(is_end);
            length.map_or(all.len(), |length| from + length)
        };
        let mut at = 0;
        while at < all.len() {
            match &all[at] {
                TokenTree::Group(group) if is_sign(at.checked_sub(1).map(|it| &all[it]), '#') => {
                    let words = group.stream().to_string().replace(' ', "");
                    if ["cfg(test", "cfg(all(test", "cfg(kani"]
                        .iter()
                        .any(|it| words.starts_with(it))
                    {
                        at = ends(at + 1, true);
                    }
                }
                TokenTree::Group(group) => self.code(group.stream(), module),
                TokenTree::Ident(word) if word == "use" => {
                    let end = ends(at + 1, false);
                    self.import(&all[at + 1..end], &Name::new(), module);
                    at = end;
                }
                TokenTree::Ident(word) => {
                    let of_macro = at > 0 && is_sign(Some(&all[at - 1]), '$');
                    let mut path = vec![word.to_string()];
                    while is_sign(all.get(at + 1), ':')
                        && is_sign(all.get(at + 2), ':')
                        && let Some(TokenTree::Ident(word)) = all.get(at + 3)
                    {
                        path.push(word.to_string());
                        at += 3;
                    }
                    if path.len() > 1 && !of_macro {
                        self.0.get_mut(module).expect("a module").0.push(path);
                    }
                }
                _ => {}
            }
            at += 1;
        }
    }

    /// Adds the names that a `use` imports.
    fn import(&mut self, tree: &[TokenTree], before: &Name, module: &Name) {
        for part in tree.split(|it| is_sign(Some(it), ',')) {
            let mut path = before.clone();
            let mut alias = None;
            for tree in part {
                match tree {
                    TokenTree::Group(group) => {
                        let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                        self.import(&inner, &path, module);
                        path.clear();
                    }
                    TokenTree::Ident(word) if word == "as" => alias = path.last().cloned(),
                    TokenTree::Ident(word) if alias.is_some() => alias = Some(word.to_string()),
                    TokenTree::Ident(word) if word == "self" && !path.is_empty() => {}
                    TokenTree::Ident(word) => path.push(word.to_string()),
                    _ => {}
                }
            }
            if let Some(name) = alias.or(path.last().cloned()) {
                let (paths, imports) = self.0.get_mut(module).expect("a module");
                imports.insert(name, path.clone());
                paths.push(path);
            }
        }
    }

    /// The module in which the item of a path stands that `module` writes; `None` if it is in another crate.
    fn place(&self, module: &Name, path: &[String], depth: usize) -> Option<Name> {
        let mut place = module.clone();
        let mut rest = path;
        match path[0].as_str() {
            "crate" => place.clear(),
            "self" | "super" => {}
            first => {
                let child = [&module[..], &[first.to_owned()]].concat();
                if !self.0.contains_key(&child) {
                    return None;
                }
            }
        }
        while let [first, more @ ..] = rest {
            let inner = [&place[..], std::slice::from_ref(first)].concat();
            match first.as_str() {
                "crate" | "self" => {}
                "super" => drop(place.pop()),
                _ if self.0.contains_key(&inner) => place = inner,
                _ => {
                    let imported = self.0[&place].1.get(first).filter(|_| depth < 9);
                    let further = imported.and_then(|path| {
                        self.place(&place, &[&path[..], more].concat(), depth + 1)
                    });
                    return further.or(Some(place));
                }
            }
            rest = more;
        }
        Some(place)
    }
}

/// What the modules of one folder use of each other: user, used, and an example.
type Uses = BTreeMap<String, BTreeMap<String, String>>;

impl Modules {
    fn uses(&self) -> BTreeMap<Name, Uses> {
        let mut all = BTreeMap::<Name, Uses>::new();
        for (module, (paths, _)) in &self.0 {
            for path in paths {
                let Some(used) = self.place(module, path, 0) else {
                    continue;
                };
                let mut both = module.iter().zip(&used);
                let Some(shared) = both.position(|(a, b)| a != b) else {
                    continue;
                };
                let uses = all.entry(module[..shared].to_vec()).or_default();
                let example = format!("{} uses {}", module.join("::"), path.join("::"));
                (uses.entry(module[shared].clone()).or_default())
                    .insert(used[shared].clone(), example);
            }
        }
        all
    }
}

/// The examples along a shortest way from one module to another.
fn way(uses: &Uses, from: &str, to: &str) -> Option<Vec<String>> {
    let mut seen = BTreeSet::from([from]);
    let mut ways = vec![(from, Vec::new())];
    let mut at = 0;
    while let Some((module, so_far)) = ways.get(at).cloned() {
        for (used, example) in uses.get(module).into_iter().flatten() {
            let longer = [&so_far[..], std::slice::from_ref(example)].concat();
            if used == to {
                return Some(longer);
            }
            if seen.insert(used) {
                ways.push((used, longer));
            }
        }
        at += 1;
    }
    None
}

fn crates(folder: &Path, found: &mut Vec<PathBuf>) {
    if folder.join("Cargo.toml").exists() && folder.join("src").exists() {
        found.push(folder.to_owned());
    }
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy();
        if path.is_dir()
            && !["target", "src", "node_modules"].contains(&&*name)
            && !name.starts_with('.')
        {
            crates(&path, found);
        }
    }
}

#[test]
fn no_modules_use_each_other_in_a_circle() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().expect("the repository");
    let mut found = Vec::new();
    crates(&root, &mut found);
    assert!(found.len() > 20, "only {} crates", found.len());
    let mut circles = Vec::new();
    for folder in &found {
        let mut modules = Modules::default();
        modules.0.entry(Name::new()).or_default();
        modules.read(&folder.join("src"), &Name::new());
        for uses in modules.uses().values() {
            let mut known = BTreeSet::new();
            for module in uses.keys() {
                let circle = way(uses, module, module).filter(|_| !known.contains(module));
                if let Some(circle) = circle {
                    let back = |it: &&String| {
                        way(uses, it, module).is_some() && way(uses, module, it).is_some()
                    };
                    known.extend(uses.keys().filter(back));
                    let name = folder
                        .strip_prefix(&root)
                        .expect("a folder of the repository");
                    circles.push(format!("{}: {}", name.display(), circle.join(", ")));
                }
            }
        }
    }
    assert!(
        circles.is_empty(),
        "{} circles:\n{}",
        circles.len(),
        circles.join("\n")
    );
}
