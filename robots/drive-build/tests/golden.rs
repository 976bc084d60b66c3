//! What is generated, compared with files beside this test. `UPDATE_GOLDEN=1 cargo test -p
//! shapebot-drive-build --test golden` writes them anew: read the difference before committing it.

mod common;

use common::{description, names};
use std::path::Path;

fn compare(file: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(file);
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, text).expect("a folder to write to");
        return;
    }
    let golden = std::fs::read_to_string(&path).unwrap_or_default();
    let differs = golden.lines().zip(text.lines()).position(|(a, b)| a != b);
    assert!(
        golden == text,
        "{file} differs from line {:?} on; UPDATE_GOLDEN=1 writes it anew",
        differs.map(|line| line + 1)
    );
}

#[test]
fn outputs_are_what_they_were() {
    for name in ["ballbot3d", "ballbot3d_1khz"] {
        let description = description(name).unwrap_or_else(|errors| panic!("{errors}"));
        compare(&format!("{name}.rs.txt"), &description.rust());
        compare(&format!("{name}.setup.txt"), &description.setup_text());
        for bus in 0..description.buses.len() {
            let text = description.dbc(bus).expect("a bus");
            compare(&format!("{name}.{}.dbc", description.buses[bus].name), &text);
        }
    }
}

#[test]
fn reports_are_what_they_were() {
    for name in names() {
        let description = description(name).unwrap_or_else(|errors| panic!("{errors}"));
        compare(&format!("{name}.report.txt"), &description.report());
    }
}

#[test]
fn generation_is_a_pure_function() {
    for name in names() {
        let once = description(name).unwrap_or_else(|errors| panic!("{errors}"));
        let twice = description(name).unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(once.rust(), twice.rust());
        assert_eq!(once.dbc(0), twice.dbc(0));
        assert_eq!(once.fingerprint, twice.fingerprint);
        assert_ne!(once.fingerprint, 0);
        assert_eq!(once.dbc(9), None);
    }
}
