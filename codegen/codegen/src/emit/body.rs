//! From a planned graph to statements.

use super::content::{Content, composed, content};
use super::names::{Names, SymbolNames};
use super::plan::{Given, Leaf, Plan, Reach, Root, Step};
use super::syntax;
use shapebot_symbolic::{Graph, Id, Node, Symbol, Unary};
use std::collections::{BTreeMap, BTreeSet};
use syn::{BinOp, Expr, Stmt};

/// What a body is made from.
pub(super) struct Request<'a> {
    pub(super) graph: &'a Graph,
    pub(super) roots: &'a [Root],
    /// Names of the blocks that roots belong to.
    pub(super) blocks: &'a [String],
    /// Values that stand ready, by [`Id::index`].
    pub(super) given: &'a [Option<Given>],
    pub(super) symbols: &'a SymbolNames,
    /// Whether results get names; a single scalar does not.
    pub(super) named: bool,
    /// The place in the model that a label speaks of.
    pub(super) source: &'a dyn Fn(&str) -> Option<String>,
}

/// A straight-line body.
pub(super) struct Body {
    pub(super) statements: Vec<Stmt>,
    /// One expression per root.
    pub(super) results: Vec<Expr>,
    /// Symbols that the text mentions.
    pub(super) used: BTreeSet<Symbol>,
    /// How often the text mentions the helper `c`.
    pub(super) constants: usize,
}

/// Writes a body.
pub(super) fn body(request: &Request<'_>) -> Body {
    let plan =
        Plan::new(request.graph, request.roots, request.given, request.symbols, request.named);
    let steps = plan.steps(request.roots);
    let mut writer = Writer {
        request,
        names: request.symbols.taken.clone(),
        variables: vec![None; request.graph.len()],
        contents: vec![None; request.graph.len()],
        preferred: preferred(&plan, request),
        numbers: BTreeMap::new(),
        place: None,
        plan,
        body: Body {
            statements: Vec::new(),
            results: Vec::new(),
            used: BTreeSet::new(),
            constants: 0,
        },
    };
    for step in steps {
        match step {
            Step::Value(id) => writer.bind_value(id),
            Step::Angle(angle) => writer.bind_angle(angle),
        }
    }
    let results = request.roots.iter().map(|root| writer.result(root)).collect();
    writer.body.results = results;
    writer.body
}

/// Names that results ask for; a value that is several results takes the first's.
fn preferred(plan: &Plan<'_>, request: &Request<'_>) -> BTreeMap<Id, String> {
    let mut names = BTreeMap::new();
    for root in request.roots.iter().filter(|_| request.named) {
        if let (false, id) = plan.strip(root.id) {
            names.entry(id).or_insert_with(|| root.name.clone());
        }
    }
    names
}

struct Writer<'a, 'r> {
    request: &'r Request<'a>,
    plan: Plan<'r>,
    names: Names,
    /// Names of bound values.
    variables: Vec<Option<String>>,
    /// What those names tell: `None` not bound, `Some(None)` nothing.
    contents: Vec<Option<Option<Content>>>,
    preferred: BTreeMap<Id, String>,
    /// Last number given out per role.
    numbers: BTreeMap<String, usize>,
    /// The last source comment.
    place: Option<String>,
    body: Body,
}

impl Writer<'_, '_> {
    fn bind_value(&mut self, id: Id) {
        let label = self.plan.graph.label_of(id);
        if let Some(place) = label.and_then(|label| (self.request.source)(label))
            && self.place.as_ref() != Some(&place)
        {
            self.body.statements.push(syntax::comment(&place));
            self.place = Some(place);
        }
        let value = self.operation(id);
        let value = signed(value);
        let (name, told) = self.choose_name(id);
        self.body.statements.push(syntax::binding(syntax::pattern(Some(&name)), value));
        self.set(id, name, told);
    }

    fn set(&mut self, id: Id, name: String, told: bool) {
        self.contents[id.index()] = Some(told.then(|| Content::atom(name.clone())).flatten());
        self.variables[id.index()] = Some(name);
    }

    /// The name of a value, and whether it tells the content.
    fn choose_name(&mut self, id: Id) -> (String, bool) {
        if let Some(name) = self.preferred.get(&id) {
            return (self.names.take(name), true);
        }
        if let Some(label) = self.plan.graph.label_of(id) {
            return (self.names.take(label), true);
        }
        let known = |id: Id| self.contents[id.index()].clone();
        if let Some(content) = composed(&self.plan, id, &known) {
            return (self.names.take(&content.text), true);
        }
        let role = match self.plan.reach[id.index()] {
            Reach::Entry(entry) => format!("{}_term", self.request.roots[entry].name),
            Reach::Block(block) => format!("{}_term", self.request.blocks[block]),
            Reach::Nothing | Reach::Everything => "shared_term".to_owned(),
        };
        (self.numbered(role), false)
    }

    fn numbered(&mut self, role: String) -> String {
        let last = self.numbers.entry(role.clone()).or_insert(0);
        self.names.number(&role, last)
    }

