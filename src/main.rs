//! The `abbe` program.

fn main() -> std::process::ExitCode {
    abbe::cli::main()
}
