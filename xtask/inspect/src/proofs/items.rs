//! Splits Rust sources into items (functions, constants, types, methods, macros, properties). For each item it computes a hash of
//! its tokens and collects the names that it uses. Comments, layout and tests are left out, and code that is compiled only without
//! the model checker.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};

use super::syntax::{FoundItem, attributes, flat, header, property, word};

/// Words after `by` in a property (a statement to prove): name of the solver, or `sampled`. They are left out of the hash, since
/// they are no part of the statement.
const SOLVERS: [&str; 6] = ["cadical", "minisat", "kissat", "cvc5", "z3", "sampled"];

/// Adds a text and a zero byte to a 64-bit FNV-1a hash; returns the new hash.
pub fn add(hash: u64, text: &str) -> u64 {
    text.bytes().chain([0]).fold(hash, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
pub const EMPTY: u64 = 0xcbf2_9ce4_8422_2325;

/// Whether a macro of this name, such as `property!` or `divided_property!`, defines a property (a statement to prove). A call with
/// a path, such as `$crate::property!`, only passes a property on.
pub fn writes_a_property(name: &str) -> bool {
    !name.contains(':') && (name == "property" || name.ends_with("_property"))
}

/// A source file's place among the crates, and its imports. They decide which items the names in the file can mean.
#[derive(Default)]
pub struct File {
    /// Number of the file's crate in the order of dependencies; a crate may only use crates with lower or equal numbers.
    pub rank: usize,
    /// Path of the file's module: crate, folders and file, such as `touchstone_control`, `law`, `tdpa`.
    pub modules: Vec<String>,
    /// Names that `use` imports, each with its full path.
    pub imports: BTreeMap<String, Vec<String>>,
    /// Last module in the path of each `use …::*`.
    pub globs: BTreeSet<String>,
}

/// Type of an item, as far as it matters for how other items can refer to it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Property,
    /// A function, constant or static outside any type.
    Free,
    Type,
    Trait,
    Alias,
    /// A function or constant of a type or trait. An empty name stands for the rest of an `impl` block without its named members.
    Member {
        /// Name of the type. `None` for methods in a trait's own definition, for a type parameter, and for an argument of a macro.
        of: Option<String>,
        of_trait: Option<String>,
    },
    Macro,
    /// A macro call where an item may stand.
    Call,
}

/// The way in which code uses a name: plainly, as a method or macro call, or at the end of a path.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum How {
    Plain,
    /// Method call: `.name(`.
    Dot,
    /// Macro call: `name!`.
    Bang,
    /// `before::name`. The text is the word before the name. It is empty for a type with arguments in angle brackets, and `$` for a
    /// macro's argument.
    After(String),
}

pub struct Item {
    pub file: usize,
    pub kind: Kind,
    pub name: String,
    /// Names of the modules around the item within its file, outermost first.
    pub inline: Vec<String>,
    /// Name of the macro whose definition contains the item, if any.
    pub within: Option<String>,
    pub number: u64,
    pub names: BTreeSet<(How, String)>,
}

/// All items of the source files that were added.
#[derive(Default)]
pub struct Items {
    pub files: Vec<File>,
    pub all: Vec<Item>,
}

/// Surroundings of the tokens that are being split into items: modules, macro, `impl` or trait.
#[derive(Clone, Default)]
struct Place {
    inline: Vec<String>,
    within: Option<String>,
    /// Names of type and trait if the tokens are inside an `impl` or a trait.
    member: Option<(Option<String>, Option<String>)>,
}

impl Items {
    /// Adds a source file with all its items. `rank` is the number of its crate. Errors: the text is not valid Rust.
    pub fn add(&mut self, rank: usize, modules: Vec<String>, text: &str) -> Result<(), String> {
        let tokens: TokenStream = text
            .parse()
            .map_err(|why| format!("{}: {why}", modules.join("/")))?;
        self.files.push(File {
            rank,
            modules,
            ..File::default()
        });
        let rest = self.split(tokens, &Place::default());
        // The remaining tokens, such as calls of another crate's macros, count as used once any item of the file is used.
        if !rest.is_empty() {
            self.push(Kind::Call, String::new(), &rest, &Place::default());
        }
        Ok(())
    }

    fn push(&mut self, kind: Kind, name: String, tokens: &[TokenTree], place: &Place) {
        let own = match &place.member {
            Some((of, _)) => of.clone(),
            None => None,
        };
        let proofs = self
            .files
            .last()
            .is_some_and(|file| file.rank > 0 && file.modules[0] == "proofs");
        let mut found = Read {
            own,
            proofs,
            number: EMPTY,
            names: BTreeSet::new(),
        };
        found.read(tokens, &BTreeSet::new());
        self.all.push(Item {
            file: self.files.len() - 1,
            kind,
            name,
            inline: place.inline.clone(),
            within: place.within.clone(),
            number: found.number,
            names: found.names,
        });
    }

