//! Conditions (c), (d) and (e): the map Γ exists near the origin (Theorem 1), the origin is an
//! equilibrium, and K⁰_qs (Eq. 16) reaches every acceleration.

use super::certificate::{Condition, Evidence, RangeClaim, SetGain, ShapeMap};
use super::conditions::coordinate_span;
use super::finding::Finding;
use super::linear::{identity, product, solve, transpose};
use super::problem::{Problem, determinant, gram};
use super::range;
use shapebot_model_dsl::codes;
use shapebot_model_dsl::model::Role;
use shapebot_symbolic::Id;

/// What became of conditions (c), (d) and (e).
#[derive(Default)]
pub(super) struct Examined {
    pub(super) map: Option<ShapeMap>,
    pub(super) conditions: Vec<Condition>,
    pub(super) findings: Vec<Finding>,
    pub(super) warnings: Vec<Finding>,
}

/// Conditions (c) to (e); the rows must be known, and free of the position variables.
pub(super) fn examine(problem: &mut Problem<'_>) -> Examined {
    let mut out = Examined::default();
    let positions: Vec<usize> = (0..problem.n_x()).collect();
    let coupling = problem.mass(&problem.unactuated.clone(), &positions);
    let at_zero = problem.matrix_at_origin(&coupling);
    if problem.graph.singular().is_some() {
        out.findings.push(irregular(problem));
        out.conditions = ['c', 'd', 'e'].map(not_examined).into();
        return out;
    }
    let full = determinant(&mut problem.graph, &coupling);
    let at_origin = determinant(&mut problem.graph, &at_zero);
    let singular = singular_at_origin(problem, &at_zero, at_origin);
    let mut claims = (RangeClaim::NothingVaries, RangeClaim::NothingVaries);
    if singular.is_none() {
        claims = range::claims(problem, full, at_origin);
    }
    let breaks = range::finding(problem, &claims.0);
    out.conditions.push(invertible(problem, at_origin, singular.is_none(), breaks.is_none()));
    let unbalanced = equilibrium(problem);
    out.conditions.push(Condition {
        letter: 'd',
        statement: "the origin is an equilibrium of the unactuated equations: G_u(0) = 0"
            .to_owned(),
        evidence: if unbalanced.is_none() { Evidence::Exact } else { Evidence::Fails },
    });
    let blocked = singular.is_some() || unbalanced.is_some();
    out.findings.extend(singular);
    out.findings.extend(breaks);
    out.findings.extend(unbalanced);
    if blocked {
        out.conditions.push(not_examined('e'));
        return out;
    }
    gain(problem, &at_zero, at_origin, claims, &mut out);
    out
}

pub(super) fn not_examined(letter: char) -> Condition {
    let statement = match letter {
        'b' => "the unactuated equations are free of q_x and q_x'",
        'c' => "M_{u,x} is invertible at the origin and over the declared ranges",
        'd' => "the origin is an equilibrium of the unactuated equations: G_u(0) = 0",
        _ => "K0_qs has full row rank",
    };
    Condition { letter, statement: statement.to_owned(), evidence: Evidence::NotExamined }
}

/// Something divides by zero there.
fn irregular(problem: &Problem<'_>) -> Finding {
    Finding::new(
        codes::P0605,
        'd',
        coordinate_span(problem, 0),
        "the equations of motion are not defined at the origin",
    )
    .note("with all coordinates zero they divide by zero (or take a logarithm or a derivative of a root there)")
    .help("shift the coordinates so that the upright state is a regular point of the energies")
}

fn invertible(problem: &Problem<'_>, at_origin: Id, at_zero: bool, in_range: bool) -> Condition {
    let exact = problem.graph.as_constant(at_origin).is_some();
    let evidence = match (at_zero && in_range, exact) {
        (false, _) => Evidence::Fails,
        (true, true) => Evidence::Exact,
        (true, false) => Evidence::AtModelValues,
    };
    let statement = "M_{u,x} is invertible at the origin (Theorem 1)".to_owned();
    Condition { letter: 'c', statement, evidence }
}

