//! What a body computes in which order, and which of its values get a name.
//!
//! A value is named if it is used more than once, labelled by the derivation, a result, or too long to
//! stand inside its user; every other value is written where it is used. Each operation of the graph
//! therefore appears exactly once in the text.

use super::names::SymbolNames;
use shapebot_symbolic::{Graph, Id, Node, Symbol, Unary, nearest, needed};

/// An expression that would be longer than this is split.
const LONGEST: usize = 150;

/// Width that a named value is reckoned with.
const NAME_WIDTH: usize = 14;

/// A value that stands ready before the body starts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Given {
    /// The value is the negative of `leaf`.
    pub(super) negative: bool,
    /// Where it stands.
    pub(super) leaf: Leaf,
}

/// Where a ready value stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Leaf {
    /// A literal, not negative.
    Number(f64),
    /// π.
    Pi,
    /// An input of the body.
    Symbol(Symbol),
    /// A field of the robot, computed by its constructor; whether its name tells its content.
    Field(String, bool),
}

impl Leaf {
    /// A literal with its sign.
    pub(super) fn number(value: f64) -> Given {
        Given {
            negative: value.is_sign_negative() && value != 0.0,
            leaf: Self::Number(value.abs()),
        }
    }
}

/// A result of a body.
#[derive(Clone, Debug)]
pub(super) struct Root {
    /// The value.
    pub(super) id: Id,
    /// What to call it.
    pub(super) name: String,
    /// The block that it belongs to.
    pub(super) block: usize,
}

/// The results that a value contributes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    /// None yet.
    Nothing,
    /// One entry.
    Entry(usize),
    /// Several entries of one block.
    Block(usize),
    /// Several blocks.
    Everything,
}

/// One step of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Bind a value to a name.
    Value(Id),
    /// Bind sine and cosine of an angle.
    Angle(Id),
}

/// The plan of one body. All lists are indexed by [`Id::index`].
pub(super) struct Plan<'a> {
    pub(super) graph: &'a Graph,
    given: &'a [Option<Given>],
    symbols: &'a SymbolNames,
    /// How often a value appears in the text.
    pub(super) uses: Vec<u32>,
    /// Whether it gets a name.
    pub(super) bound: Vec<bool>,
    /// What it contributes to.
    pub(super) reach: Vec<Reach>,
    /// Sine and cosine nodes of an angle.
    pub(super) circular: Vec<[Option<Id>; 2]>,
    width: Vec<usize>,
}

impl<'a> Plan<'a> {
    /// Plans a body; `named` says whether results get a name of their own.
    pub(super) fn new(
        graph: &'a Graph,
        roots: &[Root],
        given: &'a [Option<Given>],
        symbols: &'a SymbolNames,
        named: bool,
    ) -> Self {
        let size = graph.len();
        let mut plan = Self {
            graph,
            given,
            symbols,
            uses: vec![0; size],
            bound: vec![false; size],
            reach: vec![Reach::Nothing; size],
            circular: vec![[None; 2]; size],
            width: vec![0; size],
        };
        let ids: Vec<Id> = roots.iter().map(|root| root.id).collect();
        let order = needed(graph, &ids, |id| plan.is_given(id));
        plan.count_uses(&order, roots);
        plan.spread(&order, roots);
        plan.choose_names(&order, roots, named);
        plan
    }

    /// Local name of a symbol.
    pub(super) fn name_of(&self, symbol: Symbol) -> &str {
        self.symbols.of(symbol)
    }

    fn is_given(&self, id: Id) -> bool {
        self.given.get(id.index()).is_some_and(Option::is_some)
    }

    /// The value's leaf, if it is one.
    pub(super) fn leaf(&self, id: Id) -> Option<Given> {
        if let Some(Some(given)) = self.given.get(id.index()) {
            return Some(given.clone());
        }
        let leaf = match self.graph.node(id) {
            Node::Constant(value) => return Some(Leaf::number(nearest(value))),
            Node::Pi => Leaf::Pi,
            Node::Symbol(symbol) => Leaf::Symbol(*symbol),
            _ => return None,
        };
        Some(Given { negative: false, leaf })
    }

    fn is_leaf(&self, id: Id) -> bool {
        self.is_given(id)
            || matches!(self.graph.node(id), Node::Constant(_) | Node::Pi | Node::Symbol(_))
    }

    /// The value without changes of sign, and whether their number is odd.
    pub(super) fn strip(&self, mut id: Id) -> (bool, Id) {
        let mut negative = false;
        while !self.is_leaf(id) {
            let Node::Neg(inner) = *self.graph.node(id) else { break };
            negative = !negative;
            id = inner;
        }
        (negative, id)
    }

