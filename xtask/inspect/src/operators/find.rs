//! Every place of a source where an operator of ours makes a small wrong change.
//!
//! Code within `macro_rules!` is read as well: `$` is taken for a letter, and repetitions are left out.

use std::ops::Range;

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};
use syn::spanned::Spanned as _;
use syn::visit::{self, Visit};
use syn::{BinOp, Block, Expr, Stmt, UnOp};

/// A small wrong change of one function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Wrong {
    /// `Tdpa::exact_force`.
    pub function: String,
    /// What is done: a word.
    pub operator: &'static str,
    /// The bytes of the source that it is about.
    pub at: Range<usize>,
    /// What stands there instead.
    pub instead: String,
    /// Whether it is a whole statement or the beginning of a body, and not an expression.
    pub is_statement: bool,
    /// Whether the function is `const`, where nothing can be asked at run time.
    pub is_const: bool,
}

/// All of them, in the order of the source; `Err` where it is not Rust.
pub fn find(source: &str) -> Result<Vec<Wrong>, String> {
    let mut found = Vec::new();
    look(source, source, 0, &mut found)?;
    let tokens: TokenStream = source.parse().map_err(|why| format!("not Rust: {why}"))?;
    for (body, stripped) in macro_bodies(tokens, source) {
        // A macro of something else than whole functions is left out.
        let _ = look(source, &stripped, body.start, &mut found);
    }
    found.sort_by_key(|wrong| (wrong.at.start, wrong.at.end));
    Ok(found)
}

fn look(source: &str, text: &str, offset: usize, found: &mut Vec<Wrong>) -> Result<(), String> {
    let file: syn::File = syn::parse_str(text).map_err(|why| {
        let at = why.span().start();
        format!("from byte {offset}, line {}: {why}", at.line)
    })?;
    let mut seen = Seen {
        source,
        offset,
        within: String::new(),
        function: String::new(),
        is_const: false,
        found,
    };
    seen.visit_file(&file);
    Ok(())
}

/// What the macros of a file expand to: the bytes of each body in the source, and as long a text that is Rust.
fn macro_bodies(tokens: TokenStream, source: &str) -> Vec<(Range<usize>, String)> {
    let mut bodies = Vec::new();
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    for (index, token) in tokens.iter().enumerate() {
        let TokenTree::Group(group) = token else {
            continue;
        };
        let before = |back: usize| index.checked_sub(back).map(|at| tokens[at].to_string());
        if before(3).as_deref() == Some("macro_rules") && before(2).as_deref() == Some("!") {
            let rules: Vec<TokenTree> = group.stream().into_iter().collect();
            for (at, rule) in rules.iter().enumerate() {
                let arrow = at.checked_sub(1).map(|at| rules[at].to_string());
                match rule {
                    TokenTree::Group(body) if arrow.as_deref() == Some(">") => {
                        let outer = body.span().byte_range();
                        let inner = outer.start + 1..outer.end - 1;
                        let mut text = source[inner.clone()].as_bytes().to_vec();
                        strip(body.stream(), inner.start, &mut text);
                        if let Ok(text) = String::from_utf8(text) {
                            bodies.push((inner, text));
                        }
                    }
                    _ => {}
                }
            }
        } else {
            bodies.extend(macro_bodies(group.stream(), source));
        }
    }
    bodies
}

/// `$name` becomes `_name`, and `$( ... )*` as many spaces.
fn strip(tokens: TokenStream, start: usize, text: &mut [u8]) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    for (index, token) in tokens.iter().enumerate() {
        match token {
            TokenTree::Punct(punct) if punct.as_char() == '$' => {
                let at = punct.span().byte_range().start - start;
                text[at] = b'_';
                if let Some(TokenTree::Group(group)) = tokens.get(index + 1)
                    && group.delimiter() == Delimiter::Parenthesis
                {
                    let mut end = group.span().byte_range().end - start;
                    // The repetition's own sign.
                    if matches!(tokens.get(index + 2), Some(TokenTree::Punct(sign))
                        if "*+?".contains(sign.as_char()) && sign.spacing() != Spacing::Joint)
                    {
                        end += 1;
                    }
                    text[at..end].fill(b' ');
                }
            }
            // What was taken out stays out.
            TokenTree::Group(group) if text[group.span().byte_range().start - start] != b' ' => {
                strip(group.stream(), start, text);
            }
            _ => {}
        }
    }
}