    /// Splits tokens into items and adds these; returns the tokens that belong to no item.
    fn split(&mut self, tokens: TokenStream, place: &Place) -> Vec<TokenTree> {
        let all: Vec<TokenTree> = tokens.into_iter().collect();
        let mut left = Vec::new();
        let mut at = 0;
        while at < all.len() {
            let (begin, skipped) = attributes(&all, at);
            if begin > at && (begin >= all.len() || word(&all, at + 1) == "!") {
                at = begin;
                continue;
            }
            let found = FoundItem::at(&all, begin);
            let end = found.as_ref().map_or(begin + 1, |found| found.end);
            let tokens = &all[at..end.min(all.len())];
            match found {
                _ if skipped => {}
                Some(found) if self.take(&found, tokens, &all[begin..found.end], place) => {}
                _ => self.leave(tokens, place, &mut left),
            }
            at = end;
        }
        left
    }

    /// Appends tokens that are no item to `left`. Splits the repetitions in a macro further, since they may contain items.
    fn leave(&mut self, tokens: &[TokenTree], place: &Place, left: &mut Vec<TokenTree>) {
        for token in tokens {
            match token {
                TokenTree::Group(group)
                    if place.within.is_some()
                        && left.last().is_some_and(|it| it.to_string() == "$") =>
                {
                    let rest = self.split(group.stream(), place);
                    left.extend(rest);
                }
                other => left.push(other.clone()),
            }
        }
    }

    /// Adds one item; returns whether it was added. `bare` is the item's tokens without attributes.
    fn take(
        &mut self,
        found: &FoundItem,
        tokens: &[TokenTree],
        bare: &[TokenTree],
        place: &Place,
    ) -> bool {
        let body = |tokens: &[TokenTree]| match tokens.last() {
            Some(TokenTree::Group(group)) => Some(group.stream()),
            _ => None,
        };
        let head = &tokens[..tokens.len() - 1];
        let name = found.name.clone();
        match found.keyword.as_str() {
            "use" => {
                let file = self.files.last_mut().expect("a file");
                let path = flat(&bare[..bare.len() - 1]);
                let from = path.iter().position(|it| it == "use").unwrap_or_default() + 1;
                import(&path[from..], &[], file);
                return true;
            }
            "extern" => return true,
            "mod" => {
                let mut place = place.clone();
                place.inline.push(name);
                if let Some(body) = body(tokens) {
                    let rest = self.split(body, &place);
                    if !rest.is_empty() {
                        self.push(Kind::Call, String::new(), &rest, &place);
                    }
                }
                return true;
            }
            "impl" | "trait" => {
                let Some(body) = body(tokens) else {
                    return false;
                };
                let (of, of_trait) = if found.keyword == "impl" {
                    header(&bare[..bare.len() - 1])
                } else if name.is_empty() {
                    return false;
                } else {
                    (None, Some(name.clone()))
                };
                let inner = Place {
                    member: Some((of.clone(), of_trait.clone())),
                    ..place.clone()
                };
                let mut rest = head.to_vec();
                rest.extend(self.split(body, &inner));
                let kind = match found.keyword.as_str() {
                    "impl" => Kind::Member { of, of_trait },
                    _ => Kind::Trait,
                };
                let place = if found.keyword == "impl" {
                    &inner
                } else {
                    place
                };
                self.push(kind, name, &rest, place);
                return true;
            }
            "macro_rules" => {
                let inner = Place {
                    within: Some(name.clone()),
                    ..Place::default()
                };
                let mut rest = Vec::new();
                let mut is_body = false;
                for token in body(tokens).into_iter().flatten() {
                    match &token {
                        TokenTree::Group(group) if is_body => {
                            rest.extend(self.split(group.stream(), &inner));
                        }
                        _ => rest.push(token.clone()),
                    }
                    is_body = token.to_string() == ">";
                }
                self.push(Kind::Macro, name, &rest, &Place::default());
                return true;
            }
            "!" => {
                if writes_a_property(&name)
                    && let Some(of) = property(bare)
                {
                    self.push(Kind::Property, of, tokens, place);
                    return true;
                }
                // Inside a macro, `impl` or trait, the call is a part of that item.
                if place.within.is_some() || place.member.is_some() {
                    return false;
                }
                self.push(Kind::Call, name, tokens, place);
                return true;
            }
            _ => {}
        }
        if name.is_empty() {
            return false;
        }
        let kind = match (found.keyword.as_str(), &place.member) {
            ("struct" | "enum", _) => Kind::Type,
            // An associated type is a part of its `impl`.
            ("type", Some(_)) => return false,
            ("type", None) => Kind::Alias,
            (_, Some((of, of_trait))) => Kind::Member {
                of: of.clone(),
                of_trait: of_trait.clone(),
            },
            // Compile-time checks do not change the compiled code.
            _ if name == "_" => return true,
            _ => Kind::Free,
        };
        self.push(kind, name, tokens, place);
        true
    }
}

