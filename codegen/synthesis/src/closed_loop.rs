//! The sampled closed loop as a linear map: one period of plant, delay, observers and law.

use crate::gains::Gains;
use crate::linear_algebra::{Matrix, eigenvalues, zero_order_hold};
use crate::linearisation::Linearisation;

/// The law of `shapebot-control`, linearised at the origin without its limits. It keeps the model it was
/// made for, whatever the plant is.
#[derive(Debug)]
pub(crate) struct Law<'a> {
    model: &'a Linearisation,
    gains: &'a Gains,
    /// One for servoed coordinates.
    servoed: Vec<f64>,
    /// K⁰_qs of the unactuated shape.
    lean_gain: Matrix,
    /// Its right inverse.
    body_gain: Matrix,
    /// Inverse of M with servoed coordinates held.
    free_inverse: Matrix,
    /// ∂q̈_x/∂q̇ through the dissipation on the unactuated rows.
    braking: Matrix,
}

/// What the law keeps from step to step.
#[derive(Clone, Debug)]
struct Memory {
    lean_integral: Vec<f64>,
    servo_integral: Vec<f64>,
    momentum: Vec<f64>,
    disturbance: Vec<f64>,
    estimate: Vec<f64>,
    slope: Vec<f64>,
    offset: Vec<f64>,
    force: Vec<f64>,
    /// Dissipation at the last step.
    drag: Vec<f64>,
}

impl<'a> Law<'a> {
    /// `actuated` says of each coordinate whether an actuator works on it. `None` if a matrix is singular.
    pub(crate) fn new(
        model: &'a Linearisation,
        gains: &'a Gains,
        actuated: &[bool],
    ) -> Option<Self> {
        let (n, n_x) = (model.len(), model.position_count());
        let balancing = !gains.lean.is_empty();
        let servoed: Vec<f64> =
            (0..n).map(|i| f64::from(u8::from(i >= n_x && actuated[i]))).collect();
        let lean_gain = Matrix::from_fn(n_x, n - n_x, |i, j| {
            if balancing && actuated[n_x + j] { 0.0 } else { model.shape_gain[(i, j)] }
        });
        let transposed = lean_gain.transpose();
        let body_gain = transposed.times(&lean_gain.times(&transposed).inverse()?);
        let held = Matrix::from_fn(n, n, |i, j| {
            let free = (1.0 - servoed[i]) * (1.0 - servoed[j]);
            model.mass[(i, j)] * free + if i == j { servoed[i] } else { 0.0 }
        });
        let free_inverse = held.inverse()?;
        let (rows, positions): (Vec<usize>, Vec<usize>) =
            ((0..n).filter(|&i| !actuated[i]).collect(), (0..n_x).collect());
        let all: Vec<usize> = (0..n).collect();
        let coupling = model.mass.pick(&rows, &positions);
        let braking = coupling.solve(&model.damping.pick(&rows, &all).scaled(-1.0))?;
        Some(Self { model, gains, servoed, lean_gain, body_gain, free_inverse, braking })
    }

