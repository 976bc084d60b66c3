//! The kinematic tree: elementary hinges, a trie of points, and the inertia attached to them.
//!
//! A position such as `ball + body*[0, d_y, d_z] + arm*[0, 0, -l_a]` is a path in a trie of points:
//! the origin, the ball's centre, the arm's joint, the arm's mass. Bodies whose last term is written
//! in their own frame are attached to the point before it, with their inertia about that point: it is
//! constant there, and bodies that move together merge.

use super::lower::{Lowering, number};
use super::vector::{self, Rotation, Vec3};
use shapebot_model_dsl::model::{Axis, FrameId, RigidBody};
use shapebot_symbolic::{Id, Symbol};

/// One elementary rotation; hinge 0 is the world and never turns.
#[derive(Clone, Debug)]
pub(crate) struct Hinge {
    /// The hinge whose turned frame this one starts from; the world is its own parent.
    pub(crate) parent: usize,
    /// The rotation.
    pub(crate) rotation: Rotation,
    /// ∂(angle)/∂q.
    pub(crate) slopes: Vec<Id>,
    /// Name for readers: the frame's.
    pub(crate) name: String,
}

/// A point, reached from its parent by a vector written in a hinge's frame. Point 0 is the origin.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// The point before; the origin is its own parent.
    pub(crate) parent: usize,
    /// Frame of the vector.
    pub(crate) hinge: usize,
    /// The vector from the parent.
    pub(crate) vector: Vec3,
    /// ∂(vector)/∂q, one three-vector per coordinate.
    pub(crate) slopes: Vec<Vec3>,
}

/// Mass, first moment and inertia about a point, along a hinge's axes.
#[derive(Clone, Debug)]
pub(crate) struct Inertia {
    /// Mass.
    pub(crate) mass: Id,
    /// Mass times centre of mass.
    pub(crate) moment: Vec3,
    /// Inertia about the point.
    pub(crate) tensor: [Vec3; 3],
}

/// Rigid matter at a point, turning with a hinge.
#[derive(Clone, Debug)]
pub(crate) struct Attachment {
    /// The point it is measured from.
    pub(crate) point: usize,
    /// The frame it turns with.
    pub(crate) hinge: usize,
    /// Its inertia, constant along those axes.
    pub(crate) inertia: Inertia,
}

/// Hinges, points and attachments of a model.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    /// Hinges, parents first.
    pub(crate) hinges: Vec<Hinge>,
    /// Last hinge of each frame of the model.
    pub(crate) frames: Vec<usize>,
    /// Points, parents first.
    pub(crate) points: Vec<Point>,
    /// Rigid matter.
    pub(crate) attachments: Vec<Attachment>,
}

impl Tree {
    /// The tree of all rigid bodies of the model.
    pub(crate) fn new(lowering: &mut Lowering<'_>) -> Self {
        let bodies: Vec<&RigidBody> = lowering.model.bodies.iter().collect();
        Self::of_bodies(lowering, &bodies)
    }

    /// The tree of some rigid bodies.
    pub(crate) fn of_bodies(lowering: &mut Lowering<'_>, bodies: &[&RigidBody]) -> Self {
        let mut tree = Self {
            hinges: Vec::new(),
            frames: Vec::new(),
            points: Vec::new(),
            attachments: Vec::new(),
        };
        tree.add_hinges(lowering);
        let origin = vector::zero(&lowering.graph);
        tree.points.push(Point { parent: 0, hinge: 0, vector: origin, slopes: Vec::new() });
        for body in bodies {
            tree.attach(lowering, body);
        }
        tree
    }

    fn add_hinges(&mut self, lowering: &mut Lowering<'_>) {
        let graph = &lowering.graph;
        let still = Rotation { axis: 0, cos: graph.one(), sin: graph.zero() };
        self.hinges.push(Hinge {
            parent: 0,
            rotation: still,
            slopes: vec![graph.zero(); lowering.model.coordinates.len()],
            name: "world".into(),
        });
        let model = lowering.model;
        for (f, frame) in model.frames.iter().enumerate() {
            let mut at = frame.parent.map_or(0, |FrameId(p)| self.frames[p as usize]);
            let rotations = lowering.frame_rotations(FrameId(number(f)));
            let path = frame.name.replace(['.', '[', ']'], "_");
            for (k, (rotation, &(axis, angle))) in
                rotations.into_iter().zip(&frame.rotations).enumerate()
            {
                let angle = lowering.scalar(angle);
                let slopes = slopes(lowering, angle);
                // The frame's name is for its last rotation; those before it carry their axis.
                let last = k + 1 == frame.rotations.len();
                let name = if last { path.clone() } else { format!("{path}_{}", letter(axis)) };
                self.hinges.push(Hinge { parent: at, rotation, slopes, name });
                at = self.hinges.len() - 1;
            }
            self.frames.push(at);
        }
    }

