//! Γ of the paper's robots, derived with pen and paper.

use super::dual::Dual;
use nalgebra::{SMatrix, SVector, Vector1, Vector2};
use shapebot_dynamics::{
    Coordinate, Description, Ordered, Real, Response, Role, ShapeAccelerated, ShapeSet,
};

pub const GRAVITY: f64 = 9.81;

/// What is written by hand; [`Robot`] adds the rest of the trait.
pub trait Equations<const NX: usize, const NS: usize> {
    fn gamma<T: Real>(
        &self,
        qs: &SVector<T, NS>,
        qsd: &SVector<T, NS>,
        qsdd: &SVector<T, NS>,
    ) -> SVector<T, NX>;
    fn output<T: Real>(&self, qx: &SVector<T, NX>, qs: &SVector<T, NS>) -> SVector<T, NX>;
    fn description(&self) -> &Description;
}

#[derive(Clone, Copy, Debug)]
pub struct Robot<E>(pub E);

fn dual<T: Real, const N: usize>(
    v: &SVector<T, N>,
    direction: Option<usize>,
) -> SVector<Dual<T>, N> {
    SVector::from_fn(|i, _| Dual {
        value: v[i],
        slope: if direction == Some(i) { T::one() } else { T::zero() },
    })
}

/// The matrix whose column k is the slope of `f(Some(k))`.
fn jacobian<T: Real, const R: usize, const C: usize>(
    f: impl Fn(Option<usize>) -> SVector<Dual<T>, R>,
) -> SMatrix<T, R, C> {
    let mut matrix = SMatrix::zeros();
    for k in 0..C {
        let column = f(Some(k));
        for i in 0..R {
            matrix[(i, k)] = column[i].slope;
        }
    }
    matrix
}

impl<T, E, const NX: usize, const NS: usize> ShapeAccelerated<T, NX, NS> for Robot<E>
where
    T: Ordered,
    E: Equations<NX, NS>,
{
    fn gamma(
        &self,
        qs: &SVector<T, NS>,
        qsd: &SVector<T, NS>,
        qsdd: &SVector<T, NS>,
    ) -> SVector<T, NX> {
        self.0.gamma(qs, qsd, qsdd)
    }
    fn gamma_prime(&self, qs: &SVector<T, NS>) -> SVector<T, NX> {
        self.0.gamma(qs, &SVector::zeros(), &SVector::zeros())
    }
    fn gamma_prime_jacobian(&self, qs: &SVector<T, NS>) -> SMatrix<T, NX, NS> {
        self.response(qs, &SVector::zeros(), &SVector::zeros()).d_qs
    }
    fn shape_gain(&self) -> SMatrix<T, NX, NS> {
        self.gamma_prime_jacobian(&SVector::zeros())
    }
    fn response(
        &self,
        qs: &SVector<T, NS>,
        qsd: &SVector<T, NS>,
        qsdd: &SVector<T, NS>,
    ) -> Response<T, NX, NS> {
        let gamma = |a, b, c| self.0.gamma(&dual(qs, a), &dual(qsd, b), &dual(qsdd, c));
        Response {
            gamma: self.0.gamma(qs, qsd, qsdd),
            d_qs: jacobian(|k| gamma(k, None, None)),
            d_qsd: jacobian(|k| gamma(None, k, None)),
            d_qsdd: jacobian(|k| gamma(None, None, k)),
        }
    }
    fn output(&self, qx: &SVector<T, NX>, qs: &SVector<T, NS>) -> SVector<T, NX> {
        self.0.output(qx, qs)
    }
    fn output_jacobian_position(&self) -> SMatrix<T, NX, NX> {
        jacobian(|k| self.0.output(&dual(&SVector::zeros(), k), &dual(&SVector::zeros(), None)))
    }
    fn output_jacobian_shape(
        &self,
        qx: &SVector<T, NX>,
        qs: &SVector<T, NS>,
    ) -> SMatrix<T, NX, NS> {
        jacobian(|k| self.0.output(&dual(qx, None), &dual(qs, k)))
    }
    fn shape_description(&self) -> &Description {
        self.0.description()
    }
}

pub const fn position(name: &'static str, unit: &'static str) -> Coordinate {
    let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
    Coordinate { name, unit, role: Role::Position, actuated: true, lower, upper }
}

