//! Searches Rust source for float types, literals and casts. Comments, strings, tests and code behind the feature `float` are left
//! out.
//!
//! Clippy's `disallowed_types` would find only types: a literal such as `1.5` in `from_num(1.5)` names no type.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Result of a search through the sources in a folder.
#[derive(Debug, Default)]
pub struct Scan {
    pub files: usize,
    /// Places found, each as `file:line: word`.
    pub findings: Vec<String>,
}

/// Searches every source file below a folder.
pub fn floats_below(folder: &Path) -> Result<Scan, String> {
    let mut files = Vec::new();
    collect(folder, &mut files)?;
    files.sort();
    let texts: Result<Vec<_>, String> = files.iter().map(|file| read(file)).collect();
    let texts = texts?;
    let said = |file: &Path| {
        let file = file.display().to_string();
        move |error| format!("{file}: {error}")
    };
    // Files of modules that only tests or the feature `float` compile are left out.
    let mut left_out = BTreeSet::new();
    for (file, text) in files.iter().zip(&texts) {
        let parent = module_folder(file);
        for name in scan(text).map_err(said(file))?.gated_modules {
            left_out.insert(parent.join(format!("{name}.rs")));
            left_out.insert(parent.join(&name).join("mod.rs"));
        }
    }
    let mut result = Scan::default();
    for (file, text) in files.iter().zip(&texts) {
        if left_out.contains(file) {
            continue;
        }
        result.files += 1;
        let name = file.strip_prefix(folder).unwrap_or(file).display();
        for (line, word) in scan(text).map_err(said(file))?.floats {
            result.findings.push(format!("{name}:{line}: {word}"));
        }
    }
    Ok(result)
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), String> {
    let wrong = |error: std::io::Error| format!("{}: {error}", folder.display());
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        let path = entry.map_err(wrong)?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

fn read(file: &Path) -> Result<String, String> {
    std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))
}

/// Folder with the files of the modules that a source file declares.
fn module_folder(file: &Path) -> PathBuf {
    let parent = file.parent().unwrap_or(Path::new(""));
    let stem = file.file_stem().unwrap_or_default();
    if ["mod", "lib", "main"].iter().any(|root| stem == *root) {
        parent.to_path_buf()
    } else {
        parent.join(stem)
    }
}

/// What was found in one source text: floats with their lines, and the modules that only tests or the feature `float` compile.
#[derive(Debug, Default)]
struct FoundFloats {
    floats: Vec<(usize, String)>,
    gated_modules: Vec<String>,
}

fn scan(text: &str) -> Result<FoundFloats, proc_macro2::LexError> {
    let mut found = FoundFloats::default();
    scan_tokens(text.parse()?, &mut found);
    Ok(found)
}

fn scan_tokens(tokens: TokenStream, found: &mut FoundFloats) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        if is_gate(&tokens[at..]) {
            let item = &tokens[at + 2..];
            found.gated_modules.extend(declared_module(item));
            at += 2 + item_length(item);
            continue;
        }
        let line = || token.span().start().line;
        match token {
            TokenTree::Group(group) => scan_tokens(group.stream(), found),
            TokenTree::Ident(word) if FLOATS.iter().any(|float| word == float) => {
                found.floats.push((line(), word.to_string()));
            }
            // The tokenizer reads the fields in `pair.0.1` as one number with a fraction.
            TokenTree::Literal(literal) if !is_field(&tokens[..at]) => {
                let word = literal.to_string();
                if is_float(&word) {
                    found.floats.push((line(), word));
                }
            }
            _ => {}
        }
        at += 1;
    }
}

const FLOATS: [&str; 4] = ["f16", "f32", "f64", "f128"];

fn is_float(literal: &str) -> bool {
    let is_number = literal.starts_with(|c: char| c.is_ascii_digit());
    let prefixed = ["0x", "0b", "0o"].iter().any(|p| literal.starts_with(p));
    let named = FLOATS.iter().any(|float| literal.ends_with(float));
    let exponent = literal.contains(['e', 'E']) && !literal.ends_with("size");
    is_number && !prefixed && (literal.contains('.') || exponent || named)
}

/// Whether the token after `before` is a field name: a single dot precedes it, not the two dots of a range.
fn is_field(before: &[TokenTree]) -> bool {
    let is_dot = |token: Option<&TokenTree>| matches!(token, Some(TokenTree::Punct(sign)) if sign.as_char() == '.');
    is_dot(before.last()) && !is_dot(before.iter().nth_back(1))
}

