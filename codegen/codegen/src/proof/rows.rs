//! Which rows are actuated: condition (f) on the derived input matrix B, and condition (a) on the
//! number of rows.

use super::certificate::Condition;
use super::certificate::Evidence;
use super::finding::Finding;
use super::problem::Problem;
use num_rational::BigRational;
use num_traits::{One, Signed};
use shapebot_model_dsl::{Span, codes};
use shapebot_symbolic::Id;

/// Roles of the rows.
#[derive(Default)]
pub(super) struct Rows {
    /// Actuated coordinates with their actuator.
    pub(super) actuated: Vec<(usize, String)>,
    pub(super) conditions: Vec<Condition>,
    pub(super) findings: Vec<Finding>,
}

/// Conditions (a) and (f).
pub(super) fn examine(problem: &Problem<'_>) -> Rows {
    let mut rows = Rows { actuated: actuated(problem), ..Rows::default() };
    let coupling = coupling(problem);
    let counted = if coupling.is_none() { count(problem) } else { None };
    let n_x = problem.n_x();
    let n_s = problem.len() - n_x;
    let k = if n_x > 0 && n_s.is_multiple_of(n_x) { n_s / n_x } else { 0 };
    let statement = |holds: bool| match holds {
        true => format!(
            "unactuated equations ({}): as many as position variables, {n_x}; n_s = {k} n_x",
            problem.names(problem.unactuated.iter().copied()),
        ),
        false => format!("n_x = {n_x} unactuated equations, n_s = k n_x"),
    };
    let a = match (&coupling, &counted) {
        (Some(_), _) => Evidence::NotExamined,
        (None, Some(_)) => Evidence::Fails,
        (None, None) => Evidence::Exact,
    };
    rows.conditions.push(Condition {
        letter: 'a',
        statement: statement(a == Evidence::Exact),
        evidence: a,
    });
    let f = if coupling.is_some() { Evidence::Fails } else { Evidence::Exact };
    rows.conditions.push(Condition {
        letter: 'f',
        statement: "the derived input matrix B is [1; 0] in the chosen coordinates".to_owned(),
        evidence: f,
    });
    rows.findings.extend(coupling);
    rows.findings.extend(counted);
    rows
}

/// Coordinates with exactly one actuator of coefficient one that works on nothing else.
fn actuated(problem: &Problem<'_>) -> Vec<(usize, String)> {
    let graph = &problem.graph;
    let input = &problem.equations.input;
    let entries = |i: usize| -> Vec<usize> {
        (0..input[i].len()).filter(|&j| !graph.is_zero(input[i][j])).collect()
    };
    let name = |j: usize| {
        problem.model.actuators.get(j).map_or_else(|| format!("tau_{j}"), |a| a.name.clone())
    };
    (0..problem.len())
        .filter_map(|i| match entries(i)[..] {
            [j] if input[i][j] == graph.one() => Some((i, name(j))),
            _ => None,
        })
        .collect()
}

/// Condition (f): the first actuator that does not work on exactly one coordinate, with coefficient one.
fn coupling(problem: &Problem<'_>) -> Option<Finding> {
    let graph = &problem.graph;
    let input = &problem.equations.input;
    let count = input.first().map_or(0, Vec::len);
    let column = |j: usize| -> Vec<(usize, Id)> {
        (0..problem.len()).map(|i| (i, input[i][j])).filter(|&(_, b)| !graph.is_zero(b)).collect()
    };
    let mut owner: Vec<Option<usize>> = vec![None; problem.len()];
    for j in 0..count {
        match column(j)[..] {
            [(i, entry)] if entry == graph.one() => {
                if let Some(other) = owner[i].replace(j) {
                    return Some(shared(problem, i, other, j));
                }
            }
            ref entries => return Some(coupled(problem, j, entries)),
        }
    }
    None
}

/// Span of an actuator.
fn actuator_span(problem: &Problem<'_>, j: usize) -> Span {
    problem.model.actuators.get(j).map_or(Span::default(), |a| a.span)
}

/// Two actuators on one coordinate.
fn shared(problem: &Problem<'_>, i: usize, first: usize, second: usize) -> Finding {
    let name = |j: usize| problem.model.actuators.get(j).map_or("", |a| a.name.as_str());
    Finding::new(
        codes::P0607,
        'f',
        actuator_span(problem, second),
        format!(
            "two actuators, `{}` and `{}`, work on `{}`",
            name(first),
            name(second),
            problem.name(i)
        ),
    )
    .label("the second one")
    .also([(actuator_span(problem, first), "the first one".to_owned())])
    .note("only their sum enters the equations of motion: they are one actuator to a planner")
    .help("declare one actuator and share its force out where it is sent to the drives")
}

/// An actuator that works on several coordinates, or on one with a coefficient.
fn coupled(problem: &Problem<'_>, j: usize, entries: &[(usize, Id)]) -> Finding {
    let Some(actuator) = problem.model.actuators.get(j) else {
        return Finding::new(codes::P0607, 'f', Span::default(), "the input matrix is not [1; 0]");
    };
    let mut text = source_text(problem, actuator.displacement);
    if text.is_empty() {
        text = spelled_out(problem, entries).unwrap_or_else(|| "its displacement".to_owned());
    }
    let rows = entries
        .iter()
        .map(|&(i, b)| {
            format!("{} in the row of `{}`", coefficient_text(problem, b), problem.name(i))
        })
        .collect::<Vec<_>>()
        .join(", ");
    let title = if entries.len() > 1 {
        format!(
            "`{}` drives {} equations at once: the input matrix couples them",
            actuator.name,
            entries.len()
        )
    } else {
        format!("`{}` does not enter its equation with the coefficient one", actuator.name)
    };
    let finding = Finding::new(codes::P0607, 'f', actuator.span, title)
        .label(format!("does work on the rate of `{text}`"))
        .note(format!("by virtual work its column of B is {rows}"))
        .note(
            "an equation counts as unactuated only if no actuator enters it: the planner's dynamic \
             constraint (Eq. 6) must be free of forces",
        );
    match suggestion(problem, &text, entries) {
        Some(help) => finding.help(help),
        None => finding.help(format!("choose `{text}` itself as a coordinate")),
    }
}

