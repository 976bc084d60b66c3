//! A robot near the origin.

use crate::Error;
use nalgebra::{DMatrix, SVector};
use shapebot_dynamics::LagrangianSystem;

/// ẋ = A x + B u with x = [q; q̇].
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// A, 2 N × 2 N.
    pub state: DMatrix<f64>,
    /// B, 2 N × actuators.
    pub input: DMatrix<f64>,
}

/// The robot at rest at its origin: A = [0, 1; −M⁻¹ ∂G/∂q, −M⁻¹ D], B = [0; M⁻¹ B(0)].
///
/// # Errors
///
/// A mass matrix without an inverse.
pub fn linearise<const N: usize>(system: &dyn LagrangianSystem<f64, N>) -> Result<Linear, Error> {
    let origin = SVector::<f64, N>::zeros();
    let equation = "inverse of the mass matrix";
    let mobility =
        system.mass_matrix(&origin).try_inverse().ok_or(Error::NoSolution { equation })?;
    let stiffness = mobility * system.gravity_jacobian(&origin);
    let actuators = system.description().actuators.len();
    let mut state = DMatrix::zeros(2 * N, 2 * N);
    let mut input = DMatrix::zeros(2 * N, actuators);
    for k in 0..N {
        // Dissipation is linear in the rates or nearly so.
        let drag = |rate: f64| {
            let mut qd = SVector::zeros();
            qd[k] = rate;
            system.dissipative_force(&origin, &qd)
        };
        const STEP: f64 = 1e-4;
        let damping = mobility * (drag(STEP) - drag(-STEP)) / (2.0 * STEP);
        state[(k, N + k)] = 1.0;
        for i in 0..N {
            state[(N + i, k)] = -stiffness[(i, k)];
            state[(N + i, N + k)] = damping[i];
        }
    }
    for actuator in 0..actuators {
        let column = mobility * system.input_column(&origin, actuator);
        for i in 0..N {
            input[(N + i, actuator)] = column[i];
        }
    }
    Ok(Linear { state, input })
}
