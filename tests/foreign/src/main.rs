//! Prints a few functions of a generated robot, and what its controller does, one per line.

use shapebot_control::{Controller, Gains, State, Target};
use shapebot_dynamics::nalgebra::{Vector1, Vector2};
use shapebot_dynamics::{LagrangianSystem, Ordered, Robot};

shapebot_dynamics::include_model!("my_robot");

/// Works with any robot of one position and one shape variable.
fn print<T: Ordered>(robot: &impl Robot<T, 2, 1, 1>) {
    let c = T::from_f64;
    let (q, qd, qdd) = (Vector2::new(c(0.3), c(0.2)), Vector2::new(c(-0.4), c(0.7)), c(1.5));
    let shape = Vector1::new(q[1]);
    let gamma = robot.gamma(&shape, &Vector1::new(qd[1]), &Vector1::new(qdd));
    let mass = robot.mass_matrix(&q);
    let bias = robot.coriolis_vector(&q, &qd);
    let gravity = robot.gravity(&q);
    let gain = robot.shape_gain();
    for value in [gamma[0], mass[(0, 0)], mass[(0, 1)], mass[(1, 1)], bias[0], gravity[1], gain[0]] {
        println!("{}", value.to_f64());
    }
}

fn main() {
    let robot = my_robot::MyRobot::<f64>::from_model();
    print(&robot);
    print(&my_robot::MyRobot::<f32>::from_model());
    let heavier = my_robot::Params { m_c: 2.5, ..my_robot::Params::model() };
    let heavier = my_robot::MyRobot::<f64>::try_new(heavier).expect("parameters in range");
    println!("{}", heavier.mass_matrix(&Vector2::zeros())[(0, 0)]);
    let gains = Gains::from_design(&robot, &my_robot::CONTROL).expect("gains of this robot");
    let mut controller = Controller::new(&robot, &gains).expect("a controller");
    let leaning = State { q: Vector2::new(0.0, 0.05), qd: Vector2::zeros() };
    let command = controller.step(&leaning, &Target::stand(Vector1::zeros()));
    println!("{}", command.actuator[0]);
}
