//! Formulas of the paper as exact identities: equal for all values of parameters and coordinates.

use shapebot_codegen::derive::{Derivation, Function, Quantity};
use shapebot_symbolic::{Graph, Id, Symbol};
use shapebot_tests::models::derivation;
use std::sync::Arc;

/// A derived function with names for its symbols.
struct Paper {
    derivation: Arc<Derivation>,
    graph: Graph,
}

impl Paper {
    fn new(name: &str) -> Self {
        Self { derivation: derivation(name), graph: Graph::new() }
    }

    fn parameter(&mut self, name: &str) -> Id {
        let parameters = &self.derivation.model.parameters;
        let index = parameters.iter().position(|p| p.name == name);
        let index = index.unwrap_or_else(|| panic!("no parameter `{name}`"));
        self.graph.symbol(Symbol::Parameter(u32::try_from(index).expect("few parameters")))
    }

    /// Sine and cosine of a coordinate.
    fn sin_cos(&mut self, name: &str) -> [Id; 2] {
        let coordinates = &self.derivation.model.coordinates;
        let index = coordinates.iter().position(|c| c.name == name);
        let index = index.unwrap_or_else(|| panic!("no coordinate `{name}`"));
        let angle = self.graph.symbol(Symbol::Coordinate(u32::try_from(index).expect("few")));
        [self.graph.sin(angle), self.graph.cos(angle)]
    }

    fn product(&mut self, factors: &[Id]) -> Id {
        let one = self.graph.one();
        factors.iter().fold(one, |product, &factor| self.graph.mul(product, factor))
    }

    fn sum(&mut self, terms: &[Id]) -> Id {
        let zero = self.graph.zero();
        terms.iter().fold(zero, |sum, &term| self.graph.add(sum, term))
    }

    /// The product of named parameters.
    fn parameters(&mut self, names: &[&str]) -> Id {
        let factors: Vec<Id> = names.iter().map(|name| self.parameter(name)).collect();
        self.product(&factors)
    }

    #[track_caller]
    fn check(&self, quantity: Quantity, expected: &[Id]) {
        let function: &Function = &self.derivation.functions[&quantity];
        let found = function.results();
        assert_eq!(found.len(), expected.len(), "{quantity:?}");
        for (index, (&found, &expected)) in found.iter().zip(expected).enumerate() {
            assert!(
                function.graph.same_value(found, &self.graph, expected),
                "entry {index} of {quantity:?} is another function"
            );
        }
    }

    /// η₁, η₂, η₃ below Eq. 23.
    fn eta(&mut self) -> [Id; 3] {
        let inertia = self.parameter("I_w");
        let (body, ball) =
            (self.parameters(&["m_b", "r_w", "r_w"]), self.parameters(&["m_w", "r_w", "r_w"]));
        let first = self.sum(&[inertia, body, ball]);
        [first, self.parameters(&["m_b", "l_b", "r_w"]), self.parameters(&["m_b", "g", "l_b"])]
    }

    /// χ₁, χ₂, χ₃ below Eq. 26.
    fn chi(&mut self) -> [Id; 3] {
        let two = self.graph.integer(2);
        let (d_z, l_a) = (self.parameter("d_z"), self.parameter("l_a"));
        let height = self.graph.sub(d_z, l_a);
        let (weight, arms) =
            (self.parameters(&["m_b", "g", "l_b"]), self.parameters(&["m_a", "g"]));
        let arms = self.product(&[two, arms, height]);
        let second = self.sum(&[weight, arms]);
        let masses = [self.parameter("m_a"), self.parameter("m_b"), self.parameter("m_w")];
        let mass = self.sum(&[masses[0], masses[0], masses[1], masses[2]]);
        let (inertia, radius) = (self.parameter("I_w"), self.parameter("r_w"));
        let rolling = self.product(&[mass, radius, radius]);
        let body = self.parameters(&["m_b", "l_b", "r_w"]);
        let lifted = self.product(&[two, masses[0], height, radius]);
        let third = self.sum(&[inertia, rolling, body, lifted]);
        [self.parameters(&["m_a", "g", "l_a"]), second, third]
    }
}

#[test]
fn gamma_prime_of_the_ballbot_is_equation_21() {
    let mut paper = Paper::new("ballbot3d");
    let [eta_1, eta_2, eta_3] = paper.eta();
    let [[sin_x, cos_x], [sin_y, cos_y]] = ["phi_x", "phi_y"].map(|name| paper.sin_cos(name));
    let both = paper.product(&[eta_2, cos_x, cos_y]);
    let denominator = paper.sum(&[eta_1, both]);
    let front = paper.graph.div(eta_3, denominator);
    let along_x = paper.product(&[front, cos_x, sin_y]);
    let (a, b) = (paper.product(&[eta_1, cos_y]), paper.product(&[eta_2, cos_x]));
    let numerator = paper.sum(&[a, b]);
    let numerator = paper.product(&[front, sin_x, numerator]);
    let denominator = paper.sum(&[eta_1, b]);
    let along_y = paper.graph.div(numerator, denominator);
    let along_y = paper.graph.neg(along_y);
    paper.check(Quantity::GammaPrime, &[along_x, along_y]);
}

#[test]
fn shape_gain_of_the_ballbot_is_equation_22() {
    let mut paper = Paper::new("ballbot3d");
    let [eta_1, eta_2, eta_3] = paper.eta();
    let sum = paper.sum(&[eta_1, eta_2]);
    let entry = paper.graph.div(eta_3, sum);
    let (zero, negative) = (paper.graph.zero(), paper.graph.neg(entry));
    paper.check(Quantity::ShapeGain, &[zero, entry, negative, zero]);
}

#[test]
fn gamma_linearises_to_equation_26() {
    let mut paper = Paper::new("ballbot3d_arms");
    let [chi_1, chi_2, chi_3] = paper.chi();
    let (arm, body) = (paper.graph.div(chi_1, chi_3), paper.graph.div(chi_2, chi_3));
    let (less_arm, less_body) = (paper.graph.neg(arm), paper.graph.neg(body));
    let zero = paper.graph.zero();
    let expected =
        [[zero, less_arm, zero, less_arm, zero, body], [arm, zero, arm, zero, less_body, zero]];
    paper.check(Quantity::ShapeGain, &expected.concat());
}

#[test]
fn a_wrong_formula_is_told_from_the_right_one() {
    let mut paper = Paper::new("ballbot3d");
    let [eta_1, eta_2, eta_3] = paper.eta();
    // η₁ − η₂ instead of η₁ + η₂.
    let difference = paper.graph.sub(eta_1, eta_2);
    let entry = paper.graph.div(eta_3, difference);
    let function = &paper.derivation.functions[&Quantity::ShapeGain];
    assert!(!function.graph.same_value(function.results()[1], &paper.graph, entry));
}
