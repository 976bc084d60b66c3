//! What must hold for every bundled robot, whether compiled with parameters at run time, compiled with
//! parameters folded in, or interpreted.

use shapebot_dynamics::{Real, Robot};
use shapebot_tests::checks;
use shapebot_tests::dual::Dual;
use shapebot_tests::reference::{Data, load};

/// Reference states of a robot, if there are any.
fn reference(name: &str) -> Option<Data> {
    load("dynamics", name)
}

/// Claims about one implementation; `robot::<T>()` makes it.
macro_rules! claims {
    ($label:expr, $name:literal) => {
        const LABEL: &str = $label;

        #[test]
        fn dynamics_agree_with_the_reference_states() {
            if let Some(data) = reference($name) {
                checks::reference_states(LABEL, &robot::<f64>(), &data);
            }
        }

        #[test]
        fn shape_gain_agrees_with_the_reference() {
            if let Some(data) = reference($name) {
                checks::shape_gain(LABEL, &robot::<f64>(), &data);
            }
        }

        #[test]
        fn mass_matrix_is_symmetric_and_positive_definite() {
            checks::mass_matrix(LABEL, &robot::<f64>());
        }

        #[test]
        fn mass_rate_minus_twice_coriolis_matrix_is_skew() {
            checks::coriolis_matrix(LABEL, &robot::<f64>(), &robot::<Dual>());
        }

        #[test]
        fn power_is_the_change_of_energy() {
            checks::energies(LABEL, &robot::<f64>(), &robot::<Dual>());
        }

        #[test]
        fn forward_and_inverse_dynamics_are_inverse() {
            checks::dynamics(LABEL, &robot::<f64>());
        }

        #[test]
        fn inputs_act_on_actuated_coordinates_alone() {
            checks::inputs(LABEL, &robot::<f64>());
        }

        #[test]
        fn jacobians_of_the_dynamics_are_those_of_dual_numbers() {
            checks::lagrangian_jacobians(LABEL, &robot::<f64>(), &robot::<Dual>());
        }

        #[test]
        fn jacobians_of_gamma_are_those_of_dual_numbers() {
            checks::shape_jacobians(LABEL, &robot::<f64>(), &robot::<Dual>());
        }

        #[test]
        fn gamma_solves_the_unactuated_equations_of_motion() {
            checks::motion_of_the_shape(LABEL, &robot::<f64>());
        }

        #[test]
        fn gamma_at_rest_is_gamma_prime_and_linearises_to_the_shape_gain() {
            checks::shape_map(LABEL, &robot::<f64>());
        }

        #[test]
        fn energy_of_the_free_system_is_conserved_to_fourth_order() {
            checks::energy_is_conserved(LABEL, &robot::<f64>());
        }

        #[test]
        fn origin_is_a_regular_equilibrium() {
            checks::origin(LABEL, &robot::<f64>());
        }

        #[test]
        fn frames_are_rotations() {
            checks::frames(LABEL, &robot::<f64>());
        }

        #[test]
        fn points_are_where_the_description_says() {
            checks::points(LABEL, &robot::<f64>());
        }

        #[test]
        fn single_precision_agrees_with_double() {
            checks::single_precision(LABEL, &robot::<f32>(), &robot::<f64>());
        }
    };
}

macro_rules! suites {
    ($({ $name:literal, $module:ident, $robot:ident, $baked:ident, $n:literal, $nx:literal, $ns:literal })*) => {
        $(mod $module {
            use super::*;

            mod compiled {
                use super::*;
                use shapebot_generated::$module::$robot;
                fn robot<T: Real>() -> $robot<T> {
                    $robot::from_model()
                }
                claims!(concat!($name, ", compiled"), $name);
            }

            mod baked {
                use super::*;
                use shapebot_generated::$module::$baked;
                fn robot<T: Real>() -> impl Robot<T, $n, $nx, $ns> {
                    $baked
                }
                claims!(concat!($name, ", baked"), $name);
            }

            mod interpreted {
                use super::*;
                use shapebot_interpreter::Interpreted;
                fn robot<T: Real>() -> Interpreted<$n, $nx, $ns, T> {
                    shapebot_tests::models::interpreted($name)
                }
                claims!(concat!($name, ", interpreted"), $name);
            }
        })*
    };
}

shapebot_generated::for_each_robot!(suites);
