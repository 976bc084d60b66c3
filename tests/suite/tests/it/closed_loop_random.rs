//! Every bundled robot on its default task under random conditions that fit its size: nobody falls. And
//! where falls begin.

use rayon::prelude::*;
use shapebot_control::{Controller, Gains};
use shapebot_dynamics::control::ControlDesign;
use shapebot_dynamics::{LagrangianSystem, Robot};
use shapebot_sim::{
    Floor, Push, Ranges, RateFilter, Run, Scale, Scenario, Timing, Weights, World, draw, onset,
    simulate,
};
use shapebot_tests::closed_loop::{Experiment, Method, RATE_BANDWIDTH, straight};
use shapebot_tests::environment::say;

/// Draws in a test run; the whole thousand with `--ignored`.
const SOME: u64 = 24;
const THOUSAND: u64 = 1000;

/// Parameters that differ from the model's.
type Settings = [(&'static str, f64)];

/// A robot with its design and its default task: 2 m in 5 s, or half of the way to its range's end.
struct Subject<'a, R, const N: usize, const NX: usize, const NS: usize> {
    name: &'a str,
    model: &'a R,
    gains: Gains<f64, NX, NS>,
    scale: Scale,
    task: Experiment<N, NX, NS>,
}

impl<'a, R, const N: usize, const NX: usize, const NS: usize> Subject<'a, R, N, NX, NS>
where
    R: Robot<f64, N, NX, NS> + Sync,
{
    fn new(name: &'a str, model: &'a R, design: &ControlDesign) -> Self {
        let upper = model.description().coordinates[0].upper;
        let half_way = 0.5 * upper * model.output_jacobian_position()[(0, 0)];
        Self {
            name,
            model,
            gains: Gains::from_design(model, design).expect("gains"),
            scale: Scale::of(model).expect("a scale"),
            task: straight(model, half_way.min(2.0), 5.0, Method::Refined),
        }
    }

    fn run(
        &self,
        plant: &dyn LagrangianSystem<f64, N>,
        scenario: &Scenario<NX, NS>,
    ) -> Run<N, NX, NS> {
        let timing =
            Timing { period: self.gains.period, after: 3.0, record_every: 0, ..Timing::default() };
        let world = World { system: plant, map: self.model, scenario, timing };
        let controller = Controller::new(self.model, &self.gains).expect("a controller");
        let bandwidth = RATE_BANDWIDTH / self.scale.time;
        let mut filtered = RateFilter::new(self.model, controller, self.gains.period, bandwidth);
        simulate(&world, &self.task.table, &mut filtered).expect("a run")
    }

    /// Random runs: number of falls, which are named.
    fn survives<P>(&self, count: u64, plant: impl Fn(&Settings) -> P + Sync)
    where
        P: LagrangianSystem<f64, N>,
    {
        let one = |index: u64| {
            let (description, ranges) = (self.model.description(), Ranges::default());
            let mut drawn = draw(description, &self.scale, &ranges, 5.0, [1, index]);
            let plant = plant(&drawn.parameters);
            if Weights::of(&plant, &[]).is_err() {
                // Where weight is written as an energy, what a slope does is not known.
                drawn.scenario.floor = Floor::default();
            }
            (index, self.run(&plant, &drawn.scenario))
        };
        let mut runs: Vec<_> = (0..count).into_par_iter().map(one).collect();
        let fallen: Vec<_> = runs.iter().filter_map(|(i, run)| Some((*i, run.fell?))).collect();
        runs.sort_by(|a, b| a.1.errors.plan_rmse.total_cmp(&b.1.errors.plan_rmse));
        let at = |part: f64| {
            let (index, run) = &runs[((runs.len() - 1) as f64 * part) as usize];
            format!("{:.4} m (draw {index})", run.errors.plan_rmse / self.scale.length)
        };
        say(&format!(
            "{}: {} of {count} fell; RMSE over length {:.3} m: half {}, 95 % {}, worst {}",
            self.name,
            fallen.len(),
            self.scale.length,
            at(0.5),
            at(0.95),
            at(1.0)
        ));
        assert!(fallen.is_empty(), "{}: {fallen:?}", self.name);
        let worst = runs.last().map_or(f64::INFINITY, |(_, run)| run.errors.plan_rmse);
        assert!(worst < 0.5 * self.scale.length, "{}: {worst} m", self.name);
    }
}

macro_rules! robots {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $(mod $module {
            use super::{SOME, Settings, Subject, THOUSAND};
            use shapebot_generated::$module::{CONTROL, Params, $robot};

            fn plant(settings: &Settings) -> $robot<f64> {
                let mut parameters = Params::<f64>::model();
                for (name, value) in settings {
                    parameters.set(name, *value);
                }
                $robot::try_new(parameters).expect("in range")
            }

            #[test]
            fn does_not_fall() {
                let model = $robot::<f64>::from_model();
                Subject::new($name, &model, &CONTROL).survives(SOME, plant);
            }

            #[test]
            #[ignore = "a thousand runs take minutes"]
            fn does_not_fall_in_a_thousand_runs() {
                let model = $robot::<f64>::from_model();
                Subject::new($name, &model, &CONTROL).survives(THOUSAND, plant);
            }
        })*
    };
}

