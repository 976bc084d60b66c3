//! Condition (b): the unactuated equations do not see where the robot is or how fast it moves; and the
//! strict class of Eqs. 3-5.

use super::certificate::{Condition, Evidence, PositionFacts, Strict};
use super::finding::Finding;
use super::problem::{Problem, index};
use shapebot_model_dsl::{Span, codes};
use shapebot_symbolic::Symbol;

/// Condition (b), with one finding per position variable and kind.
pub(super) fn independence(problem: &mut Problem<'_>) -> (Condition, Vec<Finding>) {
    let mut findings = Vec::new();
    for x in 0..problem.n_x() {
        // Inertia that depends on q_x makes forces that depend on q̇_x: one message is enough.
        let by_position = position_dependence(problem, x);
        findings.extend(by_position.or_else(|| rate_dependence(problem, x)));
    }
    let statement = format!(
        "the unactuated equations ({}) are free of q_x = ({}) and q_x'",
        problem.names(problem.unactuated.iter().copied()),
        problem.names(0..problem.n_x()),
    );
    let evidence = if findings.is_empty() { Evidence::Exact } else { Evidence::Fails };
    (Condition { letter: 'b', statement, evidence }, findings)
}

/// P0602: M, C q̇ or G of an unactuated row depends on q_x.
fn position_dependence(problem: &mut Problem<'_>, x: usize) -> Option<Finding> {
    let symbol = Symbol::Coordinate(index(x));
    let equations = problem.equations;
    for u in problem.unactuated.clone() {
        for j in 0..problem.len() {
            if problem.depends(equations.mass[u][j], symbol) {
                let blame = problem.sources_where(|p, s| {
                    let entry = p.mass_of(s, u, j);
                    p.depends(entry, symbol)
                });
                let quantity = format!("M[{}, {}]", problem.name(u), problem.name(j));
                return Some(position_finding(problem, u, x, &quantity, &blame, "inertia"));
            }
        }
        if problem.depends(equations.gravity[u], symbol) {
            let blame = problem.sources_where(|p, s| {
                let entry = p.gravity_of(s, u);
                p.depends(entry, symbol)
            });
            let quantity = format!("G[{}]", problem.name(u));
            return Some(position_finding(problem, u, x, &quantity, &blame, "potential"));
        }
        if problem.depends(equations.bias[u], symbol) {
            let blame = problem.sources_where(|p, s| {
                let entry = p.bias_of(s, u);
                p.depends(entry, symbol)
            });
            let quantity = format!("(C q')[{}]", problem.name(u));
            return Some(position_finding(problem, u, x, &quantity, &blame, "inertia"));
        }
    }
    None
}

fn position_finding(
    problem: &Problem<'_>,
    u: usize,
    x: usize,
    quantity: &str,
    blame: &[usize],
    kind: &str,
) -> Finding {
    let (row, position) = (problem.name(u), problem.name(x));
    let help = if kind == "inertia" {
        format!(
            "if `{position}` is a matter of where, not of how the robot stands, write this term without \
             it, or drop the part that depends on it as a small one; else declare `{position}` as shape"
        )
    } else {
        format!(
            "a force that depends on `{position}` (a spring, a slope) belongs to the plant, not to the \
             planner's model; else declare `{position}` as shape"
        )
    };
    Finding::new(
        codes::P0602,
        'b',
        coordinate_span(problem, x),
        format!("the unactuated equation of `{row}` depends on the position variable `{position}`"),
    )
    .blame(problem, blame, &format!("makes {quantity} depend on `{position}`"))
    .note("the dynamic constraint (Eq. 6) has to be the same wherever the robot is: that makes Γ a function of shape alone (Eq. 9)")
    .help(help)
}

/// P0603: C q̇ of an unactuated row depends on q̇_x.
fn rate_dependence(problem: &mut Problem<'_>, x: usize) -> Option<Finding> {
    let symbol = Symbol::Rate(index(x));
    for u in problem.unactuated.clone() {
        if !problem.depends(problem.equations.bias[u], symbol) {
            continue;
        }
        let blame = problem.sources_where(|p, s| {
            let entry = p.bias_of(s, u);
            p.depends(entry, symbol)
        });
        let (row, position) = (problem.name(u), problem.name(x));
        let what = format!("makes (C q')[{row}] depend on the rate of `{position}`");
        return Some(
            Finding::new(
                codes::P0603,
                'b',
                coordinate_span(problem, x),
                format!("the unactuated equation of `{row}` depends on the rate of `{position}`"),
            )
            .blame(problem, &blame, &what)
            .note(format!(
                "centrifugal and Coriolis forces of the position's own motion: the inertia that \
                 `{position}` moves changes with the shape, or with where it is"
            ))
            .help(format!(
                "a planner of this class cannot balance against the speed of `{position}`; describe \
                 the motion by a coordinate whose inertia is constant, or declare `{position}` as shape"
            )),
        );
    }
    None
}

/// Where a coordinate is declared.
pub(super) fn coordinate_span(problem: &Problem<'_>, i: usize) -> Span {
    problem.model.coordinates.get(i).map_or(Span::default(), |c| c.span)
}

/// Eqs. 3-5 for all rows, and what each position variable offers to a controller.
pub(super) fn strict(problem: &mut Problem<'_>) -> (Strict, Vec<PositionFacts>) {
    let equations = problem.equations;
    let (mut departures, mut positions) = (Vec::new(), Vec::new());
    for x in 0..problem.n_x() {
        let (q, qd) = (Symbol::Coordinate(index(x)), Symbol::Rate(index(x)));
        let n = problem.len();
        let inertia = (0..n).any(|i| (i..n).any(|j| problem.depends(equations.mass[i][j], q)));
        let coriolis = (0..n).any(|i| problem.depends(equations.bias[i], q));
        let rate = (0..n).any(|i| problem.depends(equations.bias[i], qd));
        let gravity = (0..n).any(|i| problem.depends(equations.gravity[i], q));
        let acts = !problem.graph.is_zero(equations.gravity[x]);
        let name = problem.name(x);
        let said = [
            (inertia, format!("M depends on {name}")),
            (coriolis && !inertia, format!("C depends on {name}")),
            (rate, format!("C depends on the rate of {name}")),
            (gravity, format!("G depends on {name}")),
            (acts, format!("G[{name}] is not zero")),
        ];
        departures.extend(said.into_iter().filter(|(holds, _)| *holds).map(|(_, text)| text));
        let actuated = !problem.unactuated.contains(&x);
        let cyclic = !inertia && !gravity && !acts;
        positions.push(PositionFacts {
            coordinate: name,
            actuated,
            cyclic,
            momentum_observer: actuated && cyclic,
        });
    }
    let holds = departures.is_empty() && problem.n_x() > 0;
    (Strict { holds, departures }, positions)
}
