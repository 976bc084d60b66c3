//! M_{u,x} over the declared ranges: interval subdivision first, samples where its budget runs out, and
//! the certificate says which of the two it was.

use super::certificate::RangeClaim;
use super::conditions::coordinate_span;
use super::finding::Finding;
use super::linear::solve;
use super::problem::{Problem, index};
use shapebot_model_dsl::codes;
use shapebot_symbolic::field::pseudo_random;
use shapebot_symbolic::interval::{Interval, Tape, Verdict, prove_nonzero};
use shapebot_symbolic::{Id, Symbol, symbols_of};
use std::collections::{BTreeMap, HashMap};

/// Interval operations spent per claim.
const BUDGET: usize = 300_000;
/// Points looked at where the budget runs out.
const SAMPLES: usize = 400;
/// A determinant that falls below this part of its value at the origin counts as singular.
const LOST: f64 = 1e-6;
/// At samples it must keep this part of its value at the origin to count as holding there.
const KEPT: f64 = 1e-3;

/// The claims over coordinates, and over coordinates and parameters.
pub(super) fn claims(problem: &Problem<'_>, det: Id, at_origin: Id) -> (RangeClaim, RangeClaim) {
    let symbols = symbols_of(&problem.graph, &[det]);
    let unbounded: Vec<String> = symbols
        .iter()
        .filter_map(|symbol| match *symbol {
            Symbol::Coordinate(i) if coordinate_range(problem, i).is_none() => {
                Some(problem.name(i as usize))
            }
            _ => None,
        })
        .collect();
    let ranged = |symbol: &Symbol| match *symbol {
        Symbol::Parameter(i) => parameter_range(problem, i).is_some(),
        _ => false,
    };
    if !unbounded.is_empty() {
        let none = RangeClaim::NoRange { coordinates: unbounded };
        return (none.clone(), none);
    }
    let moves = symbols.iter().any(|s| matches!(s, Symbol::Coordinate(_)));
    let claim = |fixed: bool| claim(problem, det, at_origin, fixed);
    let first = if moves { claim(true) } else { RangeClaim::NothingVaries };
    let second = if symbols.iter().any(ranged) { claim(false) } else { RangeClaim::NothingVaries };
    (first, second)
}

fn coordinate_range(problem: &Problem<'_>, i: u32) -> Option<Interval> {
    let range = problem.model.coordinates.get(i as usize)?.range?;
    Some(Interval::new(range.lower, range.upper))
}

fn parameter_range(problem: &Problem<'_>, i: u32) -> Option<Interval> {
    let range = problem.model.parameters.get(i as usize)?.range?;
    Some(Interval::new(range.lower, range.upper))
}

fn box_of(problem: &Problem<'_>, symbol: Symbol, fixed: bool) -> Interval {
    match symbol {
        Symbol::Coordinate(i) => coordinate_range(problem, i).unwrap_or(Interval::ENTIRE),
        Symbol::Parameter(i) => match parameter_range(problem, i) {
            Some(range) if !fixed => range,
            _ => Interval::around(problem.value_of(symbol)),
        },
        _ => Interval::ZERO,
    }
}

fn claim(problem: &Problem<'_>, det: Id, at_origin: Id, fixed: bool) -> RangeClaim {
    let boxes: BTreeMap<Symbol, Interval> = symbols_of(&problem.graph, &[det])
        .into_iter()
        .map(|symbol| (symbol, box_of(problem, symbol, fixed)))
        .collect();
    match prove_nonzero(&problem.graph, det, &boxes, BUDGET) {
        // Up to 90° the double nearest to 90° keeps cos above zero, by 6e-17: proved, and useless.
        Verdict::Proved { boxes: count } => {
            match least_ratio(problem, det, at_origin, &boxes, None) {
                (ratio, point) if ratio < LOST => {
                    RangeClaim::Fails { at: problem.named_point(&point, fixed) }
                }
                _ => RangeClaim::Proved { boxes: count },
            }
        }
        Verdict::Refuted { point } => RangeClaim::Fails { at: problem.named_point(&point, fixed) },
        Verdict::Undecided { at } => sampled(problem, det, at_origin, &boxes, at, fixed),
    }
}

/// Samples, the point that subdivision found worst among them.
fn sampled(
    problem: &Problem<'_>,
    det: Id,
    at_origin: Id,
    boxes: &BTreeMap<Symbol, Interval>,
    worst: BTreeMap<Symbol, f64>,
    fixed: bool,
) -> RangeClaim {
    let (ratio, point) = least_ratio(problem, det, at_origin, boxes, Some(worst));
    let at = problem.named_point(&point, fixed);
    match ratio {
        ratio if ratio < LOST => RangeClaim::Fails { at },
        ratio if ratio > KEPT => RangeClaim::SampledOnly { samples: SAMPLES },
        _ => RangeClaim::Undecided { at },
    }
}