/// P0604: det M_{u,x}(0) = 0, identically or at the model's values.
fn singular_at_origin(
    problem: &Problem<'_>,
    at_zero: &[Vec<Id>],
    at_origin: Id,
) -> Option<Finding> {
    if problem.surely_nonzero(at_origin) {
        return None;
    }
    let always = problem.graph.is_zero(at_origin);
    let rows = &problem.unactuated;
    let null = |id: Id| problem.graph.is_zero(id);
    let empty_column = (0..problem.n_x()).find(|&x| at_zero.iter().all(|row| null(row[x])));
    let empty_row = (0..rows.len()).find(|&r| at_zero[r].iter().all(|&id| null(id)));
    let (place, label) = match (empty_column, empty_row) {
        (Some(x), _) => (
            x,
            format!(
                "the acceleration of `{}` enters no unactuated equation at the origin",
                problem.name(x)
            ),
        ),
        (None, Some(r)) => (
            rows[r],
            format!(
                "the equation of `{}` contains no position acceleration at the origin",
                problem.name(rows[r])
            ),
        ),
        (None, None) => {
            (0, "the accelerations of the position variables cannot be told apart".to_owned())
        }
    };
    let whose = if always { "for all parameter values" } else { "at the model's parameter values" };
    Some(
        Finding::new(
            codes::P0604,
            'c',
            coordinate_span(problem, place),
            format!("det M_{{u,x}}(0) = 0 {whose}: no map Γ from shape to acceleration exists at the origin"),
        )
        .label(label)
        .note("by the implicit function theorem the unactuated equations determine the position accelerations only if M_{u,x}(0) is invertible (Theorem 1, Eq. 8)")
        .help("the unactuated bodies must feel the acceleration of the position variables: check that their centres of mass move with them, and that zero is the upright (not the horizontal) state"),
    )
}

/// P0605: G_u(0) is not zero for all parameter values.
fn equilibrium(problem: &mut Problem<'_>) -> Option<Finding> {
    let gravity: Vec<Id> =
        problem.unactuated.iter().map(|&u| problem.equations.gravity[u]).collect();
    let at_zero = problem.at_origin(&gravity);
    let worst = at_zero.iter().position(|&g| !problem.graph.is_zero(g))?;
    let u = problem.unactuated[worst];
    let blame = problem.sources_where(|p, s| {
        let force = p.gravity_of(s, u);
        let force = p.at_origin(&[force])[0];
        !p.graph.is_zero(force)
    });
    let force = problem.numbers(&at_zero)[worst];
    let row = problem.name(u);
    let unit = problem.model.coordinates.get(u).map_or("rad", |c| c.unit.text.as_str());
    let force_unit = if unit == "m" { "N" } else { "N*m" };
    let finding = Finding::new(
        codes::P0605,
        'd',
        coordinate_span(problem, u),
        format!("the origin is no equilibrium: nothing holds `{row}` there"),
    )
    .blame(problem, &blame, &format!("pulls on `{row}` at the origin"))
    .note(format!("at the model's values {force:.4} {force_unit} remain in the equation of `{row}`, which no actuator enters"));
    Some(match range::equilibrium_near_origin(problem) {
        Some(place) => finding.help(format!(
            "measure the coordinates from the equilibrium: it lies at {place}; subtract these offsets \
             where the coordinates enter the geometry"
        )),
        None => finding.help("measure the coordinates from the state in which the robot balances at rest"),
    })
}

/// Condition (e), K⁰_qs with its blocks, and Theorem 2.
fn gain(
    problem: &mut Problem<'_>,
    at_zero: &[Vec<Id>],
    at_origin: Id,
    claims: (RangeClaim, RangeClaim),
    out: &mut Examined,
) {
    let shape: Vec<usize> = (problem.n_x()..problem.len()).collect();
    let stiffness = stiffness(problem, &shape);
    let square = gram(&mut problem.graph, &stiffness);
    let rank = determinant(&mut problem.graph, &square);
    let full = problem.surely_nonzero(rank);
    let statement =
        "K0_qs has full row rank: every acceleration is reached from some shape".to_owned();
    let evidence = if full { Evidence::AtModelValues } else { Evidence::Fails };
    out.conditions.push(Condition { letter: 'e', statement, evidence });
    if !full {
        out.findings.push(rank_deficient(problem, &stiffness, rank));
        return;
    }
    let sets = set_gains(problem, &stiffness);
    out.warnings.extend(sets.iter().filter(|s| !s.nonsingular).map(|s| weak_set(problem, s)));
    let invertible = shape.len() == problem.n_x();
    let (m, g) = (problem.numeric(at_zero), problem.numeric(&stiffness));
    let negative: Vec<Vec<f64>> = g.iter().map(|row| row.iter().map(|v| -v).collect()).collect();
    // −0 in a table of gains looks like a mistake.
    let clean = |row: &Vec<f64>| row.iter().map(|v| v + 0.0).collect();
    let gain = solve(&m, &negative).map(|k| k.iter().map(clean).collect()).unwrap_or_default();
    out.map = Some(ShapeMap {
        determinant: problem.numbers(&[at_origin])[0],
        over_coordinates: claims.0,
        over_parameters: claims.1,
        gain,
        sets,
        invertible,
    });
}

/// ∂G_u/∂q_s at the origin (Eq. 18).
pub(super) fn stiffness(problem: &mut Problem<'_>, columns: &[usize]) -> Vec<Vec<Id>> {
    let rows = problem.unactuated.clone();
    let slopes: Vec<Vec<Id>> = rows
        .iter()
        .map(|&u| {
            let force = problem.equations.gravity[u];
            columns.iter().map(|&s| problem.by_q(s, force)).collect()
        })
        .collect();
    problem.matrix_at_origin(&slopes)
}

