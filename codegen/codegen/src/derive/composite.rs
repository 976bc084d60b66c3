//! The mass matrix by composite bodies (Featherstone's CRBA, over the trie of points).
//!
//! A unit rate of one *element*, a hinge or one component of a point's vector, gives everything
//! beyond it a momentum; its projections onto the elements before it are the entries of M between
//! them. Coordinates enter through the slopes of hinge angles and point vectors.

use super::recursion::{Loads, label};
use super::tree::{Inertia, Tree};
use super::vector::{self, Vec3};
use shapebot_symbolic::{Graph, Id};

/// Something that coordinates move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Element {
    Hinge(usize),
    Component(usize, usize),
}

/// The mass matrix of the rigid bodies, or `None` for a tree in which a point or a body stands in a
/// frame that does not turn with the frame of the point before it.
pub(crate) fn mass_matrix(graph: &mut Graph, tree: &Tree, count: usize) -> Option<Vec<Vec<Id>>> {
    if !monotone(tree) {
        return None;
    }
    let composites = composites(graph, tree);
    let elements = elements(graph, tree);
    let mut mass = vec![vec![graph.zero(); count]; count];
    for &a in &elements {
        let (forces, moments) = unit_load(graph, tree, &composites, a).resolve(graph, tree);
        for &b in &elements {
            let entry = match b {
                Element::Hinge(h) => moments[h].map(|m| m[tree.hinges[h].rotation.axis]),
                Element::Component(p, k) => forces[p].map(|f| f[k]),
            };
            let Some(entry) = entry.filter(|&e| !graph.is_zero(e)) else { continue };
            spread(graph, tree, &mut mass, (a, b), entry);
        }
    }
    Some(mass)
}

fn monotone(tree: &Tree) -> bool {
    let points = tree.points.iter().all(|p| tree.within(p.hinge, tree.points[p.parent].hinge));
    let bodies = tree.attachments.iter().all(|a| tree.within(a.hinge, tree.points[a.point].hinge));
    points && bodies
}

fn elements(graph: &Graph, tree: &Tree) -> Vec<Element> {
    let moves = |slopes: &[Id]| slopes.iter().any(|&s| !graph.is_zero(s));
    let mut elements = Vec::new();
    for (h, hinge) in tree.hinges.iter().enumerate() {
        if moves(&hinge.slopes) {
            elements.push(Element::Hinge(h));
        }
    }
    for (p, point) in tree.points.iter().enumerate() {
        for k in 0..3 {
            if point.slopes.iter().any(|s| !graph.is_zero(s[k])) {
                elements.push(Element::Component(p, k));
            }
        }
    }
    elements
}

/// Composite bodies: `by_hinge[h]` lists, for each point before hinge h, everything that h turns
/// about it; `at_point[p]` is everything at or beyond p, about p, along its hinge.
struct Composites {
    by_hinge: Vec<Vec<(usize, Inertia)>>,
    at_point: Vec<Option<Inertia>>,
}

fn composites(graph: &mut Graph, tree: &Tree) -> Composites {
    let hinges = tree.hinges.len();
    let mut local: Vec<Vec<Option<Inertia>>> = vec![vec![None; hinges]; tree.points.len()];
    for attachment in &tree.attachments {
        merge(graph, &mut local[attachment.point][attachment.hinge], attachment.inertia.clone());
    }
    let mut out =
        Composites { by_hinge: vec![Vec::new(); hinges], at_point: vec![None; tree.points.len()] };
    for p in (0..tree.points.len()).rev() {
        let point = &tree.points[p];
        for h in (0..hinges).rev() {
            if h == point.hinge {
                break;
            }
            if let Some(inertia) = local[p][h].take() {
                name(graph, &inertia, &tree.hinges[h].name);
                let turned = turn(graph, tree, h, &inertia);
                out.by_hinge[h].push((p, inertia));
                merge(graph, &mut local[p][tree.hinges[h].parent], turned);
            }
        }
        let Some(total) = local[p][point.hinge].take() else { continue };
        if p > 0 {
            let shifted = shift(graph, &total, point.vector);
            merge(graph, &mut local[point.parent][point.hinge], shifted);
        }
        out.at_point[p] = Some(total);
    }
    out
}

