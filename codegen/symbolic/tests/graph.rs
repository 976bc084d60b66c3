//! The graph against independent evaluations: in doubles, and modulo the prime at points that the
//! graph itself never sees.

use num_rational::BigRational;
use proptest::prelude::*;
use shapebot_symbolic::field::{Residue, UnitPoint, pseudo_random};
use shapebot_symbolic::{Graph, Id, Node, Symbol, Tangent, Unary, evaluate, gradient};

/// An expression as a user would type it.
#[derive(Clone, Debug)]
enum Tree {
    Number(i64, i64),
    Symbol(u32),
    Sin(i64, u32),
    Cos(i64, u32),
    Add(Box<Tree>, Box<Tree>),
    Sub(Box<Tree>, Box<Tree>),
    Mul(Box<Tree>, Box<Tree>),
    Div(Box<Tree>, Box<Tree>),
    Neg(Box<Tree>),
}

fn tree() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![
        (-9_i64..10, 1_i64..5).prop_map(|(n, d)| Tree::Number(n, d)),
        (0_u32..3).prop_map(Tree::Symbol),
        (-4_i64..5, 0_u32..3).prop_map(|(k, i)| Tree::Sin(k, i)),
        (-4_i64..5, 0_u32..3).prop_map(|(k, i)| Tree::Cos(k, i)),
    ];
    leaf.prop_recursive(6, 64, 2, |inner| {
        let pair = (inner.clone(), inner.clone());
        prop_oneof![
            pair.clone().prop_map(|(a, b)| Tree::Add(Box::new(a), Box::new(b))),
            pair.clone().prop_map(|(a, b)| Tree::Sub(Box::new(a), Box::new(b))),
            pair.clone().prop_map(|(a, b)| Tree::Mul(Box::new(a), Box::new(b))),
            pair.prop_map(|(a, b)| Tree::Div(Box::new(a), Box::new(b))),
            inner.prop_map(|a| Tree::Neg(Box::new(a))),
        ]
    })
}

fn angle(graph: &mut Graph, k: i64, i: u32) -> Id {
    let x = graph.symbol(Symbol::Coordinate(i));
    let half = graph.fraction(k, 2);
    graph.mul(half, x)
}

fn build(graph: &mut Graph, tree: &Tree) -> Id {
    match tree {
        Tree::Number(n, d) => graph.fraction(*n, *d),
        Tree::Symbol(i) => graph.symbol(Symbol::Coordinate(*i)),
        Tree::Sin(k, i) => {
            let x = angle(graph, *k, *i);
            graph.sin(x)
        }
        Tree::Cos(k, i) => {
            let x = angle(graph, *k, *i);
            graph.cos(x)
        }
        Tree::Add(a, b) => {
            let (a, b) = (build(graph, a), build(graph, b));
            graph.add(a, b)
        }
        Tree::Sub(a, b) => {
            let (a, b) = (build(graph, a), build(graph, b));
            graph.sub(a, b)
        }
        Tree::Mul(a, b) => {
            let (a, b) = (build(graph, a), build(graph, b));
            graph.mul(a, b)
        }
        Tree::Div(a, b) => {
            let (a, b) = (build(graph, a), build(graph, b));
            graph.div(a, b)
        }
        Tree::Neg(a) => {
            let a = build(graph, a);
            graph.neg(a)
        }
    }
}