    fn bind_angle(&mut self, angle: Id) {
        let argument = self.value(angle);
        let known = |id: Id| self.contents[id.index()].clone();
        let (negative, id) = self.plan.strip(angle);
        let name = match content(&self.plan, id, &known) {
            Some(content) if !negative => content.text,
            _ => self.numbered("angle".to_owned()),
        };
        let pair = self.plan.circular[angle.index()];
        let mut patterns = Vec::new();
        for (node, prefix) in pair.into_iter().zip(["sin", "cos"]) {
            let variable = node.map(|node| {
                let variable = self.names.take(&format!("{prefix}_{name}"));
                self.set(node, variable.clone(), true);
                variable
            });
            patterns.push(syntax::pattern(variable.as_deref()));
        }
        let value = syntax::method(argument, "sin_cos", []);
        self.body.statements.push(syntax::binding(syntax::tuple_pattern(patterns), value));
    }

    /// A result; the negative of a value that has no name is named here.
    fn result(&mut self, root: &Root) -> Expr {
        let (_, id) = self.plan.strip(root.id);
        let value = self.value(root.id);
        if !self.request.named
            || self.plan.leaf(id).is_some()
            || self.variables[id.index()].is_some()
        {
            return value;
        }
        let name = self.names.take(&root.name);
        self.body.statements.push(syntax::binding(syntax::pattern(Some(&name)), value));
        syntax::variable(&name)
    }

    /// The value with its sign.
    fn value(&mut self, id: Id) -> Expr {
        let value = self.magnitude(id);
        signed(value)
    }

    /// (whether the value is the negative of the expression, the expression).
    fn magnitude(&mut self, id: Id) -> (bool, Expr) {
        let (outer, id) = self.plan.strip(id);
        let (inner, value) = if let Some(given) = self.plan.leaf(id) {
            self.leaf(given)
        } else if let Some(name) = &self.variables[id.index()] {
            (false, syntax::variable(name))
        } else {
            self.operation(id)
        };
        (outer != inner, value)
    }

    fn leaf(&mut self, given: Given) -> (bool, Expr) {
        let value = match given.leaf {
            Leaf::Symbol(symbol) => {
                self.body.used.insert(symbol);
                syntax::variable(self.request.symbols.of(symbol))
            }
            Leaf::Field(name, _) => syntax::field(syntax::variable("self"), &name),
            Leaf::Number(number) => {
                self.body.constants += 1;
                syntax::call("c", syntax::number(number))
            }
            Leaf::Pi => {
                self.body.constants += 1;
                syntax::call("c", syntax::pi())
            }
        };
        (given.negative, value)
    }

    /// The operation that computes a value; changes of sign move out of products into sums.
    fn operation(&mut self, id: Id) -> (bool, Expr) {
        match *self.plan.graph.node(id) {
            Node::Add(a, b) => {
                let (a, b) = (self.magnitude(a), self.magnitude(b));
                sum(a, b)
            }
            Node::Sub(a, b) => {
                let (a, (negative, b)) = (self.magnitude(a), self.magnitude(b));
                sum(a, (!negative, b))
            }
            Node::Mul(a, b) => self.product(a, syntax::mul(), b),
            Node::Div(a, b) => self.product(a, syntax::div(), b),
            Node::Unary(function, a) => {
                let argument = self.value(a);
                (false, syntax::method(argument, method_of(function), []))
            }
            Node::Atan2(y, x) => {
                let (y, x) = (self.value(y), self.value(x));
                (false, syntax::method(y, "atan2", [x]))
            }
            // Leaves and changes of sign never get here.
            Node::Neg(_) | Node::Constant(_) | Node::Pi | Node::Symbol(_) => {
                (false, syntax::variable("undefined"))
            }
        }
    }

    fn product(&mut self, a: Id, op: BinOp, b: Id) -> (bool, Expr) {
        let ((left, a), (right, b)) = (self.magnitude(a), self.magnitude(b));
        (left != right, syntax::binary(a, op, b))
    }
}

fn sum((left, a): (bool, Expr), (right, b): (bool, Expr)) -> (bool, Expr) {
    match (left, right) {
        (false, false) => (false, syntax::binary(a, syntax::add(), b)),
        (false, true) => (false, syntax::binary(a, syntax::sub(), b)),
        (true, false) => (false, syntax::binary(b, syntax::sub(), a)),
        (true, true) => (true, syntax::binary(a, syntax::add(), b)),
    }
}

fn signed((negative, value): (bool, Expr)) -> Expr {
    if negative { syntax::negative(value) } else { value }
}

/// Method of `Real`.
fn method_of(function: Unary) -> &'static str {
    match function {
        Unary::Sqrt => "sqrt",
        Unary::Exp => "exp",
        Unary::Ln => "ln",
        Unary::Asin => "asin",
        Unary::Acos => "acos",
        Unary::Atan => "atan",
        // Always bound as a pair.
        Unary::Sin | Unary::Cos => "sin_cos",
    }
}
