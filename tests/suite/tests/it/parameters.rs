//! Parameters of generated code: other values have the effect they should have, senseless ones are
//! refused.

use shapebot_dynamics::{Description, ParameterError};
use shapebot_interpreter::{Interpreted, Tapes};
use shapebot_tests::checks;
use shapebot_tests::dual::{Dual, with_replaced};
use shapebot_tests::models::derivation;
use shapebot_tests::states::Numbers;

/// The model's own values with others beside them.
fn replaced(
    description: &Description,
    mut other: impl FnMut(usize, f64) -> f64,
) -> Vec<(f64, f64)> {
    let values = description.parameters.iter().map(|p| p.value).enumerate();
    values.map(|(i, value)| (value, other(i, value))).collect()
}

/// Values within the declared ranges that are all different from the model's own.
fn perturbed(description: &Description) -> Vec<(f64, f64)> {
    let mut numbers = Numbers::new(11);
    replaced(description, |i, value| {
        let parameter = &description.parameters[i];
        let shifted = value * (1.0 + numbers.between(0.02, 0.08));
        if shifted <= parameter.upper { shifted } else { value * 0.95 }
    })
}

/// What validation says with parameter `index` replaced by `value`.
macro_rules! verdict {
    ($module:ident, $index:expr, $value:expr) => {{
        let numbers = replaced(&shapebot_generated::$module::DESCRIPTION, |i, own| {
            if i == $index { $value } else { own }
        });
        with_replaced(&numbers, shapebot_generated::$module::Params::<Dual>::model).validate()
    }};
}

macro_rules! tests {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $(mod $module {
            use super::*;
            use shapebot_generated::$module::{$robot, DESCRIPTION, Params};

            #[test]
            fn other_parameters_give_what_the_interpreter_gives() {
                let numbers = perturbed(&DESCRIPTION);
                let compiled: $robot<Dual> = with_replaced(&numbers, $robot::from_model);
                let values: Vec<f64> = numbers.iter().map(|(_, value)| *value).collect();
                let tapes = Tapes::new(&derivation($name), &values).expect("as many values as parameters");
                let interpreted = Interpreted::<$n, $nx, $ns, f64>::from_tapes(tapes).expect("a robot");
                checks::agrees($name, &compiled, &interpreted, checks::EXACT);
                let own = $robot::<f64>::from_model();
                let other = std::panic::catch_unwind(|| checks::agrees($name, &own, &interpreted, 1e-6));
                assert!(other.is_err(), "the parameters have no effect");
            }

            #[test]
            fn the_models_own_parameters_are_valid() {
                assert_eq!(Params::<f64>::model().validate(), Ok(()));
                assert_eq!(Params::<f32>::model().validate(), Ok(()));
                assert!($robot::<f64>::try_new(Params::model()).is_ok());
            }

            #[test]
            fn senseless_parameters_are_refused_by_name() {
                for (index, parameter) in DESCRIPTION.parameters.iter().enumerate() {
                    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                        let verdict = verdict!($module, index, value);
                        let Err(ParameterError::NotFinite { name, .. }) = verdict else {
                            panic!("{} = {value}: {verdict:?}", parameter.name);
                        };
                        assert_eq!(name, parameter.name);
                    }
                    for value in [parameter.lower - 1e-3, parameter.upper + 1e-3] {
                        if value.is_finite() {
                            let verdict = verdict!($module, index, value);
                            let Err(ParameterError::OutOfRange { name, .. }) = verdict else {
                                panic!("{} = {value}: {verdict:?}", parameter.name);
                            };
                            assert_eq!(name, parameter.name);
                        }
                    }
                }
            }
        })*
    };
}

shapebot_generated::for_each_robot!(tests);

#[test]
fn requirements_on_parameters_are_checked() {
    use shapebot_generated::ballbot3d_arms::Params;
    // Both in range, but the arms would reach below the centre of the ball.
    let long_arms = Params::<f64> { l_a: 0.9, d_z: 0.9, ..Params::model() };
    let verdict = long_arms.validate();
    assert_eq!(verdict, Err(ParameterError::Requirement { text: "l_a < d_z" }));
}
