//! Operations of every method of every bundled robot, counted in the emitted text: no timing, a table.

use shapebot_codegen::Build;
use shapebot_tests::environment::say;
use shapebot_tests::operations::count;

fn main() {
    for (name, text) in shapebot_models::MODELS {
        let modules = Build::new().text(*name, *text).bake_parameters().modules();
        for module in modules.unwrap_or_else(|error| panic!("{error}")) {
            let counts = count(&module.text);
            for (type_name, kind) in
                [(&module.names.robot, "at run time"), (&module.names.baked, "baked")]
            {
                say(&format!("{name}, parameters {kind}"));
                say(&format!(
                    "{:30} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6}",
                    "", "flops", "+ -", "*", "/", "angles", "other"
                ));
                for (method, operations) in counts.get(type_name).into_iter().flatten() {
                    say(&format!("{method:30} {operations}"));
                }
                say("");
            }
        }
    }
}