    /// Generalised forces for a measured state, deviations from a target at rest.
    fn step(&self, memory: &mut Memory, q: &[f64], qd: &[f64]) -> Vec<f64> {
        let Gains { period, lean, outer, servo, .. } = self.gains;
        let model = self.model;
        let n_x = model.position_count();
        let ((qx, qs), (qxd, qsd)) = (q.split_at(n_x), qd.split_at(n_x));
        self.observe(memory, qs, qxd, qsd, qd);
        let y = sum(qx, &model.output_shape.apply(qs));
        let yd = sum(qxd, &model.output_shape.apply(qsd));
        let wanted: Vec<f64> =
            (0..n_x).map(|i| -outer[i][0] * y[i] - outer[i][1] * yd[i]).collect();
        let compensation = self.body_gain.apply(&wanted);
        let trim = self.body_gain.apply(&memory.offset);
        let error: Vec<f64> = (0..qs.len()).map(|i| qs[i] - compensation[i] + trim[i]).collect();
        let mut force = vec![0.0; q.len()];
        if !lean.is_empty() {
            let (e, ed) = (self.lean_gain.apply(&error), self.lean_gain.apply(qsd));
            let feed = model.shape_gain.apply(&compensation);
            for i in 0..n_x {
                let w = |j: usize| {
                    let [p, d, k] = lean[j];
                    p * e[j] + d * ed[j] + k * memory.lean_integral[j] + feed[j]
                };
                force[i] = (0..n_x).map(|j| model.mass[(i, j)] * w(j)).sum::<f64>()
                    - memory.disturbance[i];
            }
            for (integral, e) in memory.lean_integral.iter_mut().zip(&e) {
                *integral += period * e;
            }
        }
        self.servo(memory, *servo, (q, qd), &error, &mut force);
        memory.force.clone_from(&force);
        force
    }

    /// Computed torque of the servoed shape variables.
    fn servo(
        &self,
        memory: &mut Memory,
        [rate, damping, integral]: [f64; 3],
        (q, qd): (&[f64], &[f64]),
        error: &[f64],
        force: &mut [f64],
    ) {
        let (n, n_x) = (q.len(), self.model.position_count());
        if self.servoed.iter().all(|&s| s == 0.0) {
            return;
        }
        let mut given = vec![0.0; n];
        let servoed = (n_x..n).filter(|&i| self.servoed[i] > 0.0);
        for (i, integrated) in servoed.zip(&mut memory.servo_integral) {
            let (error, speed) = (error[i - n_x], qd[i]);
            given[i] =
                -(rate * rate * error + 2.0 * damping * rate * speed) - integral * *integrated;
            *integrated += self.gains.period * error;
        }
        let bias = sum(&self.model.stiffness.apply(q), &self.model.damping.apply(qd));
        let coupled = self.model.mass.apply(&given);
        let rest: Vec<f64> = (0..n)
            .map(|i| {
                let known = if i < n_x { force[i] + memory.disturbance[i] } else { 0.0 };
                (known - bias[i] - coupled[i]) * (1.0 - self.servoed[i]) + given[i]
            })
            .collect();
        let produced = self.model.mass.apply(&self.free_inverse.apply(&rest));
        for i in n_x..n {
            force[i] += self.servoed[i] * (produced[i] + bias[i]);
        }
    }

    fn observe(&self, memory: &mut Memory, qs: &[f64], qxd: &[f64], qsd: &[f64], qd: &[f64]) {
        let Gains { period, observer_rate, offset_rate, .. } = *self.gains;
        let momentum = self.model.mass.apply(qd);
        let slope = sum(&self.model.shape_gain.apply(qs), &self.braking.apply(qd));
        let along = self.model.response.apply(qsd);
        for i in 0..qxd.len() {
            let known = memory.force[i] + memory.drag[i];
            memory.momentum[i] += period * (known + memory.disturbance[i]);
            memory.disturbance[i] = observer_rate * (momentum[i] - memory.momentum[i]);
            let mean = 0.5 * (memory.slope[i] + slope[i]);
            memory.estimate[i] += period * (mean + memory.offset[i]);
            let innovation = qxd[i] - along[i] - memory.estimate[i];
            memory.estimate[i] += 2.0 * offset_rate * period * innovation;
            memory.offset[i] += offset_rate * offset_rate * period * innovation;
        }
        memory.slope = slope;
        memory.drag = self.model.damping.scaled(-1.0).apply(qd);
        memory.drag.truncate(qxd.len());
    }

