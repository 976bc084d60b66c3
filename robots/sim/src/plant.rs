//! The robot as it is: a model's forward dynamics with what the scenario adds.

use crate::floor::{LeanOffset, Weights, turned_gravity};
use crate::friction::smooth_sign;
use crate::{Error, Scenario};
use nalgebra::{SMatrix, SVector};
use shapebot_control::State;
use shapebot_dynamics::{LagrangianSystem, ShapeAccelerated};

/// A plant: M q̈ + C q̇ + G = B u + forces of friction, floor and pushes.
///
/// The Lagrangian system may be another than the one a controller is made for: other parameters, or a
/// model with more terms.
pub struct Plant<'a, const N: usize, const NX: usize, const NS: usize> {
    system: &'a dyn LagrangianSystem<f64, N>,
    map: &'a dyn ShapeAccelerated<f64, NX, NS>,
    scenario: &'a Scenario<NX, NS>,
    weights: Weights,
    lean_offset: LeanOffset,
    /// (∂h/∂q_x)⁻¹.
    per_output: SMatrix<f64, NX, NX>,
    /// Seconds of a Runge-Kutta step.
    step: f64,
    regularisation: Regularisation,
}

/// Rates below which dry friction is smoothed.
#[derive(Clone, Debug, Default)]
struct Regularisation {
    drive: f64,
    contact: f64,
    declared: Vec<f64>,
}

impl<'a, const N: usize, const NX: usize, const NS: usize> Plant<'a, N, NX, NS> {
    /// A plant whose output is h of `map`, integrated in steps of `step` seconds.
    ///
    /// # Errors
    ///
    /// Numbers of the scenario that are out of range, a description of another size, a potential energy
    /// that is not that of the known weights while the floor is not level.
    pub fn new(
        system: &'a dyn LagrangianSystem<f64, N>,
        map: &'a dyn ShapeAccelerated<f64, NX, NS>,
        scenario: &'a Scenario<NX, NS>,
        step: f64,
    ) -> Result<Self, Error> {
        let found = system.description().coordinates.len();
        if found != N || NX + NS != N {
            return Err(Error::Coordinates { found, expected: NX + NS });
        }
        crate::error::at_least("plant step", step, f64::MIN_POSITIVE)?;
        scenario.check(system.description())?;
        let jacobian = map.output_jacobian_position();
        let weights = match scenario.floor.is_level() {
            true => Weights::default(),
            false => Weights::of(system, &scenario.weights)?,
        };
        let equation = "inverse of the output's Jacobian";
        let per_output = jacobian.try_inverse().ok_or(Error::NoSolution { equation })?;
        let lean_offset = LeanOffset::of(system);
        let mut plant = Self {
            system,
            map,
            scenario,
            weights,
            lean_offset,
            per_output,
            step,
            regularisation: Regularisation::default(),
        };
        plant.regularisation = plant.regularisation()?;
        Ok(plant)
    }

    /// As steep as the step allows, at the origin's mobility M⁻¹.
    fn regularisation(&self) -> Result<Regularisation, Error> {
        let origin = SVector::<f64, N>::zeros();
        let equation = "inverse of the mass matrix";
        let mobility = self.system.mass_matrix(&origin).try_inverse();
        let mobility = mobility.ok_or(Error::NoSolution { equation })?;
        let drive = (0..NX).map(|i| mobility[(i, i)]).fold(0.0, f64::max);
        let slope = self.contact_jacobian(&origin);
        let contact = (slope * mobility * slope.transpose()).trace();
        let friction = self.system.description().friction;
        let declared = friction.iter().map(|friction| {
            let weights = weights_of::<N>(friction.weights);
            let law = crate::Friction { viscous: 0.0, coulomb: friction.level };
            law.regularisation(weights.dot(&(mobility * weights)), self.step)
        });
        Ok(Regularisation {
            drive: self.scenario.drive.regularisation(drive, self.step),
            contact: self.scenario.contact.regularisation(contact, self.step),
            declared: declared.collect(),
        })
    }

    /// (q_x, q_s) of q.
    pub(crate) fn split(q: &SVector<f64, N>) -> (SVector<f64, NX>, SVector<f64, NS>) {
        (SVector::from_fn(|i, _| q[i]), SVector::from_fn(|i, _| q[NX + i]))
    }

    /// h(q_x, q_s) in the output's unit.
    pub fn output(&self, q: &SVector<f64, N>) -> SVector<f64, NX> {
        let (qx, qs) = Self::split(q);
        self.map.output(&qx, &qs)
    }

    /// (∂h/∂q_x)⁻¹.
    pub(crate) fn coordinates_per_output(&self) -> &SMatrix<f64, NX, NX> {
        &self.per_output
    }

