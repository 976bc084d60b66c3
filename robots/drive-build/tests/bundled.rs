//! The bundled descriptions are sound for their models.

mod common;

use common::{description, names};
use shapebot_drive_build::SimulatedKind;

#[test]
fn bundled_descriptions_are_sound() {
    for name in names() {
        let description = description(name).unwrap_or_else(|errors| panic!("{name}:\n{errors}"));
        assert_eq!(description.nodes.len(), description.simulated.len());
        for (node, simulated) in description.nodes.iter().zip(&description.simulated) {
            assert_eq!((&node.name, node.id.raw()), (&simulated.name, simulated.id));
            // Whatever is written at set-up exists, with the same type.
            for step in &node.setup {
                let (shapebot_drive::SdoStep::Write { object, kind, .. }
                | shapebot_drive::SdoStep::Expect { object, kind, .. }) = *step;
                let found = simulated.objects.iter().find(|own| own.object == object);
                assert_eq!(found.map(|own| own.kind), Some(kind), "{name} {object:?}");
            }
        }
    }
}

/// Eq. 13: a pair of motors at ±τ gives the ball 2 (r_w/r_r) τ.
#[test]
fn motors_of_a_pair_add_up_to_equation_13() {
    let description = description("ballbot3d").unwrap_or_else(|errors| panic!("{errors}"));
    let drives = description.simulated.iter().filter_map(|node| match &node.kind {
        SimulatedKind::Drive(drive) if drive.axis == "theta_x" => Some(drive),
        _ => None,
    });
    let force: f64 = drives
        .map(|drive| f64::from(drive.mounting) * drive.ratio * (f64::from(drive.mounting) * 0.3))
        .sum();
    assert!((force - 2.0 * 0.1058 / 0.006335 * 0.3).abs() < 1e-9, "{force}");
}
