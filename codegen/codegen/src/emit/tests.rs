//! The emitted text is parsed again and executed by a small machine: every value must be that of the
//! graph, every operation must be one that was counted.

mod machine;

use super::*;
use crate::build::emitted;
use crate::derive::{Block, Derivation, Parameters, derive};
use crate::emit::body::{Request, body};
use crate::emit::plan::Root;
use machine::{Count, Machine, count};
use shapebot_symbolic::{Graph, Id, Symbol, Unary, count as counted, evaluate, nearest};
use std::path::Path;

/// Names that clash with those of emitted code, a requirement, documentation that must be escaped.
const AWKWARD: &str = "//! Cart and pole, see [0] and Vec<T>.
//!
//!     an indented line
robot Awkward {
    params {
        /// Cart [1].
        c: kg = 1 in 0.1..10;
        vector: kg = 0.1 in 0.01..1;
        l: m = 0.5 in 0.1..2;
        g: m/s^2 = 9.81;
    }
    position q: m;
    shape phi: rad in -30deg..30deg;
    kinetic 1/2*c*(d/dt(q))^2;
    frame body = world * rot_y(phi);
    rigid bob { mass: vector, inertia: diag(0, 0, 0), frame: body, com: [q, 0, 0] + body*[0, 0, l] }
    gravity g along -world.z;
    actuator force on d/dt(q);
    output [q]: m;
    require c > vector;
    require shape_accelerated;
}
";

fn derivations(name: &str, text: &str) -> [Derivation; 2] {
    let parsed = shapebot_model_dsl::parse(name, text);
    let rendered = shapebot_model_dsl::render(&parsed.diagnostics, name, text, false);
    let model = parsed.model.unwrap_or_else(|| panic!("{rendered}"));
    [Parameters::Symbolic, Parameters::Baked].map(|mode| derive(&model, mode).expect("a robot"))
}

/// The bundled models where the workspace is there, and the awkward one.
fn models() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots/models");
    let mut list = vec![("awkward".to_owned(), AWKWARD.to_owned())];
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.extension().is_some_and(|extension| extension == "robot") {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            list.push((stem, std::fs::read_to_string(path).expect("text")));
        }
    }
    list.sort();
    list
}

/// A state away from the origin.
fn value_of(symbol: Symbol, model: &Model) -> f64 {
    let wave = |i: u32, scale: f64, phase: f64| scale * (f64::from(i) * 1.7 + phase).sin();
    match symbol {
        Symbol::Parameter(i) => model.parameters[i as usize].value_f64,
        Symbol::Coordinate(i) => wave(i, 0.4, 0.3),
        Symbol::Rate(i) => wave(i, 1.3, 1.1),
        Symbol::Acceleration(i) => wave(i, 2.1, 2.3),
        Symbol::Force(i) => wave(i, 5.0, 0.7),
        Symbol::Auxiliary(_) => f64::NAN,
    }
}

fn machine(model: &Model) -> Machine {
    let n = u32::try_from(model.coordinates.len()).expect("few");
    let p = u32::try_from(model.position_count()).expect("few");
    let list = |range: std::ops::Range<u32>, symbol: fn(u32) -> Symbol| -> Vec<f64> {
        range.map(|i| value_of(symbol(i), model)).collect()
    };
    let (q, qd, qdd, f) = (Symbol::Coordinate, Symbol::Rate, Symbol::Acceleration, Symbol::Force);
    let inputs = [
        ("q", list(0..n, q)),
        ("qd", list(0..n, qd)),
        ("qdd", list(0..n, qdd)),
        ("force", list(0..n, f)),
        ("qx", list(0..p, q)),
        ("qs", list(p..n, q)),
        ("qsd", list(p..n, qd)),
        ("qsdd", list(p..n, qdd)),
    ];
    let parameters: Vec<&str> = model.parameters.iter().map(|p| p.name.as_str()).collect();
    let names = SymbolNames::new(&[], &parameters);
    let values = model.parameters.iter().map(|p| p.value_f64);
    Machine::new(inputs, names.fields.into_iter().zip(values))
}

/// Entries in the order in which the text shows them: columns of matrices.
fn shown(block: &Block, values: &[f64]) -> Vec<f64> {
    match *block.extents.as_slice() {
        [rows, columns] => (0..columns)
            .flat_map(|j| (0..rows).map(move |i| (i, j)))
            .map(|(i, j)| values[i * columns + j])
            .collect(),
        [layers, rows, columns] => {
            let inner = Block { name: "", extents: vec![rows, columns], entries: Vec::new() };
            (0..layers).flat_map(|k| shown(&inner, &values[k * rows * columns..])).collect()
        }
        _ => values.to_vec(),
    }
}

