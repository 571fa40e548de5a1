//! Cross-crate tests of Touchstone; see the files beside this folder.
