//! Checks that the book (the Markdown files of the documentation) has at most 60,000 words, its page on proofs at most 2,500, and
//! the README at most 900, and the changelog at most 80 lines.

use std::path::Path;

/// Number of words in all Markdown files of a folder.
fn words_below(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let count = |entry: std::io::Result<std::fs::DirEntry>| {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => words_below(&path),
            false if path.extension().is_some_and(|it| it == "md") => words_of(&path),
            false => 0,
        }
    };
    entries.map(count).sum()
}

fn words_of(page: &Path) -> usize {
    let text = std::fs::read_to_string(page).expect("a page");
    text.split_whitespace().count()
}

#[test]
fn the_book_and_the_readme_are_short() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = |name: &str| words_of(&root.join(name));
    let sizes = [
        ("the book", words_below(&root.join("docs")), 60_000),
        ("docs/proofs.md", page("docs/proofs.md"), 2_500),
        ("README.md", page("README.md"), 900),
    ];
    for (what, words, most) in sizes {
        println!("{what}: {words} words");
        assert!(words <= most, "{what}: {words} words, of at most {most}");
    }
    let changes = std::fs::read_to_string(root.join("CHANGELOG.md")).expect("the changelog");
    let lines = changes.lines().count();
    assert!(lines <= 80, "CHANGELOG.md: {lines} lines, of at most 80");
}