    /// What differs from the nominal case.
    #[must_use]
    pub const fn scenario(&self) -> &'a Scenario<NX, NS> {
        self.scenario
    }

    /// The system.
    pub fn system(&self) -> &'a dyn LagrangianSystem<f64, N> {
        self.system
    }

    /// Rate of the output in units of q_x per rate of q: [1, (∂h/∂q_x)⁻¹ ∂h/∂q_s].
    fn contact_jacobian(&self, q: &SVector<f64, N>) -> SMatrix<f64, NX, N> {
        let (qx, qs) = Self::split(q);
        let by_shape = self.per_output * self.map.output_jacobian_shape(&qx, &qs);
        SMatrix::from_fn(|row, column| match column.checked_sub(NX) {
            Some(shape) => by_shape[(row, shape)],
            None => f64::from(u8::from(row == column)),
        })
    }

    /// Angles by which the floor rises under a configuration, rad.
    pub(crate) fn floor_angles(&self, q: &SVector<f64, N>) -> [f64; 2] {
        self.scenario.floor.angles(self.output(q).as_slice())
    }

    /// What an inertial unit adds to the coordinates, because it measures against gravity.
    pub(crate) fn lean_offset(&self, q: &SVector<f64, N>) -> SVector<f64, N> {
        if self.scenario.floor.is_level() {
            return SVector::zeros();
        }
        self.lean_offset.at(self.scenario.floor.angles(self.output(q).as_slice()))
    }

    /// Generalised forces of actuators: each within its limit, along its column of B(q). For a system
    /// without declared actuators, `force` itself.
    pub fn actuate(
        &self,
        q: &SVector<f64, N>,
        force: &SVector<f64, N>,
        actuators: &SVector<f64, N>,
    ) -> SVector<f64, N> {
        let declared = self.system.description().actuators;
        if declared.is_empty() {
            return *force;
        }
        let mut total = SVector::zeros();
        for (index, (actuator, &wanted)) in declared.iter().zip(actuators.iter()).enumerate() {
            let limit = actuator.limit * self.scenario.strength;
            total += self.system.input_column(q, index) * wanted.clamp(-limit, limit);
        }
        total
    }

    /// Forces of friction, floor and pushes: all that is not the drives', nor in the Lagrangian.
    pub fn disturbance(&self, time: f64, state: &State<f64, N>) -> SVector<f64, N> {
        let State { q, qd } = state;
        let mut force = self.system.dissipative_force(q, qd);
        let declared = self.system.description().friction.iter();
        for (friction, &smooth) in declared.zip(&self.regularisation.declared) {
            let weights = weights_of::<N>(friction.weights);
            let rate = weights.dot(qd);
            force -= weights * (friction.level * smooth_sign(rate, rate.abs(), smooth));
        }
        if !self.scenario.drive.is_none() {
            let (rate, _) = Self::split(qd);
            let drag = self.scenario.drive.per_axis(&rate, self.regularisation.drive);
            for (entry, drag) in force.iter_mut().zip(drag.iter()) {
                *entry += drag;
            }
        }
        if !self.scenario.contact.is_none() {
            let slope = self.contact_jacobian(q);
            let rate = slope * qd;
            let drag = self.scenario.contact.isotropic(&rate, self.regularisation.contact);
            force += slope.transpose() * drag;
        }
        if !self.scenario.floor.is_level() {
            let angles = self.scenario.floor.angles(self.output(q).as_slice());
            force += self.weights.pull(self.system, q, &turned_gravity(angles));
        }
        for push in self.scenario.pushes.iter().filter(|push| push.acts(time)) {
            force += self.system.point_jacobian(q, push.point).transpose() * push.force;
        }
        force
    }

    /// q̈ under generalised forces of the drives.
    pub fn acceleration(
        &self,
        time: f64,
        state: &State<f64, N>,
        drive: &SVector<f64, N>,
    ) -> SVector<f64, N> {
        let force = drive + self.disturbance(time, state);
        self.system.forward_dynamics(&state.q, &state.qd, &force)
    }

    /// The state one step later, by the classical Runge-Kutta method of fourth order with the drives'
    /// forces held.
    #[must_use]
    pub fn advance(
        &self,
        time: f64,
        state: &State<f64, N>,
        drive: &SVector<f64, N>,
    ) -> State<f64, N> {
        let h = self.step;
        let ahead = |part: f64, q: &SVector<f64, N>, qd: &SVector<f64, N>| State {
            q: state.q + q * (part * h),
            qd: state.qd + qd * (part * h),
        };
        let a1 = self.acceleration(time, state, drive);
        let s2 = ahead(0.5, &state.qd, &a1);
        let a2 = self.acceleration(time + 0.5 * h, &s2, drive);
        let s3 = ahead(0.5, &s2.qd, &a2);
        let a3 = self.acceleration(time + 0.5 * h, &s3, drive);
        let s4 = ahead(1.0, &s3.qd, &a3);
        let a4 = self.acceleration(time + h, &s4, drive);
        State {
            q: state.q + (state.qd + (s2.qd + s3.qd) * 2.0 + s4.qd) * (h / 6.0),
            qd: state.qd + (a1 + (a2 + a3) * 2.0 + a4) * (h / 6.0),
        }
    }

    /// Seconds of a step.
    #[must_use]
    pub const fn step(&self) -> f64 {
        self.step
    }
}

fn weights_of<const N: usize>(weights: &[f64]) -> SVector<f64, N> {
    SVector::from_fn(|i, _| weights.get(i).copied().unwrap_or_default())
}
