//! From a derivation to a design with its figures.

use crate::closed_loop::{Law, Plant, poles};
use crate::gains::{Gains, round};
use crate::linearisation::Linearisation;
use crate::robot::Robot;
use crate::search::{PERIOD, Quality, quality, search};
use shapebot_codegen::derive::Derivation;
use shapebot_dynamics::control::{ControlDesign, LoopFigures, ParameterRange, Pole, Servo};

/// Shares of the parameters' values over which a design is tried to hold, widest first.
const SHARES: [f64; 4] = [0.2, 0.15, 0.1, 0.05];

/// Corners of the box of parameters at which the whole robot is judged.
const CORNERS: usize = 48;

/// Longest delay that is looked at, in periods.
const LONGEST: usize = 50;

/// Gains for a robot, and what is known about the loop that they close.
///
/// # Errors
///
/// Why there are none, in words.
pub fn design(derivation: &Derivation) -> Result<ControlDesign, String> {
    if !derivation.certificate.is_shape_accelerated() {
        return Err("the model is not shape-accelerated".into());
    }
    let robot = Robot::new(derivation)?;
    let gains = search(&robot).gains(&robot);
    let unstable = || String::from("no gains were found that make its linearised loop stable");
    let law = Law::new(&robot.model, &gains, &robot.actuated).ok_or_else(unstable)?;
    let own = Plant::new(&robot.model, &robot.actuated, PERIOD).ok_or_else(unstable)?;
    let list = poles(&law.around(&own, 1), PERIOD).ok_or_else(unstable)?;
    let at_home = Quality::of(&list);
    if at_home.decay.is_nan() || at_home.decay <= 0.0 {
        return Err(unstable());
    }
    let alone = range(&robot, &law, |share| robot.samples(share, 0, true));
    let together = range(&robot, &law, |share| robot.samples(share, CORNERS, false));
    let plants: Vec<Plant> = alone.1.into_iter().chain(together.1).collect();
    let worst = plants.iter().fold(at_home, |q, plant| q.worse(quality(&law, plant, 1)));
    let delay_margin = margin(&law, std::slice::from_ref(&own));
    let worst_delay_margin = margin(&law, &plants).min(delay_margin);
    let figures = LoopFigures {
        poles: leaked(list.iter().map(|&(re, im)| Pole { re: round(re), im: round(im) })),
        damping: round(at_home.damping),
        decay: round(at_home.decay),
        worst_damping: round(worst.damping),
        worst_decay: round(worst.decay),
        delay_margin: round(delay_margin),
        worst_delay_margin: round(worst_delay_margin),
        ranges: ranges(&robot, alone.0),
        together: together.0,
        samples: plants.len(),
    };
    Ok(assembled(&robot, &gains, figures))
}

/// The widest share of the parameters' values over which the loop is stable at all samples, and the
/// plants there.
fn range(
    robot: &Robot<'_>,
    law: &Law<'_>,
    samples: impl Fn(f64) -> Vec<Linearisation>,
) -> (f64, Vec<Plant>) {
    for share in SHARES {
        let plant = |sample| Plant::new(sample, &robot.actuated, PERIOD);
        let Some(plants) = samples(share).iter().map(plant).collect::<Option<Vec<Plant>>>() else {
            continue;
        };
        if plants.iter().all(|plant| quality(law, plant, 1).decay > 0.0) {
            return (share, plants);
        }
    }
    (0.0, Vec::new())
}

/// Delay beyond one period that all loops bear, s.
fn margin(law: &Law<'_>, plants: &[Plant]) -> f64 {
    let bears =
        |extra: usize| plants.iter().all(|plant| quality(law, plant, 1 + extra).decay > 0.0);
    let (mut good, mut bad) = (0, LONGEST);
    while good + 1 < bad {
        let middle = usize::midpoint(good, bad);
        if bears(middle) { good = middle } else { bad = middle }
    }
    good as f64 * PERIOD
}

fn ranges(robot: &Robot<'_>, share: f64) -> &'static [ParameterRange] {
    let parameters = robot.derivation.model.parameters.iter().zip(robot.ranges(share));
    let varied = parameters.filter(|(_, (lower, _, upper))| lower < upper);
    leaked(varied.map(|(parameter, (lower, _, upper))| ParameterRange {
        name: Box::leak(parameter.name.clone().into_boxed_str()),
        lower: round(lower),
        upper: round(upper),
    }))
}

fn assembled(robot: &Robot<'_>, gains: &Gains, figures: LoopFigures) -> ControlDesign {
    let lean = |k: usize| leaked(gains.lean.iter().map(move |g| g[k]));
    let outer = |k: usize| leaked(gains.outer.iter().map(move |g| g[k]));
    let [rate, damping, integral] = gains.servo;
    ControlDesign {
        period: gains.period,
        balancing: robot.balancing,
        lean: lean(0),
        lean_rate: lean(1),
        lean_integral: lean(2),
        position: outer(0),
        velocity: outer(1),
        servo: Servo { rate, damping, integral },
        observer_rate: gains.observer_rate,
        offset_rate: gains.offset_rate,
        figures,
    }
}

/// A list that lives as long as the program: a design is made once per robot.
fn leaked<T>(items: impl Iterator<Item = T>) -> &'static [T] {
    Box::leak(items.collect::<Vec<T>>().into_boxed_slice())
}
