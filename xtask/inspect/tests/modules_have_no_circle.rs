//! Checks that no modules of a crate use each other in a circle, at any level of folders.
//!
//! A re-exported name counts as a use of the module that defines it. A name that `use …::*` may bring is a use of the modules so
//! imported that have the word, or of all if none has it, because a macro made it. Tests do not count, nor macros at the crate's
//! root, nor what a macro names by `$crate`, since that is used where the macro is called. A module and the modules inside it may
//! use each other.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

type Name = Vec<String>;

/// What a module writes: paths, imported names, modules of which it imports all names, and words.
#[derive(Default)]
struct Module {
    paths: Vec<Name>,
    imports: BTreeMap<String, Name>,
    globs: Vec<Name>,
    words: BTreeSet<String>,
}

/// The modules of a crate.
#[derive(Default)]
struct Modules(BTreeMap<Name, Module>);

fn is_sign(tree: Option<&TokenTree>, sign: char) -> bool {
    matches!(tree, Some(TokenTree::Punct(it)) if it.as_char() == sign)
}

fn inside(module: &Name, name: &str) -> Name {
    [&module[..], &[name.to_owned()]].concat()
}

impl Modules {
    /// Adds the source files in a folder of the crate.
    fn read(&mut self, folder: &Path, of: &Name) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let stem = path.file_stem().expect("a name").to_string_lossy();
            if stem == "tests" || of.is_empty() && stem == "bin" {
                continue;
            }
            let root = of.is_empty() && ["lib", "main"].contains(&&*stem);
            let module = if stem == "mod" || root {
                of.clone()
            } else {
                inside(of, &stem)
            };
            if path.is_dir() {
                self.read(&path, &module);
            } else if path.extension().is_some_and(|it| it == "rs") {
                let text = std::fs::read_to_string(&path).expect("a source file");
                self.code(text.parse().expect("Rust"), &module);
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
        self.0.entry(module.clone()).or_default();
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
                TokenTree::Ident(word) if word == "mod" => {
                    // The name of a module that a macro makes begins with `$`.
                    at += 1 + usize::from(is_sign(all.get(at + 1), '$'));
                    if let Some(TokenTree::Ident(name)) = all.get(at)
                        && let Some(TokenTree::Group(body)) = all.get(at + 1)
                    {
                        self.code(body.stream(), &inside(module, &name.to_string()));
                        at += 1;
                    }
                }
                TokenTree::Ident(word) => {
                    let by_macro = at > 0 && is_sign(Some(&all[at - 1]), '$');
                    let mut path = vec![word.to_string()];
                    while is_sign(all.get(at + 1), ':')
                        && is_sign(all.get(at + 2), ':')
                        && let Some(TokenTree::Ident(word)) = all.get(at + 3)
                    {
                        path.push(word.to_string());
                        at += 3;
                    }
                    let is_call = is_sign(all.get(at + 1), '!')
                        && matches!(all.get(at + 2), Some(TokenTree::Group(_)));
                    let of_root = is_call && path.len() == 2 && path[0] == "crate";
                    let of = self.0.get_mut(module).expect("a module");
                    of.words.extend(path.iter().cloned());
                    if path.len() > 1 && !by_macro && !of_root {
                        of.paths.push(path);
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
                let of = self.0.get_mut(module).expect("a module");
                of.paths.push(path.clone());
                if is_sign(part.last(), '*') {
                    of.globs.push(path);
                } else {
                    of.words.insert(name.clone());
                    of.imports.insert(name, path);
                }
            }
        }
    }