pub const fn shape(name: &'static str, actuated: bool, limit: f64) -> Coordinate {
    Coordinate { name, unit: "rad", role: Role::Shape, actuated, lower: -limit, upper: limit }
}

pub const fn set(name: &'static str, first: usize, len: usize, actuated: bool) -> ShapeSet {
    ShapeSet { name, first, len, actuated }
}

pub const NOTHING: Description = Description {
    name: "",
    summary: "",
    coordinates: &[],
    position_count: 0,
    shape_sets: &[],
    actuators: &[],
    parameters: &[],
    outputs: &[],
    output_unit: "m",
    frames: &[],
    points: &[],
    geometry: &[],
    friction: &[],
};

const LEAN: f64 = 0.5;

/// A point mass on a massless pole: cos φ ẍ + l φ̈ = g sin φ.
#[derive(Clone, Copy, Debug)]
pub struct CartPole {
    pub length: f64,
}

pub static CART_POLE: Description = Description {
    name: "cartpole",
    coordinates: &[position("x", "m"), shape("phi", false, LEAN)],
    position_count: 1,
    shape_sets: &[set("phi", 0, 1, false)],
    outputs: &["x"],
    ..NOTHING
};

impl Equations<1, 1> for CartPole {
    fn gamma<T: Real>(&self, qs: &Vector1<T>, _: &Vector1<T>, qsdd: &Vector1<T>) -> Vector1<T> {
        let (s, c) = qs[0].sin_cos();
        Vector1::new((T::from_f64(GRAVITY) * s - T::from_f64(self.length) * qsdd[0]) / c)
    }
    fn output<T: Real>(&self, qx: &Vector1<T>, _: &Vector1<T>) -> Vector1<T> {
        *qx
    }
    fn description(&self) -> &Description {
        &CART_POLE
    }
}

/// Parameters of a ballbot without arms, named as in Table I.
#[derive(Clone, Copy, Debug)]
pub struct Ballbot {
    pub r_w: f64,
    pub m_w: f64,
    pub i_w: f64,
    pub m_b: f64,
    pub l_b: f64,
    pub i_b: [f64; 3],
}

/// Table I.
pub const TABLE_I: Ballbot = Ballbot {
    r_w: 0.1058,
    m_w: 2.44,
    i_w: 0.0174,
    m_b: 70.3,
    l_b: 0.87,
    i_b: [12.59, 12.48, 0.66],
};

impl Ballbot {
    /// η₁, η₂, η₃ of Eq. 21.
    fn eta<T: Real>(&self) -> [T; 3] {
        [
            self.i_w + (self.m_b + self.m_w) * self.r_w * self.r_w,
            self.m_b * self.l_b * self.r_w,
            self.m_b * GRAVITY * self.l_b,
        ]
        .map(T::from_f64)
    }

    /// Moment of inertia of the body about axis `k` through the ball's centre, m_b l_b² + I_k.
    fn about_ball<T: Real>(&self, k: usize) -> T {
        T::from_f64(self.m_b * self.l_b * self.l_b + self.i_b[k])
    }
}

/// The pitch plane of a ballbot, q = [θ, φ].
#[derive(Clone, Copy, Debug)]
pub struct Planar(pub Ballbot);

pub static PLANAR: Description = Description {
    name: "ballbot_planar",
    coordinates: &[position("theta", "rad"), shape("phi", false, LEAN)],
    position_count: 1,
    shape_sets: &[set("phi", 0, 1, false)],
    outputs: &["x_w"],
    ..NOTHING
};

impl Equations<1, 1> for Planar {
    fn gamma<T: Real>(&self, qs: &Vector1<T>, qsd: &Vector1<T>, qsdd: &Vector1<T>) -> Vector1<T> {
        let [eta1, eta2, eta3] = self.0.eta::<T>();
        let (s, c) = qs[0].sin_cos();
        let m_phi = eta1 + (eta2 + eta2) * c + self.0.about_ball(1);
        let coriolis = -eta2 * s * qsd[0] * qsd[0];
        Vector1::new((eta3 * s - coriolis - m_phi * qsdd[0]) / (eta1 + eta2 * c))
    }
    fn output<T: Real>(&self, qx: &Vector1<T>, qs: &Vector1<T>) -> Vector1<T> {
        (qx + qs) * T::from_f64(self.0.r_w)
    }
    fn description(&self) -> &Description {
        &PLANAR
    }
}

