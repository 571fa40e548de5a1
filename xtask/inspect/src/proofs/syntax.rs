//! Reads Rust tokens one by one: the item that begins at a token, its attributes, and the header of an `impl`.

use proc_macro2::{Delimiter, TokenTree};
use std::collections::BTreeSet;

/// An item that begins at a position in the tokens: its keyword, its name (empty if it has none), and the position after the item.
pub(super) struct FoundItem {
    pub keyword: String,
    pub name: String,
    pub end: usize,
}

impl FoundItem {
    pub fn at(all: &[TokenTree], begin: usize) -> Option<Self> {
        let mut at = begin;
        while matches!(&*word(all, at), "pub" | "default" | "unsafe" | "async")
            || word(all, at) == "const"
                && matches!(&*word(all, at + 1), "fn" | "unsafe" | "async" | "extern")
            || word(all, at) == "extern"
                && word(all, at + 1).starts_with('"')
                && word(all, at + 2) == "fn"
        {
            at += match &*word(all, at) {
                "pub" if word(all, at + 1).starts_with('(') => 2,
                "extern" => 2,
                _ => 1,
            };
        }
        let keyword = word(all, at);
        let named = |at: usize| match all.get(at) {
            Some(TokenTree::Ident(name)) => name.to_string(),
            _ => String::new(),
        };
        let until = |braced: bool| {
            let mut place = at;
            loop {
                match all.get(place)? {
                    TokenTree::Group(group) if braced && group.delimiter() == Delimiter::Brace => {
                        break;
                    }
                    token if token.to_string() == ";" => break,
                    _ => place += 1,
                }
            }
            Some(place + 1)
        };
        let (name, end) = match keyword.as_str() {
            "fn" | "struct" | "enum" | "trait" | "mod" => (named(at + 1), until(true)?),
            "impl" => (String::new(), until(true)?),
            "const" | "static" | "type" => (named(at + 1), until(false)?),
            "use" | "extern" => (String::new(), until(false)?),
            "macro_rules" => (named(at + 2), at + 4),
            _ => {
                // A macro call with a path: skips the path before the macro's name.
                while word(all, at + 1) == ":"
                    || word(all, at) == ":"
                    || word(all, at) == "$" && word(all, at + 1) == "crate"
                {
                    at += 1;
                }
                let is_call = matches!(all.get(at), Some(TokenTree::Ident(_)))
                    && word(all, at + 1) == "!"
                    && matches!(all.get(at + 2), Some(TokenTree::Group(_)));
                let end = at + 3 + usize::from(word(all, at + 3) == ";");
                return is_call.then(|| Self {
                    keyword: "!".into(),
                    name: if at == begin {
                        named(at)
                    } else {
                        format!(":{}", named(at))
                    },
                    end,
                });
            }
        };
        let end = end + usize::from(keyword == "macro_rules" && word(all, end) == ";");
        Some(Self { keyword, name, end })
    }
}

pub(super) fn word(all: &[TokenTree], at: usize) -> String {
    match all.get(at) {
        Some(TokenTree::Group(group)) => match group.delimiter() {
            Delimiter::Parenthesis => "(".into(),
            Delimiter::Brace => "{".into(),
            Delimiter::Bracket => "[".into(),
            Delimiter::None => String::new(),
        },
        Some(token) => token.to_string(),
        None => String::new(),
    }
}

/// The position after the attributes that begin at `at`, and whether one of them marks a test or code that is compiled only without
/// the model checker.
pub(super) fn attributes(all: &[TokenTree], mut at: usize) -> (usize, bool) {
    let mut skipped = false;
    while word(all, at) == "#" {
        let inner = usize::from(word(all, at + 1) == "!");
        let Some(TokenTree::Group(group)) = all.get(at + 1 + inner) else {
            break;
        };
        let text: String = group.stream().to_string().split_whitespace().collect();
        skipped |= ["test", "cfg(test)", "cfg(not(kani))"].contains(&&*text)
            || text.starts_with("cfg(all(test,");
        at += 2 + inner;
        if inner == 1 {
            // An inner attribute belongs to the file, not to the next item.
            return (at, false);
        }
    }
    (at, skipped)
}

/// The name after `fn` in the braces of a property; `None` if a macro only passes the property on.
pub(super) fn property(bare: &[TokenTree]) -> Option<String> {
    let Some(TokenTree::Group(group)) = bare
        .iter()
        .rev()
        .find(|it| matches!(it, TokenTree::Group(_)))
    else {
        return None;
    };
    let all: Vec<TokenTree> = group.stream().into_iter().collect();
    let at = all.iter().position(|token| token.to_string() == "fn")?;
    match all.get(at + 1)? {
        TokenTree::Ident(name) if group.delimiter() == Delimiter::Brace => Some(name.to_string()),
        _ => None,
    }
}

/// Names of type and trait, in this order, from the tokens of a header such as `impl<…> Trait for Type<…>`.
pub(super) fn header(bare: &[TokenTree]) -> (Option<String>, Option<String>) {
    let mut depth = 0_i32;
    let mut parts = [None, None];
    let (mut part, mut generics) = (0, BTreeSet::new());
    let mut first = true;
    for (at, token) in bare.iter().enumerate().skip(1) {
        let text = token.to_string();
        match text.as_str() {
            "<" => depth += 1,
            ">" if at > 0 && bare[at - 1].to_string() == "-" => {}
            ">" => {
                depth -= 1;
                first &= depth > 0;
            }
            "for" if depth == 0 => part = 1,
            "where" if depth == 0 => break,
            _ if depth > 0 && first => drop(generics.insert(text)),
            _ if depth == 0 => {
                first = false;
                match token {
                    TokenTree::Ident(_) if bare[at - 1].to_string() != "$" && text != "dyn" => {
                        parts[part] = Some(text)
                    }
                    TokenTree::Ident(_) | TokenTree::Group(_) => parts[part] = None,
                    _ => {}
                }
            }
            _ => {}
        }
    }
    let of = parts[part].take().filter(|name| !generics.contains(name));
    (of, if part == 1 { parts[0].take() } else { None })
}

pub(super) fn flat(tokens: &[TokenTree]) -> Vec<String> {
    let mut words = Vec::new();
    for token in tokens {
        match token {
            TokenTree::Group(group) => {
                words.push("{".into());
                words.extend(flat(&group.stream().into_iter().collect::<Vec<_>>()));
                words.push("}".into());
            }
            other => words.push(other.to_string()),
        }
    }
    words
}
