//! From a graph of binary operations to a system of sums: chains of additions and of multiplications
//! that nothing else uses are taken apart.

use super::system::{Kind, System, Variable};
use crate::normal_form::fixed_image;
use crate::{Graph, Id, Node, Unary, transfer};
use std::collections::HashMap;

/// What to take apart beyond chains that are used once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Policy {
    /// Distribute a product over a sum of up to so many terms that nothing else uses.
    pub(super) distribute: usize,
    /// Copy shared sums of up to so many terms into the sums that use them.
    pub(super) copy: usize,
    /// Keep a shared product as one variable when it has more factors.
    pub(super) factors: usize,
}

/// Terms: coefficient and factors.
type Terms = Vec<(Id, Vec<Variable>)>;

/// A value while it is being taken apart.
enum Form {
    /// Of parameters alone.
    Fixed,
    /// One user takes the terms.
    Open(Terms),
    /// One term: a variable or a product.
    Single(Id, Vec<Variable>),
    /// A shared sum, and its terms if they may be copied.
    Shared(Variable, Terms),
}

/// Takes the values apart.
pub(super) fn flatten(graph: &Graph, ids: &[Id], policy: Policy) -> System {
    let order = crate::needed(graph, ids, |_| false);
    let size = order.last().map_or(0, |id| id.index() + 1);
    let mut flattener = Flattener {
        graph,
        policy,
        uses: uses(graph, &order, ids),
        fixed: vec![None; size],
        forms: (0..size).map(|_| None).collect(),
        system: System::new(Graph::new()),
    };
    for &id in &order {
        let form = flattener.form(id);
        flattener.forms[id.index()] = Some(form);
    }
    flattener.finish(ids)
}

/// How often each value is an operand or wanted; signs are looked through.
fn uses(graph: &Graph, order: &[Id], ids: &[Id]) -> Vec<u32> {
    let mut uses = vec![0; order.last().map_or(0, |id| id.index() + 1)];
    for &id in ids {
        uses[id.index()] += 1;
    }
    for &id in order.iter().rev() {
        let own = match graph.node(id) {
            Node::Neg(_) => uses[id.index()],
            _ => 1,
        };
        for operand in graph.node(id).operands().into_iter().flatten() {
            uses[operand.index()] += own;
        }
    }
    uses
}

struct Flattener<'a> {
    graph: &'a Graph,
    policy: Policy,
    // By index of the value:
    uses: Vec<u32>,
    fixed: Vec<Option<Id>>,
    forms: Vec<Option<Form>>,
    system: System,
}

