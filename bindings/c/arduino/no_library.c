/* Arduino compiles this file only if no folder beside it has a library for the board's processor. */
#error "Touchstone has no library for this board's processor: build one with Rust and put it into a folder of src, see README.md"
