//! Three-vectors and elementary rotations over a graph.

use shapebot_model_dsl::model::Axis;
use shapebot_symbolic::{Graph, Id};

/// Components along the axes of some frame.
pub(crate) type Vec3 = [Id; 3];

/// Zero vector.
pub(crate) fn zero(graph: &Graph) -> Vec3 {
    [graph.zero(); 3]
}

/// Sum.
pub(crate) fn add(graph: &mut Graph, a: Vec3, b: Vec3) -> Vec3 {
    [0, 1, 2].map(|k| graph.add(a[k], b[k]))
}

/// Scalar multiple.
pub(crate) fn scale(graph: &mut Graph, factor: Id, v: Vec3) -> Vec3 {
    v.map(|x| graph.mul(factor, x))
}

/// Vector product.
pub(crate) fn cross(graph: &mut Graph, a: Vec3, b: Vec3) -> Vec3 {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
        let left = graph.mul(a[i], b[j]);
        let right = graph.mul(a[j], b[i]);
        graph.sub(left, right)
    })
}

/// Scalar product.
pub(crate) fn dot(graph: &mut Graph, a: &[Id], b: &[Id]) -> Id {
    let mut sum = graph.zero();
    for (&x, &y) in a.iter().zip(b) {
        let product = graph.mul(x, y);
        sum = graph.add(sum, product);
    }
    sum
}

/// Matrix times vector.
pub(crate) fn apply(graph: &mut Graph, m: &[Vec3; 3], v: Vec3) -> Vec3 {
    [0, 1, 2].map(|i| dot(graph, &m[i], &v))
}

/// Unit vector along an axis.
pub(crate) fn unit(graph: &Graph, axis: usize) -> Vec3 {
    let mut v = zero(graph);
    v[axis] = graph.one();
    v
}

/// Index of an axis.
pub(crate) const fn index(axis: Axis) -> usize {
    match axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    }
}

/// A rotation about one axis, by its cosine and sine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rotation {
    /// Axis index.
    pub(crate) axis: usize,
    /// Cosine of the angle.
    pub(crate) cos: Id,
    /// Sine of the angle.
    pub(crate) sin: Id,
}

impl Rotation {
    /// Components in the parent of a vector given in the turned frame: R v.
    pub(crate) fn to_parent(self, graph: &mut Graph, v: Vec3) -> Vec3 {
        let sin = graph.neg(self.sin);
        self.turn(graph, sin, v)
    }

    /// Components in the turned frame of a vector given in the parent: Rᵀ v.
    pub(crate) fn to_child(self, graph: &mut Graph, v: Vec3) -> Vec3 {
        self.turn(graph, self.sin, v)
    }

    fn turn(self, graph: &mut Graph, sin: Id, v: Vec3) -> Vec3 {
        let (i, j) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let mut out = v;
        out[i] = combine(graph, self.cos, v[i], sin, v[j]);
        let negative = graph.neg(sin);
        out[j] = combine(graph, self.cos, v[j], negative, v[i]);
        out
    }

    /// R S Rᵀ of a symmetric matrix given in the turned frame.
    pub(crate) fn symmetric_to_parent(self, graph: &mut Graph, s: &[Vec3; 3]) -> [Vec3; 3] {
        let (a, i, j) = (self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3);
        // Off-axis block: with d = S_jj − S_ii,
        //   S_ii' = S_ii + s (d s − 2 c S_ij),  S_jj' = S_jj − the same,  S_ij' = S_ij + ….
        let d = graph.sub(s[j][j], s[i][i]);
        let ds = graph.mul(d, self.sin);
        let oc = graph.mul(s[i][j], self.cos);
        let two_oc = graph.add(oc, oc);
        let inner = graph.sub(ds, two_oc);
        let shift = graph.mul(self.sin, inner);
        let mut out = *s;
        out[i][i] = graph.add(s[i][i], shift);
        out[j][j] = graph.sub(s[j][j], shift);
        // S_ij' = c² S_ij − s² S_ij − s c d = S_ij + 2… written as c (c S_ij − s d) − s² S_ij.
        let os = graph.mul(s[i][j], self.sin);
        let left = graph.sub(oc, ds);
        let left = graph.mul(self.cos, left);
        let right = graph.mul(self.sin, os);
        let mixed = graph.sub(left, right);
        out[i][j] = mixed;
        out[j][i] = mixed;
        let column = self.to_parent(graph, [s[a][0], s[a][1], s[a][2]]);
        for k in [i, j] {
            out[a][k] = column[k];
            out[k][a] = column[k];
        }
        out
    }
}

fn combine(graph: &mut Graph, a: Id, x: Id, b: Id, y: Id) -> Id {
    let left = graph.mul(a, x);
    let right = graph.mul(b, y);
    graph.add(left, right)
}
