//! The motions that the reference tasks describe.

use crate::reference::Data;
use shapebot_dynamics::nalgebra::{SVector, Vector1};
use shapebot_planner::motion::{Bezier, Derivatives, DesiredMotion, Line};

/// A field under either of the two names that the files use.
fn either(task: &Data, names: [&str; 2]) -> Data {
    let found = names.iter().find_map(|name| task.optional(name));
    found.unwrap_or_else(|| panic!("reference task has neither of {names:?}"))
}

pub(super) fn direction<const NX: usize>(task: &Data) -> SVector<f64, NX> {
    either(task, ["direction", "dir"]).vector()
}

enum Path<const NX: usize> {
    Line(Line<f64, NX>),
    Bezier(Vec<SVector<f64, NX>>, f64),
}

/// The desired motion of a task: a path, with rest before and after it.
pub(super) struct Motion<const NX: usize> {
    path: Path<NX>,
    start: f64,
    duration: f64,
}

impl<const NX: usize> Motion<NX> {
    pub(super) fn of(task: &Data) -> Self {
        let moving = either(task, ["duration_s", "T"]).number();
        let path = if task.get("kind").text() == "bezier" {
            Path::Bezier(task.get("pts").list().iter().map(Data::vector).collect(), moving)
        } else {
            let goal = direction::<NX>(task) * either(task, ["distance_m", "D"]).number();
            Path::Line(Line::new(SVector::zeros(), goal, moving, 9).expect("a line"))
        };
        let number = |name: &str| task.optional(name).map(|value| value.number());
        let start = number("start_s").unwrap_or(0.0);
        Self { path, start, duration: number("total_s").unwrap_or(start + moving) }
    }
}

impl<const NX: usize> DesiredMotion<f64, NX> for Motion<NX> {
    fn duration(&self) -> f64 {
        self.duration
    }
    fn derivatives(&self, t: f64) -> Derivatives<f64, NX> {
        let t = t - self.start;
        match &self.path {
            Path::Line(line) => line.derivatives(t),
            Path::Bezier(points, duration) => {
                Bezier::new(points, *duration).expect("a curve").derivatives(t)
            }
        }
    }
}

/// A coordinate that goes from one angle to another in its time, and stays there.
struct Leg {
    start: f64,
    line: Line<f64, 1>,
}

impl Leg {
    /// Start, end, from, to.
    fn of(leg: &Data) -> Self {
        let [start, end, from, to] = leg.vector::<4>().into();
        let line = Line::new(Vector1::new(from), Vector1::new(to), end - start, 9);
        Self { start, line: line.expect("a leg") }
    }
}

/// What a task prescribes for the coordinates of one shape set.
pub(super) struct Prescribed<const NX: usize> {
    pub(super) set: usize,
    coordinates: [Vec<Leg>; NX],
    duration: f64,
}

impl<const NX: usize> Prescribed<NX> {
    /// The legs of a task, by shape set; `sets` has the first coordinate of each.
    pub(super) fn of(task: &Data, sets: &[usize]) -> Vec<Self> {
        let mut prescribed: Vec<Self> = Vec::new();
        let Some(legs) = task.optional("legs") else {
            return prescribed;
        };
        for entry in legs.list() {
            let [index, legs] = <[Data; 2]>::try_from(entry.list()).expect("index and legs");
            let index = index.number() as usize;
            let set = sets.iter().rposition(|&first| first <= index).expect("a shape set");
            if prescribed.iter().all(|known| known.set != set) {
                let duration = task.get("total_s").number();
                let coordinates = std::array::from_fn(|_| Vec::new());
                prescribed.push(Self { set, coordinates, duration });
            }
            let known = prescribed.iter_mut().find(|known| known.set == set).expect("the set");
            known.coordinates[index - sets[set]] = legs.list().iter().map(Leg::of).collect();
        }
        prescribed
    }
}

impl<const NX: usize> DesiredMotion<f64, NX> for Prescribed<NX> {
    fn duration(&self) -> f64 {
        self.duration
    }
    fn derivatives(&self, t: f64) -> Derivatives<f64, NX> {
        let mut derivatives = [SVector::zeros(); 5];
        for (coordinate, legs) in self.coordinates.iter().enumerate() {
            // The last leg that has begun, or the first.
            let begun = legs.iter().rev().find(|leg| leg.start <= t).or(legs.first());
            let Some(leg) = begun else { continue };
            for (sum, value) in derivatives.iter_mut().zip(leg.line.derivatives(t - leg.start)) {
                sum[coordinate] = value[0];
            }
        }
        derivatives
    }
}
