//! Looks for float types, literals and casts in Rust source, outside comments, texts, tests and what the feature `float`
//! turns on.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// What was found in a folder.
#[derive(Debug, Default)]
pub struct Scan {
    pub files: usize,
    /// `file:line: word`.
    pub findings: Vec<String>,
}

/// Reads every source file below a folder.
pub fn floats_below(folder: &Path) -> Result<Scan, String> {
    let mut files = Vec::new();
    collect(folder, &mut files)?;
    files.sort();
    let texts: Result<Vec<_>, String> = files.iter().map(|file| read(file)).collect();
    let texts = texts?;
    // A module that only exists with the feature is a file of its own.
    let mut left_out = BTreeSet::new();
    for (file, text) in files.iter().zip(&texts) {
        let parent = module_folder(file);
        for name in scan(text).gated_modules {
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
        for (line, word) in scan(text).floats {
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

/// Where the modules that a file declares lie.
fn module_folder(file: &Path) -> PathBuf {
    let parent = file.parent().unwrap_or(Path::new(""));
    let stem = file.file_stem().unwrap_or_default();
    if ["mod", "lib", "main"].iter().any(|root| stem == *root) {
        parent.to_path_buf()
    } else {
        parent.join(stem)
    }
}

/// What a text has.
#[derive(Debug, Default)]
struct Found {
    floats: Vec<(usize, String)>,
    gated_modules: Vec<String>,
}

fn scan(text: &str) -> Found {
    let tokens = tokens(text);
    let mut found = Found::default();
    let mut at = 0;
    while at < tokens.len() {
        if let Some(after) = gate(&tokens[at..]) {
            let item = &tokens[at + after..];
            if let Some(name) = declared_module(item) {
                found.gated_modules.push(name.to_owned());
            }
            at += after + item_length(item);
            continue;
        }
        let token = &tokens[at];
        if is_float(&token.text) {
            found.floats.push((token.line, token.text.clone()));
        }
        at += 1;
    }
    found
}

fn is_float(word: &str) -> bool {
    if ["f16", "f32", "f64", "f128"].contains(&word) {
        return true;
    }
    let number = word.starts_with(|c: char| c.is_ascii_digit());
    let prefixed = ["0x", "0b", "0o"].iter().any(|p| word.starts_with(p));
    number
        && !prefixed
        && (word.contains('.')
            || word.contains(['e', 'E']) && !word.contains("usize") && !word.contains("isize")
            || ["f16", "f32", "f64", "f128"]
                .iter()
                .any(|end| word.ends_with(end)))
}

/// The length of `#[cfg(feature = "float")]` or `#[cfg(test)]` at the start, if it is there.
fn gate(tokens: &[Token]) -> Option<usize> {
    let is = |words: &[&str]| {
        tokens.len() >= words.len()
            && words
                .iter()
                .zip(tokens)
                .all(|(word, token)| token.text == *word)
    };
    let gates: [&[&str]; 2] = [
        &["#", "[", "cfg", "(", "feature", "=", "\"float\"", ")", "]"],
        &["#", "[", "cfg", "(", "test", ")", "]"],
    ];
    gates.into_iter().find(|words| is(words)).map(<[_]>::len)
}

/// `NAME` of an item `mod NAME;`.
fn declared_module(item: &[Token]) -> Option<&str> {
    let at = item.iter().position(|token| token.text == "mod")?;
    let plain = item[..at]
        .iter()
        .all(|token| ["pub", "(", "crate", "super", ")"].contains(&token.text.as_str()));
    (plain && item.get(at + 2)?.text == ";").then(|| item[at + 1].text.as_str())
}

/// Tokens up to the end of the item at the start: its block, or its semicolon.
fn item_length(item: &[Token]) -> usize {
    let (mut depth, mut angles) = (0_usize, 0_usize);
    for (index, token) in item.iter().enumerate() {
        match token.text.as_str() {
            // Between the parameters of `fn f<A, B>` a comma ends nothing.
            "<" if depth == 0 => angles += 1,
            ">" if depth == 0 && item[index - 1].text != "-" => angles = angles.saturating_sub(1),
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => {
                depth = depth.saturating_sub(1);
                // A block ends an item; so does the end of what the item lies in.
                if token.text == "}" && depth == 0 {
                    return index + 1;
                }
            }
            ";" if depth == 0 => return index + 1,
            "," if depth == 0 && angles == 0 => return index + 1,
            _ => {}
        }
    }
    item.len()
}

#[derive(Debug)]
struct Token {
    line: usize,
    text: String,
}

/// Words, numbers, texts (with their quotes) and single signs; comments are left out.
fn tokens(text: &str) -> Vec<Token> {
    let chars: Vec<char> = text.chars().collect();
    let (mut at, mut line) = (0, 1);
    let mut tokens: Vec<Token> = Vec::new();
    while at < chars.len() {
        let start = at;
        let after_dot = tokens.last().is_some_and(|token| token.text == ".");
        at = match chars[at] {
            '/' if chars.get(at + 1) == Some(&'/') => until_newline(&chars, at),
            '/' if chars.get(at + 1) == Some(&'*') => past_block_comment(&chars, at),
            '"' => past_text(&chars, at),
            'r' | 'b' if raw_text(&chars, at).is_some() => raw_text(&chars, at).unwrap_or(at + 1),
            '\'' => past_quote(&chars, at),
            c if c.is_ascii_digit() => past_number(&chars, at, after_dot),
            c if c.is_alphanumeric() || c == '_' => past_word(&chars, at),
            _ => at + 1,
        };
        let is_comment = chars[start] == '/' && at > start + 1;
        if !is_comment && !chars[start].is_whitespace() {
            let text = chars[start..at].iter().collect();
            tokens.push(Token { line, text });
        }
        line += chars[start..at].iter().filter(|c| **c == '\n').count();
    }
    tokens
}

fn until_newline(chars: &[char], at: usize) -> usize {
    let rest = chars[at..].iter().position(|c| *c == '\n');
    rest.map_or(chars.len(), |length| at + length)
}

fn past_block_comment(chars: &[char], mut at: usize) -> usize {
    let mut depth = 0_usize;
    while at + 1 < chars.len() {
        match (chars[at], chars[at + 1]) {
            ('/', '*') => (depth, at) = (depth + 1, at + 2),
            ('*', '/') => {
                (depth, at) = (depth - 1, at + 2);
                if depth == 0 {
                    return at;
                }
            }
            _ => at += 1,
        }
    }
    chars.len()
}

fn past_text(chars: &[char], start: usize) -> usize {
    let mut at = start + 1;
    while at < chars.len() && chars[at] != '"' {
        at += if chars[at] == '\\' { 2 } else { 1 };
    }
    (at + 1).min(chars.len())
}

/// The end of `r"…"`, `r#"…"#`, `br"…"` at `start`, if one starts there.
fn raw_text(chars: &[char], start: usize) -> Option<usize> {
    let mut at = start + usize::from(chars[start] == 'b');
    (chars.get(at) == Some(&'r')).then_some(())?;
    at += 1;
    let hashes = chars[at..].iter().take_while(|c| **c == '#').count();
    at += hashes;
    (chars.get(at) == Some(&'"')).then_some(())?;
    at += 1;
    while at < chars.len() {
        let closing =
            chars[at] == '"' && chars[at + 1..].iter().take_while(|c| **c == '#').count() >= hashes;
        if closing {
            return Some(at + 1 + hashes);
        }
        at += 1;
    }
    Some(chars.len())
}

/// A character such as `'x'` or `'\n'`, or the sign before a lifetime.
fn past_quote(chars: &[char], at: usize) -> usize {
    if chars.get(at + 1) == Some(&'\\') {
        let end = chars[at + 3..].iter().position(|c| *c == '\'');
        return end.map_or(chars.len(), |length| at + 4 + length);
    }
    if chars.get(at + 2) == Some(&'\'') {
        at + 3
    } else {
        at + 1
    }
}

fn past_word(chars: &[char], at: usize) -> usize {
    let rest = &chars[at..];
    at + rest
        .iter()
        .take_while(|c| c.is_alphanumeric() || **c == '_')
        .count()
}

/// A number with its suffix; behind a dot (a tuple's field) it has no fraction of its own.
fn past_number(chars: &[char], at: usize, after_dot: bool) -> usize {
    let mut end = past_word(chars, at);
    let dot = chars.get(end) == Some(&'.');
    // `0..5` is a range and `1.max(2)` a call.
    let next = chars.get(end + 1).copied().unwrap_or(' ');
    if !after_dot && dot && next != '.' && !next.is_alphabetic() && next != '_' {
        end = past_word(chars, end + 1);
    }
    // 1e-5
    let exponent = chars[end - 1] == 'e' || chars[end - 1] == 'E';
    let hex = chars[at..end].starts_with(&['0', 'x']);
    if exponent && !hex && matches!(chars.get(end), Some('-' | '+')) {
        end = past_word(chars, end + 1);
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        scan(text)
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
        assert_eq!(
            scan("\n\n/* a\n */ core::f64::consts::PI").floats,
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
        let found = scan(text);
        let floats = [(12, "f32".to_owned()), (16, "f32".to_owned())];
        assert_eq!(found.floats, floats);
        assert_eq!(found.gated_modules, ["float"]);
        // Another feature is no excuse.
        assert_eq!(words("#[cfg(feature = \"other\")] fn x() -> f32;"), ["f32"]);
    }
}