fn expected(function: &Function, model: &Model) -> Vec<f64> {
    let values = evaluate(&function.graph, &function.results(), &|symbol| value_of(symbol, model));
    let mut rest = values.as_slice();
    let mut out = Vec::new();
    for block in &function.blocks {
        let (these, others) = rest.split_at(block.entries.len());
        out.extend(shown(block, these));
        rest = others;
    }
    out
}

fn operations(function: &Function) -> Count {
    let count = counted(&function.graph, &function.results());
    assert_eq!(count, function.operations, "{:?}", function.quantity);
    Count {
        additions: count.additions,
        multiplications: count.multiplications,
        divisions: count.divisions,
        angles: count.angles,
        functions: count.functions,
    }
}

fn check_variant(file: &syn::File, type_name: &str, machine: &Machine, derivation: &Derivation) {
    let model = &derivation.model;
    let mut seen = 0;
    // Without Γ there is no trait to put the output in.
    let shaped = derivation.functions.contains_key(&Quantity::Gamma);
    for (quantity, function) in &derivation.functions {
        if !shaped && methods::SHAPE.iter().any(|method| method.quantity == *quantity) {
            continue;
        }
        let (name, index) = place_of(*quantity);
        let block = machine::method(file, type_name, name, index);
        assert_eq!(count(&block), operations(function), "{type_name}: operations of {quantity:?}");
        let expected = expected(function, model);
        let sizes: Vec<usize> = function.blocks.iter().map(|block| block.entries.len()).collect();
        let found = machine.run(&block, &sizes);
        for (x, y) in found.iter().zip(&expected) {
            let scale = 1.0 + y.abs();
            assert!(
                (x - y).abs() <= 1e-9 * scale,
                "{type_name}: {quantity:?} {found:?} instead of {expected:?}"
            );
        }
        seen += 1;
    }
    assert!(seen > 15, "{seen} functions");
}

fn place_of(quantity: Quantity) -> (&'static str, Option<usize>) {
    let plain =
        methods::LAGRANGIAN.iter().chain(methods::SHAPE).find(|method| method.quantity == quantity);
    match (plain, quantity) {
        (Some(method), _) => (method.name, None),
        (_, Quantity::InputColumn(i)) => ("input_column", Some(i)),
        (_, Quantity::FrameRotation(i)) => ("frame_rotation", Some(i)),
        (_, Quantity::PointPosition(i)) => ("point_position", Some(i)),
        (_, Quantity::PointJacobian(i)) => ("point_jacobian", Some(i)),
        (None, other) => panic!("no method computes {other:?}"),
    }
}

#[test]
fn the_text_computes_what_the_graph_computes_with_the_operations_that_were_counted() {
    for (stem, text) in models() {
        let [runtime, baked] = derivations(&stem, &text);
        let module = emitted(&stem, &runtime, Some(&baked));
        let file = syn::parse_file(&module.text).unwrap_or_else(|error| panic!("{stem}: {error}"));
        let mut machine = machine(&runtime.model);
        machine.construct(&machine::constructor(&file, &module.names.robot));
        check_variant(&file, &module.names.robot, &machine, &runtime);
        check_variant(&file, &module.names.baked, &machine, &baked);
    }
}

#[test]
fn the_same_model_gives_the_same_bytes() {
    let once = || {
        let [runtime, baked] = derivations("awkward", AWKWARD);
        emitted("awkward", &runtime, Some(&baked)).text
    };
    assert_eq!(once(), once());
}

#[test]
fn what_users_write_is_escaped_and_their_names_stay() {
    let [runtime, _] = derivations("awkward", AWKWARD);
    let text = emitted("awkward-2", &runtime, None).text;
    assert!(text.contains("/// Cart and pole, see \\[0\\] and Vec\\<T\\>."), "{text}");
    assert!(text.contains("/// an indented line"));
    assert!(text.contains("pub mod awkward_2 {") && text.contains("pub struct Awkward<T>"));
    assert!(text.contains("pub c: T") && text.contains("pub vector: T"));
    assert!(text.contains("ParameterError::Requirement"));
    assert!(!text.contains("AwkwardBaked") && !text.contains("tmp"));
}

#[test]
fn a_labelled_value_is_named_and_tells_its_line() {
    let [runtime, _] = derivations("awkward", AWKWARD);
    let text = emitted("awkward", &runtime, None).text;
    let line = AWKWARD.lines().position(|line| line.contains("frame body")).expect("there") + 1;
    let labelled = runtime
        .functions
        .values()
        .any(|f| f.results().iter().any(|&id| f.graph.label_of(id).is_some()));
    if labelled {
        assert!(text.contains(&format!("// frame `body`, awkward.robot:{line}")), "{text}");
    }
}

