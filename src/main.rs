//! The program. Everything, its command line too, is in the library.

fn main() -> std::process::ExitCode {
    drivemu::main()
}
