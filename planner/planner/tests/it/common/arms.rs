//! A ballbot with two arms in its pitch plane, q = [θ, α_l, α_r, φ].

use super::robots::{Ballbot, Equations, GRAVITY, NOTHING, position, set, shape};
use nalgebra::{SVector, Vector1, Vector3};
use shapebot_dynamics::{Description, Real};

#[derive(Clone, Copy, Debug)]
pub struct PlanarArms {
    pub ballbot: Ballbot,
    pub m_a: f64,
    pub l_a: f64,
    pub i_a: f64,
    pub d_z: f64,
}

pub static PLANAR_ARMS: Description = Description {
    name: "ballbot_planar_arms",
    coordinates: &[
        position("theta", "rad"),
        shape("alpha_l", true, 1.6),
        shape("alpha_r", true, 1.6),
        shape("phi", false, 0.5),
    ],
    position_count: 1,
    shape_sets: &[set("alpha_l", 0, 1, true), set("alpha_r", 1, 1, true), set("phi", 2, 1, false)],
    outputs: &["x_w"],
    ..NOTHING
};

/// A point mass relative to the ball, in the plane, with its derivatives by φ.
#[derive(Clone, Copy)]
struct Mass<T> {
    mass: T,
    /// [x, z] of the position's derivative by φ.
    by_phi: [T; 2],
    /// [x, z] of the relative acceleration.
    acceleration: [T; 2],
}

/// A link of length `l` at angle β from the vertical.
fn link<T: Real>(l: T, angle: [T; 3]) -> ([T; 2], [T; 2]) {
    let [beta, rate, acceleration] = angle;
    let (s, c) = beta.sin_cos();
    let by_angle = [l * c, -l * s];
    let square = rate * rate;
    (by_angle, [l * (c * acceleration - s * square), -l * (s * acceleration + c * square)])
}

impl PlanarArms {
    /// Body and arms.
    fn masses<T: Real>(&self, q: [[T; 3]; 3]) -> [Mass<T>; 3] {
        let number = T::from_f64;
        let body = q[2];
        let (by_phi, acceleration) = link(number(self.ballbot.l_b), body);
        let (joint, joint_acceleration) = link(number(self.d_z), body);
        let arm = |k: usize| {
            let angle = core::array::from_fn(|r| body[r] + q[k][r]);
            let (hand, hand_acceleration) = link(-number(self.l_a), angle);
            Mass {
                mass: number(self.m_a),
                by_phi: [joint[0] + hand[0], joint[1] + hand[1]],
                acceleration: [
                    joint_acceleration[0] + hand_acceleration[0],
                    joint_acceleration[1] + hand_acceleration[1],
                ],
            }
        };
        [Mass { mass: number(self.ballbot.m_b), by_phi, acceleration }, arm(0), arm(1)]
    }
}

impl Equations<1, 3> for PlanarArms {
    /// The φ row: every mass times its acceleration (and gravity) along its motion with φ.
    fn gamma<T: Real>(&self, qs: &Vector3<T>, qsd: &Vector3<T>, qsdd: &Vector3<T>) -> Vector1<T> {
        let number = T::from_f64;
        let Ballbot { r_w, m_w, i_w, i_b, .. } = self.ballbot;
        let (r, gravity) = (number(r_w), number(GRAVITY));
        let ball = number(m_w * r_w * r_w + i_w);
        let arms = number(self.i_a);
        let mut inertia = ball;
        let mut force = ball * qsdd[2]
            + number(i_b[1]) * qsdd[2]
            + arms * (qsdd[2] + qsdd[0])
            + arms * (qsdd[2] + qsdd[1]);
        let q = [0, 1, 2].map(|k| [qs[k], qsd[k], qsdd[k]]);
        for Mass { mass, by_phi, acceleration } in self.masses(q) {
            let forward = r + by_phi[0];
            inertia += mass * r * forward;
            force += mass * (r * qsdd[2] + acceleration[0]) * forward
                + mass * (acceleration[1] + gravity) * by_phi[1];
        }
        Vector1::new(-force / inertia)
    }
    fn output<T: Real>(&self, qx: &Vector1<T>, qs: &SVector<T, 3>) -> Vector1<T> {
        Vector1::new((qx[0] + qs[2]) * T::from_f64(self.ballbot.r_w))
    }
    fn description(&self) -> &Description {
        &PLANAR_ARMS
    }
}
