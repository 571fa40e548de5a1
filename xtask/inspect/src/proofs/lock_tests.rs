use super::*;

fn numbers(files: &[(&str, &str)]) -> Statements {
    let files: Vec<(PathBuf, String)> = files
        .iter()
        .map(|(path, text)| (PathBuf::from(*path), (*text).to_owned()))
        .collect();
    Statements::of(&files, "fixed 1").expect("tokens")
}

const GUARD: &str = "
    use crate::number::{Number, shift};
    pub struct Guard<N> { pub account: N }
    impl<N: Number> Guard<N> {
        pub fn tick(&self) -> N { self.pay() }
        fn pay(&self) -> N { shift(self.account) }
        pub fn full(&self) -> N { self.account }
    }";
const NUMBER: &str = "
    pub trait Number { fn product(self) -> Self; }
    pub fn shift<N: Number>(n: N) -> N { n.product() }
    macro_rules! number { ($name:ident, $bits:literal) => { impl Number for $name { fn product(self) -> Self { self.times($bits) } } } }
    pub struct Fixed8;
    number!(Fixed8, 8);";
const TDPA: &str =
    "pub struct Tdpa; impl Tdpa { pub fn tick(&self) -> i32 { LIMIT } } const LIMIT: i32 = 1;";
const PROOFS: &str = "
    use touchstone_control::guard::Guard;
    use touchstone_control::number::Fixed8;
    use crate::valid::valid;
    macro_rules! guard { ($module:ident, $number:ident) => { pub mod $module {
        use super::*;
        property! {
            /// P1: words.
            equation \"a = b\" over \"all\" by cadical fn p1_pays(s) {
                let guard = Guard::<$number>::any(s); assume!(s, valid(&guard), \"why\"); assert!(guard.tick() > 0);
            }
        }
        property! { equation \"c\" over \"all\" fn p2_full(s) { assert!(Guard::<$number>::any(s).full() > 0); } }
    } } }
    guard!(w8, Fixed8);";
const VALID: &str = "pub fn valid<T>(it: &T) -> bool { true } pub fn another() -> bool { false }";
const LAWS: &str = "use touchstone_control::tdpa::Tdpa; property! { equation \"d\" over \"all\" fn p7_law(s) { assert!(Tdpa.tick() > 0); } }";

const FILES: [(&str, &str); 6] = [
    ("control/src/guard.rs", GUARD),
    ("control/src/number.rs", NUMBER),
    ("control/src/tdpa.rs", TDPA),
    ("proofs/src/guarded.rs", PROOFS),
    ("proofs/src/laws.rs", LAWS),
    ("proofs/src/valid.rs", VALID),
];
const HARNESSES: [&str; 3] = [
    "guarded::w8::p1_pays::proof",
    "guarded::w8::p2_full::proof",
    "laws::p7_law::proof",
];

/// Replaces the text `was` by `instead` in `file`. Returns the names of the harnesses (proofs) whose statement's hash changes, and
/// of those whose code's hash changes.
fn voided(file: &str, was: &str, instead: &str) -> (Vec<&'static str>, Vec<&'static str>) {
    let before = numbers(&FILES);
    let changed = FILES.map(|(path, text)| {
        let text = text.to_owned();
        let other = if path == file {
            text.replacen(was, instead, 1)
        } else {
            text.clone()
        };
        assert!(path != file || other != text, "{file} has no `{was}`");
        (path, other)
    });
    let changed: Vec<(&str, &str)> = changed
        .iter()
        .map(|(path, text)| (*path, &**text))
        .collect();
    let after = numbers(&changed);
    let are = |standing: Standing| {
        let mut found = Vec::new();
        for harness in HARNESSES {
            if after.standing(&before.line(harness)) == standing {
                found.push(
                    harness
                        .split("::")
                        .find(|part| part.starts_with('p'))
                        .expect("its name"),
                );
            }
        }
        found
    };
    (are(Standing::OtherStatement), are(Standing::OtherCode))
}

const NOTHING: (Vec<&str>, Vec<&str>) = (vec![], vec![]);

#[test]
fn words_tests_and_what_stands_beside_void_nothing() {
    let beside = [
        "//! Of a whole file.\npub ",
        "/// Of an item.\npub ",
        "#[non_exhaustive]\npub ",
        "pub const BESIDE: i32 = 7;\npub ",
        "#[cfg(test)] mod tests { #[test] fn a() { assert!(true); } }\npub ",
        "pub fn beside() -> i32 { 7 }\npub ",
        "\n\n   pub ",
    ];
    for text in beside {
        for file in [
            "control/src/guard.rs",
            "control/src/tdpa.rs",
            "proofs/src/valid.rs",
        ] {
            assert_eq!(voided(file, "pub ", text), NOTHING, "{file}: {text}");
        }
    }
    assert_eq!(
        voided(
            "proofs/src/guarded.rs",
            "use crate",
            "const BESIDE: i32 = 7; use crate"
        ),
        NOTHING
    );
    let more =
        "property! { equation \"e\" over \"all\" fn p3_more(s) { assert!(true); } } property! {";
    assert_eq!(
        voided("proofs/src/guarded.rs", "property! {", more),
        NOTHING
    );
    assert_eq!(
        voided("proofs/src/guarded.rs", "P1: words.", "Other words."),
        NOTHING
    );
    assert_eq!(
        voided("proofs/src/guarded.rs", "cadical", "sampled"),
        NOTHING
    );
}

#[test]
fn a_changed_function_voids_what_reaches_it() {
    let code = |file: &str, was: &str, instead: &str| {
        let (statements, code) = voided(file, was, instead);
        assert_eq!(statements, [""; 0], "{instead}");
        code
    };
    // The code is reached through a method of a method, another file, a trait that a macro implements, and a constant.
    assert_eq!(
        code(
            "control/src/guard.rs",
            "shift(self.account)",
            "self.account"
        ),
        ["p1_pays"]
    );
    assert_eq!(
        code("control/src/number.rs", "{ n.product() }", "{ n }"),
        ["p1_pays"]
    );
    assert_eq!(
        code("control/src/number.rs", "self.times($bits)", "self"),
        ["p1_pays"]
    );
    assert_eq!(
        code("control/src/number.rs", "Fixed8, 8", "Fixed8, 9"),
        ["p1_pays", "p2_full"]
    );
    assert_eq!(
        code("control/src/guard.rs", "{ self.account }", "{ 0 }"),
        ["p2_full"]
    );
    assert_eq!(
        code(
            "control/src/guard.rs",
            "pub account: N",
            "pub account: N, pub more: N"
        ),
        ["p1_pays", "p2_full"]
    );
    assert_eq!(code("control/src/tdpa.rs", "= 1", "= 2"), ["p7_law"]);
}

#[test]
fn a_weaker_statement_is_another() {
    let statement = |file: &str, was: &str, instead: &str| voided(file, was, instead).0;
    // Changes an assertion, an assumption, the condition assumed, the equation, and the number type.
    let own = "proofs/src/guarded.rs";
    assert_eq!(
        statement(own, "guard.tick() > 0", "guard.tick() >= 0"),
        ["p1_pays"]
    );
    assert_eq!(
        statement(own, "assume!(s, valid(&guard), \"why\");", ""),
        ["p1_pays"]
    );
    assert_eq!(
        statement("proofs/src/valid.rs", "{ true }", "{ false }"),
        ["p1_pays"]
    );
    assert_eq!(
        statement("proofs/src/valid.rs", "{ false }", "{ true }"),
        [""; 0]
    );
    assert_eq!(statement(own, "a = b", "a = c"), ["p1_pays"]);
    assert_eq!(
        statement(own, "w8, Fixed8", "w8, Fixed16"),
        ["p1_pays", "p2_full"]
    );
}

#[test]
fn of_two_with_one_name_each_is_a_part_of_the_number() {
    let two = |first: &str| {
        let law = format!(
            "mod a {{ property! {{ fn p1_a(s) {{ assert!({first}); }} }} }} mod b {{ property! {{ fn p1_a(s) {{ assert!(y); }} }} }}"
        );
        numbers(&[("proofs/src/law.rs", &law)]).line("law::a::p1_a::proof")
    };
    assert_ne!(two("x > 0"), two("true"));
}

/// Checks that the sources have the property of every harness in the committed lock (list of proofs).
#[test]
fn every_line_of_the_lock_is_of_a_property() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    std::env::set_current_dir(root).expect("the workspace");
    let statements = Statements::read().expect("the sources");
    let locked = read(Path::new(LOCK)).expect("the lock");
    for line in locked.lines() {
        assert!(statements.0.contains_key(&property(name(line))), "{line}");
    }
}
