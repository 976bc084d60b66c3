//! Floors that are not level.
//!
//! Coordinates stay those of the floor, so gravity turns. On an uneven floor it turns with the place;
//! the floor's curvature itself (its effect on lever arms and on rates) is left out, which is right while
//! waves are long beside the robot.

use crate::Error;
use nalgebra::{DMatrix, SMatrix, SVector, Vector3};
use shapebot_dynamics::LagrangianSystem;

/// Angles by which the floor rises along the world's x and y axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Floor {
    /// Everywhere, rad.
    pub slope: [f64; 2],
    /// Added along the way: amplitude of the angle, rad.
    pub wave: [f64; 2],
    /// Length of the wave in the output's unit; must be positive if there is one.
    pub wavelength: f64,
    /// Phase of the wave at the origin, rad.
    pub phase: f64,
}

impl Floor {
    /// Rises along the world's x axis by an angle, rad.
    #[must_use]
    pub fn rising(angle: f64) -> Self {
        Self { slope: [angle, 0.0], ..Self::default() }
    }

    /// No slope anywhere.
    #[must_use]
    pub fn is_level(&self) -> bool {
        self.slope == [0.0; 2] && self.wave == [0.0; 2]
    }

    /// The angles where the robot's output is, rad. Each axis has a wave along itself.
    #[must_use]
    pub fn angles(&self, output: &[f64]) -> [f64; 2] {
        std::array::from_fn(|axis| {
            let at = output.get(axis).copied().unwrap_or_default();
            let wave = match self.wave[axis] {
                0.0 => 0.0,
                size => size * (std::f64::consts::TAU * at / self.wavelength + self.phase).sin(),
            };
            self.slope[axis] + wave
        })
    }
}

/// Change of gravity's direction in the floor's axes.
pub(crate) fn turned_gravity(angles: [f64; 2]) -> Vector3<f64> {
    let [x, y] = angles.map(f64::sin);
    let down = (1.0 - x * x - y * y).max(0.0).sqrt();
    Vector3::new(-x, -y, 1.0 - down)
}

/// Where a robot's weight acts: found from its potential energy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Weights {
    /// Weight of the rigid bodies, N: acts at their centre of mass.
    pub rigid: f64,
    /// Further weights, N, by index of a point of the description. What a model writes as an energy
    /// instead of as a rigid body is known to the model's author alone: the mass of a rolling ball.
    pub points: Vec<(usize, f64)>,
}

impl Weights {
    /// The weight of the rigid bodies, from ∂V/∂q = m g ∂z/∂q, beside further weights at points.
    ///
    /// # Errors
    ///
    /// [`Error::NotWeight`] if the potential energy is another than that of these weights: it has
    /// springs, or matter that is written as an energy.
    pub fn of<const N: usize>(
        system: &dyn LagrangianSystem<f64, N>,
        points: &[(usize, f64)],
    ) -> Result<Self, Error> {
        let mut weights = Self { rigid: 0.0, points: points.to_vec() };
        let states = probes(system);
        let (mut along, mut square) = (0.0, 0.0);
        for q in &states {
            let rest = system.gravity(q) + weights.pull(system, q, &-Vector3::z());
            let slope = center_slope(system, q, &Vector3::z());
            along += rest.dot(&slope);
            square += slope.dot(&slope);
        }
        if square > 0.0 {
            weights.rigid = along / square;
        }
        let (mut residual, mut size) = (0.0_f64, f64::MIN_POSITIVE);
        for q in &states {
            let gravity = system.gravity(q);
            residual = residual.max((gravity + weights.pull(system, q, &-Vector3::z())).norm());
            size = size.max(gravity.norm());
        }
        if residual > 1e-6 * size {
            return Err(Error::NotWeight { residual, gravity: size });
        }
        Ok(weights)
    }

