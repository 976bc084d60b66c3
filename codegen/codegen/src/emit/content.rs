//! Names that tell what a value is: `sin_phi_x_cos_phi_y`, `omega_body_x_squared`.

use super::plan::{Given, Leaf, Plan};
use shapebot_symbolic::{Id, Node, Unary};

/// Longer names are not easier to read than a number.
const LONGEST: usize = 32;

/// How tightly a name's parts hang together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// `phi_x`, `sin_phi_x`, `omega_squared`
    Atom,
    /// `r_w_sin_phi_x`
    Product,
    /// `I_w_plus_m_w`
    Sum,
}

/// A name in the making.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Content {
    pub(super) text: String,
    pub(super) kind: Kind,
}

impl Content {
    pub(super) fn atom(text: impl Into<String>) -> Option<Self> {
        Some(Self { text: text.into(), kind: Kind::Atom })
    }

    fn new(text: String, kind: Kind) -> Option<Self> {
        (text.len() <= LONGEST).then_some(Self { text, kind })
    }
}

/// The name of a value from its operands' names; `known` gives those of named values.
pub(super) fn content(
    plan: &Plan<'_>,
    id: Id,
    known: &dyn Fn(Id) -> Option<Option<Content>>,
) -> Option<Content> {
    if let Some(given) = plan.leaf(id) {
        return leaf(plan, &given);
    }
    match known(id) {
        Some(content) => content,
        None => composed(plan, id, known),
    }
}

fn leaf(plan: &Plan<'_>, given: &Given) -> Option<Content> {
    match &given.leaf {
        _ if given.negative => None,
        Leaf::Symbol(symbol) => Content::atom(plan.name_of(*symbol)),
        Leaf::Field(name, true) => Content::atom(name.clone()),
        Leaf::Field(_, false) | Leaf::Number(_) | Leaf::Pi => None,
    }
}

/// The same without asking whether the value itself has a name.
pub(super) fn composed(
    plan: &Plan<'_>,
    id: Id,
    known: &dyn Fn(Id) -> Option<Option<Content>>,
) -> Option<Content> {
    let of = |id| content(plan, id, known);
    let number = |id| match plan.leaf(id) {
        Some(Given { negative: false, leaf: Leaf::Number(value) }) => word(value),
        _ => None,
    };
    match *plan.graph.node(id) {
        Node::Mul(a, b) if a == b => power(&of(a)?),
        Node::Mul(a, b) => match number(a) {
            Some(word) => scaled(word, &of(b)?),
            None => product(&of(a)?, &of(b)?),
        },
        Node::Div(a, b) => joined(&of(a)?, "over", &of(b)?, Kind::Product),
        Node::Add(a, b) if a == b => scaled("two", &of(a)?),
        Node::Add(a, b) => match (number(a), number(b)) {
            (Some("one"), _) => joined(&Content::atom("one")?, "plus", &of(b)?, Kind::Sum),
            (_, Some("one")) => joined(&of(a)?, "plus", &Content::atom("one")?, Kind::Sum),
            _ => joined(&of(a)?, "plus", &of(b)?, Kind::Sum),
        },
        Node::Sub(a, b) => match number(a) {
            Some("one") => joined(&Content::atom("one")?, "minus", &of(b)?, Kind::Sum),
            _ => joined(&of(a)?, "minus", &of(b)?, Kind::Sum),
        },
        Node::Unary(function, a) => applied(function, &of(a)?),
        _ => None,
    }
}

fn word(value: f64) -> Option<&'static str> {
    let words: [(f64, &str); 4] = [(0.5, "half"), (1.0, "one"), (2.0, "two"), (4.0, "four")];
    words.iter().find(|(number, _)| (number - value).abs() == 0.0).map(|(_, word)| *word)
}

fn power(base: &Content) -> Option<Content> {
    let square = base.kind == Kind::Atom && !base.text.ends_with("_squared");
    square.then(|| Content::new(format!("{}_squared", base.text), Kind::Atom))?
}

fn scaled(word: &str, value: &Content) -> Option<Content> {
    if word == "one" || value.kind == Kind::Sum {
        return None;
    }
    Content::new(format!("{word}_{}", value.text), Kind::Product)
}

fn product(a: &Content, b: &Content) -> Option<Content> {
    if a.kind == Kind::Sum || b.kind == Kind::Sum {
        return None;
    }
    Content::new(format!("{}_{}", a.text, b.text), Kind::Product)
}

fn joined(a: &Content, word: &str, b: &Content, kind: Kind) -> Option<Content> {
    let tight = if kind == Kind::Sum { Kind::Product } else { Kind::Atom };
    if a.kind > Kind::Product || b.kind > tight {
        return None;
    }
    Content::new(format!("{}_{word}_{}", a.text, b.text), kind)
}

fn applied(function: Unary, x: &Content) -> Option<Content> {
    let name = match function {
        Unary::Sin | Unary::Cos => return None,
        Unary::Sqrt => "sqrt",
        Unary::Exp => "exp",
        Unary::Ln => "ln",
        Unary::Asin => "asin",
        Unary::Acos => "acos",
        Unary::Atan => "atan",
    };
    let whole = x.kind == Kind::Atom;
    whole.then(|| Content::new(format!("{name}_{}", x.text), Kind::Atom))?
}
