//! Reads model files and prints what there is to say about them.
#![allow(clippy::print_stdout, missing_docs)]

fn main() {
    for path in std::env::args().skip(1) {
        let bytes = std::fs::read(&path).unwrap_or_default();
        let parsed = shapebot_model_dsl::parse_bytes(&path, &bytes);
        print!(
            "{}",
            shapebot_model_dsl::render(
                &parsed.diagnostics,
                &path,
                &String::from_utf8_lossy(&bytes),
                false
            )
        );
        if let Some(model) = parsed.model {
            let names: Vec<&str> = model.coordinates.iter().map(|c| c.name.as_str()).collect();
            println!(
                "{}: {} expressions, q = [{}]",
                model.name,
                model.expressions.len(),
                names.join(", ")
            );
        }
    }
}
