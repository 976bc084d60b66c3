//! The start-up code's linker script; its memory layout comes from `shapebot-firmware`.

fn main() {
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rerun-if-changed=build.rs");
}
