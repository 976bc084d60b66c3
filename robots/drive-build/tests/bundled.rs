//! The bundled descriptions are sound for their models.

mod common;

use common::{description, names};

#[test]
fn bundled_descriptions_are_sound() {
    for name in names() {
        let description = description(name).unwrap_or_else(|errors| panic!("{name}:\n{errors}"));
        assert_eq!(description.nodes.len(), description.simulated.len());
        for load in &description.loads {
            print!("{}", load.report());
        }
    }
}
