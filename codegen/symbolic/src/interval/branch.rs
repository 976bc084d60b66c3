//! Branch and bound: a value proved to keep away from zero over a box.

use super::{Interval, Tape};
use crate::{Graph, Id, Symbol};
use std::collections::BTreeMap;

/// What subdivision found out.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The value is nowhere zero in the box; so many sub-boxes were looked at.
    Proved {
        /// Sub-boxes.
        boxes: usize,
    },
    /// The budget ran out; the value comes nearest to zero, of what was seen, near this point.
    Undecided {
        /// The point.
        at: BTreeMap<Symbol, f64>,
    },
    /// The value changes sign in the box, here.
    Refuted {
        /// The point.
        point: BTreeMap<Symbol, f64>,
    },
}

/// Whether a value is nowhere zero over a box. Symbols without an entry in `boxes` may have any value.
/// `budget` counts interval operations: a sub-box costs about twice the number of nodes.
///
/// Natural extension and mean-value form are intersected; the variable that contributes most to the
/// width is split. A change of sign between two points that are decided by intervals, with a bounded
/// value between them, is a refutation.
#[must_use]
pub fn prove_nonzero(
    graph: &Graph,
    id: Id,
    boxes: &BTreeMap<Symbol, Interval>,
    budget: usize,
) -> Verdict {
    let tape = Tape::new(graph, &[id]);
    let whole: Vec<Interval> =
        tape.inputs().iter().map(|s| boxes.get(s).copied().unwrap_or(Interval::ENTIRE)).collect();
    Search { tape, reference: None, nearest: None }.run(whole, budget)
}

struct Search {
    tape: Tape,
    /// A point where the sign is known, and whether it is positive.
    reference: Option<(Vec<f64>, bool)>,
    /// Middle of the undecided box with the smallest value, and that value.
    nearest: Option<(Vec<f64>, f64)>,
}

impl Search {
    fn run(mut self, whole: Vec<Interval>, budget: usize) -> Verdict {
        let allowed = (budget / (3 * self.tape.len().max(1))).max(1);
        let mut queue = std::collections::VecDeque::from([whole]);
        let mut looked_at = 0;
        while let Some(part) = queue.pop_front() {
            let middle: Vec<f64> = part.iter().map(|x| x.middle()).collect();
            if looked_at == allowed {
                self.remember(middle);
                return self.undecided();
            }
            looked_at += 1;
            let (value, split) = self.enclose(&part, &middle);
            if let Some(point) = self.sign_change(&middle) {
                return Verdict::Refuted { point: self.named(&point) };
            }
            if value.excludes_zero() {
                continue;
            }
            self.remember(middle);
            match split.and_then(|i| halves(&part, i)) {
                Some([left, right]) => queue.extend([left, right]),
                None => return self.undecided(),
            }
        }
        Verdict::Proved { boxes: looked_at }
    }

    /// Enclosure over a box, and the variable to split.
    fn enclose(&self, part: &[Interval], middle: &[f64]) -> (Interval, Option<usize>) {
        let (natural, slopes) = self.tape.with_slopes(part);
        if natural.excludes_zero() {
            return (natural, None);
        }
        let point: Vec<Interval> = middle.iter().map(|&x| Interval::point(x)).collect();
        let mut centred = self.tape.over(&point)[0];
        let mut split: Option<(usize, f64)> = None;
        for (i, (&x, &slope)) in part.iter().zip(&slopes).enumerate() {
            if x.width() == 0.0 {
                continue;
            }
            centred = centred + slope * (x - point[i]);
            let smear = match slope.magnitude() * x.width() {
                finite if finite.is_finite() => finite,
                _ => f64::MAX.min(x.width()),
            };
            if split.is_none_or(|(_, best)| smear > best) {
                split = Some((i, smear));
            }
        }
        (natural.intersect(centred), split.map(|(i, _)| i))
    }

    fn decided_sign(&self, point: &[f64]) -> Option<bool> {
        let exact: Vec<Interval> = point.iter().map(|&x| Interval::point(x)).collect();
        let value = self.tape.over(&exact)[0];
        value.excludes_zero().then_some(value.lower > 0.0)
    }

    /// A zero between this point and the reference, if their signs differ.
    fn sign_change(&mut self, point: &[f64]) -> Option<Vec<f64>> {
        let positive = self.decided_sign(point)?;
        let Some((base, sign)) = &self.reference else {
            self.reference = Some((point.to_vec(), positive));
            return None;
        };
        if *sign == positive {
            return None;
        }
        let (mut a, mut b) = (base.clone(), point.to_vec());
        for _ in 0..60 {
            let middle: Vec<f64> = a.iter().zip(&b).map(|(x, y)| 0.5 * x + 0.5 * y).collect();
            match self.decided_sign(&middle) {
                Some(s) if s == *sign => a = middle,
                Some(_) => b = middle,
                None => break,
            }
        }
        // A pole changes the sign as well: the value has to stay bounded between the two.
        let between: Vec<Interval> = a.iter().zip(&b).map(|(&x, &y)| Interval::new(x, y)).collect();
        let bounded = self.tape.over(&between)[0].is_bounded();
        bounded.then(|| between.iter().map(|x| x.middle()).collect())
    }