struct Seen<'a> {
    source: &'a str,
    /// Where the text that is read begins in the source.
    offset: usize,
    /// The type or trait.
    within: String,
    function: String,
    is_const: bool,
    found: &'a mut Vec<Wrong>,
}

impl Seen<'_> {
    fn range(&self, span: proc_macro2::Span) -> Range<usize> {
        let at = span.byte_range();
        at.start + self.offset..at.end + self.offset
    }

    fn text(&self, span: proc_macro2::Span) -> &str {
        &self.source[self.range(span)]
    }

    fn add(
        &mut self,
        operator: &'static str,
        at: Range<usize>,
        instead: String,
        is_statement: bool,
    ) {
        if self.function.is_empty() {
            return;
        }
        let (function, is_const) = (self.function.clone(), self.is_const);
        self.found.push(Wrong {
            function,
            operator,
            at,
            instead,
            is_statement,
            is_const,
        });
    }

    /// The bytes with a part of them replaced.
    fn with(&self, whole: proc_macro2::Span, part: proc_macro2::Span, instead: &str) -> String {
        let (whole, part) = (self.range(whole), self.range(part));
        format!(
            "{}{instead}{}",
            &self.source[whole.start..part.start],
            &self.source[part.end..whole.end]
        )
    }

    fn function(&mut self, name: &str, signature: &syn::Signature, block: &Block) {
        let before = (self.function.clone(), self.is_const);
        self.function = if self.within.is_empty() {
            name.to_owned()
        } else {
            format!("{}::{name}", self.within)
        };
        self.is_const = signature.constness.is_some();
        let open = self.range(block.brace_token.span.open()).end;
        for answer in self.answers(signature) {
            self.add("returns", open..open, answer, true);
        }
        visit::visit_block(self, block);
        (self.function, self.is_const) = before;
    }

    /// What a function can return that does none of its work.
    fn answers(&self, signature: &syn::Signature) -> Vec<String> {
        let returned = match &signature.output {
            syn::ReturnType::Default => return vec!["return;".into()],
            syn::ReturnType::Type(_, returned) => self.text(returned.span()),
        };
        let only = |value: &str| vec![format!("return {value};")];
        match returned {
            "bool" => vec!["return true;".into(), "return false;".into()],
            of if of.starts_with("Option<") => only("None"),
            of if of.starts_with("Result<") || of.starts_with('&') || of.contains("impl ") => {
                Vec::new()
            }
            _ => only("Default::default()"),
        }
    }
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let path = attribute.path();
        let of_tests = path.is_ident("cfg")
            && matches!(&attribute.meta, syn::Meta::List(list) if list.tokens.to_string().contains("test"));
        path.is_ident("test") || of_tests
    })
}

/// The type's or trait's last word.
fn last_word(of: &str) -> String {
    let of = of.split('<').next().unwrap_or_default();
    of.rsplit("::")
        .next()
        .unwrap_or_default()
        .trim()
        .trim_start_matches('$')
        .into()
}

/// Functions that say what is there for people to read.
const FOR_PEOPLE: [&str; 2] = ["fmt", "name"];