/// `wheel - body` is the coordinate that would do: with it in place of one of those it is made of.
fn suggestion(problem: &Problem<'_>, text: &str, entries: &[(usize, Id)]) -> Option<String> {
    let coefficients: Vec<(usize, BigRational)> = entries
        .iter()
        .map(|&(i, b)| Some((i, problem.graph.as_constant(b)?.clone())))
        .collect::<Option<_>>()?;
    let &(replaced, ref own) = coefficients.iter().find(|(_, c)| c.abs().is_one())?;
    let coordinate = problem.model.coordinates.get(replaced)?;
    let fresh = fresh_name(problem, &coordinate.name);
    // c_r q_r + Σ c_i q_i = new, solved for q_r.
    let mut solved = if own.is_positive() { fresh.clone() } else { format!("-{fresh}") };
    for (i, c) in coefficients.iter().filter(|(i, _)| *i != replaced) {
        let moved = -c / own;
        let sign = if moved.is_negative() { '-' } else { '+' };
        let size = moved.abs();
        let factor = if size.is_one() { String::new() } else { format!("{size}*") };
        solved.push_str(&format!(" {sign} {factor}{}", problem.name(*i)));
    }
    let role = match coordinate.role {
        shapebot_model_dsl::model::Role::Position => "position",
        shapebot_model_dsl::model::Role::Shape => "shape",
    };
    let name = &coordinate.path;
    Some(format!(
        "the coordinate that removes the coupling is `{text}`: declare `{role} {fresh}: {};` for it in \
         place of `{name}`, put `let {} = {solved};`, and let the actuator work on `d/dt({fresh})`",
        coordinate.unit.text, coordinate.name,
    ))
}

/// A name that no coordinate has.
fn fresh_name(problem: &Problem<'_>, base: &str) -> String {
    let taken = |name: &str| problem.model.coordinates.iter().any(|c| c.name == name);
    let mut name = format!("{base}_rel");
    while taken(&name) {
        name.push('_');
    }
    name
}

fn source_text(problem: &Problem<'_>, expr: shapebot_model_dsl::model::ExprId) -> String {
    if (expr.0 as usize) < problem.model.expressions.len() {
        problem.model.text(problem.model.expr_span(expr)).trim().to_owned()
    } else {
        String::new()
    }
}

/// `theta - phi`, from the column of B, if that is constant.
fn spelled_out(problem: &Problem<'_>, entries: &[(usize, Id)]) -> Option<String> {
    let mut text = String::new();
    for &(i, b) in entries {
        let c = problem.graph.as_constant(b)?;
        let sign = match (text.is_empty(), c.is_negative()) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        let factor = if c.abs().is_one() { String::new() } else { format!("{}*", c.abs()) };
        text.push_str(&format!("{sign}{factor}{}", problem.name(i)));
    }
    Some(text)
}

fn coefficient_text(problem: &Problem<'_>, b: Id) -> String {
    match problem.graph.as_constant(b) {
        Some(c) if c.is_positive() => format!("+{c}"),
        Some(c) => c.to_string(),
        None => "a factor that is not constant".to_owned(),
    }
}

/// Condition (a).
fn count(problem: &Problem<'_>) -> Option<Finding> {
    let (n, n_x) = (problem.len(), problem.n_x());
    let free = problem.unactuated.len();
    let span = |i: usize| problem.model.coordinates.get(i).map_or(Span::default(), |c| c.span);
    if n_x == 0 {
        return Some(
            Finding::new(codes::P0601, 'a', span(0), "the robot has no position variables")
                .label("all coordinates are declared as shape")
                .help("declare the coordinates that say where the robot is with `position`"),
        );
    }
    if free != n_x {
        let places =
            problem.unactuated.iter().map(|&i| (span(i), "no actuator works on this".to_owned()));
        let help = if free > n_x {
            format!("add {} actuator(s), or declare fewer coordinates as shape", free - n_x)
        } else {
            format!("a robot with {n_x} position variables must leave {n_x} coordinates to balance")
        };
        return Some(
            Finding::new(
                codes::P0601,
                'a',
                span(0),
                format!("{free} unactuated equations for {n_x} position variables"),
            )
            .label(format!("{n_x} position variables are declared"))
            .also(places)
            .note("the unactuated equations are solved for the accelerations of the position variables (Theorem 1)")
            .help(help),
        );
    }
    let n_s = n - n_x;
    (n_s == 0 || !n_s.is_multiple_of(n_x)).then(|| {
        Finding::new(
            codes::P0601,
            'a',
            span(n_x.min(n - 1)),
            format!("{n_s} shape variables are no multiple of {n_x} position variables"),
        )
        .label("shape variables come in sets of n_x")
        .help(format!("declare shape variables in vectors of {n_x}"))
    })
}