/// One graph that touches every operator and function, every absorption of a sign.
fn every_operator() -> (Graph, Vec<Id>) {
    let mut g = Graph::new();
    let [x, y, z] = [0, 1, 2].map(|i| g.symbol(Symbol::Coordinate(i)));
    let (tenth, pi) = (g.fraction(1, 10), g.pi());
    let mut roots = Vec::new();
    let functions = [Unary::Sqrt, Unary::Exp, Unary::Ln, Unary::Asin, Unary::Acos, Unary::Atan];
    for function in functions {
        let small = g.mul(tenth, x);
        roots.push(g.unary(function, small));
    }
    let (sin, cos) = (g.sin(x), g.cos(y));
    let sum = g.add(x, y);
    let difference = g.sub(y, z);
    let nested = g.sub(sum, difference);
    let outer = g.sub(x, nested);
    let product = g.mul(outer, difference);
    let minus = g.neg(product);
    let quotient = g.div(minus, sum);
    let inner = g.div(sum, difference);
    let deep = g.div(x, inner);
    let scaled = g.mul(pi, quotient);
    let negated = g.neg(x);
    let decaying = g.unary(Unary::Exp, negated);
    let double = g.mul(sum, cos);
    let angle = g.sin(double);
    let heading = g.atan2(y, x);
    let less = g.sub(scaled, deep);
    let opposite = g.neg(sum);
    roots.extend([sin, minus, quotient, less, decaying, angle, heading, opposite, negated, nested]);
    let zero = g.zero();
    roots.push(zero);
    (g, roots)
}

#[test]
fn every_operator_and_function_reaches_the_text_once() {
    let (graph, ids) = every_operator();
    let symbols = SymbolNames::new(&["x", "y", "z"], &[]);
    let roots: Vec<Root> = ids
        .iter()
        .enumerate()
        .map(|(i, &id)| Root { id, name: format!("result_{i}"), block: 0 })
        .collect();
    let blocks = ["results".to_owned()];
    let written = body(&Request {
        graph: &graph,
        roots: &roots,
        blocks: &blocks,
        given: &[],
        symbols: &symbols,
        named: true,
        source: &|_| None,
    });
    let mut statements = written.statements;
    statements.push(syn::Stmt::Expr(syntax::array(written.results), None));
    let function: syn::ItemFn = syn::parse_quote!(fn f() { #(#statements)* });
    let file = syn::File {
        shebang: None,
        frontmatter: None,
        attrs: Vec::new(),
        items: vec![Item::Fn(function)],
    };
    let text = prettyplease::unparse(&file);
    let parsed: syn::ItemFn = syn::parse_str(&text).expect("Rust");
    let values = [0.7, -0.4, 0.3];
    let found = Machine::with_variables([("x", 0.7), ("y", -0.4), ("z", 0.3)])
        .run(&parsed.block, &[ids.len()]);
    let expected = evaluate(&graph, &ids, &|symbol| match symbol {
        Symbol::Coordinate(i) => values[i as usize],
        _ => f64::NAN,
    });
    for ((x, y), root) in found.iter().zip(&expected).zip(&roots) {
        assert!(
            (x - y).abs() < 1e-14 * (1.0 + y.abs()),
            "{}: {x} instead of {y}\n{text}",
            root.name
        );
    }
    let count_of = counted(&graph, &ids);
    let count = count(&parsed.block);
    assert_eq!(
        (count.additions, count.multiplications),
        (count_of.additions, count_of.multiplications),
        "{text}"
    );
    assert_eq!((count.divisions, count.angles), (count_of.divisions, count_of.angles), "{text}");
    assert_eq!(count.functions, count_of.functions, "{text}");
}

#[test]
fn numbers_are_the_nearest_doubles_and_read_back() {
    let decimals = [
        "0.1",
        "0.1058",
        "2.2250738585072014e-308",
        "4.9e-324",
        "0.30000000000000004",
        "1e22",
        "9007199254740993",
        "1.7976931348623157e308",
    ];
    for text in decimals {
        let exact = rational(text);
        let value: f64 = text.parse().expect("a number");
        assert_eq!(nearest(&exact), value, "{text}");
        let expr = syntax::number(value);
        let shown = quote::quote!(#expr).to_string();
        assert_eq!(shown.parse::<f64>(), Ok(value), "{shown}");
    }
    // Many digits: num-rational's own conversion must round once.
    let third =
        rational("0.333333333333333333333333333333333333333333333333333333333333333333333333");
    assert_eq!(nearest(&third), 1.0 / 3.0);
}

fn rational(text: &str) -> num_rational::BigRational {
    use num_traits::{One, Pow};
    let (digits, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let mut value = num_rational::BigRational::one();
    value *= num_rational::BigRational::from_integer(
        format!("{whole}{fraction}").parse().expect("digits"),
    );
    let ten = num_rational::BigRational::from_integer(10.into());
    let places =
        exponent.parse::<i32>().expect("exponent") - i32::try_from(fraction.len()).expect("few");
    value * ten.pow(places)
}
