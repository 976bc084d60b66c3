use super::*;
use approx::assert_relative_eq;
use shapebot_generated as generated;

#[test]
fn places_are_found_from_the_geometry() {
    let ballbot = generated::ballbot3d::Ballbot3d::<f64>::default();
    assert_eq!(find_place(&ballbot).expect("the ball's centre").carrier, None);
    let cart = generated::cartpole_planar::CartpolePlanar::<f64>::default();
    assert_eq!(find_place(&cart).expect("the cart").carrier, None);
    let maze = generated::marble_maze::MarbleMaze::<f64>::default();
    assert_eq!(find_place(&maze).expect("the marble on the plate").carrier, Some(0));
}

/// A ball of radius r that goes 2 π r straight ahead is turned once about the axis across.
#[test]
fn balls_roll_without_slipping() {
    let robot = generated::ballbot3d::Ballbot3d::<f64>::default();
    let mut recorder = Recorder::new(&robot);
    let steps = 100;
    for k in 0..=steps {
        let theta = std::f64::consts::FRAC_PI_2 * f64::from(k) / f64::from(steps);
        recorder.push(&[theta, 0.0, 0.0, 0.0].into(), &[0.0; 2].into(), &[0.0; 2].into());
    }
    let animation = recorder.finish();
    let [w, x, y, z] = animation.frames[100][0].rotation;
    let half = std::f64::consts::FRAC_PI_4;
    assert_relative_eq!(w, half.cos(), epsilon = 1e-9);
    assert_relative_eq!(y, half.sin(), epsilon = 1e-9);
    assert_relative_eq!(x.abs() + z.abs(), 0.0, epsilon = 1e-9);
    // It stands on the floor.
    let Shape::Sphere { radius } = Recorder::new(&robot).bodies[0].shape else { panic!("no ball") };
    assert_relative_eq!(animation.floor, -radius, epsilon = 1e-12);
    // The trunk leans with its frame alone.
    assert_eq!(animation.frames[100][1].rotation, [1.0, 0.0, 0.0, 0.0]);
}

#[test]
fn only_balls_on_the_floor_roll() {
    let robot = generated::ballbot3d_arms::Ballbot3dArms::<f64>::default();
    let recorder = Recorder::new(&robot);
    let rolling: Vec<&str> = (0..recorder.bodies.len())
        .filter(|&body| recorder.rolling[body])
        .map(|body| recorder.bodies[body].name.as_str())
        .collect();
    assert_eq!(rolling, ["wheel"]);
    let cart = generated::cartpole_planar::CartpolePlanar::<f64>::default();
    assert!(Recorder::new(&cart).rolling.iter().all(|rolls| !rolls));
}

/// On the tilted plate the marble's path is in the plate's axes, and lies on it.
#[test]
fn paths_are_carried_by_the_plate() {
    let robot = generated::marble_maze::MarbleMaze::<f64>::default();
    let mut recorder = Recorder::new(&robot);
    recorder.push(&[0.05, -0.02, 0.1, 0.2].into(), &[0.04, 0.0].into(), &[0.05, 0.0].into());
    let animation = recorder.finish();
    assert_eq!(animation.carrier, Some(0));
    let actual = animation.paths.iter().find(|path| path.stroke == Stroke::Actual).unwrap();
    assert_eq!(actual.points, [[0.05, -0.02, 0.003]]);
}