/// Arithmetic to evaluate a tree or a graph in.
trait Field: Copy {
    fn rational(value: &BigRational) -> Option<Self>;
    fn symbol(i: u32) -> Self;
    /// (cos, sin) of k/2 times symbol i.
    fn circle(k: i64, i: u32) -> (Self, Self);
    fn add(self, other: Self) -> Self;
    fn neg(self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn inverse(self) -> Option<Self>;
}

impl Field for Residue {
    fn rational(value: &BigRational) -> Option<Self> {
        Residue::from_rational(value)
    }
    fn symbol(i: u32) -> Self {
        pseudo_random(&[0xfeed, u64::from(i)])
    }
    fn circle(k: i64, i: u32) -> (Self, Self) {
        let p = UnitPoint::from_half_tangent(pseudo_random(&[0xbeef, u64::from(i)])).multiple(k);
        (p.cos, p.sin)
    }
    fn add(self, other: Self) -> Self {
        Residue::add(self, other)
    }
    fn neg(self) -> Self {
        Residue::neg(self)
    }
    fn mul(self, other: Self) -> Self {
        Residue::mul(self, other)
    }
    fn inverse(self) -> Option<Self> {
        Residue::inverse(self)
    }
}

fn value_of_tree<F: Field>(tree: &Tree) -> Option<F> {
    Some(match tree {
        Tree::Number(n, d) => F::rational(&BigRational::new((*n).into(), (*d).into()))?,
        Tree::Symbol(i) => F::symbol(*i),
        Tree::Sin(k, i) => F::circle(*k, *i).1,
        Tree::Cos(k, i) => F::circle(*k, *i).0,
        Tree::Add(a, b) => value_of_tree::<F>(a)?.add(value_of_tree(b)?),
        Tree::Sub(a, b) => value_of_tree::<F>(a)?.add(value_of_tree::<F>(b)?.neg()),
        Tree::Mul(a, b) => value_of_tree::<F>(a)?.mul(value_of_tree(b)?),
        Tree::Div(a, b) => value_of_tree::<F>(a)?.mul(value_of_tree::<F>(b)?.inverse()?),
        Tree::Neg(a) => value_of_tree::<F>(a)?.neg(),
    })
}

/// The multiple of a half symbol that an argument of sin or cos is.
fn half_multiple(graph: &Graph, id: Id) -> (i64, u32) {
    let half = BigRational::new(1.into(), 2.into());
    match graph.node(id) {
        Node::Symbol(Symbol::Coordinate(i)) => (2, *i),
        Node::Neg(a) => {
            let (k, i) = half_multiple(graph, *a);
            (-k, i)
        }
        Node::Mul(c, x) => {
            let (k, i) = half_multiple(graph, *x);
            let scaled = graph.as_constant(*c).unwrap() * BigRational::from_integer(k.into());
            assert!((&scaled / &half).is_integer() || scaled.is_integer());
            (i64::try_from(scaled.to_integer()).unwrap(), i)
        }
        // The same value had been built as a sum before.
        Node::Add(a, b) => {
            let ((k, i), (l, j)) = (half_multiple(graph, *a), half_multiple(graph, *b));
            assert_eq!(i, j);
            (k + l, i)
        }
        Node::Sub(a, b) => {
            let ((k, i), (l, j)) = (half_multiple(graph, *a), half_multiple(graph, *b));
            assert_eq!(i, j);
            (k - l, i)
        }
        other => panic!("no multiple of a symbol: {other:?}"),
    }
}

fn value_of_graph<F: Field>(graph: &Graph, id: Id) -> Option<F> {
    Some(match graph.node(id) {
        Node::Constant(value) => F::rational(value)?,
        Node::Symbol(Symbol::Coordinate(i)) => F::symbol(*i),
        Node::Add(a, b) => value_of_graph::<F>(graph, *a)?.add(value_of_graph(graph, *b)?),
        Node::Sub(a, b) => {
            value_of_graph::<F>(graph, *a)?.add(value_of_graph::<F>(graph, *b)?.neg())
        }
        Node::Mul(a, b) => value_of_graph::<F>(graph, *a)?.mul(value_of_graph(graph, *b)?),
        Node::Div(a, b) => {
            value_of_graph::<F>(graph, *a)?.mul(value_of_graph::<F>(graph, *b)?.inverse()?)
        }
        Node::Neg(a) => value_of_graph::<F>(graph, *a)?.neg(),
        Node::Unary(function, a) => {
            let (k, i) = half_multiple(graph, *a);
            let (cos, sin) = F::circle(k, i);
            if *function == Unary::Sin { sin } else { cos }
        }
        other => panic!("not built here: {other:?}"),
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    #[test]
    fn rewrites_keep_the_value_at_points_the_graph_never_saw(tree in tree()) {
        let mut graph = Graph::new();
        let id = build(&mut graph, &tree);
        prop_assume!(graph.singular().is_none());
        if let (Some(direct), Some(shared)) =
            (value_of_tree::<Residue>(&tree), value_of_graph::<Residue>(&graph, id))
        {
            prop_assert_eq!(direct, shared);
        }
    }

    #[test]
    fn forward_and_reverse_derivatives_agree_exactly(tree in tree()) {
        let mut graph = Graph::new();
        let id = build(&mut graph, &tree);
        prop_assume!(graph.singular().is_none());
        let symbols = [0, 1, 2].map(Symbol::Coordinate);
        let one = graph.one();
        let reverse = gradient(&mut graph, &[(id, one)], &symbols);
        for (symbol, from_reverse) in symbols.into_iter().zip(reverse) {
            let forward = Tangent::partial(&graph, symbol).of(&mut graph, id);
            prop_assert_eq!(forward, from_reverse);
        }
    }

    #[test]
    fn derivatives_agree_with_differences(tree in tree()) {
        let mut graph = Graph::new();
        let id = build(&mut graph, &tree);
        prop_assume!(graph.singular().is_none());
        let slope = Tangent::partial(&graph, Symbol::Coordinate(0)).of(&mut graph, id);
        let at = |x: f64| move |s: Symbol| match s {
            Symbol::Coordinate(0) => x,
            Symbol::Coordinate(i) => 0.3 + 0.4 * f64::from(i),
            _ => f64::NAN,
        };
        let value = |x: f64| evaluate(&graph, &[id], &at(x))[0];
        let (x, step) = (0.71, 1e-4);
        let far = (value(x + 2.0 * step) - value(x - 2.0 * step)) / (4.0 * step);
        let near = (value(x + step) - value(x - step)) / (2.0 * step);
        let exact = evaluate(&graph, &[slope], &at(x))[0];
        // Where the two differences disagree the function is too steep for them to judge.
        let scale = 1.0 + exact.abs() + value(x).abs();
        if (far - near).abs() < 1e-6 * scale && scale < 1e4 {
            prop_assert!((near - exact).abs() < 1e-5 * scale, "{near} {exact}");
        }
    }
}

#[test]
fn trigonometric_identities_are_seen() {
    let mut g = Graph::new();
    let (x, y) = (g.symbol(Symbol::Coordinate(0)), g.symbol(Symbol::Coordinate(1)));
    let (sx, cx, sy, cy) = (g.sin(x), g.cos(x), g.sin(y), g.cos(y));
    let squares = [g.mul(sx, sx), g.mul(cx, cx)];
    assert_eq!(g.add(squares[0], squares[1]), g.one());
    let sum = g.add(x, y);
    let direct = g.sin(sum);
    let (left, right) = (g.mul(sx, cy), g.mul(cx, sy));
    assert_eq!(g.add(left, right), direct);
    let half = g.fraction(1, 2);
    let half_x = g.mul(half, x);
    let (s, c) = (g.sin(half_x), g.cos(half_x));
    let product = g.mul(s, c);
    assert_eq!(g.add(product, product), sx);
    let negative = g.neg(x);
    assert_eq!(g.cos(negative), cx);
}

#[test]
fn quarter_turns_are_exact() {
    let mut g = Graph::new();
    let (pi, half) = (g.pi(), g.fraction(1, 2));
    let quarter = g.mul(half, pi);
    assert_eq!((g.sin(quarter), g.cos(quarter)), (g.one(), g.zero()));
    let x = g.symbol(Symbol::Coordinate(0));
    let shifted = g.add(x, quarter);
    let (direct, sine) = (g.cos(shifted), g.sin(x));
    assert_eq!(direct, g.neg(sine));
}

#[test]
fn roots_obey_their_definition() {
    let mut g = Graph::new();
    let x = g.symbol(Symbol::Parameter(0));
    let root = g.unary(Unary::Sqrt, x);
    assert_eq!(g.mul(root, root), x);
    let four = g.integer(4);
    assert_eq!(g.unary(Unary::Sqrt, four), g.integer(2));
}

#[test]
fn division_by_an_identical_zero_is_reported() {
    let mut g = Graph::new();
    let x = g.symbol(Symbol::Coordinate(0));
    let (s, c) = (g.sin(x), g.cos(x));
    let (ss, cc, one) = (g.mul(s, s), g.mul(c, c), g.one());
    let sum = g.add(ss, cc);
    let zero = g.sub(sum, one);
    assert!(g.is_zero(zero));
    assert!(g.singular().is_none());
    g.div(one, zero);
    assert!(g.singular().is_some());
}

#[test]
fn nothing_is_nan_at_the_origin() {
    let mut g = Graph::new();
    let x = g.symbol(Symbol::Coordinate(0));
    let (s, c) = (g.sin(x), g.cos(x));
    let tangent = g.div(s, c);
    let value = g.mul(tangent, s);
    let first = Tangent::partial(&g, Symbol::Coordinate(0)).of(&mut g, value);
    let second = Tangent::partial(&g, Symbol::Coordinate(0)).of(&mut g, first);
    let at_origin = evaluate(&g, &[value, first, second], &|_| 0.0);
    assert_eq!(at_origin, vec![0.0, 0.0, 2.0]);
}
