//! Checks that `include/touchstone.h` is equal to the header that cbindgen generates from the source.

use std::path::Path;

#[test]
fn the_header_is_that_of_the_source() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("cbindgen.toml");
    let mut made = Vec::new();
    cbindgen::Builder::new()
        .with_config(config)
        .with_src(root.join("src/lib.rs"))
        .generate()
        .expect("a header")
        .write(&mut made);
    let made = String::from_utf8(made).expect("text");
    let path = root.join("include/touchstone.h");
    if std::env::var_os("TOUCHSTONE_WRITE_HEADER").is_some() {
        std::fs::write(&path, &made).expect("a header that can be written");
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        kept == made,
        "include/touchstone.h is not what the source gives: TOUCHSTONE_WRITE_HEADER=1 cargo test -p touchstone-c --test header"
    );
}
