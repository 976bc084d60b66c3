//! Kinetic and potential energy of rigid bodies, from the tree.

use super::lower::Lowering;
use super::tree::Tree;
use super::vector::{self, Vec3};
use shapebot_symbolic::Id;

/// Kinetic energy ½ m v² + v · (ω × h) + ½ ω · I ω of all attachments, in local axes.
pub(crate) fn kinetic(lowering: &mut Lowering<'_>, tree: &Tree, rates: &[Id]) -> Id {
    let graph = &mut lowering.graph;
    let mut omegas: Vec<Vec3> = vec![vector::zero(graph)];
    for hinge in tree.hinges.iter().skip(1) {
        let carried = hinge.rotation.to_child(graph, omegas[hinge.parent]);
        let mut relative = vector::zero(graph);
        relative[hinge.rotation.axis] = vector::dot(graph, &hinge.slopes, rates);
        omegas.push(vector::add(graph, carried, relative));
    }
    let mut velocities: Vec<Vec3> = vec![vector::zero(graph)];
    for point in tree.points.iter().skip(1) {
        let from = tree.points[point.parent].hinge;
        let carried = tree.express(graph, velocities[point.parent], from, point.hinge);
        let turning = vector::cross(graph, omegas[point.hinge], point.vector);
        let own = [0, 1, 2].map(|k| {
            let slopes: Vec<Id> = point.slopes.iter().map(|s| s[k]).collect();
            vector::dot(graph, &slopes, rates)
        });
        let sum = vector::add(graph, carried, turning);
        velocities.push(vector::add(graph, sum, own));
    }
    let half = graph.fraction(1, 2);
    let mut total = graph.zero();
    for attachment in &tree.attachments {
        let (omega, inertia) = (omegas[attachment.hinge], &attachment.inertia);
        let home = tree.points[attachment.point].hinge;
        let v = tree.express(graph, velocities[attachment.point], home, attachment.hinge);
        let square = vector::dot(graph, &v, &v);
        let translation = graph.mul(inertia.mass, square);
        let spin = vector::apply(graph, &inertia.tensor, omega);
        let rotation = vector::dot(graph, &omega, &spin);
        let sum = graph.add(translation, rotation);
        let squares = graph.mul(half, sum);
        let turning = vector::cross(graph, omega, inertia.moment);
        let mixed = vector::dot(graph, &v, &turning);
        let energy = graph.add(squares, mixed);
        total = graph.add(total, energy);
    }
    total
}

/// Potential energy −Σ m g · r of all attachments, zero at the world's origin.
pub(crate) fn potential(lowering: &mut Lowering<'_>, tree: &Tree, gravity: Vec3) -> Id {
    let graph = &mut lowering.graph;
    let mut down: Vec<Vec3> = vec![gravity];
    for hinge in tree.hinges.iter().skip(1) {
        let local = hinge.rotation.to_child(graph, down[hinge.parent]);
        down.push(local);
    }
    let mut depths: Vec<Id> = vec![graph.zero()];
    for point in tree.points.iter().skip(1) {
        let step = vector::dot(graph, &down[point.hinge], &point.vector);
        let depth = graph.add(depths[point.parent], step);
        depths.push(depth);
    }
    let mut total = graph.zero();
    for attachment in &tree.attachments {
        let weight = graph.mul(attachment.inertia.mass, depths[attachment.point]);
        let moment = vector::dot(graph, &down[attachment.hinge], &attachment.inertia.moment);
        let work = graph.add(weight, moment);
        total = graph.sub(total, work);
    }
    total
}
