//! Designs of the bundled models, and models that have none.

use shapebot_codegen::derive::{Derivation, Parameters, derive};
use shapebot_dynamics::control::ControlDesign;
use shapebot_synthesis::{control, design};

fn derivation(name: &str, text: &str) -> Derivation {
    let parsed = shapebot_model_dsl::parse(name, text);
    let model = parsed.model.unwrap_or_else(|| panic!("{:?}", parsed.diagnostics));
    derive(&model, Parameters::Symbolic).expect("a robot")
}

fn bundled() -> impl Iterator<Item = (&'static str, Derivation, ControlDesign)> {
    let models = shapebot_models::MODELS.iter().map(|(name, text)| (*name, derivation(name, text)));
    let robots = models.filter(|(_, derivation)| derivation.certificate.is_shape_accelerated());
    robots.map(|(name, derivation)| {
        let design = design(&derivation).unwrap_or_else(|reason| panic!("{name}: {reason}"));
        (name, derivation, design)
    })
}

#[test]
fn every_bundled_robot_gets_a_loop_that_is_stable_over_its_ranges() {
    for (name, derivation, design) in bundled() {
        let figures = &design.figures;
        let n_x = derivation.model.position_count();
        assert!(figures.poles.iter().all(|pole| pole.re < 0.0), "{name}: {:?}", figures.poles);
        assert!(figures.poles.len() >= 2 * derivation.model.coordinates.len(), "{name}");
        assert!(figures.damping >= 0.4 && figures.worst_damping > 0.0, "{name}: {figures:?}");
        assert!(figures.decay >= figures.worst_decay && figures.worst_decay > 0.0, "{name}");
        assert!(figures.delay_margin >= 0.01 && figures.worst_delay_margin >= 0.006, "{name}");
        assert!(figures.together >= 0.1, "{name}: {}", figures.together);
        for parameter in &derivation.model.parameters {
            let range = figures.ranges.iter().find(|range| range.name == parameter.name);
            let range = range.unwrap_or_else(|| panic!("{name}: no range of {}", parameter.name));
            // A fifth to both sides, or as far as the declaration goes.
            let reaches = |end: f64, declared: f64, wanted: f64| {
                (end - wanted).abs() < 1e-3 * wanted.abs()
                    || (end - declared).abs() < 1e-3 * declared.abs()
            };
            let declared = parameter.range.map_or((0.0, 0.0), |r| (r.lower, r.upper));
            assert!(
                reaches(range.lower, declared.0, 0.8 * parameter.value_f64),
                "{name}: {range:?}"
            );
            assert!(
                reaches(range.upper, declared.1, 1.2 * parameter.value_f64),
                "{name}: {range:?}"
            );
        }
        let lean = if design.balancing { n_x } else { 0 };
        assert_eq!((design.lean.len(), design.position.len()), (lean, n_x), "{name}");
        // Less than the pull of gravity would not hold the lean.
        assert!(design.lean.iter().all(|&gain| gain > 1.0), "{name}");
    }
}

#[test]
fn the_momentum_observer_is_there_where_its_conditions_are_proved() {
    for (name, derivation, design) in bundled() {
        let proved = derivation.certificate.positions.iter().all(|p| p.momentum_observer);
        assert_eq!(design.observer_rate > 0.0, proved, "{name}");
    }
}

#[test]
fn a_design_is_the_same_every_time() {
    for (name, derivation, first) in bundled() {
        assert_eq!(design(&derivation), Ok(first), "{name}");
    }
}

/// A pole on a cart, as long as one likes.
fn pole(length: &str) -> Derivation {
    let text = format!(
        "robot Pole {{
            params {{ c: kg = 1; m: kg = 0.1; l: m = {length}; g: m/s^2 = 9.81; }}
            position x: m;
            shape phi: rad in -60deg..60deg;
            frame pole = world * rot_y(phi);
            rigid cart {{ mass: c, com: [x, 0, 0] }}
            rigid bob {{ mass: m, frame: pole, com: [x, 0, 0] + pole*[0, 0, l] }}
            gravity g along -world.z;
            actuator f on d/dt(x);
            output x: m;
            require shape_accelerated;
        }}"
    );
    derivation("pole.robot", &text)
}

#[test]
fn gains_scale_with_the_robot() {
    let [long, short] = ["2", "0.125"].map(|l| design(&pole(l)).expect("gains"));
    // Sixteen times as short falls four times as fast.
    let ratio = |gains: fn(&ControlDesign) -> f64| gains(&short) / gains(&long);
    assert!((ratio(|d| d.lean[0]) - 1.0).abs() < 0.2, "{long:?} {short:?}");
    assert!((ratio(|d| d.lean_rate[0]) * 4.0 - 1.0).abs() < 0.3, "{long:?} {short:?}");
    assert!((ratio(|d| d.position[0]) / 16.0 - 1.0).abs() < 0.5, "{long:?} {short:?}");
}

#[test]
fn a_robot_that_falls_faster_than_the_loop_gets_a_warning_and_no_constant() {
    // A tenth of a millimetre: it falls with a pole of 330 rad/s, a period is 2 ms.
    let addition = control(&pole("0.0001"));
    assert_eq!(addition.items, "");
    assert_eq!(addition.warnings.len(), 1);
    let warning = &addition.warnings[0];
    assert!(warning.contains("`Pole`") && warning.contains("no gains were found"), "{warning}");
}

#[test]
fn the_constant_states_its_figures() {
    let addition = control(&pole("0.5"));
    assert!(addition.warnings.is_empty());
    for part in ["pub const CONTROL: ::shapebot_dynamics::control::ControlDesign", "slowest decay"]
    {
        assert!(addition.items.contains(part), "{part} is not in\n{}", addition.items);
    }
}
