// SPDX-License-Identifier: Apache-2.0
//! Finds libodograph: in ODOGRAPH_LIB_DIR, by pkg-config, or in the default folders of the linker.
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-env-changed=ODOGRAPH_LIB_DIR");
    if std::env::var("CARGO_FEATURE_APP").is_err() {
        return;
    }
    let folder = std::env::var("ODOGRAPH_LIB_DIR").ok().or_else(|| {
        let output = Command::new("pkg-config").args(["--variable=libdir", "odograph"]).output().ok()?;
        Some(String::from_utf8(output.stdout).ok()?.trim().to_string()).filter(|path| !path.is_empty())
    });
    if let Some(folder) = folder {
        println!("cargo:rustc-link-search=native={folder}");
    }
}
