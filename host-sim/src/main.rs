//! The `touchstone` program; everything is in the library's [`cli`](touchstone::cli).

fn main() -> std::process::ExitCode {
    touchstone::cli::main()
}
