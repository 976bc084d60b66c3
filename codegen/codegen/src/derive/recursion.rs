//! Newton–Euler recursion over the tree: generalised forces of a motion without forming M or C.
//!
//! Outward, each hinge's angular velocity and acceleration and each point's acceleration, all in
//! local axes. Inward, forces at points and moments at hinges, projected onto the coordinates. With
//! q̈ = 0 and no gravity the result is C q̇; at rest under gravity it is G.

use super::lower::{Lowering, number};
use super::tree::{Attachment, Inertia, Tree};
use super::vector::{self, Vec3};
use shapebot_symbolic::{Graph, Id, Symbol, Tangent};

/// Rates and accelerations of the coordinates, and the acceleration of gravity in world axes.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    /// q̇.
    pub(crate) rates: Vec<Id>,
    /// q̈.
    pub(crate) accelerations: Vec<Id>,
    /// World components of gravity, zero to leave it out.
    pub(crate) gravity: Vec3,
}

/// How the force and moment of a rigid body are written. All are equal; their counts differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BodyForm {
    /// Euler's equation with the inertia tensor.
    Tensor,
    /// With the second moments ∫ r rᵀ dm, which share the acceleration gradient with the force.
    SecondMoments,
}

/// Angular velocity, angular acceleration and acceleration gradient H of each hinge: a point at r
/// from a hinge's point has the acceleration a + H r, H = [α]ₓ + ω ωᵀ − |ω|² 1.
#[derive(Clone, Debug)]
struct Spin {
    omega: Vec3,
    alpha: Vec3,
    gradient: [Vec3; 3],
}

/// Generalised forces M q̈ + C q̇ + G of the rigid bodies.
pub(crate) fn inverse_dynamics(
    lowering: &mut Lowering<'_>,
    tree: &Tree,
    motion: &Motion,
    form: BodyForm,
) -> Vec<Id> {
    let spins = spins(lowering, tree, motion);
    let accelerations = accelerations(lowering, tree, motion, &spins);
    let mut loads = Loads::new(tree);
    for attachment in &tree.attachments {
        attachment_load(
            &mut lowering.graph,
            tree,
            attachment,
            &spins,
            &accelerations,
            form,
            &mut loads,
        );
    }
    loads.project(&mut lowering.graph, tree, lowering.model.coordinates.len())
}

fn spins(lowering: &mut Lowering<'_>, tree: &Tree, motion: &Motion) -> Vec<Spin> {
    let mut spins: Vec<Spin> = Vec::with_capacity(tree.hinges.len());
    for (h, hinge) in tree.hinges.iter().enumerate() {
        if h == 0 {
            let zero = vector::zero(&lowering.graph);
            spins.push(Spin { omega: zero, alpha: zero, gradient: [zero; 3] });
            continue;
        }
        let rate = vector::dot(&mut lowering.graph, &hinge.slopes, &motion.rates);
        let acceleration = second_derivative(lowering, &hinge.slopes, motion);
        let graph = &mut lowering.graph;
        let parent = &spins[hinge.parent];
        let carried = hinge.rotation.to_child(graph, parent.omega);
        let turned = hinge.rotation.to_child(graph, parent.alpha);
        let axis = hinge.rotation.axis;
        let mut relative = vector::zero(graph);
        relative[axis] = rate;
        let mut own = vector::zero(graph);
        own[axis] = acceleration;
        let omega = vector::add(graph, carried, relative);
        let coupling = vector::cross(graph, carried, relative);
        let alpha = vector::add(graph, turned, coupling);
        let alpha = vector::add(graph, alpha, own);
        label(graph, omega, "omega", &hinge.name);
        label(graph, alpha, "alpha", &hinge.name);
        let gradient = gradient(graph, omega, alpha);
        spins.push(Spin { omega, alpha, gradient });
    }
    spins
}

/// Names the components of a vector, but for those of parameters alone: their own factors say more.
pub(crate) fn label(graph: &mut Graph, v: Vec3, what: &str, of: &str) {
    for (component, axis) in v.into_iter().zip(["x", "y", "z"]) {
        let symbols = shapebot_symbolic::symbols_of(graph, &[component]);
        if symbols.iter().any(|s| !matches!(s, Symbol::Parameter(_))) {
            graph.label(component, format!("{what}_{of}_{axis}"));
        }
    }
}

fn gradient(graph: &mut Graph, omega: Vec3, alpha: Vec3) -> [Vec3; 3] {
    let mut h = [vector::zero(graph); 3];
    let squares = omega.map(|w| graph.mul(w, w));
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let sum = graph.add(squares[j], squares[k]);
        h[i][i] = graph.neg(sum);
        let product = graph.mul(omega[i], omega[j]);
        h[i][j] = graph.sub(product, alpha[k]);
        h[j][i] = graph.add(product, alpha[k]);
    }
    h
}

