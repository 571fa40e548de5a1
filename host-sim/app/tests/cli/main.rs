//! Tests of the program's commands that need no device, in one program, which is compiled and linked once.

#[path = "../common/mod.rs"]
mod common;

mod cli_errors;
mod cli_folder;
mod cli_hard;
mod cli_results;
mod cli_space;
mod cli_space_mechanism;
