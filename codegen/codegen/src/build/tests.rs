//! What build scripts rely on.

use super::*;

/// A folder that is removed again.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path =
            std::env::temp_dir().join(format!("shapebot-build-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const CART: &str = "robot Cart {
    params { m: kg = 1 in 0.1..10; }
    position x: m;
    kinetic 1/2*m*(d/dt(x))^2;
    actuator f on d/dt(x);
}";

#[test]
fn a_file_that_did_not_change_is_left_alone() {
    let folder = Folder::new("unchanged");
    let build = Build::new().text("cart", CART).out_dir(&folder.0);
    build.generate().expect("generated");
    let file = folder.0.join("cart.rs");
    let long_ago = std::time::SystemTime::UNIX_EPOCH;
    let handle = std::fs::File::options().write(true).open(&file).expect("there");
    handle.set_modified(long_ago).expect("set");
    build.generate().expect("generated");
    assert_eq!(std::fs::metadata(&file).and_then(|m| m.modified()).expect("there"), long_ago);
    let files = std::fs::read_dir(&folder.0).expect("there").count();
    assert_eq!(files, 1, "nothing temporary stays");
}

#[test]
fn all_wrong_models_are_reported_at_once_with_their_places() {
    let build = Build::new()
        .text("first", "robot A {")
        .text("second", "robot B { nonsense }")
        .model("absent.robot");
    let error = build.modules().expect_err("three errors");
    let text = format!("{error:?}");
    for part in [
        "no robot was generated",
        "first.robot:1",
        "second.robot:1",
        "cannot read the model absent.robot",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}

#[test]
fn two_models_of_one_name_are_refused() {
    let error = Build::new().text("a-b", CART).text("a_b", CART).modules().expect_err("one module");
    assert!(error.to_string().contains("`a_b`"));
}

#[test]
fn a_collection_lists_what_it_includes() {
    let folder = Folder::new("collection");
    Build::new()
        .text("cart", CART)
        .out_dir(&folder.0)
        .generate_collection("robots")
        .expect("generated");
    let list = std::fs::read_to_string(folder.0.join("robots.rs")).expect("written");
    assert!(list.contains("include!(concat!(env!(\"OUT_DIR\"), \"/cart.rs\"));"));
    assert!(list.contains("{ \"cart\", cart, Cart, CartBaked, 1, 1, 0 }"));
    syn::parse_file(&list).expect("Rust");
}

#[test]
fn extensions_add_items_and_warnings() {
    fn extension(derivation: &Derivation) -> Addition {
        let n = derivation.model.coordinates.len();
        let items = format!("/// Coordinates.\npub const COUNT: usize = {n};");
        Addition { items, warnings: vec!["mind the step".into()] }
    }
    fn broken(_: &Derivation) -> Addition {
        Addition { items: "pub const = ;".into(), warnings: Vec::new() }
    }
    let build = Build::new().text("cart", CART).with(extension);
    let module = build.clone().modules().expect("a module").remove(0);
    let added = "    /// Coordinates.\n    pub const COUNT: usize = 1;\n";
    assert!(module.text.contains(added), "{}", module.text);
    assert_eq!(module.warnings, ["mind the step"]);
    let module = build.with(broken).modules().expect("a module").remove(0);
    assert!(module.text.contains("compile_error!"), "{}", module.text);
}
