//! Which functions of the law's code a harness reaches: read from the names in the checker's program of it.

use std::collections::BTreeSet;
use std::path::Path;

use serde::Deserialize;

use crate::answer::Answer;

/// The crates whose functions are looked for.
const CRATES: [&str; 2] = ["touchstone_control::", "touchstone_protocol::"];
/// Types of the harnesses' own, whose methods are not the law's code.
const NOT_OURS: &str = "facts::";

/// What the checker writes about a crate's harnesses.
#[derive(Deserialize)]
struct Metadata {
    proof_harnesses: Vec<Harness>,
}

#[derive(Deserialize)]
struct Harness {
    pretty_name: String,
    goto_file: String,
}

/// Of each harness of the newest build in `folder`: its name, how large its program is, in bytes, and the functions in it.
pub fn reached(folder: &Path) -> Result<Answer, String> {
    let newest = newest(folder)?;
    let text = std::fs::read_to_string(&newest).map_err(|why| why.to_string())?;
    let metadata: Metadata = serde_json::from_str(&text).map_err(|why| why.to_string())?;
    let mut read = 0;
    for harness in &metadata.proof_harnesses {
        let program = harness.goto_file.replace(".symtab.out", ".out");
        let Ok(bytes) = std::fs::read(&program) else {
            continue;
        };
        let names: Vec<String> = functions(&bytes).into_iter().collect();
        println!(
            "{}\t{}\t{}",
            harness.pretty_name,
            bytes.len(),
            names.join(";")
        );
        read += 1;
    }
    match read {
        0 => Err(format!("{}: no program of a harness", folder.display())),
        _ => Ok(Answer::Right(format!("{read} harnesses"))),
    }
}

fn newest(folder: &Path) -> Result<std::path::PathBuf, String> {
    let entries =
        std::fs::read_dir(folder).map_err(|why| format!("{}: {why}", folder.display()))?;
    entries
        .filter_map(Result::ok)
        .map(|entry| entry.path())
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("touchstone_proofs") && name.ends_with(".kani-metadata.json")
        })
        .max_by_key(|path| path.metadata().and_then(|of| of.modified()).ok())
        .ok_or_else(|| format!("{}: no harness was built", folder.display()))
}

/// The functions of the crate among a program's strings, without their type arguments: `filter::VirtualMass::drive`.
fn functions(bytes: &[u8]) -> BTreeSet<String> {
    let printable = |byte: &u8| (b' '..=b'~').contains(byte);
    bytes
        .split(|byte| !printable(byte))
        .filter_map(|run| function(std::str::from_utf8(run).ok()?))
        .collect()
}

/// One string, a stray byte at most before it: a function of the crates, or `<Type as Trait>::method` with a trait of theirs.
fn function(text: &str) -> Option<String> {
    [text, text.get(1..).unwrap_or_default()]
        .into_iter()
        .find_map(|text| match text.strip_prefix('<') {
            Some(of_trait) => method(of_trait),
            None => plain(text),
        })
        .map(|name| {
            name.split("::{closure")
                .next()
                .unwrap_or_default()
                .to_owned()
        })
        .filter(|name| {
            let ok = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == ':';
            name.contains("::") && name.chars().all(ok)
        })
}

fn plain(text: &str) -> Option<String> {
    let of = CRATES.iter().find(|of| text.starts_with(**of))?;
    Some(without_arguments(&text[of.len()..]))
}

/// `Type as Trait>::method`.
fn method(text: &str) -> Option<String> {
    let (own, rest) = text.split_once(" as ")?;
    let (of_trait, method) = rest.rsplit_once(">::")?;
    let ours = |path: &str| CRATES.iter().any(|of| path.starts_with(of));
    if own.starts_with(NOT_OURS) || !ours(of_trait) && !ours(own) {
        return None;
    }
    let own = without_arguments(own);
    let own = CRATES
        .iter()
        .find_map(|of| own.strip_prefix(of))
        .unwrap_or(&own);
    Some(format!("{own}::{}", without_arguments(method)))
}

/// `VirtualMass::<facts::Facts32>` is `VirtualMass`.
fn without_arguments(name: &str) -> String {
    let mut depth = 0_u32;
    let mut out = String::new();
    for c in name.chars() {
        match c {
            '<' => depth += 1,
            '>' => depth = depth.saturating_sub(1),
            _ if depth == 0 => out.push(c),
            _ => {}
        }
    }
    out.replace("::::", "::").trim_end_matches(':').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_function_is_named_without_what_it_is_made_for() {
        for (text, wanted) in [
            (
                "7touchstone_control::filter::VirtualMass::<facts::Facts32>::drive",
                Some("filter::VirtualMass::drive"),
            ),
            (
                "<touchstone_control::law::Tdpa<number::Fixed32<24>> as touchstone_control::Law>::tick",
                Some("law::Tdpa::tick"),
            ),
            (
                "touchstone_control::guard::settings::derived::{closure#0}",
                Some("guard::settings::derived"),
            ),
            (
                "3<u8 as touchstone_control::magnitude::Word>::divides_within::{closure#0}",
                Some("u8::divides_within"),
            ),
            (
                "<facts::Facts32 as touchstone_control::Number>::product",
                None,
            ),
            (
                "std::ptr::drop_in_place::<touchstone_control::filter::VirtualMass>",
                None,
            ),
        ] {
            assert_eq!(function(text).as_deref(), wanted, "{text}");
        }
    }
}
