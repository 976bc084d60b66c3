//! The ballbot with arms, from its Jacobians: test material for the optimiser.

#![allow(unreachable_pub)]

use num_rational::BigRational;
use shapebot_symbolic::{Graph, Id, Symbol, Tangent};

/// Coordinates [θx θy αlx αly αrx αry φx φy].
pub const COORDINATES: usize = 8;

/// Values of the parameters, in units of 10⁻⁵, in the order in which they are used.
const VALUES: [(&str, i64); 15] = [
    ("r_w", 10_580),
    ("m_w", 244_000),
    ("I_w", 1_740),
    ("m_b", 7_030_000),
    ("l_b", 87_000),
    ("Ixx_b", 1_259_000),
    ("Iyy_b", 1_248_000),
    ("Izz_b", 66_000),
    ("m_a", 100_000),
    ("l_a", 55_000),
    ("d_y", 18_415),
    ("d_z", 130_000),
    ("Ixx_a", 160),
    ("Iyy_a", 160),
    ("Izz_a", 100),
];

type Vector = [Id; 3];
type Matrix = [[Id; 3]; 3];

/// A graph with the parameters either as numbers or as symbols.
pub struct Model {
    pub graph: Graph,
    baked: bool,
}

impl Model {
    pub fn new(baked: bool) -> Self {
        Self { graph: Graph::new(), baked }
    }

    fn parameter(&mut self, name: &str) -> Id {
        let index = VALUES.iter().position(|value| value.0 == name).unwrap();
        if self.baked {
            self.graph.constant(BigRational::new(VALUES[index].1.into(), 100_000.into()))
        } else {
            self.graph.symbol(Symbol::Parameter(index as u32))
        }
    }

    fn q(&mut self, i: u32) -> Id {
        self.graph.symbol(Symbol::Coordinate(i))
    }

    fn rotation(&mut self, axis: usize, angle: Id) -> Matrix {
        let g = &mut self.graph;
        let (s, c) = (g.sin(angle), g.cos(angle));
        let (minus, zero, one) = (g.neg(s), g.zero(), g.one());
        match axis {
            0 => [[one, zero, zero], [zero, c, minus], [zero, s, c]],
            _ => [[c, zero, s], [zero, one, zero], [minus, zero, c]],
        }
    }

    fn dot(&mut self, a: &[Id], b: &[Id]) -> Id {
        let mut sum = self.graph.zero();
        for (&x, &y) in a.iter().zip(b) {
            let product = self.graph.mul(x, y);
            sum = self.graph.add(sum, product);
        }
        sum
    }

    fn times(&mut self, a: &Matrix, b: &Matrix) -> Matrix {
        let mut product = *a;
        for i in 0..3 {
            for j in 0..3 {
                product[i][j] = self.dot(&a[i], &[b[0][j], b[1][j], b[2][j]]);
            }
        }
        product
    }

    fn apply(&mut self, a: &Matrix, x: &Vector) -> Vector {
        a.map(|row| self.dot(&row, x))
    }

    fn plus(&mut self, a: &Vector, b: &Vector) -> Vector {
        [0, 1, 2].map(|i| self.graph.add(a[i], b[i]))
    }

    fn slopes(&mut self, value: Id) -> Vec<Id> {
        (0..COORDINATES as u32)
            .map(|i| {
                Tangent::partial(&self.graph, Symbol::Coordinate(i)).of(&mut self.graph, value)
            })
            .collect()
    }

    /// Adds weight · Σ aᵢ aⱼ to the upper triangle.
    fn add_energy(&mut self, m: &mut [Vec<Id>], weight: Id, row: &[Id]) {
        for i in 0..COORDINATES {
            for j in i..COORDINATES {
                let product = self.graph.mul(row[i], row[j]);
                let part = self.graph.mul(weight, product);
                m[i][j] = self.graph.add(m[i][j], part);
            }
        }
    }

