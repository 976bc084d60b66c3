//! Binding times: what depends on parameters alone is computed once, by the constructor.

use super::content::{Content, composed};
use super::names::{Names, SymbolNames};
use super::plan::{Given, Leaf, Plan, Root};
use crate::derive::{Function, Quantity};
use shapebot_symbolic::{Graph, Id, Node, Symbol, evaluate, transfer};
use std::collections::BTreeMap;

/// Values of parameters alone, shared by all functions of a robot.
pub(super) struct Hoisted {
    /// Their graph.
    pub(super) graph: Graph,
    /// The fields, as results of the constructor.
    pub(super) fields: Vec<Root>,
    /// Ready values of each function.
    pub(super) given: BTreeMap<Quantity, Vec<Option<Given>>>,
}

/// Collects the values of all functions; `name_of` gives the stem of names that tell nothing better.
pub(super) fn hoist(
    functions: &BTreeMap<Quantity, Function>,
    symbols: &SymbolNames,
    name_of: &dyn Fn(Quantity) -> String,
) -> Hoisted {
    let mut graph = Graph::new();
    let mut images: BTreeMap<Quantity, Vec<(Id, Id)>> = BTreeMap::new();
    let mut stems: BTreeMap<Id, String> = BTreeMap::new();
    for (&quantity, function) in functions {
        let wanted = frontier(function);
        let moved = transfer(&function.graph, &wanted, &mut graph);
        for &image in &moved {
            stems.entry(strip(&graph, image).1).or_insert_with(|| name_of(quantity));
        }
        images.insert(quantity, wanted.into_iter().zip(moved).collect());
    }
    stems
        .retain(|&id, _| !matches!(graph.node(id), Node::Constant(_) | Node::Pi | Node::Symbol(_)));
    let (fields, told) = name_fields(&graph, &stems, symbols);
    let mut leaves: BTreeMap<Id, Leaf> = BTreeMap::new();
    for root in &fields {
        leaves.insert(root.id, Leaf::Field(root.name.clone(), told.contains_key(&root.id)));
    }
    let given = images
        .into_iter()
        .map(|(quantity, images)| {
            let size = functions.get(&quantity).map_or(0, |function| function.graph.len());
            (quantity, table(size, images, &graph, &leaves))
        })
        .collect();
    Hoisted { graph, fields, given }
}

/// Ready values of a function whose parameters are numbers: its constants beyond the rationals.
pub(super) fn baked(function: &Function) -> Vec<Option<Given>> {
    let wanted = frontier(function);
    let values = evaluate(&function.graph, &wanted, &|_| f64::NAN);
    let mut given = vec![None; function.graph.len()];
    for (id, value) in wanted.into_iter().zip(values) {
        given[id.index()] = Some(Leaf::number(value));
    }
    given
}

/// Composed values of parameters alone that something else uses.
fn frontier(function: &Function) -> Vec<Id> {
    let results = function.results();
    let order = shapebot_symbolic::needed(&function.graph, &results, |_| false);
    let mut fixed = vec![false; function.graph.len()];
    let mut wanted = vec![false; function.graph.len()];
    for &id in &order {
        let node = function.graph.node(id);
        fixed[id.index()] = match node {
            Node::Constant(_) | Node::Pi | Node::Symbol(Symbol::Parameter(_)) => true,
            Node::Symbol(_) => false,
            node => node.operands().into_iter().flatten().all(|x| fixed[x.index()]),
        };
        if !fixed[id.index()] {
            for operand in node.operands().into_iter().flatten() {
                wanted[operand.index()] |= fixed[operand.index()];
            }
        }
    }
    for id in results {
        wanted[id.index()] |= fixed[id.index()];
    }
    let composed = |id: &Id| {
        wanted[id.index()]
            && !matches!(function.graph.node(*id), Node::Constant(_) | Node::Pi | Node::Symbol(_))
    };
    order.into_iter().filter(composed).collect()
}

fn strip(graph: &Graph, mut id: Id) -> (bool, Id) {
    let mut negative = false;
    while let Node::Neg(inner) = *graph.node(id) {
        negative = !negative;
        id = inner;
    }
    (negative, id)
}

fn table(
    size: usize,
    images: Vec<(Id, Id)>,
    graph: &Graph,
    leaves: &BTreeMap<Id, Leaf>,
) -> Vec<Option<Given>> {
    let mut given = vec![None; size];
    for (id, image) in images {
        let (negative, image) = strip(graph, image);
        let leaf = match graph.node(image) {
            Node::Constant(value) => {
                let value = shapebot_symbolic::nearest(value);
                given[id.index()] = Some(Leaf::number(if negative { -value } else { value }));
                continue;
            }
            Node::Pi => Leaf::Pi,
            Node::Symbol(symbol) => Leaf::Symbol(*symbol),
            _ => match leaves.get(&image) {
                Some(leaf) => leaf.clone(),
                None => continue,
            },
        };
        given[id.index()] = Some(Given { negative, leaf });
    }
    given
}

/// Names the fields; also says which names tell their content.
fn name_fields(
    graph: &Graph,
    stems: &BTreeMap<Id, String>,
    symbols: &SymbolNames,
) -> (Vec<Root>, BTreeMap<Id, Content>) {
    let nothing = vec![None; graph.len()];
    let plan = Plan::new(graph, &[], &nothing, symbols, true);
    let mut names = symbols.taken.clone();
    let mut told: BTreeMap<Id, Content> = BTreeMap::new();
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    let mut fields = Vec::new();
    for (&id, stem) in stems {
        let known = |x: Id| stems.contains_key(&x).then(|| told.get(&x).cloned());
        let telling = match graph.label_of(id) {
            Some(label) => Some(label.to_owned()),
            None => composed(&plan, id, &known).map(|content| content.text),
        };
        let name = match telling {
            Some(text) => {
                let name = names.take(&text);
                told.extend(Content::atom(name.clone()).map(|content| (id, content)));
                name
            }
            None => numbered(&mut names, &mut numbers, stem),
        };
        fields.push(Root { id, name, block: 0 });
    }
    (fields, told)
}

fn numbered<'s>(
    names: &mut Names,
    numbers: &mut BTreeMap<&'s str, usize>,
    stem: &'s str,
) -> String {
    names.number(&format!("{stem}_constant"), numbers.entry(stem).or_insert(0))
}
