//! The mass matrix is positive definite, the output is one: conditions on any model.

use super::certificate::MassFacts;
use super::conditions::coordinate_span;
use super::finding::Finding;
use super::linear::{cholesky, symmetric_eigenvalues};
use super::problem::{Problem, determinant, index};
use super::range::{coordinate_boxes, point_text, sample_point};
use shapebot_model_dsl::codes;
use shapebot_symbolic::interval::Tape;
use shapebot_symbolic::{Id, Symbol, symbols_of};

/// Points of the declared ranges at which the mass matrix is looked at.
const SAMPLES: usize = 32;

/// P0611: Cholesky at the origin and at samples of the declared ranges, at the model's values.
pub(super) fn examine(problem: &Problem<'_>) -> (MassFacts, Option<Finding>) {
    let n = problem.len();
    let flat: Vec<Id> = problem.equations.mass.iter().flatten().copied().collect();
    let tape = Tape::new(&problem.graph, &flat);
    let matrix = |value: &dyn Fn(&Symbol) -> f64| -> Vec<Vec<f64>> {
        let inputs: Vec<f64> = tape.inputs().iter().map(value).collect();
        tape.at(&inputs).chunks(n).map(<[f64]>::to_vec).collect()
    };
    let origin = matrix(&|&s| problem.value_of(s));
    if cholesky(&origin).is_none() {
        let facts = MassFacts { eigenvalues: (f64::NAN, f64::NAN), samples: 0 };
        return (facts, Some(indefinite_at_origin(problem, &origin)));
    }
    let values = symmetric_eigenvalues(&origin);
    let symbols: Vec<Symbol> = symbols_of(&problem.graph, &flat).into_iter().collect();
    let boxes = coordinate_boxes(problem, &symbols);
    let eigenvalues = (values[0], values[n - 1]);
    for sample in 0..SAMPLES {
        let point = sample_point(&boxes, sample);
        let there = matrix(&|s| match s {
            Symbol::Parameter(_) => problem.value_of(*s),
            _ => point.get(s).copied().unwrap_or(0.0),
        });
        if cholesky(&there).is_none() {
            let at = point_text(problem, &problem.named_point(&point, true));
            let finding = Finding::new(
                codes::P0611,
                '-',
                coordinate_span(problem, 0),
                format!("the mass matrix is not positive definite at {at}"),
            )
            .note("kinetic energy must be positive for every motion; at the origin it is")
            .help("check the kinetic terms there, or declare smaller ranges");
            return (MassFacts { eigenvalues, samples: sample }, Some(finding));
        }
    }
    (MassFacts { eigenvalues, samples: SAMPLES }, None)
}

fn indefinite_at_origin(problem: &Problem<'_>, origin: &[Vec<f64>]) -> Finding {
    let lacking = (0..origin.len()).find(|&i| origin[i][i].is_nan() || origin[i][i] <= 0.0);
    let place = lacking.unwrap_or(0);
    let name = problem.name(place);
    let label = match lacking {
        Some(i) if origin[i][i] == 0.0 => {
            format!("no kinetic energy is in the rate of `{name}` alone")
        }
        Some(i) if origin[i][i].is_nan() => {
            "the mass matrix is not defined at the origin".to_owned()
        }
        Some(_) => format!("moving `{name}` alone has negative kinetic energy"),
        None => "some combination of rates has no kinetic energy".to_owned(),
    };
    Finding::new(
        codes::P0611,
        '-',
        coordinate_span(problem, place),
        "the mass matrix is not positive definite at the origin and the model's parameter values",
    )
    .label(label)
    .note("accelerations follow from forces only if every motion has kinetic energy")
    .help("give every coordinate mass or inertia, and check the signs of kinetic terms")
}

/// P0609: n_x outputs, ∂h/∂q_x constant and nonsingular.
pub(super) fn output(problem: &mut Problem<'_>) -> Option<Finding> {
    let declared = problem.model.output.as_ref()?;
    let n_x = problem.n_x();
    let entries = problem.equations.output.clone();
    let wrong = |title: String| Some(Finding::new(codes::P0609, '-', declared.span, title));
    if entries.len() != n_x {
        let title =
            format!("the output has {} entries for {n_x} position variables", entries.len());
        return wrong(title).map(|f| f.help("give one entry per position variable"));
    }
    let mut jacobian = Vec::new();
    for (k, &entry) in entries.iter().enumerate() {
        let mut row = Vec::new();
        for x in 0..n_x {
            let slope = problem.by_q(x, entry);
            for j in 0..problem.len() {
                if problem.depends(slope, Symbol::Coordinate(index(j))) {
                    let name = declared.names.get(k).cloned().unwrap_or_default();
                    let (x, j) = (problem.name(x), problem.name(j));
                    return wrong(format!("the output `{name}` is not linear in `{x}`: its slope depends on `{j}`"))
                        .map(|f| f.note("the planner turns desired accelerations of the output into those of q_x by a constant matrix"));
                }
            }
            row.push(slope);
        }
        jacobian.push(row);
    }
    let det = determinant(&mut problem.graph, &jacobian);
    if problem.surely_nonzero(det) {
        return None;
    }
    wrong("the output does not determine the position: its Jacobian by the position variables is singular".to_owned())
        .map(|f| f.help("the entries of the output must move independently with the position variables"))
}
