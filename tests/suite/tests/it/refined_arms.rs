//! The ballbot with arms: constraints, two phases, shares, force limits, files.

use shapebot_dynamics::ShapeAccelerated;
use shapebot_dynamics::nalgebra::{SVector, Vector2};
use shapebot_generated::ballbot3d_arms::Ballbot3dArms;
use shapebot_planner::motion::{DesiredMotion, Legs, Line, Rest};
use shapebot_planner::value::{
    FileError, PlanText, PlanView, RobotId, encode, verify_text, write_csv, write_json,
};
use shapebot_planner::{
    Constrained, Error, RefinedPlan, Refinement, SetMotion, Spare, Start, Task, TwoPhases,
    Weighting, Workspace, actuator_force, choose_shares, refine, refine_with_forces,
};
use std::io::Write;

fn robot() -> Ballbot3dArms<f64> {
    Ballbot3dArms::from_model()
}

fn line(goal: [f64; 2], duration: f64) -> Line<f64, 2> {
    Line::new(Vector2::zeros(), goal.into(), duration, 9).expect("a line")
}

fn say(text: std::fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// One arm waves sideways, the other forward; the body keeps the ball where it is.
#[test]
fn asymmetric_waving_is_compensated_by_the_body() {
    let robot = robot();
    let swing = |x: f64, y: f64| {
        [line([x, y], 6.0), Line::new(Vector2::new(x, y), Vector2::zeros(), 6.0, 9).expect("one")]
    };
    let (left, right) = (swing(1.0, 0.0), swing(0.0, -1.2));
    let (left, right) = (Legs::new(&left).expect("legs"), Legs::new(&right).expect("legs"));
    let sets = [SetMotion { set: 0, motion: &left }, SetMotion { set: 1, motion: &right }];
    let constraint = Constrained::new(&robot, &sets).expect("a constraint");
    let rest = Rest::new(Vector2::zeros(), 12.0).expect("a rest");
    let task = Task::new(&rest, 1201)
        .weighting(Weighting::Contributions(&[0.0, 0.0, 1.0]))
        .constraint(constraint);
    let gained = *shapebot_planner::plan(&robot, &task).expect("a plan").report();
    let mut workspace = Workspace::<f64, 2, 96>::new();
    let plan = refine(&robot, &task, &Refinement::default(), &mut workspace).expect("a plan");
    let report = plan.report();
    say(format_args!(
        "waving: gain {:.2e} m, refined {:.2e} m, {} sweeps",
        gained.output_rmse, report.output_rmse, report.sweeps
    ));
    assert!(report.converged && report.output_rmse < 2e-5, "{report:?}");
    assert!(gained.output_rmse < 0.02, "{gained:?}");
}

/// The paper's lateral move of 1 m in 12.3 s: the right arm accelerates, the left arm brakes.
#[test]
fn a_lateral_move_in_two_phases() {
    let robot = robot();
    let phases = TwoPhases::new(Vector2::zeros(), Vector2::new(0.0, -1.0), 12.3).expect("phases");
    let arms = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let mut start: Option<Start<f64, 2, 6>> = None;
    for (half, (ratios, (moving, still))) in
        phases.halves.iter().zip(arms.iter().zip([(2, 0), (0, 2)]))
    {
        let task = Task::new(half, 616).weighting(Weighting::Contributions(ratios));
        // With a constant gain each arm stays on its own side of zero, exactly.
        let gained = shapebot_planner::plan(&robot, &task).expect("a gain plan");
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        for row in gained.rows(&robot) {
            low = low.min(row.plan.shape[moving]);
            high = high.max(row.plan.shape[moving]);
            assert_eq!(row.plan.shape[still], 0.0);
        }
        let gained_ends = [0.0, half.duration()].map(|t| gained.at(t));
        for end in gained_ends {
            for rate in [end.shape, end.shape_velocity, end.shape_acceleration] {
                assert!(rate.abs().max() < 1e-9, "{rate}");
            }
        }
        // The right arm swings to its side, the left arm to the other.
        let inward = if moving == 2 { high } else { -low };
        assert!(inward < 1e-9 && high - low > 0.5, "{low} {high}");
        // Refined, the second half begins where the first ends.
        let mut workspace = Workspace::<f64, 2, 64>::new();
        let mut refinement = Refinement::default();
        if let Some(start) = start {
            refinement = refinement.start(start);
        }
        let plan = refine(&robot, &task, &refinement, &mut workspace).expect("a plan");
        let report = plan.report();
        let (mut least, mut most) = (0.0_f64, 0.0_f64);
        for row in plan.rows(&robot, 1).expect("rows") {
            least = least.min(row.plan.shape[moving]);
            most = most.max(row.plan.shape[moving]);
        }
        say(format_args!(
            "lateral: gain arm {:.1}..{:.1} deg; refined {:.1}..{:.1} deg, RMSE {:.2e} m, end {:.1e} m",
            low.to_degrees(),
            high.to_degrees(),
            least.to_degrees(),
            most.to_degrees(),
            report.output_rmse,
            report.output_end_error
        ));
        assert!(report.converged && report.output_end_error < 1e-4, "{report:?}");
        assert!(if moving == 2 { most } else { -least } < 1e-3, "{least} {most}");
        let last = plan.rows(&robot, 1).expect("rows").last().expect("a row");
        assert!(last.plan.shape_velocity.abs().max() < 1e-9);
        start = Some(Start {
            position: last.position,
            velocity: last.velocity,
            shape: last.plan.shape,
            shape_velocity: last.plan.shape_velocity,
            shape_acceleration: Some(SVector::zeros()),
        });
    }
}

#[test]
fn shares_are_chosen_from_limits() {
    let robot = robot();
    let task_line = line([2.0, 0.0], 8.0);
    let task = Task::<_, _, 6>::new(&task_line, 401);
    let mut workspace = Workspace::<f64, 2, 64>::new();
    let degrees = |arms: f64, lean: f64| {
        SVector::from([arms, arms, arms, arms, lean, lean].map(f64::to_radians))
    };
    let mut peaks = |limits, spare| {
        let refinement = Refinement::default().limits(limits);
        let mut shares = [0.0; 3];
        choose_shares(&robot, &task, &refinement, spare, &mut shares, &mut workspace).map(|()| {
            let task = task.weighting(Weighting::Contributions(&shares));
            let plan = refine(&robot, &task, &refinement, &mut workspace).expect("a plan");
            let peak = plan.report().peak_shape.map(f64::to_degrees);
            say(format_args!("shares {shares:.4?}: arms {:.2}, lean {:.3} deg", peak[1], peak[5]));
            (shares, peak)
        })
    };
    let (shares, peak) = peaks(degrees(40.0, 10.0), Spare::Unactuated).expect("shares");
    assert!(peak[1] <= 40.0 && peak[1] > 39.0 && (shares[0] - shares[1]).abs() < 1e-12, "{peak}");
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    let (_, peak) = peaks(degrees(80.0, 1.2), Spare::Actuated).expect("shares");
    assert!(peak[5] <= 1.2 && peak[5] > 1.17, "{peak}");
    // A gentle motion needs no arms at all, or no lean.
    let (shares, _) = peaks(degrees(80.0, 10.0), Spare::Actuated).expect("shares");
    assert!(shares[2] > 1.0 - 1e-9, "{shares:?}");
    let error = peaks(degrees(5.0, 0.5), Spare::Unactuated).expect_err("refused");
    assert!(matches!(error, Error::LimitExceeded { .. }), "{error}");
}

#[test]
fn forces_are_limits_too() {
    let robot = robot();
    let mut workspace = Workspace::<f64, 2, 96>::new();
    let leap = line([8.0, 0.0], 3.2);
    let ratios = [0.0, 0.0, 1.0];
    let task = Task::new(&leap, 321).weighting(Weighting::Contributions(&ratios));
    let error = refine_with_forces::<_, _, _, _, 8, 2, 6, 96>(
        &robot,
        &task,
        &Refinement::default(),
        &mut workspace,
    )
    .map(|_| ())
    .expect_err("refused");
    say(format_args!("{error}"));
    let Error::LimitExceeded { duration: Some(duration), .. } = error else {
        panic!("{error}");
    };
    let slower = line([8.0, 0.0], duration);
    let task = Task::new(&slower, 321).weighting(Weighting::Contributions(&ratios));
    let (plan, forces) = refine_with_forces::<_, _, _, _, 8, 2, 6, 96>(
        &robot,
        &task,
        &Refinement::default(),
        &mut workspace,
    )
    .expect("a plan");
    assert!(plan.report().converged && forces.peak.max() <= 60.0);
}

type Plan<'a> = RefinedPlan<'a, Line<f64, 2>, shapebot_planner::Unconstrained, f64, 2, 6>;

fn stored<T>(check: impl FnOnce(&Ballbot3dArms<f64>, &Plan<'_>) -> T) -> T {
    let (robot, line) = (robot(), line([1.0, 0.5], 5.0));
    let ratios = [0.2, 0.2, 0.6];
    let task = Task::new(&line, 501).weighting(Weighting::Contributions(&ratios));
    let slow = Line::new(Vector2::zeros(), Vector2::new(0.2, 0.1), 6.0, 9).expect("a line");
    let task = Task { motion: &slow, ..task };
    let mut workspace = Workspace::<f64, 2, 64>::new();
    let plan = refine(&robot, &task, &Refinement::default(), &mut workspace).expect("a plan");
    check(&robot, &plan)
}

#[test]
fn altered_and_truncated_files_are_refused() {
    stored(|robot, plan| {
        let rows = || plan.rows(robot, 1).expect("rows");
        let force = |row: &_| actuator_force::<_, _, 8, 2, 6>(robot, row);
        let id = RobotId::of(robot.shape_description());
        let mut bytes = vec![0; 1 << 16];
        let used = encode::<f32, _, 2, 6, 8>(&id, rows(), 10, force, &mut bytes).expect("bytes");
        bytes.truncate(used);
        let view = PlanView::<f32, 2, 6, 8>::open(&bytes, &id).expect("a plan");
        let deviation = view.deviation(rows(), force);
        say(format_args!("{used} bytes, {deviation:?}"));
        assert!(deviation.shape < 1e-5 && deviation.position < 1e-4 && deviation.force < 0.05);
        for cut in 0..used {
            assert!(PlanView::<f32, 2, 6, 8>::open(&bytes[..cut], &id).is_err(), "{cut}");
        }
        for index in 0..used {
            for bit in 0..8 {
                let mut altered = bytes.clone();
                altered[index] ^= 1 << bit;
                assert!(PlanView::<f32, 2, 6, 8>::open(&altered, &id).is_err(), "{index}");
            }
        }
        let heavier = RobotId::with(robot.shape_description(), |name| {
            (name == robot.shape_description().parameters[0].name).then_some(123.0)
        });
        let refusal = PlanView::<f32, 2, 6, 8>::open(&bytes, &heavier).map(|_| ());
        assert!(matches!(refusal, Err(FileError::OtherRobot { .. })));
        assert_eq!(view.robot(), &id);
        let mismatch = PlanView::<f64, 2, 6, 8>::open(&bytes, &id).map(|_| ());
        assert!(matches!(mismatch, Err(FileError::Mismatch { field: "bytes per number", .. })));
        let mut newer = bytes.clone();
        newer[4] = 3;
        let refusal = PlanView::<f32, 2, 6, 8>::open(&newer, &id).map(|_| ());
        assert_eq!(refusal, Err(FileError::Version { found: 3 }));
        let small = encode::<f32, _, 2, 6, 8>(&id, rows(), 10, force, &mut [0; 100]);
        assert!(matches!(small, Err(FileError::BufferTooSmall { found: 100, .. })));
        let stride = encode::<f32, _, 2, 6, 8>(&id, rows(), 7, force, &mut bytes);
        assert!(matches!(stride, Err(FileError::Nodes { stride: 7, .. })));
    });
}

#[test]
fn text_files_carry_version_and_checksum() {
    stored(|robot, plan| {
        let force = |row: &_| actuator_force::<_, _, 8, 2, 6>(robot, row);
        let names = ["f0", "f1", "f2", "f3", "f4", "f5", "f6", "f7"];
        let description = robot.shape_description();
        let id = RobotId::of(description);
        let rows = || plan.rows(robot, 1).expect("rows");
        let (mut csv, mut json) = (String::new(), String::new());
        write_csv(&mut csv, &id, description, names, rows(), force).expect("csv");
        write_json(&mut json, &id, description, names, rows(), force).expect("json");
        let header: Vec<&str> = csv.lines().nth(1).expect("a header").split(',').collect();
        let first: Vec<f64> = csv
            .lines()
            .nth(2)
            .expect("a row")
            .split(',')
            .map(|x| x.parse().expect("a number"))
            .collect();
        assert_eq!((header.len(), first.len()), (1 + 2 + 2 + 6 + 18 + 8, header.len()));
        for text in [&csv, &json] {
            assert_eq!(verify_text(text), Ok(()));
            let read = PlanText::open(text).expect("a plan");
            assert_eq!(read.robot(), &id);
            assert!(read.columns().eq(header.iter().copied()));
            assert_eq!(read.rows().count(), 501);
            assert!(read.rows().next().expect("a row").flatten().eq(first.iter().copied()));
            assert!(verify_text(&text[..text.len() - 5]).is_err());
            assert!(verify_text(&text[..text.len() / 2]).is_err());
            let altered = text.replacen('7', "8", 1);
            assert!(verify_text(&altered).is_err());
            let newer = text.replacen("shapebot-plan 2", "shapebot-plan 3", 1).replacen(
                "\"version\": 2",
                "\"version\": 3",
                1,
            );
            assert_eq!(verify_text(&newer), Err(FileError::Version { found: 3 }));
        }
        assert_eq!(verify_text("t,x\n0,1\n"), Err(FileError::NotAPlan));
    });
}