/// d²/dt² of a function of the coordinates whose first derivatives are `slopes`.
fn second_derivative(lowering: &mut Lowering<'_>, slopes: &[Id], motion: &Motion) -> Id {
    let graph = &mut lowering.graph;
    let mut sum = vector::dot(graph, slopes, &motion.accelerations);
    let seeds = motion.rates.iter().enumerate();
    let mut along = Tangent::new(seeds.map(|(j, &rate)| (Symbol::Coordinate(number(j)), rate)));
    for (&slope, &rate) in slopes.iter().zip(&motion.rates) {
        let change = along.of(graph, slope);
        let part = graph.mul(change, rate);
        sum = graph.add(sum, part);
    }
    sum
}

/// Acceleration of each point, in its hinge's axes, minus gravity.
fn accelerations(
    lowering: &mut Lowering<'_>,
    tree: &Tree,
    motion: &Motion,
    spins: &[Spin],
) -> Vec<Vec3> {
    let origin = motion.gravity.map(|g| lowering.graph.neg(g));
    let mut out = vec![origin];
    for point in tree.points.iter().skip(1) {
        let parent = &tree.points[point.parent];
        let carried =
            tree.express(&mut lowering.graph, out[point.parent], parent.hinge, point.hinge);
        let spin = &spins[point.hinge];
        let turned = vector::apply(&mut lowering.graph, &spin.gradient, point.vector);
        let mut sum = vector::add(&mut lowering.graph, carried, turned);
        let moving = [0, 1, 2].map(|k| {
            let slopes: Vec<Id> = point.slopes.iter().map(|s| s[k]).collect();
            let rate = vector::dot(&mut lowering.graph, &slopes, &motion.rates);
            (rate, second_derivative(lowering, &slopes, motion))
        });
        let graph = &mut lowering.graph;
        let coriolis = vector::cross(graph, spin.omega, moving.map(|(rate, _)| rate));
        let two = graph.integer(2);
        let coriolis = vector::scale(graph, two, coriolis);
        sum = vector::add(graph, sum, coriolis);
        sum = vector::add(graph, sum, moving.map(|(_, second)| second));
        out.push(sum);
    }
    out
}

fn attachment_load(
    graph: &mut Graph,
    tree: &Tree,
    attachment: &Attachment,
    spins: &[Spin],
    accelerations: &[Vec3],
    form: BodyForm,
    loads: &mut Loads,
) {
    let Attachment { point, hinge, inertia } = attachment;
    let spin = &spins[*hinge];
    let a = tree.express(graph, accelerations[*point], tree.points[*point].hinge, *hinge);
    let translation = vector::scale(graph, inertia.mass, a);
    let rotation = vector::apply(graph, &spin.gradient, inertia.moment);
    let force = vector::add(graph, translation, rotation);
    let name = &tree.hinges[*hinge].name;
    label(graph, a, "acceleration", name);
    label(graph, force, "force", name);
    let carried = vector::cross(graph, inertia.moment, a);
    let own = match form {
        BodyForm::Tensor => euler(graph, inertia, spin),
        BodyForm::SecondMoments => second_moments(graph, inertia, spin),
    };
    let moment = vector::add(graph, carried, own);
    label(graph, moment, "moment", name);
    loads.force(graph, *point, *hinge, force);
    loads.moment(graph, *hinge, moment);
}

/// I α + ω × I ω.
fn euler(graph: &mut Graph, inertia: &Inertia, spin: &Spin) -> Vec3 {
    let accelerating = vector::apply(graph, &inertia.tensor, spin.alpha);
    let spinning = vector::apply(graph, &inertia.tensor, spin.omega);
    let gyroscopic = vector::cross(graph, spin.omega, spinning);
    vector::add(graph, accelerating, gyroscopic)
}

/// The axial part of H Σ with Σ = ∫ r rᵀ dm = ½ tr(I) 1 − I.
fn second_moments(graph: &mut Graph, inertia: &Inertia, spin: &Spin) -> Vec3 {
    let t = &inertia.tensor;
    let partial = graph.add(t[0][0], t[1][1]);
    let trace = graph.add(partial, t[2][2]);
    let half = graph.fraction(1, 2);
    let half_trace = graph.mul(half, trace);
    let sigma = [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| if i == j { graph.sub(half_trace, t[i][i]) } else { graph.neg(t[i][j]) })
    });
    let column = |graph: &mut Graph, j: usize| {
        let v = [sigma[0][j], sigma[1][j], sigma[2][j]];
        vector::apply(graph, &spin.gradient, v)
    };
    let product = [0, 1, 2].map(|j| column(graph, j)); // product[j][i] = (H Σ)_ij
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| graph.sub(product[i][j], product[j][i]))
}