shapebot_generated::for_each_robot!(robots);

/// The controller knows the textbook model, the plant is the full one.
mod maze_with_all_terms {
    use super::{SOME, Settings, Subject, THOUSAND};
    use shapebot_generated::marble_maze::{CONTROL, MarbleMaze};
    use shapebot_generated::marble_maze_full::{MarbleMazeFull, Params};

    fn plant(settings: &Settings) -> MarbleMazeFull<f64> {
        let mut parameters = Params::<f64>::model();
        for (name, value) in settings {
            parameters.set(name, *value);
        }
        MarbleMazeFull::try_new(parameters).expect("in range")
    }

    #[test]
    fn the_marble_stays_on_the_plate() {
        let model = MarbleMaze::<f64>::from_model();
        Subject::new("marble maze, all terms", &model, &CONTROL).survives(SOME, plant);
    }

    #[test]
    #[ignore = "a thousand runs take minutes"]
    fn the_marble_stays_on_the_plate_in_a_thousand_runs() {
        let model = MarbleMaze::<f64>::from_model();
        Subject::new("marble maze, all terms", &model, &CONTROL).survives(THOUSAND, plant);
    }
}

#[test]
fn falls_begin_beyond_the_ranges() {
    use shapebot_generated::ballbot3d::{Ballbot3d, CONTROL, Params};
    let model = Ballbot3d::<f64>::from_model();
    let subject = Subject::new("ballbot3d", &model, &CONTROL);
    let falls = |scenario: Scenario<2, 2>| subject.run(&model, &scenario).fell.is_some();
    let delay = onset(0.004, 0.2, 0.02, |actuation_delay| {
        falls(Scenario { actuation_delay, ..Scenario::default() })
    });
    let bias = onset(0.005, 0.5, 0.02, |angle| {
        let mut scenario = Scenario::default();
        scenario.sensors.lean_bias[1] = angle;
        falls(scenario)
    });
    let head = model.description().points.iter().position(|p| *p == "head").expect("a head");
    let push = onset(20.0, 5000.0, 0.02, |force| {
        let push = Push { point: head, force: [force, 0.0, 0.0].into(), start: 2.0, duration: 0.1 };
        falls(Scenario { pushes: vec![push], ..Scenario::default() })
    });
    let heavy = onset(0.1, 0.4, 0.02, |more| {
        let mut parameters = Params::<f64>::model();
        parameters.m_b *= 1.0 + more;
        parameters.Ixx_b *= 1.0 + more;
        parameters.Iyy_b *= 1.0 + more;
        let plant = Ballbot3d::try_new(parameters).expect("in range");
        subject.run(&plant, &Scenario::default()).fell.is_some()
    });
    say(&format!(
        "falls begin: delay {delay:?} s; bias {bias:?} rad; push of .1 s at the head {push:?} N; \
         heavier by {heavy:?}"
    ));
    assert!(delay.stands > 0.012 && delay.falls.is_some(), "{delay:?}");
    assert!(bias.stands > 1.0_f64.to_radians() && bias.falls.is_some(), "{bias:?}");
    assert!(push.stands > 40.0 && push.falls.is_some(), "{push:?}");
    assert!(heavy.stands >= 0.3, "{heavy:?}");
}
