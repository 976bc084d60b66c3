//! Plans of generated robots against those of an independent implementation of the paper's planner.

use shapebot_dynamics::nalgebra::SMatrix;
use shapebot_generated::ballbot3d_arms;
use shapebot_planner::Weighting;
use shapebot_tests::compare::assert_close;
use shapebot_tests::planning::{model_of, reference_point, reference_task};
use shapebot_tests::reference::{Data, load, names};

macro_rules! robots {
    ($({ $name:literal, $module:ident, $robot:ident, $($rest:tt)* })*) => {
        /// Checks a task with the robot of its model.
        fn check_task(model: &str, name: &str, data: &Data) {
            match model {
                $($name => {
                    let robot = shapebot_generated::$module::$robot::<f64>::from_model();
                    reference_task(name, &robot, data);
                })*
                other => panic!("no robot `{other}`"),
            }
        }

        /// Checks a point with the robot of its model.
        fn check_point(model: &str, name: &str, point: &Data) {
            match model {
                $($name => {
                    let robot = shapebot_generated::$module::$robot::<f64>::from_model();
                    reference_point(name, &robot, point);
                })*
                other => panic!("no robot `{other}`"),
            }
        }
    };
}

shapebot_generated::for_each_robot!(robots);

fn task(name: &str) {
    let data = load("planning", name).expect("a reference task");
    check_task(model_of(data.get("system").text()), name, &data);
}

#[test]
fn plans_of_all_reference_tasks_are_reproduced() {
    let mut tasks = names("planning");
    tasks.retain(|name| name != "gamma_points");
    assert!(tasks.len() >= 11, "reference tasks: {tasks:?}");
    tasks.iter().for_each(|name| task(name));
}

#[test]
fn gamma_agrees_at_the_reference_points() {
    let data = load("planning", "gamma_points").expect("reference points");
    let points = data.get("points");
    let systems = points.0.as_object().expect("points by system");
    assert_eq!(systems.len(), 4);
    for system in systems.keys() {
        let list = points.get(system).list();
        assert!(!list.is_empty(), "{system}: no points");
        for (index, point) in list.iter().enumerate() {
            check_point(model_of(system), &format!("{system}, point {index}"), point);
        }
    }
}

/// W of Eqs. 27-30 for contributions of left arm, right arm and body.
fn paper_weights(p: &ballbot3d_arms::Params<f64>, ratios: [f64; 3]) -> SMatrix<f64, 6, 6> {
    let height = p.d_z - p.l_a;
    let chi_1 = p.m_a * p.g * p.l_a;
    let chi_2 = p.m_b * p.g * p.l_b + 2.0 * p.m_a * p.g * height;
    let mass = 2.0 * p.m_a + p.m_b + p.m_w;
    let chi_3 = p.I_w + mass * p.r_w * p.r_w + p.m_b * p.l_b * p.r_w + 2.0 * p.m_a * height * p.r_w;
    let entries = [chi_3 / chi_1, chi_3 / chi_1, chi_3 / chi_2];
    SMatrix::from_fn(|i, j| if i == j { entries[i / 2] * ratios[i / 2].sqrt() } else { 0.0 })
}

#[test]
fn weights_of_equations_27_to_30_are_contributions() {
    let robot = ballbot3d_arms::Ballbot3dArms::<f64>::from_model();
    for ratios in [[1.0 / 3.0; 3], [0.25, 0.25, 0.5], [0.7, 0.1, 0.2], [0.01, 0.01, 0.98]] {
        let weights = paper_weights(robot.params(), ratios);
        let paper: SMatrix<f64, 6, 2> = Weighting::Matrix(weights).gain(&robot).expect("a gain");
        let general: SMatrix<f64, 6, 2> =
            Weighting::Contributions(&ratios).gain(&robot).expect("a gain");
        assert_close(format!("gain for {ratios:?}"), &general, &paper, 1e-12);
    }
}
