//! Lists the third-party packages in the programs of an archive, their licences and the licence texts that must be passed on.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Deserialize;

/// The fields that are read from the output of `cargo metadata`.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
    resolve: Resolve,
}

#[derive(Deserialize)]
struct Package {
    id: String,
    name: String,
    version: String,
    license: Option<String>,
    /// Where the package comes from; `None` for a package of the workspace.
    source: Option<String>,
    manifest_path: PathBuf,
}

#[derive(Deserialize)]
struct Resolve {
    nodes: Vec<Node>,
}

#[derive(Deserialize)]
struct Node {
    id: String,
    deps: Vec<Dependency>,
}

#[derive(Deserialize)]
struct Dependency {
    pkg: String,
    dep_kinds: Vec<Kind>,
}

#[derive(Deserialize)]
struct Kind {
    kind: Option<String>,
}

/// Names of the packages whose programs are in the archive.
const SHIPPED: [&str; 2] = ["touchstone", "touchstone-firmware"];
/// Beginnings of the file names that mark a licence text, which the archive must pass on.
const TEXTS: [&str; 6] = [
    "LICENSE",
    "LICENCE",
    "COPYING",
    "COPYRIGHT",
    "NOTICE",
    "UNLICENSE",
];

/// The list of packages as text, followed by their licence texts; equal texts appear once. Errors: a package names no licence.
pub fn text(metadata: &[&Path]) -> Result<String, String> {
    let mut rows = BTreeMap::new();
    let mut texts = BTreeMap::<String, BTreeSet<String>>::new();
    for path in metadata {
        let wrong = |why: String| format!("{}: {why}", path.display());
        let content = std::fs::read_to_string(path).map_err(|why| wrong(why.to_string()))?;
        let all: Metadata = serde_json::from_str(&content).map_err(|why| wrong(why.to_string()))?;
        for package in needed(&all).map_err(wrong)? {
            let name = format!("{} {}", package.name, package.version);
            let Some(licence) = &package.license else {
                return Err(format!("{name} names no licence in its Cargo.toml"));
            };
            let found = texts_of(package)?;
            let mark = if found.is_empty() {
                "  (no text comes with it)"
            } else {
                ""
            };
            rows.insert(name.clone(), format!("{licence}{mark}"));
            for text in found {
                texts.entry(text).or_default().insert(name.clone());
            }
        }
    }
    let mut out = format!(
        "Packages of others that are in `touchstone` or in a board's program, or help to build their code, with the licences that they name: {}.\n\
         Rust's own library is in both: MIT OR Apache-2.0. Below the list is every text that comes with a package, once.\n\n",
        rows.len()
    );
    for (name, licence) in &rows {
        out += &format!("{name:40} {licence}\n");
    }
    for (text, names) in &texts {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        out += &format!("\n{}\n{}\n\n{text}\n", "=".repeat(72), names.join(", "));
    }
    Ok(out)
}

/// The third-party packages that the shipped programs need, without those that are only used to build or test.
fn needed(all: &Metadata) -> Result<Vec<&Package>, String> {
    let packages: BTreeMap<&str, &Package> = all
        .packages
        .iter()
        .map(|package| (package.id.as_str(), package))
        .collect();
    let nodes: BTreeMap<&str, &Node> = all
        .resolve
        .nodes
        .iter()
        .map(|node| (node.id.as_str(), node))
        .collect();
    let mut open: Vec<&str> = all
        .packages
        .iter()
        .filter(|package| package.source.is_none() && SHIPPED.contains(&&*package.name))
        .map(|package| package.id.as_str())
        .collect();
    if open.is_empty() {
        return Err(format!("none of {} is in it", SHIPPED.join(", ")));
    }
    let mut seen = BTreeSet::new();
    while let Some(id) = open.pop() {
        if !seen.insert(id) {
            continue;
        }
        let node = nodes
            .get(id)
            .ok_or_else(|| format!("{id} is not resolved"))?;
        let normal = |dependency: &&Dependency| {
            let mut kinds = dependency.dep_kinds.iter();
            kinds.any(|kind| kind.kind.is_none())
        };
        open.extend(
            node.deps
                .iter()
                .filter(normal)
                .map(|next| next.pkg.as_str()),
        );
    }
    let found = seen.into_iter().filter_map(|id| packages.get(id).copied());
    Ok(found.filter(|package| package.source.is_some()).collect())
}

/// The licence texts in the folder of a package.
fn texts_of(package: &Package) -> Result<Vec<String>, String> {
    let folder = package.manifest_path.parent().unwrap_or(Path::new("."));
    let mut texts = Vec::new();
    for name in super::sorted(folder)? {
        let upper = name.to_string_lossy().to_uppercase();
        let path = folder.join(&name);
        if TEXTS.iter().any(|start| upper.starts_with(start)) && path.is_file() {
            let text = String::from_utf8_lossy(&super::read(&path)?).into_owned();
            texts.push(text.replace('\r', "").trim_end().to_owned());
        }
    }
    Ok(texts)
}