impl<'ast> Visit<'ast> for Seen<'_> {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }
    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        if is_test(&item.attrs) {
            return;
        }
        let mut within = last_word(self.text(item.self_ty.span()));
        // A trait's function, where the type has several of one name.
        if let Some((_, path, _)) = &item.trait_ {
            let of = last_word(self.text(path.span()));
            if !matches!(of.as_str(), "Law" | "Number" | "Word" | "Wide" | "Spatial") {
                within = format!("{within}::{of}");
            }
        }
        let before = std::mem::replace(&mut self.within, within);
        visit::visit_item_impl(self, item);
        self.within = before;
    }
    fn visit_item_trait(&mut self, item: &'ast syn::ItemTrait) {
        let before = std::mem::replace(&mut self.within, item.ident.to_string());
        visit::visit_item_trait(self, item);
        self.within = before;
    }
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if !is_test(&item.attrs) {
            self.function(&item.sig.ident.to_string(), &item.sig, &item.block);
        }
    }
    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        let name = item.sig.ident.to_string();
        if !is_test(&item.attrs) && !FOR_PEOPLE.contains(&name.as_str()) {
            self.function(&name, &item.sig, &item.block);
        }
    }
    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(block) = &item.default {
            self.function(&item.sig.ident.to_string(), &item.sig, block);
        }
    }
    // Not code that runs.
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
    fn visit_macro(&mut self, _: &'ast syn::Macro) {}
    fn visit_expr_repeat(&mut self, repeat: &'ast syn::ExprRepeat) {
        self.visit_expr(&repeat.expr);
    }

    fn visit_stmt(&mut self, statement: &'ast Stmt) {
        if let Stmt::Expr(expression, Some(_)) = statement
            && matches!(
                expression,
                Expr::Assign(_) | Expr::MethodCall(_) | Expr::Call(_) | Expr::Binary(_)
            )
        {
            let at = self.range(statement.span());
            self.add("drops", at, String::new(), true);
        }
        visit::visit_stmt(self, statement);
    }

    fn visit_expr(&mut self, expression: &'ast Expr) {
        let whole = expression.span();
        let at = self.range(whole);
        match expression {
            Expr::Binary(binary) => {
                for instead in swapped(&binary.op) {
                    let text = self.with(whole, binary.op.span(), instead);
                    let assigns =
                        instead.ends_with('=') && !matches!(*instead, "<=" | ">=" | "==" | "!=");
                    if !assigns {
                        self.add("operator", at.clone(), text, false);
                    }
                }
            }
            Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_) | UnOp::Not(_)) => {
                // A negative number is a constant; its digits are looked at by themselves.
                let text = self.text(unary.expr.span()).to_owned();
                self.add("sign", at, text, false);
            }
            Expr::MethodCall(call) => {
                for instead in method(&call.method.to_string()) {
                    let text = self.with(whole, call.method.span(), instead);
                    self.add("method", at.clone(), text, false);
                }
            }
            Expr::Path(_) | Expr::Call(_) => {
                let text = self.text(whole);
                if let Some(instead) = constant(text) {
                    self.add("constant", at, instead, false);
                }
            }
            Expr::Lit(literal) => {
                if let syn::Lit::Int(number) = &literal.lit
                    && let Ok(value) = number.base10_parse::<u128>()
                {
                    let suffix = number.suffix();
                    let others: &[u128] = match value {
                        0 => &[1],
                        1 => &[0, 2],
                        _ => &[value + 1, value - 1],
                    };
                    for other in others {
                        self.add("constant", at.clone(), format!("{other}{suffix}"), false);
                    }
                }
                if let syn::Lit::Bool(value) = &literal.lit {
                    self.add("constant", at, (!value.value).to_string(), false);
                }
            }
            Expr::If(of) if !matches!(*of.cond, Expr::Let(_)) => {
                // The whole decision, one way and the other.
                let cond = self.range(of.cond.span());
                if !has_let(&of.cond) {
                    self.add("decided", cond.clone(), "true".into(), false);
                    self.add("decided", cond, "false".into(), false);
                }
            }
            _ => {}
        }
        visit::visit_expr(self, expression);
    }
}

/// `if a && let Some(b) = c`: no expression that could stand elsewhere.
fn has_let(condition: &Expr) -> bool {
    match condition {
        Expr::Let(_) => true,
        Expr::Binary(binary) => has_let(&binary.left) || has_let(&binary.right),
        _ => false,
    }
}

