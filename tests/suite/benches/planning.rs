//! Time per plan of the tasks of Table II.

use divan::Bencher;
use shapebot_dynamics::ShapeAccelerated;
use shapebot_dynamics::nalgebra::SVector;
use shapebot_planner::{Task, Weighting, motion::Line, plan};
use shapebot_tests::planning::model_of;
use shapebot_tests::reference::{load, names};

fn main() {
    divan::main();
}

/// Reference tasks of the table.
fn tasks() -> Vec<String> {
    names("planning").into_iter().filter(|name| name.starts_with("table2_")).collect()
}

macro_rules! robots {
    ($({ $name:literal, $module:ident, $robot:ident, $($rest:tt)* })*) => {
        #[divan::bench(args = tasks(), sample_size = 1)]
        fn table_2(bencher: Bencher<'_, '_>, task: &str) {
            let data = load("planning", task).expect("a task");
            let direction = data.get("task").get("direction");
            let direction: Vec<f64> = direction.list().iter().map(|x| x.number()).collect();
            match model_of(data.get("system").text()) {
                $($name => time(bencher, &shapebot_generated::$module::$robot::<f64>::from_model(), &direction),)*
                other => panic!("no robot `{other}`"),
            }
        }
    };
}

shapebot_generated::for_each_robot!(robots);

/// Two metres in five seconds, leaning with the unactuated shape set alone.
fn time<const NX: usize, const NS: usize>(
    bencher: Bencher<'_, '_>,
    robot: &impl ShapeAccelerated<f64, NX, NS>,
    direction: &[f64],
) {
    let goal = SVector::<f64, NX>::from_fn(|i, _| 2.0 * direction[i]);
    let line = Line::new(SVector::zeros(), goal, 5.0, 9).expect("a line");
    let sets = robot.shape_description().shape_sets.iter();
    let ratios: Vec<f64> = sets.map(|set| f64::from(u8::from(!set.actuated))).collect();
    let task = Task::new(&line, 501).weighting(Weighting::Contributions(&ratios));
    bencher.bench_local(|| plan(robot, &task).expect("a plan").report().output_rmse);
}
