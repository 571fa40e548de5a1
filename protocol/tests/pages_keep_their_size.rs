//! Checks that the book (the Markdown files of the documentation) has at most 60,000 words and the README at most 900.

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
    let [book, readme] = [
        words_below(&root.join("docs")),
        words_of(&root.join("README.md")),
    ];
    println!("{book} words in the book, {readme} in the README");
    assert!(
        book <= 60_000,
        "{book} words in the book, of at most 60,000"
    );
    assert!(
        readme <= 900,
        "{readme} words in the README, of at most 900"
    );
}
