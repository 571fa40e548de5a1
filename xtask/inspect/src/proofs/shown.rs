//! Which assertions of the properties a cover shows to be reached: one that comes after it in the same block, and so is reached only by way
//! of it. An assertion without one is one itself: `assert_reached!` (`proofs/src/lib.rs`). Each cover costs a trace of all that happened.

use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use quote::ToTokens;
use syn::{Block, Expr, Macro, Stmt};

const ASSERTION: &str = "assert";
/// What is to be reached by itself.
const COVERS: [&str; 2] = ["cover", "assert_reached"];

/// The lines of a source in which an `assert!` of a condition alone stands that no cover shows.
pub fn unshown(text: &str) -> Result<Vec<usize>, String> {
    let tokens: TokenStream = text.parse().map_err(|why| format!("{why}"))?;
    let mut lines = Vec::new();
    look(&tokens, &[], &mut lines);
    Ok(lines)
}

/// Of the assertions among these tokens themselves those that are not `shown`, and of each group in them.
fn look(tokens: &TokenStream, shown: &[usize], lines: &mut Vec<usize>) {
    let all: Vec<TokenTree> = tokens.clone().into_iter().collect();
    for (place, tree) in all.iter().enumerate() {
        if let Some(name) = invoked(&all, place, ASSERTION) {
            let line = name.span().start().line;
            if !shown.contains(&line) && !has_words(&all[place + 2]) && !is_of_core(&all, place) {
                lines.push(line);
            }
        }
        if let TokenTree::Group(group) = tree {
            look(&group.stream(), &of_block(group), lines);
        }
    }
}

/// A macro's name where it is called.
fn invoked<'t>(all: &'t [TokenTree], place: usize, name: &str) -> Option<&'t TokenTree> {
    let is = matches!(&all[place], TokenTree::Ident(ident) if ident == name);
    let called =
        matches!(all.get(place + 1), Some(TokenTree::Punct(mark)) if mark.as_char() == '!');
    let with = matches!(all.get(place + 2), Some(TokenTree::Group(_)));
    (is && called && with).then(|| &all[place])
}

/// `core::assert!`, of which the macros are made.
fn is_of_core(all: &[TokenTree], place: usize) -> bool {
    place > 0 && matches!(&all[place - 1], TokenTree::Punct(mark) if mark.as_char() == ':')
}

/// Whether an assertion has words of its own: what stands in the place of the code has, and not every harness asks it.
fn has_words(arguments: &TokenTree) -> bool {
    let TokenTree::Group(group) = arguments else {
        return false;
    };
    let all: Vec<TokenTree> = group.stream().into_iter().collect();
    let comma = |tree: &TokenTree| matches!(tree, TokenTree::Punct(mark) if mark.as_char() == ',');
    all.iter()
        .position(comma)
        .is_some_and(|at| at + 1 < all.len())
}

/// The lines of those assertions of a block after which there is a cover in it.
fn of_block(group: &Group) -> Vec<usize> {
    if group.delimiter() != Delimiter::Brace {
        return Vec::new();
    }
    let braced = TokenTree::Group(Group::new(Delimiter::Brace, plain(group.stream())));
    let Ok(block) = syn::parse2::<Block>(braced.into()) else {
        return Vec::new();
    };
    let mut shown = Vec::new();
    for (place, statement) in block.stmts.iter().enumerate() {
        let later = &block.stmts[place + 1..];
        if let Some(found) = stated(statement)
            && found.path.is_ident(ASSERTION)
            && later.iter().any(covers)
        {
            let name = found.path.segments[0].ident.span();
            shown.push(name.start().line);
        }
    }
    shown
}

/// The tokens without the `$` of a macro's definition.
fn plain(tokens: TokenStream) -> TokenStream {
    let kept = tokens.into_iter().filter_map(|tree| match tree {
        TokenTree::Punct(mark) if mark.as_char() == '$' => None,
        TokenTree::Group(group) => {
            let mut inner = Group::new(group.delimiter(), plain(group.stream()));
            inner.set_span(group.span());
            Some(TokenTree::Group(inner))
        }
        other => Some(other),
    });
    kept.collect()
}

fn stated(statement: &Stmt) -> Option<&Macro> {
    match statement {
        Stmt::Macro(found) => Some(&found.mac),
        Stmt::Expr(Expr::Macro(found), _) => Some(&found.mac),
        _ => None,
    }
}

/// Whether there is a cover in a statement, however deep. What an item declares is not done where it stands, and what has an attribute may
/// not be there.
fn covers(statement: &Stmt) -> bool {
    if matches!(statement, Stmt::Item(_)) {
        return false;
    }
    let tokens = statement.to_token_stream();
    let attribute =
        |tree: TokenTree| matches!(tree, TokenTree::Punct(mark) if mark.as_char() == '#');
    !tokens.clone().into_iter().next().is_some_and(attribute) && within(&tokens)
}

fn within(tokens: &TokenStream) -> bool {
    let all: Vec<TokenTree> = tokens.clone().into_iter().collect();
    (0..all.len()).any(|place| {
        COVERS
            .iter()
            .any(|name| invoked(&all, place, name).is_some())
            || matches!(&all[place], TokenTree::Group(group) if within(&group.stream()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines, of a property's body.
    fn lines(body: &str) -> Vec<usize> {
        let text = format!("property! {{ by cadical fn p1(s) {{\n{body}\n}} }}");
        unshown(&text).expect("Rust")
    }

    #[test]
    fn a_cover_after_it_in_its_block_shows_an_assertion() {
        assert!(lines("assert!(a);\ncover!(s, b, \"b\");").is_empty());
        assert!(lines("assert!(a);\nif b {\ncover!(s, b, \"b\");\n}").is_empty());
        assert!(lines("if a {\nassert!(b);\ncover!(s, true, \"a\");\n}").is_empty());
        assert!(
            lines("for a in $all {\nassert!($b);\n$crate::cover!(s, $b, \"b\");\n}").is_empty()
        );
    }

    #[test]
    fn a_cover_before_it_does_not() {
        assert_eq!(lines("cover!(s, b, \"b\");\nassert!(a);"), [3]);
    }

    #[test]
    fn a_cover_that_is_reached_without_it_does_not() {
        assert_eq!(lines("if a {\nassert!(a);\n}\ncover!(s, b, \"b\");"), [3]);
        assert_eq!(
            lines("match a {\nA => assert!(a),\nB => cover!(s, b, \"b\"),\n}"),
            [3]
        );
        assert_eq!(lines("a.all(|b| assert!(b));\ncover!(s, b, \"b\");"), [2]);
        assert_eq!(
            lines("assert!(a);\nfn later() { cover!(s, b, \"b\"); }"),
            [2]
        );
        let by_samples = "assert!(a);\n#[cfg(not(kani))]\ncover!(s, b, \"b\");";
        assert_eq!(lines(by_samples), [2]);
        assert_eq!(
            lines("let a = c && { assert!(a); true };\ncover!(s, b, \"b\");"),
            [2]
        );
    }

    #[test]
    fn one_with_words_or_with_its_own_cover_is_not_asked() {
        assert!(lines("assert!(a, \"words\");").is_empty());
        assert!(lines("assert!(a);\nassert_reached!(b);").is_empty());
        assert!(lines("core::assert!(a);").is_empty());
        assert_eq!(lines("assert!(a,);"), [2]);
    }
}
