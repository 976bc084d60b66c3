//! Tapes against the graph they were compiled from.

use crate::State;
use crate::compile::compile;
use crate::tape::{Operation, Tape};
use shapebot_symbolic::{Graph, Id, Symbol, Unary, evaluate};

fn values(symbol: Symbol) -> f64 {
    match symbol {
        Symbol::Parameter(i) => [0.3, 1.7][i as usize],
        Symbol::Coordinate(i) => [0.4, -0.9][i as usize],
        Symbol::Rate(i) => [1.1, 2.3][i as usize],
        Symbol::Acceleration(i) => [-0.2, 0.6][i as usize],
        Symbol::Force(i) => [5.0, -7.0][i as usize],
        Symbol::Auxiliary(_) => f64::NAN,
    }
}

const STATE: State<'static, f64> =
    State { q: &[0.4, -0.9], qd: &[1.1, 2.3], qdd: &[-0.2, 0.6], force: &[5.0, -7.0] };

fn run(tape: &Tape<f64>) -> Vec<f64> {
    let mut results = vec![f64::NAN; tape.outputs.len()];
    tape.run(&STATE, |i, value| results[i] = value);
    results
}

fn close(left: &[f64], right: &[f64]) -> bool {
    left.iter().zip(right).all(|(a, b)| (a - b).abs() <= 1e-15 * b.abs().max(1.0))
}

/// Every kind of node, shared values, and results that are inputs, constants and each other.
fn everything(graph: &mut Graph) -> Vec<Id> {
    let [p, x, v] = [Symbol::Parameter(0), Symbol::Coordinate(0), Symbol::Rate(1)];
    let [p, x, v] = [p, x, v].map(|symbol| graph.symbol(symbol));
    let (a, f) = (graph.symbol(Symbol::Acceleration(1)), graph.symbol(Symbol::Force(0)));
    let (sine, cosine) = (graph.sin(x), graph.cos(x));
    let pi = graph.pi();
    let scale = graph.mul(p, pi);
    let product = graph.mul(sine, v);
    let sum = graph.add(product, scale);
    let quotient = graph.div(sum, cosine);
    let negative = graph.neg(quotient);
    let square = graph.mul(v, v);
    let root = graph.unary(Unary::Sqrt, square);
    let fifth = graph.fraction(1, 5);
    let small = graph.mul(fifth, x);
    let others = [Unary::Exp, Unary::Asin, Unary::Acos, Unary::Atan].map(|f| graph.unary(f, small));
    let ln = graph.unary(Unary::Ln, f);
    let angle = graph.atan2(v, f);
    let difference = graph.sub(angle, a);
    let mut results = vec![
        quotient,
        negative,
        sum,
        root,
        ln,
        angle,
        difference,
        sine,
        x,
        scale,
        graph.one(),
        sum,
    ];
    results.extend(others);
    results
}

#[test]
fn a_tape_gives_what_the_graph_is_worth() {
    let mut graph = Graph::new();
    let results = everything(&mut graph);
    let tape = compile(&graph, &results, &[0.3, 1.7]);
    let expected = evaluate(&graph, &results, &values);
    assert!(close(&run(&tape), &expected), "{:?} {expected:?}", run(&tape));
    assert_eq!(run(&tape), run(&tape));
}

#[test]
fn parameters_alone_cost_nothing_per_call() {
    let mut graph = Graph::new();
    let (p, r) = (graph.symbol(Symbol::Parameter(0)), graph.symbol(Symbol::Parameter(1)));
    let x = graph.symbol(Symbol::Coordinate(0));
    let sine = graph.sin(p);
    let ratio = graph.div(sine, r);
    let result = graph.mul(ratio, x);
    let tape = compile(&graph, &[result], &[0.3, 1.7]);
    assert_eq!(tape.steps.len(), 1);
    assert_eq!(tape.constants, [libm_sine(0.3) / 1.7]);
}

fn libm_sine(x: f64) -> f64 {
    shapebot_dynamics::Real::sin_cos(x).0
}

#[test]
fn sine_and_cosine_of_an_angle_are_one_instruction() {
    let mut graph = Graph::new();
    let x = graph.symbol(Symbol::Coordinate(0));
    let (sine, cosine) = (graph.sin(x), graph.cos(x));
    let tape = compile::<f64>(&graph, &[cosine, sine], &[]);
    assert_eq!(tape.steps.len(), 1);
    assert_eq!(tape.runs[0].operation, Operation::SinCos);
    let (s, c) = shapebot_dynamics::Real::sin_cos(0.4);
    assert_eq!(run(&tape), [c, s]);
}

#[test]
fn registers_of_dead_values_are_used_again() {
    let mut graph = Graph::new();
    let x = graph.symbol(Symbol::Coordinate(0));
    let mut value = x;
    for i in 1..200 {
        let step = graph.integer(i);
        let sum = graph.add(value, step);
        value = graph.sin(sum);
    }
    let tape = compile::<f64>(&graph, &[value], &[]);
    assert!(tape.register_count < tape.constants.len() + 5);
    assert!(close(&run(&tape), &evaluate(&graph, &[value], &values)));
}

#[test]
fn threads_that_call_at_once_do_not_disturb_each_other() {
    let mut graph = Graph::new();
    let results = everything(&mut graph);
    let tape = compile(&graph, &results, &[0.3, 1.7]);
    let expected = run(&tape);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| (0..500).for_each(|_| assert_eq!(run(&tape), expected)));
        }
    });
}

#[test]
fn a_tape_runs_in_single_precision() {
    let mut graph = Graph::new();
    let (x, p) = (graph.symbol(Symbol::Coordinate(0)), graph.symbol(Symbol::Parameter(0)));
    let sine = graph.sin(x);
    let result = graph.mul(p, sine);
    let tape = compile(&graph, &[result], &[0.5_f32]);
    let mut value = 0.0;
    tape.run(&State { q: &[0.4_f32], ..State::EMPTY }, |_, v| value = v);
    assert_eq!(value, 0.5 * shapebot_dynamics::Real::sin_cos(0.4_f32).0);
}