fn swapped(operator: &BinOp) -> &'static [&'static str] {
    match operator {
        BinOp::Lt(_) => &["<=", ">"],
        BinOp::Le(_) => &["<", ">"],
        BinOp::Gt(_) => &[">=", "<"],
        BinOp::Ge(_) => &[">", "<"],
        BinOp::Eq(_) => &["!="],
        BinOp::Ne(_) => &["=="],
        BinOp::And(_) => &["||"],
        BinOp::Or(_) => &["&&"],
        BinOp::Add(_) => &["-"],
        BinOp::Sub(_) => &["+"],
        BinOp::Mul(_) => &["+"],
        BinOp::Div(_) => &["*"],
        BinOp::Rem(_) => &["/"],
        BinOp::Shl(_) => &[">>"],
        BinOp::Shr(_) => &["<<"],
        BinOp::BitAnd(_) => &["|"],
        BinOp::BitOr(_) => &["&"],
        BinOp::BitXor(_) => &["|"],
        _ => &[],
    }
}

fn method(name: &str) -> &'static [&'static str] {
    match name {
        "min" => &["max"],
        "max" => &["min"],
        "plus_fitting" => &["minus_fitting"],
        "minus_fitting" => &["plus_fitting"],
        "wrapping_add" => &["wrapping_sub"],
        "wrapping_sub" => &["wrapping_add"],
        "saturating_add" => &["saturating_sub"],
        "saturating_sub" => &["saturating_add"],
        "wrapping_mul" => &["wrapping_add"],
        "saturating_mul" => &["saturating_add"],
        "checked_add" => &["checked_sub"],
        "checked_sub" => &["checked_add"],
        "wrapping_shl" => &["wrapping_shr"],
        "wrapping_shr" => &["wrapping_shl"],
        "towards_zero" => &["rounded_up"],
        "rounded_up" => &["towards_zero"],
        "outward" => &["outward_up"],
        "outward_up" => &["outward"],
        "is_some" => &["is_none"],
        "is_none" => &["is_some"],
        "is_negative" => &["is_positive"],
        "minus" => &["plus"],
        "plus" => &["minus"],
        _ => &[],
    }
}

fn constant(text: &str) -> Option<String> {
    let (of, name) = text.rsplit_once("::")?;
    let other = match name {
        "zero()" => "quantum()",
        "quantum()" => "zero()",
        "MAX" => "MIN",
        "MIN" => "MAX",
        "ZERO" => "MAX",
        "MAX_SIGNED" | "WIDE_MAX_SIGNED" => "ZERO",
        _ => return None,
    };
    Some(format!("{of}::{other}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(source: &str) -> Vec<String> {
        let all = find(source).expect("Rust");
        let say = |wrong: Wrong| {
            let was = &source[wrong.at.clone()];
            format!(
                "{} {}: `{was}` `{}`",
                wrong.function, wrong.operator, wrong.instead
            )
        };
        all.into_iter().map(say).collect()
    }

    #[test]
    fn every_operator_finds_its_place() {
        let source = "impl<N> Law<N> for a::Tdpa<N> { fn f(&mut self, x: i32) -> bool { self.y = x; if x < 1 { return true; } !self.b } }";
        assert_eq!(
            found(source),
            [
                "Tdpa::f returns: `` `return true;`",
                "Tdpa::f returns: `` `return false;`",
                "Tdpa::f drops: `self.y = x;` ``",
                "Tdpa::f decided: `x < 1` `true`",
                "Tdpa::f decided: `x < 1` `false`",
                "Tdpa::f operator: `x < 1` `x <= 1`",
                "Tdpa::f operator: `x < 1` `x > 1`",
                "Tdpa::f constant: `1` `0`",
                "Tdpa::f constant: `1` `2`",
                "Tdpa::f constant: `true` `false`",
                "Tdpa::f sign: `!self.b` `self.b`",
            ]
        );
    }

    #[test]
    fn code_within_a_macro_is_read_and_tests_are_not() {
        let source = "macro_rules! m { ($(#[$d:meta])* $n:ident, $w:ty) => { $(#[$d])* impl $n { fn g(x: $w) -> $w { x.min(<$w>::MAX) } } }; }
            #[cfg(test)] mod tests { fn t() -> i32 { 1 + 2 } }";
        assert_eq!(
            found(source),
            [
                "n::g returns: `` `return Default::default();`",
                "n::g method: `x.min(<$w>::MAX)` `x.max(<$w>::MAX)`",
                "n::g constant: `<$w>::MAX` `<$w>::MIN`",
            ]
        );
    }
}
