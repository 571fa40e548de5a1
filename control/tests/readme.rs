//! Checks that the README's code examples are those in `examples`, which are compiled.

#[test]
fn the_examples_in_the_readme_are_those_that_are_compiled() {
    let readme = include_str!("../README.md");
    for (name, example) in [
        ("one_wall", include_str!("../examples/one_wall.rs")),
        ("own_device", include_str!("../examples/own_device.rs")),
    ] {
        let (_, code) = example
            .split_once("\n\n")
            .expect("a line of documentation, then code");
        assert!(readme.contains(&format!("```rust\n{code}```")), "{name}");
    }
}
