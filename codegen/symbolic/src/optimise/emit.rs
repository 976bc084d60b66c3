//! From a system of sums back to a graph of binary operations.

use super::system::{Kind, System, Variable};
use crate::normal_form::{Atom, Polynomials};
use crate::{Graph, Id, Node, transfer};
use num_traits::Signed;

/// Builds the values of a system's roots. `None` if the system refers to itself in a circle.
pub(super) fn emit(system: &System) -> Option<(Graph, Vec<Id>)> {
    let mut emitter = Emitter {
        system,
        graph: Graph::new(),
        images: vec![None; system.kinds.len()],
        coefficients: vec![None; system.coefficients.len()],
    };
    emitter.run()?;
    let ids =
        system.roots.iter().map(|&root| emitter.images[root as usize]).collect::<Option<_>>()?;
    Some((emitter.graph, ids))
}

struct Emitter<'a> {
    system: &'a System,
    graph: Graph,
    images: Vec<Option<Id>>,
    coefficients: Vec<Option<Id>>,
}

impl Emitter<'_> {
    /// Depth first, without recursion: chains can be long.
    fn run(&mut self) -> Option<()> {
        // Angles first, so that they keep their form.
        for index in 0..self.images.len() {
            if matches!(self.system.kinds[index], Kind::Given(_)) {
                self.images[index] = self.value(index as Variable);
            }
        }
        let mut open = vec![false; self.images.len()];
        let mut stack: Vec<Variable> = self.system.roots.iter().rev().copied().collect();
        while let Some(&variable) = stack.last() {
            let index = variable as usize;
            if self.images[index].is_some() {
                stack.pop();
                continue;
            }
            let missing = self.missing(variable);
            if missing.is_empty() {
                self.images[index] = Some(self.value(variable)?);
                stack.pop();
            } else if open[index] {
                return None;
            } else {
                open[index] = true;
                stack.extend(missing.into_iter().rev());
            }
        }
        Some(())
    }

    fn missing(&self, variable: Variable) -> Vec<Variable> {
        let is_missing = |x: &Variable| self.images[*x as usize].is_none();
        match &self.system.kinds[variable as usize] {
            Kind::Given(_) => Vec::new(),
            Kind::Function(_, operands) => operands.iter().copied().filter(is_missing).collect(),
            Kind::Sum(terms) => {
                let factors = terms.iter().flat_map(|&t| &self.system.term(t).factors);
                factors.copied().filter(is_missing).collect()
            }
        }
    }

    fn value(&mut self, variable: Variable) -> Option<Id> {
        let system = self.system;
        match &system.kinds[variable as usize] {
            Kind::Given(id) => Some(self.coefficient(*id)),
            Kind::Function(node, operands) => {
                let x = self.images[operands[0] as usize]?;
                let y = operands.get(1).and_then(|&y| self.images[y as usize]);
                Some(match (node, y) {
                    (Node::Unary(function, _), _) => self.graph.unary(*function, x),
                    (Node::Div(..), Some(y)) => self.graph.div(x, y),
                    (Node::Atan2(..), Some(y)) => self.graph.atan2(x, y),
                    _ => return None,
                })
            }
            Kind::Sum(terms) => self.sum(terms),
        }
    }

    /// Positive terms first, so that no sign is left in front.
    fn sum(&mut self, terms: &[u32]) -> Option<Id> {
        let (mut plus, mut minus) = (None, None);
        for &number in terms {
            let value = self.product(number)?;
            let (side, part) = match *self.graph.node(value) {
                Node::Neg(x) => (&mut minus, x),
                _ => (&mut plus, value),
            };
            *side = Some(match *side {
                Some(sum) => self.graph.add(sum, part),
                None => part,
            });
        }
        Some(match (plus, minus) {
            (Some(a), Some(b)) => self.graph.sub(a, b),
            (Some(a), None) => a,
            (None, Some(b)) => self.graph.neg(b),
            (None, None) => self.graph.zero(),
        })
    }

    fn product(&mut self, number: u32) -> Option<Id> {
        let term = self.system.term(number);
        let coefficient = self.coefficient(term.coefficient);
        let mut product = None;
        for &factor in &term.factors {
            let image = self.images[factor as usize]?;
            product = Some(match product {
                Some(part) => self.graph.mul(part, image),
                None => image,
            });
        }
        Some(match product {
            Some(product) => self.graph.mul(coefficient, product),
            None => coefficient,
        })
    }

    fn coefficient(&mut self, id: Id) -> Id {
        if let Some(image) = self.coefficients[id.index()] {
            return image;
        }
        let image = match self.system.coefficients.as_constant(id) {
            // The graph keeps the sign of a number in the number.
            Some(value) if value.is_negative() => {
                let magnitude = self.graph.constant(-value);
                self.graph.neg(magnitude)
            }
            Some(value) => self.graph.constant(value.clone()),
            None => transfer(&self.system.coefficients, &[id], &mut self.graph)[0],
        };
        self.coefficients[id.index()] = Some(image);
        image
    }
}

/// Polynomials as a system of sums.
pub(super) fn from_polynomials(polynomials: &Polynomials) -> System {
    let mut system = System::new(polynomials.coefficients.clone());
    let sums: Vec<Variable> =
        polynomials.values.iter().map(|_| system.variable(Kind::Sum(Vec::new()))).collect();
    let atoms: Vec<Variable> = polynomials
        .atoms
        .iter()
        .map(|atom| {
            system.variable(match atom {
                Atom::Given(id) => Kind::Given(*id),
                Atom::Function(node, operands) => {
                    Kind::Function(node.clone(), operands.iter().map(|&x| sums[x]).collect())
                }
            })
        })
        .collect();
    for (value, &sum) in sums.iter().enumerate() {
        for (coefficient, factors) in polynomials.expanded(value) {
            let factors = factors.into_iter().map(|x| atoms[x]).collect();
            system.push_term(sum, coefficient, factors);
        }
    }
    system.roots = polynomials.roots.iter().map(|&root| sums[root]).collect();
    for &root in &system.roots.clone() {
        system.uses[root as usize] += 1;
    }
    system
}
