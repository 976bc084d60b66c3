//! Positions, frames, the input matrix and the output.

use super::lower::{Lowering, number};
use super::mechanics::Mechanics;
use super::quantity::{Function, Quantity};
use super::select::{Candidate, Effort, choose, matrix, vector};
use super::vector as v3;
use shapebot_model_dsl::model::{Model, Position, Role};
use shapebot_symbolic::{Id, Symbol};

const DIRECT: &str = "as written";

/// Named points of a model, in the order in which [`Quantity::PointPosition`] counts them: declared
/// points, then centres of mass of rigid bodies, then centres of geometry.
#[must_use]
pub fn points(model: &Model) -> Vec<(String, &Position)> {
    let declared = model.points.iter().map(|p| (p.name.clone(), &p.position));
    let bodies = model.bodies.iter().map(|b| (format!("{}.com", b.name), &b.com));
    let solids = model.geometry.iter().map(|g| (format!("{}.center", g.name), &g.center));
    declared.chain(bodies).chain(solids).collect()
}

/// Functions of positions.
pub(crate) fn functions(base: &Mechanics<'_>) -> Vec<Function> {
    let model = base.lowering.model;
    let mut out = vec![center_of_mass(base)];
    for actuator in 0..model.actuators.len() {
        out.push(input_column(base, actuator));
    }
    for frame in 0..model.frames.len() {
        out.push(frame_rotation(base, frame));
    }
    for (index, (_, position)) in points(model).into_iter().enumerate() {
        out.extend(point(base, index, position));
    }
    out.extend(output(base));
    out
}

fn center_of_mass(base: &Mechanics<'_>) -> Function {
    let mut lowering = base.lowering.clone();
    let mut weighted = v3::zero(&lowering.graph);
    let mut total = lowering.graph.zero();
    for body in &base.lowering.model.bodies {
        let (mass, at) = (lowering.scalar(body.mass), lowering.position(&body.com));
        let part = v3::scale(&mut lowering.graph, mass, at);
        weighted = v3::add(&mut lowering.graph, weighted, part);
        total = lowering.graph.add(total, mass);
    }
    let graph = &mut lowering.graph;
    let center =
        if graph.is_zero(total) { weighted } else { weighted.map(|w| graph.div(w, total)) };
    let candidate = Candidate::new(DIRECT, graph, vec![vector("position", center.to_vec())]);
    choose(Quantity::CenterOfMass, vec![candidate], Effort::Quick)
}

/// ∂(displacement)/∂q of one actuator: a column of B by virtual work.
pub(crate) fn column(lowering: &mut Lowering<'_>, actuator: usize) -> Vec<Id> {
    let model = lowering.model;
    let Some(actuator) = model.actuators.get(actuator) else { return Vec::new() };
    let displacement = lowering.scalar(actuator.displacement);
    super::tree::slopes(lowering, displacement)
}

fn input_column(base: &Mechanics<'_>, actuator: usize) -> Function {
    let mut lowering = base.lowering.clone();
    let column = column(&mut lowering, actuator);
    let candidate = Candidate::new(DIRECT, &lowering.graph, vec![vector("force", column)]);
    choose(Quantity::InputColumn(actuator), vec![candidate], Effort::Quick)
}

fn frame_rotation(base: &Mechanics<'_>, frame: usize) -> Function {
    let mut lowering = base.lowering.clone();
    let id = shapebot_model_dsl::model::FrameId(number(frame));
    let columns = [0, 1, 2].map(|k| {
        let axis = v3::unit(&lowering.graph, k);
        lowering.world_components(id, axis)
    });
    let rows: Vec<Vec<Id>> = (0..3).map(|i| columns.iter().map(|c| c[i]).collect()).collect();
    let candidate = Candidate::new(DIRECT, &lowering.graph, vec![matrix("rotation", &rows)]);
    choose(Quantity::FrameRotation(frame), vec![candidate], Effort::Quick)
}

fn point(base: &Mechanics<'_>, index: usize, position: &Position) -> [Function; 2] {
    let mut lowering = base.lowering.clone();
    let at = lowering.position(position);
    let place = Candidate::new(DIRECT, &lowering.graph, vec![vector("position", at.to_vec())]);
    let place = choose(Quantity::PointPosition(index), vec![place], Effort::Quick);
    let rows: Vec<Vec<Id>> = at.iter().map(|&x| super::tree::slopes(&mut lowering, x)).collect();
    let slopes = Candidate::new(DIRECT, &lowering.graph, vec![matrix("jacobian", &rows)]);
    [place, choose(Quantity::PointJacobian(index), vec![slopes], Effort::Quick)]
}

/// Entries of the task-space output: declared, else the position coordinates.
pub(crate) fn output_entries(lowering: &mut Lowering<'_>) -> Vec<Id> {
    let model = lowering.model;
    match &model.output {
        Some(output) => output.entries.iter().map(|&e| lowering.scalar(e)).collect(),
        None => {
            let positions = 0..number(model.position_count());
            positions.map(|i| lowering.graph.symbol(Symbol::Coordinate(i))).collect()
        }
    }
}

fn output(base: &Mechanics<'_>) -> Vec<Function> {
    let mut lowering = base.lowering.clone();
    let entries = output_entries(&mut lowering);
    let rows: Vec<Vec<Id>> =
        entries.iter().map(|&e| super::tree::slopes(&mut lowering, e)).collect();
    let nx = base.lowering.model.coordinates.iter().filter(|c| c.role == Role::Position).count();
    let position: Vec<Vec<Id>> = rows.iter().map(|r| r[..nx].to_vec()).collect();
    let shape: Vec<Vec<Id>> = rows.iter().map(|r| r[nx..].to_vec()).collect();
    let parts = [
        (Quantity::Output, vector("output", entries)),
        (Quantity::OutputJacobianPosition, matrix("jacobian", &position)),
        (Quantity::OutputJacobianShape, matrix("jacobian", &shape)),
    ];
    parts
        .into_iter()
        .map(|(quantity, block)| {
            let candidate = Candidate::new(DIRECT, &lowering.graph, vec![block]);
            choose(quantity, vec![candidate], Effort::Quick)
        })
        .collect()
}