    /// A_cl of the loop around a plant, whose forces come `delay` periods after the measurement.
    pub(crate) fn around(&self, plant: &Plant, delay: usize) -> Matrix {
        let size = self.unpack(plant, delay, &[]).2;
        let mut closed = Matrix::zeros(size, size);
        let quiet = Disturbance::none(self.model);
        for j in 0..size {
            let mut unit = vec![0.0; size];
            unit[j] = 1.0;
            closed.set_column(j, &self.advance(plant, delay, &unit, &quiet));
        }
        closed
    }

    /// The same with constant disturbances as further states: a force on each position variable, in
    /// accelerations, then an offset of each measured shape variable.
    pub(crate) fn disturbed(&self, plant: &Plant, delay: usize) -> Matrix {
        let closed = self.around(plant, delay);
        let (n, n_x) = (self.model.len(), self.model.position_count());
        let size = closed.rows;
        let mut whole = Matrix::from_fn(size + n, size + n, |i, j| {
            if i < size && j < size { closed[(i, j)] } else { f64::from(u8::from(i == j)) }
        });
        for j in 0..n {
            let mut disturbance = Disturbance::none(self.model);
            if j < n_x {
                disturbance.force = (0..n_x).map(|i| self.model.mass[(i, j)]).collect();
            } else {
                disturbance.shape[j - n_x] = 1.0;
            }
            let mut column = self.advance(plant, delay, &vec![0.0; size], &disturbance);
            column.extend((0..n).map(|i| f64::from(u8::from(i == j))));
            whole.set_column(size + j, &column);
        }
        whole
    }

    /// One period of the loop.
    fn advance(
        &self,
        plant: &Plant,
        delay: usize,
        z: &[f64],
        disturbance: &Disturbance,
    ) -> Vec<f64> {
        let (n, n_x) = (self.model.len(), self.model.position_count());
        let (mut pipeline, mut memory, _) = self.unpack(plant, delay, z);
        let state = &z[..2 * n];
        let mut measured = state[..n].to_vec();
        for (q, offset) in measured[n_x..].iter_mut().zip(&disturbance.shape) {
            *q += offset;
        }
        let force = self.step(&mut memory, &measured, &state[n..]);
        pipeline.push(force);
        let acting = pipeline.remove(0);
        let disturbing = |i: usize| disturbance.force.get(i).copied().unwrap_or(0.0);
        let acting: Vec<f64> = plant.driven.iter().map(|&i| acting[i] + disturbing(i)).collect();
        let mut next = sum(&plant.free.apply(state), &plant.forced.apply(&acting));
        for force in pipeline {
            next.extend(plant.driven.iter().map(|&i| force[i]));
        }
        for part in memory.parts(self) {
            next.extend(part.iter());
        }
        next
    }

    /// Forces under way, memory, and the number of states.
    fn unpack(&self, plant: &Plant, delay: usize, z: &[f64]) -> (Vec<Vec<f64>>, Memory, usize) {
        let (n, n_x) = (self.model.len(), self.model.position_count());
        let mut at = 2 * n;
        let mut take = |count: usize| {
            let part: Vec<f64> =
                (at..at + count).map(|i| z.get(i).copied().unwrap_or(0.0)).collect();
            at += count;
            part
        };
        let spread = |values: Vec<f64>| {
            let mut force = vec![0.0; n];
            for (&i, value) in plant.driven.iter().zip(values) {
                force[i] = value;
            }
            force
        };
        let pipeline: Vec<Vec<f64>> =
            (0..delay).map(|_| spread(take(plant.driven.len()))).collect();
        let servoed = self.servoed.iter().filter(|&&s| s > 0.0).count();
        let mut memory = Memory {
            lean_integral: vec![0.0; n_x],
            servo_integral: vec![0.0; servoed],
            momentum: vec![0.0; n_x],
            disturbance: vec![0.0; n_x],
            estimate: vec![0.0; n_x],
            slope: vec![0.0; n_x],
            offset: vec![0.0; n_x],
            force: vec![0.0; n],
            drag: vec![0.0; n_x],
        };
        let lengths: Vec<usize> = memory.parts(self).iter().map(|part| part.len()).collect();
        for (part, length) in memory.parts_mut(self).into_iter().zip(lengths) {
            *part = take(length);
        }
        (pipeline, memory, at)
    }
}

