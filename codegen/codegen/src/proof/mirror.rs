//! `require mirror(left, right)`: reflection of the robot in its x-z plane.
//!
//! A reflection acts on the coordinates by a signed permutation S that exchanges the listed pairs; the
//! dynamics are unchanged if T(S q, S q̇) = T(q, q̇) and V(S q) = V(q), which is decided exactly. Signs
//! follow from geometry: rotations about x and z turn the other way, rotations about y stay, and so do
//! displacements in the plane; the second entry of a planar output changes its sign. What geometry does
//! not tell is searched for.

use super::certificate::Mirror;
use super::finding::Finding;
use super::problem::{Problem, index};
use shapebot_model_dsl::model::{Axis, CoordinateId, Expr, ExprId, Requirement};
use shapebot_model_dsl::{Span, codes};
use shapebot_symbolic::field::pseudo_random;
use shapebot_symbolic::interval::Tape;
use shapebot_symbolic::{Id, Symbol, substitute, symbols_of};
use std::collections::{BTreeSet, HashMap};

/// More signs than this are not searched through.
const SEARCHED: usize = 10;

/// All mirror requirements.
pub(super) fn examine(problem: &mut Problem<'_>) -> (Vec<Mirror>, Vec<Finding>) {
    let (mut mirrors, mut findings) = (Vec::new(), Vec::new());
    let required = &problem.model.requirements;
    for demand in required {
        if let Requirement::Mirror { instances, exchanged } = &demand.requirement {
            match mirror(problem, instances, exchanged, demand.span) {
                Ok(found) => mirrors.push(found),
                Err(finding) => findings.push(*finding),
            }
        }
    }
    (mirrors, findings)
}

fn mirror(
    problem: &mut Problem<'_>,
    instances: &(String, String),
    exchanged: &[(CoordinateId, CoordinateId)],
    span: Span,
) -> Result<Mirror, Box<Finding>> {
    let image = permutation(problem.len(), exchanged);
    let known = geometric_signs(problem, &image);
    let open: Vec<usize> =
        (0..problem.len()).filter(|&i| known[i].is_none() && i <= image[i]).collect();
    let mut guess: Vec<bool> = known.iter().map(|flip| flip.unwrap_or(false)).collect();
    let candidates = 1_usize << open.len().min(SEARCHED);
    for candidate in 0..candidates {
        for (bit, &i) in open.iter().enumerate().take(SEARCHED) {
            let flip = candidate >> bit & 1 == 1;
            guess[i] = flip;
            guess[image[i]] = flip;
        }
        if plausible(problem, &image, &guess) && invariant(problem, &image, &guess) {
            let images = image.iter().copied().zip(guess.iter().copied()).collect();
            return Ok(Mirror { instances: instances.clone(), images });
        }
    }
    let guess: Vec<bool> = known.iter().map(|flip| flip.unwrap_or(false)).collect();
    Err(Box::new(broken(problem, instances, span, &image, &guess)))
}

fn permutation(n: usize, exchanged: &[(CoordinateId, CoordinateId)]) -> Vec<usize> {
    let mut image: Vec<usize> = (0..n).collect();
    for &(a, b) in exchanged {
        image.swap(a.0 as usize, b.0 as usize);
    }
    image
}

/// Whether each coordinate changes its sign, as far as frames and output tell.
fn geometric_signs(problem: &Problem<'_>, image: &[usize]) -> Vec<Option<bool>> {
    let mut flips: Vec<Option<bool>> = vec![None; problem.len()];
    for frame in &problem.model.frames {
        for &(axis, angle) in &frame.rotations {
            let mut used = BTreeSet::new();
            coordinates_in(problem, angle, &mut used);
            if let Some(&i) = used.first()
                && used.len() == 1
            {
                flips[i] = Some(axis != Axis::Y);
            }
        }
    }
    if let [along, across] = problem.equations.output[..] {
        for (entry, flip) in [(along, false), (across, true)] {
            for symbol in symbols_of(&problem.graph, &[entry]) {
                match symbol {
                    Symbol::Coordinate(i) if (i as usize) < problem.n_x() => {
                        flips[i as usize].get_or_insert(flip);
                    }
                    _ => {}
                }
            }
        }
    }
    // Exchanged coordinates change their signs together.
    (0..flips.len()).map(|i| flips[i].or(flips[image[i]])).collect()
}