impl Flattener<'_> {
    fn form(&mut self, id: Id) -> Form {
        if let Some(coefficient) =
            fixed_image(self.graph, &mut self.system.coefficients, |x| self.fixed[x.index()], id)
        {
            self.fixed[id.index()] = Some(coefficient);
            return Form::Fixed;
        }
        match *self.graph.node(id) {
            Node::Add(a, b) => self.sum(id, a, b, false),
            Node::Sub(a, b) => self.sum(id, a, b, true),
            Node::Neg(a) => {
                let terms = self.addends(a, true);
                self.close(id, terms)
            }
            Node::Mul(a, b) => self.product(id, a, b),
            Node::Div(a, b) if let Some(divisor) = self.fixed[b.index()] => {
                let one = self.system.one();
                let inverse = self.system.coefficients.div(one, divisor);
                let terms = self.distributed((inverse, Vec::new()), a, usize::MAX);
                self.close(id, terms)
            }
            Node::Symbol(_) | Node::Unary(Unary::Sin | Unary::Cos, _) => {
                let image = transfer(self.graph, &[id], &mut self.system.coefficients)[0];
                self.single(Kind::Given(image))
            }
            ref node => {
                let node = node.clone();
                let operands: Vec<Id> = node.operands().into_iter().flatten().collect();
                let operands = operands.into_iter().map(|x| self.variable(x)).collect();
                self.single(Kind::Function(node, operands))
            }
        }
    }

    fn single(&mut self, kind: Kind) -> Form {
        let variable = self.system.variable(kind);
        Form::Single(self.system.one(), vec![variable])
    }

    fn sum(&mut self, id: Id, a: Id, b: Id, minus: bool) -> Form {
        let mut terms = self.addends(a, false);
        terms.extend(self.addends(b, minus));
        self.close(id, terms)
    }

    fn product(&mut self, id: Id, a: Id, b: Id) -> Form {
        let terms = match (self.is_sum(a), self.is_sum(b)) {
            (true, false) => {
                let factor = self.factor(b);
                self.distributed(factor, a, self.policy.distribute)
            }
            (false, true) => {
                let factor = self.factor(a);
                self.distributed(factor, b, self.policy.distribute)
            }
            _ => {
                let (x, y) = (self.factor(a), self.factor(b));
                vec![self.times(&x, &y)]
            }
        };
        self.close(id, terms)
    }

    fn is_sum(&self, id: Id) -> bool {
        matches!(&self.forms[id.index()], Some(Form::Open(_)))
    }

    /// A factor times a sum, over which it is distributed if that has few enough terms.
    fn distributed(&mut self, factor: (Id, Vec<Variable>), sum: Id, limit: usize) -> Terms {
        let few =
            matches!(&self.forms[sum.index()], Some(Form::Open(terms)) if terms.len() <= limit);
        if few {
            let terms = self.addends(sum, false);
            return terms.iter().map(|term| self.times(&factor, term)).collect();
        }
        let other = self.factor(sum);
        vec![self.times(&factor, &other)]
    }

    fn times(&mut self, x: &(Id, Vec<Variable>), y: &(Id, Vec<Variable>)) -> (Id, Vec<Variable>) {
        let coefficient = self.system.coefficients.mul(x.0, y.0);
        let mut factors = [x.1.as_slice(), y.1.as_slice()].concat();
        factors.sort_unstable();
        (coefficient, factors)
    }

    /// Keeps what is shared as a variable.
    fn close(&mut self, id: Id, mut terms: Terms) -> Form {
        let shared = self.uses[id.index()] > 1;
        match terms.len() {
            1 => {
                let (coefficient, factors) = terms.remove(0);
                if shared && factors.len() > self.policy.factors {
                    let variable = self.system.sum(vec![(self.system.one(), factors)]);
                    return Form::Single(coefficient, vec![variable]);
                }
                Form::Single(coefficient, factors)
            }
            count if shared => {
                let copied = if count <= self.policy.copy { terms.clone() } else { Vec::new() };
                Form::Shared(self.system.sum(terms), copied)
            }
            _ => Form::Open(terms),
        }
    }

    /// A value as terms of the sum that uses it.
    fn addends(&mut self, id: Id, minus: bool) -> Terms {
        let mut terms = match &mut self.forms[id.index()] {
            Some(Form::Open(terms)) => std::mem::take(terms),
            Some(Form::Shared(_, copied)) if !copied.is_empty() => copied.clone(),
            _ => vec![self.factor(id)],
        };
        if minus {
            for term in &mut terms {
                term.0 = self.system.coefficients.neg(term.0);
            }
        }
        terms
    }

    /// A value as one term.
    fn factor(&mut self, id: Id) -> (Id, Vec<Variable>) {
        let one = self.system.one();
        match &mut self.forms[id.index()] {
            Some(Form::Single(coefficient, factors)) => (*coefficient, factors.clone()),
            Some(Form::Shared(variable, _)) => (one, vec![*variable]),
            Some(Form::Open(terms)) => {
                let terms = std::mem::take(terms);
                let variable = self.system.sum(terms);
                self.forms[id.index()] = Some(Form::Shared(variable, Vec::new()));
                (one, vec![variable])
            }
            Some(Form::Fixed) | None => (self.fixed[id.index()].unwrap_or(one), Vec::new()),
        }
    }

    /// A value as a variable.
    fn variable(&mut self, id: Id) -> Variable {
        let (coefficient, factors) = self.factor(id);
        match factors.as_slice() {
            &[variable] if coefficient == self.system.one() => variable,
            _ => self.system.sum(vec![(coefficient, factors)]),
        }
    }

    fn finish(mut self, ids: &[Id]) -> System {
        let mut roots: HashMap<Id, Variable> = HashMap::new();
        for &id in ids {
            let root = match roots.get(&id) {
                Some(&root) => root,
                None => self.root(id),
            };
            roots.insert(id, root);
            self.system.roots.push(root);
            self.system.uses[root as usize] += 1;
        }
        self.system
    }

    fn root(&mut self, id: Id) -> Variable {
        if let Some(Form::Shared(variable, _)) = &self.forms[id.index()] {
            return *variable;
        }
        let terms = self.addends(id, false);
        self.system.sum(terms)
    }
}
