//! Generated code against formulas worked out by hand.

use shapebot_dynamics::nalgebra::{Matrix2, SVector, Vector1, Vector2};
use shapebot_dynamics::{LagrangianSystem, ShapeAccelerated};
use shapebot_tests::compare::assert_close;
use shapebot_tests::states::{State, states};

/// States of a generated robot by its module.
macro_rules! states_of {
    ($module:ident, $n:literal) => {
        states::<$n>(&shapebot_generated::$module::DESCRIPTION, 10)
    };
}

/// T = ½ (2 (m_w + I_w/r²) + m_b) r² (θ̇ + φ̇)² + ½ I_m θ̇² + m_b r l cos φ (θ̇ + φ̇) φ̇ + ½ (m_b l² + I_b) φ̇²,
/// V = m_b g l cos φ.
#[test]
fn segway_is_the_textbook_wheeled_pendulum() {
    let robot = shapebot_generated::segway_planar::SegwayPlanar::<f64>::from_model();
    let p = *robot.params();
    let rolling = 2.0 * (p.m_w * p.r_w * p.r_w + p.I_w) + p.m_b * p.r_w * p.r_w;
    let (lever, upright) = (p.m_b * p.r_w * p.l_b, p.m_b * p.l_b * p.l_b + p.I_b);
    let weight = p.m_b * p.g * p.l_b;
    for State { q, qd, qdd, .. } in states_of!(segway_planar, 2) {
        let (sin, cos) = q[1].sin_cos();
        let coupling = rolling + lever * cos;
        let lean = rolling + 2.0 * lever * cos + upright;
        let mass = Matrix2::new(rolling + p.I_m, coupling, coupling, lean);
        let bias = Vector2::repeat(-lever * sin * qd[1] * qd[1]);
        let gravity = Vector2::new(0.0, -weight * sin);
        assert_close("M", &robot.mass_matrix(&q), &mass, 1e-13);
        assert_close("Cqd", &robot.coriolis_vector(&q, &qd), &bias, 1e-13);
        assert_close("G", &robot.gravity(&q), &gravity, 1e-13);
        let gamma = Vector1::new((-lean * qdd[1] - bias[1] - gravity[1]) / coupling);
        let part = |v: SVector<f64, 2>| Vector1::new(v[1]);
        assert_close("Gamma", &robot.gamma(&part(q), &part(qd), &part(qdd)), &gamma, 1e-13);
    }
    let gain = Vector1::new(weight / (rolling + lever));
    assert_close("K0_qs", &ShapeAccelerated::<f64, 1, 1>::shape_gain(&robot), &gain, 1e-13);
}

/// On a tilted plate a solid ball rolls with 5/7 of the acceleration of one that slides.
#[test]
fn marble_rolls_with_five_sevenths_of_the_downhill_acceleration() {
    let robot = shapebot_generated::marble_maze::MarbleMaze::<f64>::from_model();
    let p = *robot.params();
    let half = 0.5 * (p.m + 0.4 * p.m);
    for State { q, qd, qdd, .. } in states_of!(marble_maze, 4) {
        let part = |v: SVector<f64, 4>| Vector2::new(v[2], v[3]);
        let (sin_x, (sin_y, cos_y)) = (q[2].sin(), q[3].sin_cos());
        let downhill = Vector2::new(p.g * sin_y, -p.g * cos_y * sin_x) * (5.0 / 7.0);
        assert_close("Gamma", &robot.gamma(&part(q), &part(qd), &part(qdd)), &downhill, 1e-13);
        let mass = robot.mass_matrix(&q);
        assert_close("M of the marble", &mass[(0, 0)], &(2.0 * half), 1e-13);
        assert_close("M of the marble", &mass[(1, 1)], &(2.0 * half), 1e-13);
        assert_eq!(mass.fixed_view::<2, 2>(0, 2).into_owned(), Matrix2::zeros());
    }
}

/// M = [[m_c + m_p, m_p l cos φ], [·, m_p l²]]; the masses do not enter Γ = (g sin φ − l φ̈)/cos φ.
#[test]
fn cart_pole_has_its_closed_form() {
    let robot = shapebot_generated::cartpole_planar::CartpolePlanar::<f64>::from_model();
    let p = *robot.params();
    for State { q, qd, qdd, .. } in states_of!(cartpole_planar, 2) {
        let (sin, cos) = q[1].sin_cos();
        let coupling = p.m_p * p.l * cos;
        let mass = Matrix2::new(p.m_c + p.m_p, coupling, coupling, p.m_p * p.l * p.l);
        assert_close("M", &robot.mass_matrix(&q), &mass, 1e-14);
        let bias = Vector2::new(-p.m_p * p.l * sin * qd[1] * qd[1], 0.0);
        assert_close("Cqd", &robot.coriolis_vector(&q, &qd), &bias, 1e-14);
        let gamma = Vector1::new((p.g * sin - p.l * qdd[1]) / cos);
        let part = |v: SVector<f64, 2>| Vector1::new(v[1]);
        assert_close("Gamma", &robot.gamma(&part(q), &part(qd), &part(qdd)), &gamma, 1e-14);
    }
}

/// In the pitch plane the ballbot in space is the planar ballbot.
#[test]
fn ballbot_in_space_moves_in_the_pitch_plane_like_the_planar_one() {
    let space = shapebot_generated::ballbot3d::Ballbot3d::<f64>::from_model();
    let plane = shapebot_generated::ballbot_planar::BallbotPlanar::<f64>::from_model();
    for State { q, qd, qdd, .. } in states_of!(ballbot_planar, 2) {
        let lift = |v: SVector<f64, 2>| SVector::<f64, 4>::from([v[0], 0.0, 0.0, v[1]]);
        let force = space.inverse_dynamics(&lift(q), &lift(qd), &lift(qdd));
        let expected = lift(plane.inverse_dynamics(&q, &qd, &qdd));
        assert_close("forces", &force, &expected, 1e-12);
    }
}