    /// The modules in which the item of a path may stand that `module` writes; none if it is in another crate.
    fn places(&self, module: &Name, path: &[String], depth: usize) -> Vec<Name> {
        let mut place = match path[0].as_str() {
            "crate" => Name::new(),
            first if ["self", "super"].contains(&first) => module.clone(),
            first if self.0.contains_key(&inside(module, first)) => module.clone(),
            _ => return Vec::new(),
        };
        for (at, name) in path.iter().enumerate() {
            let inner = inside(&place, name);
            match name.as_str() {
                "crate" | "self" => {}
                "super" => drop(place.pop()),
                _ if self.0.contains_key(&inner) => place = inner,
                _ if depth > 9 => break,
                _ => {
                    let of = &self.0[&place];
                    let has = |glob: &&Name| {
                        let places = self.places(&place, glob, depth + 1);
                        places.iter().any(|it| self.0[it].words.contains(name))
                    };
                    let mut globs: Vec<&Name> = of.globs.iter().filter(has).collect();
                    if globs.is_empty() && !of.words.contains(name) {
                        globs.extend(&of.globs);
                    }
                    let globs = globs.into_iter().map(|glob| inside(glob, name));
                    let imported = of.imports.get(name);
                    let ways = imported.map_or_else(|| globs.collect(), |it| vec![it.clone()]);
                    let found: Vec<Name> = (ways.iter())
                        .map(|way| [&way[..], &path[at + 1..]].concat())
                        .flat_map(|way| self.places(&place, &way, depth + 1))
                        .collect();
                    return if found.is_empty() { vec![place] } else { found };
                }
            }
        }
        vec![place]
    }
}

/// What the modules of one folder use of each other: user, used, and an example.
type Uses = BTreeMap<String, BTreeMap<String, String>>;

impl Modules {
    fn uses(&self) -> BTreeMap<Name, Uses> {
        let mut all = BTreeMap::<Name, Uses>::new();
        for (module, of) in &self.0 {
            for path in &of.paths {
                for used in self.places(module, path, 0) {
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
        }
        all
    }

    /// For each module in a circle, the examples along a shortest one.
    fn circles(&self) -> BTreeSet<String> {
        let mut circles = BTreeSet::new();
        for uses in self.uses().values() {
            for mut circle in uses.keys().filter_map(|module| circle(uses, module)) {
                circle.sort();
                circles.insert(circle.join(", "));
            }
        }
        circles
    }
}

/// The examples along a shortest way from a module to itself.
fn circle(uses: &Uses, of: &str) -> Option<Vec<String>> {
    let mut seen = BTreeSet::new();
    let mut ways = vec![(of, Vec::new())];
    let mut at = 0;
    while let Some((module, so_far)) = ways.get(at).cloned() {
        for (used, example) in uses.get(module).into_iter().flatten() {
            let longer = [&so_far[..], std::slice::from_ref(example)].concat();
            if used == of {
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
        modules.read(&folder.join("src"), &Name::new());
        let name = folder.strip_prefix(&root).expect("in the repository");
        let said = |circle| format!("{}: {circle}", name.display());
        circles.extend(modules.circles().into_iter().map(said));
    }
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

/// Small crates: the root and module `one`, beside a module `two` that uses `one`.
const CIRCLES: &str = "
    | use crate::two::Two; pub struct One;
    | use crate::{two::*}; pub struct One;
    pub use two::Two; | fn f(_: crate::Two) {} pub struct One;
    pub use two::*; | use crate::Two as Other; pub struct One;
    pub use two::*; | use super::MadeByMacro; pub struct One;
    pub use two::Two; | pub struct One; mod inner { use super::super::Two; }";
const NONE: &str = "
    | pub struct One;
    | use two::Two; pub struct One;
    pub use two::*; pub struct Own; | use crate::Own; pub struct One;
    pub use two::*; | crate::rows!(One); pub struct One;
    pub use two::Two; | #[cfg(test)] mod tests { use crate::Two; } pub struct One;
    pub use two::Two; | pub struct One; struct Two; mod inner { use super::Two; }
    pub use two::Two; | pub struct One; struct Two; m!(mod $inner { use super::Two; });";

#[test]
fn the_reader_finds_each_circle_and_no_other() {
    for (crates, is_circle) in [(CIRCLES, true), (NONE, false)] {
        for line in crates.lines().skip(1) {
            let (root, one) = line.split_once('|').expect("root and module");
            let mut modules = Modules::default();
            modules.code(root.parse().expect("Rust"), &Name::new());
            modules.code(one.parse().expect("Rust"), &vec!["one".into()]);
            let two = "use crate::one::One; pub struct Two;".parse();
            modules.code(two.expect("Rust"), &vec!["two".into()]);
            assert_eq!(!modules.circles().is_empty(), is_circle, "{line}");
        }
    }
}