    /// Operands without changes of sign. Sine and cosine of one angle are one use of it.
    fn operands(&self, id: Id) -> impl Iterator<Item = Id> + '_ {
        self.graph.node(id).operands().into_iter().flatten().map(|operand| self.strip(operand).1)
    }

    /// The angle of a sine or cosine.
    pub(super) fn angle_of(&self, id: Id) -> Option<Id> {
        match *self.graph.node(id) {
            Node::Unary(Unary::Sin | Unary::Cos, angle) if !self.is_given(id) => Some(angle),
            _ => None,
        }
    }

    fn count_uses(&mut self, order: &[Id], roots: &[Root]) {
        for &id in order {
            if self.is_leaf(id) || matches!(self.graph.node(id), Node::Neg(_)) {
                continue;
            }
            if let Node::Unary(function @ (Unary::Sin | Unary::Cos), angle) = *self.graph.node(id) {
                let pair = &mut self.circular[angle.index()];
                let first = *pair == [None; 2];
                pair[usize::from(function == Unary::Cos)] = Some(id);
                if !first {
                    continue;
                }
            }
            let operands: Vec<Id> = self.operands(id).collect();
            for operand in operands {
                self.uses[operand.index()] += 1;
            }
        }
        for root in roots {
            let (_, id) = self.strip(root.id);
            self.uses[id.index()] += 1;
        }
    }

    /// From the results down: what each value contributes to.
    fn spread(&mut self, order: &[Id], roots: &[Root]) {
        for (entry, root) in roots.iter().enumerate() {
            let reach = &mut self.reach[root.id.index()];
            *reach = merge(*reach, Reach::Entry(entry), roots);
        }
        for &id in order.iter().rev() {
            let from = self.reach[id.index()];
            for operand in self.graph.node(id).operands().into_iter().flatten() {
                let reach = &mut self.reach[operand.index()];
                *reach = merge(*reach, from, roots);
            }
        }
    }

    fn choose_names(&mut self, order: &[Id], roots: &[Root], named: bool) {
        for root in roots {
            let (negative, id) = self.strip(root.id);
            if named && !negative && !self.is_leaf(id) {
                self.bound[id.index()] = true;
            }
        }
        let only = if named { None } else { roots.first().map(|root| root.id) };
        for &id in order {
            let i = id.index();
            if self.is_leaf(id) || matches!(self.graph.node(id), Node::Neg(_)) {
                continue;
            }
            let shared = self.uses[i] > 1;
            let labelled = self.graph.label_of(id).is_some() && only != Some(id);
            self.bound[i] |= shared || labelled || self.angle_of(id).is_some();
            self.width[i] = self.fit(id);
        }
    }

    /// Width of a value's expression, after naming operands that would make it too long.
    fn fit(&mut self, id: Id) -> usize {
        let operands: Vec<Id> = self.operands(id).collect();
        loop {
            let widths: Vec<usize> =
                operands.iter().map(|&operand| self.shown_width(operand)).collect();
            let total = widths.iter().sum::<usize>() + 5;
            let widest = (0..operands.len()).max_by_key(|&k| (widths[k], std::cmp::Reverse(k)));
            match widest {
                Some(k)
                    if total > LONGEST
                        && !self.is_leaf(operands[k])
                        && !self.bound[operands[k].index()] =>
                {
                    self.bound[operands[k].index()] = true;
                }
                _ => return total,
            }
        }
    }

    fn shown_width(&self, id: Id) -> usize {
        match self.leaf(id) {
            Some(Given { leaf: Leaf::Field(name, _), .. }) => name.len() + 5,
            Some(Given { leaf: Leaf::Symbol(symbol), .. }) => self.symbols.of(symbol).len(),
            Some(_) => 7,
            None if self.bound[id.index()] => NAME_WIDTH,
            None => self.width[id.index()],
        }
    }

    /// The steps in order: plain angles first, then each value right after what it needs.
    pub(super) fn steps(&self, roots: &[Root]) -> Vec<Step> {
        let mut walk = Walk { plan: self, seen: vec![false; self.graph.len()], steps: Vec::new() };
        for pair in &self.circular {
            let Some(first) = pair[0].or(pair[1]) else { continue };
            if let Some(angle) = self.angle_of(first)
                && self.is_leaf(self.strip(angle).1)
            {
                walk.seen[first.index()] = true;
                walk.steps.push(Step::Angle(angle));
            }
        }
        for root in roots {
            walk.visit(root.id);
        }
        walk.steps
    }
}

struct Walk<'p, 'a> {
    plan: &'p Plan<'a>,
    seen: Vec<bool>,
    steps: Vec<Step>,
}

impl Walk<'_, '_> {
    /// Depth first without recursion: graphs are deeper than stacks.
    fn visit(&mut self, root: Id) {
        let plan = self.plan;
        let mut stack = vec![(root, None)];
        while let Some((id, done)) = stack.pop() {
            if let Some(step) = done {
                self.steps.push(step);
                continue;
            }
            let (_, id) = plan.strip(id);
            if plan.is_leaf(id) {
                continue;
            }
            // Sine and cosine are one step, marked by the first of the two nodes.
            let (key, step) = match plan.angle_of(id) {
                Some(angle) => {
                    let [sine, cosine] = plan.circular[angle.index()];
                    (sine.or(cosine).unwrap_or(id), Some(Step::Angle(angle)))
                }
                None => (id, plan.bound[id.index()].then_some(Step::Value(id))),
            };
            if std::mem::replace(&mut self.seen[key.index()], true) {
                continue;
            }
            if step.is_some() {
                stack.push((id, step));
            }
            let operands = plan.graph.node(id).operands();
            stack.extend(operands.into_iter().rev().flatten().map(|operand| (operand, None)));
        }
    }
}

fn merge(a: Reach, b: Reach, roots: &[Root]) -> Reach {
    let block = |reach| match reach {
        Reach::Entry(entry) => Some(roots[entry].block),
        Reach::Block(block) => Some(block),
        _ => None,
    };
    match (a, b) {
        (Reach::Nothing, other) | (other, Reach::Nothing) => other,
        (a, b) if a == b => a,
        (a, b) => match (block(a), block(b)) {
            (Some(x), Some(y)) if x == y => Reach::Block(x),
            _ => Reach::Everything,
        },
    }
}