fn coordinates_in(problem: &Problem<'_>, id: ExprId, used: &mut BTreeSet<usize>) {
    match *problem.model.expr(id) {
        Expr::Coordinate(c) => {
            used.insert(c.0 as usize);
        }
        Expr::Add(a, b) | Expr::Sub(a, b) | Expr::Mul(a, b) | Expr::Div(a, b) => {
            coordinates_in(problem, a, used);
            coordinates_in(problem, b, used);
        }
        Expr::Neg(a) | Expr::Power(a, _) => coordinates_in(problem, a, used),
        _ => {}
    }
}

/// T and V at a random point in doubles and at its image: rules most candidates out.
fn plausible(problem: &Problem<'_>, image: &[usize], flip: &[bool]) -> bool {
    let tape = Tape::new(&problem.graph, &[problem.equations.kinetic, problem.equations.potential]);
    #[allow(clippy::cast_precision_loss)]
    let random =
        |kind: u64, i: u64| pseudo_random(&[0x31, kind, i]).value() as f64 / (1_u64 << 61) as f64;
    let value = |symbol: Symbol, mirrored: bool| {
        let (kind, i) = match symbol {
            Symbol::Coordinate(i) => (1, i as usize),
            Symbol::Rate(i) => (2, i as usize),
            other => return problem.value_of(other),
        };
        let (from, sign) = match mirrored {
            true => (image[i], if flip[i] { -1.0 } else { 1.0 }),
            false => (i, 1.0),
        };
        sign * random(kind, from as u64)
    };
    let at = |mirrored: bool| {
        tape.at(&tape.inputs().iter().map(|&s| value(s, mirrored)).collect::<Vec<f64>>())
    };
    at(false).iter().zip(at(true)).all(|(a, b)| (a - b).abs() <= 1e-9 * (a.abs() + b.abs() + 1e-9))
}

/// Values with q and q̇ replaced by their images.
fn reflected(problem: &mut Problem<'_>, ids: &[Id], image: &[usize], flip: &[bool]) -> Vec<Id> {
    let graph = &mut problem.graph;
    let mut replacement = HashMap::new();
    for i in 0..image.len() {
        for kind in [Symbol::Coordinate as fn(u32) -> Symbol, Symbol::Rate] {
            let from = graph.symbol(kind(index(i)));
            let to = graph.symbol(kind(index(image[i])));
            let to = if flip[i] { graph.neg(to) } else { to };
            replacement.insert(from, to);
        }
    }
    substitute(graph, ids, &replacement)
}

fn invariant(problem: &mut Problem<'_>, image: &[usize], flip: &[bool]) -> bool {
    let energies = [problem.equations.kinetic, problem.equations.potential];
    reflected(problem, &energies, image, flip) == energies
}

/// P0608, with the energy terms that have no mirror image.
fn broken(
    problem: &mut Problem<'_>,
    instances: &(String, String),
    span: Span,
    image: &[usize],
    flip: &[bool],
) -> Finding {
    let originals: Vec<(Id, Id)> =
        problem.equations.sources.iter().map(|s| (s.kinetic, s.potential)).collect();
    let flat: Vec<Id> = originals.iter().flat_map(|&(t, v)| [t, v]).collect();
    let images = reflected(problem, &flat, image, flip);
    let places: Vec<(Span, String)> = images
        .chunks(2)
        .zip(&problem.equations.sources)
        .filter(|(energies, _)| !originals.contains(&(energies[0], energies[1])))
        .map(|(_, source)| {
            (source.span, format!("{} is not the mirror image of any other term", source.name))
        })
        .collect();
    let (left, right) = instances;
    Finding::new(
        codes::P0608,
        '-',
        span,
        format!("`{left}` and `{right}` are not mirror images: the dynamics change when they are exchanged"),
    )
    .label("required here")
    .also(places)
    .note("the reflection is in the x-z plane: rotations about x and z change their sign, rotations about y do not, y changes its sign")
    .help("the two instances need the same parameters, attachments at opposite y and coordinates turning about the same axes; everything else must be symmetric about the x-z plane")
}
