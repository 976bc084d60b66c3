//! The optimiser: same values, never more operations, the same result in every run.

mod support;

use shapebot_symbolic::{Effort, Graph, Id, Symbol, Unary, count, evaluate, normal_form, optimise};
use support::{Model, upper};

/// splitmix64.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % bound as u64) as usize
    }
}

fn inputs(graph: &mut Graph) -> Vec<Id> {
    let mut pool = vec![graph.fraction(3, 7), graph.integer(-2), graph.pi(), graph.one()];
    for i in 0..3 {
        let symbols = [Symbol::Parameter(i), Symbol::Coordinate(i), Symbol::Rate(i)];
        pool.extend(symbols.map(|symbol| graph.symbol(symbol)));
        let angle = graph.symbol(Symbol::Coordinate(i));
        pool.extend([graph.sin(angle), graph.cos(angle)]);
    }
    pool
}

/// A random expression; roots and quotients only of sums that stay positive.
fn random_graph(seed: u64, size: usize) -> (Graph, Vec<Id>) {
    let mut random = Random(seed);
    let mut graph = Graph::new();
    let mut pool = inputs(&mut graph);
    for _ in 0..size {
        let recent = pool.len().min(24);
        let a = pool[random.below(pool.len())];
        let b = pool[pool.len() - 1 - random.below(recent)];
        let value = match random.below(12) {
            0..=3 => graph.add(a, b),
            4 | 5 => graph.sub(a, b),
            6..=8 => graph.mul(a, b),
            9 => graph.neg(b),
            10 => {
                let (x, y) = (graph.sin(a), graph.cos(b));
                graph.mul(x, y)
            }
            _ => quotient(&mut graph, a, b),
        };
        pool.push(value);
    }
    let ids = (0..6).map(|i| pool[pool.len() - 1 - 3 * i]).collect();
    (graph, ids)
}

fn quotient(graph: &mut Graph, a: Id, b: Id) -> Id {
    let sine = graph.sin(b);
    let two = graph.integer(2);
    let bottom = graph.add(sine, two);
    let root = graph.unary(Unary::Sqrt, bottom);
    graph.div(a, root)
}

fn value_of(symbol: Symbol) -> f64 {
    match symbol {
        Symbol::Parameter(i) => 0.7 + 0.31 * f64::from(i),
        Symbol::Coordinate(i) => 0.3 - 0.47 * f64::from(i),
        Symbol::Rate(i) => -0.9 + 0.53 * f64::from(i),
        _ => f64::NAN,
    }
}

fn assert_optimised(graph: &Graph, ids: &[Id], effort: Effort) -> (Graph, Vec<Id>) {
    let (best, best_ids) = optimise(graph, ids, effort);
    assert_eq!(best_ids.len(), ids.len());
    for (&id, &best_id) in ids.iter().zip(&best_ids) {
        assert!(graph.same_value(id, &best, best_id));
    }
    assert!(count(&best, &best_ids).flops() <= count(graph, ids).flops());
    let (before, after) = (evaluate(graph, ids, &value_of), evaluate(&best, &best_ids, &value_of));
    for (x, y) in before.iter().zip(&after) {
        if x.abs() < 1e6 {
            assert!((x - y).abs() <= 1e-9 * x.abs().max(1.0), "{x} became {y}");
        }
    }
    (best, best_ids)
}

#[test]
fn random_graphs_keep_their_values() {
    for seed in 0..60 {
        for size in [8, 25, 60] {
            let (graph, ids) = random_graph(seed, size);
            assert_optimised(&graph, &ids, Effort::Quick);
            assert_optimised(&graph, &ids, Effort::Thorough);
        }
    }
}

#[test]
fn normal_forms_of_random_graphs_keep_their_values() {
    for seed in 100..160 {
        let (graph, ids) = random_graph(seed, 20);
        let Some(polynomials) = normal_form::expand(&graph, &ids, 300) else { continue };
        let (form, form_ids) = polynomials.rebuild();
        for (&id, &form_id) in ids.iter().zip(&form_ids) {
            assert!(graph.same_value(id, &form, form_id));
        }
    }
}

#[test]
fn two_runs_give_the_same_graph() {
    for seed in 200..210 {
        let (graph, ids) = random_graph(seed, 60);
        let (first, first_ids) = optimise(&graph, &ids, Effort::Thorough);
        let (second, second_ids) = optimise(&graph, &ids, Effort::Thorough);
        assert_eq!(first_ids, second_ids);
        assert_eq!(first.len(), second.len());
        for (&a, &b) in first_ids.iter().zip(&second_ids) {
            assert_eq!(first.node(a), second.node(b));
        }
    }
}

#[test]
fn the_mass_matrix_of_the_ballbot_with_arms_gets_cheap() {
    for (baked, limit) in [(true, 160), (false, 170)] {
        let mut model = Model::new(baked);
        let m = model.mass_matrix();
        let ids = upper(&m);
        let (best, best_ids) = assert_optimised(&model.graph, &ids, Effort::Thorough);
        let flops = count(&best, &best_ids).flops();
        assert!(flops <= limit, "{flops} operations");
        assert_eq!(count(&best, &best_ids).angles, 6);
    }
}

#[test]
fn the_bias_from_christoffel_symbols_shrinks_to_a_third() {
    let mut model = Model::new(true);
    let m = model.mass_matrix();
    let bias = model.bias(&m);
    let (best, best_ids) = assert_optimised(&model.graph, &bias, Effort::Thorough);
    let flops = count(&best, &best_ids).flops();
    assert!(flops <= 420, "{flops} operations");
}

#[test]
fn no_parameter_is_divided_by() {
    // p x + q y and p z + q w share x + (q/p) y only if p may not be zero.
    let mut graph = Graph::new();
    let [p, q] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
    let [x, y, z] = [0, 1, 2].map(|i| graph.symbol(Symbol::Rate(i)));
    let (px, qy) = (graph.mul(p, x), graph.mul(q, y));
    let plain = graph.add(px, qy);
    let (zx, zy) = (graph.mul(z, px), graph.mul(z, qy));
    let scaled = graph.add(zx, zy);
    let (best, ids) = assert_optimised(&graph, &[plain, scaled], Effort::Thorough);
    let values = evaluate(&best, &ids, &|symbol| match symbol {
        Symbol::Parameter(0) => 0.0,
        other => value_of(other),
    });
    assert!(values.iter().all(|value| value.is_finite()));
    assert_eq!(count(&best, &ids).flops(), 4);
}

#[test]
fn names_follow_their_values() {
    let mut graph = Graph::new();
    let [x, y, z] = [0, 1, 2].map(|i| graph.symbol(Symbol::Rate(i)));
    let sum = graph.add(x, y);
    graph.label(sum, "common");
    let (a, b) = (graph.mul(sum, z), graph.mul(sum, sum));
    let (best, ids) = optimise(&graph, &[a, b], Effort::Quick);
    let named = shapebot_symbolic::needed(&best, &ids, |_| false)
        .into_iter()
        .find_map(|id| best.label_of(id));
    assert_eq!(named, Some("common"));
}

#[test]
fn factors_of_sums_are_taken_out() {
    // 2a b + 2a c + 2a d
    let mut graph = Graph::new();
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| graph.symbol(Symbol::Rate(i)));
    let two = graph.integer(2);
    let twice = graph.mul(two, a);
    let mut sum = graph.zero();
    for x in [b, c, d] {
        let part = graph.mul(twice, x);
        sum = graph.add(sum, part);
    }
    let (best, ids) = assert_optimised(&graph, &[sum], Effort::Quick);
    assert_eq!(count(&best, &ids).flops(), 4);
}