/// A ballbot, q = [θ_x, θ_y, φ_x, φ_y].
#[derive(Clone, Copy, Debug)]
pub struct Spatial(pub Ballbot);

pub static SPATIAL: Description = Description {
    name: "ballbot3d",
    coordinates: &[
        position("theta_x", "rad"),
        position("theta_y", "rad"),
        shape("phi_x", false, LEAN),
        shape("phi_y", false, LEAN),
    ],
    position_count: 2,
    shape_sets: &[set("phi", 0, 2, false)],
    outputs: &["x_w", "y_w"],
    ..NOTHING
};

impl Equations<2, 2> for Spatial {
    /// With u = θ̇_x + φ̇_y, w = θ̇_y − φ̇_x (the ball's velocity over r_w) and the body's centre at
    /// l_b (p, −q, …), p = c_x s_y, q = s_x, the kinetic energy is
    /// ½ η₁ (u² + w²) + η₂ (u ṗ − w q̇) + ½ (A φ̇_x² + B(φ_x) φ̇_y²); its φ rows give u̇ and ẇ.
    fn gamma<T: Real>(&self, qs: &Vector2<T>, qsd: &Vector2<T>, qsdd: &Vector2<T>) -> Vector2<T> {
        let [eta1, eta2, eta3] = self.0.eta::<T>();
        let ((sx, cx), (sy, cy)) = (qs[0].sin_cos(), qs[1].sin_cos());
        let (dx, dy, ddx, ddy) = (qsd[0], qsd[1], qsdd[0], qsdd[1]);
        let two = T::from_f64(2.0);
        let (a, across, yaw) =
            (self.0.about_ball::<T>(0), self.0.about_ball::<T>(1), T::from_f64(self.0.i_b[2]));
        let b = across * cx * cx + yaw * sx * sx;
        let db = two * sx * cx * (yaw - across);
        let ddp =
            cx * cy * ddy - sx * sy * ddx - cx * sy * (dx * dx + dy * dy) - two * sx * cy * dx * dy;
        let ddq = cx * ddx - sx * dx * dx;
        let du = (eta3 * cx * sy - eta2 * ddp - b * ddy - db * dx * dy) / (eta1 + eta2 * cx * cy);
        let dw = (eta2 * ddq + a * ddx - eta2 * sx * sy * du - db * dy * dy / two - eta3 * sx * cy)
            / (eta1 + eta2 * cx);
        Vector2::new(du - ddy, dw + ddx)
    }
    fn output<T: Real>(&self, qx: &Vector2<T>, qs: &Vector2<T>) -> Vector2<T> {
        Vector2::new(qx[0] + qs[1], qx[1] - qs[0]) * T::from_f64(self.0.r_w)
    }
    fn description(&self) -> &Description {
        &SPATIAL
    }
}

/// Two arms and a body that accelerate a ball linearly: Γ = K⁰_qs q_s − τ² K⁰_qs q̈_s.
#[derive(Clone, Copy, Debug)]
pub struct LinearArms {
    pub shape_gain: SMatrix<f64, 2, 6>,
    pub tau_squared: f64,
}

pub static LINEAR_ARMS: Description = Description {
    name: "linear_arms",
    coordinates: &[
        position("theta_x", "rad"),
        position("theta_y", "rad"),
        shape("alpha_l_x", true, 2.0),
        shape("alpha_l_y", true, 2.0),
        shape("alpha_r_x", true, 2.0),
        shape("alpha_r_y", true, 2.0),
        shape("phi_x", false, LEAN),
        shape("phi_y", false, LEAN),
    ],
    position_count: 2,
    shape_sets: &[set("alpha_l", 0, 2, true), set("alpha_r", 2, 2, true), set("phi", 4, 2, false)],
    outputs: &["x_w", "y_w"],
    ..NOTHING
};

impl Equations<2, 6> for LinearArms {
    fn gamma<T: Real>(
        &self,
        qs: &SVector<T, 6>,
        _: &SVector<T, 6>,
        qsdd: &SVector<T, 6>,
    ) -> Vector2<T> {
        self.shape_gain.map(T::from_f64) * (qs - qsdd * T::from_f64(self.tau_squared))
    }
    fn output<T: Real>(&self, qx: &Vector2<T>, _: &SVector<T, 6>) -> Vector2<T> {
        qx * T::from_f64(0.1058)
    }
    fn description(&self) -> &Description {
        &LINEAR_ARMS
    }
}
