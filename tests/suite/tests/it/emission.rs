//! The emitted text: the same in every run, as short as promised, and documented.

use shapebot_codegen::derive::{Function, Parameters, Quantity, prove, specialise};
use shapebot_codegen::{Build, Module, build::emitted};
use shapebot_tests::models::model;
use shapebot_tests::operations::{Methods, Operations, count};
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::process::Command;
use std::sync::OnceLock;

/// Modules of all bundled models, with baked types.
fn generate() -> Vec<Module> {
    let models = shapebot_models::MODELS.iter();
    let build =
        models.fold(Build::new().bake_parameters(), |build, (name, text)| build.text(*name, *text));
    build.modules().unwrap_or_else(|error| panic!("{error}"))
}

/// The modules of this run.
fn modules() -> &'static [Module] {
    static MODULES: OnceLock<Vec<Module>> = OnceLock::new();
    MODULES.get_or_init(generate)
}

/// Counts of a bundled robot's methods, parameters at run time and baked.
fn counts(name: &str) -> [Methods; 2] {
    let module =
        modules().iter().find(|m| m.stem == name).unwrap_or_else(|| panic!("no model `{name}`"));
    let mut counts = count(&module.text);
    [&module.names.robot, &module.names.baked].map(|name| counts.remove(name).expect("a type"))
}

fn digest(modules: &[Module]) -> String {
    let mut hasher = DefaultHasher::new();
    modules.iter().for_each(|module| module.text.hash(&mut hasher));
    format!("digest {:016x}", hasher.finish())
}

/// Set in the second process of the test below.
const CHILD: &str = "SHAPEBOT_DIGEST_ONLY";

#[test]
fn two_generations_are_equal_to_the_byte() {
    if std::env::var_os(CHILD).is_some() {
        return shapebot_tests::environment::say(&digest(modules()));
    }
    for (first, second) in modules().iter().zip(generate()) {
        assert!(first.text == second.text, "`{}` was emitted in two ways", first.stem);
    }
    // Another process has other addresses and other hash seeds.
    let test = std::env::current_exe().expect("the path of this test");
    let arguments = ["--exact", "emission::two_generations_are_equal_to_the_byte", "--nocapture"];
    let output =
        Command::new(test).args(arguments).env(CHILD, "1").output().expect("a second process");
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(said.contains(&digest(modules())), "another process emits another text:\n{said}");
}

/// What the best of SymForce, CasADi and SymPy reaches for the ballbot with arms, parameters folded in;
/// ours by the operators in the emitted text.
#[test]
fn operations_of_the_ballbot_with_arms_are_no_more_than_the_best_of_other_tools() {
    let [_, baked] = counts("ballbot3d_arms");
    for (method, limit) in [
        ("mass_matrix", 303),
        ("coriolis_vector", 280),
        ("gravity", 60),
        ("gamma", 613),
        ("response", 2937),
        ("forward_dynamics", 1190),
        ("motion", 1086),
    ] {
        let flops = baked[method].flops();
        assert!(flops > 0 && flops <= limit, "{method}: {flops} operations, at most {limit}");
    }
}

#[test]
fn one_pass_is_cheaper_than_single_calls() {
    for module in modules() {
        for counts in counts(&module.stem) {
            let flops = |method: &str| counts[method].flops();
            let single = flops("mass_matrix") + flops("coriolis_vector") + flops("gravity");
            assert!(flops("motion") <= single, "{}: {} > {single}", module.stem, flops("motion"));
        }
    }
}

#[test]
fn folding_parameters_in_saves_operations() {
    let totals = modules().iter().map(|module| {
        counts(&module.stem).map(|methods| methods.values().map(Operations::flops).sum::<usize>())
    });
    let [runtime, baked] = totals.fold([0, 0], |[a, b], [x, y]| [a + x, b + y]);
    assert!(baked < runtime, "{baked} operations baked, {runtime} at run time");
}

/// The quantity that a method computes.
const METHODS: [(&str, Quantity); 9] = [
    ("mass_matrix", Quantity::MassMatrix),
    ("coriolis_matrix", Quantity::CoriolisMatrix),
    ("coriolis_vector", Quantity::CoriolisVector),
    ("gravity", Quantity::Gravity),
    ("forward_dynamics", Quantity::ForwardDynamics),
    ("motion", Quantity::Motion),
    ("gamma", Quantity::Gamma),
    ("gamma_prime", Quantity::GammaPrime),
    ("response", Quantity::Response),
];

#[test]
fn documented_operations_are_those_of_the_text() {
    for (name, _) in shapebot_models::MODELS {
        let model = model(name);
        let (equations, certificate) =
            prove(&model).unwrap_or_else(|errors| panic!("{name}: {errors:?}"));
        let [runtime, baked] = [Parameters::Symbolic, Parameters::Baked]
            .map(|parameters| specialise(&model, &equations, &certificate, parameters));
        let module = emitted(name, &runtime, Some(&baked));
        let counted = count(&module.text);
        let pairs = [(&module.names.robot, &runtime), (&module.names.baked, &baked)];
        for (type_name, derivation) in pairs {
            compare(type_name, &counted[type_name], &derivation.functions);
        }
    }
}

fn compare(name: &str, counted: &Methods, functions: &BTreeMap<Quantity, Function>) {
    for (method, quantity) in METHODS {
        let Some(function) = functions.get(&quantity) else { continue };
        let documented = function.operations;
        let documented = Operations {
            additions: documented.additions,
            multiplications: documented.multiplications,
            divisions: documented.divisions,
            angles: documented.angles,
            functions: documented.functions,
        };
        assert_eq!(counted[method], documented, "{name}::{method}: in the text, and documented");
    }
}

#[test]
fn every_module_documents_coordinates_parameters_and_source() {
    for module in modules() {
        let model = model(&module.stem);
        let text = &module.text;
        let contains = |part: &str| assert!(text.contains(part), "{}: no `{part}`", module.stem);
        contains(&format!("{}.robot", module.stem));
        contains(&format!("pub mod {}", module.names.module));
        model.coordinates.iter().for_each(|coordinate| contains(&format!("`{}`", coordinate.name)));
        for parameter in &model.parameters {
            contains(&format!("pub {}: T", parameter.name));
            if let Some(line) = parameter.docs.lines().next() {
                contains(line.trim());
            }
        }
    }
}

#[test]
fn emitted_code_names_crates_by_absolute_paths_alone() {
    for module in modules() {
        for line in module.text.lines().map(str::trim).filter(|line| line.starts_with("use ")) {
            let allowed = ["use ::shapebot_dynamics::", "use super::", "use ::core::"];
            assert!(allowed.iter().any(|start| line.starts_with(start)), "{}: {line}", module.stem);
        }
        assert!(!module.text.contains("std::"), "{} needs the standard library", module.stem);
        assert!(!module.text.contains("unsafe"), "{} has unsafe code", module.stem);
    }
}