    fn remember(&mut self, middle: Vec<f64>) {
        let size = self.tape.at(&middle)[0].abs();
        if self.nearest.as_ref().is_none_or(|(_, least)| size < *least) {
            self.nearest = Some((middle, size));
        }
    }

    fn undecided(&self) -> Verdict {
        let at = self.nearest.as_ref().map(|(point, _)| self.named(point)).unwrap_or_default();
        Verdict::Undecided { at }
    }

    fn named(&self, point: &[f64]) -> BTreeMap<Symbol, f64> {
        self.tape.inputs().iter().copied().zip(point.iter().copied()).collect()
    }
}

/// Both halves of a box along one variable; `None` if it is too narrow to be halved.
fn halves(part: &[Interval], i: usize) -> Option<[Vec<Interval>; 2]> {
    let x = part[i];
    let cut = match (x.lower.is_finite(), x.upper.is_finite()) {
        (true, false) => 2.0 * x.lower.abs() + 1.0,
        (false, true) => -2.0 * x.upper.abs() - 1.0,
        _ => x.middle(),
    };
    let inside = x.lower < cut && cut < x.upper;
    inside.then(|| {
        let (mut left, mut right) = (part.to_vec(), part.to_vec());
        left[i].upper = cut;
        right[i].lower = cut;
        [left, right]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(i: u32) -> Symbol {
        Symbol::Coordinate(i)
    }

    fn boxes(limits: &[f64]) -> BTreeMap<Symbol, Interval> {
        (0..).zip(limits).map(|(i, &b)| (angle(i), Interval::new(-b, b))).collect()
    }

    #[test]
    fn cosine_is_proved_nonzero_short_of_a_right_angle_and_refuted_beyond() {
        let mut graph = Graph::new();
        let x = graph.symbol(angle(0));
        let cosine = graph.cos(x);
        assert!(matches!(
            prove_nonzero(&graph, cosine, &boxes(&[1.5]), 1000),
            Verdict::Proved { .. }
        ));
        let Verdict::Refuted { point } = prove_nonzero(&graph, cosine, &boxes(&[2.0]), 1000) else {
            panic!("cos changes sign before 2 rad")
        };
        assert!((point[&angle(0)].abs() - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
    }

    #[test]
    fn a_double_zero_is_undecided_not_proved() {
        let mut graph = Graph::new();
        let x = graph.symbol(angle(0));
        let square = graph.mul(x, x);
        let verdict = prove_nonzero(&graph, square, &boxes(&[1.0]), 3000);
        assert!(matches!(verdict, Verdict::Undecided { .. }));
    }

    #[test]
    fn a_pole_is_no_refutation() {
        let mut graph = Graph::new();
        let (one, x) = (graph.one(), graph.symbol(angle(0)));
        let inverse = graph.div(one, x);
        let verdict = prove_nonzero(&graph, inverse, &boxes(&[1.0]), 3000);
        assert!(matches!(verdict, Verdict::Undecided { .. }));
    }

    #[test]
    fn cancellation_is_seen_by_the_mean_value_form() {
        let mut graph = Graph::new();
        let (x, y) = (graph.symbol(angle(0)), graph.symbol(angle(1)));
        let (cx, cy) = (graph.cos(x), graph.cos(y));
        // 1.05 − cos x cos y: the natural extension at the origin is within 0.05 of zero.
        let product = graph.mul(cx, cy);
        let offset = graph.fraction(105, 100);
        let value = graph.sub(offset, product);
        let verdict = prove_nonzero(&graph, value, &boxes(&[1.0, 1.0]), 4000);
        assert!(matches!(verdict, Verdict::Proved { .. }), "{verdict:?}");
    }

    #[test]
    fn slopes_enclose_difference_quotients() {
        let mut graph = Graph::new();
        let (x, y) = (graph.symbol(angle(0)), graph.symbol(angle(1)));
        let (sine, root) = (graph.sin(x), graph.mul(y, y));
        let sum = graph.add(sine, root);
        let value = graph.div(sum, root);
        let tape = Tape::new(&graph, &[value]);
        let point: Vec<f64> =
            tape.inputs().iter().map(|s| if *s == angle(0) { 0.3 } else { 0.7 }).collect();
        let exact: Vec<Interval> = point.iter().map(|&x| Interval::point(x)).collect();
        let (_, slopes) = tape.with_slopes(&exact);
        for i in 0..2 {
            let (mut high, mut low) = (point.clone(), point.clone());
            high[i] += 1e-6;
            low[i] -= 1e-6;
            let difference = (tape.at(&high)[0] - tape.at(&low)[0]) / 2e-6;
            assert!((slopes[i].middle() - difference).abs() < 1e-7);
        }
    }
}