/// Names the parts of a composite body for the reader.
fn name(graph: &mut Graph, inertia: &Inertia, of: &str) {
    label(graph, inertia.moment, "first_moment", of);
    for (row, axis) in inertia.tensor.iter().zip(["x", "y", "z"]) {
        label(graph, *row, "inertia", &format!("{of}_{axis}"));
    }
}

fn merge(graph: &mut Graph, slot: &mut Option<Inertia>, inertia: Inertia) {
    *slot = Some(match slot.take() {
        Some(old) => old.plus(graph, &inertia),
        None => inertia,
    });
}

/// Along the axes of the parent of hinge `h`.
fn turn(graph: &mut Graph, tree: &Tree, h: usize, inertia: &Inertia) -> Inertia {
    let rotation = tree.hinges[h].rotation;
    Inertia {
        mass: inertia.mass,
        moment: rotation.to_parent(graph, inertia.moment),
        tensor: rotation.symmetric_to_parent(graph, &inertia.tensor),
    }
}

/// About a point that stands `v` before: I + 2 (h·v) 1 − h vᵀ − v hᵀ + m (v² 1 − v vᵀ).
fn shift(graph: &mut Graph, inertia: &Inertia, v: Vec3) -> Inertia {
    let mv = vector::scale(graph, inertia.mass, v);
    let moment = vector::add(graph, inertia.moment, mv);
    // With h' = h + m v: I' = I + (h·v + h'·v) 1 − (h vᵀ + v h'ᵀ).
    let h = inertia.moment;
    let mut tensor = inertia.tensor;
    let products = [0, 1, 2].map(|i| {
        let once = graph.mul(h[i], v[i]);
        let again = graph.mul(moment[i], v[i]);
        graph.add(once, again)
    });
    for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let sum = graph.add(products[j], products[k]);
        tensor[i][i] = graph.add(tensor[i][i], sum);
        let left = graph.mul(h[i], v[j]);
        let right = graph.mul(v[i], moment[j]);
        let both = graph.add(left, right);
        let entry = graph.sub(tensor[i][j], both);
        tensor[i][j] = entry;
        tensor[j][i] = entry;
    }
    Inertia { mass: inertia.mass, moment, tensor }
}

/// Momentum of everything beyond an element that moves at unit rate.
fn unit_load(graph: &mut Graph, tree: &Tree, composites: &Composites, element: Element) -> Loads {
    let mut loads = Loads::new(tree);
    match element {
        Element::Hinge(h) => {
            let axis = tree.hinges[h].rotation.axis;
            let a = vector::unit(graph, axis);
            for (p, inertia) in &composites.by_hinge[h] {
                let momentum = vector::cross(graph, a, inertia.moment);
                loads.force(graph, *p, h, momentum);
                let column = [0, 1, 2].map(|i| inertia.tensor[i][axis]);
                loads.moment(graph, h, column);
            }
        }
        Element::Component(p, k) => {
            if let Some(inertia) = &composites.at_point[p] {
                let direction = vector::unit(graph, k);
                let momentum = vector::scale(graph, inertia.mass, direction);
                let angular = vector::cross(graph, inertia.moment, direction);
                loads.force(graph, p, tree.points[p].hinge, momentum);
                loads.moment(graph, tree.points[p].hinge, angular);
            }
        }
    }
    loads
}

/// Adds an entry between two elements to the coordinates that move them.
fn spread(
    graph: &mut Graph,
    tree: &Tree,
    mass: &mut [Vec<Id>],
    (a, b): (Element, Element),
    entry: Id,
) {
    let slope = |element: Element, j: usize| match element {
        Element::Hinge(h) => tree.hinges[h].slopes[j],
        Element::Component(p, k) => tree.points[p].slopes[j][k],
    };
    let count = mass.len();
    for i in 0..count {
        for j in 0..count {
            let product = graph.mul(slope(a, i), slope(b, j));
            if graph.is_zero(product) {
                continue;
            }
            let part = graph.mul(product, entry);
            mass[i][j] = graph.add(mass[i][j], part);
            if a != b {
                mass[j][i] = graph.add(mass[j][i], part);
            }
        }
    }
}