/// Adds to `file` the names that the path of a `use` such as `a::{b, c as d, e::*}` imports.
fn import(words: &[String], before: &[String], file: &mut File) {
    let mut path = before.to_vec();
    let mut at = 0;
    while at < words.len() {
        match words[at].as_str() {
            ":" | "pub" => at += 1,
            "{" => {
                let (mut depth, mut begin, mut end) = (0, at + 1, at);
                loop {
                    match words[end].as_str() {
                        "{" => depth += 1,
                        "}" => depth -= 1,
                        _ => {}
                    }
                    if depth == 1 && words[end] == "," || depth == 0 {
                        import(&words[begin..end], &path, file);
                        begin = end + 1;
                    }
                    if depth == 0 {
                        return;
                    }
                    end += 1;
                }
            }
            "*" => {
                file.globs.extend(path.last().cloned());
                return;
            }
            "as" => {
                file.imports.insert(words[at + 1].clone(), path);
                return;
            }
            // `a::{self}`
            "self" if at + 1 == words.len() && !path.is_empty() => break,
            name => {
                path.push(name.into());
                at += 1;
            }
        }
    }
    if let Some(name) = path.last().cloned() {
        file.imports.insert(name, path);
    }
}

/// Hash and used names of an item while its tokens are being read.
struct Read {
    /// Name of the type that `Self` stands for, if known.
    own: Option<String>,
    proofs: bool,
    number: u64,
    names: BTreeSet<(How, String)>,
}

impl Read {
    /// Adds tokens to the hash, and the names in them to `names`. Names of local variables (`bound`) are left out where they stand
    /// for the variable.
    fn read(&mut self, all: &[TokenTree], bound: &BTreeSet<String>) {
        let mut bound = bound.clone();
        let mut binds = Vec::new();
        let mut at = 0;
        while let Some(token) = all.get(at) {
            if word(all, at) == "#" {
                let (after, skipped) = attributes(all, at);
                let inner = usize::from(word(all, at + 1) == "!");
                // Documentation and `non_exhaustive` do not change what code computes.
                let changes_nothing = matches!(all.get(at + 1 + inner), Some(TokenTree::Group(group))
                    if group.stream().to_string().starts_with("doc") || group.stream().to_string() == "non_exhaustive");
                if skipped && let Some(found) = FoundItem::at(all, after) {
                    at = found.end;
                    continue;
                }
                if changes_nothing {
                    at += 2 + inner;
                    continue;
                }
            }
            match token {
                TokenTree::Group(group) => {
                    self.number = add(self.number, &format!("{:?}", group.delimiter()));
                    let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                    self.read(&inner, &bound);
                    self.number = add(self.number, "end");
                }
                TokenTree::Ident(ident) => {
                    let text = ident.to_string();
                    if text == "let" {
                        let name = at + 1 + usize::from(word(all, at + 1) == "mut");
                        binds.push(word(all, name));
                    }
                    if !(self.proofs && SOLVERS.contains(&&*text)) {
                        self.number = add(self.number, &text);
                        let named = named(all, at, self.own.as_deref()).filter(|(how, name)| {
                            *how != How::Plain || word(all, at + 1) == "(" || !bound.contains(name)
                        });
                        self.names.extend(named);
                    }
                }
                other => {
                    // A `let` binds its name only after its own expression; inside the expression the name may still refer to an
                    // item.
                    if word(all, at) == ";" {
                        bound.extend(binds.drain(..));
                    }
                    self.number = add(self.number, &other.to_string());
                }
            }
            at += 1;
        }
    }
}

/// The name that the word at position `at` refers to, with the way in which it is used (plain name, path, method or macro call);
/// `None` if the word cannot refer to an item. `own` is the type of `Self`.
fn named(all: &[TokenTree], at: usize, own: Option<&str>) -> Option<(How, String)> {
    let back = |by: usize| {
        at.checked_sub(by)
            .map(|at| word(all, at))
            .unwrap_or_default()
    };
    let (next, after) = (word(all, at + 1), word(all, at + 2));
    let replaced = |text: String| match own {
        Some(own) if text == "Self" => own.to_owned(),
        _ => text,
    };
    let text = replaced(word(all, at));
    let paths_on = next == ":" && after == ":";
    match back(1).as_str() {
        "fn" | "'" => None,
        "." if back(2) != "." => (next == "(" || paths_on).then_some((How::Dot, text)),
        ":" if back(2) == ":" => {
            let before = match at.checked_sub(3).and_then(|at| all.get(at)) {
                Some(TokenTree::Ident(it))
                    if word(all, at.wrapping_sub(4)) != "$" || it == "crate" =>
                {
                    replaced(it.to_string())
                }
                // An argument of a macro.
                Some(TokenTree::Ident(_)) => "$".into(),
                _ => String::new(),
            };
            Some((
                if next == "!" {
                    How::Bang
                } else {
                    How::After(before)
                },
                text,
            ))
        }
        _ if next == "!" && matches!(all.get(at + 2), Some(TokenTree::Group(_))) => {
            Some((How::Bang, text))
        }
        // The name of a field, argument or variable before its type.
        _ if next == ":" && !paths_on => None,
        _ => Some((How::Plain, text)),
    }
}