    fn add_body(
        &mut self,
        m: &mut [Vec<Id>],
        mass: Id,
        inertia: [Id; 3],
        position: &Vector,
        r: &Matrix,
    ) {
        for x in position {
            let row = self.slopes(*x);
            self.add_energy(m, mass, &row);
        }
        // vee(Rᵀ ∂R): component k is column j of R times the slope of column i, (i, j, k) cyclic.
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let slopes: Vec<Vec<Id>> = (0..3).map(|n| self.slopes(r[n][i])).collect();
            let row: Vec<Id> = (0..COORDINATES)
                .map(|q| {
                    self.dot(
                        &[r[0][j], r[1][j], r[2][j]],
                        &[slopes[0][q], slopes[1][q], slopes[2][q]],
                    )
                })
                .collect();
            self.add_energy(m, inertia[k], &row);
        }
    }

    /// The mass matrix; its lower triangle is zero.
    pub fn mass_matrix(&mut self) -> Vec<Vec<Id>> {
        let zero = self.graph.zero();
        let mut m = vec![vec![zero; COORDINATES]; COORDINATES];
        let [tx, ty, px, py] = [0, 1, 6, 7].map(|i| self.q(i));
        let (rx, ry) = (self.rotation(0, px), self.rotation(1, py));
        let body = self.times(&ry, &rx);
        let r_w = self.parameter("r_w");
        let (spin_x, spin_y) = (self.graph.add(tx, py), self.graph.sub(ty, px));
        let ball = [self.graph.mul(r_w, spin_x), self.graph.mul(r_w, spin_y), zero];
        let [m_w, i_w] = ["m_w", "I_w"].map(|name| self.parameter(name));
        for (position, spin) in [(ball[0], spin_x), (ball[1], spin_y)] {
            for (value, weight) in [(position, m_w), (spin, i_w)] {
                let row = self.slopes(value);
                self.add_energy(&mut m, weight, &row);
            }
        }
        let [m_b, l_b] = ["m_b", "l_b"].map(|name| self.parameter(name));
        let inertia = ["Ixx_b", "Iyy_b", "Izz_b"].map(|name| self.parameter(name));
        let arm = self.apply(&body, &[zero, zero, l_b]);
        let centre = self.plus(&ball, &arm);
        self.add_body(&mut m, m_b, inertia, &centre, &body);
        self.add_arm(&mut m, &ball, &body, 2, false);
        self.add_arm(&mut m, &ball, &body, 4, true);
        m
    }

    fn add_arm(
        &mut self,
        m: &mut [Vec<Id>],
        ball: &Vector,
        body: &Matrix,
        first: u32,
        right: bool,
    ) {
        let zero = self.graph.zero();
        let [m_a, l_a, mut d_y, d_z] =
            ["m_a", "l_a", "d_y", "d_z"].map(|name| self.parameter(name));
        let inertia = ["Ixx_a", "Iyy_a", "Izz_a"].map(|name| self.parameter(name));
        if right {
            d_y = self.graph.neg(d_y);
        }
        let (ax, ay) = (self.q(first), self.q(first + 1));
        let (rx, ry) = (self.rotation(0, ax), self.rotation(1, ay));
        let turn = self.times(&ry, &rx);
        let down = [zero, zero, self.graph.neg(l_a)];
        let hanging = self.apply(&turn, &down);
        let local = self.plus(&[zero, d_y, d_z], &hanging);
        let turned = self.apply(body, &local);
        let position = self.plus(ball, &turned);
        let orientation = self.times(body, &turn);
        self.add_body(m, m_a, inertia, &position, &orientation);
    }

    /// C q̇ by Christoffel symbols: Σⱼₖ (∂ₖMᵢⱼ − ½ ∂ᵢMⱼₖ) q̇ⱼ q̇ₖ.
    pub fn bias(&mut self, m: &[Vec<Id>]) -> Vec<Id> {
        let rates: Vec<Id> =
            (0..COORDINATES as u32).map(|i| self.graph.symbol(Symbol::Rate(i))).collect();
        let entry = |i: usize, j: usize| m[i.min(j)][i.max(j)];
        let half = self.graph.fraction(1, 2);
        let mut bias = vec![self.graph.zero(); COORDINATES];
        for k in 0..COORDINATES {
            let mut slope = Tangent::partial(&self.graph, Symbol::Coordinate(k as u32));
            let mut energy = self.graph.zero();
            for i in 0..COORDINATES {
                for j in 0..COORDINATES {
                    let d = slope.of(&mut self.graph, entry(i, j));
                    let weighted = self.graph.mul(d, rates[j]);
                    let forward = self.graph.mul(weighted, rates[k]);
                    bias[i] = self.graph.add(bias[i], forward);
                    let backward = self.graph.mul(weighted, rates[i]);
                    energy = self.graph.add(energy, backward);
                }
            }
            let part = self.graph.mul(half, energy);
            bias[k] = self.graph.sub(bias[k], part);
        }
        bias
    }
}

/// The entries of the upper triangle, row by row.
pub fn upper(m: &[Vec<Id>]) -> Vec<Id> {
    (0..m.len()).flat_map(|i| m[i][i..].to_vec()).collect()
}