/// Whether the tokens begin with `#[cfg(feature = "float")]` or `#[cfg(test)]`.
fn is_gate(tokens: &[TokenTree]) -> bool {
    let [TokenTree::Punct(hash), TokenTree::Group(attribute), ..] = tokens else {
        return false;
    };
    let gates = ["cfg(feature=\"float\")", "cfg(test)"];
    let words = attribute.stream().to_string().replace(' ', "");
    hash.as_char() == '#' && gates.contains(&words.as_str())
}

/// The name of a module declared by `mod NAME;`; `None` for any other item.
fn declared_module(item: &[TokenTree]) -> Option<String> {
    let at = item.iter().position(|token| is_word(token, "mod"))?;
    let plain = item[..at]
        .iter()
        .all(|token| is_word(token, "pub") || matches!(token, TokenTree::Group(_)));
    (plain && is_sign(item.get(at + 2)?, ';')).then(|| item[at + 1].to_string())
}

fn is_word(token: &TokenTree, word: &str) -> bool {
    matches!(token, TokenTree::Ident(ident) if ident == word)
}

fn is_sign(token: &TokenTree, sign: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == sign)
}

/// Number of tokens of the item that begins here, up to and including its block, semicolon or comma.
fn item_length(item: &[TokenTree]) -> usize {
    let mut angles = 0_usize;
    for (index, token) in item.iter().enumerate() {
        let follows_minus = index > 0 && is_sign(&item[index - 1], '-');
        match token {
            TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => return index + 1,
            // A comma between the parameters of `fn f<A, B>` does not end the item.
            _ if is_sign(token, '<') => angles += 1,
            _ if is_sign(token, '>') && !follows_minus => angles = angles.saturating_sub(1),
            _ if is_sign(token, ';') || is_sign(token, ',') && angles == 0 => return index + 1,
            _ => {}
        }
    }
    item.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        scan(text)
            .expect("it is Rust")
            .floats
            .into_iter()
            .map(|(_, word)| word)
            .collect()
    }

    #[test]
    fn floats_are_found_wherever_they_are_written() {
        assert_eq!(words("let x: f32 = y as f64;"), ["f32", "f64"]);
        assert_eq!(
            words("a = 1.5 + 2. + 3e4 + 1e-5 + 7f32;"),
            ["1.5", "2.", "3e4", "1e-5", "7f32"]
        );
        assert_eq!(words("0.5..1.5"), ["0.5", "1.5"]);
        assert_eq!(words("assert!(x < 1.5)"), ["1.5"]);
        assert_eq!(
            scan("\n\n/* a\n */ core::f64::consts::PI").unwrap().floats,
            [(4, "f64".to_owned())]
        );
    }

    #[test]
    fn what_only_looks_like_a_float_is_not_found() {
        for text in [
            "// 1.5 f32\n/* f64 /* nested 2.0 */ 3.0 */",
            "const X: Si = Si::lit(\"0.0005\");",
            "r#\"a \"1.5\" f32\"#; br\"2.5\"; '\\''; 'a'; \"\\\" 1.5\"",
            "self.0.1 + pair.0.0",
            "/// 1.5 f32\nfn x() {}",
            "for i in 0..5 { 1.max(2); 0x1e5; 0xE; 3usize; 10_isize; }",
            "fn of<'a>(x: &'a u32) -> I8F24 { to_f64_bits }",
        ] {
            assert_eq!(words(text), Vec::<String>::new(), "{text}");
        }
    }

    #[test]
    fn what_the_feature_turns_on_and_tests_are_left_out_and_no_more() {
        let text = "
            #[cfg(feature = \"float\")]
            mod float;
            #[cfg(feature = \"float\")]
            #[must_use]
            pub fn to_f64(self) -> f64 { 1.0 }
            #[cfg(feature = \"float\")]
            fn declared<A, B>(x: f64) -> f32;
            struct Pair {
                #[cfg(feature = \"float\")]
                first: f64,
                second: f32,
            }
            #[cfg(test)]
            mod tests { const X: f64 = 2.0; }
            fn left(x: f32) {}
        ";
        let found = scan(text).unwrap();
        let floats = [(12, "f32".to_owned()), (16, "f32".to_owned())];
        assert_eq!(found.floats, floats);
        assert_eq!(found.gated_modules, ["float"]);
        // Code behind any other feature is searched.
        assert_eq!(words("#[cfg(feature = \"other\")] fn x() -> f32;"), ["f32"]);
    }
}
