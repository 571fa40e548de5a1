//! Compares the schemas of results with the files in `docs/schema`.

use serde_json::Value;

/// Checks that a file in `docs/schema` has the text of this schema. With the environment variable `TOUCHSTONE_WRITE_SCHEMA` the
/// function writes the file first. Used by tests.
pub fn is_documented(file: &str, schema: &Value) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../docs/schema")
        .join(file);
    let text = format!("{schema:#}\n");
    if std::env::var_os("TOUCHSTONE_WRITE_SCHEMA").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    assert!(
        std::fs::read_to_string(&path).unwrap() == text,
        "write {file} anew: TOUCHSTONE_WRITE_SCHEMA=1 cargo test -p touchstone-lab schema"
    );
}
