//! Finds the assertions in proved properties for which nothing shows that the model checker reaches them.
//!
//! A cover is a statement that the checker must be able to reach. A cover after an assertion, as a statement of the same block, can
//! only be reached through the assertion. An assertion without such a cover must be written as `assert_reached!`
//! (`proofs/src/lib.rs`), which contains its own cover. This form is used only where needed, because the checker computes a trace
//! for each cover.

use proc_macro2::{Delimiter, Group, LineColumn, TokenStream, TokenTree};
use syn::parse::Parser;
use syn::punctuated::Punctuated;
use syn::{Block, Expr, ExprLit, Lit, Stmt, StmtMacro, Token};

/// Macros that the checker reports as an assertion of the property, each with the number of arguments before its message.
const ASSERTIONS: [(&str, usize); 6] = [
    ("assert", 1),
    ("assert_eq", 2),
    ("assert_ne", 2),
    ("debug_assert", 1),
    ("debug_assert_eq", 2),
    ("debug_assert_ne", 2),
];
/// Macros that are or contain a cover, which the checker must be able to reach.
const COVERS: [&str; 2] = ["cover", "assert_reached"];

/// Line numbers of the assertions in a source text that nothing shows to be reachable: they have no message, and no cover
/// (statement that must be reached) follows them.
pub fn unshown(text: &str) -> Result<Vec<usize>, String> {
    let tokens: TokenStream = text.parse().map_err(|why| format!("{why}"))?;
    let mut lines = Vec::new();
    look(&tokens, &[], &mut lines);
    Ok(lines)
}

/// Adds to `lines` the assertions among the tokens that are not in `shown`, and searches nested blocks in the same way.
fn look(tokens: &TokenStream, shown: &[LineColumn], lines: &mut Vec<usize>) {
    let all: Vec<TokenTree> = tokens.clone().into_iter().collect();
    for (place, tree) in all.iter().enumerate() {
        if is_asserted(&all, place) {
            let at = tree.span().start();
            if !shown.contains(&at) {
                lines.push(at.line);
            }
        }
        if let TokenTree::Group(group) = tree
            && !is_out_of_it(&all, place)
        {
            look(&group.stream(), &of_block(group), lines);
        }
    }
}

/// Whether an assertion without a message is at this position. An assertion with a message belongs to a replacement of shipped
/// code, which not every harness (proof) uses, so it needs no cover.
fn is_asserted(all: &[TokenTree], place: usize) -> bool {
    let [
        TokenTree::Ident(name),
        TokenTree::Punct(mark),
        TokenTree::Group(arguments),
    ] = &all[place..(place + 3).min(all.len())]
    else {
        return false;
    };
    let known = ASSERTIONS.iter().find(|(known, _)| name == known);
    known.is_some_and(|(_, before)| {
        mark.as_char() == '!' && !has_words(&arguments.stream(), *before)
    })
}

/// Whether the argument after the first `before` ones is a string, which is the assertion's message.
fn has_words(arguments: &TokenStream, before: usize) -> bool {
    let parser = Punctuated::<Expr, Token![,]>::parse_terminated;
    let Ok(all) = parser.parse2(plain(arguments.clone())) else {
        return false;
    };
    let words = |it: &Expr| {
        matches!(
            it,
            Expr::Lit(ExprLit {
                lit: Lit::Str(_),
                ..
            })
        )
    };
    all.iter().nth(before).is_some_and(words)
}

/// Whether the search leaves out the block at this position. It leaves out modules of tests, and the definition of
/// `assert_reached!`, whose assertion needs no other cover (statement that must be reached).
fn is_out_of_it(all: &[TokenTree], place: usize) -> bool {
    let before = |back: usize| {
        let tree = place.checked_sub(back).map(|at| &all[at]);
        tree.map(ToString::to_string).unwrap_or_default()
    };
    let reached = before(1) == "assert_reached" && before(2) == "!" && before(3) == "macro_rules";
    let tests = before(2) == "mod" && before(3).contains("cfg") && before(3).contains("test");
    reached || tests
}

/// Positions of the assertions in a block that are followed by a cover (a statement that must be reachable) in the same block.
fn of_block(group: &Group) -> Vec<LineColumn> {
    if group.delimiter() != Delimiter::Brace {
        return Vec::new();
    }
    let braced = TokenTree::Group(Group::new(Delimiter::Brace, plain(group.stream())));
    let Ok(block) = syn::parse2::<Block>(braced.into()) else {
        return Vec::new();
    };
    let is = |statement: &StmtMacro, names: &[&str]| {
        let last = statement.mac.path.segments.last();
        // A statement with an attribute does not count, since it may not be compiled.
        statement.attrs.is_empty()
            && last.is_some_and(|it| names.iter().any(|name| it.ident == name))
    };
    let assertions = ASSERTIONS.map(|(name, _)| name);
    let mut shown = Vec::new();
    let mut covered = false;
    for statement in block.stmts.iter().rev() {
        let Stmt::Macro(statement) = statement else {
            continue;
        };
        if is(statement, &COVERS) {
            covered = true;
        } else if covered && is(statement, &assertions) {
            let last = statement.mac.path.segments.last();
            shown.extend(last.map(|it| it.ident.span().start()));
        }
    }
    shown
}

/// The tokens without the `$` signs of a macro's definition.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// For tests: line numbers that [`unshown`] returns for a property with this body.
    fn lines(body: &str) -> Vec<usize> {
        let text = format!("property! {{ by cadical fn p1(s) {{\n{body}\n}} }}");
        unshown(&text).expect("Rust")
    }

    #[test]
    fn a_cover_after_it_in_its_block_shows_an_assertion() {
        assert!(lines("assert!(a);\ncover!(s, b, \"b\");").is_empty());
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
    fn a_cover_that_may_not_be_made_does_not() {
        for maybe in [
            "if b {\ncover!(s, b, \"b\");\n}",
            "let later = || { cover!(s, b, \"b\"); };",
            "if b { #[cfg(not(kani))] cover!(s, b, \"b\"); }",
            "$(cover!(s, b, \"b\");)?",
        ] {
            assert_eq!(lines(&format!("assert!(a);\n{maybe}")), [2], "{maybe}");
        }
    }

    #[test]
    fn another_assertion_is_one_too() {
        for other in [
            "assert_eq!(a, b)",
            "debug_assert!(a)",
            "core::assert!(a)",
            "assert!(of::<A, B>(c))",
        ] {
            let hidden = format!("if a {{\n{other};\n}}\ncover!(s, b, \"b\");");
            assert_eq!(lines(&hidden), [3], "{other}");
            assert!(lines(&format!("{other};\ncover!(s, b, \"b\");")).is_empty());
        }
        assert_eq!(
            lines("assert!(a); if b { assert!(c); } cover!(s, b, \"b\");"),
            [2]
        );
    }

    #[test]
    fn one_with_words_or_with_its_own_cover_is_not_asked() {
        assert!(lines("assert!(a, \"words\");").is_empty());
        assert!(lines("assert!(a);\nassert_reached!(b);").is_empty());
        assert!(lines("assert_eq!(a, b, \"words {}\", c);").is_empty());
        let made = "macro_rules! assert_reached { ($a:expr) => {{ kani::cover!(true, \"\"); assert!($a) }}; }";
        assert!(lines(made).is_empty());
        assert_eq!(lines("assert!(a,);"), [2]);
    }
}
