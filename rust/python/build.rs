//! Records which toolchain builds the core, for `mav doctor`.

use std::env;
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=CARGO_HOME");
    println!("cargo:rustc-env=MAVSTACK_TOOLCHAIN={} {}", compiler(), origin());
}

/// Name and version of the compiler, such as "rustc 1.95.0 (59807616e 2026-04-14)".
fn compiler() -> String {
    let program = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(program).arg("--version").output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    text.unwrap_or_else(|_| "rustc".to_owned())
}

/// Whether the toolchain is the one that `backend/mavstack_rust.py` got; its path stays out of the library.
fn origin() -> &'static str {
    let home = env::var_os("CARGO_HOME").unwrap_or_default();
    if Path::new(&home).ends_with(".tools/rust/cargo") { "of the project (.tools)" } else { "of the system" }
}
