//! Checks that the README's code example is the one in `examples`, which is compiled.

#[test]
fn the_example_in_the_readme_is_the_one_that_is_compiled() {
    let example = include_str!("../examples/one_wall.rs");
    let (_, code) = example
        .split_once("\n\n")
        .expect("a line of documentation, then code");
    assert!(include_str!("../README.md").contains(&format!("```rust\n{code}```")));
}
