//! Vectors as Rust.

/// Numbers as an array; they read back as the same doubles.
pub(crate) fn array<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> String {
    let numbers: Vec<String> = numbers.into_iter().map(|number| format!("{number:?}")).collect();
    format!("[{}]", numbers.join(", "))
}

/// `pub const NAME: [Type; n] = [...];` with its documentation.
pub(crate) fn list(docs: &str, name: &str, kind: &str, entries: &[String]) -> String {
    let entries = entries.join("\n");
    format!("/// {docs}\npub const {name}: &[{kind}] = &[\n{entries}\n];\n")
}

/// The module of all vectors.
pub(crate) fn module(items: &[String]) -> String {
    let items = items.join("\n");
    format!(
        "//! Recorded when this crate was made; see `recorded.rs` for where they come from.\n\n{items}"
    )
}
