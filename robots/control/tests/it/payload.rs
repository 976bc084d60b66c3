//! A payload is found from the momentum of the drives.

use crate::common::{Check, PERIOD, balances, every, reach, rest, travel};
use nalgebra::{SMatrix, SVector, Vector3};
use shapebot_control::estimator::{Payload, PayloadEstimator, PayloadSettings};
use shapebot_control::{Controller, Error, Gains, State, Target};
use shapebot_dynamics::control::ControlDesign;
use shapebot_dynamics::{LagrangianSystem, Robot};

type With<'a, R> = &'a dyn Fn(&str, f64) -> R;

/// A robot that carries a point mass: M gains m JᵀJ, the forces m Jᵀ(J̇ q̇ + g e_z).
struct Loaded<'r, R> {
    robot: &'r R,
    point: usize,
    mass: f64,
    /// Viscous and dry friction of the drives.
    friction: [f64; 2],
}

impl<R> Loaded<'_, R> {
    fn acceleration<const N: usize>(
        &self,
        state: &State<f64, N>,
        force: &SVector<f64, N>,
        positions: usize,
    ) -> SVector<f64, N>
    where
        R: LagrangianSystem<f64, N>,
    {
        let State { q, qd } = state;
        let jacobian = |q: &SVector<f64, N>| self.robot.point_jacobian(q, self.point);
        let (j, h) = (jacobian(q), 1e-4);
        let change = (jacobian(&(q + qd * h)) - jacobian(&(q - qd * h))) * qd / (2.0 * h);
        let weight = j.transpose() * ((change + Vector3::z() * 9.81) * self.mass);
        let motion = self.robot.motion(q, qd);
        let rubbing = SVector::from_fn(|i, _| {
            let [viscous, dry] = self.friction;
            if i < positions { -viscous * qd[i] - dry * (qd[i] / 0.02).tanh() } else { 0.0 }
        });
        let drag = self.robot.dissipative_force(q, qd);
        let rest = force + rubbing + drag - motion.coriolis_vector - motion.gravity - weight;
        eliminate(motion.mass_matrix + j.transpose() * j * self.mass, rest)
    }

    fn advance<const N: usize>(
        &self,
        state: &State<f64, N>,
        force: &SVector<f64, N>,
        positions: usize,
    ) -> State<f64, N>
    where
        R: LagrangianSystem<f64, N>,
    {
        let slope = |s: &State<f64, N>| (s.qd, self.acceleration(s, force, positions));
        let along = |(v, a): (SVector<f64, N>, SVector<f64, N>), t: f64| State {
            q: state.q + v * t,
            qd: state.qd + a * t,
        };
        let h = PERIOD;
        let k1 = slope(state);
        let k2 = slope(&along(k1, h / 2.0));
        let k3 = slope(&along(k2, h / 2.0));
        let k4 = slope(&along(k3, h));
        State {
            q: state.q + (k1.0 + k2.0 * 2.0 + k3.0 * 2.0 + k4.0) * (h / 6.0),
            qd: state.qd + (k1.1 + k2.1 * 2.0 + k3.1 * 2.0 + k4.1) * (h / 6.0),
        }
    }
}

/// Elimination without pivots, for positive definite matrices.
fn eliminate<const N: usize>(mut a: SMatrix<f64, N, N>, mut b: SVector<f64, N>) -> SVector<f64, N> {
    for k in 0..N {
        for i in (0..N).filter(|&i| i != k) {
            let factor = a[(i, k)] / a[(k, k)];
            for j in k..N {
                let part = factor * a[(k, j)];
                a[(i, j)] -= part;
            }
            b[i] -= factor * b[k];
        }
    }
    SVector::from_fn(|i, _| b[i] / a[(i, i)])
}

/// Carries a payload to and fro, and says what was found.
fn carry<R, const N: usize, const NX: usize, const NS: usize>(
    robot: &R,
    design: &ControlDesign,
    mass: f64,
    friction: [f64; 2],
) -> (Payload<f64>, usize)
where
    R: Robot<f64, N, NX, NS>,
{
    let description = robot.description();
    let point = description.points.iter().position(|name| *name == "head").expect("a head");
    let loaded = Loaded { robot, point, mass, friction };
    let gains = Gains::from_design(robot, design).expect("gains");
    let mut controller = Controller::new(robot, &gains).expect("a controller");
    let settings = PayloadSettings::new(PERIOD, point, description.actuators[0].limit);
    let mut estimator = PayloadEstimator::new(robot, &settings).expect("an estimator");
    let there = travel(robot, reach(robot), 5.0, 0.0);
    let mut state = rest();
    let mut payload = estimator.step(&state, &SVector::zeros());
    let end = there.last().expect("a plan").position[0];
    let back = there.iter().map(|target| {
        let [at, rate, acceleration] = target.position;
        Target {
            position: [end - at, -rate, -acceleration],
            shape: target.shape.map(|shape| -shape),
            ..*target
        }
        .with_feedforward(robot)
    });
    let there: Vec<_> = there.iter().copied().chain(back).collect();
    for target in &there {
        let command = controller.step(&state, target);
        assert!(!command.fault);
        state = loaded.advance(&state, &command.force, NX);
        payload = estimator.step(&state, &command.force);
    }
    (payload, point)
}

struct Finds;

impl Check for Finds {
    fn check<R, const N: usize, const NX: usize, const NS: usize>(
        name: &str,
        robot: &R,
        design: &ControlDesign,
        _: With<'_, R>,
    ) where
        R: Robot<f64, N, NX, NS>,
    {
        if !balances(robot) {
            let settings = PayloadSettings::new(PERIOD, 0, 1.0);
            assert_eq!(PayloadEstimator::new(robot, &settings).err(), Some(Error::Kind), "{name}");
            return;
        }
        let limit = robot.description().actuators[0].limit;
        // A tenth of the moment of the body's own weight.
        let weight = 0.1 * robot.gravity_jacobian(&SVector::zeros())[(N - 1, N - 1)].abs() / 9.81;
        let point = robot.description().points.iter().position(|p| *p == "head").expect("a head");
        let height = robot.point_position(&SVector::zeros(), point)[2];
        let mass = weight / height;
        let friction = [0.002 * limit, 0.01 * limit];
        // A tenth of it, or half a percent of what the drive moves.
        let metres = robot.output_jacobian_position()[(0, 0)];
        let moved = robot.mass_matrix(&SVector::zeros())[(0, 0)] / (metres * metres);
        let tolerance = (0.1 * mass).max(0.005 * moved);
        let (payload, point) = carry(robot, design, mass, friction);
        assert!((payload.mass - mass).abs() < tolerance, "{name}: {payload:?}, {mass} kg");
        assert!((payload.dry / friction[1] - 1.0).abs() < 0.3, "{name}: {payload:?}");
        let (without, _) = carry(robot, design, 0.0, friction);
        assert!(without.mass.abs() < tolerance, "{name}: {without:?}");
        // Between the centre of mass without payload, and the payload.
        let empty = robot.center_of_mass(&SVector::zeros())[2];
        let head = robot.point_position(&SVector::zeros(), point)[2];
        let center = payload.center_of_mass[2];
        assert!((empty.min(head)..=empty.max(head)).contains(&center), "{name}: {payload:?}");
    }
}

#[test]
fn a_payload_on_the_head_is_weighed_while_driving() {
    every::<Finds>();
}
