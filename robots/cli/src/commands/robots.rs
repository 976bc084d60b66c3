//! `shapebot robots`: the bundled robots.

use crate::failure::Outcome;
use crate::output::{Align, Columns};
use crate::robot::bundled;

pub(crate) fn run() -> Outcome {
    let mut columns = Columns::new(&[
        ("robot", Align::Left),
        ("n", Align::Right),
        ("n_x", Align::Right),
        ("n_s", Align::Right),
        ("class", Align::Left),
        ("summary", Align::Left),
    ]);
    for robot in bundled() {
        let dynamics = robot.dynamics(&[])?;
        let sizes = dynamics.sizes();
        let class =
            if dynamics.is_shape_accelerated() { "shape-accelerated" } else { "Lagrangian" };
        columns.push(vec![
            robot.name().to_owned(),
            sizes.all.to_string(),
            sizes.position.to_string(),
            sizes.shape.to_string(),
            class.to_owned(),
            dynamics.description().summary.to_owned(),
        ]);
    }
    columns.write(&mut anstream::stdout().lock())?;
    Ok(())
}