    /// Generalised force of the weights if gravity pulls along `direction`.
    pub(crate) fn pull<const N: usize>(
        &self,
        system: &dyn LagrangianSystem<f64, N>,
        q: &SVector<f64, N>,
        direction: &Vector3<f64>,
    ) -> SVector<f64, N> {
        let mut force = SVector::zeros();
        if self.rigid != 0.0 {
            force += center_slope(system, q, direction) * self.rigid;
        }
        for &(point, weight) in &self.points {
            force += system.point_jacobian(q, point).transpose() * direction * weight;
        }
        force
    }
}

/// States at which a potential is looked at: spread over the ranges.
fn probes<const N: usize>(system: &dyn LagrangianSystem<f64, N>) -> [SVector<f64, N>; 3] {
    let coordinates = system.description().coordinates;
    [0.31, -0.17, 0.44].map(|part: f64| {
        SVector::from_fn(|i, _| {
            let reach = coordinates.get(i).map_or(1.0, |c| c.upper.min(1.0));
            part * reach * (1.0 + 0.37 * i as f64).cos()
        })
    })
}

/// ∂(direction · centre of mass)/∂q by central differences: exact to 1e-9 of the robot's size.
fn center_slope<const N: usize>(
    system: &dyn LagrangianSystem<f64, N>,
    q: &SVector<f64, N>,
    direction: &Vector3<f64>,
) -> SVector<f64, N> {
    const STEP: f64 = 1e-4;
    SVector::from_fn(|i, _| {
        let at = |shift: f64| {
            let mut q = *q;
            q[i] += shift * STEP;
            system.center_of_mass(&q).dot(direction)
        };
        (at(1.0) - at(-1.0)) / (2.0 * STEP)
    })
}

/// How the lean that an inertial unit measures, relative to gravity, differs from the coordinates,
/// which are relative to the floor.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LeanOffset {
    /// Unactuated shape coordinates, as indices into q.
    coordinates: Vec<usize>,
    /// Their change per rise of the floor along x and y.
    per_angle: DMatrix<f64>,
}

impl LeanOffset {
    /// The inertial unit sits on the first frame whose z axis leans with every unactuated shape
    /// coordinate and with no position variable.
    pub(crate) fn of<const N: usize>(system: &dyn LagrangianSystem<f64, N>) -> Self {
        let description = system.description();
        let position = description.position_count;
        let coordinates: Vec<usize> =
            description.unactuated_shape().map(|index| position + index).collect();
        for frame in 0..description.frames.len() {
            let tilt = tilt(system, frame);
            let leans = tilt.select_columns(&coordinates);
            let still = (0..position).all(|k| tilt.column(k).norm() < 1e-6);
            let gram = leans.transpose() * &leans;
            if coordinates.is_empty() || !still || gram.determinant() < 1e-3 {
                continue;
            }
            if let Some(inverse) = gram.try_inverse() {
                return Self { per_angle: inverse * leans.transpose(), coordinates };
            }
        }
        Self { per_angle: DMatrix::zeros(0, 2), coordinates: Vec::new() }
    }

    /// What is added to the coordinates when the floor rises by `angles`.
    pub(crate) fn at<const N: usize>(&self, angles: [f64; 2]) -> SVector<f64, N> {
        let mut offset = SVector::zeros();
        for (row, &coordinate) in self.coordinates.iter().enumerate() {
            offset[coordinate] =
                -self.per_angle[(row, 0)] * angles[0] - self.per_angle[(row, 1)] * angles[1];
        }
        offset
    }
}

/// ∂(x, y of the frame's z axis)/∂q at the origin.
fn tilt<const N: usize>(system: &dyn LagrangianSystem<f64, N>, frame: usize) -> DMatrix<f64> {
    const STEP: f64 = 1e-4;
    let mut tilt = DMatrix::zeros(2, N);
    for k in 0..N {
        let axis = |shift: f64| {
            let mut q = SVector::zeros();
            q[k] = shift;
            let rotation: SMatrix<f64, 3, 3> = system.frame_rotation(&q, frame);
            [rotation[(0, 2)], rotation[(1, 2)]]
        };
        let (plus, minus) = (axis(STEP), axis(-STEP));
        for row in 0..2 {
            tilt[(row, k)] = (plus[row] - minus[row]) / (2.0 * STEP);
        }
    }
    tilt
}