/// Forces at points (by the hinge whose axes they are written in) and moments at hinges.
#[derive(Clone, Debug)]
pub(crate) struct Loads {
    forces: Vec<Vec<Option<Vec3>>>,
    moments: Vec<Option<Vec3>>,
}

impl Loads {
    /// No load.
    pub(crate) fn new(tree: &Tree) -> Self {
        let hinges = tree.hinges.len();
        Self { forces: vec![vec![None; hinges]; tree.points.len()], moments: vec![None; hinges] }
    }

    /// Adds a force at a point, given along a hinge's axes.
    pub(crate) fn force(&mut self, graph: &mut Graph, point: usize, hinge: usize, force: Vec3) {
        accumulate(graph, &mut self.forces[point][hinge], force);
    }

    /// Adds a moment that turns everything at or beyond a hinge, along its axes.
    pub(crate) fn moment(&mut self, graph: &mut Graph, hinge: usize, moment: Vec3) {
        accumulate(graph, &mut self.moments[hinge], moment);
    }

    /// Total force at each point (in its hinge's axes) and moment at each hinge, inward.
    pub(crate) fn resolve(
        mut self,
        graph: &mut Graph,
        tree: &Tree,
    ) -> (Vec<Option<Vec3>>, Vec<Option<Vec3>>) {
        let mut totals = vec![None; tree.points.len()];
        for p in (0..tree.points.len()).rev() {
            let total = self.gather(graph, tree, p);
            totals[p] = total;
            let Some(force) = total else { continue };
            if p == 0 {
                continue;
            }
            let point = &tree.points[p];
            let name = &tree.hinges[point.hinge].name;
            label(graph, force, "load", name);
            let arm = vector::cross(graph, point.vector, force);
            label(graph, arm, "load_moment", name);
            accumulate(graph, &mut self.moments[point.hinge], arm);
            accumulate(graph, &mut self.forces[point.parent][point.hinge], force);
        }
        for h in (1..tree.hinges.len()).rev() {
            let Some(moment) = self.moments[h] else { continue };
            label(graph, moment, "total_moment", &tree.hinges[h].name);
            let carried = tree.hinges[h].rotation.to_parent(graph, moment);
            accumulate(graph, &mut self.moments[tree.hinges[h].parent], carried);
        }
        (totals, self.moments)
    }

    /// Sum of the forces at a point: turned inward hinge by hinge, so that those of one frame are
    /// added before they are turned.
    fn gather(&mut self, graph: &mut Graph, tree: &Tree, p: usize) -> Option<Vec3> {
        let home = tree.points[p].hinge;
        for h in (1..tree.hinges.len()).rev() {
            if h == home || tree.within(home, h) {
                continue;
            }
            if let Some(force) = self.forces[p][h].take() {
                let carried = tree.hinges[h].rotation.to_parent(graph, force);
                let parent = tree.hinges[h].parent;
                accumulate(graph, &mut self.forces[p][parent], carried);
            }
        }
        // What is left stands in a frame that the point's own frame turns with.
        let mut total = self.forces[p][home].take();
        for h in 0..tree.hinges.len() {
            if let Some(force) = self.forces[p][h].take() {
                let force = tree.express(graph, force, h, home);
                accumulate(graph, &mut total, force);
            }
        }
        total
    }

    /// Generalised forces: virtual work of all loads.
    pub(crate) fn project(self, graph: &mut Graph, tree: &Tree, count: usize) -> Vec<Id> {
        let (forces, moments) = self.resolve(graph, tree);
        let mut out = vec![graph.zero(); count];
        for (hinge, moment) in tree.hinges.iter().zip(&moments) {
            let Some(moment) = moment else { continue };
            for (j, &slope) in hinge.slopes.iter().enumerate() {
                let work = graph.mul(slope, moment[hinge.rotation.axis]);
                out[j] = graph.add(out[j], work);
            }
        }
        for (point, force) in tree.points.iter().zip(&forces) {
            let Some(force) = force else { continue };
            for (j, slope) in point.slopes.iter().enumerate() {
                let work = vector::dot(graph, slope, force);
                out[j] = graph.add(out[j], work);
            }
        }
        out
    }
}

fn accumulate(graph: &mut Graph, slot: &mut Option<Vec3>, v: Vec3) {
    *slot = Some(match *slot {
        Some(old) => vector::add(graph, old, v),
        None => v,
    });
}