/// The smallest part of its value at the origin that the determinant keeps at samples, and where.
fn least_ratio(
    problem: &Problem<'_>,
    det: Id,
    at_origin: Id,
    boxes: &BTreeMap<Symbol, Interval>,
    known: Option<BTreeMap<Symbol, f64>>,
) -> (f64, BTreeMap<Symbol, f64>) {
    let tape = Tape::new(&problem.graph, &[det, at_origin]);
    let relative = |point: &BTreeMap<Symbol, f64>| {
        let value = |s: &Symbol| point.get(s).copied().unwrap_or_else(|| problem.value_of(*s));
        let values = tape.at(&tape.inputs().iter().map(value).collect::<Vec<f64>>());
        // NaN counts as lost.
        let ratio = (values[0] / values[1]).abs();
        if ratio.is_nan() { 0.0 } else { ratio }
    };
    known
        .into_iter()
        .chain((0..SAMPLES).map(|sample| sample_point(boxes, sample)))
        .map(|point| (relative(&point), point))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or_default()
}

/// A fixed pseudo-random point of a box; every fourth one a corner.
pub(super) fn sample_point(
    boxes: &BTreeMap<Symbol, Interval>,
    sample: usize,
) -> BTreeMap<Symbol, f64> {
    let corner = sample.is_multiple_of(4);
    boxes
        .iter()
        .enumerate()
        .map(|(k, (&symbol, x))| {
            #[allow(clippy::cast_precision_loss)]
            let t = pseudo_random(&[0x5a, sample as u64, k as u64]).value() as f64
                / (1_u64 << 61) as f64;
            let t = if corner { t.round() } else { t };
            (symbol, x.lower + t * x.width())
        })
        .collect()
}

/// Ranges of all coordinates, zero where none is declared, parameters at the model's values.
pub(super) fn coordinate_boxes(
    problem: &Problem<'_>,
    symbols: &[Symbol],
) -> BTreeMap<Symbol, Interval> {
    let bounded = |symbol: Symbol| match box_of(problem, symbol, true) {
        x if x.is_bounded() => x,
        _ => Interval::ZERO,
    };
    symbols.iter().map(|&symbol| (symbol, bounded(symbol))).collect()
}

/// P0613: M_{u,x} becomes singular within the declared ranges of the coordinates.
pub(super) fn finding(problem: &Problem<'_>, claim: &RangeClaim) -> Option<Finding> {
    let RangeClaim::Fails { at } = claim else { return None };
    let largest = at.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let place = largest
        .and_then(|(name, _)| problem.model.coordinates.iter().position(|c| c.path == *name));
    Some(
        Finding::new(
            codes::P0613,
            'c',
            coordinate_span(problem, place.unwrap_or(problem.n_x())),
            "M_{u,x} becomes singular within the declared ranges",
        )
        .label(format!("at {}", point_text(problem, at)))
        .note("there the unactuated equations no longer determine the position accelerations: Γ has a pole")
        .help(match place {
            Some(i) => format!("declare a smaller range for `{}`", problem.name(i)),
            None => "declare smaller ranges".to_owned(),
        }),
    )
}

/// `phi.x = 90.0 deg, s = 0.2 m`.
pub(super) fn point_text(problem: &Problem<'_>, at: &[(String, f64)]) -> String {
    let describe = |(name, value): &(String, f64)| {
        let angle = problem
            .model
            .coordinates
            .iter()
            .any(|c| c.path == *name && c.unit.dimension.exponents.iter().all(|e| e.0 == 0));
        if angle {
            format!("{name} = {:.2} deg", value.to_degrees())
        } else {
            format!("{name} = {value:.4}")
        }
    };
    at.iter().map(describe).collect::<Vec<_>>().join(", ")
}

/// Where the unactuated equations balance, by Newton's method on their own coordinates, as text.
pub(super) fn equilibrium_near_origin(problem: &mut Problem<'_>) -> Option<String> {
    let rows = problem.unactuated.clone();
    let n_x = problem.n_x();
    if rows.iter().any(|&u| u < n_x) {
        return None;
    }
    let forces: Vec<Id> = rows.iter().map(|&u| problem.equations.gravity[u]).collect();
    let mut values = forces.clone();
    for &force in &forces {
        for &u in &rows {
            values.push(problem.by_q(u, force));
        }
    }
    let tape = Tape::new(&problem.graph, &values);
    let mut point: HashMap<Symbol, f64> = HashMap::new();
    let n = rows.len();
    for _ in 0..30 {
        let value = |s: &Symbol| point.get(s).copied().unwrap_or_else(|| problem.value_of(*s));
        let v = tape.at(&tape.inputs().iter().map(value).collect::<Vec<f64>>());
        let residual: Vec<Vec<f64>> = v[..n].iter().map(|&g| vec![g]).collect();
        let slope: Vec<Vec<f64>> = v[n..].chunks(n).map(<[f64]>::to_vec).collect();
        let step = solve(&slope, &residual)?;
        for (k, &u) in rows.iter().enumerate() {
            *point.entry(Symbol::Coordinate(index(u))).or_insert(0.0) -= step[k][0];
        }
        let largest = step.iter().fold(0.0_f64, |m, s| m.max(s[0].abs()));
        if largest < 1e-12 {
            let at: Vec<(String, f64)> = rows
                .iter()
                .map(|&u| (problem.name(u), point[&Symbol::Coordinate(index(u))]))
                .collect();
            return at.iter().all(|(_, v)| v.abs() < 1.6).then(|| point_text(problem, &at));
        }
    }
    None
}