    fn attach(&mut self, lowering: &mut Lowering<'_>, body: &RigidBody) {
        let hinge = self.frames[body.frame.0 as usize];
        let mass = lowering.scalar(body.mass);
        let inertia = body.inertia.map(|row| row.map(|e| lowering.scalar(e)));
        let mut terms = body.com.terms.as_slice();
        let mut offset = vector::zero(&lowering.graph);
        if let Some((last, before)) = terms.split_last()
            && self.frames[last.frame.0 as usize] == hinge
        {
            let entries = lowering.entries(last);
            if entries
                .iter()
                .all(|&e| slopes(lowering, e).iter().all(|&s| lowering.graph.is_zero(s)))
            {
                offset = entries;
                terms = before;
            }
        }
        let mut point = 0;
        for term in terms {
            let entries = lowering.entries(term);
            point = self.point(lowering, point, self.frames[term.frame.0 as usize], entries);
        }
        let inertia = about_point(lowering, mass, offset, inertia);
        self.merge(lowering, Attachment { point, hinge, inertia });
    }

    /// The point at `vector` from another, made once.
    fn point(
        &mut self,
        lowering: &mut Lowering<'_>,
        parent: usize,
        hinge: usize,
        vector: Vec3,
    ) -> usize {
        if vector.iter().all(|&e| lowering.graph.is_zero(e)) {
            return parent;
        }
        let same = |p: &Point| p.parent == parent && p.hinge == hinge && p.vector == vector;
        if let Some(known) = self.points.iter().skip(1).position(same) {
            return known + 1;
        }
        let by_entry = vector.map(|e| slopes(lowering, e));
        let count = lowering.model.coordinates.len();
        let slopes = (0..count).map(|j| [0, 1, 2].map(|k| by_entry[k][j])).collect();
        self.points.push(Point { parent, hinge, vector, slopes });
        self.points.len() - 1
    }

    fn merge(&mut self, lowering: &mut Lowering<'_>, new: Attachment) {
        let graph = &mut lowering.graph;
        let same = |a: &&mut Attachment| a.point == new.point && a.hinge == new.hinge;
        match self.attachments.iter_mut().find(same) {
            Some(old) => old.inertia = old.inertia.plus(graph, &new.inertia),
            None => self.attachments.push(new),
        }
    }

    /// Whether hinge `inner` turns with hinge `outer` (or is it).
    pub(crate) fn within(&self, mut inner: usize, outer: usize) -> bool {
        while inner > outer {
            inner = self.hinges[inner].parent;
        }
        inner == outer
    }

    /// Components along hinge `to` of a vector given along hinge `from`.
    pub(crate) fn express(
        &self,
        graph: &mut shapebot_symbolic::Graph,
        mut v: Vec3,
        mut from: usize,
        to: usize,
    ) -> Vec3 {
        while !self.within(to, from) {
            v = self.hinges[from].rotation.to_parent(graph, v);
            from = self.hinges[from].parent;
        }
        let mut path = Vec::new();
        let mut at = to;
        while at != from {
            path.push(at);
            at = self.hinges[at].parent;
        }
        for hinge in path.into_iter().rev() {
            v = self.hinges[hinge].rotation.to_child(graph, v);
        }
        v
    }
}

impl Inertia {
    /// Sum of two bodies about the same point and axes.
    pub(crate) fn plus(&self, graph: &mut shapebot_symbolic::Graph, other: &Self) -> Self {
        Self {
            mass: graph.add(self.mass, other.mass),
            moment: vector::add(graph, self.moment, other.moment),
            tensor: [0, 1, 2].map(|i| vector::add(graph, self.tensor[i], other.tensor[i])),
        }
    }
}

const fn letter(axis: Axis) -> char {
    match axis {
        Axis::X => 'x',
        Axis::Y => 'y',
        Axis::Z => 'z',
    }
}

/// ∂(value)/∂q.
pub(crate) fn slopes(lowering: &mut Lowering<'_>, id: Id) -> Vec<Id> {
    let count = number(lowering.model.coordinates.len());
    (0..count).map(|j| lowering.partial(id, Symbol::Coordinate(j))).collect()
}

/// Inertia about a point from which the centre of mass is at `offset` (parallel axes).
fn about_point(
    lowering: &mut Lowering<'_>,
    mass: Id,
    offset: Vec3,
    about_com: [Vec3; 3],
) -> Inertia {
    let graph = &mut lowering.graph;
    let moment = vector::scale(graph, mass, offset);
    let square = vector::dot(graph, &moment, &offset);
    let mut tensor = about_com;
    for i in 0..3 {
        for j in 0..3 {
            let mut shift = graph.mul(moment[i], offset[j]);
            shift = graph.neg(shift);
            if i == j {
                shift = graph.add(square, shift);
            }
            tensor[i][j] = graph.add(about_com[i][j], shift);
        }
    }
    Inertia { mass, moment, tensor }
}