impl Memory {
    /// The parts that are in use.
    fn parts(&self, law: &Law<'_>) -> Vec<&Vec<f64>> {
        let uses = uses(law);
        let parts = [
            &self.lean_integral,
            &self.servo_integral,
            &self.momentum,
            &self.disturbance,
            &self.force,
            &self.drag,
            &self.estimate,
            &self.slope,
            &self.offset,
        ];
        parts.into_iter().zip(uses).filter(|(_, used)| *used).map(|(part, _)| part).collect()
    }

    fn parts_mut(&mut self, law: &Law<'_>) -> Vec<&mut Vec<f64>> {
        let uses = uses(law);
        let parts = [
            &mut self.lean_integral,
            &mut self.servo_integral,
            &mut self.momentum,
            &mut self.disturbance,
            &mut self.force,
            &mut self.drag,
            &mut self.estimate,
            &mut self.slope,
            &mut self.offset,
        ];
        parts.into_iter().zip(uses).filter(|(_, used)| *used).map(|(part, _)| part).collect()
    }
}

fn uses(law: &Law<'_>) -> [bool; 9] {
    let gains = law.gains;
    let lean = gains.lean.iter().any(|g| g[2] != 0.0);
    let servo = gains.servo[2] != 0.0 && law.servoed.contains(&1.0);
    let [observer, offset] = [gains.observer_rate > 0.0, gains.offset_rate > 0.0];
    [lean, servo, observer, observer, observer, observer, offset, offset, offset]
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// Constant disturbances.
#[derive(Clone, Debug)]
struct Disturbance {
    /// Generalised force on each position variable.
    force: Vec<f64>,
    /// Offset of each measured shape variable.
    shape: Vec<f64>,
}

impl Disturbance {
    fn none(model: &Linearisation) -> Self {
        let n_x = model.position_count();
        Self { force: vec![0.0; n_x], shape: vec![0.0; model.len() - n_x] }
    }
}

/// A plant sampled with forces held over a period.
#[derive(Clone, Debug)]
pub(crate) struct Plant {
    free: Matrix,
    forced: Matrix,
    /// Coordinates with an actuator.
    driven: Vec<usize>,
}

impl Plant {
    /// `None` if the mass matrix is singular.
    pub(crate) fn new(model: &Linearisation, actuated: &[bool], period: f64) -> Option<Self> {
        let n = model.len();
        let inverse = model.mass.inverse()?;
        let by_position = inverse.times(&model.stiffness);
        let by_rate = inverse.times(&model.damping);
        let a = Matrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, _) => f64::from(u8::from(j == i + n)),
            (false, true) => -by_position[(i - n, j)],
            (false, false) => -by_rate[(i - n, j - n)],
        });
        let driven: Vec<usize> = (0..n).filter(|&i| actuated[i]).collect();
        let b = Matrix::from_fn(2 * n, driven.len(), |i, j| {
            if i < n { 0.0 } else { inverse[(i - n, driven[j])] }
        });
        let (free, forced) = zero_order_hold(&a, &b, period);
        Some(Self { free, forced, driven })
    }
}

/// Poles s = ln(z)/T, those of pure delay left out, slowest first; `None` if they cannot be computed.
pub(crate) fn poles(closed: &Matrix, period: f64) -> Option<Vec<(f64, f64)>> {
    let values = eigenvalues(closed)?;
    let continuous = values.into_iter().filter_map(|(re, im)| {
        let size = re.hypot(im);
        (size > 1e-3).then(|| (size.ln() / period, im.atan2(re) / period))
    });
    let mut list: Vec<(f64, f64)> = continuous.collect();
    list.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)));
    Some(list)
}