fn rank_deficient(problem: &Problem<'_>, stiffness: &[Vec<Id>], rank: Id) -> Finding {
    let zero_row = stiffness.iter().position(|row| row.iter().all(|&id| problem.graph.is_zero(id)));
    let place = zero_row.map_or(0, |r| problem.unactuated[r]);
    let whose = if problem.graph.is_zero(rank) {
        "for all parameter values"
    } else {
        "at the model's values"
    };
    let label = match zero_row {
        Some(_) => format!("gravity (or a spring) puts nothing into the equation of `{}` when the shape changes", problem.name(place)),
        None => "the unactuated equations feel the shape in fewer directions than there are position variables".to_owned(),
    };
    Finding::new(
        codes::P0606,
        'e',
        coordinate_span(problem, place),
        format!("K0_qs is not of full row rank {whose}: some acceleration is reached from no shape"),
    )
    .label(label)
    .note("K0_qs = -M_{u,x}(0)^-1 dG_u/dq_s(0) (Eq. 16) is what the planner turns accelerations into shapes with")
    .help("check that `gravity` is declared and that the centre of mass lies off the axis about which the robot leans")
}

fn set_gains(problem: &mut Problem<'_>, stiffness: &[Vec<Id>]) -> Vec<SetGain> {
    let n_x = problem.n_x();
    let sets: Vec<_> =
        problem.model.sets.iter().filter(|s| s.role == Role::Shape).cloned().collect();
    let mut gains = Vec::new();
    for set in sets {
        let columns: Vec<usize> = set.coordinates.iter().map(|c| c.0 as usize - n_x).collect();
        let block: Vec<Vec<Id>> =
            stiffness.iter().map(|row| columns.iter().map(|&c| row[c]).collect()).collect();
        let nonsingular = columns.len() == n_x && {
            let det = determinant(&mut problem.graph, &block);
            problem.surely_nonzero(det)
        };
        gains.push(SetGain { name: set.name, size: columns.len(), nonsingular });
    }
    gains
}

/// P0612.
fn weak_set(problem: &Problem<'_>, set: &SetGain) -> Finding {
    let n_x = problem.n_x();
    let declared = problem.model.sets.iter().find(|s| s.name == set.name && s.role == Role::Shape);
    let span = declared.map_or_else(|| coordinate_span(problem, n_x), |s| s.span);
    let label = if set.size == n_x {
        "its block of K0_qs is singular".to_owned()
    } else {
        format!(
            "its block of K0_qs is not square: {} coordinates for {n_x} position variables",
            set.size
        )
    };
    Finding::new(
        codes::P0612,
        'e',
        span,
        format!("shape set `{}` cannot make every acceleration on its own", set.name),
    )
    .label(label)
    .note("weights that let only this set move (Eqs. 24-30) have no solution; with other sets it still helps")
}

/// ẍ = u − τ² ü near the origin, q_s = K⁰_qx u with K⁰_qx the minimum-norm inverse (Eq. 24, W = 1)
/// through some shape variables: τ² of the position variables and of the output.
pub(super) fn time_constants(
    problem: &mut Problem<'_>,
    gain: &[Vec<f64>],
    through: &[usize],
) -> Option<[Vec<Vec<f64>>; 2]> {
    let n_x = problem.n_x();
    let rows = problem.unactuated.clone();
    let positions: Vec<usize> = (0..n_x).collect();
    let (mx, ms) = (problem.mass(&rows, &positions), problem.mass(&rows, through));
    let (mx, ms) = (problem.matrix_at_origin(&mx), problem.matrix_at_origin(&ms));
    let (mx, ms) = (problem.numeric(&mx), problem.numeric(&ms));
    let k: Vec<Vec<f64>> =
        gain.iter().map(|row| through.iter().map(|&s| row[s - n_x]).collect()).collect();
    let kt = transpose(&k);
    let inverse = product(&kt, &solve(&product(&k, &kt), &identity(n_x))?);
    let constants = solve(&mx, &product(&ms, &inverse))?;
    // h moves with the shape as well: ∂h/∂q_x (u − τ² ü) + ∂h/∂q_s K⁰_qx ü.
    let (hx, hs) = (output_slopes(problem, &positions), output_slopes(problem, through));
    let along = solve(&hx, &product(&hs, &inverse))?;
    let of_output = constants
        .iter()
        .zip(&along)
        .map(|(row, part)| row.iter().zip(part).map(|(a, b)| a - b).collect())
        .collect();
    Some([constants, of_output])
}

/// Columns of ∂h/∂q at the origin.
fn output_slopes(problem: &mut Problem<'_>, columns: &[usize]) -> Vec<Vec<f64>> {
    let entries = problem.equations.output.clone();
    let slopes: Vec<Vec<Id>> =
        entries.iter().map(|&h| columns.iter().map(|&c| problem.by_q(c, h)).collect()).collect();
    let slopes = problem.matrix_at_origin(&slopes);
    problem.numeric(&slopes)
}
